//! From picture options to the picture, its light and its gradient.

use super::enum_names::{GradientMethod, Shading, Switch};
use super::picture::PictureOptions;
use super::shade_from::ShadeFrom;
use super::threshold::{Threshold, WindowEnds};
use super::transfer_choice::TransferChoice;
use crate::error::Result;
use crate::scene::{
    Emission, Gradient, Homogeneity, Light, Mode, Phong, Picture, Precomputed, Projection,
    Quadrature, Reflection, ShadedFrom, SrgbColor, TransferFile, Window,
};
use crate::subject::Subject;

/// The picture options, resolved for a volume.
pub(super) struct ResolvedPicture {
    pub picture: Picture,
    pub lights: Vec<Light>,
    pub gradient: Gradient,
    /// The options that make the same, with every default of the mode in its place, every value physical and
    /// the transfer function written out.
    pub options: PictureOptions,
}

/// How a picture is lit.
struct Lighting {
    phong: Option<Phong>,
    lights: Vec<Light>,
    gradient: Gradient,
    /// The mode, and the options that make the same.
    options: PictureOptions,
}

impl PictureOptions {
    /// Makes the picture; `quadrature` sums its light where the mode is dvr, `phong` says how it reflects light where nothing
    /// else is given.
    ///
    /// # Errors
    /// An order statistic; an empty window; a transfer function that cannot be read.
    pub(super) fn resolve(
        self,
        quadrature: Quadrature,
        phong: Phong,
        subject: &Subject,
    ) -> Result<ResolvedPicture> {
        let lighting = self.lighting(phong)?;
        match self.mode() {
            Mode::Iso => self.surface(lighting, subject),
            Mode::Mip => self.projection(Projection::Maximum, lighting, subject),
            Mode::Minip => self.projection(Projection::Minimum, lighting, subject),
            Mode::Mean => self.projection(Projection::Mean, lighting, subject),
            Mode::Lmip => {
                let threshold = value(self.lmip_threshold, subject)?;
                self.projection(Projection::LocalMaximum { threshold }, lighting, subject)
            }
            Mode::Dvr => self.emission(quadrature, lighting, subject),
        }
    }

    fn surface(self, lighting: Lighting, subject: &Subject) -> Result<ResolvedPicture> {
        let iso = value(self.iso, subject)?;
        let caps = self.caps.map_or(Picture::CAPS, Switch::is_on);
        let refine = self.refine.unwrap_or_default();
        let color = self.color.unwrap_or(SrgbColor::IVORY);
        Ok(ResolvedPicture {
            picture: Picture::Surface {
                iso,
                caps,
                refine,
                color: color.linear(),
                phong: lighting.phong,
            },
            lights: lighting.lights,
            gradient: lighting.gradient,
            options: Self {
                iso: Some(Threshold::Value(iso)),
                caps: Some(caps.into()),
                refine: Some(refine),
                color: Some(color),
                ..lighting.options
            },
        })
    }

    fn projection(
        self,
        of: Projection,
        lighting: Lighting,
        subject: &Subject,
    ) -> Result<ResolvedPicture> {
        let window = match self.window {
            Some(ends) => Window::new(ends.black.resolve(subject)?, ends.white.resolve(subject)?)?,
            None => Window::of_range(subject.robust_range)?,
        };
        Ok(ResolvedPicture {
            picture: Picture::Projection { of, window },
            lights: lighting.lights,
            gradient: lighting.gradient,
            options: Self {
                window: Some(WindowEnds {
                    black: Threshold::Value(window.black()),
                    white: Threshold::Value(window.white()),
                }),
                lmip_threshold: match of {
                    Projection::LocalMaximum { threshold } => Some(Threshold::Value(threshold)),
                    _ => None,
                },
                ..lighting.options
            },
        })
    }

    fn emission(
        self,
        quadrature: Quadrature,
        lighting: Lighting,
        subject: &Subject,
    ) -> Result<ResolvedPicture> {
        let file = match self.tf {
            Some(choice) => choice.read()?,
            None => TransferFile::named(TransferFile::DEFAULT_PRESET)?,
        };
        let file = file.in_values(subject.robust_range);
        let termination = self.termination.unwrap_or_default();
        let shaded_from = match self.shade_from {
            Some(gradient) => gradient.resolve(subject)?,
            None => ShadedFrom::default(),
        };
        let is_shaded = lighting.phong.is_some();
        let homogeneity = self.homogeneity.map(|limit| Homogeneity {
            rule: self.homogeneity_rule.unwrap_or_default(),
            limit,
        });
        Ok(ResolvedPicture {
            picture: Picture::Emission(Emission {
                transfer: file.clone().transfer_function(subject.robust_range)?,
                phong: lighting.phong,
                shaded_from,
                quadrature,
                termination,
                homogeneity,
            }),
            lights: lighting.lights,
            gradient: lighting.gradient,
            options: Self {
                tf: Some(TransferChoice::Written(file)),
                quad: Some(quadrature),
                termination: Some(termination),
                homogeneity: homogeneity.map(|homogeneity| homogeneity.limit),
                homogeneity_rule: homogeneity.map(|homogeneity| homogeneity.rule),
                shade_from: is_shaded.then_some(ShadeFrom::PerMm(shaded_from)),
                ..lighting.options
            },
        })
    }

    fn lighting(&self, default: Phong) -> Result<Lighting> {
        let (gradient, of_gradient) = self.resolved_gradient()?;
        let unlit = Lighting {
            phong: None,
            lights: vec![Light::default()],
            gradient,
            options: Self {
                mode: Some(self.mode()),
                shading: self.mode().is_lit().then_some(self.shading()),
                ..of_gradient
            },
        };
        let reflection = match self.shading() {
            Shading::None => return Ok(unlit),
            Shading::Phong => Reflection::Phong,
            Shading::BlinnPhong => Reflection::BlinnPhong,
        };
        let tint = |color: Option<SrgbColor>| color.unwrap_or(SrgbColor::WHITE);
        let ambient_color = tint(self.ambient_color);
        let diffuse_color = tint(self.diffuse_color);
        let specular_color = tint(self.specular_color);
        let phong = Phong {
            reflection,
            ambient: self.ambient.unwrap_or(default.ambient),
            ambient_color: ambient_color.linear(),
            diffuse: self.diffuse.unwrap_or(default.diffuse),
            diffuse_color: diffuse_color.linear(),
            specular: self.specular.unwrap_or(default.specular),
            specular_color: specular_color.linear(),
            shininess: self.shininess.unwrap_or(default.shininess),
        };
        let lights = self.light.clone();
        let lights = lights.unwrap_or_else(|| vec![Light::default()]);
        Light::check_count(&lights)?;
        Ok(Lighting {
            phong: Some(phong),
            options: Self {
                ambient: Some(phong.ambient),
                ambient_color: Some(ambient_color),
                diffuse: Some(phong.diffuse),
                diffuse_color: Some(diffuse_color),
                specular: Some(phong.specular),
                specular_color: Some(specular_color),
                shininess: Some(phong.shininess),
                light: Some(lights.clone()),
                ..unlit.options
            },
            lights,
            ..unlit
        })
    }

    /// The gradient, and the options that make the same.
    fn resolved_gradient(&self) -> Result<(Gradient, Self)> {
        let none = Self::default();
        if !self.has_normals() {
            return Ok((Gradient::default(), none));
        }
        let method = self.gradient_method();
        let options = Self {
            gradient: Some(method),
            ..none
        };
        Ok(match method {
            GradientMethod::Central => (Gradient::Central, options),
            GradientMethod::Forward => (Gradient::Forward, options),
            GradientMethod::FourthOrder => (Gradient::FourthOrder, options),
            GradientMethod::Precomputed => {
                let scale = self.gradient_scale.unwrap_or_default();
                let sigma = self.gradient_smooth.unwrap_or_default();
                let precomputed = Precomputed::new(scale.get(), sigma.get())?;
                let options = Self {
                    gradient_scale: Some(scale),
                    gradient_smooth: Some(sigma),
                    ..options
                };
                (Gradient::Precomputed(precomputed), options)
            }
        })
    }
}

/// The physical value of a threshold: the suggested iso value where none is given.
fn value(threshold: Option<Threshold>, subject: &Subject) -> Result<f64> {
    match threshold {
        Some(threshold) => threshold.resolve(subject),
        None => Ok(subject.suggested_iso),
    }
}
