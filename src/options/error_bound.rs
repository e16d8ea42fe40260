//! `METRIC:BOUND`: how far off a picture may be.

use std::fmt;
use std::str::FromStr;

use super::text_form::text_form;
use crate::error::{Error, Result};
use crate::number_text::{concise, number};
use crate::scene::Mode;

/// A figure by which a picture is held against the reference's of the same scene; as
/// `frame::error` defines each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ErrorMetric {
    /// Colour, sRGB-encoded 0..1: the root of the mean square.
    Rmse,
    /// Colour: the greatest difference of a channel.
    Max,
    /// Colour: what 99 of 100 differences do not exceed.
    P99,
    /// Colour: −20 log₁₀ rmse, dB; a bound from below.
    Psnr,
    /// Surfaces: the greatest difference of depth of any pixel, voxels of the smallest spacing; a
    /// missed or extra hit is beyond any.
    Depth,
    /// Surfaces: missed and extra hits, as a share of the reference's hits.
    Missed,
    /// Projections: the greatest difference of value, as a share of the volume's value range.
    Value,
}

impl ErrorMetric {
    /// All metrics, in the order in which they are listed to users.
    pub const ALL: [Self; 7] = [
        Self::Rmse,
        Self::Max,
        Self::P99,
        Self::Psnr,
        Self::Depth,
        Self::Missed,
        Self::Value,
    ];

    /// The metric's name, as users write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rmse => "rmse",
            Self::Max => "max",
            Self::P99 => "p99",
            Self::Psnr => "psnr",
            Self::Depth => "depth",
            Self::Missed => "missed",
            Self::Value => "value",
        }
    }

    /// Whether pictures of this mode have such an error.
    pub fn is_of(self, mode: Mode) -> bool {
        match self {
            Self::Rmse | Self::Max | Self::P99 | Self::Psnr => true,
            Self::Depth | Self::Missed => mode == Mode::Iso,
            Self::Value => !matches!(mode, Mode::Iso | Mode::Dvr),
        }
    }

    /// The bounds that make sense, in words.
    fn domain(self) -> &'static str {
        match self {
            Self::Rmse | Self::Max | Self::P99 => {
                "a number above 0 and at most 1, such as 0.002 or 1/255"
            }
            Self::Psnr => "decibels above 0 and at most 200, such as 40",
            Self::Depth => "voxels above 0, at most 1e6, such as 0.05 or 0.05vox",
            Self::Missed => "a share from 0 to 1 or 100%, such as 0.1%",
            Self::Value => "a share above 0 and at most 1 or 100%, such as 0.5%",
        }
    }

    fn takes(self, bound: f64) -> bool {
        match self {
            Self::Rmse | Self::Max | Self::P99 | Self::Value => bound > 0.0 && bound <= 1.0,
            Self::Psnr => bound > 0.0 && bound <= 200.0,
            Self::Depth => bound > 0.0 && bound <= 1e6,
            Self::Missed => (0.0..=1.0).contains(&bound),
        }
    }
}

impl fmt::Display for ErrorMetric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// `METRIC:BOUND`: the metric's figure must not exceed the bound (psnr: must reach it).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorBound {
    metric: ErrorMetric,
    bound: f64,
}

impl ErrorBound {
    /// Makes a bound of a metric.
    ///
    /// # Errors
    /// A bound that the metric cannot have.
    pub fn new(metric: ErrorMetric, bound: f64) -> Result<Self> {
        if metric.takes(bound) {
            return Ok(Self { metric, bound });
        }
        Err(Error::usage(format!(
            "a bound of {} for {metric} is out of its domain: it must be {}",
            concise(bound),
            metric.domain()
        )))
    }

    /// The metric that is bounded.
    pub fn metric(self) -> ErrorMetric {
        self.metric
    }

    /// The bound, in the metric's unit.
    pub fn bound(self) -> f64 {
        self.bound
    }

    /// Returns whether a figure of the metric is within the bound; NaN never is.
    pub fn is_met_by(self, figure: f64) -> bool {
        match self.metric {
            ErrorMetric::Psnr => figure >= self.bound,
            _ => figure <= self.bound,
        }
    }

    /// Checks that pictures of this mode have such an error.
    ///
    /// # Errors
    /// Usage: pictures of the mode have no such error.
    pub fn check(self, mode: Mode) -> Result<()> {
        let metric = self.metric;
        if metric.is_of(mode) {
            return Ok(());
        }
        let why = match metric {
            ErrorMetric::Value => "only a projection shows values",
            _ => "only a surface is hit at a depth",
        };
        let there: Vec<&str> = (ErrorMetric::ALL.into_iter())
            .filter(|metric| metric.is_of(mode))
            .map(ErrorMetric::name)
            .collect();
        Err(Error::usage(format!(
            "'max-error' {metric} cannot be combined with mode '{mode}': {why}"
        ))
        .hint(format!("mode {mode} has {}", there.join(", "))))
    }
}

impl FromStr for ErrorBound {
    type Err = Error;

    /// The bound is a number, a fraction such as 1/255, of shares also a percentage, of depths also
    /// with the unit vox.
    fn from_str(text: &str) -> Result<Self> {
        let names = || ErrorMetric::ALL.map(ErrorMetric::name).join(", ");
        let Some((name, bound)) = text.trim().split_once(':') else {
            return Err(Error::usage(format!(
                "'{text}' is not an error bound: write METRIC:BOUND, such as rmse:0.002; the metrics are {}",
                names()
            )));
        };
        let metric = (ErrorMetric::ALL.into_iter())
            .find(|metric| metric.name().eq_ignore_ascii_case(name.trim()))
            .ok_or_else(|| {
                Error::usage(format!(
                    "'{name}' is not an error metric: write one of {}",
                    names()
                ))
            })?;
        let is_share = matches!(metric, ErrorMetric::Missed | ErrorMetric::Value);
        let bound = bound.trim().to_ascii_lowercase();
        let bound = bound.as_str();
        let read = match (bound.strip_suffix('%'), bound.strip_suffix("vox")) {
            (Some(percent), _) if is_share => number(percent).map(|percent| percent / 100.0),
            (_, Some(voxels)) if metric == ErrorMetric::Depth => number(voxels),
            _ => match bound.split_once('/') {
                Some((above, below)) => {
                    number(above).and_then(|above| number(below).map(|below| above / below))
                }
                None => number(bound),
            },
        };
        match read {
            Ok(bound) if bound.is_finite() => Self::new(metric, bound),
            _ => Err(Error::usage(format!(
                "'{bound}' is not a bound for {metric}: it must be {}",
                metric.domain()
            ))),
        }
    }
}

impl fmt::Display for ErrorBound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.metric, self.bound)
    }
}

text_form!(ErrorBound);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_parse_and_print() {
        for (text, bound, printed) in [
            ("rmse:0.002", 0.002, "rmse:0.002"),
            ("max:1/255", 1.0 / 255.0, "max:0.00392156862745098"),
            ("p99:1e-3", 1e-3, "p99:0.001"),
            ("psnr:40", 40.0, "psnr:40"),
            ("depth:0.05vox", 0.05, "depth:0.05"),
            ("depth:0.05", 0.05, "depth:0.05"),
            ("missed:0.1%", 0.1 / 100.0, "missed:0.001"),
            ("missed:0", 0.0, "missed:0"),
            ("value:0.5%", 0.5 / 100.0, "value:0.005"),
            ("value:1/200", 0.005, "value:0.005"),
        ] {
            let parsed: ErrorBound = text.parse().unwrap();
            assert_eq!(parsed.bound(), bound, "{text}");
            assert_eq!(parsed.to_string(), printed);
            assert_eq!(printed.parse::<ErrorBound>().unwrap(), parsed);
        }
    }

    #[test]
    fn what_is_no_bound_is_refused_in_one_sentence() {
        for (text, reason) in [
            ("rmse", "is not an error bound"),
            ("", "is not an error bound"),
            ("mse:1", "is not an error metric"),
            ("rmse:", "is not a bound for rmse"),
            ("rmse:x", "is not a bound for rmse"),
            ("rmse:1/0", "is not a bound for rmse"),
            ("rmse:0/0", "is not a bound for rmse"),
            ("rmse:nan", "is not a bound for rmse"),
            ("rmse:1%", "is not a bound for rmse"),
            ("max:0.1vox", "is not a bound for max"),
            ("rmse:0", "out of its domain"),
            ("rmse:-1", "out of its domain"),
            ("max:2", "out of its domain"),
            ("psnr:0", "out of its domain"),
            ("missed:101%", "out of its domain"),
            ("value:0", "out of its domain"),
            ("depth:1e7", "out of its domain"),
        ] {
            let refused = text.parse::<ErrorBound>().unwrap_err();
            assert!(refused.to_string().contains(reason), "{text}: {refused}");
            assert_eq!(refused.exit_code(), 2);
            assert!(!refused.to_string().contains('\n'));
        }
    }

    #[test]
    fn each_mode_has_its_metrics() {
        let names = |mode: Mode| {
            let of_mode = ErrorMetric::ALL.into_iter().filter(|m| m.is_of(mode));
            of_mode.map(ErrorMetric::name).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(names(Mode::Iso), "rmse max p99 psnr depth missed");
        assert_eq!(names(Mode::Dvr), "rmse max p99 psnr");
        for mode in Mode::ALL {
            for metric in ErrorMetric::ALL {
                let bound = ErrorBound::new(metric, 0.5).unwrap();
                assert_eq!(bound.check(mode).is_ok(), metric.is_of(mode));
            }
        }
        let refused = "value:1%".parse::<ErrorBound>().unwrap().check(Mode::Iso);
        let refused = refused.unwrap_err();
        assert!(refused.hint_text().unwrap().contains("depth"), "{refused}");
    }
}
