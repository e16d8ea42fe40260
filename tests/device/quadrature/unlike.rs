//! Volumes of strongly unlike spacings: dvr's default takes the rule that has no steps, which keeps its
//! bound there at a cost that does not grow with the ratio.

use angioray::extent::ImageSize;
use angioray::frame::STEPS;
use angioray::options::SceneOptions;
use angioray::scene::{Camera, Lens, Picture, Quadrature, QuadratureMethod, Scene};
use angioray::volume::{Geometry, Volume};
use angioray::{Content, Sphere, Subject};
use glam::{DMat3, DVec3};

use crate::common::{self, hash, on_device, on_reference, volume_with};

/// A ball in faint noise, whatever the spacing.
fn ball(dims: [u64; 3], spacing_mm: [f64; 3]) -> Volume {
    let geometry = Geometry::new(DVec3::ZERO, DMat3::IDENTITY, spacing_mm.into()).unwrap();
    let middle = DVec3::from_array(dims.map(|n| 0.5 * (n as f64 - 1.0)));
    volume_with(dims, geometry, |x, y, z| {
        let off = (DVec3::new(x, y, z) - middle) / middle;
        (230.0 * (1.2 - off.length()).clamp(0.0, 1.0) + 20.0 * hash(x, y, z)) as u8
    })
}

fn subject(volume: &Volume) -> Subject {
    let sphere = Sphere::from(volume.bounding_sphere());
    let range = volume.range();
    Subject {
        sphere,
        content: Content::around(sphere),
        spacing_mm: volume.geometry().spacing_mm(),
        range,
        robust_range: range,
        otsu: range.at(0.5),
        suggested_iso: range.at(0.5),
    }
}

/// What the default makes of the volume, seen along the axis of its largest spacing, a little aslant, in
/// orthographic projection; and its notes. The transfer function's unit is a tenth of the path.
fn scene(volume: &Volume, toward: DVec3, height_mm: f64, more: &str) -> (Scene, Vec<String>) {
    let (center, radius_mm) = volume.bounding_sphere();
    let unit_mm = 0.1 * radius_mm;
    let text = format!(
        "mode = 'dvr'\n{more}\n[tf]\nunit_length_mm = {unit_mm:?}\npoints = [[40, 0.1, 0.2, 0.9, 0], [150, 0.9, 0.7, 0.1, 0.3], [255, 1, 1, 1, 0.8]]\n"
    );
    let options = SceneOptions::parse(&text, "scene").unwrap();
    let resolved = options
        .checked()
        .unwrap()
        .resolve(&subject(volume))
        .unwrap();
    let mut scene = resolved.scene;
    scene.size = ImageSize::new(24, 24).unwrap();
    let eye = center - toward.normalize() * (3.0 * radius_mm);
    let up = toward.any_orthonormal_vector();
    let lens = Lens::Orthographic { height_mm };
    scene.camera = Camera::look_at(eye, center, up, lens).unwrap();
    (scene, resolved.notes)
}

fn quadrature(scene: &Scene) -> Quadrature {
    match &scene.picture {
        Picture::Emission(emission) => emission.quadrature,
        other => panic!("{other:?}"),
    }
}

/// Samples of a ray on the mean; and the largest error of a channel.
fn measured(volume: &Volume, scene: &Scene) -> Option<(f64, f64)> {
    let device = common::device()?;
    let frame = &on_device(&device, volume, std::slice::from_ref(scene))[0];
    let reference = on_reference(volume, scene);
    assert!(reference.color.iter().any(|c| c[3] > 0.5), "nothing to see");
    let pairs = reference
        .color
        .iter()
        .flatten()
        .zip(frame.color.iter().flatten());
    let error = pairs.fold(0.0, |max, (a, b)| f64::max(max, f64::from((a - b).abs())));
    let samples: u64 = frame
        .plane(STEPS)
        .into_iter()
        .flatten()
        .map(|&n| u64::from(n))
        .sum();
    Some((samples as f64 / frame.size.pixels() as f64, error))
}

/// A volume, the direction of view and the height of the picture.
fn cases() -> Vec<(&'static str, Volume, DVec3, f64)> {
    let flat = ball([32, 32, 32], [1e-4, 1.0, 1.0]);
    let tall = ball([24, 24, 24], [1.0, 1.0, 500.0]);
    let thin = ball([16, 16, 16], [0.01, 1.0, 0.2]);
    vec![
        ("1:10^4", flat, DVec3::new(1e-7, 1.0, 0.02), 4e-3),
        ("1:1:500", tall, DVec3::new(1e-4, 2e-4, 1.0), 30.0),
        ("aslant", thin, DVec3::new(1e-3, 1.0, 0.3), 0.2),
    ]
}

/// More samples than a ray with this bound needs in any of the cases; fixed steps take ten times as many at
/// least.
const MAX_SAMPLES: f64 = 1500.0;

#[test]
fn the_default_keeps_its_bound_at_a_cost_that_does_not_grow_with_the_ratio() {
    for (name, volume, toward, height_mm) in cases() {
        let (scene, notes) = scene(&volume, toward, height_mm, "");
        let adaptive = Quadrature::of(QuadratureMethod::Adaptive);
        let unlike = name != "aslant";
        assert_eq!(quadrature(&scene) == adaptive, unlike, "{name}");
        assert_eq!(
            notes.iter().any(|note| note.contains("samples per ray")),
            unlike,
            "{name}: {notes:?}"
        );
        let Some((samples, error)) = measured(&volume, &scene) else {
            return;
        };
        println!("| {name} | {samples:.0} | {error:.1e} |");
        if unlike {
            assert!(error <= adaptive.bound(), "{name}: {error}");
            assert!(samples < MAX_SAMPLES, "{name}: {samples}");
        }
    }
}

#[test]
fn requested_steps_are_taken_and_their_cost_is_reported() {
    let (_, volume, toward, height_mm) = cases().swap_remove(1);
    for more in [
        "quad = 'simpson'",
        "step = 0.5",
        "sampling = 'fixed'",
        "homogeneity = 0.01",
        "voxels = 'filtered'",
    ] {
        let (scene, notes) = scene(&volume, toward, height_mm, more);
        assert!(quadrature(&scene).is_stepped(), "{more}");
        let reported: Vec<_> = notes
            .iter()
            .filter(|n| n.contains("samples per ray"))
            .collect();
        assert!(
            reported.len() == 1 && reported[0].contains("in all: --quad adaptive"),
            "{more}: {notes:?}"
        );
    }
    // The controls: coarse steps cost little; the adaptive rule takes none; and fixed steps do cost that.
    let (coarse, notes) = scene(&volume, toward, height_mm, "step = 20");
    assert!(
        quadrature(&coarse).is_stepped() && !notes.iter().any(|n| n.contains("per ray")),
        "{notes:?}"
    );
    let (_, notes) = scene(&volume, toward, height_mm, "quad = 'adaptive:1e-4'");
    assert!(!notes.iter().any(|n| n.contains("per ray")), "{notes:?}");
    let (stepped, _) = scene(&volume, toward, height_mm, "step = 2");
    if let Some((samples, _)) = measured(&volume, &stepped) {
        assert!(samples > 3.0 * MAX_SAMPLES, "{samples}");
    }
}

/// Beyond what steps can be counted in, where only a rule without them has a picture.
#[test]
fn ratios_beyond_any_step_have_a_picture() {
    let volume = ball([16, 16, 16], [1e-7, 1.0, 1.0]);
    let (scene, _) = scene(&volume, DVec3::new(1.0, 0.3, 0.2), 40.0, "");
    let Some(device) = common::device() else {
        return;
    };
    let frame = &on_device(&device, &volume, std::slice::from_ref(&scene))[0];
    let reference = on_reference(&volume, &scene);
    let pairs = reference
        .color
        .iter()
        .flatten()
        .zip(frame.color.iter().flatten());
    assert!(pairs.fold(0.0, |max, (a, b)| f32::max(max, (a - b).abs())) < 1e-3);
}
