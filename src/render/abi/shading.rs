//! From a scene's lights and a material to what kernels shade by: the one place where lights narrow from double to
//! single precision.

use glam::DVec3;

use crate::scene::{Light, LightFrom, Phong, Rgb, Scene, ShadedFrom};
use crate::volume::Volume;

use super::constants::KernelEnum;
use super::convert::rgb0;
use super::structs::{LightSource, Shading};

/// The number by which the map from index-space to world-space covectors is divided on the device, so that extreme
/// spacings cost no precision: its largest entry, per mm.
pub fn covector_scale(volume: &Volume) -> f64 {
    largest(volume.geometry().index_from_world().matrix3.to_cols_array())
}

fn largest<const N: usize>(numbers: [f64; N]) -> f64 {
    numbers
        .iter()
        .fold(0.0, |max, number| max.max(number.abs()))
}

/// How a surface of this colour, or a medium, reflects the lights of a scene; without a reflection it shows its
/// colour.
pub struct Material {
    /// The surface's colour; a medium has its own.
    pub color: Rgb,
    /// The reflection.
    pub phong: Option<Phong>,
    /// The gradient from which a medium is shaded fully.
    pub shaded_from: ShadedFrom,
}

/// The lights of a scene, and how a material reflects them.
pub fn shading(material: &Material, scene: &Scene, volume: &Volume) -> Shading {
    let phong = material.phong.unwrap_or_default();
    let world_from_index = volume.geometry().world_from_index().matrix3;
    let rows = world_from_index.transpose() * largest(world_from_index.to_cols_array()).recip();
    let mut lights = [bytemuck::Zeroable::zeroed(); Light::MAX_COUNT];
    for (source, light) in lights.iter_mut().zip(&scene.lights) {
        *source = light_source(*light, &phong, scene, volume);
    }
    // Where it is too small for a number of the device all is shaded, as from 0 on.
    let in_stored = material.shaded_from.get() / volume.rescale().slope / covector_scale(volume);
    let shaded_from = in_stored.min(f64::from(f32::MAX)) as f32;
    Shading {
        color: rgb0(material.color),
        ambient: rgb0(Rgb(phong.ambient_light())),
        world_row_x: xyz0(rows.x_axis),
        world_row_y: xyz0(rows.y_axis),
        world_row_z: xyz0(rows.z_axis),
        lights,
        light_count: scene.lights.len().min(Light::MAX_COUNT) as u32,
        shininess: phong.shininess.get() as f32,
        reflection: material.phong.map(|phong| phong.reflection).number(),
        shaded_from: if shaded_from.is_normal() {
            shaded_from
        } else {
            0.0
        },
    }
}

/// One light of a scene. A point's place is narrowed in index space, as rays' are: neither a far eye nor a volume far
/// from the world's origin costs it digits.
fn light_source(light: Light, phong: &Phong, scene: &Scene, volume: &Volume) -> LightSource {
    let (diffuse, specular) = phong.of_light(light);
    let shines_from = light.shines_from(&scene.camera);
    let place = match shines_from {
        LightFrom::Eye => DVec3::ZERO,
        LightFrom::Direction(toward_light) => toward_light,
        LightFrom::Point(at_world) => {
            let at_index = (volume.geometry().index_from_world()).transform_point3(at_world);
            // Beyond any number of the device a point is a direction.
            at_index * (FARTHEST / largest(at_index.to_array())).min(1.0)
        }
    };
    LightSource {
        place: xyz0(place),
        diffuse: rgb0(Rgb(diffuse)),
        specular: rgb0(Rgb(specular)),
        shines_from: shines_from.number(),
        pad_0: 0,
        pad_1: 0,
        pad_2: 0,
    }
}

/// The most that an index coordinate of a light is.
const FARTHEST: f64 = 1e30;

fn xyz0(v: DVec3) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, 0.0]
}
