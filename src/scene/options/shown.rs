//! From filled picture options to the picture and its light.

use super::numbers::{HomogeneityLimit, Reflectance, Shininess, Termination};
use super::picture::PictureOptions;
use super::values::{LightChoice, SrgbColor, Threshold, WindowEnds};
use super::words::{Mode, Shading, Switch};
use crate::error::Result;
use crate::extent::Range;
use crate::scene::{
    Emission, Homogeneity, Light, Phong, Picture, Projection, Reflection, Rgb, TransferFile, Window,
};

impl PictureOptions {
    /// A surface's colour, sRGB: warm ivory.
    pub(super) const IVORY: SrgbColor = SrgbColor([0.94, 0.87, 0.76]);

    /// The shading, light and gradient alone, with their defaults in place.
    pub(super) fn lit(&self) -> Result<Self> {
        let shading = self.shading();
        let only_shading = Self {
            shading: Some(shading),
            ..self.differentiated()?
        };
        if shading == Shading::None {
            return Ok(only_shading);
        }
        let default = Phong::default();
        let reflectance = |given: Option<Reflectance>, default| match given {
            Some(given) => Ok(Some(given)),
            None => Reflectance::new(default).map(Some),
        };
        Ok(Self {
            ambient: reflectance(self.ambient, default.ambient)?,
            diffuse: reflectance(self.diffuse, default.diffuse)?,
            specular: reflectance(self.specular, default.specular)?,
            shininess: match self.shininess {
                Some(shininess) => Some(shininess),
                None => Some(Shininess::new(default.shininess)?),
            },
            light: self.light.or(Some(LightChoice::Headlight)),
            ..only_shading
        })
    }

    /// From filled options.
    pub(super) fn picture(&self, range: Range) -> Result<Picture> {
        let value = |threshold: Option<Threshold>| match threshold {
            Some(Threshold::Value(value)) => value,
            _ => range.min,
        };
        let projection = |of| {
            let ends = self.window;
            let end = |pick: fn(WindowEnds) -> Threshold| value(ends.map(pick));
            let window = Window::new(end(|w| w.black), end(|w| w.white))?;
            Ok(Picture::Projection { of, window })
        };
        match self.mode() {
            Mode::Iso => Ok(Picture::Surface {
                iso: value(self.iso),
                caps: self.caps.is_none_or(Switch::is_on),
                refine: self.refine.unwrap_or_default(),
                color: Rgb::from_srgb(self.color.unwrap_or(Self::IVORY).0),
                phong: self.phong(),
            }),
            Mode::Mip => projection(Projection::Maximum),
            Mode::Minip => projection(Projection::Minimum),
            Mode::Mean => projection(Projection::Mean),
            Mode::Lmip => projection(Projection::LocalMaximum {
                threshold: value(self.lmip_threshold),
            }),
            Mode::Dvr => {
                let file = match self.tf.clone() {
                    Some(choice) => choice.read()?,
                    None => TransferFile::named(TransferFile::DEFAULT_PRESET)?,
                };
                let rule = self.homogeneity_rule.unwrap_or_default();
                let homogeneity = self.homogeneity.map(HomogeneityLimit::get);
                Ok(Picture::Emission(Emission {
                    transfer: file.transfer_function(range)?,
                    phong: self.phong(),
                    quadrature: self.quad.unwrap_or_default(),
                    termination: self
                        .termination
                        .map_or(Emission::DEFAULT_TERMINATION, Termination::get),
                    homogeneity: homogeneity.map(|limit| Homogeneity { rule, limit }),
                }))
            }
        }
    }

    fn phong(&self) -> Option<Phong> {
        let default = Phong::default();
        let reflection = match self.shading() {
            Shading::None => return None,
            Shading::Phong => Reflection::Phong,
            Shading::BlinnPhong => Reflection::BlinnPhong,
        };
        Some(Phong {
            reflection,
            ambient: self.ambient.map_or(default.ambient, Reflectance::get),
            diffuse: self.diffuse.map_or(default.diffuse, Reflectance::get),
            specular: self.specular.map_or(default.specular, Reflectance::get),
            shininess: self.shininess.map_or(default.shininess, Shininess::get),
        })
    }

    pub(super) fn light(&self) -> Light {
        self.light.map_or(Light::default(), LightChoice::light)
    }
}
