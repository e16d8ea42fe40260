//! One frame, from scene to planes: uploads, the picture's own passes, the tone curve, the
//! read-back.

mod sampled;

pub use sampled::Sampled;

use std::time::Instant;

use crate::error::{Error, Result};
use crate::frame::{Frame, Wanted};
use crate::gpu::{Buffer, Device, PassTime, Timings};
use crate::octree::Octree;
use crate::scene::{Picture, SamplingMethod, Scene, Storage};
use crate::volume::Volume;

use super::classified::{Criterion, RecentlyClassified};
use super::clip::DeviceClip;
use super::emission::emission;
use super::gradient::{self, DeviceDirections, DeviceGradient, GradientFigures};
use super::lanes::Lanes;
use super::passes::{Built, DeviceVolume, Run, tone_curve};
use super::picture::{self, View};
use super::rays::{ray_grid, volume_grid};
use super::room::{check_picture, check_volume};
use super::twins;
use super::variant::{MOST_SAMPLES, Variant};
use super::voxels::{DeviceVoxels, HeldVoxels};

/// How the device is used; never changes a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Options {
    /// Work-items along x and y of a group; `None`: those of 8 × 8 pixels.
    pub work_group: Option<[usize; 2]>,
    /// Rays that a work-item follows side by side; `None`: [`Lanes::of`] the device.
    pub lanes: Option<Lanes>,
}

/// A volume on a device, ready to be looked at.
pub struct Renderer<'a> {
    device: &'a Device,
    volume: &'a Volume,
    octree: &'a Octree,
    uploaded: DeviceVolume,
    voxels: HeldVoxels,
    /// Those of the last picture that needed some.
    directions: Option<DeviceDirections>,
    classified: RecentlyClassified,
    built: Built,
    work_group: Option<[usize; 2]>,
    lanes: Lanes,
    upload_ms: f64,
    /// Uploaded and not yet told.
    uploaded_bytes: u64,
}

/// A frame and what it cost.
pub struct Rendering {
    pub frame: Frame,
    /// In launch order.
    pub passes: Vec<PassTime>,
    /// Building passes, for this frame.
    pub build_ms: f64,
    /// Uploading the volume: with its first frame, then 0.
    pub upload_ms: f64,
    /// Telling from ranges of values what can be left out; 0 where the last frame's holds.
    pub classify_ms: f64,
    /// From host to device, for this frame; with the volume's first frame the volume too.
    pub uploaded_bytes: u64,
    /// Device time from the first launch's start to the last one's end.
    pub render_ms: f64,
    /// Copying the wanted planes to the host, after the last pass has ended.
    pub read_back_ms: f64,
    /// Of precomputed gradients, where the picture made use of them.
    pub gradients: Option<GradientFigures>,
    /// Held on the device while rendering.
    pub device_bytes: u64,
}

impl<'a> Renderer<'a> {
    /// Uploads the octree. The voxels follow with the first picture, as it wants them held.
    ///
    /// # Errors
    /// The device has no room, or cannot run work-groups of the wanted size.
    pub fn new(
        device: &'a Device,
        volume: &'a Volume,
        octree: &'a Octree,
        options: Options,
    ) -> Result<Self> {
        let start = Instant::now();
        let uploaded_before = device.uploaded_bytes();
        check_work_group(device, options.work_group)?;
        check_volume(device.info(), volume.dims(), volume.voxels().voxel_type())?;
        let levels: Vec<[u32; 4]> = octree
            .levels()
            .iter()
            .map(|level| [level.size[0], level.size[1], level.size[2], level.offset])
            .collect();
        let uploaded = DeviceVolume {
            grid: volume_grid(volume, levels.len() as u32),
            levels: Buffer::upload(device, "octree's levels", &levels)?,
            node_range: Buffer::upload(device, "octree's ranges", octree.ranges())?,
        };
        Ok(Self {
            device,
            volume,
            octree,
            uploaded,
            voxels: HeldVoxels::default(),
            directions: None,
            classified: RecentlyClassified::default(),
            built: Built::default(),
            work_group: options.work_group,
            lanes: options.lanes.unwrap_or_else(|| Lanes::of(device.info())),
            upload_ms: start.elapsed().as_secs_f64() * 1e3,
            uploaded_bytes: device.uploaded_bytes() - uploaded_before,
        })
    }

    /// What is looked at.
    pub fn volume(&self) -> &'a Volume {
        self.volume
    }

    /// Whether the device can hold the volume in this way.
    ///
    /// # Errors
    /// The device has no images, none so large, or none of the voxels' type.
    pub fn check_storage(&self, storage: Storage) -> Result<()> {
        DeviceVoxels::check(self.device, self.volume, storage)
    }

    /// Forgets which nodes and cells matter: the next picture finds it anew, as if its iso value or transfer
    /// function were new.
    pub fn forget_classes(&mut self) {
        self.classified.forget();
    }

    /// What the device holds of the volume at least, uploaded or not.
    fn least_held_bytes(&self) -> u64 {
        self.uploaded.bytes() + self.volume.voxels().bytes().len() as u64
    }

    /// Uploads the voxels as they are to be held, unless they are there; this is upload time.
    fn upload_voxels(&mut self, storage: Storage) -> Result<()> {
        let start = Instant::now();
        let uploaded_before = self.device.uploaded_bytes();
        self.voxels.held(self.device, self.volume, storage)?;
        let bytes = self.device.uploaded_bytes() - uploaded_before;
        if bytes > 0 {
            self.upload_ms += start.elapsed().as_secs_f64() * 1e3;
            self.uploaded_bytes += bytes;
        }
        Ok(())
    }

    /// Computes and uploads the gradients that the picture needs precomputed, unless those of the last
    /// one are the same.
    ///
    /// # Errors
    /// The device has no room.
    pub fn precompute(&mut self, scene: &Scene, wanted: Wanted) -> Result<()> {
        if let Some(how) = gradient::needed(scene, wanted)
            && self.directions.as_ref().is_none_or(|d| d.how != how)
        {
            self.directions = None; // its memory first
            let made = DeviceDirections::upload(self.device, self.volume, how)?;
            self.directions = Some(made);
        }
        Ok(())
    }

    /// Casts a scene; computes only the planes that are wanted.
    ///
    /// # Errors
    /// The device fails or has no room, cannot hold the voxels as the sampling wants them, or the
    /// step is too small to count samples.
    pub fn render(&mut self, scene: &Scene, wanted: Wanted) -> Result<Rendering> {
        let method = scene.sampling_method();
        if method == SamplingMethod::Fixed {
            check_step(scene, self.volume)?;
        }
        let storage = scene.sampling.voxels;
        storage.check(method, scene.sampling.filter)?;
        let device_info = self.device.info();
        check_picture(device_info, scene.size, wanted, self.least_held_bytes())?;
        self.upload_voxels(storage)?;
        let uploaded_before = self.device.uploaded_bytes();
        self.precompute(scene, wanted)?;
        let directions = self.directions.as_ref();
        let directions_bytes = directions.map_or(0, |directions| directions.figures.bytes);
        let directions = directions.filter(|_| gradient::needed(scene, wanted).is_some());
        let held_bytes = self.uploaded.bytes() + self.voxels.bytes() + directions_bytes;
        check_picture(device_info, scene.size, wanted, held_bytes)?;
        let start = Instant::now();
        let criterion = Criterion::of(scene, wanted, self.volume, self.octree);
        let (device, volume, octree) = (self.device, self.volume, self.octree);
        let (classified, is_new) = self
            .classified
            .of(device, volume, octree, scene, criterion)?;
        let classify_ms = if is_new {
            start.elapsed().as_secs_f64() * 1e3
        } else {
            0.0
        };
        let mut timings = Timings::default();
        let mut run = Run {
            device: self.device,
            built: &mut self.built,
            timings: &mut timings,
            size: scene.size,
            work_group: self.work_group,
            variant: Variant::of(self.volume, self.octree, &scene.sampling, self.lanes),
            voxels: self.voxels.held(self.device, self.volume, storage)?,
        };
        let world_from_index = self.volume.geometry().world_from_index();
        let clip = DeviceClip::upload(self.device, &scene.clip_planes, world_from_index)?;
        let view = View {
            scene,
            wanted,
            volume: self.volume,
            octree: self.octree,
            uploaded: &self.uploaded,
            classified,
            clip: &clip,
            gradient: DeviceGradient::of(scene.gradient, directions),
            rays: ray_grid(&scene.camera, scene.size, self.volume),
        };
        let mut planes = match &scene.picture {
            Picture::Surface {
                iso,
                caps,
                refine,
                color,
                phong,
            } => picture::surface(&mut run, &view, *iso, *caps, *refine, *color, *phong)?,
            Picture::Projection { of, window } => {
                picture::projection(&mut run, &view, *of, *window)?
            }
            Picture::Emission(medium) => emission(&mut run, &view, medium)?,
        };
        if wanted.display {
            let mut display = run.plane("display plane")?;
            tone_curve(
                &mut run,
                &view.rays,
                &twins::tone(&scene.tone),
                &planes.color,
                &mut display,
            )?;
            planes.display = Some(display);
        }
        let build_ms = timings.build(self.device)?;
        let (passes, render_ms) = timings.finish(self.device)?;
        let finished = Instant::now();
        let frame = planes.read_back(self.device, scene.size, wanted, self.volume.rescale())?;
        Ok(Rendering {
            frame,
            read_back_ms: finished.elapsed().as_secs_f64() * 1e3,
            passes,
            build_ms,
            upload_ms: std::mem::take(&mut self.upload_ms),
            classify_ms,
            uploaded_bytes: std::mem::take(&mut self.uploaded_bytes)
                + (self.device.uploaded_bytes() - uploaded_before),
            render_ms,
            gradients: directions.map(|directions| directions.figures),
            device_bytes: held_bytes
                + self.classified.bytes()
                + clip.planes.bytes()
                + planes.bytes(),
        })
    }
}

fn check_work_group(device: &Device, work_group: Option<[usize; 2]>) -> Result<()> {
    let Some([x, y]) = work_group else {
        return Ok(());
    };
    let most = device.info().max_work_group;
    if x.checked_mul(y).is_some_and(|n| (1..=most).contains(&n)) {
        return Ok(());
    }
    Err(Error::usage(format!(
        "a work-group of {x}x{y} work-items: the device '{}' takes 1 to {most} in all",
        device.info().name
    )))
}

/// Samples are counted in single precision: a ray may have at most [`MOST_SAMPLES`] of them.
fn check_step(scene: &Scene, volume: &Volume) -> Result<()> {
    let (_, radius_mm) = volume.bounding_sphere();
    let samples = 2.0 * radius_mm / twins::step_mm(&scene.sampling, volume);
    if samples < f64::from(MOST_SAMPLES) {
        return Ok(());
    }
    Err(Error::usage(format!(
        "a step of {} voxels of the smallest spacing gives up to {samples:.3e} samples per ray, more than 2^24",
        scene.sampling.step
    ))
    .hint("choose a larger --step, or in dvr --quad adaptive, else --sampling exact, which take none"))
}
