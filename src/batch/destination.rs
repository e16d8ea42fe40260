//! Where frames go: a picture each, or one animation.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::frame::{self, Animation, Encoding, Frame, Reel, is_whole};

use super::FrameNames;

/// A frame on its way to its file.
pub struct Shot<T> {
    /// Which one of the path it is.
    pub index: u32,
    pub frame: Frame,
    /// Its own, as the text that pictures carry.
    pub scene: String,
    /// What is to be remembered of it.
    pub about: T,
}

/// What is remembered of a frame that has been written.
pub struct Written<T> {
    /// Which one of the path it is.
    pub index: u32,
    pub about: T,
    /// Encoding and writing it; in an animation the last one's takes in closing the file.
    pub encode_ms: f64,
}

/// What frames are written to.
#[derive(Debug, Clone, PartialEq)]
pub enum Destination {
    /// Every frame to a file of its own.
    Pictures {
        names: FrameNames,
        encoding: Encoding,
    },
    /// All frames to one file.
    Animation { path: PathBuf, animation: Animation },
}

/// What a picture depends on beside its scene. Pictures carry it, so that no frame of another volume,
/// device or program is taken for one that is there already.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Provenance {
    /// The program's.
    pub version: &'static str,
    /// The volume's [content](crate::volume::Volume::content_hash), in hexadecimal: another one may
    /// come to lie under the same name.
    pub content: String,
    /// The name of what rendered.
    pub device: String,
}

impl Provenance {
    /// The keys and texts of a picture's metadata; `scene` is the picture's.
    pub fn metadata<'a>(&'a self, scene: &'a str) -> [(&'static str, &'a str); 4] {
        [
            ("scene", scene),
            ("version", self.version),
            ("content", &self.content),
            ("device", &self.device),
        ]
    }
}

impl Destination {
    /// That a frame of this size fits.
    ///
    /// # Errors
    /// As [`Encoding::check_size`].
    pub fn check_size(&self, size: ImageSize) -> Result<()> {
        match self {
            Self::Pictures { encoding, .. } => encoding.check_size(size),
            Self::Animation { .. } => Ok(()),
        }
    }

    /// Whether what is there can be told from what is missing.
    pub fn tells_what_is_there(&self) -> bool {
        match self {
            Self::Pictures { encoding, .. } => encoding.format.carries_metadata(),
            Self::Animation { .. } => false,
        }
    }

    /// Makes the folder of a sequence where there is none.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn make_folder(&self) -> Result<()> {
        match self {
            Self::Pictures { names, .. } if names.folder() != Path::new("") => {
                std::fs::create_dir_all(names.folder())
                    .map_err(|cause| Error::writing(names.folder(), "make the folder", &cause))
            }
            _ => Ok(()),
        }
    }

    /// Whether a frame is there already: whole, of this scene and this provenance.
    pub fn holds(&self, index: u32, size: ImageSize, scene: &str, from: &Provenance) -> bool {
        match self {
            Self::Pictures { names, encoding } => {
                is_whole(&names.path(index), size, encoding, &from.metadata(scene))
            }
            Self::Animation { .. } => false,
        }
    }

    /// Writes frames as they come, every picture whole or not at all, an animation likewise.
    /// `reel` is what comes; a picture carries its own scene and `from`, an animation `scene` and
    /// `from`.
    ///
    /// # Errors
    /// The first error among `shots`, the pictures before it being written; what cannot be written.
    pub fn write<T>(
        &self,
        reel: Reel,
        from: &Provenance,
        scene: &str,
        shots: &mut dyn Iterator<Item = Result<Shot<T>>>,
    ) -> Result<Vec<Written<T>>> {
        let mut written = Vec::new();
        match self {
            Self::Pictures { names, encoding } => {
                for shot in shots {
                    let Shot {
                        index,
                        frame,
                        scene,
                        about,
                    } = shot?;
                    let began = Instant::now();
                    let metadata = from.metadata(&scene);
                    frame::write(&names.path(index), &frame, encoding, &metadata)?;
                    written.push(Written {
                        index,
                        about,
                        encode_ms: ms_since(began),
                    });
                }
            }
            Self::Animation { path, animation } => {
                let metadata = from.metadata(scene);
                let mut handed: Option<Instant> = None;
                let mut frames = std::iter::from_fn(|| {
                    settle(&mut written, handed.take());
                    let shot = shots.next();
                    handed = Some(Instant::now());
                    Some(shot?.map(|shot| {
                        written.push(Written {
                            index: shot.index,
                            about: shot.about,
                            encode_ms: 0.0,
                        });
                        shot.frame
                    }))
                });
                animation.write(path, reel, &metadata, &mut frames)?;
                settle(&mut written, handed);
            }
        }
        Ok(written)
    }
}

/// Adds to the last frame's encoding the time since it was handed over.
fn settle<T>(written: &mut [Written<T>], handed: Option<Instant>) {
    if let (Some(handed), Some(last)) = (handed, written.last_mut()) {
        last.encode_ms += ms_since(handed);
    }
}

fn ms_since(began: Instant) -> f64 {
    began.elapsed().as_secs_f64() * 1e3
}
