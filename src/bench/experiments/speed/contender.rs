//! What is timed: modes in their settings, from the camera of the peers' benchmark.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::medium::Medium;
use crate::bench::Specimen;
use crate::error::Result;
use crate::extent::ImageSize;
use crate::scene::{
    Camera, Emission, Knot, Lens, Light, Mode, Phong, Picture, Projection, Quadrature, Refine,
    Reflectance, Rgb, Sampling, SamplingMethod, Scene, Tone, TransferFunction, Window,
};

/// What is seen; ways of seeing the same have one truth and one rival.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Look {
    Surface,
    Maximum,
    Mean,
    LocalMaximum,
    Medium,
    ShadedMedium,
}

impl Look {
    pub const ALL: [Self; 6] = [
        Self::Surface,
        Self::Maximum,
        Self::Mean,
        Self::LocalMaximum,
        Self::Medium,
        Self::ShadedMedium,
    ];

    pub fn mode(self) -> Mode {
        match self {
            Self::Surface => Mode::Iso,
            Self::Maximum => Mode::Mip,
            Self::Mean => Mode::Mean,
            Self::LocalMaximum => Mode::Lmip,
            Self::Medium | Self::ShadedMedium => Mode::Dvr,
        }
    }

    /// For tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Surface => "iso shaded",
            Self::Maximum => "mip",
            Self::Mean => "mean",
            Self::LocalMaximum => "lmip",
            Self::Medium => "dvr",
            Self::ShadedMedium => "dvr shaded",
        }
    }
}

/// A look in one setting.
pub struct Contender {
    pub look: Look,
    pub setting: String,
    /// From the middle of the camera's way.
    pub scene: Scene,
}

/// Of a surface and of shaded media, with a headlight: as in the peers' benchmark.
const PHONG: (f64, f64) = (0.1, 0.9);
const SURFACE: Rgb = Rgb([0.9, 0.78, 0.7]);

/// A transfer function as in the peers' benchmark: values as multiples of the iso value, counted from
/// [`base`], which there are 60, 110, 170 and 230 of 255; colours in linear light; opacities of a
/// voxel's path.
const KNOTS: [(f64, [f64; 3], f64); 4] = [
    (60.0 / 124.0, [0.25, 0.02, 0.02], 0.0),
    (110.0 / 124.0, [0.8, 0.15, 0.1], 0.04),
    (170.0 / 124.0, [1.0, 0.6, 0.35], 0.15),
    (230.0 / 124.0, [1.0, 0.95, 0.85], 0.3),
];

/// From where a transfer function's values are counted: 0 where no voxel lies below.
fn base(specimen: &Specimen) -> f64 {
    specimen.volume.range().min.min(0.0)
}

/// From 2.2 times the volume's longest side, 20° above its middle, the field of view 30°.
fn camera(specimen: &Specimen) -> Result<Camera> {
    let (center_world, _) = specimen.volume.bounding_sphere();
    let spacing_mm = specimen.volume.geometry().spacing_mm();
    let voxels = specimen.volume.dims().array();
    let sides_mm = DVec3::from_array(voxels.map(|n| f64::from(n.max(2) - 1))) * spacing_mm;
    let (up, ahead) = 20_f64.to_radians().sin_cos();
    let away = DVec3::new(ahead, 0.0, up) * (2.2 * sides_mm.max_element());
    Camera::look_at(
        center_world + away,
        center_world,
        DVec3::Z,
        Lens::Perspective { fov_deg: 30.0 },
    )
}

/// A look at a specimen in a way of following rays.
pub fn scene(
    specimen: &Specimen,
    look: Look,
    side_px: u32,
    sampling: Sampling,
    quadrature: Quadrature,
) -> Result<Scene> {
    let range = specimen.volume.range();
    let phong = Some(Phong {
        ambient: Reflectance::new(PHONG.0)?,
        diffuse: Reflectance::new(PHONG.1)?,
        specular: Reflectance::new(0.0)?,
        ..Phong::default()
    });
    let projection = |of| -> Result<Picture> {
        let window = Window::new(base(specimen), range.max)?;
        Ok(Picture::Projection { of, window })
    };
    let medium = |phong| -> Result<Picture> {
        let base = base(specimen);
        let knot = |&(multiple, color, opacity)| Knot {
            value: base + multiple * (specimen.iso - base),
            color: Rgb(color),
            opacity,
        };
        let unit_length_mm = specimen.volume.geometry().smallest_spacing_mm();
        let transfer = TransferFunction::new(KNOTS.iter().map(knot).collect(), unit_length_mm)?;
        Ok(Picture::Emission(Emission {
            phong,
            quadrature,
            ..Emission::of(transfer)
        }))
    };
    Ok(Scene {
        size: ImageSize::new(side_px, side_px)?,
        camera: camera(specimen)?,
        picture: match look {
            Look::Surface => Picture::Surface {
                iso: specimen.iso,
                caps: true,
                refine: Refine::default(),
                color: SURFACE,
                phong,
            },
            Look::Maximum => projection(Projection::Maximum)?,
            Look::Mean => projection(Projection::Mean)?,
            Look::LocalMaximum => projection(Projection::LocalMaximum {
                threshold: specimen.iso,
            })?,
            Look::Medium => medium(None)?,
            Look::ShadedMedium => medium(phong)?,
        },
        clip_planes: Vec::new(),
        sampling,
        light: Light::default(),
        gradient: Default::default(),
        tone: Tone::default(),
    })
}

/// Everything that is timed in pictures of one size, `media` in the settings chosen for them.
pub fn contenders(specimen: &Specimen, side_px: u32, media: &[Medium]) -> Result<Vec<Contender>> {
    let fixed = Sampling {
        method: SamplingMethod::Fixed,
        ..Sampling::default()
    };
    let (exact, plain) = (Sampling::default(), Quadrature::default());
    let steps = format!("step {}", fixed.step);
    let mut all = Vec::new();
    for (look, setting, sampling) in [
        (Look::Surface, "exact", exact),
        (Look::Surface, &steps, fixed),
        (Look::Maximum, "exact", exact),
        (Look::Maximum, &steps, fixed),
        (Look::Mean, "exact", exact),
        (Look::LocalMaximum, "exact", exact),
    ] {
        all.push(Contender {
            look,
            setting: setting.to_owned(),
            scene: scene(specimen, look, side_px, sampling, plain)?,
        });
    }
    for medium in media {
        all.push(Contender {
            look: medium.look(),
            setting: medium.setting(),
            scene: medium.scene(specimen, side_px)?,
        });
    }
    Ok(all)
}
