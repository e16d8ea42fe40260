//! Picture options: what is shown. Each mode takes those that mean something to it, and refuses
//! the others.

use std::convert::Infallible;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::gradient::GradientScale;
use super::group::{Keys, group};
use super::numbers::{HomogeneityLimit, Reflectance, Shininess, SigmaVoxels, Termination};
use super::subject::Subject;
use super::values::{LightChoice, SrgbColor, Threshold, WindowEnds};
use super::words::{GradientMethod, Mode, Shading, Switch};
use crate::error::{Error, Result};
use crate::scene::{Emission, HomogeneityRule, Quadrature, Refine, TransferFile, TransferUnits};

group! {
    /// What is shown.
    #[derive(serde::Serialize)]
    #[command(next_help_heading = "Picture")]
    pub struct PictureOptions {
        /// What is shown: iso (a surface), mip, minip, mean, lmip (projections) or dvr (emission
        /// and absorption) [default: iso]
        #[arg(long, value_name = "MODE")]
        mode: Mode,

        /// iso: the surface's value; a number, a share of the value range such as 50%, a percentile of
        /// the voxels such as p99.5 (nearest rank), or otsu [default: suggested by the volume's
        /// histogram]
        #[arg(long, value_name = "VALUE|N%|pN|otsu", allow_hyphen_values = true)]
        iso: Threshold,

        /// iso: close the surface where the volume ends or is clipped [default: on]
        #[arg(long, value_name = "on|off")]
        caps: Switch,

        /// iso: how the hit is refined between samples: none, bisection, regula-falsi, illinois or
        /// newton, :N for N iterations; with fixed steps [default: regula-falsi:5]
        #[arg(long, value_name = "METHOD[:N]")]
        refine: Refine,

        /// iso: the surface's colour: sRGB r,g,b from 0 to 1, #rrggbb, #rgb, or a CSS name such as
        /// ivory [default: warm ivory, 0.94,0.87,0.76]
        #[arg(long, value_name = "COLOR", allow_hyphen_values = true)]
        color: SrgbColor,

        /// Projections: the values shown black and white; numbers, shares of the value range such as
        /// 5%, percentiles of the voxels such as p99.5, or otsu. HI,LO inverts: what is bright in the
        /// volume is dark in the picture [default: the value range, without a few far-away values and
        /// padding]
        #[arg(long, value_name = "LO,HI", allow_hyphen_values = true)]
        window: WindowEnds,

        /// lmip: the value from which a local maximum counts, written as that of --iso [default: the
        /// suggested iso value]
        #[arg(long, value_name = "VALUE|N%|pN|otsu", allow_hyphen_values = true)]
        lmip_threshold: Threshold,

        /// dvr: the transfer function, a TOML file or a preset: cta (Hounsfield units), mra or
        /// 3dra (shares of the window's default) [default: 3dra]
        #[arg(long, value_name = "FILE|PRESET")]
        tf: TransferChoice,

        /// dvr: how light is summed along a ray: riemann, midpoint, simpson, romberg, rk4 or
        /// preintegrated at the fixed step, or adaptive, which takes no steps and keeps every
        /// channel within the error :BOUND of linear light, 0.001 unless told [default: simpson;
        /// adaptive where --sampling exact is given, and where nothing about steps is and they would
        /// cost out of proportion: spacings more than 100 times apart, or more than 16384 samples
        /// per ray]
        #[arg(long, value_name = "METHOD[:BOUND]")]
        quad: Quadrature,

        /// dvr: take an octree leaf for its average value, in one step, where that changes no
        /// pixel by more than E [default: never]
        #[arg(long, value_name = "E", allow_hyphen_values = true)]
        homogeneity: HomogeneityLimit,

        /// dvr: what E limits: optical, the pixel's error; or range, the leaf's value range as a
        /// share of the volume's, whatever the transfer function does in it [default: optical]
        #[arg(long, value_name = "optical|range")]
        homogeneity_rule: HomogeneityRule,

        /// dvr: the opacity at which a ray ends; the colour lost is at most 1 minus this
        /// [default: 0.999]
        #[arg(long, value_name = "OPACITY", allow_hyphen_values = true)]
        termination: Termination,

        /// iso, dvr: none, phong or blinn-phong [default: phong for iso, none for dvr]
        #[arg(long, value_name = "NAME")]
        shading: Shading,

        /// Light reflected from everywhere [default: 0.1]
        #[arg(long, value_name = "A", allow_hyphen_values = true)]
        ambient: Reflectance,

        /// Light reflected from the lamp in all directions [default: 0.9]
        #[arg(long, value_name = "D", allow_hyphen_values = true)]
        diffuse: Reflectance,

        /// Light mirrored from the lamp [default: 0.2]
        #[arg(long, value_name = "S", allow_hyphen_values = true)]
        specular: Reflectance,

        /// Sharpness of the mirrored light [default: 32]
        #[arg(long, value_name = "N", allow_hyphen_values = true)]
        shininess: Shininess,

        /// headlight, or the world direction toward a distant light [default: headlight]
        #[arg(long, value_name = "headlight|X,Y,Z", allow_hyphen_values = true)]
        light: LightChoice,

        /// iso, shaded dvr: how normals are found: central, forward or fourth-order differences of
        /// the field, or precomputed: central ones at every N-th voxel, interpolated between
        /// [default: central]
        #[arg(long, value_name = "NAME")]
        gradient: GradientMethod,

        /// Voxels between two precomputed gradients, 1 to 8 [default: 2]
        #[arg(long, value_name = "N", allow_hyphen_values = true)]
        gradient_scale: GradientScale,

        /// Gaussian smoothing before precomputed gradients: its standard deviation in voxels of the
        /// smallest spacing [default: 0, none]
        #[arg(long, value_name = "VOXELS", allow_hyphen_values = true)]
        gradient_smooth: SigmaVoxels,
    }
}

/// `--tf`: a preset's name or a file's, or in a scene file the function itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum TransferChoice {
    Named(String),
    Written(TransferFile),
}

impl TransferChoice {
    /// The file named, where it is one.
    pub fn file(&self) -> Option<PathBuf> {
        match self {
            Self::Named(name) if TransferFile::preset(name).is_none() => Some(PathBuf::from(name)),
            _ => None,
        }
    }

    /// # Errors
    /// As [`TransferFile::named`].
    pub fn read(self) -> Result<TransferFile> {
        match self {
            Self::Named(name) => TransferFile::named(&name),
            Self::Written(file) => Ok(file),
        }
    }
}

impl FromStr for TransferChoice {
    type Err = Infallible;

    fn from_str(name: &str) -> std::result::Result<Self, Infallible> {
        Ok(Self::Named(name.to_owned()))
    }
}

impl<'de> Deserialize<'de> for TransferChoice {
    fn deserialize<D: Deserializer<'de>>(from: D) -> std::result::Result<Self, D::Error> {
        struct NameOrTable;

        impl<'de> Visitor<'de> for NameOrTable {
            type Value = TransferChoice;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a preset, a file's name, or a table with points")
            }

            fn visit_str<E>(self, name: &str) -> std::result::Result<Self::Value, E> {
                Ok(TransferChoice::Named(name.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(
                self,
                table: A,
            ) -> std::result::Result<Self::Value, A::Error> {
                TransferFile::deserialize(MapAccessDeserializer::new(table))
                    .map(TransferChoice::Written)
            }
        }

        from.deserialize_any(NameOrTable)
    }
}

/// A key, the modes it belongs to, and why no other.
struct Belongs {
    key: &'static str,
    modes: &'static [Mode],
    why: &'static str,
}

const PROJECTIONS: &[Mode] = &[Mode::Mip, Mode::Lmip, Mode::Minip, Mode::Mean];
const LIT: &[Mode] = &[Mode::Iso, Mode::Dvr];
/// What a shading makes use of.
const LIGHT: [&str; 5] = ["ambient", "diffuse", "specular", "shininess", "light"];
/// What shading and the adaptive quadrature rule out.
const HOMOGENEITY: [&str; 2] = ["homogeneity", "homogeneity-rule"];
const UNLIT: &str = "a projection has no surface to light";
const NO_NORMALS: &str = "a projection has no normals";

#[rustfmt::skip]
const BELONGS: [Belongs; 20] = [
    Belongs { key: "iso", modes: &[Mode::Iso], why: "only a surface has an iso value" },
    Belongs { key: "caps", modes: &[Mode::Iso], why: "only a surface is closed where the volume ends" },
    Belongs { key: "refine", modes: &[Mode::Iso], why: "only a surface has a hit to refine" },
    Belongs { key: "color", modes: &[Mode::Iso], why: "a projection is grey, and dvr takes its colours from the transfer function" },
    Belongs { key: "window", modes: PROJECTIONS, why: "only a projection shows values as grey" },
    Belongs { key: "lmip-threshold", modes: &[Mode::Lmip], why: "only lmip looks for a local maximum" },
    Belongs { key: "tf", modes: &[Mode::Dvr], why: "only dvr maps values to opacity; a surface has 'color', a projection 'window'" },
    Belongs { key: "quad", modes: &[Mode::Dvr], why: "only dvr sums light along the ray" },
    Belongs { key: "homogeneity", modes: &[Mode::Dvr], why: "only dvr takes a node for its average" },
    Belongs { key: "homogeneity-rule", modes: &[Mode::Dvr], why: "only dvr takes a node for its average" },
    Belongs { key: "termination", modes: &[Mode::Dvr], why: "only dvr gathers opacity along the ray" },
    Belongs { key: "shading", modes: LIT, why: UNLIT },
    Belongs { key: "ambient", modes: LIT, why: UNLIT },
    Belongs { key: "diffuse", modes: LIT, why: UNLIT },
    Belongs { key: "specular", modes: LIT, why: UNLIT },
    Belongs { key: "shininess", modes: LIT, why: UNLIT },
    Belongs { key: "light", modes: LIT, why: UNLIT },
    Belongs { key: "gradient", modes: LIT, why: NO_NORMALS },
    Belongs { key: "gradient-scale", modes: LIT, why: NO_NORMALS },
    Belongs { key: "gradient-smooth", modes: LIT, why: NO_NORMALS },
];

/// Whether a key, other than `mode` itself, means something to the mode.
pub(super) fn belongs_to(key: &str, mode: Mode) -> bool {
    let belongs = |b: &Belongs| b.key == key && b.modes.contains(&mode);
    BELONGS.iter().any(belongs)
}

impl PictureOptions {
    pub(super) fn mode(&self) -> Mode {
        self.mode.unwrap_or(Mode::Iso)
    }

    pub(super) fn shading(&self) -> Shading {
        self.shading.unwrap_or(match self.mode() {
            Mode::Iso => Shading::Phong,
            _ => Shading::None,
        })
    }

    /// What of a scene file's picture still applies when these are the flags: another mode drops
    /// what belongs to the file's mode, no shading drops its light, other gradients than precomputed
    /// ones what only those use.
    pub(super) fn keep_of(&self, mut file: Self) -> Self {
        let had_normals = file.has_normals();
        if let Some(mode) = self.mode
            && mode != file.mode()
        {
            // The file's own shading may be that of its mode.
            let shading = file
                .shading
                .filter(|_| LIT.contains(&mode) && LIT.contains(&file.mode()));
            file = Self {
                shading,
                ..file.keeping(|key| belongs_to(key, mode))
            };
            let shading = self.shading.or(shading);
            if shading.is_none_or(|s| s == Shading::None) {
                file = file.unlit();
            }
        }
        if self.shading == Some(Shading::None) {
            file = file.unlit();
        }
        let lit = self.shading.is_some_and(|s| s != Shading::None);
        let adapts = self.quad.is_some_and(|quad| !quad.is_stepped());
        if lit || adapts {
            file = file.keeping(|key| !HOMOGENEITY.contains(&key));
        }
        if self.homogeneity.is_some() {
            file.quad = file.quad.filter(|quad| quad.is_stepped());
            file.shading = None;
            file = file.unlit();
        }
        if had_normals && !self.clone().over(file.clone()).has_normals() {
            file = file.without_gradient();
        }
        let method = self.gradient;
        if method.is_some_and(|method| method != GradientMethod::Precomputed) {
            file = file.without_precomputed();
        }
        file
    }

    pub(super) fn unlit(self) -> Self {
        self.keeping(|key| !LIGHT.contains(&key))
    }

    /// # Errors
    /// An option that means nothing to the mode, or to a picture without shading.
    pub(super) fn check(&self) -> Result<()> {
        let mode = self.mode();
        let given = self.given();
        let is_given = |key: &str| given.iter().any(|given| given == key);
        if let Some(stray) = BELONGS
            .iter()
            .find(|b| is_given(b.key) && !b.modes.contains(&mode))
        {
            let modes: Vec<String> = stray.modes.iter().map(Mode::to_string).collect();
            return Err(Error::usage(format!(
                "'{}' does not go with mode '{mode}': {}",
                stray.key, stray.why
            ))
            .hint(format!("it belongs to mode {}", modes.join(", "))));
        }
        if self.shading() == Shading::None
            && let Some(key) = LIGHT.iter().find(|key| is_given(key))
        {
            return Err(Error::usage(format!(
                "'{key}' has no effect in mode '{mode}' without shading"
            ))
            .hint("choose a shading: phong or blinn-phong"));
        }
        self.check_homogeneity()?;
        self.check_gradient()
    }

    /// # Errors
    /// Homogeneous nodes where a node's average says too little, or their rule without them.
    fn check_homogeneity(&self) -> Result<()> {
        if self.homogeneity.is_none() {
            return match self.homogeneity_rule {
                None => Ok(()),
                Some(rule) => Err(Error::usage(format!(
                    "'homogeneity-rule' {rule} has no effect without 'homogeneity', its limit"
                ))),
            };
        }
        if self.shading() != Shading::None {
            return Err(Error::usage(
                "'homogeneity' does not go with shading: normals differ inside a node",
            )
            .hint("choose shading none, or leave homogeneity out"));
        }
        if !self.quad.unwrap_or_default().is_stepped() {
            return Err(Error::usage(
                "'homogeneity' does not go with quad 'adaptive', which keeps a bound of its own",
            )
            .hint("choose another quad, or leave homogeneity out"));
        }
        Ok(())
    }

    /// Whether a default of these options is made from the values' robust range.
    pub(super) fn takes_robust_range(&self) -> bool {
        match self.mode() {
            Mode::Iso => self.iso.is_none(),
            Mode::Mip | Mode::Minip | Mode::Mean => self.window.is_none(),
            Mode::Lmip => self.window.is_none() || self.lmip_threshold.is_none(),
            Mode::Dvr => {
                let file = match self.tf.clone() {
                    Some(choice) => choice.read(),
                    None => TransferFile::named(TransferFile::DEFAULT_PRESET),
                };
                file.is_ok_and(|file| file.units == TransferUnits::Range)
            }
        }
    }

    /// With every default of its mode in its place, every value physical, and the transfer
    /// function written out: filling again changes nothing.
    pub(super) fn filled(self, subject: &Subject) -> Result<Self> {
        self.check()?;
        let mode = self.mode();
        let lit = self.lit()?;
        let value = |threshold: Option<Threshold>, default: f64| {
            let value = match threshold {
                Some(threshold) => threshold.resolve(subject)?,
                None => default,
            };
            Ok(Some(Threshold::Value(value)))
        };
        let bare = Self {
            mode: Some(mode),
            ..Self::default()
        };
        Ok(match mode {
            Mode::Iso => Self {
                iso: value(self.iso, subject.suggested_iso)?,
                caps: self.caps.or(Some(Switch::On)),
                refine: self.refine.or(Some(Refine::default())),
                color: self.color.or(Some(Self::IVORY)),
                mode: Some(mode),
                ..lit
            },
            Mode::Mip | Mode::Minip | Mode::Mean => Self {
                window: Some(window_values(self.window, subject)?),
                ..bare
            },
            Mode::Lmip => Self {
                window: Some(window_values(self.window, subject)?),
                lmip_threshold: value(self.lmip_threshold, subject.suggested_iso)?,
                ..bare
            },
            Mode::Dvr => {
                let file = match self.tf {
                    Some(choice) => choice.read()?,
                    None => TransferFile::named(TransferFile::DEFAULT_PRESET)?,
                };
                Self {
                    tf: Some(TransferChoice::Written(
                        file.in_values(subject.robust_range),
                    )),
                    quad: self.quad.or(Some(Quadrature::default())),
                    termination: match self.termination {
                        Some(termination) => Some(termination),
                        None => Some(Termination::new(Emission::DEFAULT_TERMINATION)?),
                    },
                    homogeneity: self.homogeneity,
                    homogeneity_rule: self
                        .homogeneity
                        .map(|_| self.homogeneity_rule.unwrap_or_default()),
                    mode: Some(mode),
                    ..lit
                }
            }
        })
    }
}

/// The robust value range where no window is given; a constant volume is middle grey.
fn window_values(window: Option<WindowEnds>, subject: &Subject) -> Result<WindowEnds> {
    let range = subject.robust_range;
    let (black, white) = match window {
        Some(ends) => (ends.black.resolve(subject)?, ends.white.resolve(subject)?),
        None if range.min < range.max => (range.min, range.max),
        None => {
            let margin = f64::max(0.5, range.min.abs() * 1e-3);
            (range.min - margin, range.max + margin)
        }
    };
    Ok(WindowEnds {
        black: Threshold::Value(black),
        white: Threshold::Value(white),
    })
}

#[cfg(test)]
mod tests {
    use clap::Args;

    use super::*;
    use crate::scene::options::flag_names;

    #[test]
    fn every_option_says_which_modes_it_belongs_to() {
        let mut keys = flag_names(&PictureOptions::augment_args(clap::Command::new("scene")));
        keys.retain(|key| key != "mode");
        keys.sort();
        let mut told: Vec<&str> = BELONGS.iter().map(|belongs| belongs.key).collect();
        told.sort_unstable();
        assert_eq!(told, keys);
        assert!(LIGHT.iter().all(|key| told.contains(key)));
        // The control: no key is told that is none.
        assert!(!keys.contains(&"lmip_threshold".to_owned()));
    }

    #[test]
    fn given_keys_are_the_flags_names() {
        let options = PictureOptions {
            lmip_threshold: Some(Threshold::Otsu),
            shading: Some(Shading::Phong),
            ..PictureOptions::default()
        };
        assert_eq!(options.given(), ["lmip-threshold", "shading"]);
        let kept = options.keeping(|key| key != "lmip-threshold");
        assert_eq!(kept.given(), ["shading"]);
    }
}
