//! The content of pictures: the cells that can show something, and the sphere around them.

use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use crate::error::Result;
use crate::render::abi::{StoredIso, stored};
use crate::render::resources::Knots;
use crate::scene::{Filter, Picture, Projection};
use crate::subject::Sphere;
use crate::volume::Volume;

use super::cells::may_cross;
use super::opacity_ranges::OpacityRanges;
use super::rows::Rows;

/// The bounding sphere of everything that pictures, each with its filter, can show of a volume: about the centre
/// of the box, along the voxel axes, around all cells that can show something. Where nothing can, or all of the
/// volume, it is the volume's.
///
/// A surface is shown by the cells whose values the iso value parts and, with caps, by those at or above it at
/// the volume's faces; a medium by those that hold a value that absorbs; a maximum (`mip`, `lmip`) by those
/// that exceed the lower end of the window. With the nearest filter a cell is a voxel's own box. All of the
/// volume is shown by a minimum and by a mean. Clip planes are no part of it.
///
/// # Errors
/// Not enough memory.
pub fn content_sphere(volume: &Volume, shown: &[(Picture, Filter)]) -> Result<Sphere> {
    let whole = Sphere::from(volume.bounding_sphere());
    let mut contents = Vec::new();
    for (picture, filter) in shown {
        let Some(rows) = content(volume, picture, *filter)? else {
            return Ok(whole);
        };
        contents.push(rows);
    }
    let world_from_index = volume.geometry().world_from_index();
    Ok(around(&contents, world_from_index).unwrap_or(whole))
}

/// The cells of which a picture can show something, row by row; `None`: it shows all of the volume.
fn content(volume: &Volume, picture: &Picture, filter: Filter) -> Result<Option<Rows>> {
    let rows = match picture {
        // The first cell of a row that has a corner inside has one outside, or is at the volume's face.
        Picture::Surface {
            iso, caps: true, ..
        } => {
            let iso = StoredIso::nearest(volume.rescale(), *iso);
            Rows::that_hold(volume, filter, |[_, max]| may_be_inside(max, iso))
        }
        Picture::Surface { iso, .. } => {
            let iso = StoredIso::nearest(volume.rescale(), *iso);
            match filter {
                Filter::Linear => Rows::that_hold(volume, filter, |range| may_cross(range, iso)),
                Filter::Nearest => Rows::at_steps(volume, |value| may_be_inside(value, iso)),
            }
        }
        Picture::Projection { of, window } => match of {
            Projection::Maximum | Projection::LocalMaximum { .. } => {
                let floor = stored(volume.rescale(), window.range().min);
                Rows::that_hold(volume, filter, |[_, max]| max > floor)
            }
            Projection::Minimum | Projection::Mean => return Ok(None),
        },
        Picture::Emission(emission) => {
            let knots = Knots::of(&emission.transfer, volume);
            let ranges = OpacityRanges::new(&knots);
            Rows::that_hold(volume, filter, |[min, max]| ranges.absorbs(min, max))
        }
    };
    rows.map(Some)
}

/// Whether a value may be inside a surface, as the kernels find its side.
fn may_be_inside(value: f32, iso: StoredIso) -> bool {
    value - iso.value >= -iso.error
}

/// The sphere around the cells of all rows; `None` where there are none.
fn around(contents: &[Rows], world_from_index: DAffine3) -> Option<Sphere> {
    let boxes = || contents.par_iter().flat_map(Rows::boxes);
    let join = |a: [DVec3; 2], b: [DVec3; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    let [least, greatest] = boxes().reduce_with(join)?;
    let center_world = world_from_index.transform_point3((least + greatest) * 0.5);
    let farthest = |corners: [DVec3; 2]| {
        let corner =
            |at: usize| DVec3::from_array([0, 1, 2].map(|axis| corners[at >> axis & 1][axis]));
        let distance = |at| {
            world_from_index
                .transform_point3(corner(at))
                .distance(center_world)
        };
        (0..8).map(distance).fold(0.0, f64::max)
    };
    let radius_mm = boxes().map(farthest).reduce(|| 0.0, f64::max);
    Some(Sphere {
        center_world,
        radius_mm,
    })
}
