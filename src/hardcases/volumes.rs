use glam::DVec3;

use super::HardScene;
use super::view::{OBLIQUE, View};
use crate::volume::Volume;

pub fn scenes(name: &str, _member: usize, volume: &Volume) -> Vec<HardScene> {
    let range = volume.range();
    let unit_mm = 4.0 * volume.geometry().smallest_spacing_mm();
    let whole = View::whole("", volume, OBLIQUE);
    match name {
        "constant" => {
            let view = whole.size(17, 17);
            vec![
                view.iso(77.0, true),
                view.iso(77.0, false),
                view.iso(77.5, true),
                view.mip(),
            ]
        }
        "orientations" => {
            let view = whole.size(48, 48);
            vec![view.iso(120.0, true)]
        }
        "wide-index" => vec![whole.size(41, 41).iso(127.0, true)],
        "clip-planes" => clipped(volume, whole),
        _ => {
            let view = whole.size(17, 17);
            let points = [(range.at(0.1), 0.0), (range.at(0.9), 0.5)];
            let mut scenes = vec![view.iso(range.at(0.45), true), view.mip()];
            if range.width() > 0.0 {
                scenes.push(view.dvr("dvr", unit_mm, &points));
            }
            scenes
        }
    }
}

/// The bump under planes: none, one, one that is not normalised, many of which one matters, two that
/// leave nothing, one through the eye, one along the rays.
fn clipped(volume: &Volume, whole: View) -> Vec<HardScene> {
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
