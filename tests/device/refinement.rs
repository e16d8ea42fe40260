//! The refiners against closed-form roots: rows of voxels whose profile crosses the iso value once,
//! compared along the rows.

use crate::common;

use angioray::extent::ImageSize;
use angioray::frame::{DEPTH, STEPS, Wanted};
use angioray::render::{Options, Renderer};
use angioray::scene::{
    Camera, Gradient, Lens, Light, Picture, Refine, RefineMethod, Rgb, Sampling, SamplingMethod,
    Scene, StepVoxels, Tone,
};
use angioray::volume::Volume;
use common::volume_of;
use glam::DVec3;

const ROWS: u32 = 64;
const ISO: f64 = 10.0;
/// Longer than a voxel: a bracket holds a kink or two.
const STEP_VOXELS: f64 = 1.7;

/// A voxel's value by its x and row.
type Profile = fn(f64, f64) -> f64;

/// Flat, then a knee at a voxel of its own, then ever steeper: chords stall at one end.
fn knee(x: f64, y: f64) -> f64 {
    let knee = 7.0 + (y * 0.37) % 11.0;
    let beyond = (x - knee).max(0.0);
    y * 0.1 + beyond * 3.0 + beyond.powi(4) * (1.0 + y)
}

/// Ever so slightly bent.
fn gentle(x: f64, y: f64) -> f64 {
    x * (0.6 + 0.01 * y) + 0.01 * x * x
}

/// Where the piecewise linear row crosses the iso value, in voxels from x = 0.
fn root(profile: Profile, y: f64) -> f64 {
    let after = (0..)
        .find(|&x| f64::from(profile(f64::from(x), y) as f32) >= ISO)
        .unwrap();
    let (a, b) = (
        f64::from(profile(f64::from(after - 1), y) as f32),
        f64::from(profile(f64::from(after), y) as f32),
    );
    f64::from(after - 1) + (ISO - a) / (b - a)
}

fn rows(profile: Profile) -> Volume {
    volume_of([32, u64::from(ROWS), 1], |x, y, _| profile(x, y) as f32)
}

/// Distance of each row's hit from its root in voxels, and the samples taken in all.
fn errors(renderer: &mut Renderer, profile: Profile, refine: Refine) -> (Vec<f64>, u64) {
    // One pixel per row, the eye 10 mm before x = 0; row 0 of the image is the highest y.
    let lens = Lens::Orthographic {
        height_mm: f64::from(ROWS),
    };
    let middle = DVec3::new(0.0, f64::from(ROWS - 1) / 2.0, 0.0);
    let camera = Camera::look_at(middle - DVec3::X * 10.0, middle, DVec3::Y, lens).unwrap();
    let scene = Scene {
        size: ImageSize::new(1, ROWS).unwrap(),
        camera,
        picture: Picture::Surface {
            iso: ISO,
            caps: false,
            refine,
            color: Rgb([1.0; 3]),
            phong: None,
        },
        clip_planes: Vec::new(),
        sampling: Sampling {
            method: SamplingMethod::Fixed,
            step: StepVoxels::new(STEP_VOXELS).unwrap(),
            ..Sampling::default()
        },
        lights: vec![Light::default()],
        gradient: Gradient::default(),
        anti_aliasing: Default::default(),
        sparse: None,
        ambient_occlusion: None,
        shadows: None,
        depth_of_field: None,
        depth_cues: None,
        tone: Tone::default(),
    };
    let frame = renderer.render(&scene, Wanted::ALL).unwrap().frame;
    let depth_mm = frame.plane(DEPTH).unwrap();
    let errors = depth_mm
        .iter()
        .enumerate()
        .map(|(row, &depth_mm)| {
            (f64::from(depth_mm) - 10.0 - root(profile, f64::from(ROWS - 1) - row as f64)).abs()
        })
        .collect();
    (
        errors,
        frame
            .plane(STEPS)
            .unwrap()
            .iter()
            .map(|&n| u64::from(n))
            .sum(),
    )
}

fn worst(errors: &[f64]) -> f64 {
    errors
        .iter()
        .fold(0.0, |max, &e| if e > max || e.is_nan() { e } else { max })
}

fn mean(errors: &[f64]) -> f64 {
    errors.iter().sum::<f64>() / errors.len() as f64
}

#[test]
fn bisection_and_regula_falsi_stay_within_their_bound() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = rows(knee);
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let mut with = |method, iterations| {
        errors(
            &mut renderer,
            knee,
            Refine::new(method, iterations).unwrap(),
        )
    };

    let (unrefined, unrefined_samples) = with(RefineMethod::None, 0);
    assert!(worst(&unrefined) <= STEP_VOXELS + 1e-5);
    for n in 1..=8 {
        let bound = STEP_VOXELS / f64::from(2u32 << n) + 1e-5;
        let (bisection, _) = with(RefineMethod::Bisection, n);
        let (regula_falsi, samples) = with(RefineMethod::RegulaFalsi, n);
        assert!(
            worst(&bisection) <= bound,
            "bisection:{n}: {}",
            worst(&bisection)
        );
        assert!(
            worst(&regula_falsi) <= bound,
            "regula-falsi:{n}: {}",
            worst(&regula_falsi)
        );
        // No more than the guard allows: two samples an iteration, one more, and the bracket's.
        let refining = samples - unrefined_samples;
        assert!(
            refining <= u64::from(ROWS * (2 * n + 3)),
            "regula-falsi:{n}: {refining}"
        );
        // The bound is one that the unrefined answer breaks.
        assert!(worst(&unrefined) > bound);
    }
}

#[test]
fn chords_and_tangents_beat_bisection_where_the_field_is_gentle() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = rows(gentle);
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let mut with = |method, iterations| {
        mean(
            &errors(
                &mut renderer,
                gentle,
                Refine::new(method, iterations).unwrap(),
            )
            .0,
        )
    };
    let bisection = with(RefineMethod::Bisection, 5);
    for method in [
        RefineMethod::RegulaFalsi,
        RefineMethod::Illinois,
        RefineMethod::Newton,
    ] {
        let refined = with(method, 5);
        assert!(
            refined < 0.1 * bisection,
            "{method:?}: {refined} against {bisection}"
        );
    }
    // The comparison is not won by standing still.
    assert!(with(RefineMethod::None, 0) > bisection);
}
