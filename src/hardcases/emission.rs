use glam::DVec3;

use super::HardScene;
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
/// The same picture under each of the rules.
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

pub fn scenes(name: &str, volume: &Volume) -> Vec<HardScene> {
    let (center, radius_mm) = volume.bounding_sphere();
    let whole = View::whole("", volume, OBLIQUE).size(31, 31);
    // One ray through the middle.
    let along =
        |name: &str, axis: DVec3| View::ortho(name, center, axis, 2.0 * radius_mm, 1e-3).size(1, 1);
    let along_x = along("x", DVec3::NEG_X);
    // Two values apart, so that the opacity at 100 is 0.03 whichever way the points are read.
    let medium: &[(f64, f64)] = &[(0.0, 0.0), (200.0, 0.06)];
    match name {
        "homogeneous" => {
            let eye = center + OBLIQUE.normalize() * (1.05 * radius_mm);
            let wide = View::perspective("wide", eye, center, 100.0).size(31, 31);
            let mut scenes = under(&QuadratureMethod::ALL, &wide, "", 2.0, medium);
            scenes.push(whole.dvr("whole", 2.0, medium));
            scenes
        }
        "slab" => under(SMOOTH, &along_x, "", 1.0, &[(0.0, 0.0), (1.0, 0.3)]),
        "ramp" => under(SMOOTH, &along_x, "", 40.0, &[(0.0, 0.0), (64.0, 0.95)]),
        "gaussian" => under(SMOOTH, &whole, "whole", 1.0, &[(0.1, 0.0), (1.0, 0.3)]),
        "tf-spike" => {
            let spike = &[(128.0, 0.0), (128.05, 0.9), (128.1, 0.0)];
            let scene = |name: &str, quad: &str| {
                let view = along_x.clone().with(&format!("quad = \"{quad}\""));
                view.dvr(name, 1.0, spike)
            };
            vec![
                scene("preintegrated", "preintegrated"),
                scene("adaptive", "adaptive:1e-4"),
            ]
        }
        "tf-stairs" => {
            let adaptive = &[QuadratureMethod::Adaptive];
            let jump = &[(120.0, 0.0), (120.0, 0.3)];
            let stairs = &[
                (60.0, 0.0),
                (60.0, 0.1),
                (120.0, 0.1),
                (120.0, 0.3),
                (180.0, 0.3),
                (180.0, 0.05),
            ];
            let mut scenes = under(adaptive, &whole, "jump", 4.0, jump);
            scenes.extend(under(adaptive, &whole, "stairs", 4.0, stairs));
            scenes
        }
        "tf-outside" => vec![
            whole.dvr("transparent", 1.0, &[(0.0, 0.0), (255.0, 0.0)]),
            whole.dvr("clear-point", 1.0, &[(50.0, 0.0)]),
            whole.dvr("above", 1.0, &[(1e6, 0.0), (2e6, 1.0)]),
            whole.dvr("below", 4.0, &[(-2e6, 1.0), (-1e6, 0.2)]),
            whole.dvr("opaque", 1.0, &[(0.0, 1.0), (255.0, 1.0)]),
        ],
        "opaque-step" => {
            let opaque = &[(50.0, 1.0)];
            under(&QuadratureMethod::ALL, &whole, "whole", 1e-6, opaque)
        }
        "faint-4096" => {
            let faint = &[(0.0, 0.0), (200.0, 2e-6)];
            under(&QuadratureMethod::ALL, &along_x, "", 1.0, faint)
        }
        "thin-bright-sheet" => {
            let adaptive = &[QuadratureMethod::Adaptive];
            let sheet = &[(200.0, 0.0), (255.0, 0.5)];
            let mut scenes = under(adaptive, &along_x, "", 1.0, sheet);
            scenes.extend(under(adaptive, &whole, "whole", 1.0, sheet));
            scenes
        }
        "false-homogeneous" => {
            let points: &[(f64, f64)] = &[(100.9, 0.0), (101.1, 0.5)];
            let averaged = |view: View| view.with("homogeneity = 0.001");
            vec![
                averaged(along_x).dvr("", 1.0, points),
                averaged(whole).dvr("whole", 1.0, points),
            ]
        }
        _ => vec![
            along_x.dvr("", 2.0, medium),
            along("y", DVec3::NEG_Y).dvr("", 2.0, medium),
            along("z", DVec3::NEG_Z).dvr("", 2.0, medium),
            whole.dvr("whole", 2.0, medium),
        ],
    }
}
