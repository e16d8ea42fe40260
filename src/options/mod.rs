//! Options: the flags of the command line, the keys of the scene file and the stats' `scene`
//! are this one thing.
//!
//! They have two forms. *As given* every option may be absent ([`SceneOptions`]). *As resolved* they are
//! the [`Scene`](crate::scene::Scene): [`SceneOptions::resolve`] applies the defaults, which depend on the
//! volume. With the scene it gives the options that make the same scene again and leave nothing to a default.
//!
//! What an option needs and what applies without it is in one table (`rules`), which options exclude or
//! replace each other beside it (`conflicts`); where helps begin and end is made of the table (`help`).
//!
//! What does not determine the picture (its file, the device) is no scene option, but its flags can
//! be keys of a scene file all the same: any group of them can be taken from a [`SceneFile`].

mod camera;
mod carm;
mod check;
mod clip;
mod conflicts;
mod effects;
mod enum_names;
mod error_bound;
mod framing;
pub(crate) mod group;
pub(crate) mod help;
mod lights;
mod max_error;
mod notes;
mod of_mode;
mod order_statistics;
mod picture;
mod precedence;
mod quantities;
mod resolve;
pub(crate) mod rules;
mod sampling;
mod scene_file;
mod setting;
mod shade_from;
mod step_cost;
pub(crate) mod text_form;
mod threshold;
mod to_picture;
mod tone;
mod transfer_choice;
mod triple;
mod volume;

pub use camera::CameraOptions;
pub use carm::CArm;
pub use clip::ClipOptions;
pub use effects::EffectOptions;
pub use enum_names::{Fit, GradientMethod, NonFiniteRule, Shading, Switch};
pub use error_bound::{ErrorBound, ErrorMetric};
pub use max_error::ToleranceOptions;
pub use picture::PictureOptions;
pub use quantities::{AngleDeg, Count, GradientScale, SigmaMm, SigmaVoxels, Zoom};
pub use resolve::Resolved;
pub use sampling::SamplingOptions;
pub use scene_file::{Part, SceneFile, flag_names};
pub use setting::Setting;
pub use shade_from::ShadeFrom;
pub use threshold::{Threshold, WindowEnds};
pub use tone::ToneOptions;
pub use transfer_choice::TransferChoice;
pub use triple::{SpacingMm, Triple};
pub use volume::{FilePath, RawSizeText, VolumeOptions};

use crate::scene::Mode;
use group::Keys;

/// Everything that determines a picture, as far as it is given: by flags, by a scene file, or by
/// flags over a scene file ([`SceneOptions::over`]).
#[derive(Debug, Clone, PartialEq, Default, clap::Args, serde::Serialize)]
#[command(mut_args(help::completed))]
pub struct SceneOptions {
    /// The volume and how it is read.
    #[command(flatten)]
    #[serde(flatten)]
    pub volume: VolumeOptions,
    /// What is shown of it.
    #[command(flatten)]
    #[serde(flatten)]
    pub picture: PictureOptions,
    /// From where it is seen.
    #[command(flatten)]
    #[serde(flatten)]
    pub camera: CameraOptions,
    /// Where it is cut open.
    #[command(flatten)]
    #[serde(flatten)]
    pub clip: ClipOptions,
    /// How rays are followed.
    #[command(flatten)]
    #[serde(flatten)]
    pub sampling: SamplingOptions,
    /// What light and lens do beyond reflection at a point.
    #[command(flatten)]
    #[serde(flatten)]
    pub effects: EffectOptions,
    /// How the picture is displayed.
    #[command(flatten)]
    #[serde(flatten)]
    pub tone: ToneOptions,
}

impl SceneOptions {
    /// Returns what kind of picture this is.
    pub fn mode(&self) -> Mode {
        self.picture.mode()
    }

    /// Returns these options, those not given taken from `base`, whatever they rule out in it.
    fn or(self, base: Self) -> Self {
        Self {
            volume: self.volume.over(base.volume),
            picture: self.picture.over(base.picture),
            camera: self.camera.over(base.camera),
            clip: self.clip.over(base.clip),
            sampling: self.sampling.over(base.sampling),
            effects: self.effects.over(base.effects),
            tone: self.tone.over(base.tone),
        }
    }
}

impl Keys for SceneOptions {
    fn given(&self) -> Vec<String> {
        [
            self.volume.given(),
            self.sampling.given(),
            self.picture.given(),
            self.camera.given(),
            self.clip.given(),
            self.effects.given(),
            self.tone.given(),
        ]
        .concat()
    }

    fn retaining(self, passes: impl Fn(&str) -> bool) -> Self {
        Self {
            volume: self.volume.retaining(&passes),
            picture: self.picture.retaining(&passes),
            camera: self.camera.retaining(&passes),
            clip: self.clip.retaining(&passes),
            sampling: self.sampling.retaining(&passes),
            effects: self.effects.retaining(&passes),
            tone: self.tone.retaining(&passes),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn given_keys_are_the_flags_names() {
        let options = PictureOptions {
            lmip_threshold: Some(Threshold::Otsu),
            shading: Some(Shading::Phong),
            ..PictureOptions::default()
        };
        assert_eq!(options.given(), ["lmip-threshold", "shading"]);
        let remaining = options.retaining(|key| key != "lmip-threshold");
        assert_eq!(remaining.given(), ["shading"]);
    }
}
