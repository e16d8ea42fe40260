//! One frame, from scene to planes: uploads, the picture's own passes, the tone curve, the
//! read-back.

use std::time::Instant;

use crate::error::{Error, Result};
use crate::frame::{Frame, Layer, Wanted};
use crate::gpu::{Device, FrameTimes, PassTime, Timings};
use crate::octree::Octree;
use crate::render::abi::{Jitter, Lanes, Variant, jitter, tone};
use crate::render::occupancy::{Criterion, OccupancyCache, OccupancyTables};
use crate::render::passes::{CastInputs, Passes, Run, tone_curve};
use crate::render::resources::{
    DeviceClip, DeviceDirections, DeviceGradient, DeviceVoxels, GradientFigures, HeldVolume,
    RaySource, needed_gradients,
};
use crate::scene::{Light, Occlusion, SamplingMethod, Scene, Storage};
use crate::volume::Volume;

use super::casting::cast_picture;
use super::planes::Planes;
use super::room::{check_picture, check_volume, listing_bytes};
use super::sample_check::SampleCheck;
use super::step::check_step;
use super::view::{View, with_cues};

/// How the device is used; never changes a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Options {
    /// Work-items along x and y of a group; `None`: those of 8 × 8 pixels.
    pub work_group: Option<[usize; 2]>,
    /// Rays that a work-item follows side by side; `None`: [`Lanes::of`] the device.
    pub lanes: Option<Lanes>,
}

/// A volume on a device, ready to be rendered.
pub struct Renderer<'a> {
    pub(super) device: &'a Device,
    pub(super) volume: &'a Volume,
    pub(super) octree: &'a Octree,
    /// The parts of the volume that are on the device.
    pub(super) held: HeldVolume,
    /// The precomputed gradients of the last picture that needed some.
    directions: Option<DeviceDirections>,
    occupancies: OccupancyCache,
    pub(super) passes: Passes,
    pub(super) work_group: Option<[usize; 2]>,
    pub(super) lanes: Lanes,
}

/// A frame and what it cost.
pub struct Rendering {
    /// The picture.
    pub frame: Frame,
    /// The passes in launch order.
    pub passes: Vec<PassTime>,
    /// Time to build passes for this frame.
    pub build_ms: f64,
    /// Time to upload the volume: with its first frame, then 0.
    pub upload_ms: f64,
    /// Time to find from ranges of values what can be left out; 0 where it was known from an earlier frame.
    pub classify_ms: f64,
    /// The bytes uploaded from host to device for this frame; with the volume's first frame the volume
    /// too.
    pub uploaded_bytes: u64,
    /// Device time from the first launch's start to the last one's end.
    pub render_ms: f64,
    /// Time to copy the wanted planes to the host, after the last pass has ended.
    pub read_back_ms: f64,
    /// The rays of each round: one round for a whole picture; those of a sparse one; for an anti-aliased one the
    /// rays through pixels' centres, where they are needed, and then all others.
    pub rays_per_round: Vec<u64>,
    /// How much the picture may differ from one with as many rays in every pixel, where its anti-aliasing is adaptive.
    pub sample_check: Option<SampleCheck>,
    /// How far away the focal plane of the lens is along the view axis, mm; `None`: a pinhole.
    pub focus_mm: Option<f64>,
    /// The precomputed gradients, where the picture made use of them.
    pub gradients: Option<GradientFigures>,
    /// Bytes held on the device while rendering.
    pub device_bytes: u64,
}

/// The cost of an upload.
pub(super) struct Upload {
    ms: f64,
    bytes: u64,
}

/// The launches of a picture: the planes that they fill, and the time to find what they can skip.
struct Launched {
    planes: Planes,
    classify_ms: f64,
}

impl<'a> Renderer<'a> {
    /// A renderer of a volume, of which nothing is uploaded before its first picture.
    ///
    /// # Errors
    /// The device cannot hold the volume, or cannot run work-groups of the wanted size.
    pub fn new(
        device: &'a Device,
        volume: &'a Volume,
        octree: &'a Octree,
        options: Options,
    ) -> Result<Self> {
        check_work_group(device, options.work_group)?;
        check_volume(device.info(), volume.dims(), volume.voxels().voxel_type())?;
        Ok(Self {
            device,
            volume,
            octree,
            held: HeldVolume::default(),
            directions: None,
            occupancies: OccupancyCache::default(),
            passes: Passes::default(),
            work_group: options.work_group,
            lanes: options.lanes.unwrap_or_else(|| Lanes::of(device.info())),
        })
    }

    /// The volume that is rendered.
    pub fn volume(&self) -> &'a Volume {
        self.volume
    }

    /// Checks that the device can hold the volume in this storage.
    ///
    /// # Errors
    /// The device has no images, none so large, or none of the voxels' type.
    pub fn check_storage(&self, storage: Storage) -> Result<()> {
        DeviceVoxels::check(self.device, self.volume, storage)
    }

    /// Drops what is known of nodes and cells: the next picture finds it anew, as if its iso value or transfer
    /// function were new.
    pub fn forget_classes(&mut self) {
        self.occupancies.clear();
    }

    /// Computes and uploads the gradients that the picture needs precomputed, unless those of the last
    /// one are the same.
    ///
    /// # Errors
    /// The device has no room.
    pub fn precompute(&mut self, scene: &Scene, wanted: Wanted) -> Result<()> {
        if let Some(how) = needed_gradients(scene, wanted)
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
        self.render_rays(scene, wanted, None)
    }

    /// Casts some pixels of a scene, counted row by row, each by one ray. The frame's others are empty: transparent, with every
    /// layer's value where nothing is known ([`Layer::empty`](crate::frame::Layer::empty)).
    ///
    /// # Errors
    /// As [`Renderer::render`]; a pixel outside the picture; no pixels; usage: what is found from the pixels around each.
    pub fn render_pixels(
        &mut self,
        scene: &Scene,
        wanted: Wanted,
        pixels: &[u32],
    ) -> Result<Rendering> {
        self.render_rays(scene, wanted, Some(pixels))
    }

    fn render_rays(
        &mut self,
        scene: &Scene,
        wanted: Wanted,
        pixels: Option<&[u32]>,
    ) -> Result<Rendering> {
        self.check_scene(scene)?;
        if pixels.is_some() {
            check_alone(scene)?;
        }
        let needed = with_cues(scene, wanted);
        let listing_bytes = listing_bytes(scene);
        let min_held_bytes = HeldVolume::min_bytes(self.volume, self.octree) + listing_bytes;
        check_picture(self.device.info(), scene.size, needed, min_held_bytes)?;
        let volume_upload = self.upload_volume(scene.sampling.voxels)?;
        let uploaded_before = self.device.uploaded_bytes();
        self.precompute(scene, needed)?;
        let held_bytes = self.held_bytes();
        let with_lists = held_bytes + listing_bytes;
        check_picture(self.device.info(), scene.size, needed, with_lists)?;

        let mut timings = Timings::default();
        let Launched {
            planes,
            classify_ms,
        } = self.launch(scene, needed, pixels, &mut timings)?;
        let FrameTimes {
            passes,
            build_ms,
            device_ms,
        } = timings.finish(self.device)?;

        let finished = Instant::now();
        let frame = planes.read_back(self.device, scene.size, wanted, self.volume.rescale())?;
        let uploaded_bytes = self.device.uploaded_bytes() - uploaded_before;
        Ok(Rendering {
            frame,
            read_back_ms: finished.elapsed().as_secs_f64() * 1e3,
            passes,
            build_ms,
            upload_ms: volume_upload.ms,
            classify_ms,
            uploaded_bytes: volume_upload.bytes + uploaded_bytes,
            render_ms: device_ms,
            rays_per_round: planes.rays_per_round.clone(),
            sample_check: planes.check,
            focus_mm: planes.focus_mm,
            gradients: (self.directions_for(scene, needed)).map(|directions| directions.figures),
            device_bytes: held_bytes + self.occupancies.bytes() + planes.bytes(),
        })
    }

    /// Checks that the scene's samples can be counted and read.
    fn check_scene(&self, scene: &Scene) -> Result<()> {
        Light::check_count(&scene.lights)?;
        let method = scene.sampling_method();
        if method == SamplingMethod::Fixed {
            check_step(scene, self.volume)?;
        }
        (scene.sampling.voxels).check(method, scene.sampling.filter)
    }

    /// Uploads what is not there of the octree's tables, and of the voxels in this storage.
    pub(super) fn upload_volume(&mut self, storage: Storage) -> Result<Upload> {
        let start = Instant::now();
        let uploaded_before = self.device.uploaded_bytes();
        self.held
            .upload(self.device, self.volume, self.octree, storage)?;
        let bytes = self.device.uploaded_bytes() - uploaded_before;
        let ms = if bytes > 0 {
            start.elapsed().as_secs_f64() * 1e3
        } else {
            0.0
        };
        Ok(Upload { ms, bytes })
    }

    /// Device memory that the volume and its gradients take, in bytes.
    fn held_bytes(&self) -> u64 {
        let directions = self.directions.as_ref();
        self.held.bytes() + directions.map_or(0, |directions| directions.figures.bytes)
    }

    /// The precomputed gradients, where the picture makes use of them.
    fn directions_for(&self, scene: &Scene, wanted: Wanted) -> Option<&DeviceDirections> {
        needed_gradients(scene, wanted).and(self.directions.as_ref())
    }

    /// Puts the launches of a picture in order, after what they read is uploaded.
    fn launch(
        &mut self,
        scene: &Scene,
        wanted: Wanted,
        pixels: Option<&[u32]>,
        timings: &mut Timings,
    ) -> Result<Launched> {
        let (device, volume, octree) = (self.device, self.volume, self.octree);
        let start = Instant::now();
        let criterion = Criterion::of(scene, wanted, volume, octree);
        let tables = OccupancyTables::of_scene(scene, wanted);
        let (occupancy, is_new) = self
            .occupancies
            .get(device, volume, octree, tables, criterion)?;
        let classify_ms = if is_new {
            start.elapsed().as_secs_f64() * 1e3
        } else {
            0.0
        };
        let world_from_index = volume.geometry().world_from_index();
        let clip = DeviceClip::upload(device, &scene.clip_planes, world_from_index)?;
        let directions = needed_gradients(scene, wanted).and(self.directions.as_ref());
        let (on_device, voxels) =
            self.held
                .upload(device, volume, octree, scene.sampling.voxels)?;
        let (camera, size) = (&scene.camera, scene.size);
        let rays = match pixels {
            Some(pixels) => RaySource::of_pixels(device, camera, size, volume, pixels)?,
            None => RaySource::of_camera(camera, size, volume),
        };
        let mut run = Run {
            device,
            passes: &mut self.passes,
            timings,
            announcing: false,
            rays,
            work_group: self.work_group,
            variant: Variant::of(volume, octree, &scene.sampling, self.lanes),
            voxels,
        };
        let view = View {
            scene,
            // A lens is focused, and its circles of confusion found, by the depths.
            wanted: wanted.with_if(scene.depth_of_field.is_some(), Layer::Depth),
            volume,
            octree,
            inputs: CastInputs {
                volume: on_device,
                occupancy,
                clip: &clip,
                jitter: jitter_of(scene),
            },
            gradient: DeviceGradient::of(scene.gradient, directions),
        };
        let mut planes = cast_picture(&mut run, &view, pixels.is_none())?;
        if wanted.display {
            let mut display = run.plane("display plane", [0.0; 4])?;
            tone_curve(&mut run, &tone(&scene.tone), &planes.color, &mut display)?;
            planes.display = Some(display);
        }
        planes.other_bytes += clip.bytes();
        Ok(Launched {
            planes,
            classify_ms,
        })
    }
}

/// How the samples of a scene's rays are shifted; where none are taken at fixed steps there is nothing to shift.
fn jitter_of(scene: &Scene) -> Option<Jitter> {
    match scene.sampling_method() {
        SamplingMethod::Fixed => jitter(scene.sampling.jitter),
        SamplingMethod::Exact => None,
    }
}

/// Checks that pixels of a scene can be rendered without those around them.
fn check_alone(scene: &Scene) -> Result<()> {
    if let Some(Occlusion::Screen(_)) = scene.ambient_occlusion {
        return Err(Error::usage(
            "occlusion that is estimated from the picture needs all of its pixels",
        ));
    }
    if scene.depth_cues.is_some_and(|cues| cues.draws_edges()) {
        return Err(Error::usage(
            "what is drawn at edges needs the pixels on both sides of them",
        ));
    }
    Ok(())
}

fn check_work_group(device: &Device, work_group: Option<[usize; 2]>) -> Result<()> {
    let Some([x, y]) = work_group else {
        return Ok(());
    };
    let max = device.info().max_work_group;
    if x.checked_mul(y).is_some_and(|n| (1..=max).contains(&n)) {
        return Ok(());
    }
    Err(Error::usage(format!(
        "a work-group of {x}x{y} work-items: the device '{}' takes 1 to {max} in all",
        device.info().name
    )))
}
