//! PNG, WebP and JPEG: the display plane, as near as the format holds it.

use std::fs;
use std::path::Path;

use angioray::extent::ImageSize;
use angioray::frame::{BitDepth, Encoding, Format, Wanted, write};
use angioray::scene::srgb_from_linear;

use super::{METADATA, nothing_hit, picture, picture_rgb8};

fn decode_png(path: &Path) -> (png::Info<'static>, Vec<u8>) {
    let file = std::io::BufReader::new(fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    (reader.info().clone(), bytes)
}

#[test]
fn png_holds_the_display_plane_as_srgb_with_the_metadata() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    write(&path, &picture(), &Encoding::new(Format::Png), &METADATA).unwrap();
    let (info, bytes) = decode_png(&path);
    assert_eq!((info.width, info.height), (5, 3));
    assert_eq!(info.color_type, png::ColorType::Rgb);
    assert_eq!(info.bit_depth, png::BitDepth::Eight);
    assert!(info.srgb.is_some());
    assert_eq!(bytes, picture_rgb8());

    let sixteen = Encoding {
        bit_depth: BitDepth::Sixteen,
        ..Encoding::new(Format::Png)
    };
    write(&path, &picture(), &sixteen, &METADATA).unwrap();
    let (info, bytes) = decode_png(&path);
    assert_eq!(info.bit_depth, png::BitDepth::Sixteen);
    // k/255 is (257 k)/65535: both bytes are k.
    let doubled: Vec<_> = picture_rgb8().iter().flat_map(|k| [*k, *k]).collect();
    assert_eq!(bytes, doubled);
    let texts: Vec<_> = info
        .utf8_text
        .iter()
        .map(|chunk| (chunk.keyword.as_str(), chunk.get_text().unwrap()))
        .collect();
    assert_eq!(texts, METADATA.map(|(key, text)| (key, text.to_owned())));
}

/// A row with a given linear grey at each of 256 pixels, shown through the closed form of
/// IEC 61966-2-1: the byte is the nearest one.
#[test]
fn srgb_levels_are_the_nearest_at_all_256() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ramp.png");
    let size = ImageSize::new(256, 1).unwrap();
    let mut frame = nothing_hit(size, Wanted::ALL);
    let linear = |level: usize| {
        let v = level as f64 / 255.0;
        if v <= 0.04045 {
            v / 12.92
        } else {
            ((v + 0.055) / 1.055).powf(2.4)
        }
    };
    let grey: Vec<_> = (0..256)
        .map(|k| srgb_from_linear(linear(k)) as f32)
        .collect();
    frame.display = Some(grey.iter().map(|v| [*v, *v, *v, 1.0]).collect());
    write(&path, &frame, &Encoding::new(Format::Png), &[]).unwrap();
    let (_, bytes) = decode_png(&path);
    let expected: Vec<_> = (0..=255_u8).flat_map(|k| [k; 3]).collect();
    assert_eq!(bytes, expected);
    // Writing the linear values instead would be seen.
    frame.display = Some((0..256).map(|k| [linear(k) as f32; 4]).collect());
    write(&path, &frame, &Encoding::new(Format::Png), &[]).unwrap();
    assert_ne!(decode_png(&path).1, expected);
}

#[test]
fn webp_is_lossless() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.webp");
    write(&path, &picture(), &Encoding::new(Format::WebP), &[]).unwrap();
    let image = image::load_from_memory(&fs::read(&path).unwrap()).unwrap();
    assert_eq!((image.width(), image.height()), (5, 3));
    assert_eq!(image.to_rgb8().into_raw(), picture_rgb8());
}

#[test]
fn jpeg_follows_its_quality() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.jpg");
    let size = ImageSize::new(64, 64).unwrap();
    let mut frame = nothing_hit(size, Wanted::ALL);
    for (pixel, display) in frame.display.as_mut().unwrap().iter_mut().enumerate() {
        let wave = |f: f32| 0.5 + 0.4 * (pixel as f32 * f).sin();
        *display = [wave(0.11), wave(0.017), wave(0.031), 1.0];
    }
    let encode = |quality| {
        let encoding = Encoding {
            quality,
            ..Encoding::new(Format::Jpeg)
        };
        write(&path, &frame, &encoding, &[]).unwrap();
        let bytes = fs::read(&path).unwrap();
        let decoded = image::load_from_memory(&bytes)
            .unwrap()
            .to_rgb8()
            .into_raw();
        let worst = decoded
            .iter()
            .zip(frame.display.iter().flatten().flat_map(|d| d[..3].to_vec()))
            .map(|(byte, exact)| (f32::from(*byte) / 255.0 - exact).abs())
            .fold(0.0, f32::max);
        (bytes.len(), worst)
    };
    let (small, good, default) = (encode(10), encode(100), encode(Encoding::DEFAULT_QUALITY));
    assert!(small.0 < default.0 && default.0 < good.0);
    assert!(good.1 < 0.02, "{}", good.1);
    assert!(small.1 > 0.05, "{}", small.1);
}
