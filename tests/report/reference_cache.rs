//! Reference pictures are computed once, and never taken for those of something else.

use crate::common;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use angioray::frame::{Frame, Layer, Wanted};
use angioray::lab::measure::ReferenceCache;
use angioray::progress::Silent;
use angioray::reference;
use angioray::scene::{Picture, Projection, Scene, Window};
use angioray::volume::Volume;

fn volume(peak: f64) -> Volume {
    common::volume_of([9, 9, 9], |x, y, z| {
        (peak - (x - 4.0).abs() - (y - 4.0).abs() - (z - 4.0).abs()).max(0.0) as f32
    })
}

fn scene(volume: &Volume, size_px: u32) -> Scene {
    let picture = Picture::Projection {
        of: Projection::Maximum,
        window: Window::new(0.0, 10.0).unwrap(),
    };
    common::scene(volume, size_px, picture)
}

fn cached(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().path()).collect()
}

/// The picture, and whether it was computed.
fn picture(folder: &Path, volume: &Volume, scene: &Scene, wanted: Wanted) -> (Frame, bool) {
    let references = ReferenceCache::in_folder(folder, volume).unwrap();
    let first = references.frame(scene, wanted, &Silent).unwrap();
    (first.frame, first.computed)
}

#[test]
fn a_picture_is_computed_once_and_comes_back_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let volume = volume(8.0);
    let scene = scene(&volume, 16);
    let expected = reference::render(&volume, &scene, Wanted::ALL, &Silent).unwrap();
    let (first, computed) = picture(folder.path(), &volume, &scene, Wanted::ALL);
    assert!(computed);
    let (second, computed) = picture(folder.path(), &volume, &scene, Wanted::ALL);
    assert!(!computed);
    assert_eq!(first, expected);
    assert_eq!(second, expected);
    assert_eq!(cached(folder.path()).len(), 1);
}

#[test]
fn another_volume_scene_or_choice_of_planes_is_computed_anew() {
    let folder = tempfile::tempdir().unwrap();
    let volume_of = volume;
    let volume = volume_of(8.0);
    let seen = scene(&volume, 16);
    picture(folder.path(), &volume, &seen, Wanted::ALL);

    let other = volume_of(7.0);
    assert!(picture(folder.path(), &other, &seen, Wanted::ALL).1);
    let mut turned = seen.clone();
    turned.camera = common::camera(&volume, common::OBLIQUE + glam::DVec3::X * 1e-9);
    assert!(picture(folder.path(), &volume, &turned, Wanted::ALL).1);
    let (frame, computed) = picture(folder.path(), &volume, &seen, Wanted::DISPLAY);
    assert!(computed);
    assert!(frame.display.is_some() && !frame.layers.has(Layer::Depth));
    assert_eq!(cached(folder.path()).len(), 4);
}

#[test]
fn what_was_not_used_for_a_month_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    let volume = volume(8.0);
    let (seen, mut other) = (scene(&volume, 16), scene(&volume, 16));
    other.camera = common::camera(&volume, common::OBLIQUE + glam::DVec3::X);
    let age = |days: u64| SystemTime::now() - Duration::from_secs(days * 24 * 3600);
    let set_back = |days| {
        for file in cached(folder.path()) {
            let file = fs::File::options().append(true).open(file).unwrap();
            file.set_modified(age(days)).unwrap();
        }
    };
    picture(folder.path(), &volume, &seen, Wanted::ALL);
    picture(folder.path(), &volume, &other, Wanted::ALL);
    // A file that is not a picture is not removed.
    fs::write(folder.path().join("notes.txt"), "").unwrap();
    set_back(29);
    // Used again: young again.
    assert!(!picture(folder.path(), &volume, &seen, Wanted::ALL).1);
    let young = |file: &PathBuf| {
        let modified = file.metadata().unwrap().modified().unwrap();
        modified > age(1)
    };
    assert_eq!(
        cached(folder.path())
            .iter()
            .filter(|file| young(file))
            .count(),
        1
    );
    set_back(31);
    assert!(picture(folder.path(), &volume, &seen, Wanted::ALL).1);
    assert_eq!(cached(folder.path()).len(), 2);
    assert!(folder.path().join("notes.txt").exists());
}

#[test]
fn a_picture_that_cannot_be_cached_is_returned_all_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let volume = volume(8.0);
    let scene = scene(&volume, 16);
    let inner = folder.path().join("cache");
    let references = ReferenceCache::in_folder(&inner, &volume).unwrap();
    fs::remove_dir(&inner).unwrap();
    let first = references.frame(&scene, Wanted::ALL, &Silent).unwrap();
    let why = first.not_cached.unwrap().to_string();
    assert!(first.computed && why.contains("cache"), "{why}");
    fs::create_dir(&inner).unwrap();
    let again = references.frame(&scene, Wanted::ALL, &Silent).unwrap();
    assert!(again.computed && again.not_cached.is_none());
    assert_eq!(again.frame, first.frame);
}

#[test]
fn what_is_torn_is_computed_again() {
    let folder = tempfile::tempdir().unwrap();
    let volume = volume(8.0);
    let scene = scene(&volume, 16);
    let (expected, _) = picture(folder.path(), &volume, &scene, Wanted::ALL);
    let file = &cached(folder.path())[0];
    let whole = fs::read(file).unwrap();
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 4;
    let longer = [&whole[..], &whole[..]].concat();
    for torn in [&whole[..whole.len() / 2], b"", &flipped] {
        fs::write(file, torn).unwrap();
        let (frame, computed) = picture(folder.path(), &volume, &scene, Wanted::ALL);
        assert!(computed, "{} of {} bytes", torn.len(), whole.len());
        assert_eq!(frame, expected);
        assert_eq!(fs::read(file).unwrap(), whole);
    }
    // What follows the whole picture, its checksum included, is not read.
    fs::write(file, longer).unwrap();
    let (frame, computed) = picture(folder.path(), &volume, &scene, Wanted::ALL);
    assert!(!computed);
    assert_eq!(frame, expected);
}
