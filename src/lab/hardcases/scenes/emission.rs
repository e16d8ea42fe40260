//! The scenes of emission and absorption.

use glam::DVec3;

use super::super::HardScene;
use super::view::{OBLIQUE, View};
use crate::scene::QuadratureMethod;
use crate::volume::Volume;

/// The error that the adaptive rule is held to.
const BOUND: f64 = 1e-4;
/// Rules of order 2 at least, for which half a voxel is fine enough where a medium changes.
const SMOOTH: &[QuadratureMethod] = &[
    QuadratureMethod::Midpoint,
    QuadratureMethod::Simpson,
    QuadratureMethod::Romberg,
    QuadratureMethod::Rk4,
    QuadratureMethod::Preintegrated,
    QuadratureMethod::Adaptive,
];
const ADAPTIVE: &[QuadratureMethod] = &[QuadratureMethod::Adaptive];
/// Two values apart, so that the opacity at 100 is 0.03 whichever way the points are read.
const MEDIUM: &[(f64, f64)] = &[(0.0, 0.0), (200.0, 0.06)];

/// The scenes that show one picture under each of the rules.
fn under(
    rules: &[QuadratureMethod],
    view: &View,
    what: &str,
    unit_length_mm: f64,
    points: &[(f64, f64)],
) -> Vec<HardScene> {
    let scene = |&method: &QuadratureMethod| {
        let quadrature = match method {
            QuadratureMethod::Adaptive => format!("{method}:{BOUND}"),
            _ => method.to_string(),
        };
        let what = match what {
            "" => method.to_string(),
            what => format!("{what}-{method}"),
        };
        let view = view.clone().with(&format!("quad = \"{quadrature}\""));
        view.dvr(&what, unit_length_mm, points)
    };
    rules.iter().map(scene).collect()
}

fn whole(volume: &Volume) -> View {
    View::whole("", volume, OBLIQUE).size(31, 31)
}

/// One ray through the middle.
fn along(volume: &Volume, name: &str, axis: DVec3) -> View {
    let (center, radius_mm) = volume.bounding_sphere();
    View::ortho(name, center, axis, 2.0 * radius_mm, 1e-3).size(1, 1)
}

fn along_x(volume: &Volume) -> View {
    along(volume, "x", DVec3::NEG_X)
}

pub fn homogeneous(volume: &Volume) -> Vec<HardScene> {
    let (center, radius_mm) = volume.bounding_sphere();
    let eye = center + OBLIQUE.normalize() * (1.05 * radius_mm);
    let wide = View::perspective("wide", eye, center, 100.0).size(31, 31);
    let mut scenes = under(&QuadratureMethod::ALL, &wide, "", 2.0, MEDIUM);
    scenes.push(whole(volume).dvr("whole", 2.0, MEDIUM));
    scenes
}

pub fn slab(volume: &Volume) -> Vec<HardScene> {
    let points = &[(0.0, 0.0), (1.0, 0.3)];
    under(SMOOTH, &along_x(volume), "", 1.0, points)
}

pub fn ramp(volume: &Volume) -> Vec<HardScene> {
    let points = &[(0.0, 0.0), (64.0, 0.95)];
    under(SMOOTH, &along_x(volume), "", 40.0, points)
}

pub fn gaussian(volume: &Volume) -> Vec<HardScene> {
    let points = &[(0.1, 0.0), (1.0, 0.3)];
    under(SMOOTH, &whole(volume), "whole", 1.0, points)
}

pub fn tf_spike(volume: &Volume) -> Vec<HardScene> {
    let spike = &[(128.0, 0.0), (128.05, 0.9), (128.1, 0.0)];
    let scene = |name: &str, quad: &str| {
        let view = along_x(volume).with(&format!("quad = \"{quad}\""));
        view.dvr(name, 1.0, spike)
    };
    vec![
        scene("preintegrated", "preintegrated"),
        scene("adaptive", "adaptive:1e-4"),
    ]
}

pub fn tf_stairs(volume: &Volume) -> Vec<HardScene> {
    let jump = &[(120.0, 0.0), (120.0, 0.3)];
    let stairs = &[
        (60.0, 0.0),
        (60.0, 0.1),
        (120.0, 0.1),
        (120.0, 0.3),
        (180.0, 0.3),
        (180.0, 0.05),
    ];
    let mut scenes = under(ADAPTIVE, &whole(volume), "jump", 4.0, jump);
    scenes.extend(under(ADAPTIVE, &whole(volume), "stairs", 4.0, stairs));
    scenes
}

pub fn tf_outside(volume: &Volume) -> Vec<HardScene> {
    let whole = whole(volume);
    vec![
        whole.dvr("transparent", 1.0, &[(0.0, 0.0), (255.0, 0.0)]),
        whole.dvr("clear-point", 1.0, &[(50.0, 0.0)]),
        whole.dvr("above", 1.0, &[(1e6, 0.0), (2e6, 1.0)]),
        whole.dvr("below", 4.0, &[(-2e6, 1.0), (-1e6, 0.2)]),
        whole.dvr("opaque", 1.0, &[(0.0, 1.0), (255.0, 1.0)]),
    ]
}

pub fn opaque_step(volume: &Volume) -> Vec<HardScene> {
    let opaque = &[(50.0, 1.0)];
    under(
        &QuadratureMethod::ALL,
        &whole(volume),
        "whole",
        1e-6,
        opaque,
    )
}

pub fn faint_4096(volume: &Volume) -> Vec<HardScene> {
    let faint = &[(0.0, 0.0), (200.0, 2e-6)];
    under(&QuadratureMethod::ALL, &along_x(volume), "", 1.0, faint)
}

pub fn thin_bright_sheet(volume: &Volume) -> Vec<HardScene> {
    let sheet = &[(200.0, 0.0), (255.0, 0.5)];
    let mut scenes = under(ADAPTIVE, &along_x(volume), "", 1.0, sheet);
    scenes.extend(under(ADAPTIVE, &whole(volume), "whole", 1.0, sheet));
    scenes
}

pub fn false_homogeneous(volume: &Volume) -> Vec<HardScene> {
    let points: &[(f64, f64)] = &[(100.9, 0.0), (101.1, 0.5)];
    let averaged = |view: View| view.with("homogeneity = 0.001");
    vec![
        averaged(along_x(volume)).dvr("", 1.0, points),
        averaged(whole(volume)).dvr("whole", 1.0, points),
    ]
}

/// A ray along each axis, and the whole.
pub fn along_axes(volume: &Volume) -> Vec<HardScene> {
    vec![
        along_x(volume).dvr("", 2.0, MEDIUM),
        along(volume, "y", DVec3::NEG_Y).dvr("", 2.0, MEDIUM),
        along(volume, "z", DVec3::NEG_Z).dvr("", 2.0, MEDIUM),
        whole(volume).dvr("whole", 2.0, MEDIUM),
    ]
}
