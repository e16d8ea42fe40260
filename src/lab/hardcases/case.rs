//! What a hard case is: its volumes, its scenes, the right answer.

use std::path::Path;

use crate::error::{Error, Result};
use crate::volume::{Volume, write_nrrd, write_nrrd_of};

/// A hard case: one volume, or several of one kind.
#[derive(Debug)]
pub struct HardCase {
    /// The case's name, as users write it.
    pub name: &'static str,
    /// The kind of difficulty that it belongs to: rays to 6, isosurface to 15, emission and absorption to 21, volumes to 26,
    /// pixels and what is blurred and estimated from them 27 and 28, a lens out of focus 33.
    pub number: u32,
    /// One sentence: what is hard.
    pub about: &'static str,
    /// One sentence: the right answer.
    pub answer: &'static str,
    /// The names of the case's volumes, where it has several; else empty.
    pub members: &'static [&'static str],
    pub(super) make: fn(usize) -> Result<HardVolume>,
    pub(super) scenes: fn(&Volume) -> Vec<HardScene>,
}

/// A hard case's volume.
#[derive(Debug)]
pub struct HardVolume {
    /// The volume, as scenes see it.
    pub volume: Volume,
    /// NRRD's name of the voxel type and little-endian voxels, where a [`Volume`] cannot hold them
    /// as they stand in the file: `volume` is then what reading that file gives.
    pub(super) stored: Option<(&'static str, Vec<u8>)>,
}

/// One view of a hard case.
#[derive(Debug, Clone, PartialEq)]
pub struct HardScene {
    /// Distinguishes the scenes of one case; may be part of a file's name.
    pub name: String,
    /// The text of a scene file: camera and picture, without the volume.
    pub toml: String,
}

impl From<Volume> for HardVolume {
    fn from(volume: Volume) -> Self {
        Self {
            volume,
            stored: None,
        }
    }
}

impl HardVolume {
    /// Writes the volume to an attached NRRD file, as [`write_nrrd`] does.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path, gzip: bool) -> Result<()> {
        match &self.stored {
            Some((type_name, voxels)) => {
                write_nrrd_of(&self.volume, type_name, "little", voxels, path, gzip)
            }
            None => write_nrrd(&self.volume, path, gzip),
        }
    }
}

impl HardCase {
    /// The number of the case's volumes.
    pub fn count(&self) -> usize {
        self.members.len().max(1)
    }

    /// The case's volume number `member`, from 0 to [`HardCase::count`].
    ///
    /// # Errors
    /// Usage: there is no such member. Failed: there is not enough memory.
    pub fn volume(&self, member: usize) -> Result<HardVolume> {
        if member >= self.count() {
            return Err(Error::usage(format!(
                "the hard case {} has {} volumes, so there is no number {member}",
                self.name,
                self.count()
            )));
        }
        (self.make)(member)
    }

    /// The scenes of one of the case's volumes, at least one.
    pub fn scenes(&self, volume: &Volume) -> Vec<HardScene> {
        (self.scenes)(volume)
    }
}
