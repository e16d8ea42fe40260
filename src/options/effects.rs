//! Effect options: light and lens beyond a point and its light.

use super::group::group;
use super::text_form::text_form;
use crate::scene::{AmbientOcclusion, DepthOfField, DofMethod, Phong, Reflectance};

text_form!(AmbientOcclusion, DepthOfField, DofMethod);

group! {
    /// What light and lens do beyond reflection at a point.
    #[derive(serde::Serialize)]
    #[command(next_help_heading = "Effects")]
    pub struct EffectOptions {
        /// Ambient occlusion: the light from everywhere is dimmed where the surface itself is in its way within
        /// MM; N rays from each hit tell how much, up to 1024 [default of N: 64], and S from 0 to 1 how
        /// strongly it shows [default of S: 1]
        #[arg(long, value_name = "rays=N,distance=MM,strength=S", allow_hyphen_values = true)]
        ao: AmbientOcclusion,

        /// Depth of field: a lens of this diameter in place of a pinhole, or cones of this half-angle of an
        /// orthographic camera (aperture=1deg), in focus at a distance in mm along the view axis, at the
        /// median depth of what is seen (auto), at what is seen in a pixel counted from the upper left
        /// (pixel:X:Y), or at a percentile of the depths (percentile:P). S from 0 to 1 darkens what is out
        /// of focus [default of S: 0]
        #[arg(
            long,
            value_name = "focus=F,aperture=MM|DEGdeg[,darken=S]",
            allow_hyphen_values = true
        )]
        dof: DepthOfField,

        /// How depth of field is made: gather blurs each surface over what lies behind it, with a second cast for
        /// what first surfaces hide, and leaves what is in focus as it is; mix mixes the picture with a blurred
        /// one by how far each pixel is out of focus (Lesar et al.); lens:N casts the picture through N points
        /// of the lens, up to 1024
        #[arg(long, value_name = "gather|mix|lens:N", allow_hyphen_values = true)]
        dof_method: DofMethod,
    }
}

impl EffectOptions {
    /// Returns the options that make the same, where the way to make depth of field has its default.
    pub(super) fn resolve(self) -> Self {
        let dof_method = self.dof.map(|_| self.dof_method.unwrap_or_default());
        Self { dof_method, ..self }
    }

    /// Returns how light is reflected where nothing else is given: where light from everywhere may be occluded there is more
    /// of it.
    pub(super) fn phong(&self) -> Phong {
        let default = Phong::default();
        match self.ao {
            None => default,
            Some(_) => Phong {
                ambient: Reflectance::OCCLUDED,
                diffuse: Reflectance::OCCLUDED,
                ..default
            },
        }
    }
}
