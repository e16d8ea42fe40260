//! Signed error maps against pictures whose difference is known, decoded from their files.

use std::fs::File;
use std::io::Cursor;
use std::path::PathBuf;

use angioray::extent::ImageSize;
use angioray::frame::error::{
    Entry, ErrorMap, Quantity, Scale, color_error, depth_error, normal_error, value_error,
};
use angioray::frame::palette::{Rgb, cool_warm};
use angioray::frame::{DEPTH, Frame, Layers, NORMAL, VALUE, read_metadata};
use exr::prelude::{FlatSamples, read_first_flat_layer_from_file};

const INF: f32 = f32::INFINITY;
const SCALE: Scale = Scale {
    smallest_spacing_mm: 0.5,
    range_width: 200.0,
};
const BLUE: Rgb = [59, 76, 192];
const GREY: Rgb = [221, 221, 221];
const RED: Rgb = [180, 4, 38];

/// A row of pixels that nothing was hit in.
fn row(width: usize) -> Frame {
    let mut layers = Layers::default();
    layers.insert(DEPTH, vec![INF; width]);
    layers.insert(NORMAL, vec![[0.0; 3]; width]);
    layers.insert(VALUE, vec![0.0; width]);
    Frame {
        size: ImageSize::new(width as u32, 1).unwrap(),
        color: vec![[0.0; 4]; width],
        display: Some(vec![[0.0, 0.0, 0.0, 1.0]; width]),
        layers,
    }
}

fn with_depth(depth: &[f32]) -> Frame {
    let mut frame = row(depth.len());
    frame.layers.insert(DEPTH, depth.to_vec());
    frame
}

fn map(quantity: Quantity, reference: &Frame, frame: &Frame) -> ErrorMap {
    ErrorMap::new(quantity, reference, frame, SCALE).unwrap()
}

fn differences(map: &ErrorMap) -> Vec<Option<f64>> {
    map.entries.iter().map(|e| e.difference()).collect()
}

/// The picture's size and R, G, B, by the PNG's own decoder.
fn decoded(png: &[u8]) -> (u32, u32, Vec<Rgb>) {
    let mut reader = png::Decoder::new(Cursor::new(png)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgb);
    assert_eq!(info.bit_depth, png::BitDepth::Eight);
    let pixels = bytes.chunks_exact(3).map(|c| [c[0], c[1], c[2]]);
    (info.width, info.height, pixels.collect())
}

fn temporary(name: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    (folder, path)
}

/// Depths in mm, voxels of 0.5 mm: nearer, equal, farther; missed, extra, nothing.
fn depths() -> ErrorMap {
    let reference = with_depth(&[10.0, 10.0, 10.0, 10.0, 10.0, INF, INF]);
    let other = with_depth(&[9.0, 10.0, 10.5, 11.0, INF, 7.0, INF]);
    map(Quantity::Depth, &reference, &other)
}

#[test]
fn depths_are_signed_voxels_and_hits_of_one_picture_are_marked() {
    let map = depths();
    assert_eq!(
        map.entries,
        [
            Entry::Difference(-2.0),
            Entry::Difference(0.0),
            Entry::Difference(1.0),
            Entry::Difference(2.0),
            Entry::Missed,
            Entry::Extra,
            Entry::Nothing,
        ]
    );
    assert_eq!((map.scale, map.largest()), (2.0, Some(2.0)));
    assert_eq!(map.quantity.unit(), "voxels");
    let (width, height, pixels) = decoded(&map.png().unwrap());
    assert_eq!((width, height), (7, 1));
    assert_eq!(
        pixels,
        [
            BLUE,
            GREY,
            [244, 154, 123],
            RED,
            [0, 0, 0],
            [255, 213, 0],
            [119, 119, 119]
        ]
    );
    // The other way round it is the other way round.
    let reference = with_depth(&[9.0, INF]);
    let swapped = self::map(Quantity::Depth, &reference, &with_depth(&[10.0, 3.0]));
    assert_eq!(swapped.entries, [Entry::Difference(2.0), Entry::Extra]);
}

#[test]
fn colours_are_how_much_brighter_the_pixel_is() {
    let (mut reference, mut other) = (row(4), row(4));
    let set = |frame: &mut Frame, pixel: usize, rgb: [f32; 3]| {
        frame.display.as_mut().unwrap()[pixel] = [rgb[0], rgb[1], rgb[2], 1.0];
    };
    set(&mut reference, 0, [0.5, 0.5, 0.5]);
    set(&mut other, 0, [0.75, 0.5, 0.5]);
    set(&mut reference, 1, [0.5, 0.25, 0.0]);
    set(&mut other, 1, [0.25, 0.0, 0.0]);
    // Two changes that cancel each other.
    set(&mut other, 2, [0.25, 0.0, 0.0]);
    set(&mut reference, 2, [0.0, 0.25, 0.0]);
    let map = map(Quantity::Color, &reference, &other);
    let expected = [0.25 / 3.0, -0.5 / 3.0, 0.0, 0.0].map(Some);
    assert_eq!(differences(&map), expected);
    assert_eq!(map.scale, 0.5 / 3.0);
    let (_, _, pixels) = decoded(&map.png().unwrap());
    assert_eq!(pixels, [[244, 154, 123], BLUE, GREY, GREY]);
}

#[test]
fn values_are_shares_of_the_range_where_both_cover() {
    let (mut reference, mut other) = (row(4), row(4));
    for (frame, pixels, value) in [(&mut reference, 0..3, 100.0), (&mut other, 1..4, 90.0)] {
        for pixel in pixels {
            frame.color[pixel][3] = 1.0;
            frame.plane_mut(VALUE).unwrap()[pixel] = value;
        }
    }
    other.plane_mut(VALUE).unwrap()[2] = 100.0;
    let map = map(Quantity::Value, &reference, &other);
    assert_eq!(
        map.entries,
        [
            Entry::Missed,
            Entry::Difference(-0.05),
            Entry::Difference(0.0),
            Entry::Extra
        ]
    );
}

#[test]
fn angles_have_no_sign_and_run_from_grey_to_red() {
    let (mut reference, mut other) = (row(4), row(4));
    let x = [1.0, 0.0, 0.0];
    reference.layers.insert(NORMAL, vec![x, x, x, [0.0; 3]]);
    let turned = vec![x, [1.0, -1.0, 0.0], [0.0, 0.0, 1.0], x];
    other.layers.insert(NORMAL, turned);
    let map = map(Quantity::Normal, &reference, &other);
    let expected = [Some(0.0), Some(45.0), Some(90.0), None];
    for (angle, expected) in differences(&map).into_iter().zip(expected) {
        assert!((angle.unwrap_or(-1.0) - expected.unwrap_or(-1.0)).abs() < 1e-9);
    }
    assert_eq!(map.entries[3], Entry::Extra);
    let (_, _, pixels) = decoded(&map.png().unwrap());
    assert_eq!(pixels[..3], [GREY, [244, 154, 123], RED]);
    let stops = map.palette_stops();
    assert_eq!(stops[0], (0.0, GREY));
    assert_eq!(stops[stops.len() - 1], (1.0, RED));
}

#[test]
fn a_bar_shows_the_colours_of_the_map() {
    let map = depths();
    let stops = map.palette_stops();
    assert_eq!(stops[0], (0.0, BLUE));
    assert_eq!(stops[32], (0.5, GREY));
    assert_eq!(stops[64], (1.0, RED));
    for (position, color) in &stops {
        assert_eq!(*color, cool_warm(2.0 * position - 1.0));
    }
    // Between stops a browser interpolates in sRGB: within 2 levels of the map's colours.
    for pair in stops.windows(2) {
        let [a, b] = [pair[0].1, pair[1].1].map(|color| color.map(f64::from));
        let middle = cool_warm(pair[0].0 + pair[1].0 - 1.0);
        for channel in 0..3 {
            let shown = (a[channel] + b[channel]) / 2.0;
            assert!(
                (shown - f64::from(middle[channel])).abs() <= 2.0,
                "{pair:?}"
            );
        }
    }
}

#[test]
fn a_few_outliers_or_a_few_differences_do_not_set_the_scale() {
    // One of 200 differences is huge, a thousand pixels are equal.
    let reference = with_depth(&[10.0; 1200]);
    let mut depths = vec![10.0_f32; 1200];
    depths[..200].fill(10.5);
    depths[7] = 1000.0;
    let map = map(Quantity::Depth, &reference, &with_depth(&depths));
    assert_eq!((map.scale, map.largest()), (1.0, Some(1980.0)));
    let (_, _, pixels) = decoded(&map.png().unwrap());
    assert_eq!((pixels[7], pixels[8], pixels[300]), (RED, RED, GREY));

    // To another scale the same differences look smaller.
    let wider = map.clone().with_scale(2.0).unwrap();
    assert_eq!(wider.entries, map.entries);
    let (_, _, pixels) = decoded(&wider.png().unwrap());
    assert_eq!((pixels[7], pixels[8]), (RED, [244, 154, 123]));
    for bad in [0.0, -1.0, f64::NAN, INF.into()] {
        assert!(map.clone().with_scale(bad).is_err(), "{bad}");
    }
}

#[test]
fn equal_pictures_are_grey_and_empty_ones_show_nothing() {
    let hit = with_depth(&[1.0, 2.0]);
    let equal = map(Quantity::Depth, &hit, &hit);
    assert_eq!((equal.scale, equal.largest()), (0.01, Some(0.0)));
    assert_eq!(decoded(&equal.png().unwrap()).2, [GREY; 2]);
    let empty = map(Quantity::Depth, &row(2), &row(2));
    assert_eq!((empty.scale, empty.largest()), (0.01, None));
    assert_eq!(decoded(&empty.png().unwrap()).2, [[119, 119, 119]; 2]);
}

/// What rounding leaves is not shown unless it is requested.
#[test]
fn rounding_does_not_fill_a_map() {
    let reference = with_depth(&[10.0; 3]);
    let map = map(
        Quantity::Depth,
        &reference,
        &with_depth(&[10.0_f32.next_up(); 3]),
    );
    assert!(map.largest().unwrap() > 0.0);
    assert_eq!(decoded(&map.png().unwrap()).2, [GREY; 3]);
    let closer = map.with_scale(1e-6).unwrap();
    assert_eq!(decoded(&closer.png().unwrap()).2, [RED; 3]);
}

#[test]
fn files_hold_what_the_map_says() {
    let map = depths();
    let (_folder, path) = temporary("map.png");
    map.write_png(&path).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), map.png().unwrap());

    let path = path.with_extension("exr");
    map.write_exr(&path).unwrap();
    let image = read_first_flat_layer_from_file(&path).unwrap();
    let channels = &image.layer_data.channel_data.list;
    let found: Vec<_> = channels
        .iter()
        .map(|channel| {
            let FlatSamples::F32(samples) = &channel.sample_data else {
                panic!("{} is not 32-bit float", channel.name)
            };
            (channel.name.to_string(), samples.clone())
        })
        .collect();
    let error = vec![-2.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0];
    let state = vec![1.0, 1.0, 1.0, 1.0, 2.0, 3.0, 0.0];
    assert_eq!(
        found,
        [("error.V".to_owned(), error), ("state.V".to_owned(), state)]
    );
    let metadata = read_metadata(&path).unwrap();
    for pair in [("quantity", "depth"), ("unit", "voxels")] {
        assert!(
            metadata.contains(&(pair.0.to_owned(), pair.1.to_owned())),
            "{metadata:?}"
        );
    }
    // A folder that is not there leaves nothing behind and is named.
    let nowhere = path.with_file_name("nowhere").join("map.exr");
    for failed in [map.write_exr(&nowhere), map.write_png(&nowhere)] {
        assert!(failed.unwrap_err().to_string().contains("nowhere"));
    }
    assert!(File::open(&nowhere).is_err());
}

/// The map and the figures are of the same differences.
#[test]
fn maps_agree_with_the_figures() {
    let (mut reference, mut other) = (row(300), row(300));
    for pixel in 0..300_usize {
        let (a, b) = ((pixel * 37 % 101) as f32, (pixel * 53 % 97) as f32);
        reference.display.as_mut().unwrap()[pixel] = [a / 101.0; 4];
        other.display.as_mut().unwrap()[pixel] = [b / 97.0; 4];
        for (frame, v, gap) in [(&mut reference, a, 5), (&mut other, b, 7)] {
            if pixel % gap != 0 {
                frame.color[pixel][3] = 1.0;
                frame.plane_mut(DEPTH).unwrap()[pixel] = 100.0 + v;
                frame.plane_mut(VALUE).unwrap()[pixel] = v;
                frame.plane_mut(NORMAL).unwrap()[pixel] = [v, 100.0, 0.0];
            }
        }
    }
    let count = |map: &ErrorMap, which| map.entries.iter().filter(|&&e| e == which).count() as u64;
    let largest = |quantity| map(quantity, &reference, &other).largest();
    // Of grey pictures the mean of three equal differences is one of them.
    let color = color_error(&reference, &other).unwrap();
    assert!((largest(Quantity::Color).unwrap() - color.max).abs() < 1e-15);
    let depth = depth_error(&reference, &other, SCALE.smallest_spacing_mm).unwrap();
    assert_eq!(largest(Quantity::Depth), depth.max);
    let value = value_error(&reference, &other, SCALE.range_width).unwrap();
    assert_eq!(largest(Quantity::Value), value.max);
    let normal = normal_error(&reference, &other).unwrap();
    assert!(largest(Quantity::Normal) >= normal.p99_deg);
    for quantity in [Quantity::Depth, Quantity::Value, Quantity::Normal] {
        let map = map(quantity, &reference, &other);
        assert_eq!(count(&map, Entry::Missed), depth.missed);
        assert_eq!(count(&map, Entry::Extra), depth.extra);
    }
    assert!(depth.missed > 0 && depth.extra > 0 && depth.missed != depth.extra);
}

#[test]
fn what_cannot_be_mapped_is_an_error() {
    let good = row(4);
    let all = [
        Quantity::Color,
        Quantity::Depth,
        Quantity::Normal,
        Quantity::Value,
    ];
    let bare = Frame {
        display: None,
        layers: Layers::default(),
        ..good.clone()
    };
    let mut bad = good.clone();
    bad.display.as_mut().unwrap()[2][1] = f32::NAN;
    bad.plane_mut(DEPTH).unwrap()[2] = f32::NAN;
    bad.plane_mut(NORMAL).unwrap()[2][0] = f32::NAN;
    bad.plane_mut(VALUE).unwrap()[2] = f32::NAN;
    for quantity in all {
        let of = |a: &Frame, b: &Frame| ErrorMap::new(quantity, a, b, SCALE);
        assert!(of(&good, &good).is_ok());
        assert!(of(&good, &row(5)).is_err() && of(&bare, &good).is_err());
        for outcome in [of(&good, &bad), of(&bad, &good)] {
            let message = outcome.unwrap_err().to_string();
            assert!(message.contains("pixel 2,0"), "{message}");
        }
        let mut short = of(&good, &good).unwrap();
        short.entries.pop();
        assert!(short.png().is_err());
    }
}
