//! The scenes of what is as thin as pixels.

use glam::DVec3;

use super::super::HardScene;
use super::view::View;
use crate::volume::Volume;

/// The radius of the vessels of the hard case `pixel-lines` where their field is 127.5, in mm.
pub const LINE_RADIUS_MM: f64 = 1.0;

/// The most pixels along a side.
const MAX_SIDE_PX: f64 = 256.0;

/// The widths of a vessel in a picture, in pixels.
const WIDTHS_PX: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 3.0];

/// Toward eyes nearly above the slab, so that the picture's axes lie along none of the volume's.
const TOWARD: [(&str, DVec3); 3] = [
    ("a", DVec3::new(0.08, 0.05, 1.0)),
    ("b", DVec3::new(-0.03, 0.09, 1.0)),
    ("c", DVec3::new(0.06, -0.07, 1.0)),
];

/// Each width from each eye: `width-0.25-a-iso127.5-open` and so on.
pub fn pixel_lines(volume: &Volume) -> Vec<HardScene> {
    let (center, _) = volume.bounding_sphere();
    let whole_mm = volume.dims().array()[0] as f64;
    let of = |width_px: f64, (eye, toward): (&str, DVec3)| {
        let pixel_mm = 2.0 * LINE_RADIUS_MM / width_px;
        let side_px = (whole_mm / pixel_mm).min(MAX_SIDE_PX).round();
        let name = format!("width-{width_px}-{eye}");
        let view = View::ortho(name, center, toward, 2.0 * whole_mm, side_px * pixel_mm);
        view.size(side_px as u32, side_px as u32).iso(127.5, false)
    };
    let each = WIDTHS_PX.map(|width| TOWARD.map(|eye| of(width, eye)));
    each.into_iter().flatten().collect()
}
