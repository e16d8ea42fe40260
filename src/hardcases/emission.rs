use glam::DVec3;

use super::HardScene;
use super::view::{OBLIQUE, View};
use crate::volume::Volume;

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
            vec![wide.dvr("", 2.0, medium), whole.dvr("whole", 2.0, medium)]
        }
        "slab" => vec![along_x.dvr("", 1.0, &[(0.0, 0.0), (1.0, 0.3)])],
        "ramp" => vec![along_x.dvr("", 40.0, &[(0.0, 0.0), (64.0, 0.95)])],
        "gaussian" => vec![whole.dvr("whole", 1.0, &[(0.1, 0.0), (1.0, 0.3)])],
        "tf-spike" => vec![along_x.dvr("", 1.0, &[(128.0, 0.0), (128.05, 0.9), (128.1, 0.0)])],
        "tf-stairs" => vec![
            whole.dvr("jump", 4.0, &[(120.0, 0.0), (120.0, 0.3)]),
            whole.dvr(
                "stairs",
                4.0,
                &[
                    (60.0, 0.0),
                    (60.0, 0.1),
                    (120.0, 0.1),
                    (120.0, 0.3),
                    (180.0, 0.3),
                    (180.0, 0.05),
                ],
            ),
        ],
        "tf-outside" => vec![
            whole.dvr("transparent", 1.0, &[(0.0, 0.0), (255.0, 0.0)]),
            whole.dvr("clear-point", 1.0, &[(50.0, 0.0)]),
            whole.dvr("above", 1.0, &[(1e6, 0.0), (2e6, 1.0)]),
            whole.dvr("below", 4.0, &[(-2e6, 1.0), (-1e6, 0.2)]),
            whole.dvr("opaque", 1.0, &[(0.0, 1.0), (255.0, 1.0)]),
        ],
        "opaque-step" => vec![whole.dvr("", 1e-6, &[(50.0, 1.0)])],
        "faint-4096" => vec![along_x.dvr("", 1.0, &[(0.0, 0.0), (200.0, 2e-6)])],
        "thin-bright-sheet" => vec![
            along_x.dvr("", 1.0, &[(200.0, 0.0), (255.0, 0.5)]),
            whole.dvr("whole", 1.0, &[(200.0, 0.0), (255.0, 0.5)]),
        ],
        "false-homogeneous" => {
            let points: &[(f64, f64)] = &[(100.9, 0.0), (101.1, 0.5)];
            vec![
                along_x.dvr("", 1.0, points),
                whole.dvr("whole", 1.0, points),
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
