//! What cannot be written: a sentence, and no file left behind.

use std::fs;
use std::path::{Path, PathBuf};

use angioray::extent::ImageSize;
use angioray::frame::{BitDepth, DEPTH, Encoding, Format, Layer, Wanted, write};

use super::{METADATA, all_layers, nothing_hit, picture};

fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn webp_reports_what_it_cannot_hold() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.webp");
    let size = ImageSize::new(16_384, 1).unwrap();
    let wide = nothing_hit(size, Wanted::ALL);
    let error = write(&path, &wide, &Encoding::new(Format::WebP), &[]).unwrap_err();
    assert!(error.to_string().contains("16383 pixels"), "{error}");
    assert_eq!(names_in(folder.path()), [""; 0]);
    let size = ImageSize::new(16_383, 1).unwrap();
    let fits = nothing_hit(size, Wanted::ALL);
    write(&path, &fits, &Encoding::new(Format::WebP), &[]).unwrap();
}

#[test]
fn what_a_format_cannot_do_is_wrong_usage_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        all_layers(Format::Png),
        Encoding {
            bit_depth: BitDepth::Sixteen,
            ..Encoding::new(Format::Jpeg)
        },
        Encoding {
            quality: 0,
            ..Encoding::new(Format::Jpeg)
        },
        Encoding {
            quality: 101,
            ..Encoding::new(Format::Jpeg)
        },
    ];
    for encoding in cases {
        let path = folder.path().join("a.out");
        let error = write(&path, &picture(), &encoding, &[]).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{error}");
    }
    assert_eq!(names_in(folder.path()), [""; 0]);
}

#[test]
fn a_frame_without_the_plane_is_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let size = ImageSize::new(4, 4).unwrap();
    let bare = nothing_hit(size, Wanted::NONE);
    for format in [Format::Png, Format::Jpeg, Format::WebP] {
        let path = folder.path().join("a");
        let error = write(&path, &bare, &Encoding::new(format), &[]).unwrap_err();
        assert!(error.to_string().contains("display"), "{error}");
    }
    for layer in Layer::ALL {
        for format in [Format::Exr, Format::Npy] {
            let path = folder.path().join("a");
            let encoding = Encoding {
                layers: vec![layer],
                ..Encoding::new(format)
            };
            let outcome = write(&path, &bare, &encoding, &[]);
            if layer == Layer::Cast {
                // Needs no plane.
                outcome.unwrap();
                fs::remove_file(&path).unwrap();
            } else {
                let message = outcome.unwrap_err().to_string();
                assert!(message.contains(layer.name()), "{message}");
            }
            // What the encoding needs is enough.
            let wanted = Wanted::for_encoding(&encoding, false);
            write(&path, &nothing_hit(size, wanted), &encoding, &[]).unwrap();
            fs::remove_file(&path).unwrap();
        }
    }
    assert_eq!(names_in(folder.path()), [""; 0]);

    let mut short = picture();
    let mut depths = short.layers.take(DEPTH).unwrap();
    depths.pop();
    short.layers.insert(DEPTH, depths);
    let path = folder.path().join("a.exr");
    let error = write(&path, &short, &all_layers(Format::Exr), &[]).unwrap_err();
    assert!(
        error.to_string().contains("depth plane has 14 entries"),
        "{error}"
    );
}

#[test]
fn unwritable_places_leave_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::write(root.join("file"), "x").unwrap();
    fs::create_dir(root.join("taken")).unwrap();
    for name in ["a.png", "a.exr", "a.jpg", "a.webp", "a.npy"] {
        let encoding = Encoding::new(Format::from_path(Path::new(name)).unwrap());
        let places = [
            root.join("missing").join(name),
            root.join("file").join(name),
            root.join("taken"),
        ];
        for path in places {
            let error = write(&path, &picture(), &encoding, &METADATA).unwrap_err();
            assert_eq!(error.exit_code(), 74);
            let message = error.to_string();
            assert!(message.starts_with(path.to_str().unwrap()), "{message}");
            assert!(!message.contains('\n'), "{message}");
        }
        // A full disk.
        let full = PathBuf::from("/dev/full");
        if full.exists() {
            let error = write(&full, &picture(), &encoding, &METADATA).unwrap_err();
            assert!(
                error.to_string().starts_with("/dev/full: cannot write"),
                "{error}"
            );
        }
    }
    assert_eq!(names_in(root), ["file", "taken"]);
    assert_eq!(names_in(&root.join("taken")), [""; 0]);
    assert_eq!(fs::read(root.join("file")).unwrap(), b"x");
}
