//! The reference's pictures, each computed once.
//!
//! The reference takes seconds where a device takes milliseconds. Its pictures are kept in a
//! folder, each under a hash of everything that it depends on: the voxels and their geometry, the
//! scene, the planes asked for, and the program itself. So nothing stale is ever taken for the
//! truth.

use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

use crate::error::{Error, Result};
use crate::frame::{Frame, Wanted};
use crate::kept::{self, Kept, asked_for};
use crate::progress::Progress;
use crate::reference;
use crate::scene::Scene;
use crate::volume::Volume;

use super::program::hash_program;

/// Where reference pictures of one volume come from.
pub struct Truth<'a> {
    volume: &'a Volume,
    cache: Option<Cache>,
}

/// A folder of pictures of one volume.
struct Cache {
    kept: Kept,
    /// Of program and volume.
    hasher: blake3::Hasher,
}

/// A reference picture.
pub struct TrueFrame {
    pub frame: Frame,
    /// Whether it had to be computed.
    pub computed: bool,
    /// Why it could not be kept for the next time.
    pub not_kept: Option<Error>,
}

impl<'a> Truth<'a> {
    /// Pictures are computed whenever they are asked for.
    pub fn uncached(volume: &'a Volume) -> Self {
        Self {
            volume,
            cache: None,
        }
    }

    /// Pictures are kept in `folder`, which is made where there is none; those that nobody asked for in
    /// thirty days, such as those of programs that are no more, are removed from it.
    ///
    /// # Errors
    /// The folder cannot be made; the program cannot read its own file.
    pub fn kept_in(folder: &Path, volume: &'a Volume) -> Result<Self> {
        let kept = Kept::in_folder(folder, EXTENSION)?;
        let mut hasher = blake3::Hasher::new();
        hash_program(&mut hasher)?;
        hasher.update(volume.content_hash().as_bytes());
        Ok(Self {
            volume,
            cache: Some(Cache { kept, hasher }),
        })
    }

    /// The reference's picture of `scene`.
    ///
    /// # Errors
    /// As [`reference::render`]. A kept picture that cannot be read is computed again.
    pub fn frame(
        &self,
        scene: &Scene,
        wanted: Wanted,
        progress: &dyn Progress,
    ) -> Result<TrueFrame> {
        let kept = self.cache.as_ref().map(|cache| cache.path(scene, wanted));
        if let Some(path) = &kept
            && let Some(frame) = read(path, scene, wanted)
        {
            return Ok(TrueFrame {
                frame,
                computed: false,
                not_kept: None,
            });
        }
        let frame = reference::render(self.volume, scene, wanted, progress)?;
        let not_kept = kept.and_then(|path| write(&path, &frame).err());
        Ok(TrueFrame {
            frame,
            computed: true,
            not_kept,
        })
    }
}

impl Cache {
    fn path(&self, scene: &Scene, wanted: Wanted) -> PathBuf {
        let mut hasher = self.hasher.clone();
        // Debug output names every field, and prints floats so that they read back as they were.
        hasher.update(format!("{scene:?} {wanted:?}").as_bytes());
        self.kept.path(&hasher)
    }
}

/// Of kept pictures.
const EXTENSION: &str = "frame";

/// The colour and then the other planes, zlib-compressed (whose checksum shows a torn file).
fn write(path: &Path, frame: &Frame) -> Result<()> {
    let failed = |cause| Error::writing(path, "write", &cause);
    kept::write(path, |out| {
        let mut out = ZlibEncoder::new(out, Compression::fast());
        let mut frame = frame.clone();
        for plane in frame.bytes_mut() {
            out.write_all(plane).map_err(failed)?;
        }
        out.finish().map_err(failed)?;
        Ok(())
    })
}

/// The picture kept in `path`; nothing where there is none, or none that is whole.
fn read(path: &Path, scene: &Scene, wanted: Wanted) -> Option<Frame> {
    let mut file = ZlibDecoder::new(kept::open(path).ok()?);
    let mut frame = Frame::blank(scene.size, wanted).ok()?;
    for plane in frame.bytes_mut() {
        file.read_exact(plane).ok()?;
    }
    let at_end = file.read(&mut [0]).ok()? == 0;
    if at_end {
        asked_for(path);
    }
    at_end.then_some(frame)
}
