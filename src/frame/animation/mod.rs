//! Frames one after another in one file: .gif, .apng, and by ffmpeg .mp4 and .webm.

mod apng;
mod gif;
mod video;

use std::cell::Cell;
use std::fmt;
use std::path::Path;
use std::str::FromStr;

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::output::write_atomically;

use super::Frame;

/// An animation's file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnimationFormat {
    /// GIF: at most 256 colours a frame, repeated for ever.
    Gif,
    /// APNG: lossless, repeated for ever.
    Apng,
    /// MP4: H.264, by ffmpeg.
    Mp4,
    /// WebM: VP9, by ffmpeg.
    WebM,
}

impl AnimationFormat {
    /// The extensions of file names, and the format that each means.
    pub const EXTENSIONS: [(&'static str, Self); 4] = [
        ("gif", Self::Gif),
        ("apng", Self::Apng),
        ("mp4", Self::Mp4),
        ("webm", Self::WebM),
    ];

    /// The format that a file name's extension names, in upper or lower case; `None` if it is no
    /// animation's.
    pub fn from_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        let of_name = |(name, _): &&(&str, Self)| extension.eq_ignore_ascii_case(name);
        Self::EXTENSIONS
            .iter()
            .find(of_name)
            .map(|(_, format)| *format)
    }
}

/// Frames per second, to hundredths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameRate(f64);

impl FrameRate {
    /// The possible rates, frames per second.
    pub const ALLOWED: std::ops::RangeInclusive<f64> = 0.01..=240.0;

    /// Makes a rate, rounded to hundredths.
    ///
    /// # Errors
    /// Outside [`FrameRate::ALLOWED`] (usage).
    pub fn new(per_second: f64) -> Result<Self> {
        if !Self::ALLOWED.contains(&per_second) {
            return Err(Error::usage(format!(
                "{per_second} frames per second: there must be {} to {}",
                Self::ALLOWED.start(),
                Self::ALLOWED.end()
            )));
        }
        Ok(Self((per_second * 100.0).round() / 100.0))
    }

    /// The rate in frames per second.
    pub fn per_second(self) -> f64 {
        self.0
    }

    /// Frames per hundred seconds: a whole number.
    fn per_100_s(self) -> u16 {
        (self.0 * 100.0).round() as u16
    }
}

impl Default for FrameRate {
    fn default() -> Self {
        Self(30.0)
    }
}

impl FromStr for FrameRate {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let number = text.trim().parse();
        Self::new(number.map_err(|_| Error::usage(format!("'{text}' is not a number")))?)
    }
}

impl fmt::Display for FrameRate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// How an animation is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Animation {
    /// The file format.
    pub format: AnimationFormat,
    /// How fast the frames follow each other.
    pub rate: FrameRate,
}

/// The frames to come: how many, their size and their rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reel {
    /// The size of every frame.
    pub size: ImageSize,
    /// The number of frames, at least one.
    pub frames: u32,
}

impl Animation {
    /// Checks that the animation can be written, as far as is known beforehand.
    ///
    /// # Errors
    /// A frame rate that the format cannot do (usage); ffmpeg is needed, and missing or
    /// without the codec.
    pub fn check(&self) -> Result<()> {
        match self.format {
            AnimationFormat::Gif => gif::check(self.rate),
            AnimationFormat::Apng => Ok(()),
            AnimationFormat::Mp4 | AnimationFormat::WebM => video::check(self.format),
        }
    }

    /// Writes all frames as displayed, whole or not at all. `metadata` are keys and texts for an
    /// .apng, as in a PNG; the others have no place for them.
    ///
    /// # Errors
    /// As [`Animation::check`]; the first error among `frames`; too few or too many of them, or of
    /// another size; a path that cannot be written.
    pub fn write(
        &self,
        path: &Path,
        reel: Reel,
        metadata: &[(&str, &str)],
        frames: &mut dyn Iterator<Item = Result<Frame>>,
    ) -> Result<()> {
        let count = Cell::new(0);
        let mut frames = frames.map(|frame| {
            let frame = frame?;
            count.set(count.get() + 1);
            if frame.size != reel.size || count.get() > reel.frames {
                return Err(Error::failed(format!(
                    "frame {} of {} is one too many, or is {} where the animation is {}",
                    count.get(),
                    reel.frames,
                    frame.size,
                    reel.size
                )));
            }
            Ok(frame)
        });
        write_atomically(path, |out| {
            match self.format {
                AnimationFormat::Gif => gif::encode(out, path, self.rate, reel.size, &mut frames),
                AnimationFormat::Apng => {
                    apng::encode(out, path, self.rate, reel, metadata, &mut frames)
                }
                AnimationFormat::Mp4 | AnimationFormat::WebM => {
                    video::encode(out, path, self, reel.size, &mut frames)
                }
            }?;
            if count.get() < reel.frames {
                return Err(Error::failed(format!(
                    "{}: {} of {} frames were given",
                    path.display(),
                    count.get(),
                    reel.frames
                )));
            }
            Ok(())
        })
    }
}
