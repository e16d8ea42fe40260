//! Damaged and hostile volume files: cut off at every length, bytes changed, numbers replaced. None
//! may make a panic, a hang, wrong voxels taken for right ones, or an absurd allocation.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use angioray::progress::Silent;
use angioray::volume::{ReadOptions, Volume, read};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

/// Counts what each thread holds, and the most it ever held since asked.
struct Counting;

thread_local! {
    static HELD: Cell<isize> = const { Cell::new(0) };
    static MOST: Cell<isize> = const { Cell::new(0) };
}

fn count(bytes: isize) {
    // A thread that is ending has no counters any more; it no longer reads volumes either.
    let _ = HELD.try_with(|held| {
        held.set(held.get() + bytes);
        let _ = MOST.try_with(|most| most.set(most.get().max(held.get())));
    });
}

// SAFETY: every call goes to the system's allocator unchanged; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        unsafe { System.alloc(layout) }
    }
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        unsafe { System.alloc_zeroed(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size as isize - layout.size() as isize);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The most bytes this thread held during `work`, beyond those it held before.
fn most_held<T>(work: impl FnOnce() -> T) -> (T, isize) {
    let before = HELD.get();
    MOST.set(before);
    let done = work();
    (done, MOST.get() - before)
}

/// No fixture is larger than 1 KiB.
const MOST_MEMORY: isize = 16 << 20;

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
    let (volume, held) = most_held(|| read(path, &ReadOptions::default(), &Silent));
    assert!(held < MOST_MEMORY, "{} held {held} bytes", path.display());
    if let Err(error) = &volume {
        let message = error.to_string();
        let named = message.starts_with(&path.display().to_string());
        let is_sentence = !message.contains(char::is_control) && message.len() < 2000;
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

/// A change to a file's bytes.
#[derive(Debug, Clone)]
enum Change {
    Byte {
        at: usize,
        value: u8,
    },
    Bytes {
        at: usize,
        value: [u8; 8],
        length: usize,
    },
    Number {
        which: usize,
        text: String,
    },
    Cut {
        at: usize,
        length: usize,
    },
    Double {
        at: usize,
        length: usize,
    },
}

impl Change {
    fn apply(&self, bytes: &mut Vec<u8>) {
        let size = bytes.len();
        if size == 0 {
            return;
        }
        match self {
            Self::Byte { at, value } => bytes[at % size] = *value,
            Self::Bytes { at, value, length } => {
                for (offset, value) in value[..*length].iter().enumerate() {
                    bytes[(at + offset) % size] = *value;
                }
            }
            Self::Number { which, text } => {
                let numbers = written_numbers(bytes);
                if let Some(range) = numbers.get(which % numbers.len().max(1)) {
                    bytes.splice(range.clone(), text.bytes());
                }
            }
            Self::Cut { at, length } => {
                let at = at % size;
                bytes.drain(at..(at + length).min(size));
            }
            Self::Double { at, length } => {
                let at = at % size;
                let part = bytes[at..(at + length).min(size)].to_vec();
                bytes.splice(at..at, part);
            }
        }
    }
}

/// Where numbers are written in the text at a file's start.
fn written_numbers(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let mut numbers = Vec::new();
    let mut start = None;
    for (at, byte) in bytes.iter().take(600).enumerate() {
        match (byte.is_ascii_digit(), start) {
            (true, None) => start = Some(at),
            (false, Some(from)) => {
                numbers.push(from..at);
                start = None;
            }
            _ => {}
        }
    }
    numbers
}

fn change() -> impl Strategy<Value = Change> {
    let hostile_text = prop::sample::select(vec![
        "0",
        "-1",
        "-9223372036854775808",
        "9223372036854775807",
        "18446744073709551615",
        "340282366920938463463374607431768211456",
        "1048576",
        "1099511627776",
        "1e308",
        "-1e308",
        "1e-320",
        "nan",
        "inf",
        "-inf",
        "",
        "99999",
        "%d",
        "4294967296",
        "65536",
        "(",
        "\n",
    ]);
    let hostile_bytes = prop::sample::select(vec![
        [0; 8],
        [0xff; 8],
        [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f],
        [0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff],
        [0, 0, 0xc0, 0x7f, 0, 0, 0xc0, 0x7f],
        [0, 0, 0, 0, 0, 1, 0, 0],
    ]);
    prop_oneof![
        (any::<usize>(), any::<u8>()).prop_map(|(at, value)| Change::Byte { at, value }),
        (
            any::<usize>(),
            hostile_bytes,
            prop::sample::select(vec![2, 4, 8])
        )
            .prop_map(|(at, value, length)| Change::Bytes { at, value, length }),
        (any::<usize>(), hostile_text).prop_map(|(which, text)| Change::Number {
            which,
            text: text.into()
        }),
        (any::<usize>(), 1..40usize).prop_map(|(at, length)| Change::Cut { at, length }),
        (any::<usize>(), 1..40usize).prop_map(|(at, length)| Change::Double { at, length }),
    ]
}

#[test]
fn changed_files_are_read_or_refused_and_nothing_else() {
    let read_anyway = Cell::new(0);
    let refused = Cell::new(0);
    let folder = copies();
    for original in fixtures() {
        let whole = fs::read(&original).unwrap();
        let path = folder.path().join(original.file_name().unwrap());
        let mut runner = TestRunner::new_with_rng(
            Config {
                cases: 100,
                failure_persistence: None,
                ..Config::default()
            },
            TestRunner::deterministic().new_rng(),
        );
        runner
            .run(&prop::collection::vec(change(), 1..4), |changes| {
                let mut bytes = whole.clone();
                for change in &changes {
                    change.apply(&mut bytes);
                }
                write_anew(&path, &bytes);
                match read_checked(&path) {
                    Ok(volume) => {
                        read_anyway.set(read_anyway.get() + 1);
                        let range = volume.range();
                        prop_assert!(range.min.is_finite() && range.max.is_finite());
                        prop_assert!(volume.geometry().spacing_mm().min_element() > 0.0);
                    }
                    Err(_) => refused.set(refused.get() + 1),
                }
                Ok(())
            })
            .unwrap_or_else(|failure| panic!("{}: {failure}", original.display()));
        write_anew(&path, &whole);
    }
    // Both happen, so neither branch is idle.
    let (read_anyway, refused) = (read_anyway.get(), refused.get());
    assert!(
        read_anyway > 1000 && refused > 1000,
        "{read_anyway} {refused}"
    );
}

/// Few bytes that announce 2^40 voxels, in every way that hides their true size.
#[test]
fn lying_sizes_cost_neither_time_nor_memory() {
    let folder = copies();
    let path = |name: &str| folder.path().join(name);
    let refuse = |name: &str, bytes: &[u8]| {
        fs::write(path(name), bytes).unwrap();
        let (volume, held) = most_held(|| read(&path(name), &ReadOptions::default(), &Silent));
        let error = volume.expect_err(name);
        assert!(held < MOST_MEMORY, "{name} held {held} bytes: {error}");
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
        let (volume, held) = most_held(|| read(&path, &ReadOptions::default(), &Silent));
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

#[test]
fn the_memory_count_sees_an_allocation() {
    let (block, held) = most_held(|| vec![1u8; 3 << 20]);
    assert_eq!(block.len(), 3 << 20);
    assert!(held >= 3 << 20);
}
