//! `angioray orbit`: every frame is what `render` makes, in pictures, animations and shards; stopped
//! and resumed.

use crate::cli_place;
use crate::common;

mod animations;
mod frames;
mod jitter;
mod refused;
mod resuming;
mod statistics;
mod stopping;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use cli_place::Place;

const REFERENCE: &str = "--device reference";

/// A folder with vessels of 24³ voxels, which look different from every side.
fn place() -> Place {
    let place = Place::empty();
    place.done("phantom vessels -o v.nrrd --size 24 --seed 2");
    place
}

/// A folder's files by name.
fn contents(place: &Place, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(place.path(folder)).unwrap();
    let file = |entry: fs::DirEntry| {
        let name = entry.file_name().into_string().unwrap();
        (name, fs::read(entry.path()).unwrap())
    };
    entries.map(|entry| file(entry.unwrap())).collect()
}

fn names(numbers: &[u32]) -> Vec<String> {
    numbers.iter().map(|k| format!("{k:02}.png")).collect()
}

/// A picture's RGB bytes.
fn pixels(path: &Path) -> Vec<u8> {
    let file = std::io::BufReader::new(fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    reader.finish().unwrap();
    pixels
}

/// Mean and greatest difference of two pictures, in levels.
fn apart(a: &[u8], b: &[u8]) -> (f64, u8) {
    assert_eq!(a.len(), b.len());
    let differences = || a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
    let sum: f64 = differences().map(f64::from).sum();
    (sum / a.len() as f64, differences().max().unwrap())
}
