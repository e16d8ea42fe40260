use glam::DVec3;

use super::HardScene;
use super::view::{OBLIQUE, View};
use crate::volume::Volume;

/// Along axes, and across an edge from cell to cell.
const ALONG: [(&str, DVec3); 7] = [
    ("x", DVec3::X),
    ("-x", DVec3::NEG_X),
    ("y", DVec3::Y),
    ("-y", DVec3::NEG_Y),
    ("z", DVec3::Z),
    ("-z", DVec3::NEG_Z),
    ("xy", DVec3::new(1.0, 1.0, 0.0)),
];

const MEDIAN: f64 = 127.0;
const THIN: &[(f64, f64)] = &[(25.0, 0.0), (230.0, 0.5)];

pub fn scenes(name: &str, volume: &Volume) -> Vec<HardScene> {
    let (center, radius_mm) = volume.bounding_sphere();
    let unit_mm = 4.0 * volume.geometry().smallest_spacing_mm();
    let whole = View::whole("", volume, OBLIQUE).size(41, 41);
    match name {
        // Every half voxel a ray: in the volume's faces, beside them, through voxel centres, in
        // cell faces, along cell edges.
        "axis-rays" => ALONG
            .into_iter()
            .flat_map(|(name, toward_eye)| {
                let view = View::ortho(name, center, toward_eye, 16.0, 9.5).size(19, 19);
                [
                    view.iso(MEDIAN, true),
                    view.iso(MEDIAN, false),
                    view.mip(),
                    view.dvr("dvr", unit_mm, THIN),
                ]
            })
            .collect(),
        "grid-rays" => [
            ("xyz", DVec3::ONE),
            ("x-yz", DVec3::new(1.0, -1.0, 1.0)),
            ("-x-yz", DVec3::new(-1.0, -1.0, 1.0)),
            ("xz", DVec3::new(1.0, 0.0, 1.0)),
        ]
        .into_iter()
        .flat_map(|(name, toward_eye)| {
            let corner = View::ortho(name, center, toward_eye, 32.0, 1e-3).size(1, 1);
            // A pixel is as wide as corners lie apart along the picture's rows.
            let rows = View::ortho(
                format!("{name}-rows"),
                center,
                toward_eye,
                32.0,
                12.0 * 2_f64.sqrt(),
            )
            .size(24, 24);
            [
                corner.iso(MEDIAN, true),
                corner.iso(MEDIAN, false),
                corner.mip(),
                rows.iso(MEDIAN, false),
                rows.mip(),
            ]
        })
        .collect(),
        "face-rays" => ALONG[..6]
            .iter()
            .flat_map(|(name, toward_eye)| {
                let view = View::ortho(*name, center, *toward_eye, 16.0, 9.0).size(9, 9);
                [view.iso(MEDIAN, true), view.iso(MEDIAN, false), view.mip()]
            })
            .collect(),
        "eye-on-grid" => {
            let on_surface = surface_below(volume);
            let eyes = [
                ("face", DVec3::new(0.0, 3.3, 4.7)),
                ("far-face", DVec3::new(8.0, 3.3, 4.7)),
                ("edge", DVec3::new(0.0, 0.0, 4.7)),
                ("corner", DVec3::ZERO),
                ("far-corner", DVec3::splat(8.0)),
                ("voxel", DVec3::splat(4.0)),
                ("cell-face", DVec3::new(4.0, 3.3, 5.2)),
                ("inside", DVec3::new(3.4, 4.3, 5.2)),
                ("surface", on_surface),
            ];
            let aims = [
                ("in", None),
                ("along-x", Some(DVec3::X)),
                ("along-y", Some(DVec3::NEG_Y)),
            ];
            eyes.into_iter()
                .flat_map(|(name, eye)| {
                    aims.map(|(aim, along)| {
                        let target = along.map_or(DVec3::new(4.1, 3.7, 4.2), |along| eye + along);
                        View::perspective(format!("{name}-{aim}"), eye, target, 70.0).size(15, 15)
                    })
                })
                .flat_map(|view| [view.iso(MEDIAN, true), view.mip()])
                .collect()
        }
        "far-camera" => {
            let far = 1e5 * radius_mm;
            let height_mm = 2.0 * far * (0.5e-3_f64.to_radians()).tan();
            let toward = OBLIQUE.normalize();
            let eye = center + toward * far;
            let near = View::ortho("orthographic", center, toward, 2.0 * radius_mm, height_mm);
            [View::perspective("far", eye, center, 1e-3), near]
                .into_iter()
                .map(|view| view.size(41, 41).iso(MEDIAN, true))
                .collect()
        }
        "lenses" => [(600.0, 0.1), (1.2, 175.0), (1e-4, 175.0)]
            .into_iter()
            .flat_map(|(radii, fov_deg)| {
                let eye = center + OBLIQUE.normalize() * (radii * radius_mm);
                let name = format!("{fov_deg}-degrees-{radii}-radii");
                let view = View::perspective(name, eye, center, fov_deg).size(21, 21);
                [view.iso(MEDIAN, true), view.mip()]
            })
            .collect(),
        _ => vec![
            whole.iso(MEDIAN, true),
            whole.mip(),
            whole.dvr("dvr", unit_mm, THIN),
        ],
    }
}

/// A point of the isosurface on a grid line along x: where it begins to be above the median.
fn surface_below(volume: &Volume) -> DVec3 {
    let stored = |x: usize| volume.voxels().stored(x + 9 * (4 + 9 * 4));
    let crossing = (0..8).find(|&x| (stored(x) < MEDIAN) != (stored(x + 1) < MEDIAN));
    let x = crossing.unwrap_or(0);
    let (a, b) = (stored(x), stored(x + 1));
    DVec3::new(x as f64 + (MEDIAN - a) / (b - a), 4.0, 4.0)
}
