//! The scenes of isosurfaces.

use glam::DVec3;

use super::super::HardScene;
use super::view::{OBLIQUE, View};
use crate::volume::Volume;

/// Orthographic, so many mm high, about the volume's centre.
fn across(volume: &Volume, name: &str, toward_eye: DVec3, height_mm: f64) -> View {
    let (center, radius_mm) = volume.bounding_sphere();
    View::ortho(name, center, toward_eye, 4.0 * radius_mm, height_mm)
}

fn whole(volume: &Volume) -> View {
    View::whole("", volume, OBLIQUE)
}

/// The middle pixel of the first two looks along the cell's diagonal.
pub fn tangent(volume: &Volume) -> Vec<HardScene> {
    let view = across(volume, "diagonal", DVec3::NEG_ONE, 1e-3).size(1, 1);
    let about = across(volume, "about", DVec3::NEG_ONE, 1.0).size(33, 33);
    vec![
        view.iso(149.99, false),
        view.iso(150.01, false),
        about.iso(149.0, false),
    ]
}

pub fn three_roots(volume: &Volume) -> Vec<HardScene> {
    let view = across(volume, "diagonal", DVec3::NEG_ONE, 1e-3).size(1, 1);
    let about = across(volume, "about", DVec3::NEG_ONE, 1.6).size(33, 33);
    vec![view.iso(50.0, false), about.iso(50.0, false)]
}

pub fn two_roots_in_a_step(volume: &Volume) -> Vec<HardScene> {
    let views = [
        ("x", DVec3::NEG_X),
        ("-x", DVec3::X),
        ("oblique", DVec3::new(-1.0, 0.3, 0.2)),
    ];
    let scene = |(name, toward)| {
        across(volume, name, toward, 7.9)
            .size(25, 25)
            .iso(250.0, false)
    };
    views.map(scene).into()
}

pub fn plateau(volume: &Volume) -> Vec<HardScene> {
    let isos = [99.999, 100.0, 100.001, 60.0, 199.999];
    let front = across(volume, "front", DVec3::Y, 10.0).size(31, 31);
    let whole = whole(volume).size(31, 31);
    let scenes = isos.map(|iso| [whole.iso(iso, true), front.iso(iso, true)]);
    scenes.into_iter().flatten().collect()
}

pub fn iso_at_extremes(volume: &Volume) -> Vec<HardScene> {
    let isos = [20.0, 19.999, 200.0, 200.001, -1e30, 1e30];
    let view = whole(volume).size(31, 31);
    let ahead = across(volume, "front", DVec3::Y, 11.0).size(11, 11);
    let scenes = isos.map(|iso| {
        [
            view.iso(iso, true),
            view.iso(iso, false),
            ahead.iso(iso, false),
        ]
    });
    scenes.into_iter().flatten().collect()
}

pub fn saddle(volume: &Volume) -> Vec<HardScene> {
    let view = whole(volume).size(61, 61);
    let along = across(volume, "x", DVec3::X, 5.0).size(20, 20);
    vec![
        view.iso(100.0, false),
        view.iso(127.5, false),
        view.iso(180.0, true),
        along.iso(127.5, false),
    ]
}

pub fn thin_vessels(volume: &Volume) -> Vec<HardScene> {
    let views = [("above", DVec3::Z), ("oblique", DVec3::new(0.3, -0.5, 0.8))];
    let view = |(name, toward)| across(volume, name, toward, 200.0).size(300, 300);
    views.map(|each| view(each).iso(127.5, false)).into()
}

pub fn touching_vessels(volume: &Volume) -> Vec<HardScene> {
    let views = [
        ("front", DVec3::NEG_Y),
        ("oblique", DVec3::new(0.1, -1.0, 0.4)),
    ];
    let view = |(name, toward)| across(volume, name, toward, 24.0).size(48, 48);
    views.map(|each| view(each).iso(127.5, false)).into()
}

pub fn one_bright_voxel(volume: &Volume) -> Vec<HardScene> {
    let along = across(volume, "x", DVec3::X, 1.0).size(1, 1);
    let diagonal = across(volume, "xyz", DVec3::ONE, 1e-3).size(1, 1);
    let about = across(volume, "about", OBLIQUE, 2.0).size(41, 41);
    vec![
        along.iso(250.0, false),
        diagonal.iso(250.0, false),
        about.iso(30.0, false),
        about.mip(),
    ]
}

pub fn stenosis(volume: &Volume) -> Vec<HardScene> {
    let front = across(volume, "front", DVec3::NEG_Y, 12.0).size(99, 36);
    let along = across(volume, "along", DVec3::new(1.0, 0.2, 0.1), 12.0).size(36, 36);
    vec![front.iso(127.5, false), along.iso(127.5, false)]
}

pub fn sheet(volume: &Volume) -> Vec<HardScene> {
    let scene = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let toward = if degrees == 90.0 {
            DVec3::Y
        } else {
            DVec3::new(cos, sin, 0.0)
        };
        let view = across(volume, &format!("{degrees}-degrees"), toward, 40.0);
        view.size(41, 41).iso(127.5, true)
    };
    [0.0, 45.0, 80.0, 89.0, 89.9, 90.0].map(scene).into()
}

pub fn step_edge(volume: &Volume) -> Vec<HardScene> {
    let view = across(volume, "x", DVec3::NEG_X, 7.9).size(9, 9);
    let oblique = across(volume, "oblique", DVec3::new(-1.0, 0.4, 0.3), 7.9).size(25, 25);
    vec![
        view.iso(0.01, false),
        view.iso(254.99, false),
        oblique.iso(0.01, false),
        oblique.iso(254.99, false),
    ]
}

/// Scenes along an axis, in which a ray goes through every voxel's centre.
pub fn corner_voxels(volume: &Volume) -> Vec<HardScene> {
    let along = [("x", DVec3::X), ("-y", DVec3::NEG_Y), ("z", DVec3::Z)];
    let oblique = [("oblique", OBLIQUE), ("behind", -OBLIQUE)];
    let along = along.map(|(name, toward)| {
        let view = across(volume, name, toward, 40.0).size(40, 40);
        [view.iso(250.0, true), view.mip()]
    });
    let oblique = oblique.map(|(name, toward)| {
        let view = across(volume, name, toward, 60.0).size(150, 150);
        view.iso(127.5, true)
    });
    along.into_iter().flatten().chain(oblique).collect()
}

pub fn zero_gradient(_volume: &Volume) -> Vec<HardScene> {
    let eye = DVec3::new(10.0, 4.0, 4.0);
    let ahead = View::perspective("ahead", eye, eye + DVec3::X, 60.0).size(9, 9);
    let aside = View::perspective("aside", eye, eye + DVec3::new(1.0, 0.5, 0.3), 60.0).size(9, 9);
    vec![ahead.iso(127.5, false), aside.iso(127.5, false)]
}

pub fn mirrored_normals(volume: &Volume) -> Vec<HardScene> {
    let view = whole(volume).size(61, 61);
    vec![view.iso((-0.5_f64).exp(), true)]
}

pub fn white_noise(volume: &Volume) -> Vec<HardScene> {
    let view = whole(volume).size(61, 61);
    let (eye, target) = (DVec3::splat(15.7), DVec3::new(17.0, 14.0, 16.0));
    let inside = View::perspective("inside", eye, target, 90.0).size(61, 61);
    vec![
        view.iso(127.0, true),
        view.iso(127.0, false),
        inside.iso(127.0, false),
    ]
}

/// The surface at half of the signal's range.
pub fn marschner_lobb(volume: &Volume) -> Vec<HardScene> {
    let view = whole(volume).size(61, 61);
    let above = across(volume, "above", DVec3::Z, 42.0).size(61, 61);
    vec![view.iso(25_000.0, true), above.iso(25_000.0, false)]
}
