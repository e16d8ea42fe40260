//! Scene options: the flags of the command line, the keys of the scene file and the stats' `scene`
//! are this one thing.
//!
//! Every option may be absent. [`SceneOptions::resolve`] fills in the defaults, which depend on the
//! volume, and makes the [`Scene`]; the filled options, read back as a scene file, make the same
//! scene again.
//!
//! What does not determine the picture (its file, the device) is no scene option, but its flags can
//! be keys of a scene file all the same: any [`group`] can be taken from a [`SceneFile`].

mod bound;
mod camera;
mod clip;
mod cost;
mod file;
mod gradient;
pub(crate) mod group;
mod numbers;
mod of_mode;
mod picture;
pub(crate) mod plain;
mod sampling;
mod setting;
mod shown;
mod subject;
mod thresholds;
mod tolerance;
mod tone;
mod values;
mod volume;
mod words;

pub use bound::{ErrorBound, ErrorMetric};
pub use camera::CameraOptions;
pub use clip::ClipOptions;
pub use file::{Part, SceneFile, flag_names};
pub use gradient::GradientScale;
pub use numbers::{
    AngleDeg, Brightness, Contrast, Count, FovDeg, Gamma, HeightMm, HomogeneityLimit, Reflectance,
    Shininess, SigmaMm, SigmaVoxels, StepVoxels, Termination, Zoom,
};
pub(crate) use numbers::{concise, concise_within, whole};
pub use picture::{PictureOptions, TransferChoice};
pub use sampling::SamplingOptions;
pub use setting::Setting;
pub use subject::Subject;
pub use tolerance::ToleranceOptions;
pub use tone::ToneOptions;
pub use values::{CArm, LightChoice, SpacingMm, SrgbColor, Threshold, Triple, WindowEnds};
pub use volume::{FilePath, RawSizeText, VolumeOptions};
pub use words::{GradientMethod, Mode, NonFiniteRule, Shading, Switch, View};

use crate::error::{Error, Result};
use crate::extent::Range;
use crate::scene::{Quadrature, QuadratureMethod, SamplingMethod, Scene, Storage, TransferFile};

/// Everything that determines a picture, as far as it was said.
#[derive(Debug, Clone, PartialEq, Default, clap::Args, serde::Serialize)]
pub struct SceneOptions {
    #[command(flatten)]
    #[serde(flatten)]
    pub volume: VolumeOptions,
    #[command(flatten)]
    #[serde(flatten)]
    pub picture: PictureOptions,
    #[command(flatten)]
    #[serde(flatten)]
    pub camera: CameraOptions,
    #[command(flatten)]
    #[serde(flatten)]
    pub clip: ClipOptions,
    #[command(flatten)]
    #[serde(flatten)]
    pub sampling: SamplingOptions,
    #[command(flatten)]
    #[serde(flatten)]
    pub tone: ToneOptions,
}

/// A scene, the options that make it, and what was chosen for the user.
#[derive(Debug, Clone, PartialEq)]
pub struct Resolved {
    pub scene: Scene,
    /// With every default in its place.
    pub options: SceneOptions,
    /// One sentence each about a default or computed value which the user may want to know.
    pub notes: Vec<String>,
}

impl SceneOptions {
    /// These flags over a scene file's options. What a flag rules out in the file, such as the eye
    /// when the flag is a view, or the iso value when it is another mode, goes with it.
    #[must_use]
    pub fn over(self, mut file: Self) -> Self {
        // An integral is not sampled as a surface is: neither's sampling is the other's.
        let dvr = |options: &Self| options.picture.mode() == Mode::Dvr;
        if self.picture.mode.is_some() && dvr(&self) != dvr(&file) {
            file.sampling.sampling = None;
            file = file.without_steps();
        }
        let implies_steps =
            self.steps_given() || self.picture.quad.is_some() || self.picture.homogeneity.is_some();
        match self.sampling.sampling {
            None if implies_steps => file.sampling.sampling = None,
            None => {}
            Some(method) => {
                let of_method = |quad: &Quadrature| quad.sampling() == method;
                file.picture.quad = file.picture.quad.filter(of_method);
                if method == SamplingMethod::Exact {
                    file = file.without_steps();
                    let suits = |storage: &Storage| *storage != Storage::Filtered;
                    file.sampling.voxels = file.sampling.voxels.filter(suits);
                    file.picture.homogeneity = None;
                    file.picture.homogeneity_rule = None;
                }
            }
        }
        Self {
            volume: self.volume.over(file.volume),
            camera: self.camera.clone().over(self.camera.keep_of(file.camera)),
            clip: self.clip.over(file.clip),
            picture: self
                .picture
                .clone()
                .over(self.picture.keep_of(file.picture)),
            sampling: self.sampling.over(file.sampling),
            tone: self.tone.over(file.tone),
        }
    }

    /// What kind of picture this is.
    pub fn mode(&self) -> Mode {
        self.picture.mode()
    }

    /// All that can be known without the volume: contradictions refused, the transfer function
    /// read.
    ///
    /// # Errors
    /// Options that contradict each other or mean nothing to the mode; a transfer function that
    /// cannot be read.
    pub fn checked(mut self) -> Result<Self> {
        self.camera.check()?;
        self.integrated_picture().check()?;
        self.clip.check()?;
        if let (Some(method), Some(quad)) = (self.sampling.sampling, self.picture.quad)
            && quad.sampling() != method
        {
            return Err(Error::usage(format!(
                "'sampling' = {method} does not go with 'quad' = {quad}, which is {}",
                quad.sampling()
            ))
            .hint("leave one of both out: quad adaptive is dvr's exact sampling"));
        }
        let sampling = self.sampling.sampling();
        sampling.voxels.check(self.method(), sampling.filter)?;
        if let Some(choice) = self.picture.tf.take() {
            self.picture.tf = Some(TransferChoice::Written(choice.read()?));
        }
        Ok(self)
    }

    /// With each order statistic of the voxels, such as p99.5, replaced by its value, and a sentence on
    /// each option that named one. `values` gives the physical values of percentages, which are each
    /// asked for once; `range` is that of the volume, by which the sentences round.
    #[must_use]
    pub fn measured(
        mut self,
        range: Range,
        values: impl FnOnce(&[f64]) -> Vec<f64>,
    ) -> (Self, Vec<String>) {
        let percents = self.picture.percentiles();
        if percents.is_empty() {
            return (self, Vec::new());
        }
        let values = values(&percents);
        let known: Vec<(f64, f64)> = percents.into_iter().zip(values).collect();
        let named = self.picture.clone();
        self.picture = self.picture.measured(&known);
        let notes = named.replaced(&self.picture, range);
        (self, notes)
    }

    /// The scene for a volume.
    ///
    /// # Errors
    /// As [`SceneOptions::checked`]; an order statistic, which [`SceneOptions::measured`] replaces; an
    /// empty window; an impossible camera.
    pub fn resolve(&self, subject: &Subject) -> Result<Resolved> {
        let Some((quad, note)) = self.without_costly_steps(subject) else {
            return self.resolve_as_said(subject);
        };
        let mut suited = self.clone();
        suited.picture.quad = Some(quad);
        let mut resolved = suited.resolve_as_said(subject)?;
        resolved.notes.push(note);
        Ok(resolved)
    }

    /// As [`SceneOptions::resolve`], with the quadrature's default whatever it costs.
    fn resolve_as_said(&self, subject: &Subject) -> Result<Resolved> {
        let method = self.method();
        let mut options = Self {
            volume: self.volume.clone().filled(),
            picture: self.integrated_picture().filled(subject)?,
            camera: self.camera.clone().filled(subject)?,
            clip: self.clip.clone().filled()?,
            sampling: self.sampling.clone().filled(method)?,
            tone: self.tone.clone().filled()?,
        };
        if method == SamplingMethod::Exact {
            options = options.without_steps();
        }
        let scene = Scene {
            size: options.camera.size()?,
            camera: options.camera.camera()?,
            picture: options.picture.picture(subject.robust_range)?,
            clip_planes: options.clip.planes().to_vec(),
            sampling: options.sampling.sampling(),
            light: options.picture.light(),
            gradient: options.picture.gradient()?,
            tone: options.tone.tone(),
        };
        let notes = self.notes(&options, subject);
        Ok(Resolved {
            scene,
            options,
            notes,
        })
    }

    /// How surfaces and projections are sampled: exactly, unless steps are asked for by their name
    /// or by what belongs to them. Emission and absorption is sampled as its quadrature is.
    fn method(&self) -> SamplingMethod {
        if self.picture.mode() == Mode::Dvr {
            return self.quadrature().sampling();
        }
        let implied = if self.steps_given() {
            SamplingMethod::Fixed
        } else {
            SamplingMethod::default()
        };
        self.sampling.sampling.unwrap_or(implied)
    }

    /// How emission and absorption is integrated: within a bound where exact sampling is asked for.
    fn quadrature(&self) -> Quadrature {
        let implied = match self.sampling.sampling {
            Some(SamplingMethod::Exact) => Quadrature::of(QuadratureMethod::Adaptive),
            _ => Quadrature::default(),
        };
        self.picture.quad.unwrap_or(implied)
    }

    /// The picture, in dvr with its quadrature, which exact sampling implies.
    fn integrated_picture(&self) -> PictureOptions {
        let dvr = self.picture.mode() == Mode::Dvr;
        PictureOptions {
            quad: self.picture.quad.or(dvr.then(|| self.quadrature())),
            ..self.picture.clone()
        }
    }

    /// Whether something is said that only fixed steps have.
    fn steps_given(&self) -> bool {
        let sampling = &self.sampling;
        sampling.step.is_some() || sampling.probe.is_some() || self.picture.refine.is_some()
    }

    fn without_steps(mut self) -> Self {
        self.sampling.step = None;
        self.sampling.probe = None;
        self.picture.refine = None;
        self
    }

    fn notes(&self, filled: &Self, subject: &Subject) -> Vec<String> {
        let mut notes = Vec::new();
        let within = |value| concise_within(value, subject.range);
        if self.method() == SamplingMethod::Exact && self.steps_given() {
            let what = match filled.picture.quad {
                Some(quad) => format!("quad = {quad}"),
                None => "sampling = exact".to_owned(),
            };
            notes.push(format!(
                "{what} takes no steps: step, refine and probe have no effect"
            ));
        }
        let given = &self.picture;
        let mut suggested = |key, given: Option<Threshold>, filled: Option<Threshold>| {
            if let (None, Some(Threshold::Value(value))) = (given, filled) {
                notes.push(format!(
                    "{key} = {}, suggested by the histogram: --{key} chooses another",
                    within(value)
                ));
            }
        };
        suggested("iso", given.iso, filled.picture.iso);
        suggested(
            "lmip-threshold",
            given.lmip_threshold,
            filled.picture.lmip_threshold,
        );
        notes.extend(given.replaced(&filled.picture, subject.range));
        notes.extend(filled.picture.no_surface_note(subject.range));
        if subject.robust_range != subject.range && given.takes_robust_range() {
            let (robust, whole) = (subject.robust_range, subject.range);
            notes.push(format!(
                "the defaults cover the values {} to {}: outliers or padding reach from {} to {}",
                within(robust.min),
                within(robust.max),
                within(whole.min),
                within(whole.max)
            ));
        }
        notes.extend(filled.clip.notes(subject));
        notes.extend(filled.cost_note(subject));
        if filled.picture.mode() == Mode::Dvr && given.tf.is_none() {
            let preset = TransferFile::DEFAULT_PRESET;
            notes.push(format!("tf = {preset}: --tf chooses another"));
        }
        notes
    }

    /// As the text of a scene file.
    ///
    /// # Errors
    /// A value that TOML cannot hold (a whole number of 64 bits).
    pub fn to_toml(&self) -> Result<String> {
        let refused = |error: toml::ser::Error| {
            Error::failed(format!("the scene cannot be written as TOML: {error}"))
        };
        let table = toml::Table::try_from(self).map_err(refused)?;
        toml::to_string(&table).map_err(refused)
    }
}
