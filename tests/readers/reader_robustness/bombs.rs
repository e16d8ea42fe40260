//! Few bytes that announce or unpack to many: refused at once where that is more than they can hold, and
//! where they can hold it memory grows with what really comes.

use std::fs;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use angioray::error::ErrorKind;
use angioray::progress::Silent;
use angioray::volume::{ReadOptions, read};
use bzip2::write::BzEncoder;
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::memory::max_held;

/// A decoder alone takes some of it.
const FEW_MEGABYTES: isize = 6 << 20;

/// Reading the file must fail, for little memory, and in a sentence that has `word`.
fn refused(path: &Path, word: &str) {
    let (volume, held) = max_held(|| read(path, &ReadOptions::default(), &Silent));
    let error = volume.expect_err(&path.display().to_string());
    assert_eq!(error.kind(), ErrorKind::Input, "{error}");
    assert!(error.to_string().contains(word), "{error}");
    assert!(held < FEW_MEGABYTES, "{held} bytes: {error}");
}

fn case(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/cases")
        .join(name)
}

/// A folder with one file.
struct Made {
    folder: tempfile::TempDir,
}

impl Made {
    fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
        }
    }

    fn file(&self, name: &str, parts: &[&[u8]]) -> PathBuf {
        let path = self.folder.path().join(name);
        fs::write(&path, parts.concat()).unwrap();
        path
    }
}

fn nrrd(encoding: &str, sizes: &str, more: &str) -> Vec<u8> {
    let header = format!(
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: {sizes}\nencoding: {encoding}\n{more}\n"
    );
    header.into_bytes()
}

fn npy(shape: &str) -> Vec<u8> {
    let text = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({shape}), }}\n");
    let length = (text.len() as u32).to_le_bytes();
    [b"\x93NUMPY\x02\x00", &length[..], text.as_bytes(), &[7; 8]].concat()
}

fn npz(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    for (name, bytes) in arrays {
        archive.start_file(format!("{name}.npy"), options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

#[test]
fn arrays_that_overlap_and_absurd_axes_are_refused() {
    refused(&case("npz-overlap-500.npz"), "overlap");
    let made = Made::new();
    let axes = "1,".repeat(3000);
    refused(&made.file("axes.npy", &[&npy(&axes)]), "axes");
    refused(
        &made.file("axes.npz", &[&npz(&[("a", npy(&axes))])]),
        "axes",
    );
    let blanks = " ".repeat(20_000);
    refused(&made.file("long.npy", &[&npy(&blanks)]), "10000");
    // The control: as many arrays, each a place of its own, are an archive.
    let names: Vec<String> = (0..500).map(|n| n.to_string()).collect();
    let arrays: Vec<_> = names.iter().map(|n| (&n[..], npy("2, 2, 2"))).collect();
    let path = made.file("many.npz", &[&npz(&arrays)]);
    assert!(read(&path, &ReadOptions::default(), &Silent).is_ok());
}

#[test]
fn compressed_data_are_believed_as_much_as_they_can_hold() {
    refused(&case("bzip2-bomb-3kB.nrrd"), "cannot hold");
    let made = Made::new();
    let zeros = vec![0; 1 << 20];
    let mut gzip = GzEncoder::new(Vec::new(), Compression::best());
    gzip.write_all(&zeros).unwrap();
    let gzip = gzip.finish().unwrap();
    let mut zlib = ZlibEncoder::new(Vec::new(), Compression::best());
    zlib.write_all(&zeros).unwrap();
    let zlib = zlib.finish().unwrap();
    // Twice what deflate packs at best.
    let many = format!("2064 {} 1", gzip.len());
    refused(
        &made.file("a.nrrd", &[&nrrd("gzip", &many, ""), &gzip]),
        "cannot hold",
    );
    let skip = "byte skip: 2000000000\n";
    refused(
        &made.file("skip.nrrd", &[&nrrd("gzip", "4 4 4", skip), &gzip]),
        "cannot hold",
    );
    let meta = format!(
        "NDims = 3\nDimSize = 2064 {} 1\nElementType = MET_UCHAR\nCompressedData = True\nElementDataFile = LOCAL\n",
        zlib.len()
    );
    refused(
        &made.file("a.mha", &[meta.as_bytes(), &zlib]),
        "cannot hold",
    );
    let packed = npz(&[("volume", [npy("4096, 4096, 64"), zeros.clone()].concat())]);
    refused(&made.file("a.npz", &[&packed]), "cannot hold");
    let text = nrrd("ascii", "100 100 100", "");
    refused(&made.file("text.nrrd", &[&text, b"1 2 3"]), "cannot hold");
    // The control: what is really there is read.
    let path = made.file("b.nrrd", &[&nrrd("gzip", "1024 1024 1", ""), &gzip]);
    assert!(read(&path, &ReadOptions::default(), &Silent).is_ok());
}

/// The most that a block of bzip2 holds: 900,000 bytes, of which every five stand for 259.
#[test]
fn the_densest_bzip2_is_read() {
    let mut bzip2 = BzEncoder::new(Vec::new(), bzip2::Compression::best());
    for _ in 0..4662 {
        bzip2.write_all(&[0xff; 10_000]).unwrap();
    }
    let bzip2 = bzip2.finish().unwrap();
    assert!(bzip2.len() < 100, "{}", bzip2.len());
    let made = Made::new();
    let path = made.file("a.nrrd", &[&nrrd("bzip2", "4662 100 100", ""), &bzip2]);
    let volume = read(&path, &ReadOptions::default(), &Silent).unwrap();
    assert_eq!(volume.range().min, 255.0);
    // Ten times as much is more than those bytes can be.
    refused(
        &made.file("b.nrrd", &[&nrrd("bzip2", "46620 100 100", ""), &bzip2]),
        "cannot hold",
    );
}
