use glam::DVec3;

use super::HardScene;
use super::view::{OBLIQUE, View};
use crate::volume::Volume;

pub fn scenes(name: &str, volume: &Volume) -> Vec<HardScene> {
    let (center, radius_mm) = volume.bounding_sphere();
    let across = |name: &str, toward_eye: DVec3, height_mm: f64| {
        View::ortho(name, center, toward_eye, 4.0 * radius_mm, height_mm)
    };
    let whole = View::whole("", volume, OBLIQUE);
    match name {
        "tangent" => {
            // The middle pixel looks along the cell's diagonal.
            let view = across("diagonal", DVec3::NEG_ONE, 1e-3).size(1, 1);
            let about = across("about", DVec3::NEG_ONE, 1.0).size(33, 33);
            vec![
                view.iso(149.99, false),
                view.iso(150.01, false),
                about.iso(149.0, false),
            ]
        }
        "three-roots" => {
            let view = across("diagonal", DVec3::NEG_ONE, 1e-3).size(1, 1);
            let about = across("about", DVec3::NEG_ONE, 1.6).size(33, 33);
            vec![view.iso(50.0, false), about.iso(50.0, false)]
        }
        "two-roots-in-a-step" => vec![
            across("x", DVec3::NEG_X, 7.9)
                .size(25, 25)
                .iso(250.0, false),
            across("-x", DVec3::X, 7.9).size(25, 25).iso(250.0, false),
            across("oblique", DVec3::new(-1.0, 0.3, 0.2), 7.9)
                .size(25, 25)
                .iso(250.0, false),
        ],
        "plateau" => [99.999, 100.0, 100.001, 60.0, 199.999]
            .into_iter()
            .flat_map(|iso| {
                let front = across("front", DVec3::Y, 10.0).size(31, 31);
                [
                    whole.clone().size(31, 31).iso(iso, true),
                    front.iso(iso, true),
                ]
            })
            .collect(),
        "iso-at-extremes" => [20.0, 19.999, 200.0, 200.001, -1e30, 1e30]
            .into_iter()
            .flat_map(|iso| {
                let view = whole.clone().size(31, 31);
                let ahead = across("front", DVec3::Y, 11.0).size(11, 11);
                [
                    view.iso(iso, true),
                    view.iso(iso, false),
                    ahead.iso(iso, false),
                ]
            })
            .collect(),
        "saddle" => {
            let view = whole.size(61, 61);
            vec![
                view.iso(100.0, false),
                view.iso(127.5, false),
                view.iso(180.0, true),
                across("x", DVec3::X, 5.0).size(20, 20).iso(127.5, false),
            ]
        }
        "thin-vessels" => vec![
            across("above", DVec3::Z, 200.0)
                .size(300, 300)
                .iso(127.5, false),
            across("oblique", DVec3::new(0.3, -0.5, 0.8), 200.0)
                .size(300, 300)
                .iso(127.5, false),
        ],
        "touching-vessels" => vec![
            across("front", DVec3::NEG_Y, 24.0)
                .size(48, 48)
                .iso(127.5, false),
            across("oblique", DVec3::new(0.1, -1.0, 0.4), 24.0)
                .size(48, 48)
                .iso(127.5, false),
        ],
        "one-bright-voxel" => vec![
            across("x", DVec3::X, 1.0).size(1, 1).iso(250.0, false),
            across("xyz", DVec3::ONE, 1e-3).size(1, 1).iso(250.0, false),
            across("about", OBLIQUE, 2.0).size(41, 41).iso(30.0, false),
            across("about", OBLIQUE, 2.0).size(41, 41).mip(),
        ],
        "stenosis" => vec![
            across("front", DVec3::NEG_Y, 12.0)
                .size(99, 36)
                .iso(127.5, false),
            across("along", DVec3::new(1.0, 0.2, 0.1), 12.0)
                .size(36, 36)
                .iso(127.5, false),
        ],
        "sheet" => [0.0, 45.0, 80.0, 89.0, 89.9, 90.0]
            .into_iter()
            .map(|degrees: f64| {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let toward = if degrees == 90.0 {
                    DVec3::Y
                } else {
                    DVec3::new(cos, sin, 0.0)
                };
                across(&format!("{degrees}-degrees"), toward, 40.0)
                    .size(41, 41)
                    .iso(127.5, true)
            })
            .collect(),
        "step-edge" => {
            let view = across("x", DVec3::NEG_X, 7.9).size(9, 9);
            let oblique = across("oblique", DVec3::new(-1.0, 0.4, 0.3), 7.9).size(25, 25);
            vec![
                view.iso(0.01, false),
                view.iso(254.99, false),
                oblique.iso(0.01, false),
                oblique.iso(254.99, false),
            ]
        }
        "corner-voxels" => [
            ("x", DVec3::X),
            ("-y", DVec3::NEG_Y),
            ("z", DVec3::Z),
            ("oblique", OBLIQUE),
            ("behind", -OBLIQUE),
        ]
        .into_iter()
        .flat_map(|(name, toward)| {
            // Along an axis a ray through every voxel's centre.
            let view = across(name, toward, 40.0).size(40, 40);
            let fine = across(name, toward, 60.0).size(150, 150);
            let axis = toward.length_squared() == 1.0;
            if axis {
                vec![view.iso(250.0, true), view.mip()]
            } else {
                vec![fine.iso(127.5, true)]
            }
        })
        .collect(),
        "zero-gradient" => {
            let eye = DVec3::new(10.0, 4.0, 4.0);
            let ahead = View::perspective("ahead", eye, eye + DVec3::X, 60.0).size(9, 9);
            let aside =
                View::perspective("aside", eye, eye + DVec3::new(1.0, 0.5, 0.3), 60.0).size(9, 9);
            vec![ahead.iso(127.5, false), aside.iso(127.5, false)]
        }
        "mirrored-normals" => {
            vec![whole.size(61, 61).iso((-0.5_f64).exp(), true)]
        }
        "white-noise" => {
            let view = whole.size(61, 61);
            let inside = View::perspective(
                "inside",
                DVec3::splat(15.7),
                DVec3::new(17.0, 14.0, 16.0),
                90.0,
            );
            vec![
                view.iso(127.0, true),
                view.iso(127.0, false),
                inside.size(61, 61).iso(127.0, false),
            ]
        }
        // Marschner and Lobb's half.
        _ => vec![
            whole.clone().size(61, 61).iso(25_000.0, true),
            across("above", DVec3::Z, 42.0)
                .size(61, 61)
                .iso(25_000.0, false),
        ],
    }
}
