//! The candidates: the pictures in their settings.

use super::medium::Medium;
use super::picture::{PictureKind, scene};
use crate::error::Result;
use crate::lab::bench::Dataset;
use crate::scene::{Quadrature, Sampling, SamplingMethod, Scene};

/// A picture in one setting.
pub struct Candidate {
    pub kind: PictureKind,
    pub setting: String,
    /// The scene, from the middle of the camera's path.
    pub scene: Scene,
}

/// Everything that is timed in pictures of one size, `media` in the settings chosen for them.
pub fn candidates(dataset: &Dataset, side_px: u32, media: &[Medium]) -> Result<Vec<Candidate>> {
    let fixed = Sampling {
        method: SamplingMethod::Fixed,
        ..Sampling::default()
    };
    let (exact, plain) = (Sampling::default(), Quadrature::default());
    let steps = format!("step {}", fixed.step);
    let mut all = Vec::new();
    for (kind, setting, sampling) in [
        (PictureKind::Surface, "exact", exact),
        (PictureKind::Surface, &steps, fixed),
        (PictureKind::Maximum, "exact", exact),
        (PictureKind::Maximum, &steps, fixed),
        (PictureKind::Mean, "exact", exact),
        (PictureKind::LocalMaximum, "exact", exact),
    ] {
        all.push(Candidate {
            kind,
            setting: setting.to_owned(),
            scene: scene(dataset, kind, side_px, sampling, plain)?,
        });
    }
    for medium in media {
        all.push(Candidate {
            kind: medium.kind(),
            setting: medium.setting(),
            scene: medium.scene(dataset, side_px)?,
        });
    }
    Ok(all)
}
