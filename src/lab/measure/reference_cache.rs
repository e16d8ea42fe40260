//! The reference's pictures, each computed once.
//!
//! The reference takes seconds where a device takes milliseconds. Its pictures are cached in a
//! folder, each under a hash of everything that it depends on: the voxels and their geometry, the
//! scene, the wanted planes, and the program itself. So no stale picture is ever taken for the
//! reference's.

use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

use crate::cache::{self, CacheFolder, mark_used};
use crate::error::{Error, Result};
use crate::frame::{Frame, Wanted};
use crate::progress::Progress;
use crate::reference;
use crate::scene::Scene;
use crate::volume::Volume;

use super::program::hash_program;

/// Where reference pictures of one volume come from.
pub struct ReferenceCache<'a> {
    volume: &'a Volume,
    cache: Option<Cache>,
}

/// A folder of pictures of one volume.
struct Cache {
    folder: CacheFolder,
    /// The hash of program and volume.
    hasher: blake3::Hasher,
}

/// A reference picture.
pub struct ReferenceFrame {
    /// The reference's picture.
    pub frame: Frame,
    /// Whether the reference had to be computed.
    pub computed: bool,
    /// Why the picture could not be cached for the next time.
    pub not_cached: Option<Error>,
}

impl<'a> ReferenceCache<'a> {
    /// A cache without a folder: every picture is computed.
    pub fn uncached(volume: &'a Volume) -> Self {
        Self {
            volume,
            cache: None,
        }
    }

    /// A cache of pictures in `folder`, which is created if it does not exist; those that were not used for
    /// thirty days, such as those of older programs, are removed from it.
    ///
    /// # Errors
    /// The folder cannot be made; the program cannot read its own file.
    pub fn in_folder(folder: &Path, volume: &'a Volume) -> Result<Self> {
        let folder = CacheFolder::in_folder(folder, EXTENSION)?;
        let mut hasher = blake3::Hasher::new();
        hash_program(&mut hasher)?;
        hasher.update(volume.content_hash().as_bytes());
        Ok(Self {
            volume,
            cache: Some(Cache { folder, hasher }),
        })
    }

    /// The reference's picture of `scene`.
    ///
    /// # Errors
    /// As [`reference::render`]. A cached picture that cannot be read is computed again.
    pub fn frame(
        &self,
        scene: &Scene,
        wanted: Wanted,
        progress: &dyn Progress,
    ) -> Result<ReferenceFrame> {
        let cached = self.cache.as_ref().map(|cache| cache.path(scene, wanted));
        if let Some(path) = &cached
            && let Some(frame) = read(path, scene, wanted)
        {
            return Ok(ReferenceFrame {
                frame,
                computed: false,
                not_cached: None,
            });
        }
        let frame = reference::render(self.volume, scene, wanted, progress)?;
        let not_cached = cached.and_then(|path| write(&path, &frame).err());
        Ok(ReferenceFrame {
            frame,
            computed: true,
            not_cached,
        })
    }
}

impl Cache {
    fn path(&self, scene: &Scene, wanted: Wanted) -> PathBuf {
        let mut hasher = self.hasher.clone();
        // Debug output names every field, and prints floats so that they read back as they were.
        hasher.update(format!("{scene:?} {wanted:?}").as_bytes());
        self.folder.path(&hasher)
    }
}

/// The extension of cached pictures.
const EXTENSION: &str = "frame";

/// Writes the colour and then the other planes, zlib-compressed (whose checksum shows a torn file).
fn write(path: &Path, frame: &Frame) -> Result<()> {
    let failed = |cause| Error::writing(path, "write", &cause);
    cache::write(path, |out| {
        let mut out = ZlibEncoder::new(out, Compression::fast());
        let mut frame = frame.clone();
        for plane in frame.bytes_mut() {
            out.write_all(plane).map_err(failed)?;
        }
        out.finish().map_err(failed)?;
        Ok(())
    })
}

/// The picture cached in `path`; `None` if there is no complete one.
fn read(path: &Path, scene: &Scene, wanted: Wanted) -> Option<Frame> {
    let mut file = ZlibDecoder::new(cache::open(path).ok()?);
    let mut frame = Frame::blank(scene.size, wanted).ok()?;
    for plane in frame.bytes_mut() {
        file.read_exact(plane).ok()?;
    }
    let at_end = file.read(&mut [0]).ok()? == 0;
    if at_end {
        mark_used(path);
    }
    at_end.then_some(frame)
}
