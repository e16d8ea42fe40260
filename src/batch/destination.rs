//! Where frames go: a picture each, or one animation.

use std::iter::Peekable;
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::frame::{self, Animation, Encoding, Frame, Reel, is_complete};

use super::{FinishedFrames, FrameNames};

/// A frame that is to be written to its file.
pub struct Shot<T> {
    /// The frame's index along the path.
    pub index: u32,
    /// The picture, with the planes that its file holds.
    pub frame: Frame,
    /// The frame's scene, as the text that pictures carry.
    pub scene: String,
    /// The record of it that the caller wants back.
    pub about: T,
}

/// The record of a frame that has been written.
pub struct Written<T> {
    /// The frame's index along the path.
    pub index: u32,
    /// The caller's record of it, as it came in [`Shot::about`].
    pub about: T,
    /// The time of encoding and writing the frame, ms; in an animation the last frame's includes closing
    /// the file.
    pub encode_ms: f64,
}

/// Where frames are written to.
#[derive(Debug, Clone, PartialEq)]
pub enum Destination {
    /// Every frame to a file of its own.
    Pictures {
        /// The frames' file names.
        names: FrameNames,
        /// The format of the pictures, and what is written of each frame.
        encoding: Encoding,
    },
    /// All frames to one file.
    Animation {
        /// The animation's file.
        path: PathBuf,
        /// The animation's format and frame rate.
        animation: Animation,
        /// Where the finished frames are until the file is whole; `None` where the file is a device or a pipe.
        finished: Option<FinishedFrames>,
    },
}

/// Everything but its scene that a picture depends on. Pictures carry it, so that no frame of another
/// volume, device or program is taken for a finished one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Provenance {
    /// The version of the program.
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
    /// Checks that a frame of this size fits.
    ///
    /// # Errors
    /// As [`Encoding::check_size`].
    pub fn check_size(&self, size: ImageSize) -> Result<()> {
        match self {
            Self::Pictures { encoding, .. } => encoding.check_size(size),
            Self::Animation { .. } => Ok(()),
        }
    }

    /// Whether finished frames can be recognised, so that a later run makes only the missing ones.
    pub fn recognises_finished(&self) -> bool {
        match self {
            Self::Pictures { encoding, .. } => encoding.format.carries_metadata(),
            Self::Animation { finished, .. } => finished.is_some(),
        }
    }

    /// Makes the folder of a sequence, or of an animation's finished frames, if it does not exist.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn make_folder(&self) -> Result<()> {
        match self {
            Self::Pictures { names, .. } if names.folder() != Path::new("") => {
                std::fs::create_dir_all(names.folder())
                    .map_err(|cause| Error::writing(names.folder(), "make the folder", &cause))
            }
            Self::Animation {
                finished: Some(finished),
                ..
            } => finished.make_folder(),
            _ => Ok(()),
        }
    }

    /// Whether a frame is finished already: complete, of this scene and this provenance.
    pub fn holds(&self, index: u32, size: ImageSize, scene: &str, from: &Provenance) -> bool {
        match self {
            Self::Pictures { names, encoding } => {
                is_complete(&names.path(index), size, encoding, &from.metadata(scene))
            }
            Self::Animation { finished, .. } => (finished.as_ref())
                .is_some_and(|finished| finished.holds(index, size, &from.metadata(scene))),
        }
    }

    /// Writes frames as they come, every picture whole or not at all, an animation likewise: of the
    /// `reel`'s frames, those that do not come are read where they were saved. A picture carries its
    /// own scene and `from`, an animation `scene` and `from`.
    ///
    /// # Errors
    /// The first error among `shots`, the pictures before it being written, or saved beside an animation;
    /// what cannot be written.
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
            Self::Animation {
                path,
                animation,
                finished,
            } => {
                let mut joined = Joined {
                    finished: finished.as_ref(),
                    from,
                    shots: shots.peekable(),
                    written: &mut written,
                    handed: None,
                };
                let mut frames = (0..reel.frames).map_while(|index| joined.frame(index));
                animation.write(path, reel, &from.metadata(scene), &mut frames)?;
                joined.settle();
                if let Some(finished) = finished {
                    finished.remove();
                }
            }
        }
        Ok(written)
    }
}

/// All frames of an animation in order: those that are made, which are saved meanwhile, and between them
/// those that were finished before.
struct Joined<'a, T, I: Iterator<Item = Result<Shot<T>>>> {
    finished: Option<&'a FinishedFrames>,
    from: &'a Provenance,
    shots: Peekable<I>,
    written: &'a mut Vec<Written<T>>,
    /// When the last of those that came was handed to the encoder.
    handed: Option<Instant>,
}

impl<T, I: Iterator<Item = Result<Shot<T>>>> Joined<'_, T, I> {
    /// The frame; `None`: it neither comes nor was finished before.
    fn frame(&mut self, index: u32) -> Option<Result<Frame>> {
        self.settle();
        let comes = |shot: &Result<Shot<T>>| !matches!(shot, Ok(shot) if shot.index != index);
        match self.shots.next_if(comes) {
            Some(shot) => Some(shot.and_then(|shot| self.take(shot))),
            None => Some(self.finished?.read(index)),
        }
    }

    fn take(&mut self, shot: Shot<T>) -> Result<Frame> {
        self.handed = Some(Instant::now());
        if let Some(finished) = self.finished {
            finished.save(shot.index, &shot.frame, &self.from.metadata(&shot.scene))?;
        }
        self.written.push(Written {
            index: shot.index,
            about: shot.about,
            encode_ms: 0.0,
        });
        Ok(shot.frame)
    }

    /// Adds to the encoding of the last one that came the time since it was handed over.
    fn settle(&mut self) {
        if let (Some(handed), Some(last)) = (self.handed.take(), self.written.last_mut()) {
            last.encode_ms += ms_since(handed);
        }
    }
}

fn ms_since(began: Instant) -> f64 {
    began.elapsed().as_secs_f64() * 1e3
}
