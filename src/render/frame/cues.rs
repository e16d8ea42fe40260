//! Depth cues: what colours tell of depth, once what they show is known.

use crate::error::Result;
use crate::render::passes::{Run, dim_at_edges, tint_by_depth};

use super::planes::Planes;
use super::view::View;

/// Tints and fades the colours of the run's rays, which are finished otherwise, by the depths of what they show, where the scene
/// asks for it. Each ray's once.
///
/// # Errors
/// As [`Run::cast`].
pub fn tint(run: &mut Run, view: &View, planes: &mut Planes) -> Result<()> {
    match &view.scene.depth_cues {
        Some(cues) if cues.tints() => tint_by_depth(run, cues, &planes.layers, &mut planes.color),
        _ => Ok(()),
    }
}

/// Dims the colours of a whole picture, which is finished otherwise, where depths of neighbouring pixels differ, where the scene
/// asks for it.
///
/// # Errors
/// As [`Run::screen`].
pub fn draw_edges(run: &mut Run, view: &View, planes: &mut Planes) -> Result<()> {
    match &view.scene.depth_cues {
        Some(cues) if cues.draws_edges() => {
            dim_at_edges(run, cues, &planes.layers, &mut planes.color)
        }
        _ => Ok(()),
    }
}
