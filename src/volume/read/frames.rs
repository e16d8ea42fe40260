//! Which of the stored elements are wanted: one frame of a file that holds several.

use std::io::{self, BufRead, Read};

use crate::error::{Error, Result};
use crate::extent::Dims;

/// The stored order of the frames: runs of `run` elements, taken in turn from each of `count`
/// frames. Whole volumes one after the other are one long run each; components beside each other
/// are runs of one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Frames {
    pub(super) run: u64,
    pub(super) count: u64,
    pub(super) chosen: u64,
}

impl Frames {
    /// Chooses a frame of an array with these sizes (the first axis fastest): `frame_axis` counts the
    /// frames; the others, at most three, are the volume's. The note says which of several frames is
    /// read.
    ///
    /// # Errors
    /// More than three axes besides, sizes out of bounds, a frame which the file does not have.
    pub(super) fn choose(
        sizes: &[u64],
        frame_axis: Option<usize>,
        frame: u32,
    ) -> Result<(Dims, Self, Option<String>)> {
        let mut dims = [1; 3];
        let mut space = sizes
            .iter()
            .enumerate()
            .filter(|&(axis, _)| Some(axis) != frame_axis)
            .map(|(_, &size)| size);
        for (dim, size) in dims.iter_mut().zip(&mut space) {
            *dim = size;
        }
        if space.next().is_some() {
            return Err(Error::input(format!(
                "an array of {} axes is not a volume, nor a series of volumes",
                sizes.len()
            )));
        }
        let dims = Dims::new(dims)?;
        let count = frame_axis.map_or(1, |axis| sizes[axis]);
        if count == 0 {
            return Err(Error::input("the file announces no frame at all"));
        }
        let chosen = u64::from(frame);
        if chosen >= count {
            return Err(if count == 1 {
                Error::usage(format!(
                    "frame {chosen} was requested, but the file has one volume"
                ))
                .hint("leave --frame away")
            } else {
                Error::usage(format!(
                    "frame {chosen} was requested, but the file has frames 0 to {}",
                    count - 1
                ))
            });
        }
        let note =
            (count > 1).then(|| format!("frame {chosen} of {count} is read (0 is the first)"));
        // The factors are part of a volume within its bounds, so that no product overflows.
        let run = sizes[..frame_axis.unwrap_or(sizes.len())].iter().product();
        let frames = Self { run, count, chosen };
        Ok((dims, frames, note))
    }

    /// The bytes of all frames.
    ///
    /// # Errors
    /// More than any file has.
    pub(super) fn total_bytes(self, dims: Dims, element_bytes: u64) -> Result<u64> {
        let total = u128::from(dims.voxels()) * u128::from(self.count) * u128::from(element_bytes);
        u64::try_from(total)
            .ok()
            .filter(|&total| total < 1 << 60)
            .ok_or_else(|| {
                Error::input(format!(
                    "{} frames of {dims} voxels announced: more than any file holds",
                    self.count
                ))
            })
    }

    /// Whether the chosen frame lies in one piece.
    pub(super) fn is_contiguous(self, dims: Dims) -> bool {
        self.run == dims.voxels()
    }

    /// Passes only the chosen frame's bytes on. Call [`Frames::total_bytes`] first: it vouches for
    /// the products here.
    pub(super) fn pick<R: BufRead>(self, reader: R, element_bytes: u64) -> Picked<R> {
        let run = self.run * element_bytes;
        Picked {
            reader,
            run,
            gap: run * (self.count - 1),
            skip: run * self.chosen,
            left: run,
        }
    }
}

/// See [`Frames::pick`].
pub(super) struct Picked<R> {
    reader: R,
    run: u64,
    gap: u64,
    /// Bytes to drop before the next wanted one.
    skip: u64,
    /// Wanted bytes left of the current run.
    left: u64,
}

impl<R: BufRead> Read for Picked<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut filled = 0;
        while filled < buffer.len() {
            let available = self.reader.fill_buf()?;
            if available.is_empty() {
                break;
            }
            if self.skip > 0 {
                let dropped = self.skip.min(available.len() as u64);
                self.reader.consume(dropped as usize);
                self.skip -= dropped;
                continue;
            }
            let count = (self.left.min(available.len() as u64) as usize).min(buffer.len() - filled);
            buffer[filled..filled + count].copy_from_slice(&available[..count]);
            self.reader.consume(count);
            filled += count;
            self.left -= count as u64;
            if self.left == 0 {
                self.left = self.run;
                self.skip = self.gap;
            }
        }
        Ok(filled)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picked(sizes: &[u64], axis: usize, frame: u32) -> Vec<u8> {
        let bytes: Vec<u8> = (0..sizes.iter().product::<u64>() as u8).collect();
        let (dims, frames, _) = Frames::choose(sizes, Some(axis), frame).unwrap();
        let mut out = Vec::new();
        frames
            .pick(&bytes[..], 1)
            .take(dims.voxels())
            .read_to_end(&mut out)
            .unwrap();
        out
    }

    #[test]
    fn a_frame_is_picked_along_any_axis() {
        assert_eq!(picked(&[2, 3, 1, 2], 3, 1), [6, 7, 8, 9, 10, 11]);
        assert_eq!(picked(&[2, 3, 1, 2], 0, 1), [1, 3, 5, 7, 9, 11]);
        assert_eq!(picked(&[2, 3, 1, 2], 1, 2), [4, 5, 10, 11]);
    }

    #[test]
    fn a_missing_frame_and_absurd_sizes_are_refused() {
        assert!(Frames::choose(&[2, 2, 2], None, 1).is_err());
        assert!(Frames::choose(&[2, 2, 2, 3], Some(3), 3).is_err());
        assert!(Frames::choose(&[2, 2, 2, 0], Some(3), 0).is_err());
        assert!(Frames::choose(&[2, 2, 2, 2, 2], Some(4), 0).is_err());
        let (dims, frames, _) = Frames::choose(&[9, 9, 9, u64::MAX], Some(3), 0).unwrap();
        assert!(frames.total_bytes(dims, 8).is_err());
    }
}
