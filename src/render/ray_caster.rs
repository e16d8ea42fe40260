//! First crossings of rays that are given one by one.

use crate::error::Result;
use crate::frame::{Certificate, Kind, Layer, Plane};
use crate::gpu::{Buffer, Device, Timings};
use crate::octree::Octree;
use crate::scene::{Refine, Sampling};
use crate::volume::Volume;

use super::abi::{KernelEnum, Lanes, StoredIso, SurfaceCast, Variant};
use super::occupancy::{Criterion, Occupancy, OccupancyTables};
use super::passes::{CastInputs, Passes, Run, exact_surface};
use super::resources::{DeviceClip, DeviceLayers, HeldVolume, IndexRay, RaySource};

/// The first crossing of one ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstCrossing {
    /// The ray parameter: lengths of the ray's direction from its origin; +∞: nothing.
    pub t: f32,
    /// The kind of thing that the ray meets.
    pub kind: Kind,
    /// What is proven of the result in spite of rounding.
    pub certificate: Certificate,
}

/// The first crossings of rays, and what they cost.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedCrossings {
    /// One for each ray, in their order.
    pub crossings: Vec<FirstCrossing>,
    /// The time of the cast on the device's clock, ms: without uploads, and without finding what can be left out.
    pub device_ms: f64,
}

/// Casts rays on a device; builds each variant once.
pub struct RayCaster<'a> {
    device: &'a Device,
    lanes: Lanes,
    passes: Passes,
}

impl<'a> RayCaster<'a> {
    /// A caster whose work-items follow `lanes` rays side by side; `None`: [`Lanes::of`] the device.
    pub fn new(device: &'a Device, lanes: Option<Lanes>) -> Self {
        Self {
            device,
            lanes: lanes.unwrap_or_else(|| Lanes::of(device.info())),
            passes: Passes::default(),
        }
    }

    /// The first change of Φ ≥ `iso` along each ray, as the exact surface's cast finds it for a picture;
    /// `iso` is physical. Rays need not run together.
    ///
    /// # Errors
    /// The device fails or has no room; no rays.
    pub fn cast(
        &mut self,
        volume: &Volume,
        octree: &Octree,
        iso: f64,
        caps: bool,
        rays: &[IndexRay],
    ) -> Result<Vec<FirstCrossing>> {
        let cast = self.cast_timed(volume, octree, iso, caps, rays)?;
        Ok(cast.crossings)
    }

    /// Casts rays as [`RayCaster::cast`] does, and says how long the device took.
    ///
    /// # Errors
    /// The device fails or has no room; no rays.
    pub fn cast_timed(
        &mut self,
        volume: &Volume,
        octree: &Octree,
        iso: f64,
        caps: bool,
        rays: &[IndexRay],
    ) -> Result<TimedCrossings> {
        let (device, sampling) = (self.device, Sampling::default());
        let mut held = HeldVolume::default();
        let (on_device, voxels) = held.upload(device, volume, octree, sampling.voxels)?;
        let iso = StoredIso::exactly(volume.rescale(), iso);
        let criterion = Criterion::Iso(iso);
        let occupancy = Occupancy::upload(
            device,
            volume,
            octree,
            OccupancyTables::of(&sampling),
            criterion,
        )?;
        let world_from_index = volume.geometry().world_from_index();
        let clip = DeviceClip::upload(device, &[], world_from_index)?;
        let rays = RaySource::of_rays(device, rays)?;
        let mut layers = DeviceLayers::default();
        layers.allocate(device, &rays, &[Layer::Kind, Layer::Certificate])?;
        let mut timings = Timings::default();
        let mut run = Run {
            device,
            passes: &mut self.passes,
            timings: &mut timings,
            announcing: false,
            rays,
            work_group: Some([1, 1]),
            variant: Variant::of(volume, octree, &sampling, self.lanes),
            voxels,
        };
        let inputs = CastInputs {
            volume: on_device,
            occupancy: &occupancy,
            clip: &clip,
            jitter: None,
        };
        let cast = surface_cast(iso, caps, &sampling);
        let mut hit = run.plane("hits", f32::INFINITY)?;
        exact_surface(&mut run, inputs, &cast, &mut hit, &mut layers)?;
        let device_ms = timings.finish(device)?.device_ms;
        Ok(TimedCrossings {
            crossings: found(device, &hit, &layers)?,
            device_ms,
        })
    }
}

fn found(device: &Device, hit: &Buffer<f32>, layers: &DeviceLayers) -> Result<Vec<FirstCrossing>> {
    let hit = hit.download(device)?;
    let counts = |layer| -> Result<Vec<u32>> {
        Ok(match layers.download(device, layer)? {
            Some(Plane::Counts(counts)) => counts,
            _ => Vec::new(),
        })
    };
    let (kind, certificate) = (counts(Layer::Kind)?, counts(Layer::Certificate)?);
    let found = hit.into_iter().zip(kind).zip(certificate);
    Ok(found
        .map(|((t, kind), certificate)| FirstCrossing {
            t,
            kind: kind_of(kind),
            certificate: certificate_of(certificate),
        })
        .collect())
}

fn surface_cast(iso: StoredIso, caps: bool, sampling: &Sampling) -> SurfaceCast {
    SurfaceCast {
        iso: iso.value,
        step_mm: 0.0,
        caps: u32::from(caps),
        refine: Refine::default().method().number(),
        iterations: 0,
        traverse: sampling.skip.then_some(sampling.traverse).number(),
        probe: 0,
        iso_error: iso.error,
    }
}

fn kind_of(number: u32) -> Kind {
    let kinds = [Kind::Surface, Kind::Cap];
    let found = kinds.into_iter().find(|&kind| kind as u32 == number);
    found.unwrap_or(Kind::Nothing)
}

fn certificate_of(number: u32) -> Certificate {
    let proven = [Certificate::Miss, Certificate::Hit];
    let found = proven.into_iter().find(|&each| each as u32 == number);
    found.unwrap_or(Certificate::Undecided)
}
