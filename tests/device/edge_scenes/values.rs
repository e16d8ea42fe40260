//! Voxel values of any magnitude and sign, iso values and transfer functions of any kind.

use angioray::extent::Dims;
use angioray::frame::KIND;
use angioray::scene::{Camera, Lens, Scene};
use angioray::volume::{Geometry, NonFinite, Rescale, Volume, Voxels};
use glam::DVec3;

use super::{Trial, emission, report, size, surface};
use crate::common::Figure::{AlphaMax, DepthP99};
use crate::common::{
    self, assert_sound, differing_pixels, hash, moved_by_a_pixel, on_device, on_reference,
    volume_of,
};

#[test]
fn values_of_any_magnitude() {
    let Some(device) = common::device() else {
        return;
    };
    let mut wrong = Vec::new();
    for scale in [1e-30, 1e-38, 1e30, 3e38, -1e30] {
        let volume = volume_of([9, 8, 7], |x, y, z| (scale * hash(x, y, z)) as f32);
        let trial = Trial {
            device: &device,
            volume: &volume,
            name: format!("{scale:e}"),
        };
        let camera = common::camera(&volume, common::OBLIQUE);
        wrong.extend(trial.failures(&[("oblique".into(), camera, size(17, 17))]));
    }
    report(&wrong);
}

/// A plateau of 100 in the middle, a single voxel of 200, 20 outside.
fn plateau() -> Volume {
    volume_of([12, 13, 11], |x, y, z| {
        if [x, y, z] == [6.0, 6.0, 5.0] {
            200u8
        } else if (3.0..9.0).contains(&x) && (3.0..9.0).contains(&y) && (3.0..8.0).contains(&z) {
            100
        } else {
            20
        }
    })
}

/// The iso value at a voxel's value, a plateau, the ends of the range, beyond them. Caps make what
/// lies at the iso value itself visible.
#[test]
fn iso_values_of_any_kind() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = plateau();
    let trial = Trial {
        device: &device,
        volume: &volume,
        name: "iso".into(),
    };
    let (center, _) = volume.bounding_sphere();
    let cameras = [
        common::camera(&volume, common::OBLIQUE),
        Camera::look_at(
            center + DVec3::Y * 40.0,
            center,
            DVec3::Z,
            Lens::Orthographic { height_mm: 10.0 },
        )
        .unwrap(),
    ];
    let isos = [
        20.0, 20.001, 60.0, 99.999, 100.0, 100.001, 199.999, 200.0, 200.001, 19.999, -1e30, 1e30,
        0.0,
    ];
    let mut scenes = Vec::new();
    for camera in cameras {
        for iso in isos {
            for caps in [true, false] {
                scenes.push((
                    iso,
                    caps,
                    trial.scene(surface(iso, caps), camera, size(31, 31)),
                ));
            }
        }
    }
    let only: Vec<Scene> = scenes.iter().map(|s| s.2.clone()).collect();
    let mut wrong = Vec::new();
    for ((iso, caps, scene), frame) in scenes.iter().zip(on_device(&device, &volume, &only)) {
        let reference = on_reference(&volume, scene);
        assert_sound("iso", &frame);
        let differ = differing_pixels(&reference, &frame);
        let depth = DepthP99.of(&reference, &frame, &volume);
        if differ > 0 || depth > 0.01 {
            wrong.push(format!(
                "iso {iso} caps {caps} {:?}: {differ} pixels, depth {depth}",
                scene.camera.lens()
            ));
        }
        let hits = reference
            .plane(KIND)
            .into_iter()
            .flatten()
            .filter(|k| **k != 0)
            .count();
        // By definition: nothing above the maximum, nothing changes sign at or below the minimum.
        if *iso > 200.0 || (*iso <= 20.0 && !caps) {
            assert_eq!(hits, 0, "iso {iso} caps {caps}");
        } else if *iso < 199.0 {
            assert!(hits > 0, "iso {iso} caps {caps}");
        }
        if *iso == 60.0 {
            assert!(differing_pixels(&reference, &moved_by_a_pixel(&frame)) > 0);
        }
    }
    report(&wrong);
}

#[test]
fn transfer_functions_of_any_kind() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = volume_of([12, 13, 11], |x, y, z| {
        (20.0 * x + 3.0 * y + 2.0 * (z * 0.7).sin() * z) as u8
    });
    let trial = Trial {
        device: &device,
        volume: &volume,
        name: "transfer".into(),
    };
    let camera = common::camera(&volume, common::OBLIQUE);
    // Name, points, unit length, limit of opacity. An opaque mm absorbs 13.8: rays that graze an
    // edge of the volume feel a path that is wrong by a millionth of it.
    type Case<'a> = (&'a str, &'a [(f64, f64)], f64, f64);
    let cases: [Case; 11] = [
        ("transparent", &[(0.0, 0.0), (255.0, 0.0)], 1.0, 0.0),
        ("one clear knot", &[(50.0, 0.0)], 1.0, 0.0),
        ("opaque", &[(0.0, 1.0), (255.0, 1.0)], 1.0, 1e-4),
        ("opaque at once", &[(50.0, 1.0)], 1e-6, 1e-6),
        ("one knot", &[(50.0, 0.1)], 2.0, 1e-5),
        ("faint", &[(50.0, 1e-6)], 1.0, 1e-8),
        ("beyond the range", &[(1e6, 0.0), (2e6, 1.0)], 1.0, 0.0),
        ("below the range", &[(-2e6, 1.0), (-1e6, 0.2)], 4.0, 1e-5),
        ("a ramp", &[(0.0, 0.0), (255.0, 0.3)], 1.0, 0.001),
        ("a jump", &[(120.0, 0.0), (120.0, 0.3)], 4.0, 0.01),
        (
            "stairs",
            &[
                (60.0, 0.0),
                (60.0, 0.1),
                (120.0, 0.1),
                (120.0, 0.3),
                (180.0, 0.3),
                (180.0, 0.05),
            ],
            4.0,
            0.01,
        ),
    ];
    let scenes = cases
        .map(|(_, knots, unit_mm, _)| trial.scene(emission(knots, unit_mm), camera, size(25, 25)));
    let frames = on_device(&device, &volume, &scenes);
    let mut wrong = Vec::new();
    for (((name, _, _, limit), scene), frame) in cases.iter().zip(&scenes).zip(&frames) {
        let reference = on_reference(&volume, scene);
        assert_sound(name, frame);
        let measured = AlphaMax.of(&reference, frame, &volume);
        println!("{name}: {measured:.2e}");
        if measured > *limit {
            wrong.push(format!("{name}: {measured:.3e} > {limit}"));
        }
        // Where there is something to see, a pixel's move is seen.
        if *limit > 0.0 {
            assert!(
                AlphaMax.of(&reference, &moved_by_a_pixel(frame), &volume) > *limit,
                "{name}"
            );
        }
    }
    report(&wrong);
}

/// Negative and mixed values: physical 0 is nothing special.
#[test]
fn denormal_and_signed_values() {
    let Some(device) = common::device() else {
        return;
    };
    let mut wrong = Vec::new();
    for (name, low, high) in [
        ("denormal", 1e-42, 1e-40),
        ("signed", -1.0, 1.0),
        ("shifted", 1e6, 1e6 + 64.0),
    ] {
        let voxels: Vec<f32> = (0..9 * 8 * 7)
            .map(|i| {
                (low + (high - low)
                    * hash(f64::from(i % 9), f64::from(i / 9 % 8), f64::from(i / 72)))
                    as f32
            })
            .collect();
        let volume = Volume::new(
            Dims::new([9, 8, 7]).unwrap(),
            Voxels::from(voxels),
            Geometry::default(),
            Rescale::IDENTITY,
            NonFinite::Refuse,
        )
        .unwrap();
        let trial = Trial {
            device: &device,
            volume: &volume,
            name: name.into(),
        };
        let camera = common::camera(&volume, common::OBLIQUE);
        wrong.extend(trial.failures(&[("oblique".into(), camera, size(17, 17))]));
    }
    report(&wrong);
}
