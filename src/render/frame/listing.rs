//! From marks to a list: the pixels that are cast next, compacted on the device.

use crate::error::Result;
use crate::gpu::Buffer;
use crate::render::abi::LISTED_SQUARE;
use crate::render::passes::{Run, count_marked, list_marked, sum_counts};

/// Lists marked pixels. Its buffers serve every round of a frame.
pub struct Listing {
    /// Per square its pixels, then where they begin in the list.
    counts: Buffer<u32>,
    total: Buffer<u32>,
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
            counts: Buffer::new(run.device, "counts of pixels", squares as usize)?,
            total: Buffer::new(run.device, "number of pixels", 1)?,
        })
    }

    /// Lists the pixels that `marks` has cast next, and marks them as cast; `None` where there are none. Starts what
    /// waits, and waits for the device.
    ///
    /// # Errors
    /// As [`Run::squares`]; the device failed or has no room.
    pub fn take(&mut self, run: &mut Run, marks: &mut Buffer<u32>) -> Result<Option<Buffer<u32>>> {
        self.count(run, marks)?;
        run.timings.start(run.device)?;
        let count = self.total.download(run.device)?[0] as usize;
        if count == 0 {
            return Ok(None);
        }
        let mut listed = Buffer::new(run.device, "list of pixels", count)?;
        list_marked(run, &self.counts, marks, &mut listed)?;
        Ok(Some(listed))
    }

    /// Announces the passes that list pixels.
    ///
    /// # Errors
    /// As [`Run::squares`].
    pub fn announce(
        &mut self,
        run: &mut Run,
        marks: &mut Buffer<u32>,
        listed: &mut Buffer<u32>,
    ) -> Result<()> {
        self.count(run, marks)?;
        list_marked(run, &self.counts, marks, listed)
    }

    fn count(&mut self, run: &mut Run, marks: &Buffer<u32>) -> Result<()> {
        count_marked(run, marks, &mut self.counts)?;
        sum_counts(run, &mut self.counts, &mut self.total)
    }
}
