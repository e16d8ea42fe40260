//! A file's bytes, mapped: read where they lie, without a copy.

use std::fs::File;
use std::io;
use std::ops::Deref;
use std::path::Path;

use memmap2::Mmap;

use super::shortened::{Watch, watch};

/// A mapped file. If it is shortened while it is read, that is noticed if the program has requested
/// it with [`super::end_when_shortened`].
#[derive(Debug)]
pub struct MappedFile {
    map: Mmap,
    watch: Option<Watch>,
}

impl MappedFile {
    /// Maps all of `file`, which is called `path`.
    ///
    /// # Errors
    /// Those of the system.
    pub fn new(file: &File, path: &Path) -> io::Result<Self> {
        // SAFETY: the map is only read. That nobody rewrites a volume file while it is being rendered
        // is the price of not copying it, as for every program that maps files.
        let map = unsafe { Mmap::map(file) }?;
        let watch = watch(&map, path);
        Ok(Self { map, watch })
    }
}

impl Deref for MappedFile {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.map
    }
}

impl Drop for MappedFile {
    fn drop(&mut self) {
        // Before the addresses can be another's.
        drop(self.watch.take());
    }
}
