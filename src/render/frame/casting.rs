//! How many rays a picture has: one a pixel, fewer, or more.

use crate::error::Result;
use crate::render::passes::Run;
use crate::scene::DofMethod;

use super::antialias::cast_antialiased;
use super::blur::{gather, mix};
use super::cues::{draw_edges, tint};
use super::lens::see_through_lens;
use super::picture::schedule;
use super::planes::Planes;
use super::sparse::cast_sparsely;
use super::view::View;

/// Casts the scene's picture: every pixel once, or where the picture is a `whole` one as many rays as the scene
/// asks for, and through its lens.
///
/// # Errors
/// As [`schedule`], [`Run::cast`], [`gather`] and [`see_through_lens`].
pub fn cast_picture(run: &mut Run, view: &View, is_whole: bool) -> Result<Planes> {
    let mut planes = cast_through_pinhole(run, view, is_whole)?;
    if let Some(dof) = view.scene.depth_of_field.filter(|_| is_whole) {
        match view.scene.sampling.dof {
            DofMethod::Gather => gather(run, view, &mut planes, dof)?,
            DofMethod::Mix => mix(run, view, &mut planes, dof)?,
            DofMethod::Lens(rays) => see_through_lens(run, view, &mut planes, dof, rays)?,
        }
    }
    Ok(planes)
}

fn cast_through_pinhole(run: &mut Run, view: &View, is_whole: bool) -> Result<Planes> {
    let schedule = schedule(run, view)?;
    let aa = view.scene.anti_aliasing;
    if let Some(sparse) = view.scene.sparse.filter(|_| is_whole) {
        return cast_sparsely(run, view, schedule.as_ref(), sparse);
    }
    if aa.rays() > 1 && is_whole {
        return cast_antialiased(run, view, schedule.as_ref(), aa);
    }
    let mut planes = schedule.planes(run)?;
    schedule.cast(run, &mut planes)?;
    schedule.finish(run, &mut planes)?;
    tint(run, view, &mut planes)?;
    if is_whole {
        draw_edges(run, view, &mut planes)?;
    }
    planes.rays_per_round.push(run.rays.count() as u64);
    Ok(planes)
}
