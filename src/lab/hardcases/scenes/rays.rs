//! The scenes of rays: along the grid, from on it, from far away.

use glam::DVec3;

use super::super::HardScene;
use super::view::{OBLIQUE, View};
use crate::volume::Volume;

/// Directions along axes, and across an edge from cell to cell.
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

fn unit_mm(volume: &Volume) -> f64 {
    4.0 * volume.geometry().smallest_spacing_mm()
}

/// Every half voxel a ray: in the volume's faces, beside them, through voxel centres, in cell faces,
/// along cell edges.
pub fn axis_rays(volume: &Volume) -> Vec<HardScene> {
    let (center, _) = volume.bounding_sphere();
    let scenes = ALONG.map(|(name, toward_eye)| {
        let view = View::ortho(name, center, toward_eye, 16.0, 9.5).size(19, 19);
        [
            view.iso(MEDIAN, true),
            view.iso(MEDIAN, false),
            view.mip(),
            view.dvr("dvr", unit_mm(volume), THIN),
        ]
    });
    scenes.into_iter().flatten().collect()
}

pub fn grid_rays(volume: &Volume) -> Vec<HardScene> {
    let (center, _) = volume.bounding_sphere();
    let diagonals = [
        ("xyz", DVec3::ONE),
        ("x-yz", DVec3::new(1.0, -1.0, 1.0)),
        ("-x-yz", DVec3::new(-1.0, -1.0, 1.0)),
        ("xz", DVec3::new(1.0, 0.0, 1.0)),
    ];
    let scenes = diagonals.map(|(name, toward_eye)| {
        let view = |name, height_mm| View::ortho(name, center, toward_eye, 32.0, height_mm);
        let corner = view(name.to_owned(), 1e-3).size(1, 1);
        // A pixel is as wide as corners lie apart along the picture's rows.
        let rows = view(format!("{name}-rows"), 12.0 * 2_f64.sqrt()).size(24, 24);
        [
            corner.iso(MEDIAN, true),
            corner.iso(MEDIAN, false),
            corner.mip(),
            rows.iso(MEDIAN, false),
            rows.mip(),
        ]
    });
    scenes.into_iter().flatten().collect()
}

pub fn face_rays(volume: &Volume) -> Vec<HardScene> {
    let (center, _) = volume.bounding_sphere();
    let scenes = ALONG[..6].iter().flat_map(|(name, toward_eye)| {
        let view = View::ortho(*name, center, *toward_eye, 16.0, 9.0).size(9, 9);
        [view.iso(MEDIAN, true), view.iso(MEDIAN, false), view.mip()]
    });
    scenes.collect()
}

pub fn eye_on_grid(volume: &Volume) -> Vec<HardScene> {
    let eyes = [
        ("face", DVec3::new(0.0, 3.3, 4.7)),
        ("far-face", DVec3::new(8.0, 3.3, 4.7)),
        ("edge", DVec3::new(0.0, 0.0, 4.7)),
        ("corner", DVec3::ZERO),
        ("far-corner", DVec3::splat(8.0)),
        ("voxel", DVec3::splat(4.0)),
        ("cell-face", DVec3::new(4.0, 3.3, 5.2)),
        ("inside", DVec3::new(3.4, 4.3, 5.2)),
        ("surface", surface_below(volume)),
    ];
    let aims = [
        ("in", None),
        ("along-x", Some(DVec3::X)),
        ("along-y", Some(DVec3::NEG_Y)),
    ];
    let views = eyes.into_iter().flat_map(|(name, eye)| {
        aims.map(|(aim, along)| {
            let target = along.map_or(DVec3::new(4.1, 3.7, 4.2), |along| eye + along);
            View::perspective(format!("{name}-{aim}"), eye, target, 70.0).size(15, 15)
        })
    });
    let scenes = views.flat_map(|view| [view.iso(MEDIAN, true), view.mip()]);
    scenes.collect()
}

pub fn far_camera(volume: &Volume) -> Vec<HardScene> {
    let (center, radius_mm) = volume.bounding_sphere();
    let far = 1e5 * radius_mm;
    let height_mm = 2.0 * far * (0.5e-3_f64.to_radians()).tan();
    let toward = OBLIQUE.normalize();
    let eye = center + toward * far;
    let near = View::ortho("orthographic", center, toward, 2.0 * radius_mm, height_mm);
    let views = [View::perspective("far", eye, center, 1e-3), near];
    views.map(|view| view.size(41, 41).iso(MEDIAN, true)).into()
}

pub fn lenses(volume: &Volume) -> Vec<HardScene> {
    let (center, radius_mm) = volume.bounding_sphere();
    let scenes = [(600.0, 0.1), (1.2, 175.0), (1e-4, 175.0)].map(|(radii, fov_deg)| {
        let eye = center + OBLIQUE.normalize() * (radii * radius_mm);
        let name = format!("{fov_deg}-degrees-{radii}-radii");
        let view = View::perspective(name, eye, center, fov_deg).size(21, 21);
        [view.iso(MEDIAN, true), view.mip()]
    });
    scenes.into_iter().flatten().collect()
}

/// All of the volume in three modes.
pub fn whole(volume: &Volume) -> Vec<HardScene> {
    let whole = View::whole("", volume, OBLIQUE).size(41, 41);
    vec![
        whole.iso(MEDIAN, true),
        whole.mip(),
        whole.dvr("dvr", unit_mm(volume), THIN),
    ]
}

/// A point of the isosurface on a grid line along x: where it begins to be above the median.
fn surface_below(volume: &Volume) -> DVec3 {
    let stored = |x: usize| volume.voxels().stored(x + 9 * (4 + 9 * 4));
    let crossing = (0..8).find(|&x| (stored(x) < MEDIAN) != (stored(x + 1) < MEDIAN));
    let x = crossing.unwrap_or(0);
    let (a, b) = (stored(x), stored(x + 1));
    DVec3::new(x as f64 + (MEDIAN - a) / (b - a), 4.0, 4.0)
}
