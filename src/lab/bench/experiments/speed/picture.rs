//! The pictures that are timed, from the camera of the peers' benchmark.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::extent::ImageSize;
use crate::lab::bench::Dataset;
use crate::scene::{
    Camera, Emission, Knot, Lens, Light, Mode, Phong, Picture, Projection, Quadrature, Refine,
    Reflectance, Rgb, Sampling, Scene, Tone, TransferFunction, Window,
};

/// The kind of picture; settings that show the same have one reference and one baseline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum PictureKind {
    Surface,
    Maximum,
    Mean,
    LocalMaximum,
    Medium,
    ShadedMedium,
}

impl PictureKind {
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

    /// The name in tables.
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

/// Ambient and diffuse light of a surface and of shaded media, with a headlight: as in the peers'
/// benchmark.
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

/// The value from which a transfer function's values are counted: 0 where no voxel lies below.
fn base(dataset: &Dataset) -> f64 {
    dataset.volume.range().min.min(0.0)
}

/// The camera: 2.2 times the volume's longest side away, 20° above its middle, the field of view 30°.
fn camera(dataset: &Dataset) -> Result<Camera> {
    let (center_world, _) = dataset.volume.bounding_sphere();
    let spacing_mm = dataset.volume.geometry().spacing_mm();
    let voxels = dataset.volume.dims().array();
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

/// The scene of a dataset under a method of following rays.
pub fn scene(
    dataset: &Dataset,
    kind: PictureKind,
    side_px: u32,
    sampling: Sampling,
    quadrature: Quadrature,
) -> Result<Scene> {
    let range = dataset.volume.range();
    let phong = Some(Phong {
        ambient: Reflectance::new(PHONG.0)?,
        diffuse: Reflectance::new(PHONG.1)?,
        specular: Reflectance::new(0.0)?,
        ..Phong::default()
    });
    let projection = |of| -> Result<Picture> {
        let window = Window::new(base(dataset), range.max)?;
        Ok(Picture::Projection { of, window })
    };
    let medium = |phong| -> Result<Picture> {
        let base = base(dataset);
        let knot = |&(multiple, color, opacity)| Knot {
            value: base + multiple * (dataset.iso - base),
            color: Rgb(color),
            opacity,
        };
        let unit_length_mm = dataset.volume.geometry().smallest_spacing_mm();
        let transfer = TransferFunction::new(KNOTS.iter().map(knot).collect(), unit_length_mm)?;
        Ok(Picture::Emission(Emission {
            phong,
            quadrature,
            ..Emission::of(transfer)
        }))
    };
    Ok(Scene {
        size: ImageSize::new(side_px, side_px)?,
        camera: camera(dataset)?,
        picture: match kind {
            PictureKind::Surface => Picture::Surface {
                iso: dataset.iso,
                caps: true,
                refine: Refine::default(),
                color: SURFACE,
                phong,
            },
            PictureKind::Maximum => projection(Projection::Maximum)?,
            PictureKind::Mean => projection(Projection::Mean)?,
            PictureKind::LocalMaximum => projection(Projection::LocalMaximum {
                threshold: dataset.iso,
            })?,
            PictureKind::Medium => medium(None)?,
            PictureKind::ShadedMedium => medium(phong)?,
        },
        clip_planes: Vec::new(),
        sampling,
        lights: vec![Light::default()],
        ambient_occlusion: None,
        shadows: None,
        depth_of_field: None,
        depth_cues: None,
        gradient: Default::default(),
        anti_aliasing: Default::default(),
        sparse: None,
        tone: Tone::default(),
    })
}
