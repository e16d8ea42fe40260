//! The scenes of volumes of any size, type, value and orientation, and of clip planes.

use glam::DVec3;

use super::super::HardScene;
use super::view::{OBLIQUE, View};
use crate::volume::Volume;

pub fn constant(volume: &Volume) -> Vec<HardScene> {
    let view = View::whole("", volume, OBLIQUE).size(17, 17);
    vec![
        view.iso(77.0, true),
        view.iso(77.0, false),
        view.iso(77.5, true),
        view.mip(),
    ]
}

pub fn orientations(volume: &Volume) -> Vec<HardScene> {
    let view = View::whole("", volume, OBLIQUE).size(48, 48);
    vec![view.iso(120.0, true)]
}

pub fn wide_index(volume: &Volume) -> Vec<HardScene> {
    let view = View::whole("", volume, OBLIQUE).size(41, 41);
    vec![view.iso(127.0, true)]
}

/// All of the volume in three modes; emission where its values are not all one.
pub fn whole(volume: &Volume) -> Vec<HardScene> {
    let range = volume.range();
    let view = View::whole("", volume, OBLIQUE).size(17, 17);
    let mut scenes = vec![view.iso(range.at(0.45), true), view.mip()];
    if range.width() > 0.0 {
        let unit_mm = 4.0 * volume.geometry().smallest_spacing_mm();
        let points = [(range.at(0.1), 0.0), (range.at(0.9), 0.5)];
        scenes.push(view.dvr("dvr", unit_mm, &points));
    }
    scenes
}

/// The bump under planes: none, one, one that is not normalised, many of which one matters, two that
/// leave nothing, one through the eye, one along the rays.
pub fn clip_planes(volume: &Volume) -> Vec<HardScene> {
    let whole = View::whole("", volume, OBLIQUE);
    let (center, radius_mm) = volume.bounding_sphere();
    let half = [0.0, 0.0, 1.0, -center.z];
    let scaled = half.map(|c| c * 1e6);
    // Planes that cut away nothing, about the plane that halves.
    let mut many: Vec<[f64; 4]> = (0..63)
        .map(|n: i32| {
            let (sin, cos) = f64::from(n).sin_cos();
            let out = -(cos * center.x + sin * center.y);
            [cos, sin, 0.0, out + 2.0 * radius_mm]
        })
        .collect();
    many.push(half);
    let eye = center + OBLIQUE.normalize() * (4.0 * radius_mm);
    let across = OBLIQUE.normalize().any_orthonormal_vector();
    let through = [across.x, across.y, across.z, -across.dot(eye)];
    let planes = [
        ("none", vec![]),
        ("half", vec![half]),
        ("scaled", vec![scaled]),
        ("many", many),
        (
            "nothing-left",
            vec![[0.0, 0.0, 1.0, -9.0], [0.0, 0.0, -1.0, 7.0]],
        ),
        ("through-the-eye", vec![through]),
    ];
    let mut scenes: Vec<HardScene> = planes
        .into_iter()
        .map(|(name, planes)| {
            let view = whole.clone().named(name).size(41, 41);
            view.with(&format!("clip-plane = {planes:?}"))
                .iso(127.0, true)
        })
        .collect();
    let along = View::ortho("along-the-rays", center, DVec3::Y, 3.0 * radius_mm, 17.0);
    let planes = [[1.0, 0.0, 0.0, -center.x]];
    let along = along.size(17, 17).with(&format!("clip-plane = {planes:?}"));
    scenes.push(along.iso(127.0, true));
    scenes
}
