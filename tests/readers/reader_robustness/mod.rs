//! Damaged and hostile volume files: cut off at every length, bytes changed, numbers replaced. None
//! may make a panic, a hang, wrong voxels taken for right ones, or an absurd allocation.

mod bombs;
mod campaign;
mod changes;
mod memory;
mod octree;
#[cfg(unix)]
mod refused;
#[cfg(unix)]
mod shortened;
mod subjects;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use angioray::progress::Silent;
use angioray::volume::{ReadOptions, Volume, read};

use memory::max_held;

/// No fixture is larger than 1 KiB.
const MAX_MEMORY: isize = 16 << 20;

fn fixtures() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/volumes");
    let mut paths: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    paths
}

/// A folder with copies of all fixtures (data files lie beside their headers).
fn copies() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for fixture in fixtures() {
        fs::copy(&fixture, folder.path().join(fixture.file_name().unwrap())).unwrap();
    }
    folder
}

/// Writes a file anew: rewriting one in place makes some file systems wait for the disk.
fn write_anew(path: &Path, contents: &[u8]) {
    let _ = fs::remove_file(path);
    fs::write(path, contents).unwrap();
}

/// Reads the file under the memory limit; an error must be one sentence that names it.
fn read_checked(path: &Path) -> angioray::Result<Volume> {
    let (volume, held) = max_held(|| read(path, &ReadOptions::default(), &Silent));
    assert!(held < MAX_MEMORY, "{} held {held} bytes", path.display());
    if let Err(error) = &volume {
        let message = error.to_string();
        let named = message.starts_with(&path.display().to_string());
        // Whatever it quotes is shown escaped where it is printed; how much of it is bounded here.
        let is_sentence = !message.is_empty() && message.len() < 2000;
        assert!(named && is_sentence, "{message}");
    }
    volume
}

/// Everything that a reader can get wrong about the voxels.
fn contents(volume: &Volume) -> (String, Vec<u8>) {
    let place = format!(
        "{} {:?} {:?}",
        volume.dims(),
        volume.geometry(),
        volume.rescale()
    );
    (place, volume.voxels().bytes().to_vec())
}

/// Headers say where the voxels are; text files may end anywhere in a number.
fn ends_in_text(path: &Path) -> bool {
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    name.contains("ascii") || name.ends_with(".nhdr") || name.ends_with(".mhd")
}

#[test]
fn a_file_cut_off_anywhere_is_refused_or_reads_the_same() {
    let mut refused = 0;
    let folder = copies();
    for original in fixtures() {
        let whole = fs::read(&original).unwrap();
        let path = folder.path().join(original.file_name().unwrap());
        let intact = read(&original, &ReadOptions::default(), &Silent).ok();
        let file = fs::File::options().write(true).open(&path).unwrap();
        for length in (0..whole.len()).rev() {
            file.set_len(length as u64).unwrap();
            match (read_checked(&path), &intact) {
                (Err(_), _) => refused += 1,
                (Ok(volume), Some(intact)) if !ends_in_text(&original) => assert_eq!(
                    contents(&volume),
                    contents(intact),
                    "{} cut off at {length}",
                    original.display()
                ),
                (Ok(_), _) => {}
            }
        }
        write_anew(&path, &whole);
    }
    // The check would also pass if nothing were ever refused.
    assert!(refused > 10_000, "{refused}");
}

#[test]
fn the_comparison_sees_another_volume() {
    let of = |name: &str| {
        let path = fixtures().into_iter().find(|path| path.ends_with(name));
        contents(&read(&path.unwrap(), &ReadOptions::default(), &Silent).unwrap())
    };
    assert_eq!(of("np_i16.npy"), of("np_big.npy"));
    assert_ne!(of("np_i16.npy").1, of("np_series.npy").1);
    assert_ne!(of("np_i16.npy").0, of("sitk_i16.nrrd").0);
}

/// Few bytes that announce 2^40 voxels, in every encoding that hides their true size.
#[test]
fn lying_sizes_cost_neither_time_nor_memory() {
    let folder = copies();
    let path = |name: &str| folder.path().join(name);
    let refuse = |name: &str, bytes: &[u8]| {
        fs::write(path(name), bytes).unwrap();
        let (volume, held) = max_held(|| read(&path(name), &ReadOptions::default(), &Silent));
        let error = volume.expect_err(name);
        assert!(held < MAX_MEMORY, "{name} held {held} bytes: {error}");
    };
    let gz = fs::read(path("nib2_i16.nii.gz")).unwrap();
    let bz2 = fs::read(path("slice_008.raw.bz2")).unwrap();
    for (encoding, data) in [
        ("gzip", &gz),
        ("bzip2", &bz2),
        ("raw", &bz2),
        ("ascii", &gz),
    ] {
        let header = format!(
            "NRRD0004\ntype: float\ndimension: 3\nsizes: 10240 10240 10240\nendian: little\nencoding: {encoding}\n\n"
        );
        refuse(
            &format!("{encoding}.nrrd"),
            &[header.as_bytes(), data].concat(),
        );
    }
    for (name, compressed) in [("zlib.mha", "True"), ("raw.mha", "False")] {
        let header = format!(
            "NDims = 3\nDimSize = 10240 10240 10240\nElementType = MET_DOUBLE\nCompressedData = {compressed}\nElementDataFile = LOCAL\n"
        );
        refuse(name, &[header.as_bytes(), b"\x78\x9c\x63\x00"].concat());
    }
    let raw_gz = fs::read(path("ramp_5x4x3_int16.raw.gz")).unwrap();
    refuse("lie_10240x10240x10240_float32.raw.gz", &raw_gz);
    let mut npy = fs::read(path("np_u8.npy")).unwrap();
    let shape = npy
        .windows(9)
        .position(|part| part == b"(3, 4, 5)")
        .unwrap();
    npy.splice(shape..shape + 9, *b"(9999, 9999, 9999)");
    refuse("lie.npy", &npy);
    let list = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1024 1024 1048576\nencoding: raw\ndata file: s%d.raw 1 1048576 1\n";
    refuse("many.nhdr", list.as_bytes());
}

#[test]
fn gzip_is_decoded_into_place_and_plain_voxels_cost_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let voxels: Vec<u8> = (0..24u32 << 20).map(|i| (i / 999) as u8).collect();
    let bytes = voxels.len() as isize;
    let held = |name: &str, contents: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, contents).unwrap();
        let (volume, held) = max_held(|| read(&path, &ReadOptions::default(), &Silent));
        assert_eq!(volume.unwrap().voxels().bytes(), voxels, "{name}");
        held
    };
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gzip.write_all(&voxels).unwrap();
    let zipped = held("a_256x256x192_int16.raw.gz", &gzip.finish().unwrap());
    assert!(
        (bytes..bytes + (3 << 20)).contains(&zipped),
        "{zipped} of {bytes}"
    );
    let plain = held("a_256x256x192_int16.raw", &voxels);
    assert!(plain < 1 << 20, "{plain} of {bytes}");
}
