//! The tone curve, in double precision.

use crate::scene::{Tone, srgb_from_linear};

/// A premultiplied linear-light pixel as a display shows it: sRGB-encoded 0..1, opaque; the steps
/// of [`Tone`] in their order.
pub fn display(color: [f64; 4], tone: &Tone) -> [f64; 4] {
    let channel = |c: usize| {
        let linear = color[c] + tone.background.0[c] * (1.0 - color[3]);
        let encoded = srgb_from_linear(linear);
        let toned = (encoded - 0.5) * tone.contrast.get() + 0.5 + tone.brightness.get();
        toned.clamp(0.0, 1.0).powf(1.0 / tone.gamma.get())
    };
    [channel(0), channel(1), channel(2), 1.0]
}
