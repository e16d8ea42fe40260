//! An error map as a picture, and as numbers.

use std::io::Write;
use std::path::Path;

use crate::error::{Error, Result};
use crate::frame::channel::Channel;
use crate::frame::palette::{self, Rgb};
use crate::frame::{exr, png};
use crate::output::write_atomically;

use super::{Entry, ErrorMap};

/// The states of an EXR's `state.V`.
const NOTHING: f32 = 0.0;
const COMPARED: f32 = 1.0;
const MISSED: f32 = 2.0;
const EXTRA: f32 = 3.0;

/// The three colours of pixels without difference are far from all of the palette's, and distinguished
/// by their lightness alone.
impl ErrorMap {
    /// The colour of hits that only the reference has: black.
    pub const MISSED_COLOR: Rgb = [0, 0, 0];
    /// The colour of hits that only the picture has: yellow.
    pub const EXTRA_COLOR: Rgb = [255, 213, 0];
    /// The colour of pixels where neither picture has anything: grey.
    pub const NOTHING_COLOR: Rgb = [119, 119, 119];

    /// An opaque picture of 8 bits a channel: differences from blue (−[`Self::scale`]) over light
    /// grey (0) to red (+[`Self::scale`]), those without sign from light grey to red.
    ///
    /// # Errors
    /// Entries that are not as many as the pixels.
    pub fn png(&self) -> Result<Vec<u8>> {
        self.check()?;
        let colors: Vec<u8> = self.entries.iter().flat_map(|e| self.color(*e)).collect();
        png::rgb8(self.size, &colors)
    }

    /// Writes [`Self::png`], whole or not at all.
    ///
    /// # Errors
    /// Those of [`Self::png`]; a path that cannot be written.
    pub fn write_png(&self, path: &Path) -> Result<()> {
        let bytes = self.png()?;
        write_atomically(path, |out| {
            out.write_all(&bytes)
                .map_err(|cause| Error::writing(path, "write", &cause))
        })
    }

    /// Writes an OpenEXR file, whole or not at all: `error.V`, the differences, 0 where there is
    /// none; `state.V`, 0 where neither picture has anything, 1 where they are compared, 2 missed,
    /// 3 extra. Its attributes `quantity` and `unit` say what the differences are.
    ///
    /// # Errors
    /// Entries that are not as many as the pixels; a path that cannot be written.
    pub fn write_exr(&self, path: &Path) -> Result<()> {
        self.check()?;
        let differences: Vec<f32> = self
            .entries
            .iter()
            .map(|entry| narrow(entry.difference().unwrap_or(0.0)))
            .collect();
        let states: Vec<f32> = self.entries.iter().map(|entry| state(*entry)).collect();
        write_atomically(path, |out| {
            exr::encode(
                out,
                path,
                self.size,
                vec![
                    Channel::scalar("error.V", &differences),
                    Channel::scalar("state.V", &states),
                ],
                &[
                    ("quantity", self.quantity.name()),
                    ("unit", self.quantity.unit()),
                ],
            )
        })
    }

    /// The palette for a colour bar: where along it, 0 to 1, and the colour. 0 stands for
    /// −[`Self::scale`], or for 0 where differences have no sign, 1 for +[`Self::scale`]. What
    /// browsers interpolate between stops is within 2.5 of 255 levels.
    pub fn palette_stops(&self) -> Vec<(f64, Rgb)> {
        const STEPS: usize = 64;
        (0..=STEPS)
            .map(|k| {
                let position = k as f64 / STEPS as f64;
                let share = if self.quantity.is_signed() {
                    2.0 * position - 1.0
                } else {
                    position
                };
                (position, palette::cool_warm(share))
            })
            .collect()
    }

    fn color(&self, entry: Entry) -> Rgb {
        match entry {
            Entry::Nothing => Self::NOTHING_COLOR,
            Entry::Missed => Self::MISSED_COLOR,
            Entry::Extra => Self::EXTRA_COLOR,
            Entry::Difference(difference) => palette::cool_warm(difference / self.scale),
        }
    }

    fn check(&self) -> Result<()> {
        if self.entries.len() == self.size.pixels() {
            return Ok(());
        }
        Err(Error::failed(format!(
            "the error map has {} entries for a picture of {}",
            self.entries.len(),
            self.size
        )))
    }
}

fn state(entry: Entry) -> f32 {
    match entry {
        Entry::Nothing => NOTHING,
        Entry::Difference(_) => COMPARED,
        Entry::Missed => MISSED,
        Entry::Extra => EXTRA,
    }
}

/// Rounds to single precision, finite as before.
fn narrow(v: f64) -> f32 {
    v.clamp(f32::MIN.into(), f32::MAX.into()) as f32
}
