//! What is refused of options before a volume is known.

use super::conflicts::CONTRADICTIONS;
use super::group::Keys;
use super::rules::{Group, Need, unmet};
use super::{SceneOptions, TransferChoice};
use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::scene::{DepthCues, Light, Mode, SamplingMethod};

/// The order in which needs are checked: that an option belongs to another mode says more than that
/// something else is missing.
const FIRST_NEEDS: [fn(Need) -> bool; 4] = [
    |need| need == Need::Eye,
    |need| matches!(need, Need::Modes(..)),
    |need| need == Need::Shading,
    |_| true,
];

impl SceneOptions {
    /// Refuses contradictions and reads the transfer function: all that can be known without the volume.
    ///
    /// # Errors
    /// Usage: options that contradict each other or mean nothing to the mode. A transfer function that
    /// cannot be read.
    pub fn checked(mut self) -> Result<Self> {
        self.camera.check()?;
        self.check_rules()?;
        self.clip.check()?;
        Light::check_count(self.picture.light.as_deref().unwrap_or_default())?;
        if let (Some(method), Some(quad)) = (self.sampling.sampling, self.picture.quad)
            && quad.sampling() != method
        {
            return Err(Error::usage(format!(
                "'sampling' = {method} cannot be combined with 'quad' = {quad}, which is {}",
                quad.sampling()
            ))
            .hint("leave one of both out: quad adaptive is dvr's exact sampling"));
        }
        self.sampling.sparse_in(self.mode())?;
        self.effects.check_cues(self.mode())?;
        DepthCues::filled_in(
            self.effects.cue.as_deref().unwrap_or_default(),
            ImageSize::DEFAULT,
        )?;
        if let Some(shadows) = self.effects.cast_shadows() {
            shadows.check(self.mode())?;
        }
        let voxels = self.sampling.voxels.unwrap_or_default();
        voxels.check(self.method(), self.sampling.filter.unwrap_or_default())?;
        if let Some(choice) = self.picture.tf.take() {
            self.picture.tf = Some(TransferChoice::Written(choice.read()?));
        }
        Ok(self)
    }

    /// Checks the options against the rules between them.
    ///
    /// # Errors
    /// Usage: an option lacks what it needs; two of them contradict each other.
    pub(super) fn check_rules(&self) -> Result<()> {
        if let Some(row) = CONTRADICTIONS.iter().find(|row| (row.is_in)(self)) {
            let error = Error::usage(row.sentence);
            return Err(match row.hint {
                "" => error,
                hint => error.hint(hint),
            });
        }
        let given = self.given();
        let missing = FIRST_NEEDS.iter().find_map(|is_first| {
            unmet(Group::Scene, &given, |need| {
                !is_first(need) || self.allows(need)
            })
        });
        match missing {
            None => Ok(()),
            Some((option, need)) => Err(self.refusal(option, need)),
        }
    }

    /// Whether these options have what one of them needs.
    pub(super) fn meets(&self, need: Need) -> bool {
        match need {
            Need::Modes(modes, _) | Need::IdleBeside(modes) => modes.contains(&self.mode()),
            Need::Steps => self.method() == SamplingMethod::Fixed,
            Need::Shading => self.picture.is_shaded(),
            Need::Normals => self.picture.has_normals(),
            Need::Precomputed(_) => {
                self.picture.gradient_method() == super::GradientMethod::Precomputed
            }
            Need::Eye => self.camera.eye.is_some(),
            Need::Homogeneity => self.picture.homogeneity.is_some(),
            Need::Sparse => self.sampling.is_sparse(),
            Need::Lens => self.effects.dof.is_some(),
            Need::Cues => self.effects.cue.is_some(),
            Need::Shadows => self.effects.shadows.is_some(),
            // Of options beside the scene.
            Need::OpenCl
            | Need::Layered
            | Need::Png
            | Need::Jpeg
            | Need::Animation
            | Need::AimedRays
            | Need::TimedFrames
            | Need::Rounds
            | Need::Volumes
            | Need::ResultsFolder => true,
        }
    }

    /// Whether an option with this need is accepted, be it without effect.
    pub(super) fn allows(&self, need: Need) -> bool {
        matches!(need, Need::IdleBeside(_) | Need::Steps) || self.meets(need)
    }

    fn refusal(&self, option: &str, need: Need) -> Error {
        let mode = self.mode();
        match need {
            Need::Modes(modes, why) => {
                let modes: Vec<&str> = modes.iter().map(|mode| Mode::name(*mode)).collect();
                Error::usage(format!(
                    "'{option}' cannot be combined with mode '{mode}': {why}"
                ))
                .hint(format!("it belongs to mode {}", modes.join(", ")))
            }
            Need::Precomputed(why) => Error::usage(format!(
                "'{option}' cannot be combined with gradient '{}': {why}",
                self.picture.gradient_method()
            ))
            .hint("it belongs to gradient precomputed"),
            Need::Eye => {
                Error::usage("'up' can only be given with 'eye': a view has an up of its own")
                    .hint("'roll' turns a view about its line of sight")
            }
            Need::Homogeneity => Error::usage(format!(
                "'homogeneity-rule' {} has no effect without 'homogeneity', its limit",
                self.picture.homogeneity_rule.unwrap_or_default()
            )),
            Need::Sparse => Error::usage(format!(
                "'{option}' has no effect without 'sparse': every pixel is cast"
            )),
            Need::Lens => Error::usage(format!(
                "'{option}' has no effect without 'dof': a pinhole has no lens"
            )),
            Need::Cues => Error::usage(format!(
                "'{option}' has no effect without 'cue': no colour depends on the depth"
            )),
            Need::Shadows => Error::usage(format!(
                "'{option}' has no effect without 'shadows': hard or soft, none are cast"
            )),
            _ => Error::usage(format!(
                "'{option}' has no effect in mode '{mode}' without shading"
            ))
            .hint("choose a shading: phong or blinn-phong"),
        }
    }
}
