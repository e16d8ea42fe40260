//! From marks to a list: the pixels that are cast or interpolated next, compacted on the device.

use std::ops::Range;
use std::sync::Arc;

use crate::error::Result;
use crate::gpu::Buffer;
use crate::render::abi::LISTED_SQUARE;
use crate::render::passes::{Run, count_marked, list_marked, sum_counts};

/// A list of pixels, counted row by row, each with where its ray may meet something first.
pub struct Listed {
    /// First those that are cast next.
    pub pixels: Arc<Buffer<[u32; 2]>>,
    next: usize,
}

impl Listed {
    /// A list of a single pixel, which nobody has written.
    ///
    /// # Errors
    /// The device has no room.
    pub fn placeholder(run: &Run) -> Result<Self> {
        let one = Buffer::new(run.device, "list of pixels", 1)?;
        Ok(Self {
            pixels: Arc::new(one),
            next: 1,
        })
    }

    /// The pixels that are cast next.
    pub fn next(&self) -> Range<usize> {
        0..self.next
    }

    /// The pixels that are interpolated in blocks that have their corners to themselves.
    pub fn in_blocks(&self) -> Range<usize> {
        self.next..self.pixels.count()
    }
}

/// Lists marked pixels. Its buffers serve every round of a frame.
pub struct Listing {
    /// Per square its pixels of either kind, then where they begin in the list.
    counts: Buffer<u32>,
    totals: Buffer<u32>,
}

impl Listing {
    /// Room for the counts of a run's picture.
    ///
    /// # Errors
    /// The rays belong to no picture; the device has no room.
    pub fn new(run: &Run) -> Result<Self> {
        let (_, size) = run.picture()?;
        let squares = size.width().div_ceil(LISTED_SQUARE) * size.height().div_ceil(LISTED_SQUARE);
        Ok(Self {
            counts: Buffer::new(run.device, "counts of pixels", 2 * squares as usize)?,
            totals: Buffer::new(run.device, "numbers of pixels", 2)?,
        })
    }

    /// Lists the pixels that `marks` has cast next, which it marks as cast, and those in blocks; `None` where there are none to
    /// be cast. Starts what waits, and waits for the device.
    ///
    /// # Errors
    /// As [`Run::squares`]; the device failed or has no room.
    pub fn take(&mut self, run: &mut Run, marks: &mut Buffer<u32>) -> Result<Option<Listed>> {
        self.count(run, marks)?;
        run.timings.start(run.device)?;
        let totals = self.totals.download(run.device)?;
        let [next, all] = [totals[0], totals[1]].map(|total| total as usize);
        if next == 0 {
            return Ok(None);
        }
        let mut pixels = Buffer::new(run.device, "list of pixels", all)?;
        list_marked(run, &self.counts, marks, &mut pixels)?;
        Ok(Some(Listed {
            pixels: Arc::new(pixels),
            next,
        }))
    }

    /// Announces the passes that list pixels.
    ///
    /// # Errors
    /// As [`Run::squares`]; the device has no room.
    pub fn announce(&mut self, run: &mut Run, marks: &mut Buffer<u32>) -> Result<()> {
        let mut one = Buffer::new(run.device, "list of pixels", 1)?;
        self.count(run, marks)?;
        list_marked(run, &self.counts, marks, &mut one)
    }

    fn count(&mut self, run: &mut Run, marks: &Buffer<u32>) -> Result<()> {
        count_marked(run, marks, &mut self.counts)?;
        sum_counts(run, &mut self.counts, &mut self.totals)
    }
}
