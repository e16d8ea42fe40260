//! GIF: a palette of its own for every frame.

use std::io::Write;
use std::path::Path;

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, RgbImage};

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::frame::encoder_error::encoder_error;
use crate::frame::{Frame, quantize};

use super::FrameRate;

/// How carefully colours are chosen where there are more than 256: 1 is slowest and best; from
/// about 10 on differences are seen.
const SPEED: i32 = 10;

/// Players show anything quicker than 2/100 s as slowly as 10/100 s.
const MAX_PER_SECOND: f64 = 50.0;

pub(super) fn check(rate: FrameRate) -> Result<()> {
    if rate.per_second() > MAX_PER_SECOND {
        return Err(Error::usage(format!(
            "a .gif of {} frames per second: players take at most {MAX_PER_SECOND}",
            rate
        ))
        .hint("choose a smaller --fps, or write an .apng or .mp4"));
    }
    Ok(())
}

pub(super) fn encode(
    out: &mut impl Write,
    path: &Path,
    rate: FrameRate,
    size: ImageSize,
    frames: &mut dyn Iterator<Item = Result<Frame>>,
) -> Result<()> {
    check(rate)?;
    let (width, height) = (size.width(), size.height());
    let failed = |error| encoder_error(path, error);
    let mut encoder = GifEncoder::new_with_speed(out, SPEED);
    encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
    for (index, frame) in frames.enumerate() {
        let rgb = RgbImage::from_raw(width, height, quantize::rgb8(&frame?)?);
        let rgb = rgb.ok_or_else(|| Error::failed("a frame of another size"))?;
        let rgba = image::DynamicImage::from(rgb).into_rgba8();
        let delay = Delay::from_numer_denom_ms(10 * delay_10ms(rate, index as u64), 1);
        encoder
            .encode_frame(image::Frame::from_parts(rgba, 0, 0, delay))
            .map_err(failed)?;
    }
    Ok(())
}

/// A GIF counts in 1/100 s: how many frame `index` stays, so that the whole keeps its rate.
fn delay_10ms(rate: FrameRate, index: u64) -> u32 {
    let until = |index: u64| 10_000.0 * index as f64 / f64::from(rate.per_100_s());
    (until(index + 1).round() - until(index).round()) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delays_of_whole_hundredths_keep_the_rate() {
        let at = |rate| FrameRate::new(rate).unwrap();
        for (rate, second) in [(30.0, 30), (25.0, 25), (12.5, 25), (50.0, 50)] {
            let at_rate = at(rate);
            let delays: Vec<u32> = (0..second).map(|k| delay_10ms(at_rate, k)).collect();
            let seconds = second as f64 / rate;
            assert_eq!(f64::from(delays.iter().sum::<u32>()), 100.0 * seconds);
            assert!(delays.iter().all(|&delay| delay >= 2), "{delays:?}");
        }
        assert!(check(at(50.0)).is_ok());
        assert!(check(at(60.0)).is_err());
    }
}
