//! The statistics of a job (`--stats`): what was rendered, on what, how long it took.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use crate::error::{Error, Result};
use crate::gpu::DeviceInfo;
use crate::lab::measure::{BoundReached, Counts, SamplingCheck, host_peak_bytes};
use crate::lab::tolerance::ToleranceStats;
use crate::options::SceneOptions;
use crate::output::write_atomically;
use crate::render::SampleCheck;
use crate::volume::Volume;

use super::terminal::write_json;

#[derive(Serialize)]
pub struct Stats<'a> {
    pub version: &'static str,
    pub command: &'static str,
    /// Everything that determines the picture, in the form of a scene file.
    pub scene: &'a SceneOptions,
    pub volume: VolumeStats,
    pub device: DeviceStats,
    /// The picture file's channels, in order.
    pub channels: Vec<String>,
    pub times_ms: Times,
    pub passes: Vec<PassStats>,
    pub counts: Counts,
    /// The rays of each round of casting; of a single picture.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rays_per_round: Vec<u64>,
    /// How much adaptive anti-aliasing may differ from the whole of it; of a single picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample_check: Option<SampleCheck>,
    /// How far from the truth the occlusion may be, where that is bounded; of a single picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub occlusion_bound: Option<BoundReached>,
    /// How far away the focal plane of the lens is along the view axis, mm; of a single picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub focus_mm: Option<f64>,
    /// Whether the step will do, where that was checked; of a single picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sampling_check: Option<SamplingCheck>,
    pub memory: Memory,
    /// Where an error bound decided how rays are followed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_error: Option<ToleranceStats>,
}

#[derive(Serialize)]
pub struct VolumeStats {
    pub file: String,
    pub dims: [u32; 3],
    #[serde(rename = "type")]
    pub kind: &'static str,
    pub spacing_mm: [f64; 3],
    pub origin_mm: [f64; 3],
    /// The rows of the matrix whose columns are the index axes' directions.
    pub direction: [[f64; 3]; 3],
    pub range: [f64; 2],
    pub non_finite: u64,
}

impl VolumeStats {
    pub fn of(file: &Path, volume: &Volume, non_finite: u64) -> Self {
        let geometry = volume.geometry();
        let range = volume.range();
        Self {
            file: file.display().to_string(),
            dims: volume.dims().array(),
            kind: volume.voxels().voxel_type().name(),
            spacing_mm: geometry.spacing_mm().to_array(),
            origin_mm: geometry.origin_mm().to_array(),
            direction: geometry.direction().transpose().to_cols_array_2d(),
            range: [range.min, range.max],
            non_finite,
        }
    }
}

#[derive(Serialize, Clone)]
pub struct DeviceStats {
    pub name: String,
    pub platform: String,
    pub driver: String,
}

impl From<&DeviceInfo> for DeviceStats {
    fn from(info: &DeviceInfo) -> Self {
        Self {
            name: info.name.clone(),
            platform: info.platform.clone(),
            driver: info.driver.clone(),
        }
    }
}

#[derive(Serialize, Default)]
pub struct Times {
    pub read: f64,
    pub smooth: f64,
    pub octree: f64,
    /// Telling from the octree what can be left out.
    pub classify: f64,
    /// Time of kernel compilation, ms.
    pub build: f64,
    pub upload: f64,
    /// Computing and uploading precomputed gradients.
    pub gradient: f64,
    /// All passes of the frame.
    pub render: f64,
    /// Copying the planes to the host; 0 where the reference renders.
    pub read_back: f64,
    pub encode: f64,
}

#[derive(Serialize, Clone)]
pub struct PassStats {
    pub name: String,
    pub ms: f64,
}

#[derive(Serialize)]
pub struct Memory {
    /// The most that the process held; unknown on some systems.
    pub host_peak_bytes: Option<u64>,
    pub device_bytes: u64,
    /// The part of these bytes that holds precomputed gradients.
    pub gradient_bytes: u64,
    /// The bytes uploaded from host to device.
    pub uploaded_bytes: u64,
}

impl Memory {
    pub fn now(device_bytes: u64, gradient_bytes: u64, uploaded_bytes: u64) -> Self {
        Self {
            host_peak_bytes: host_peak_bytes(),
            device_bytes,
            gradient_bytes,
            uploaded_bytes,
        }
    }
}

/// The statistics of an orbit: the sums over the frames that were made, and each of them.
#[derive(Serialize)]
pub struct OrbitStats<'a> {
    /// The scene is that of frame 0.
    #[serde(flatten)]
    pub all: Stats<'a>,
    pub orbit: OrbitFigures,
    pub frames: Vec<FrameStats>,
}

/// An orbit's axis and angles, and this process's share of it.
#[derive(Serialize)]
pub struct OrbitFigures {
    pub frames: u32,
    pub degrees: f64,
    /// The unit axis of the orbit, world space.
    pub axis: [f64; 3],
    /// Frames that were there already.
    pub kept: usize,
    pub shard: String,
}

#[derive(Serialize)]
pub struct FrameStats {
    pub index: u32,
    pub degrees: f64,
    pub render_ms: f64,
    pub read_back_ms: f64,
    /// Beside the rendering of frames after it.
    pub encode_ms: f64,
    pub counts: Counts,
}

/// Writes statistics as JSON, of whose strings a terminal obeys nothing: the file may be one.
pub fn write(stats: &impl Serialize, path: &Path) -> Result<()> {
    write_atomically(path, |out| {
        write_json(out, stats)
            .and_then(|()| writeln!(out))
            .map_err(|cause| Error::writing(path, "write", &cause))
    })
}
