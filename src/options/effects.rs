//! Effect options: light and lens beyond a point and its light.

use super::group::group;
use super::text_form::text_form;
use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::scene::{
    AmbientOcclusion, Camera, DepthCue, DepthCues, DepthOfField, DepthRange, DofMethod,
    LightSizeDeg, Mode, Occlusion, Phong, Reflectance, ScreenOcclusion, ShadowMethod, Shadows,
};
use crate::subject::Content;

text_form!(
    AmbientOcclusion,
    DepthCue,
    DepthOfField,
    DepthRange,
    DofMethod,
    LightSizeDeg,
    ScreenOcclusion,
    ShadowMethod
);

group! {
    /// What light and lens do beyond reflection at a point.
    #[derive(serde::Serialize)]
    #[command(next_help_heading = "Effects")]
    pub struct EffectOptions {
        /// Ambient occlusion: the light from everywhere is dimmed where the surface itself is in its way within
        /// MM; N rays from each hit tell how much, up to 1024 [default of N: 64], and S from 0 to 1 how
        /// strongly it shows [default of S: 1]. With bound=E in place of rays=N its share is bounded from both
        /// sides, and what shows is within E of it, from 0.001 to 0.5, where the voxels decide that (layer
        /// occlusion_bound)
        #[arg(
            long,
            value_name = "rays=N|bound=E,distance=MM,strength=S",
            allow_hyphen_values = true
        )]
        ao: AmbientOcclusion,

        /// Shadows: lights but headlights are dimmed where the volume itself is in their way. on: by rays from
        /// cell to cell toward each light; in dvr also step=K, by rays whose samples are K times the sample step
        /// apart, and cached:N, from a grid of optical depths with N points along its longest side
        #[arg(long, value_name = "on|step=K|cached:N")]
        shadows: ShadowMethod,

        /// The angle in degrees that each light fills, from 0 to 90: shadows of a surface get soft edges
        #[arg(long, value_name = "DEG")]
        light_size: LightSizeDeg,

        /// Ambient occlusion within MM estimated from the picture alone: from N pixels around each, an even number
        /// up to 1024 [default of N: 32]. What is seen is as thick as it is (layer thick), or MM with thickness=MM;
        /// what lies behind it or outside the picture occludes nothing
        #[arg(
            long,
            value_name = "radius=MM,samples=N,strength=S",
            allow_hyphen_values = true
        )]
        ssao: ScreenOcclusion,

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

        /// What tells near from far, once of each kind, S from 0 to 1: fog:S, what is far away fades into the
        /// background; chromadepth:S, colours from red, near, to blue, far, with ramp=full or red-white-blue,
        /// steps=N to tell only N depths apart, rim=P to colour only where normals turn away (iso, dvr), the
        /// less the larger P; halo:S, what is far away is dark around what is near; contour:S, what is in
        /// front of something is outlined; both with width=PX [default of PX: as suits the picture's height]
        #[arg(long, value_name = "KIND:S[,KEY=VALUE]", allow_hyphen_values = true)]
        #[serde(deserialize_with = "super::text_form::one_or_more")]
        cue: Vec<DepthCue>,

        /// The distances from the eye, in mm, between which near is told from far; of an orthographic camera
        /// those from the eye plane
        #[arg(long, value_name = "NEAR,FAR", allow_hyphen_values = true)]
        cue_range: DepthRange,
    }
}

impl EffectOptions {
    /// Returns the options that make the same, where the way to make depth of field has its default.
    pub(super) fn resolve(self) -> Self {
        let dof_method = self.dof.map(|_| self.dof_method.unwrap_or_default());
        let light_size = self.shadows.map(|_| self.light_size.unwrap_or_default());
        Self {
            dof_method,
            light_size,
            ..self
        }
    }

    /// Returns the shadows that are asked for.
    pub(super) fn cast_shadows(&self) -> Option<Shadows> {
        self.shadows.map(|method| Shadows {
            method,
            light_size: self.light_size.unwrap_or_default(),
        })
    }

    /// Whether a cue is asked for that is drawn where depths of neighbouring pixels differ.
    pub(super) fn draws_edges(&self) -> bool {
        let is_drawn = |cue: &DepthCue| matches!(cue, DepthCue::Halo(_) | DepthCue::Contour(_));
        self.cue.iter().flatten().any(is_drawn)
    }

    /// Refuses cues that the mode has not.
    ///
    /// # Errors
    /// Usage: a colour at the rim of things in a mode without normals.
    pub(super) fn check_cues(&self, mode: Mode) -> Result<()> {
        let at_rims = |cue: &DepthCue| matches!(cue, DepthCue::Chromadepth(c) if c.rim.is_some());
        if mode.is_lit() || !self.cue.iter().flatten().any(at_rims) {
            return Ok(());
        }
        Err(Error::usage(format!(
            "'cue' chromadepth cannot have a 'rim' in mode '{mode}': a projection has no normals"
        ))
        .hint("leave 'rim' out, or choose mode iso or dvr"))
    }

    /// Returns these options without what of the cues needs normals.
    #[must_use]
    pub(super) fn without_rims(mut self) -> Self {
        for cue in self.cue.iter_mut().flatten() {
            if let DepthCue::Chromadepth(colors) = cue {
                colors.rim = None;
            }
        }
        self
    }

    /// Makes the depth cues of a camera's picture, and the options that make the same: without a range that of
    /// `content`.
    ///
    /// # Errors
    /// As [`DepthCues::new`], [`DepthRange::of_content`] and [`Self::check_cues`].
    pub(super) fn resolve_cues(
        &mut self,
        mode: Mode,
        camera: &Camera,
        size: ImageSize,
        content: Content,
    ) -> Result<Option<DepthCues>> {
        let Some(cues) = &self.cue else {
            return Ok(None);
        };
        self.check_cues(mode)?;
        let range = match self.cue_range {
            Some(range) => range,
            None => DepthRange::of_content(content, camera)?,
        };
        let resolved = DepthCues::new(cues, range, size)?;
        self.cue = Some(DepthCues::filled_in(cues, size)?);
        self.cue_range = Some(range);
        Ok(Some(resolved))
    }

    /// Returns what dims the light from everywhere, and how it is found.
    pub(super) fn occlusion(&self) -> Option<Occlusion> {
        let of_screen = self.ssao.map(Occlusion::Screen);
        self.ao.map(Occlusion::Volume).or(of_screen)
    }

    /// Returns how light is reflected where nothing else is given: where light from everywhere may be occluded there is more
    /// of it.
    pub(super) fn phong(&self) -> Phong {
        let default = Phong::default();
        match self.occlusion() {
            None => default,
            Some(_) => Phong {
                ambient: Reflectance::OCCLUDED,
                diffuse: Reflectance::OCCLUDED,
                ..default
            },
        }
    }
}
