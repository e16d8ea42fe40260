//! Values far from zero: the same field with an offset is the same picture. And a single slice.

use std::path::Path;

use angioray::extent::Dims;
use angioray::frame::{DEPTH, Frame, KIND};
use angioray::gpu::Device;
use angioray::progress::Silent;
use angioray::scene::Scene;
use angioray::scene::{
    Camera, Lens, Phong, Picture, Projection, Refine, Rgb, SamplingMethod, Window,
};
use angioray::volume::{Geometry, NonFinite, ReadOptions, Rescale, Volume, read, smooth};
use glam::DVec3;

use super::{emission, report, size};
use crate::common::{self, on_device, on_reference, volume_of};

/// Most that depths may be apart, mm.
const NEAR_MM: f64 = 1e-4;
/// Most that colours may be apart, linear light.
const NEAR_COLOR: f32 = 2e-5;

fn case(name: &str) -> Volume {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/cases");
    read(&path.join(name), &ReadOptions::default(), &Silent).unwrap()
}

/// The field of `f64_off….nrrd` without its offset.
fn field(x: f64, y: f64, z: f64) -> f64 {
    3.3 * y + 1.7 * x + 0.4 * z
}

/// Surface, projections and emission of the field, its values moved by `offset`.
fn scenes(volume: &Volume, offset: f64) -> Vec<Scene> {
    let window = Window::new(offset + 10.0, offset + 90.0).unwrap();
    let projection = |of| Picture::Projection { of, window };
    let pictures = [
        Picture::Surface {
            iso: offset + 60.0,
            caps: true,
            refine: Refine::default(),
            color: Rgb([0.9; 3]),
            phong: Some(Phong::default()),
        },
        projection(Projection::Maximum),
        projection(Projection::Minimum),
        projection(Projection::Mean),
        projection(Projection::LocalMaximum {
            threshold: offset + 70.0,
        }),
        emission(&[(offset + 40.0, 0.0), (offset + 80.0, 0.2)], 1.0),
    ];
    let scene = |(at, picture)| {
        let mut scene = common::scene(volume, 24, picture);
        if at < 4 {
            scene.sampling.method = SamplingMethod::Exact;
        }
        scene
    };
    pictures.into_iter().enumerate().map(scene).collect()
}

/// What differs between two frames of what should be one picture.
fn difference(right: &Frame, found: &Frame) -> Option<String> {
    let kinds = common::differing_pixels(right, found);
    let depths = right
        .plane(DEPTH)
        .into_iter()
        .flatten()
        .zip(found.plane(DEPTH).into_iter().flatten());
    let depth = depths
        .filter(|(a, b)| a.is_finite() && b.is_finite())
        .map(|(a, b)| f64::from((a - b).abs()))
        .fold(0.0, f64::max);
    let colors = right
        .color
        .iter()
        .flatten()
        .zip(found.color.iter().flatten());
    let color = colors.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    (kinds > 0 || depth > NEAR_MM || color > NEAR_COLOR)
        .then(|| format!("{kinds} pixels differ, depths by {depth:.1e}, colours by {color:.1e}"))
}

fn hits(frame: &Frame) -> usize {
    frame
        .plane(KIND)
        .into_iter()
        .flatten()
        .filter(|&&kind| kind != 0)
        .count()
}

/// Compares the scenes of two volumes, on the device and by the reference.
fn compare(
    device: &Device,
    name: &str,
    (right, right_offset): (&Volume, f64),
    (found, found_offset): (&Volume, f64),
) -> Vec<String> {
    let (rights, founds) = (scenes(right, right_offset), scenes(found, found_offset));
    let frames = on_device(device, right, &rights);
    let others = on_device(device, found, &founds);
    let mut wrong = Vec::new();
    for (i, (frame, other)) in frames.iter().zip(&others).enumerate() {
        let references = [
            on_reference(right, &rights[i]),
            on_reference(found, &founds[i]),
        ];
        for (by, difference) in [
            ("device", difference(frame, other)),
            ("reference", difference(&references[0], &references[1])),
        ] {
            wrong.extend(difference.map(|d| format!("{name}, scene {i}, {by}: {d}")));
        }
    }
    assert!(hits(&frames[0]) > 100, "{name}: {}", hits(&frames[0]));
    wrong
}

#[test]
fn doubles_with_an_offset_are_the_same_picture() {
    let Some(device) = common::device() else {
        return;
    };
    let near = volume_of([20; 3], |x, y, z| field(x, y, z) as f32);
    let mut wrong = Vec::new();
    for (name, offset) in [("f64_off1e6.nrrd", 1e6), ("f64_off1e9.nrrd", 1e9)] {
        let far = case(name);
        wrong.extend(compare(&device, name, (&near, 0.0), (&far, offset)));
        assert!(far.notes()[0].contains("lose digits as f32 (the file has f64): at most"));
        // Smoothed, the offset is still only an offset.
        let smoothed = [smooth(&near, 1.0, &Silent), smooth(&far, 1.0, &Silent)];
        let [near, far] = smoothed.map(Result::unwrap);
        for i in 0..8000 {
            let at = |volume: &Volume| volume.rescale().physical(volume.voxels().stored(i));
            assert!((at(&far) - offset - at(&near)).abs() < 2e-5, "voxel {i}");
        }
    }
    report(&wrong);
    // The control: single precision alone has steps of 64 at 1e9.
    let coarse = volume_of([20; 3], |x, y, z| (field(x, y, z) + 1e9) as f32);
    assert!(!compare(&device, "coarse", (&near, 0.0), (&coarse, 1e9)).is_empty());
}

#[test]
fn a_calibration_with_a_large_intercept_is_the_same_picture() {
    let Some(device) = common::device() else {
        return;
    };
    let calibrated = |intercept: f64| {
        let voxels: Vec<i16> = (0..8000)
            .map(|i| {
                field(
                    f64::from(i % 20),
                    f64::from(i / 20 % 20),
                    f64::from(i / 400),
                )
            })
            .map(|value| (value * 10.0).round() as i16)
            .collect();
        let rescale = Rescale {
            slope: 0.1,
            intercept,
        };
        let dims = Dims::new([20; 3]).unwrap();
        let geometry = Geometry::default();
        Volume::new(dims, voxels.into(), geometry, rescale, NonFinite::Refuse).unwrap()
    };
    let near = calibrated(0.0);
    let mut wrong = Vec::new();
    for intercept in [-1024.0, 1e6, 1e9] {
        let (far, name) = (calibrated(intercept), format!("intercept {intercept:e}"));
        wrong.extend(compare(&device, &name, (&near, 0.0), (&far, intercept)));
    }
    report(&wrong);
    // The control: another iso value is another picture.
    assert!(!compare(&device, "moved", (&near, 0.0), (&near, 0.5)).is_empty());
}

/// A slice of 0.01 mm, opacity a half of 0.01 mm: 1 − 0.5^(1/cos θ) at any tilt.
#[test]
fn a_single_slice_absorbs_by_the_length_of_the_path_through_it() {
    let Some(device) = common::device() else {
        return;
    };
    let slice = case("thin1.nrrd");
    let (center, _) = slice.bounding_sphere();
    for tilt in [0.0_f64, 30.0, 60.0, 80.0] {
        let toward_eye = DVec3::new(tilt.to_radians().sin(), 0.0, tilt.to_radians().cos());
        let lens = Lens::Orthographic { height_mm: 1e-3 };
        let eye = center + 50.0 * toward_eye;
        let right = 1.0 - 0.5_f64.powf(1.0 / tilt.to_radians().cos());
        let alpha = |frame: &Frame| f64::from(frame.color[0][3]);
        for unit_mm in [0.01, 0.011] {
            let mut scene =
                common::scene(&slice, 1, emission(&[(0.0, 0.5), (255.0, 0.5)], unit_mm));
            scene.camera = Camera::look_at(eye, center, DVec3::Y, lens).unwrap();
            scene.size = size(1, 1);
            let found = [
                alpha(&on_device(&device, &slice, std::slice::from_ref(&scene))[0]),
                alpha(&on_reference(&slice, &scene)),
            ];
            for found in found {
                let is_right = (found - right).abs() < 1e-5;
                // The control: another unit length is another opacity.
                assert_eq!(
                    is_right,
                    unit_mm == 0.01,
                    "{tilt} degrees: {found} for {right}"
                );
            }
        }
    }
}
