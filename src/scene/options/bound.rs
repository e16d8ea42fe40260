//! `--max-error METRIC:BOUND`: how far off a picture may be, instead of how its rays are followed.

use std::fmt;
use std::str::FromStr;

use super::SceneOptions;
use super::group::{Keys, group};
use super::numbers::number;
use super::plain::plain;
use super::words::Mode;
use crate::error::{Error, Result};

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
    pub const ALL: [Self; 7] = [
        Self::Rmse,
        Self::Max,
        Self::P99,
        Self::Psnr,
        Self::Depth,
        Self::Missed,
        Self::Value,
    ];

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
    /// # Errors
    /// A bound that the metric cannot have.
    pub fn new(metric: ErrorMetric, bound: f64) -> Result<Self> {
        if metric.takes(bound) {
            return Ok(Self { metric, bound });
        }
        Err(Error::usage(format!(
            "a bound of {} for {metric} is out of its domain: it must be {}",
            super::concise(bound),
            metric.domain()
        )))
    }

    pub fn metric(self) -> ErrorMetric {
        self.metric
    }

    /// In the metric's unit.
    pub fn bound(self) -> f64 {
        self.bound
    }

    /// Whether a figure of the metric is within the bound. No figure that is none is.
    pub fn is_met_by(self, figure: f64) -> bool {
        match self.metric {
            ErrorMetric::Psnr => figure >= self.bound,
            _ => figure <= self.bound,
        }
    }

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
            "'max-error' {metric} does not go with mode '{mode}': {why}"
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
            .find(|metric| metric.name() == name)
            .ok_or_else(|| {
                Error::usage(format!(
                    "'{name}' is not an error metric: write one of {}",
                    names()
                ))
            })?;
        let is_share = matches!(metric, ErrorMetric::Missed | ErrorMetric::Value);
        let bound = bound.trim();
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

plain!(ErrorBound);

group! {
    /// What decides how rays are followed where the user does not.
    #[command(next_help_heading = "Sampling")]
    pub struct ToleranceOptions {
        /// Follow rays in the cheapest way whose error, against the double-precision reference, is
        /// within BOUND: rmse, max (1/255), p99, psnr (dB, at least) of the colours; in iso depth
        /// (voxels) and missed (a share, 0.1%) hits; in projections value (a share of the value
        /// range). Found by a probe and verified; takes the place of --sampling, --step, --probe,
        /// --refine, --quad, --homogeneity and --termination
        #[arg(long, value_name = "METRIC:BOUND")]
        max_error: ErrorBound,
    }
}

/// The keys of which an error bound takes the place. The others that say how rays are followed
/// either change no picture (skipping) or what is taken for the truth (filter, gradient).
const DECIDED: [&str; 8] = [
    "sampling",
    "step",
    "probe",
    "refine",
    "quad",
    "homogeneity",
    "homogeneity-rule",
    "termination",
];

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
            flags.decided().is_empty() && mode.is_none_or(|mode| bound.metric.is_of(mode))
        };
        Self {
            max_error: file.max_error.filter(suits),
        }
    }

    /// # Errors
    /// Usage: a bound that the mode has no metric for, or beside options of which it takes the
    /// place.
    pub fn check(&self, scene: &SceneOptions) -> Result<()> {
        let Some(bound) = self.max_error else {
            return Ok(());
        };
        if let Some(key) = scene.decided().first() {
            return Err(Error::usage(format!(
                "'max-error' and '{key}' exclude each other: a bound decides by itself how rays are followed"
            ))
            .hint(format!("leave out {}, or 'max-error'", DECIDED.join(", "))));
        }
        bound.check(scene.mode())
    }
}

impl SceneOptions {
    /// The keys given of which an error bound takes the place.
    fn decided(&self) -> Vec<String> {
        let mut keys = self.sampling.given();
        keys.extend(self.picture.given());
        keys.retain(|key| DECIDED.contains(&key.as_str()));
        keys
    }

    /// Without what an error bound takes the place of.
    #[must_use]
    pub fn undecided(self) -> Self {
        let keep = |key: &str| !DECIDED.contains(&key);
        Self {
            picture: self.picture.keeping(keep),
            sampling: self.sampling.keeping(keep),
            ..self
        }
    }
}

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
        for (text, said) in [
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
            assert!(refused.to_string().contains(said), "{text}: {refused}");
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
                refused.to_string().contains("exclude each other"),
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
        ] {
            bound.check(&parse(text)).unwrap();
        }
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
        for (of_file, flags, kept) in [
            ("rmse:0.1", "iso = 1", true),
            ("depth:0.1", "mode = 'iso'", true),
            ("depth:0.1", "mode = 'mip'", false),
        ] {
            let over = none().over_file(bound(of_file), &parse(flags), &mut parse(""));
            assert_eq!(over == bound(of_file), kept, "{of_file} {flags}");
            assert_eq!(over == none(), !kept);
        }
    }
}
