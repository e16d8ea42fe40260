//! The adaptive rule keeps its bound: against the double-precision reference, under transfer
//! functions that change abruptly, spiked, stepped or next to opaque, on phantoms and on real volumes where
//! `ANGIORAY_DATA` names their folder. `cargo nextest run --test device --no-capture quadrature:: | grep '|'`
//! prints how many pixels do.

use std::path::PathBuf;

use angioray::extent::Dims;
use angioray::frame::{Frame, STEPS};
use angioray::gpu::Device;
use angioray::progress::Silent;
use angioray::scene::{
    Emission, Light, Phong, Picture, Quadrature, Scene, ShadedFrom, TransferFunction,
};
use angioray::volume::{PhantomKind, PhantomSpec, ReadOptions, Volume, phantom, read};

use glam::DVec3;

use super::knot;
use crate::common::{self, on_device, on_reference};

const SIZE_PX: u32 = 64;
/// The minimum share of pixels within the bound.
const MIN: f64 = 0.999;
const BOUNDS: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];

const BLUE: [f64; 3] = [0.1, 0.2, 0.9];
const WARM: [f64; 3] = [0.9, 0.7, 0.1];

/// Names and points: share of the value range, colour, opacity.
type Points = Vec<(f64, [f64; 3], f64)>;

fn hard() -> Vec<(&'static str, Points)> {
    let stairs = (1..8).flat_map(|i| {
        let at = 0.1 * f64::from(i);
        let of = |i: i32| (if i % 2 == 0 { BLUE } else { WARM }, 0.05 * f64::from(i));
        let (below, above) = (of(i - 1), of(i));
        [(at, below.0, below.1), (at, above.0, above.1)]
    });
    vec![
        ("smooth", vec![(0.1, BLUE, 0.0), (0.9, WARM, 0.6)]),
        (
            "abrupt",
            vec![(0.3, BLUE, 0.0), (0.31, WARM, 0.7), (1.0, BLUE, 0.8)],
        ),
        (
            "spike",
            vec![(0.35, WARM, 0.0), (0.353, WARM, 0.95), (0.356, BLUE, 0.0)],
        ),
        ("stairs", stairs.collect()),
        ("opaque", vec![(0.2, BLUE, 0.0), (0.4, WARM, 1.0)]),
    ]
}

fn transfer(points: &Points, volume: &Volume) -> TransferFunction {
    let range = volume.range();
    let knots = points
        .iter()
        .map(|&(at, color, opacity)| knot(range.at(at), color, opacity));
    let unit_mm = 2.0 * volume.geometry().smallest_spacing_mm();
    TransferFunction::new(knots.collect(), unit_mm).unwrap()
}

/// The share of pixels of which no channel is off by more than `bound`, and the largest error.
fn within(reference: &Frame, frame: &Frame, bound: f64) -> (f64, f64) {
    let pixels = reference.color.iter().zip(&frame.color);
    let error = |(a, b): (&[f32; 4], &[f32; 4])| {
        (0..4).fold(0.0, |max, c| f64::max(max, f64::from((a[c] - b[c]).abs())))
    };
    let errors: Vec<f64> = pixels.map(error).collect();
    let within_bound = errors.iter().filter(|&&e| e <= bound).count();
    let max = errors.iter().fold(0.0, |max, &e| f64::max(max, e));
    (within_bound as f64 / errors.len() as f64, max)
}

fn scene(volume: &Volume, emission: Emission, lit: &Lit) -> Scene {
    Scene {
        lights: lit.lights.clone(),
        ..common::scene(volume, SIZE_PX, Picture::Emission(emission))
    }
}

fn samples(frame: &Frame) -> u64 {
    frame
        .plane(STEPS)
        .into_iter()
        .flatten()
        .map(|&n| u64::from(n))
        .sum()
}

/// How a medium is lit.
#[derive(Default)]
struct Lit {
    phong: Option<Phong>,
    lights: Vec<Light>,
    shaded_from: ShadedFrom,
    /// The bound down to which all must be kept.
    kept_down_to: f64,
}

fn check(name: &str, volume: &Volume, lit: &Lit) {
    let Some(device) = common::device() else {
        return;
    };
    let mut broken = 0;
    let mut wrong = Vec::new();
    for (shape, points) in hard() {
        broken += usize::from(check_one(
            &device,
            name,
            volume,
            (shape, &points),
            lit,
            &mut wrong,
        ));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(broken >= 2, "{name}: fixed steps keep the bound too");
}

/// Every bound under one transfer function; whether fixed steps break that of 1e-3.
fn check_one(
    device: &Device,
    name: &str,
    volume: &Volume,
    (shape, points): (&str, &Points),
    lit: &Lit,
    wrong: &mut Vec<String>,
) -> bool {
    let emission = Emission {
        phong: lit.phong,
        shaded_from: lit.shaded_from,
        ..Emission::of(transfer(points, volume))
    };
    let adaptive = BOUNDS.map(|bound| Emission {
        quadrature: Quadrature::adaptive(bound).unwrap(),
        ..emission.clone()
    });
    let mut scenes: Vec<Scene> = adaptive.map(|e| scene(volume, e, lit)).to_vec();
    scenes.push(scene(volume, emission, lit));
    let reference = on_reference(volume, &scenes[0]);
    let frames = on_device(device, volume, &scenes);
    let (fixed, adaptive) = frames.split_last().unwrap();
    let mut row = format!("| {name} | {shape} |");
    for (frame, bound) in adaptive.iter().zip(BOUNDS) {
        let (share, max) = within(&reference, frame, bound);
        row.push_str(&format!(
            " {:.2} % {max:.0e} {} |",
            100.0 * share,
            samples(frame)
        ));
        if share < MIN && bound >= lit.kept_down_to {
            wrong.push(format!(
                "{name} {shape} {bound}: {share} of the pixels, {max}"
            ));
        }
    }
    let (share, max) = within(&reference, fixed, 1e-3);
    println!(
        "{row} {:.2} % {max:.0e} {} |",
        100.0 * share,
        samples(fixed)
    );
    share < MIN
}

fn check_phantom(kind: PhantomKind, size: u64) {
    let spec = PhantomSpec::new(kind, Dims::new([size; 3]).unwrap());
    check(
        kind.name(),
        &phantom(&spec).unwrap().volume,
        &Lit::default(),
    );
}

fn check_real(name: &str, file: &str) {
    let Some(folder) = std::env::var_os("ANGIORAY_DATA").map(PathBuf::from) else {
        eprintln!("skipped: ANGIORAY_DATA does not name a folder of real volumes");
        return;
    };
    let path = folder.join(file);
    if !path.exists() {
        eprintln!("skipped: there is no {}", path.display());
        return;
    }
    let mut options = ReadOptions::default();
    if file.ends_with(".raw.gz") {
        options.raw.size = Some("256x256x256".parse().unwrap());
        options.raw.element = Some("u8".parse().unwrap());
    }
    let volume = read(&path, &options, &Silent).unwrap();
    check(name, &volume, &Lit::default());
}

#[test]
fn bound_on_noise() {
    check_phantom(PhantomKind::Noise, 24);
}

#[test]
fn bound_on_vessels() {
    check_phantom(PhantomKind::Vessels, 64);
}

#[test]
fn bound_on_a_gaussian() {
    check_phantom(PhantomKind::Blob, 40);
}

#[test]
fn bound_on_marschner_lobb() {
    check_phantom(PhantomKind::MarschnerLobb, 41);
}

#[test]
fn bound_with_shading() {
    let spec = PhantomSpec::new(PhantomKind::Vessels, Dims::new([48; 3]).unwrap());
    let volume = phantom(&spec).unwrap().volume;
    let lit = Lit {
        phong: Some(Phong::default()),
        lights: vec![Light::HEADLIGHT],
        ..Lit::default()
    };
    check("vessels, phong", &volume, &lit);
}

/// Under which points may be brighter than their colour. Where a surface turns from a light that is not at the eye the
/// light has a kink, and its highlight a step, which no node may see: 1e-5 is kept by fewer pixels.
#[test]
fn bound_with_several_lights_and_a_gradient_to_shade_from() {
    let spec = PhantomSpec::new(PhantomKind::Vessels, Dims::new([48; 3]).unwrap());
    let volume = phantom(&spec).unwrap().volume;
    let (center, radius_mm) = volume.bounding_sphere();
    let per_voxel = volume.range().width() / volume.geometry().smallest_spacing_mm();
    let lit = Lit {
        phong: Some(Phong::default()),
        lights: vec![
            "headlight@ivory@2".parse().unwrap(),
            Light::point(center + DVec3::new(0.3, -1.2, 0.8) * radius_mm).unwrap(),
        ],
        shaded_from: ShadedFrom::new(0.1 * per_voxel).unwrap(),
        kept_down_to: 1e-4,
    };
    check("vessels, two lights", &volume, &lit);
}

#[test]
fn bound_on_a_real_aneurism() {
    check_real("aneurism", "aneurism_toxi/aneurism.raw.gz");
}

#[test]
fn bound_on_real_ct_avm() {
    check_real("CT_AVM", "niivue_CT_AVM/CT_AVM.nii.gz");
}

#[test]
fn bound_on_real_chris_mra() {
    check_real("chris_MRA", "niivue_chris_MRA/chris_MRA.nii.gz");
}
