//! `--max-error`: a bound in the place of how rays are followed.

use super::group::{Keys, group};
use super::rules::{Decides, Group, deciding, rule};
use super::{ErrorBound, SceneOptions};
use crate::error::{Error, Result};
use crate::scene::Storage;

group! {
    /// The options by which the program decides how rays are followed.
    #[command(next_help_heading = "Sampling", mut_args(super::help::completed_bound))]
    pub struct ToleranceOptions {
        /// Follow rays by the cheapest setting whose error, against the double-precision reference, is
        /// within BOUND: rmse, max (1/255), p99, psnr (dB, at least) of the colours; in iso depth
        /// (voxels) and missed (a share, 0.1%) hits; in projections value (a share of the value
        /// range). Found by a probe and verified
        #[arg(long, value_name = "METRIC:BOUND")]
        max_error: ErrorBound,
    }
}

impl ToleranceOptions {
    /// Flags over a scene file's options: a bound among the flags drops what the file says of how
    /// rays are followed, which among the flags drops the file's bound, as does a mode that has not
    /// its metric.
    #[must_use]
    pub fn over_file(self, file: Self, flags: &SceneOptions, scene: &mut SceneOptions) -> Self {
        if self.max_error.is_some() {
            *scene = std::mem::take(scene).undecided();
            return self;
        }
        let suits = |bound: &ErrorBound| {
            let mode = flags.picture.mode;
            flags.decided().is_empty() && mode.is_none_or(|mode| bound.metric().is_of(mode))
        };
        Self {
            max_error: file.max_error.filter(suits),
        }
    }

    /// Checks that the bound goes with the other options.
    ///
    /// # Errors
    /// Usage: a bound that the mode has no metric for, or beside options of which it takes the
    /// place.
    pub fn check(&self, scene: &SceneOptions) -> Result<()> {
        let Some(bound) = self.max_error else {
            return Ok(());
        };
        if let Some(key) = scene.decided().first() {
            return Err(Error::usage(format!(
                "'max-error' and '{key}' cannot be combined: a bound decides by itself how rays are followed"
            ))
            .hint(format!(
                "leave out {}, or 'max-error'",
                deciding(|decides| decides == Decides::HowWithinBound)
                    .collect::<Vec<_>>()
                    .join(", ")
            )));
        }
        if scene.sampling.voxels == Some(Storage::Filtered) {
            return Err(Error::usage(
                "'max-error' and 'voxels' = filtered cannot be combined: a bound may choose exact sampling, which solves the field from the voxels themselves",
            )
            .hint("leave one of the two out, or use --voxels image"));
        }
        bound.check(scene.mode())
    }
}

impl SceneOptions {
    /// The options given of which an error bound takes the place.
    fn decided(&self) -> Vec<String> {
        let mut options = self.given();
        options.retain(|option| is_decided(option));
        options
    }

    /// Removes the options that an error bound decides.
    #[must_use]
    pub fn undecided(self) -> Self {
        self.retaining(|option| !is_decided(option))
    }
}

fn is_decided(option: &str) -> bool {
    let rule = rule(Group::Scene, option);
    rule.is_some_and(|rule| rule.decides == Decides::HowWithinBound)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_excludes_what_it_decides_and_nothing_else() {
        let bound = ToleranceOptions {
            max_error: Some("rmse:0.01".parse().unwrap()),
        };
        let parse = |text: &str| SceneOptions::parse(text, "scene").unwrap();
        for text in [
            "step = 1",
            "sampling = 'exact'",
            "probe = 'off'",
            "refine = 'none'",
            "mode = 'dvr'\nquad = 'simpson'",
            "mode = 'dvr'\nhomogeneity = 0.1",
            "mode = 'dvr'\ntermination = 0.9",
        ] {
            let refused = bound.check(&parse(text)).unwrap_err();
            assert!(
                refused.to_string().contains("cannot be combined"),
                "{refused}"
            );
            assert!(ToleranceOptions::default().check(&parse(text)).is_ok());
            assert!(bound.check(&parse(text).undecided()).is_ok(), "{text}");
        }
        for text in [
            "",
            "filter = 'nearest'",
            "traverse = 'uniform'",
            "gradient = 'forward'",
            "voxels = 'image'",
        ] {
            bound.check(&parse(text)).unwrap();
        }
        let filtered = parse("mode = 'dvr'\nvoxels = 'filtered'");
        assert!(bound.check(&filtered).is_err());
    }

    #[test]
    fn flags_win_over_the_file() {
        let bound = |text: &str| ToleranceOptions {
            max_error: Some(text.parse().unwrap()),
        };
        let parse = |text: &str| SceneOptions::parse(text, "scene").unwrap();
        let none = ToleranceOptions::default;
        let mut scene = parse("step = 2\nfilter = 'nearest'");
        let over = bound("max:0.1").over_file(bound("rmse:0.1"), &parse(""), &mut scene);
        assert_eq!(
            (over, scene),
            (bound("max:0.1"), parse("filter = 'nearest'"))
        );
        let mut scene = parse("step = 2");
        let over = none().over_file(bound("rmse:0.1"), &parse("step = 1"), &mut scene);
        assert_eq!((over, scene), (none(), parse("step = 2")));
        for (of_file, flags, remaining) in [
            ("rmse:0.1", "iso = 1", true),
            ("depth:0.1", "mode = 'iso'", true),
            ("depth:0.1", "mode = 'mip'", false),
        ] {
            let over = none().over_file(bound(of_file), &parse(flags), &mut parse(""));
            assert_eq!(over == bound(of_file), remaining, "{of_file} {flags}");
            assert_eq!(over == none(), !remaining);
        }
    }
}
