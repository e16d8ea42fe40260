//! From the scene's data to the structs that kernels read; the structs' layouts for the test.

use crate::scene::{Light, Phong, Rgb, Sampling, Tone as SceneTone, Window};
use crate::volume::{Rescale, Volume};

use super::abi::{
    self, EmissionCast, ProjectionCast, RayGrid, Shading, SurfaceCast, Tone, VolumeGrid,
};
use super::variant::reflection_number;

/// Name, size and field offsets, in bytes, of every struct that is shared with the kernels.
pub fn struct_layouts() -> Vec<(&'static str, Vec<u32>)> {
    vec![
        ("RayGrid", RayGrid::layout()),
        ("VolumeGrid", VolumeGrid::layout()),
        ("SurfaceCast", SurfaceCast::layout()),
        ("ProjectionCast", ProjectionCast::layout()),
        ("EmissionCast", EmissionCast::layout()),
        ("Shading", Shading::layout()),
        ("Tone", abi::Tone::layout()),
    ]
}

fn rgb0(color: Rgb) -> [f32; 4] {
    let [r, g, b] = color.0.map(|c| c as f32);
    [r, g, b, 0.0]
}

/// The step in mm.
pub fn step_mm(sampling: &Sampling, volume: &Volume) -> f64 {
    sampling.step.get() * volume.geometry().smallest_spacing_mm()
}

/// A physical value in the device's stored units; beyond single precision, its end.
pub fn stored(rescale: Rescale, physical: f64) -> f32 {
    let most = f64::from(f32::MAX);
    rescale.stored(physical).clamp(-most, most) as f32
}

/// A window's ends, black and white, in stored units. Where single precision cannot tell them apart and
/// white is the lower one, it is the next number below.
pub fn stored_window(rescale: Rescale, window: Window) -> [f32; 2] {
    let (black, white) = (
        stored(rescale, window.black()),
        stored(rescale, window.white()),
    );
    if black == white && window.white() < window.black() {
        return [black, black.next_down()];
    }
    [black, white]
}

/// The same as [`stored`], and how far it is from the value asked for.
pub fn stored_with_error(rescale: Rescale, physical: f64) -> (f32, f32) {
    let nearest = stored(rescale, physical);
    let error = (rescale.stored(physical) - f64::from(nearest)).abs() as f32;
    (nearest, error)
}

pub fn shading(color: Rgb, phong: Option<Phong>, light: Light) -> Shading {
    let numbers = phong.unwrap_or_default();
    let toward_light = match light {
        Light::Headlight => [0.0, 0.0, 0.0, 1.0],
        Light::Distant { toward_light } => {
            let l = toward_light.unit();
            [l.x as f32, l.y as f32, l.z as f32, 0.0]
        }
    };
    Shading {
        color: rgb0(color),
        toward_light,
        ambient: numbers.ambient.get() as f32,
        diffuse: numbers.diffuse.get() as f32,
        specular: numbers.specular.get() as f32,
        shininess: numbers.shininess.get() as f32,
        reflection: reflection_number(phong),
        pad_0: 0,
        pad_1: 0,
        pad_2: 0,
    }
}

pub fn tone(tone: &SceneTone) -> Tone {
    Tone {
        background: rgb0(tone.background),
        brightness: tone.brightness.get() as f32,
        contrast: tone.contrast.get() as f32,
        inverse_gamma: (1.0 / tone.gamma.get()) as f32,
        pad: 0,
    }
}
