//! The messages between this program and a peer; scripts/peers/README.md describes them for those
//! who write one.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use crate::error::{Error, Result};
use crate::scene::{
    Camera, Filter, Gradient, Lens, Light, LightFrom, Phong, Picture, Projection, Reflection, Scene,
};
use crate::volume::Volume;

use super::process::quotable;

/// A request to a peer: a line of JSON with one key.
#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Request {
    Load(VolumeFile),
    Scene(Box<SceneRequest>),
    Render(RenderRequest),
    /// All scenes.
    Forget {},
}

impl Request {
    pub fn line(&self) -> Result<String> {
        serde_json::to_string(self)
            .map_err(|cause| Error::failed(format!("a peer's request cannot be written: {cause}")))
    }
}

/// The voxels' file, without header, x fastest, in the machine's byte order.
#[derive(Serialize)]
pub(super) struct VolumeFile {
    pub file: String,
    pub dims: [u32; 3],
    #[serde(rename = "type")]
    pub voxel_type: &'static str,
    pub spacing: [f64; 3],
    pub origin: [f64; 3],
    /// The world directions of the axes x, y, z: unit vectors.
    pub direction: [[f64; 3]; 3],
    /// Minimum and maximum of the voxels.
    pub range: [f64; 2],
}

impl VolumeFile {
    pub fn of(volume: &Volume, file: String) -> Self {
        let geometry = volume.geometry();
        let axes = geometry.direction();
        let range = volume.stored_range();
        Self {
            file,
            dims: volume.dims().array(),
            voxel_type: volume.voxels().voxel_type().name(),
            spacing: geometry.spacing_mm().to_array(),
            origin: geometry.origin_mm().to_array(),
            direction: [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis| axis.to_array()),
            range: [range.min, range.max],
        }
    }
}

/// A scene whose values are those of the voxels as stored; lengths in mm, colours in linear light.
#[derive(Serialize)]
pub(super) struct SceneRequest {
    /// The number by which the scene is rendered.
    id: u64,
    setting: String,
    mode: &'static str,
    size: [u32; 2],
    camera: CameraRequest,
    filter: &'static str,
    gradient: &'static str,
    #[serde(flatten)]
    picture: PictureRequest,
    phong: Option<PhongRequest>,
    /// The gradient, stored units per mm, from which a medium is shaded fully; 0: all of it.
    shaded_from: f64,
    lights: Vec<LightRequest>,
    /// `[nx, ny, nz, d]`: points with n·p + d ≥ 0 stay.
    clip_planes: Vec<[f64; 4]>,
}

#[derive(Serialize)]
pub(super) struct CameraRequest {
    eye: [f64; 3],
    right: [f64; 3],
    up: [f64; 3],
    forward: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    fov_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ortho_height_mm: Option<f64>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum PictureRequest {
    Surface {
        iso: f64,
        caps: bool,
        color: [f64; 3],
    },
    Projection {
        window: [f64; 2],
        #[serde(skip_serializing_if = "Option::is_none")]
        lmip_threshold: Option<f64>,
    },
    Emission {
        unit_length_mm: f64,
        /// `[value, r, g, b, opacity]`: all four are linear between points, constant beyond them.
        points: Vec<[f64; 5]>,
    },
}

#[derive(Serialize)]
struct PhongRequest {
    reflection: &'static str,
    ambient: f64,
    ambient_color: [f64; 3],
    diffuse: f64,
    diffuse_color: [f64; 3],
    specular: f64,
    specular_color: [f64; 3],
    shininess: f64,
}

/// A light; neither `toward` nor `at`: a headlight, by which every ray is lit along itself.
#[derive(Serialize)]
struct LightRequest {
    /// Times its intensity.
    color: [f64; 3],
    /// The unit vector toward a distant light.
    #[serde(skip_serializing_if = "Option::is_none")]
    toward: Option<[f64; 3]>,
    /// A point, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    at: Option<[f64; 3]>,
}

impl LightRequest {
    fn of(light: Light, camera: &Camera) -> Self {
        let (toward, at) = match light.shines_from(camera) {
            LightFrom::Eye => (None, None),
            LightFrom::Direction(toward_light) => (Some(toward_light.to_array()), None),
            LightFrom::Point(at_world) => (None, Some(at_world.to_array())),
        };
        Self {
            color: light.linear().0,
            toward,
            at,
        }
    }
}

impl CameraRequest {
    fn of(camera: &Camera) -> Self {
        let (fov_deg, ortho_height_mm) = match camera.lens() {
            Lens::Perspective { fov_deg } => (Some(fov_deg), None),
            Lens::Orthographic { height_mm } => (None, Some(height_mm)),
        };
        Self {
            eye: camera.eye_world().to_array(),
            right: camera.right().to_array(),
            up: camera.up().to_array(),
            forward: camera.forward().to_array(),
            fov_deg,
            ortho_height_mm,
        }
    }
}

impl SceneRequest {
    pub fn of(id: u64, scene: &Scene, volume: &Volume, setting: &str) -> Self {
        let phong = match &scene.picture {
            Picture::Surface { phong, .. } => *phong,
            Picture::Emission(emission) => emission.phong,
            Picture::Projection { .. } => None,
        };
        let planes = scene.clip_planes.iter();
        Self {
            id,
            setting: setting.to_owned(),
            mode: scene.picture.mode().name(),
            size: [scene.size.width(), scene.size.height()],
            camera: CameraRequest::of(&scene.camera),
            filter: match scene.sampling.filter {
                Filter::Nearest => "nearest",
                Filter::Linear => "linear",
            },
            gradient: match scene.gradient {
                Gradient::Central | Gradient::Precomputed(_) => "central",
                Gradient::Forward => "forward",
                Gradient::FourthOrder => "fourth-order",
            },
            picture: PictureRequest::of(&scene.picture, volume),
            phong: phong.map(PhongRequest::of),
            shaded_from: match &scene.picture {
                Picture::Emission(emission) => emission.shaded_from.get() / volume.rescale().slope,
                Picture::Surface { .. } | Picture::Projection { .. } => 0.0,
            },
            lights: (scene.lights.iter())
                .map(|light| LightRequest::of(*light, &scene.camera))
                .collect(),
            clip_planes: planes
                .map(|plane| plane.normal_world().extend(plane.offset()).to_array())
                .collect(),
        }
    }
}

impl PictureRequest {
    fn of(picture: &Picture, volume: &Volume) -> Self {
        let stored = |value| volume.rescale().stored(value);
        match picture {
            Picture::Surface {
                iso, caps, color, ..
            } => Self::Surface {
                iso: stored(*iso),
                caps: *caps,
                color: color.0,
            },
            Picture::Projection { of, window } => Self::Projection {
                window: [stored(window.black()), stored(window.white())],
                lmip_threshold: match of {
                    Projection::LocalMaximum { threshold } => Some(stored(*threshold)),
                    _ => None,
                },
            },
            Picture::Emission(emission) => Self::Emission {
                unit_length_mm: emission.transfer.unit_length_mm(),
                points: (emission.transfer.knots_within(volume.range()).iter())
                    .map(|knot| {
                        let [r, g, b] = knot.color.0;
                        [stored(knot.value), r, g, b, knot.opacity]
                    })
                    .collect(),
            },
        }
    }
}

impl PhongRequest {
    fn of(phong: Phong) -> Self {
        Self {
            reflection: match phong.reflection {
                Reflection::Phong => "phong",
                Reflection::BlinnPhong => "blinn-phong",
            },
            ambient: phong.ambient.get(),
            ambient_color: phong.ambient_color.0,
            diffuse: phong.diffuse.get(),
            diffuse_color: phong.diffuse_color.0,
            specular: phong.specular.get(),
            specular_color: phong.specular_color.0,
            shininess: phong.shininess.get(),
        }
    }
}

/// A scene, and where its picture's planes go: float32, little-endian, row 0 at the top; nowhere,
/// for a picture that is only timed.
#[derive(Serialize)]
pub(super) struct RenderRequest {
    pub id: u64,
    /// The camera in place of the scene's, for pictures that are only timed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraRequest>,
    /// R, G, B, A: linear light, premultiplied, without background.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<String>,
    /// The file of the depth plane: mm from the eye along the ray, from the eye plane in orthographic
    /// projection; +∞: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth: Option<String>,
}

impl RenderRequest {
    /// A picture for its time alone, without planes.
    pub fn timed(id: u64) -> Self {
        Self {
            id,
            camera: None,
            color: None,
            depth: None,
        }
    }

    /// A picture for its time alone, from another camera.
    pub fn timed_from(id: u64, camera: &Camera) -> Self {
        Self {
            camera: Some(CameraRequest::of(camera)),
            ..Self::timed(id)
        }
    }
}

/// The first line of a peer.
#[derive(Deserialize)]
pub(super) struct Hello {
    #[serde(deserialize_with = "line")]
    pub peer: String,
    #[serde(deserialize_with = "line")]
    pub version: String,
    #[serde(deserialize_with = "line")]
    pub device: String,
    pub settings: Vec<OfferedSetting>,
}

/// Text that goes into lines of ours.
fn line<'de, D: Deserializer<'de>>(from: D) -> std::result::Result<String, D::Error> {
    String::deserialize(from).map(|text| quotable(&text))
}

fn optional_line<'de, D: Deserializer<'de>>(
    from: D,
) -> std::result::Result<Option<String>, D::Error> {
    Option::<String>::deserialize(from).map(|text| text.map(|text| quotable(&text)))
}

/// A setting's name goes back to the peer, so that it is passed on unchanged or refused.
fn name<'de, D: Deserializer<'de>>(from: D) -> std::result::Result<String, D::Error> {
    let name = String::deserialize(from)?;
    match quotable(&name) == name && !name.contains(char::is_control) {
        true => Ok(name),
        false => Err(D::Error::custom(format!(
            "the setting '{}' has too long a name, or a control character in it",
            quotable(&name)
        ))),
    }
}

#[derive(Deserialize)]
pub(super) struct OfferedSetting {
    #[serde(deserialize_with = "name")]
    pub name: String,
    pub modes: Vec<String>,
}

#[derive(Deserialize)]
pub(super) struct Loaded {
    /// Time to load the volume, ms.
    pub loaded: f64,
}

/// The answer that the scenes are forgotten.
#[derive(Deserialize)]
pub(super) struct Forgotten {}

#[derive(Deserialize)]
pub(super) struct Ready {
    pub supported: bool,
    /// Time to prepare the scene, ms.
    #[serde(default)]
    pub ready: f64,
    /// Why it is not supported.
    #[serde(default, deserialize_with = "optional_line")]
    pub why: Option<String>,
    /// How its picture differs from the scene's.
    #[serde(default, deserialize_with = "optional_line")]
    pub note: Option<String>,
}

#[derive(Deserialize)]
pub(super) struct Rendered {
    pub ms: f64,
    pub cpu_ms: Option<f64>,
    /// Whether the depth plane was written.
    #[serde(default)]
    pub depth: bool,
}
