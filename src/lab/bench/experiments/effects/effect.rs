//! The effects, and the settings of each.

use glam::DVec3;

use crate::error::Result;
use crate::lab::bench::Dataset;
use crate::scene::{
    DistanceMm, DofMethod, Light, LightSizeDeg, Occlusion, Phong, Picture, Scene, ShadowMethod,
    Shadows,
};

/// What a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// The surface, every cell solved.
    Surface,
    /// Emission and absorption.
    Medium,
}

impl Shown {
    pub const ALL: [Self; 2] = [Self::Surface, Self::Medium];

    /// The mode that shows it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Surface => "iso",
            Self::Medium => "dvr",
        }
    }

    /// The picture without any effect, lit from above the left shoulder of who looks at it: a headlight casts no shadows.
    pub fn scene(self, dataset: &Dataset, side_px: u32) -> Result<Scene> {
        let mut scene = match self {
            Self::Surface => dataset.surface(side_px)?,
            Self::Medium => dataset.emission(side_px)?,
        };
        match &mut scene.picture {
            Picture::Surface { phong, .. } => *phong = Some(Phong::default()),
            Picture::Emission(medium) => medium.phong = Some(Phong::default()),
            Picture::Projection { .. } => {}
        }
        scene.lights = vec![Light::of_camera(DVec3::new(-1.0, 1.0, 1.0))?];
        Ok(scene)
    }
}

/// The layer or the colours by which an effect is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JudgedBy {
    Occlusion,
    Visibility,
    /// The colours, in focus and out of it.
    Colors,
}

impl JudgedBy {
    pub fn name(self) -> &'static str {
        match self {
            Self::Occlusion => "occlusion",
            Self::Visibility => "visibility",
            Self::Colors => "colours",
        }
    }

    /// The error that stands for all of an effect's.
    pub fn error_name(self) -> &'static str {
        match self {
            Self::Occlusion | Self::Visibility => "mean error",
            Self::Colors => "rmse",
        }
    }
}

/// An effect of pictures of one kind: what the reference renders is the same whatever the setting.
pub struct Effect {
    pub name: &'static str,
    pub shown: Shown,
    pub judged_by: JudgedBy,
    pub options: &'static [EffectOption],
}

/// An option that makes an effect.
pub struct EffectOption {
    pub name: &'static str,
    /// Its settings, as users write them but for what all of them share.
    pub settings: &'static [&'static str],
    /// The picture with it.
    pub on: fn(Scene, &Dataset, &str) -> Result<Scene>,
}

const SHADOWS: &str = "shadows";
const DEPTH_OF_FIELD: &str = "depth of field";

pub const EFFECTS: [Effect; 6] = [
    Effect {
        name: "ambient occlusion",
        shown: Shown::Surface,
        judged_by: JudgedBy::Occlusion,
        options: &[
            EffectOption {
                name: AO,
                settings: &[
                    "rays=4",
                    "rays=16",
                    "rays=64",
                    "rays=256",
                    "bound=0.1",
                    "bound=0.05",
                ],
                on: occluded_in_volume,
            },
            EffectOption {
                name: "ssao",
                settings: &["samples=8", "samples=16", "samples=32", "samples=64"],
                on: occluded_on_screen,
            },
        ],
    },
    Effect {
        name: SHADOWS,
        shown: Shown::Surface,
        judged_by: JudgedBy::Visibility,
        options: &[EffectOption {
            name: "shadows",
            settings: &["on"],
            on: |scene, _, method| shadowed(scene, method, 0.0),
        }],
    },
    Effect {
        name: "soft shadows",
        shown: Shown::Surface,
        judged_by: JudgedBy::Visibility,
        options: &[EffectOption {
            name: "light-size",
            settings: &["5"],
            on: |scene, _, size| shadowed(scene, "on", size.parse::<LightSizeDeg>()?.get()),
        }],
    },
    Effect {
        name: DEPTH_OF_FIELD,
        shown: Shown::Surface,
        judged_by: JudgedBy::Colors,
        options: &[EffectOption {
            name: "dof-method",
            settings: &["gather", "mix", "lens:16", "lens:64"],
            on: out_of_focus,
        }],
    },
    Effect {
        name: SHADOWS,
        shown: Shown::Medium,
        judged_by: JudgedBy::Visibility,
        options: &[EffectOption {
            name: "shadows",
            settings: &["step=4", "step=2", "step=1", "on", "cached:128"],
            on: |scene, _, method| shadowed(scene, method, 0.0),
        }],
    },
    Effect {
        name: DEPTH_OF_FIELD,
        shown: Shown::Medium,
        judged_by: JudgedBy::Colors,
        options: &[EffectOption {
            name: "dof-method",
            settings: &["gather", "lens:16"],
            on: out_of_focus,
        }],
    },
];

/// The option by whose rays occlusion is estimated.
pub const AO: &str = "ao";

/// The share of the volume's radius within which a surface occludes itself.
pub const OCCLUDED_WITHIN: f64 = 0.25;

fn occluding_mm(dataset: &Dataset) -> Result<DistanceMm> {
    let (_, radius_mm) = dataset.volume.bounding_sphere();
    DistanceMm::new(OCCLUDED_WITHIN * radius_mm)
}

fn occluded_in_volume(mut scene: Scene, dataset: &Dataset, setting: &str) -> Result<Scene> {
    let text = format!("{setting},distance={}", occluding_mm(dataset)?);
    scene.ambient_occlusion = Some(Occlusion::Volume(text.parse()?));
    Ok(scene)
}

fn occluded_on_screen(mut scene: Scene, dataset: &Dataset, setting: &str) -> Result<Scene> {
    let text = format!("{setting},radius={}", occluding_mm(dataset)?);
    scene.ambient_occlusion = Some(Occlusion::Screen(text.parse()?));
    Ok(scene)
}

fn shadowed(mut scene: Scene, method: &str, size_deg: f64) -> Result<Scene> {
    scene.shadows = Some(Shadows {
        method: method.parse::<ShadowMethod>()?,
        light_size: LightSizeDeg::new(size_deg)?,
    });
    Ok(scene)
}

/// The widest circles of confusion, pixels.
pub const WIDEST_PX: f64 = 12.0;

fn out_of_focus(mut scene: Scene, dataset: &Dataset, method: &str) -> Result<Scene> {
    scene.depth_of_field = Some(dataset.lens(&scene, WIDEST_PX)?);
    scene.sampling.dof = method.parse::<DofMethod>()?;
    Ok(scene)
}
