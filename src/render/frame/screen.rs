//! Ambient occlusion estimated from the picture: the passes behind the casts of `iso`.

use crate::error::Result;
use crate::frame::Layer;
use crate::render::abi::SurfaceCast;
use crate::render::passes::{
    Run, Surroundings, Thickness, screen_occlusion, smooth_occlusion, thickness,
};
use crate::render::resources::{Screen, Sections, Spans};
use crate::scene::{DistanceMm, ScreenOcclusion};

use super::planes::{Planes, ScreenPlanes};
use super::view::View;

/// Estimates ambient occlusion from the picture.
pub struct ScreenPasses {
    asked: ScreenOcclusion,
    sections: Sections,
}

impl ScreenPasses {
    /// The passes, with their tables uploaded.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(run: &Run, asked: ScreenOcclusion) -> Result<Self> {
        let (sections, steps) = (asked.samples.sections(), asked.samples.steps());
        Ok(Self {
            asked,
            sections: Sections::upload(run.device, sections, steps)?,
        })
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.sections.bytes()
    }

    /// Room for what the passes hand on.
    ///
    /// # Errors
    /// The device has no room; the rays belong to no picture.
    pub fn planes(&self, run: &Run, view: &View) -> Result<ScreenPlanes> {
        let screen = Screen::of(&view.scene.camera, view.footprint(run)?);
        Ok(ScreenPlanes {
            spans: Spans::new(run.device, &run.rays, screen)?,
            estimate: run.plane("estimates of occlusion", 0.0)?,
        })
    }

    /// How thick what is hit is taken to be; `None`: as thick as it is.
    pub fn thickness(&self) -> Option<Thickness<'static>> {
        let constant = |mm: DistanceMm| Thickness::Constant(mm.get() as f32);
        self.asked.thickness.map(constant)
    }

    /// Fills the occlusion of the whole picture.
    ///
    /// # Errors
    /// As [`Run::screen`].
    pub fn find(
        &self,
        run: &mut Run,
        view: &View,
        cast: &SurfaceCast,
        planes: &mut Planes,
    ) -> Result<()> {
        let Planes {
            hit_mm: Some(hit_mm),
            screen: Some(ScreenPlanes { spans, estimate }),
            layers,
            ..
        } = planes
        else {
            return Ok(());
        };
        let radius_mm = self.asked.radius.get() as f32;
        let around = Surroundings {
            sections: &self.sections,
            radius_mm,
        };
        let seen = (&*spans, &*hit_mm, &*layers);
        screen_occlusion(run, view.inputs, cast.iso, around, seen, estimate)?;
        smooth_occlusion(run, radius_mm, spans, estimate, layers)
    }
}

/// Fills the layer where there is one, and the spans where the picture's occlusion is estimated from them: by how thick what is
/// hit is taken to be, or without that as thick as it is.
///
/// # Errors
/// As [`Run::cast`].
pub fn find_thickness(
    run: &mut Run,
    exact: Thickness,
    taken: Option<Thickness>,
    planes: &mut Planes,
) -> Result<()> {
    let Planes {
        hit_mm: Some(hit_mm),
        screen,
        layers,
        ..
    } = planes
    else {
        return Ok(());
    };
    let has_layer = layers.has(Layer::Thick);
    let mut spans = screen.as_mut().map(|screen| &mut screen.spans);
    if let (Some(taken), Some(spans)) = (taken, spans.take_if(|_| taken.is_some())) {
        thickness(run, taken, hit_mm, Some(spans), false, layers)?;
    }
    if spans.is_none() && !has_layer {
        return Ok(());
    }
    thickness(run, exact, hit_mm, spans, has_layer, layers)
}
