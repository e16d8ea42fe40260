//! `--check-sampling`: whether the step will do, and which one would.

use crate::error::{Error, Result};
use crate::lab::measure::SamplingCheck;
use crate::number_text::concise;
use crate::options::group::group;
use crate::options::{ErrorBound, Switch};
use crate::progress::{Progress, Stage, UNKNOWN_TOTAL};
use crate::scene::{Mode, SamplingMethod, Scene};

use super::backend::{Backend, Caster};

group! {
    /// The options by which a picture's sampling is checked.
    #[command(next_help_heading = "Sampling")]
    pub struct CheckOptions {
        /// Draw the picture twice more, its samples shifted by half a step the second time; print how many pixels
        /// differ by more than 1/255, and the step to take instead where that is more than 1 %
        #[arg(long, value_name = "on|off", num_args = 0..=1, require_equals = true,
            default_missing_value = "on")]
        check_sampling: Switch,
    }
}

impl CheckOptions {
    /// Whether the sampling is to be checked.
    ///
    /// # Errors
    /// Usage: it is, and there is nothing to check whatever the scene.
    pub fn wanted(&self, backend: &Backend, bound: Option<ErrorBound>) -> Result<bool> {
        let wanted = self.check_sampling.is_some_and(Switch::is_on);
        if wanted && matches!(backend, Backend::Reference) {
            return Err(Error::usage(
                "'check-sampling' is for OpenCL devices: the reference takes no samples at steps",
            ));
        }
        if wanted && bound.is_some() {
            return Err(Error::usage(
                "'check-sampling' and 'max-error' cannot be combined: what a bound chooses is held against the reference itself",
            )
            .hint("leave one of the two out"));
        }
        Ok(wanted)
    }
}

/// Checks the step of a scene.
///
/// # Errors
/// Usage: no samples are taken at steps. As [`SamplingCheck::of`].
pub fn check(caster: &mut Caster, scene: &Scene, progress: &dyn Progress) -> Result<SamplingCheck> {
    let exact = match scene.picture.mode() {
        Mode::Dvr => "quad adaptive",
        _ => "exact sampling",
    };
    match caster {
        Caster::Device { renderer, .. } if scene.sampling_method() == SamplingMethod::Fixed => {
            let _stage = Stage::begin(progress, "checking the sampling", UNKNOWN_TOTAL);
            SamplingCheck::of(renderer, scene)
        }
        _ => Err(Error::usage(format!(
            "'check-sampling' has nothing to check: {exact} takes no samples at steps"
        ))
        .hint("leave it out, or give a --step")),
    }
}

/// What was found, and what to do about it.
pub fn line(check: &SamplingCheck, mode: Mode) -> String {
    let percent = |share: f64| format!("{} %", concise(rounded(100.0 * share)));
    let found = format!(
        "sampling: {} of the pixels differ by more than 1/255 when all samples are shifted by half a step",
        percent(check.share)
    );
    let step = concise(check.step);
    let limit = percent(check.limit);
    let advised = check.advised_step.zip(check.advised_share);
    match advised {
        _ if check.passes() => format!("{found}: step {step} will do"),
        Some((finer, share)) => format!(
            "{found}: use step {}, with which {} do",
            concise(finer),
            percent(share)
        ),
        None => format!(
            "{found}: no step that was tried brings that below {limit}; {} takes no steps",
            match mode {
                Mode::Dvr => "--quad adaptive",
                _ => "--sampling exact",
            }
        ),
    }
}

/// A number to two digits.
fn rounded(number: f64) -> f64 {
    format!("{number:.1e}").parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_says_what_to_do() {
        let check = |share, advised_step: Option<f64>| SamplingCheck {
            step: 2.0,
            share,
            limit: 0.01,
            advised_step,
            advised_share: advised_step.map(|_| 0.004),
        };
        let fine = line(&check(0.004, Some(2.0)), Mode::Iso);
        assert!(fine.ends_with(": step 2 will do"), "{fine}");
        let coarse = line(&check(0.2468, Some(0.5)), Mode::Iso);
        assert!(coarse.starts_with("sampling: 25 % of the pixels"));
        assert!(
            coarse.ends_with(": use step 0.5, with which 0.4 % do"),
            "{coarse}"
        );
        for (mode, instead) in [
            (Mode::Mip, "--sampling exact"),
            (Mode::Dvr, "--quad adaptive"),
        ] {
            let none = line(&check(0.25, None), mode);
            assert!(none.ends_with(&format!("below 1 %; {instead} takes no steps")));
        }
    }
}
