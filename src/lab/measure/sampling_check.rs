//! Whether a picture depends on where along its rays the samples happen to lie.

use serde::Serialize;

use crate::error::Result;
use crate::frame::Wanted;
use crate::frame::error::differing_share;
use crate::render::Renderer;
use crate::scene::{Jitter, Scene, Shift, StepVoxels};

/// Two pictures of one scene, whose samples lie at whole steps from where rays enter the volume, and half-way between: how
/// many of their pixels differ visibly.
///
/// Samples at half a step from one another have nothing in common. What two such pictures agree on
/// hardly depends on the step; what they differ in at least one of them has wrong.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SamplingCheck {
    /// The step that was checked, in voxels of the smallest spacing.
    pub step: f64,
    /// The share of the pixels of which a channel, sRGB-encoded from 0 to 1, differs by more than 1/255.
    pub share: f64,
    /// The greatest share with which a step will do.
    pub limit: f64,
    /// The step itself where its share is within the limit, else the first of its halves, quarters and so on whose
    /// share is; `None` where none of them is that was tried.
    pub advised_step: Option<f64>,
    /// The share with that step.
    pub advised_share: Option<f64>,
}

impl SamplingCheck {
    /// The difference of a channel, sRGB-encoded from 0 to 1, that counts: a level of a display picture.
    pub const LEVEL: f64 = 1.0 / 255.0;

    /// The greatest share of differing pixels with which a step will do; why this: docs/accuracy.md.
    pub const LIMIT: f64 = 0.01;

    /// How often the step is halved in search of one that will do.
    const HALVINGS: u32 = 5;

    /// Checks the step of a scene whose samples are at fixed steps, and where it will not do looks for one that
    /// does. Every pixel is cast, as often as the scene asks for.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn of(renderer: &mut Renderer, scene: &Scene) -> Result<Self> {
        let step = scene.sampling.step.get();
        let share = differing(renderer, scene, step)?;
        let mut advised = Some((step, share)).filter(|_| share <= Self::LIMIT);
        for halvings in 1..=Self::HALVINGS {
            let finer = step / f64::from(1 << halvings);
            if advised.is_some() || StepVoxels::new(finer).is_err() {
                break;
            }
            let share = differing(renderer, scene, finer)?;
            advised = Some((finer, share)).filter(|_| share <= Self::LIMIT);
        }
        Ok(Self {
            step,
            share,
            limit: Self::LIMIT,
            advised_step: advised.map(|(step, _)| step),
            advised_share: advised.map(|(_, share)| share),
        })
    }

    /// Whether the step will do.
    pub fn passes(&self) -> bool {
        self.share <= self.limit
    }
}

/// The share of a scene's pixels that differ visibly between samples at whole steps and half-way between them.
fn differing(renderer: &mut Renderer, scene: &Scene, step: f64) -> Result<f64> {
    let mut checked = scene.clone();
    checked.sparse = None;
    checked.sampling.step = StepVoxels::new(step)?;
    let mut picture = |jitter| {
        checked.sampling.jitter = jitter;
        let rendering = renderer.render(&checked, Wanted::DISPLAY)?;
        Ok(rendering.frame)
    };
    let (whole, half) = (picture(Jitter::None)?, picture(Jitter::Shift(Shift::HALF))?);
    differing_share(&whole, &half, SamplingCheck::LEVEL)
}
