//! How far each setting of an effect is from the reference, and what it costs.

use serde::{Deserialize, Serialize};

use super::effect::{Effect, JudgedBy};
use super::side_px;
use crate::error::Result;
use crate::frame::error::{FocusError, PartError, ShareError, focus_error, share_error};
use crate::frame::{Frame, OCCLUSION, VISIBILITY};
use crate::lab::bench::{Bench, Dataset, display_ms};
use crate::lab::measure::{Times, evaluated_planes};
use crate::reference;
use crate::scene::Scene;

/// A setting of an effect, measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tried {
    /// The option that makes the effect; `None`: the picture without it.
    pub option: Option<String>,
    /// Its setting.
    pub setting: String,
    pub error: EffectError,
    pub times: Times,
}

impl Tried {
    pub fn name(&self) -> String {
        match &self.option {
            Some(option) => format!("{option} {}", self.setting),
            None => self.setting.clone(),
        }
    }
}

/// How far an effect is from the reference's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum EffectError {
    /// Of a share of light, at each hit.
    Share(ShareError),
    /// Of colours.
    Colors(FocusRmse),
}

/// Root mean square differences of sRGB-encoded colours, 0..1; `None` where a part of the picture has no pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FocusRmse {
    /// Of all that is seen through the lens.
    pub all: Option<f64>,
    pub in_focus: Option<f64>,
    pub near: Option<f64>,
    pub far: Option<f64>,
    pub beside: Option<f64>,
}

impl From<FocusError> for FocusRmse {
    fn from(error: FocusError) -> Self {
        let FocusError {
            in_focus,
            near,
            far,
            beside,
            ..
        } = error;
        let parts = [in_focus, near, far, beside];
        let pixels: u64 = parts.iter().map(|part| part.pixels).sum();
        let squares = |part: &PartError| Some(part.rmse?.powi(2) * part.pixels as f64);
        let sum: f64 = parts.iter().filter_map(squares).sum();
        Self {
            all: (pixels > 0).then(|| (sum / pixels as f64).sqrt()),
            in_focus: in_focus.rmse,
            near: near.rmse,
            far: far.rmse,
            beside: beside.rmse,
        }
    }
}

impl EffectError {
    /// Compares what the effect is judged by.
    fn of(judged_by: JudgedBy, reference: &Frame, frame: &Frame) -> Result<Self> {
        Ok(match judged_by {
            JudgedBy::Occlusion => Self::Share(share_error(reference, frame, OCCLUSION)?),
            JudgedBy::Visibility => Self::Share(share_error(reference, frame, VISIBILITY)?),
            JudgedBy::Colors => Self::Colors(focus_error(reference, frame)?.into()),
        })
    }

    /// The error that stands for all: the mean, or the root mean square; `None`: nothing was compared.
    pub fn whole(&self) -> Option<f64> {
        match self {
            Self::Share(error) => error.mean,
            Self::Colors(error) => error.all,
        }
    }

    pub fn share(&self) -> Option<&ShareError> {
        match self {
            Self::Share(error) => Some(error),
            Self::Colors(_) => None,
        }
    }

    pub fn colors(&self) -> Option<&FocusRmse> {
        match self {
            Self::Share(_) => None,
            Self::Colors(error) => Some(error),
        }
    }
}

/// A picture that is tried.
struct Trial {
    option: Option<&'static str>,
    setting: &'static str,
    scene: Scene,
}

/// The picture without the effect, and then with each of its settings.
fn trials(effect: &Effect, dataset: &Dataset, side_px: u32) -> Result<Vec<Trial>> {
    let without = effect.shown.scene(dataset, side_px)?;
    let mut trials = vec![Trial {
        option: None,
        setting: "without",
        scene: without.clone(),
    }];
    for option in effect.options {
        for setting in option.settings {
            trials.push(Trial {
                option: Some(option.name),
                setting,
                scene: (option.on)(without.clone(), dataset, setting)?,
            });
        }
    }
    Ok(trials)
}

/// Measures the picture without an effect and with each of its settings: the errors from the camera's first place, against one
/// picture of the reference, and the times in turn.
///
/// # Errors
/// The device, the reference, memory; stopped.
pub fn measure(bench: &Bench, dataset: &Dataset, effect: &Effect) -> Result<Vec<Tried>> {
    let trials = trials(effect, dataset, side_px(bench.preset))?;
    // What the reference renders is the same for all settings: the last stands for them.
    let asked = &trials[trials.len() - 1].scene;
    let wanted = evaluated_planes(asked);
    let reference = reference::render(&dataset.volume, asked, wanted, bench.progress)?;
    let octree = bench.octree(dataset)?;
    let mut renderer = bench.renderer(dataset, &octree)?;
    let mut errors = Vec::new();
    for trial in &trials {
        bench.check_stop()?;
        let mut frame = renderer.render(&trial.scene, wanted)?.frame;
        if trial.scene.shadows.is_none() && effect.judged_by == JudgedBy::Visibility {
            // Without shadows all of the light reaches everything; the layer would say that nothing is known.
            frame
                .layers
                .plane_mut(VISIBILITY)
                .into_iter()
                .for_each(|plane| plane.fill(1.0));
        }
        errors.push(EffectError::of(effect.judged_by, &reference, &frame)?);
    }
    let times = bench.times_under(bench.protocol(), &trials, |trial, azimuth_deg| {
        display_ms(&mut renderer, &trial.scene, azimuth_deg)
    })?;
    let tried = trials.iter().zip(errors).zip(times);
    let tried = tried.map(|((trial, error), times)| Tried {
        option: trial.option.map(str::to_owned),
        setting: trial.setting.to_owned(),
        error,
        times,
    });
    Ok(tried.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(pixels: u64, rmse: Option<f64>) -> PartError {
        PartError {
            pixels,
            rmse,
            psnr_db: rmse.map(|rmse| -20.0 * rmse.log10()),
        }
    }

    #[test]
    fn parts_count_by_their_pixels() {
        let none = part(0, None);
        let of = |in_focus, far| {
            FocusRmse::from(FocusError {
                in_focus,
                near: none,
                far,
                beside: none,
                silhouette: None,
            })
        };
        let rmse = of(part(30, Some(0.1)), part(10, Some(0.3)));
        let all = ((30.0 * 0.01 + 10.0 * 0.09) / 40.0_f64).sqrt();
        assert!((rmse.all.unwrap() - all).abs() < 1e-15);
        assert_eq!((rmse.near, rmse.far), (None, Some(0.3)));
        assert_eq!(of(none, none).all, None);
        // The control: the mean of the parts is another number.
        assert!((rmse.all.unwrap() - 0.2).abs() > 0.01);
    }
}
