//! From the scene's data to the structs and units of kernels; the structs' layouts for the test.

use crate::scene::{Jitter as SceneJitter, Rgb, Sampling, Tone as SceneTone, Window};
use crate::volume::{Rescale, Volume};

use super::structs::{
    EmissionCast, Jitter, LightGrid, LightSource, ProjectionCast, RayGrid, Shading, SurfaceCast,
    Tone, VolumeGrid,
};

/// Name, size and field offsets, in bytes, of every struct that is shared with the kernels.
pub fn struct_layouts() -> Vec<(&'static str, Vec<u32>)> {
    vec![
        ("RayGrid", RayGrid::layout()),
        ("VolumeGrid", VolumeGrid::layout()),
        ("SurfaceCast", SurfaceCast::layout()),
        ("ProjectionCast", ProjectionCast::layout()),
        ("EmissionCast", EmissionCast::layout()),
        ("LightGrid", LightGrid::layout()),
        ("LightSource", LightSource::layout()),
        ("Jitter", Jitter::layout()),
        ("Shading", Shading::layout()),
        ("Tone", Tone::layout()),
    ]
}

/// A colour as kernels have it, with 0 for what they do not read.
pub(super) fn rgb0(color: Rgb) -> [f32; 4] {
    let [r, g, b] = color.0.map(|c| c as f32);
    [r, g, b, 0.0]
}

/// The step in mm.
pub fn step_mm(sampling: &Sampling, volume: &Volume) -> f64 {
    sampling.step.get() * volume.geometry().smallest_spacing_mm()
}

/// How the samples of rays are shifted; `None`: they are not.
pub fn jitter(jitter: SceneJitter) -> Option<Jitter> {
    let (_, parts) = jitter.shift(0, 0);
    let offsets = |side, [along_x, along_y]: [u32; 2], start| Jitter {
        parts,
        hashed: 0,
        side,
        along_x,
        along_y,
        start,
        pad_0: 0,
        pad_1: 0,
    };
    match jitter {
        SceneJitter::None => None,
        SceneJitter::Shift(shift) => Some(offsets(1, [0, 0], shift.parts())),
        SceneJitter::Interleaved(pattern) => {
            let start = pattern.gained();
            Some(offsets(pattern.side(), pattern.gains(), start))
        }
        SceneJitter::Hash { seed, frame } => Some(Jitter {
            hashed: 1,
            ..offsets(1, [0, 0], SceneJitter::hash_key(seed, frame))
        }),
    }
}

/// A physical value in the device's stored units; beyond single precision, its end.
pub fn stored(rescale: Rescale, physical: f64) -> f32 {
    let max = f64::from(f32::MAX);
    rescale.stored(physical).clamp(-max, max) as f32
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

/// An iso value as the device has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StoredIso {
    /// The nearest number in single precision, in stored units.
    pub value: f32,
    /// How far that is from the scene's iso value.
    pub error: f32,
}

impl StoredIso {
    /// The nearest to a physical value.
    pub fn nearest(rescale: Rescale, physical: f64) -> Self {
        let value = stored(rescale, physical);
        let error = (rescale.stored(physical) - f64::from(value)).abs() as f32;
        Self { value, error }
    }

    /// A physical value narrowed to single precision and then taken as exact.
    pub fn exactly(rescale: Rescale, physical: f64) -> Self {
        Self {
            value: stored(rescale, physical),
            error: 0.0,
        }
    }
}

/// The tone curve, in single precision.
pub fn tone(tone: &SceneTone) -> Tone {
    Tone {
        background: rgb0(tone.background),
        brightness: tone.brightness.get() as f32,
        contrast: tone.contrast.get() as f32,
        inverse_gamma: (1.0 / tone.gamma.get()) as f32,
        pad: 0,
    }
}
