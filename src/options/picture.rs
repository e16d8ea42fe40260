//! Picture options: what is shown.

use super::enum_names::{GradientMethod, Shading, Switch};
use super::group::group;
use super::lights;
use super::quantities::{GradientScale, SigmaVoxels};
use super::shade_from::ShadeFrom;
use super::text_form::text_form;
use super::threshold::{Threshold, WindowEnds};
use super::transfer_choice::TransferChoice;
use crate::scene::{
    HomogeneityLimit, HomogeneityRule, Light, Mode, Quadrature, Refine, Reflectance, Shininess,
    SrgbColor, Termination, TransferFile, TransferUnits,
};

text_form!(
    HomogeneityLimit,
    HomogeneityRule,
    Mode,
    Quadrature,
    Refine,
    Reflectance,
    Shininess,
    Termination
);

group! {
    /// The options of the picture that is shown.
    #[derive(serde::Serialize)]
    #[command(next_help_heading = "Picture")]
    pub struct PictureOptions {
        /// What is shown: iso (a surface), mip, minip, mean, lmip (projections) or dvr (emission and
        /// absorption)
        #[arg(long, value_name = "MODE")]
        mode: Mode,

        /// The surface's value; a number, a share of the value range such as 50%, a percentile of the
        /// voxels such as p99.5 (nearest rank), or otsu
        #[arg(long, value_name = "VALUE|N%|pN|otsu", allow_hyphen_values = true)]
        iso: Threshold,

        /// Close the surface where the volume ends or is clipped
        #[arg(long, value_name = "on|off")]
        caps: Switch,

        /// How the hit is refined between samples: none, bisection, regula-falsi, illinois or newton, :N
        /// for N iterations
        #[arg(long, value_name = "METHOD[:N]")]
        refine: Refine,

        /// The surface's colour: sRGB r,g,b from 0 to 1, #rrggbb, #rgb, or a CSS name such as ivory
        #[arg(long, value_name = "COLOR", allow_hyphen_values = true)]
        color: SrgbColor,

        /// The values shown black and white; numbers, shares of the value range such as 5%, percentiles
        /// of the voxels such as p99.5, or otsu. HI,LO inverts: what is bright in the volume is dark in
        /// the picture
        #[arg(long, value_name = "LO,HI", allow_hyphen_values = true)]
        window: WindowEnds,

        /// The value from which a local maximum counts, written as that of --iso
        #[arg(long, value_name = "VALUE|N%|pN|otsu", allow_hyphen_values = true)]
        lmip_threshold: Threshold,

        /// The transfer function, a TOML file or a preset: cta (Hounsfield units), mra or 3dra (shares of
        /// the window's default)
        #[arg(long, value_name = "FILE|PRESET")]
        tf: TransferChoice,

        /// How light is summed along a ray: riemann, midpoint, simpson, romberg, rk4 or preintegrated at
        /// the fixed step, or adaptive, which takes no steps and keeps every channel within the error
        /// :BOUND of linear light, 0.001 by default
        #[arg(long, value_name = "METHOD[:BOUND]")]
        quad: Quadrature,

        /// Take an octree leaf for its average value, in one step, where that changes no pixel by more
        /// than E
        #[arg(long, value_name = "E", allow_hyphen_values = true)]
        homogeneity: HomogeneityLimit,

        /// What E limits: optical, the pixel's error; or range, the leaf's value range as a share of the
        /// volume's, whatever the transfer function does in it
        #[arg(long, value_name = "optical|range")]
        homogeneity_rule: HomogeneityRule,

        /// The opacity at which a ray ends; the colour lost is at most 1 minus this
        #[arg(long, value_name = "OPACITY", allow_hyphen_values = true)]
        termination: Termination,

        /// none, phong or blinn-phong
        #[arg(long, value_name = "NAME")]
        shading: Shading,

        /// Light reflected from everywhere
        #[arg(long, value_name = "A", allow_hyphen_values = true)]
        ambient: Reflectance,

        /// The tint of that light, a colour as that of --color
        #[arg(long, value_name = "COLOR", allow_hyphen_values = true)]
        ambient_color: SrgbColor,

        /// Light of the lights reflected in all directions; of either side, for the normal is turned to
        /// the viewer first
        #[arg(long, value_name = "D", allow_hyphen_values = true)]
        diffuse: Reflectance,

        /// The tint of that light, a colour as that of --color
        #[arg(long, value_name = "COLOR", allow_hyphen_values = true)]
        diffuse_color: SrgbColor,

        /// Light of the lights mirrored
        #[arg(long, value_name = "S", allow_hyphen_values = true)]
        specular: Reflectance,

        /// The tint of that light, a colour as that of --color
        #[arg(long, value_name = "COLOR", allow_hyphen_values = true)]
        specular_color: SrgbColor,

        /// Sharpness of the mirrored light
        #[arg(long, value_name = "N", allow_hyphen_values = true)]
        shininess: Shininess,

        /// A light, up to 4 times: headlight; fixed to the patient, the direction X,Y,Z toward it in world
        /// space or point:X,Y,Z, a place in mm, whose light gets no less with the distance; or fixed to the
        /// camera, camera:X,Y,Z, the direction toward it right, up and toward the viewer, or
        /// camera-point:X,Y,Z, a place in mm from the eye. Behind it there may be a colour as that of --color
        /// and an intensity, such as headlight@ivory@0.8
        #[arg(long, value_name = "PLACE[@COLOR][@INTENSITY]", allow_hyphen_values = true)]
        #[serde(deserialize_with = "lights::deserialize", serialize_with = "lights::serialize")]
        light: Vec<Light>,

        /// The gradient from which on the medium is shaded fully, in values per mm, or as a share of the
        /// value range per voxel such as 5%; where it is smaller, as in noise, the shaded colour counts as
        /// much less and the medium's own the more
        #[arg(long, value_name = "G|N%", allow_hyphen_values = true)]
        shade_from: ShadeFrom,

        /// How normals are found: central, forward or fourth-order differences of the field, or
        /// precomputed: central ones at every N-th voxel, interpolated between
        #[arg(long, value_name = "NAME")]
        gradient: GradientMethod,

        /// Voxels from one to the next, 1 to 8
        #[arg(long, value_name = "N", allow_hyphen_values = true)]
        gradient_scale: GradientScale,

        /// Standard deviation of the Gaussian that smooths the field before, in voxels of the smallest
        /// spacing
        #[arg(long, value_name = "VOXELS", allow_hyphen_values = true)]
        gradient_smooth: SigmaVoxels,
    }
}

impl PictureOptions {
    /// Returns the mode: that of a surface where none is given.
    pub(super) fn mode(&self) -> Mode {
        self.mode.unwrap_or_default()
    }

    /// Returns the shading: Phong's for a surface and none for a medium where none is given.
    pub(super) fn shading(&self) -> Shading {
        self.shading.unwrap_or(Shading::of(self.mode()))
    }

    /// Returns whether the picture is shaded.
    pub(super) fn is_shaded(&self) -> bool {
        self.shading() != Shading::None
    }

    /// Returns whether the picture has normals. An unshaded surface has its normal layer.
    pub(super) fn has_normals(&self) -> bool {
        match self.mode() {
            Mode::Iso => true,
            Mode::Dvr => self.is_shaded(),
            Mode::Mip | Mode::Lmip | Mode::Minip | Mode::Mean => false,
        }
    }

    /// Returns how normals are found: by central differences where nothing is given.
    pub(super) fn gradient_method(&self) -> GradientMethod {
        self.gradient.unwrap_or_default()
    }

    /// Returns whether a default of these options is made from the values' robust range.
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
}
