//! How wrong pictures are, in pixels drawn at random: the reference would take minutes for all of them.

use serde::{Deserialize, Serialize};

use crate::bench::draws::Draws;
use crate::bench::{Bench, Effort, Specimen};
use crate::error::Result;
use crate::extent::ImageSize;
use crate::frame::Frame;
use crate::measure::{Wrongness, judge_pixels, judged_planes, scale_of};
use crate::reference;
use crate::scene::{Mode, Scene};

/// Of the pixels drawn.
const SEED: u64 = 5;

/// How wrong a picture is; nothing where it has no such plane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Wrong {
    /// The mode's first of [`Wrongness::of_mode`].
    pub first: Option<f64>,
    pub color_rmse: Option<f64>,
    pub color_max: Option<f64>,
}

/// The reference's picture in some pixels.
pub struct Sparse<'a> {
    specimen: &'a Specimen,
    pixels: Vec<u32>,
    truth: Frame,
}

/// How many pixels are judged.
pub fn judged_pixels(effort: Effort) -> usize {
    match effort {
        Effort::Quick => 1024,
        Effort::Usual => 4096,
        Effort::Full => 16_384,
    }
}

/// Pixels of a picture, which is cut into so many parts of equal size, one of each at random; the same
/// for equal sizes.
fn drawn(size: ImageSize, effort: Effort) -> Vec<u32> {
    let mut draws = Draws::new(SEED);
    let parts = judged_pixels(effort).min(size.pixels());
    let bound = |part: usize| (part * size.pixels() / parts) as u32;
    let one = |part| bound(part) + draws.below(bound(part + 1) - bound(part));
    (0..parts).map(one).collect()
}

impl<'a> Sparse<'a> {
    /// # Errors
    /// As [`reference::render_pixels`].
    pub fn of(bench: &Bench, specimen: &'a Specimen, scene: &Scene) -> Result<Self> {
        let pixels = drawn(scene.size, bench.effort);
        let wanted = judged_planes(&scene.picture);
        let volume = &specimen.volume;
        let truth = reference::render_pixels(volume, scene, wanted, &pixels, bench.progress)?;
        Ok(Self {
            specimen,
            pixels,
            truth,
        })
    }

    /// # Errors
    /// An entry that cannot be compared.
    pub fn wrong(&self, mode: Mode, frame: &Frame) -> Result<Wrong> {
        let scale = scale_of(&self.specimen.volume);
        let figures = judge_pixels(&self.truth, frame, &self.pixels, scale)?;
        let first = &Wrongness::of_mode(mode)[0];
        Ok(Wrong {
            first: first.unscaled(&figures),
            color_rmse: figures.color.map(|color| color.rmse),
            color_max: figures.color.map(|color| color.max),
        })
    }
}
