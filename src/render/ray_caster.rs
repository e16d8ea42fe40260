//! `kernels/test/aimed_rays.cl`: first crossings of rays that are given one by one, for judging the
//! cast apart from cameras.

use crate::error::Result;
use crate::extent::ImageSize;
use crate::frame::{Certificate, Kind};
use crate::gpu::{Args, Buffer, Device, Timings};
use crate::octree::Octree;
use crate::scene::{Refine, Sampling};
use crate::volume::Volume;

use super::abi::{KernelEnum, Lanes, StoredIso, SurfaceCast, Variant};
use super::occupancy::{Criterion, Occupancy};
use super::passes::Passes;
use super::resources::HeldVolume;

/// The first crossing of one ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstCrossing {
    /// The ray parameter: lengths of the ray's direction from its origin; +∞: nothing.
    pub t: f32,
    /// What the ray meets.
    pub kind: Kind,
    /// What is proven of it.
    pub certificate: Certificate,
}

/// Rays a row of the launch.
const ROW: u32 = 4096;

/// Casts rays on a device; builds each variant once.
pub struct RayCaster<'a> {
    device: &'a Device,
    lanes: Lanes,
    passes: Passes,
}

impl<'a> RayCaster<'a> {
    /// `lanes` rays side by side; `None`: [`Lanes::of`] the device.
    pub fn new(device: &'a Device, lanes: Option<Lanes>) -> Self {
        Self {
            device,
            lanes: lanes.unwrap_or_else(|| Lanes::of(device.info())),
            passes: Passes::default(),
        }
    }

    /// The first change of Φ ≥ `iso` along each ray, given by its origin and direction in index
    /// space; `iso` is physical.
    ///
    /// # Errors
    /// The device fails or has no room.
    pub fn cast(
        &mut self,
        volume: &Volume,
        octree: &Octree,
        iso: f64,
        caps: bool,
        rays: &[([f32; 3], [f32; 3])],
    ) -> Result<Vec<FirstCrossing>> {
        let (device, sampling) = (self.device, Sampling::default());
        let mut held = HeldVolume::default();
        let (on_device, voxels) = held.upload(device, volume, octree, sampling.voxels)?;
        let iso = StoredIso::exactly(volume.rescale(), iso);
        let criterion = Criterion::Iso(iso);
        let occupancy = Occupancy::upload(device, volume, octree, &sampling, criterion)?;
        let padded = |[x, y, z]: [f32; 3]| [x, y, z, 0.0];
        let origins: Vec<[f32; 4]> = rays.iter().map(|ray| padded(ray.0)).collect();
        let dirs: Vec<[f32; 4]> = rays.iter().map(|ray| padded(ray.1)).collect();
        let origins = Buffer::upload(device, "rays", &origins)?;
        let dirs = Buffer::upload(device, "rays", &dirs)?;
        let mut hit = Buffer::<f32>::new(device, "hits", rays.len())?;
        let mut kind = Buffer::<u32>::new(device, "kinds", rays.len())?;
        let mut certificate = Buffer::<u32>::new(device, "certificates", rays.len())?;
        let count = rays.len() as u32;
        let size = ImageSize::new(ROW.min(count), count.div_ceil(ROW))?;
        let args = Args::new()
            .with(voxels)
            .read("node_class", &occupancy.node_class)
            .read("levels", &on_device.levels)
            .read("cells", &occupancy.cells)
            .value("volume", &on_device.grid)
            .value("cast", &surface_cast(iso, caps, &sampling))
            .value("count", &count)
            .value("width", &size.width())
            .read("origins", &origins)
            .read("dirs", &dirs)
            .write("hit", &mut hit)
            .write("kind", &mut kind)
            .write("certificate", &mut certificate);
        self.launch(
            Variant::of(volume, octree, &sampling, self.lanes),
            args,
            size,
        )?;
        let (hit, kind) = (hit.download(device)?, kind.download(device)?);
        let certificate = certificate.download(device)?;
        let found = hit.into_iter().zip(kind).zip(certificate);
        Ok(found
            .map(|((t, kind), certificate)| FirstCrossing {
                t,
                kind: kind_of(kind),
                certificate: certificate_of(certificate),
            })
            .collect())
    }

    fn launch(&mut self, variant: Variant, args: Args, size: ImageSize) -> Result<()> {
        let lanes = variant.lanes;
        let defines = variant.defines().with("LANES", lanes);
        let defines = defines.with("CERTIFICATE", 1);
        let tile = [lanes.get() as usize, 1];
        let pass = self.passes.get("test", "aimed_rays", defines, tile);
        let mut timings = Timings::default();
        timings.add(pass.launch(self.device, args, size, Some([1, 1]))?);
        timings.finish(self.device)?;
        Ok(())
    }
}

fn surface_cast(iso: StoredIso, caps: bool, sampling: &Sampling) -> SurfaceCast {
    SurfaceCast {
        iso: iso.value,
        step_mm: 0.0,
        caps: u32::from(caps),
        refine: Refine::default().method.number(),
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
