//! The finished frames of an animation that is not whole yet, saved beside it as pictures: what a stop
//! or a failure leaves of it, and what a later run need not make again.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::frame::{self, Encoding, Format, Frame, is_complete};

use super::FrameNames;

/// A folder of numbered pictures, each as an animation shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct FinishedFrames(FrameNames);

impl FinishedFrames {
    /// The frames of the animation `path`: in a folder beside it, of its name and `.frames`.
    ///
    /// # Errors
    /// `path` names no file.
    pub fn of(path: &Path) -> Result<Self> {
        let mut folder = path.as_os_str().to_owned();
        folder.push(".frames");
        FrameNames::of(&PathBuf::from(folder).join("%06d.png")).map(Self)
    }

    /// The names of the pictures.
    pub fn names(&self) -> &FrameNames {
        &self.0
    }

    /// The folder in which the pictures lie.
    pub fn folder(&self) -> &Path {
        self.0.folder()
    }

    /// The encoding: an animation holds what a PNG of 8 bits does.
    fn encoding() -> Encoding {
        Encoding::new(Format::Png)
    }

    pub(super) fn make_folder(&self) -> Result<()> {
        std::fs::create_dir_all(self.folder())
            .map_err(|cause| Error::writing(self.folder(), "make the folder", &cause))
    }

    pub(super) fn holds(&self, index: u32, size: ImageSize, metadata: &[(&str, &str)]) -> bool {
        is_complete(&self.0.path(index), size, &Self::encoding(), metadata)
    }

    pub(super) fn save(&self, index: u32, frame: &Frame, metadata: &[(&str, &str)]) -> Result<()> {
        frame::write(&self.0.path(index), frame, &Self::encoding(), metadata)
    }

    pub(super) fn read(&self, index: u32) -> Result<Frame> {
        frame::read_display(&self.0.path(index))
    }

    /// Removes the pictures, and the folder where nothing else lies in it, as far as they can be.
    pub(super) fn remove(&self) {
        let entries = std::fs::read_dir(self.folder());
        for entry in entries.into_iter().flatten().flatten() {
            if self.0.frame(&entry.file_name()).is_some() {
                let _ = std::fs::remove_file(entry.path());
            }
        }
        let _ = std::fs::remove_dir(self.folder());
    }
}
