//! From a scene's kind of picture to its passes.

use crate::error::{Error, Result};
use crate::render::occupancy::Criterion;
use crate::render::passes::Run;
use crate::scene::Picture;

use super::emission::EmissionPasses;
use super::projection::ProjectionPasses;
use super::schedule::Schedule;
use super::surface::{Surface, SurfacePasses};
use super::view::View;

/// The passes of the scene's kind of picture, which casts by the numbers that its nodes were classified by.
///
/// # Errors
/// As [`EmissionPasses::new`]; nodes were classified for another kind of picture.
pub fn schedule<'a>(run: &Run, view: &'a View<'a>) -> Result<Box<dyn Schedule + 'a>> {
    Ok(
        match (&view.scene.picture, view.inputs.occupancy.criterion()) {
            (
                Picture::Surface {
                    caps,
                    refine,
                    color,
                    phong,
                    ..
                },
                Criterion::Iso(iso),
            ) => {
                let seen = Surface {
                    caps: *caps,
                    refine: *refine,
                    color: *color,
                    phong: *phong,
                };
                Box::new(SurfacePasses::new(run, view, *iso, &seen)?)
            }
            (Picture::Projection { of, window }, Criterion::Floor(floor)) => {
                Box::new(ProjectionPasses::new(view, *of, *window, *floor))
            }
            (Picture::Emission(medium), Criterion::Opacity(opacity)) => {
                Box::new(EmissionPasses::new(run, view, medium, opacity)?)
            }
            _ => {
                return Err(Error::failed(
                    "the octree's nodes were classified for another kind of picture",
                ));
            }
        },
    )
}
