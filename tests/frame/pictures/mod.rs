//! Pictures as files: what other decoders read in them, and what happens when they cannot be
//! written.

mod display;
mod layers;
mod metadata;
mod refused;

use std::fs;
use std::path::Path;

use angioray::error::ErrorKind;
use angioray::extent::ImageSize;
use angioray::frame::{
    DEPTH, Encoding, Format, Frame, KIND, Layer, NODES, NORMAL, STEPS, VALUE, Wanted, write,
};

const METADATA: [(&str, &str); 2] = [
    ("scene", "mode = \"iso\"\n# Gefäß, Ω ≥ 300 HU\n"),
    ("version", "0.1.0"),
];

/// A picture in which no ray met anything, with the planes that `wanted` names.
fn nothing_hit(size: ImageSize, wanted: Wanted) -> Frame {
    let mut frame = Frame::blank(size, wanted).unwrap();
    for plane in frame.display.iter_mut() {
        plane.fill([0.0, 0.0, 0.0, 1.0]);
    }
    frame
}

/// 5 x 3 with a different number in every place: two hits, the rest nothing.
fn picture() -> Frame {
    let size = ImageSize::new(5, 3).unwrap();
    let mut frame = nothing_hit(size, Wanted::ALL);
    for (pixel, hit) in [(1, 1.0_f32), (13, 2.0)] {
        frame.color[pixel] = [0.1 * hit, 0.2 * hit, 0.3 * hit, 0.5 * hit];
        frame.plane_mut(DEPTH).unwrap()[pixel] = 123.456 * hit;
        frame.plane_mut(NORMAL).unwrap()[pixel] = [0.6, -0.8, 0.0];
        frame.plane_mut(VALUE).unwrap()[pixel] = -1024.5 * hit;
        frame.plane_mut(STEPS).unwrap()[pixel] = 1000 + pixel as u32;
        frame.plane_mut(NODES).unwrap()[pixel] = 16_777_215;
        frame.plane_mut(KIND).unwrap()[pixel] = 1 + hit as u32;
    }
    for (pixel, display) in frame.display.as_mut().unwrap().iter_mut().enumerate() {
        let level = |add: usize| (((pixel * 17 + add) % 256) as f64 / 255.0) as f32;
        *display = [level(0), level(85), level(170), 1.0];
    }
    frame
}

/// The bytes that [`picture`]'s display plane is made of.
fn picture_rgb8() -> Vec<u8> {
    (0..15)
        .flat_map(|pixel| [0, 85, 170].map(|add| ((pixel * 17 + add) % 256) as u8))
        .collect()
}

fn all_layers(format: Format) -> Encoding {
    Encoding {
        layers: Layer::ALL.to_vec(),
        ..Encoding::new(format)
    }
}

#[test]
fn the_same_picture_is_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let metadata = ["one", "two", "three", "four", "five", "six", "seven"].map(|k| (k, "text"));
    for name in ["a.png", "a.exr", "a.jpg", "a.webp", "a.npy"] {
        let path = folder.path().join(name);
        let format = Format::from_path(&path).unwrap();
        let encoding = if format.carries_layers() {
            all_layers(format)
        } else {
            Encoding::new(format)
        };
        let bytes = || {
            write(&path, &picture(), &encoding, &metadata).unwrap();
            fs::read(&path).unwrap()
        };
        let first = bytes();
        for _ in 0..4 {
            assert!(bytes() == first, "{name}");
        }
        let mut other = picture();
        other.color[0][0] = 0.25;
        other.display.as_mut().unwrap()[0][0] = 1.0;
        write(&path, &other, &encoding, &metadata).unwrap();
        assert!(fs::read(&path).unwrap() != first, "{name}");
    }
}

#[test]
fn formats_go_by_the_extension() {
    let of = |name: &str| Format::from_path(Path::new(name));
    assert_eq!(of("a.b/c.PNG"), Ok(Format::Png));
    assert_eq!(of("c.Jpeg"), Ok(Format::Jpeg));
    assert_eq!(of("c.jpg"), Ok(Format::Jpeg));
    assert_eq!(of("c.exr"), Ok(Format::Exr));
    assert_eq!(of("c.webp"), Ok(Format::WebP));
    assert_eq!(of("frame.png.npy"), Ok(Format::Npy));
    for bad in ["c.bmp", "c", "png", ".png", "c.png.", "", "/", "c.ｐｎｇ"] {
        let error = of(bad).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage, "{bad}");
        let hint = error.hint_text().unwrap();
        for known in [".png", ".exr", ".jpg", ".webp", ".npy"] {
            assert!(hint.contains(known), "{bad}: {hint}");
        }
    }
}

#[test]
fn an_encoding_names_its_planes() {
    let png = Wanted::for_encoding(&Encoding::new(Format::Png), false);
    assert_eq!(png, Wanted::DISPLAY);
    let all = Wanted::for_encoding(&all_layers(Format::Exr), false);
    assert_eq!(all, Wanted::NONE.with(Layer::ALL));
    let counted = Wanted::for_encoding(&Encoding::new(Format::Npy), true);
    let expected = Wanted::NONE.with(Layer::COUNTERS).with([Layer::Kind]);
    assert_eq!(counted, expected);
}
