//! Reference pictures are computed once, and never taken for those of something else.

mod common;

use std::fs;
use std::path::{Path, PathBuf};

use angioray::frame::{Frame, Wanted};
use angioray::measure::Truth;
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

fn kept(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().path()).collect()
}

/// The picture, and whether it was computed.
fn asked(folder: &Path, volume: &Volume, scene: &Scene, wanted: Wanted) -> (Frame, bool) {
    let truth = Truth::kept_in(folder, volume).unwrap();
    let found = truth.frame(scene, wanted, &Silent).unwrap();
    (found.frame, found.computed)
}

#[test]
fn a_picture_is_computed_once_and_comes_back_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let volume = volume(8.0);
    let scene = scene(&volume, 16);
    let expected = reference::render(&volume, &scene, Wanted::ALL, &Silent).unwrap();
    let (first, computed) = asked(folder.path(), &volume, &scene, Wanted::ALL);
    assert!(computed);
    let (second, computed) = asked(folder.path(), &volume, &scene, Wanted::ALL);
    assert!(!computed);
    assert_eq!(first, expected);
    assert_eq!(second, expected);
    assert_eq!(kept(folder.path()).len(), 1);
}

#[test]
fn another_volume_scene_or_choice_of_planes_is_computed_anew() {
    let folder = tempfile::tempdir().unwrap();
    let volume_of = volume;
    let volume = volume_of(8.0);
    let seen = scene(&volume, 16);
    asked(folder.path(), &volume, &seen, Wanted::ALL);

    let other = volume_of(7.0);
    assert!(asked(folder.path(), &other, &seen, Wanted::ALL).1);
    let mut turned = seen.clone();
    turned.camera = common::camera(&volume, common::OBLIQUE + glam::DVec3::X * 1e-9);
    assert!(asked(folder.path(), &volume, &turned, Wanted::ALL).1);
    let wanted = Wanted {
        display: true,
        ..Wanted::default()
    };
    let (frame, computed) = asked(folder.path(), &volume, &seen, wanted);
    assert!(computed);
    assert!(frame.display.is_some() && frame.depth.is_none());
    assert_eq!(kept(folder.path()).len(), 4);
}

#[test]
fn what_is_torn_is_computed_again() {
    let folder = tempfile::tempdir().unwrap();
    let volume = volume(8.0);
    let scene = scene(&volume, 16);
    let (expected, _) = asked(folder.path(), &volume, &scene, Wanted::ALL);
    let file = &kept(folder.path())[0];
    let whole = fs::read(file).unwrap();
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 4;
    let longer = [&whole[..], &whole[..]].concat();
    for torn in [&whole[..whole.len() / 2], b"", &flipped] {
        fs::write(file, torn).unwrap();
        let (frame, computed) = asked(folder.path(), &volume, &scene, Wanted::ALL);
        assert!(computed, "{} of {} bytes", torn.len(), whole.len());
        assert_eq!(frame, expected);
        assert_eq!(fs::read(file).unwrap(), whole);
    }
    // What follows the picture is not read.
    fs::write(file, longer).unwrap();
    assert_eq!(
        asked(folder.path(), &volume, &scene, Wanted::ALL).0,
        expected
    );
}
