//! Display values to integers.

use crate::error::{Error, Result};
use crate::memory;

use super::contents::Frame;

/// The display plane's R, G, B as bytes: 0..1 to 0..255, rounded to nearest; what lies outside is
/// clamped, NaN is 0.
///
/// # Errors
/// A frame without display plane; not enough memory.
pub(super) fn rgb8(frame: &Frame) -> Result<Vec<u8>> {
    let display = display_of(frame)?;
    let mut bytes = memory::room(3 * display.len(), "the picture's bytes")?;
    let channels = display.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]);
    bytes.extend(channels.map(|v| nearest_level(v, u8::MAX.into()) as u8));
    Ok(bytes)
}

/// Quantizes like [`rgb8`] to 0..65535, two bytes a channel, the high byte first.
pub(super) fn rgb16_big_endian(frame: &Frame) -> Result<Vec<u8>> {
    let display = display_of(frame)?;
    let mut bytes = memory::room(6 * display.len(), "the picture's bytes")?;
    let channels = display.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]);
    bytes.extend(channels.flat_map(|v| nearest_level(v, u16::MAX).to_be_bytes()));
    Ok(bytes)
}

fn display_of(frame: &Frame) -> Result<&[[f32; 4]]> {
    frame.display.as_deref().ok_or_else(|| {
        Error::failed("the picture is wanted as displayed, but the frame has no display plane")
    })
}

/// `v` in 0..1 to the nearest of the levels 0..=top.
fn nearest_level(v: f32, top: u16) -> u16 {
    // A conversion to an integer saturates, and makes 0 of NaN.
    (f64::from(v).clamp(0.0, 1.0) * f64::from(top) + 0.5) as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extent::ImageSize;
    use crate::frame::Layers;

    #[test]
    fn every_level_comes_back_and_halves_go_to_the_nearest() {
        for top in [u16::from(u8::MAX), u16::MAX] {
            let step = 1.0 / f64::from(top);
            for level in 0..=top {
                let at = |offset: f64| ((f64::from(level) + offset) * step) as f32;
                assert_eq!(nearest_level(at(0.0), top), level);
                assert_eq!(nearest_level(at(0.4), top), level);
                if level > 0 {
                    assert_eq!(nearest_level(at(-0.4), top), level);
                    // Truncation would not have passed.
                    assert_ne!((at(-0.4) * f32::from(top)) as u16, level);
                }
            }
        }
    }

    #[test]
    fn what_is_outside_is_clamped() {
        let cases = [
            (-1.0, 0),
            (-0.0, 0),
            (1.5, 255),
            (f32::INFINITY, 255),
            (f32::NEG_INFINITY, 0),
            (f32::NAN, 0),
        ];
        for (v, level) in cases {
            assert_eq!(nearest_level(v, 255), level, "{v}");
        }
    }

    #[test]
    fn channels_interleave_high_byte_first() {
        let mut frame = Frame {
            size: ImageSize::new(1, 1).unwrap(),
            color: vec![[0.0; 4]],
            display: Some(vec![[1.0, 0.5, (258.0 / 65535.0) as f32, 1.0]]),
            layers: Layers::default(),
        };
        assert_eq!(rgb8(&frame).unwrap(), [255, 128, 1]);
        assert_eq!(
            rgb16_big_endian(&frame).unwrap(),
            [255, 255, 0x80, 0x00, 0x01, 0x02]
        );
        frame.display = None;
        assert!(rgb8(&frame).is_err());
    }
}
