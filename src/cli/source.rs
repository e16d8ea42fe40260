//! The volume that the options name: read, smoothed, and as the scene sees it.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::error::{Error, Result};
use crate::gpu::DeviceInfo;
use crate::octree::Leaf;
use crate::options::{FilePath, NonFiniteRule, SceneOptions, SpacingMm, VolumeOptions};
use crate::progress::Progress;
use crate::render::{check_volume, content};
use crate::subject::Subject;
use crate::volume::{
    self, Histogram, NonFinite, RawLayout, RawSize, RawType, ReadOptions, Volume, percentiles,
};

use super::terminal::note;

/// A volume and what was learnt while it was read.
pub struct Loaded {
    pub volume: Volume,
    pub histogram: Histogram,
    pub subject: Subject,
    /// The number of NaN and ±Inf values in the file, before smoothing.
    pub non_finite: u64,
    pub read_ms: f64,
    pub smooth_ms: f64,
}

/// The volume's file and everything that must be known before it is read.
pub struct Source {
    pub path: PathBuf,
    pub leaf: Leaf,
    read: ReadOptions,
    sigma_mm: f64,
}

impl Source {
    /// The volume's file as the options describe it, checked as far as is possible without reading it.
    ///
    /// # Errors
    /// No volume named; a layout that makes no sense.
    pub fn of(options: &VolumeOptions) -> Result<Self> {
        let Some(file) = &options.volume else {
            return Err(Error::usage("no volume was named")
                .hint("give its file as the first argument, or as 'volume' in the scene file"));
        };
        let size = options.raw_size.as_ref();
        let size = size.map(|text| text.0.parse::<RawSize>());
        let element = options.raw_type.as_ref();
        let element = element.map(|text| text.parse::<RawType>());
        let raw = RawLayout {
            size: size.transpose().map_err(|e| e.at("raw-size"))?,
            element: element.transpose().map_err(|e| e.at("raw-type"))?,
            spacing_mm: options.raw_spacing.map(|SpacingMm(each)| each.into()),
            offset_bytes: options.raw_offset,
        };
        let non_finite = match options.non_finite.unwrap_or_default() {
            NonFiniteRule::Replace => NonFinite::Replace,
            NonFiniteRule::Refuse => NonFinite::Refuse,
        };
        Ok(Self {
            path: file.0.clone(),
            leaf: options.octree_leaf.unwrap_or_default(),
            read: ReadOptions {
                frame: options.frame.unwrap_or(0),
                non_finite,
                raw,
            },
            sigma_mm: options.smooth.unwrap_or_default().get(),
        })
    }

    /// The file's name alone, for what is passed on.
    pub fn name(&self) -> &Path {
        Path::new(self.path.file_name().unwrap_or_default())
    }

    /// Options of a scene as pictures store them, so that they render the same volume alike:
    /// its path is as it was given, and the octree's leaf is there.
    #[must_use]
    pub fn stored(&self, mut options: SceneOptions) -> SceneOptions {
        options.volume.volume = Some(FilePath(self.path.clone()));
        options.volume.octree_leaf = Some(self.leaf);
        options
    }

    /// The volume, smoothed where that is wanted. One that the device is too small for is refused before
    /// its voxels are read.
    ///
    /// # Errors
    /// As [`volume::read`]; the device is too small; there is no memory to smooth.
    pub fn load(&self, device: Option<&DeviceInfo>, progress: &dyn Progress) -> Result<Loaded> {
        let accept = |dims, voxel| match device {
            Some(device) => check_volume(device, dims, voxel),
            None => Ok(()),
        };
        let began = Instant::now();
        let mut volume = volume::read_if(&self.path, &self.read, progress, &accept)?;
        let read_ms = ms_since(began);
        let non_finite = volume.non_finite();
        volume.notes().iter().for_each(note);
        let began = Instant::now();
        let mut smooth_ms = 0.0;
        if self.sigma_mm > 0.0 {
            volume = volume::smooth(&volume, self.sigma_mm, progress)?;
            smooth_ms = ms_since(began);
        }
        let histogram = Subject::histogram(&volume);
        let subject = Subject::with_histogram(&volume, &histogram);
        Ok(Loaded {
            volume,
            histogram,
            subject,
            non_finite,
            read_ms,
            smooth_ms,
        })
    }
}

impl Loaded {
    /// The hash of the volume's content, in hexadecimal.
    pub fn content(&self) -> String {
        self.volume.content_hash().to_hex().to_string()
    }

    /// Measures what pictures show of the volume, where their cameras or depth cues depend on it: one content for all that
    /// are made of these options.
    pub fn frame(&mut self, pictures: &[SceneOptions]) -> Result<()> {
        let framed = pictures
            .iter()
            .filter(|options| options.depends_on_content());
        let shown = framed.map(|options| options.shown(&self.subject));
        let shown = shown.collect::<Result<Vec<_>>>()?;
        if !shown.is_empty() {
            self.subject.content = content(&self.volume, &shown)?;
        }
        Ok(())
    }

    /// The options, each order statistic of the voxels replaced by its value, which is printed.
    pub fn measured(&self, options: SceneOptions) -> SceneOptions {
        let values = |percents: &[f64]| percentiles(&self.volume, percents);
        let (options, notes) = options.measured(self.subject.range, values);
        notes.iter().for_each(note);
        options
    }
}

pub fn ms_since(began: Instant) -> f64 {
    began.elapsed().as_secs_f64() * 1e3
}
