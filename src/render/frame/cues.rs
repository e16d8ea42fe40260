//! Depth cues: what colours tell of depth, once what they show is known.

use crate::error::Result;
use crate::frame::{Layer, Wanted};
use crate::render::passes::{Run, dim_at_edges, tint_by_depth};
use crate::scene::Scene;

use super::planes::Planes;
use super::view::View;

/// Adds the planes that the colours of a scene's rays need: depths, and for colours at the rim of things normals.
pub fn with_cues(scene: &Scene, wanted: Wanted) -> Wanted {
    let cues = scene.depth_cues;
    wanted
        .with_if(cues.is_some(), Layer::Depth)
        .with_if(cues.is_some_and(|cues| cues.rim().is_some()), Layer::Normal)
}

/// Tints and fades the colours of the run's rays, which are finished otherwise, by the depths of what they show, where the scene
/// asks for it. Each ray's once.
///
/// # Errors
/// As [`Run::cast`].
pub fn tint(run: &mut Run, view: &View, planes: &mut Planes) -> Result<()> {
    match &view.scene.depth_cues {
        Some(cues) if cues.tint() => tint_by_depth(run, cues, &planes.layers, &mut planes.color),
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
        Some(cues) if cues.draw_edges() => {
            dim_at_edges(run, cues, &planes.layers, &mut planes.color)
        }
        _ => Ok(()),
    }
}
