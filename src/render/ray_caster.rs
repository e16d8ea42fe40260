//! `kernels/test/aimed_rays.cl`: first crossings of rays that are given one by one, for judging the
//! cast apart from cameras.

use std::collections::HashMap;
use std::sync::Arc;

use crate::error::Result;
use crate::extent::ImageSize;
use crate::frame::{Certificate, Kind};
use crate::gpu::{AnyBuffer, Buffer, Device, Pass, Timings, input, input_of, output, value};
use crate::octree::Octree;
use crate::scene::{Refine, Sampling};
use crate::volume::Volume;

use super::abi::{SurfaceCast, VolumeGrid};
use super::cells;
use super::classify;
use super::lanes::Lanes;
use super::rays::volume_grid;
use super::twins::stored;
use super::variant::{Variant, refine_number, traverse_number, voxel_cl_name};

/// What one ray meets first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstCrossing {
    /// In lengths of the ray's direction from its origin; +∞: nothing.
    pub t: f32,
    pub kind: Kind,
    pub certificate: Certificate,
}

/// Rays a row of the launch.
const ROW: u32 = 4096;

/// Casts rays on a device; builds each variant once.
pub struct RayCaster<'a> {
    device: &'a Device,
    lanes: Lanes,
    built: HashMap<Variant, Arc<Pass>>,
}

impl<'a> RayCaster<'a> {
    /// `lanes` rays side by side; `None`: [`Lanes::of`] the device.
    pub fn new(device: &'a Device, lanes: Option<Lanes>) -> Self {
        Self {
            device,
            lanes: lanes.unwrap_or_else(|| Lanes::of(device.info())),
            built: HashMap::new(),
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
        let sampling = Sampling::default();
        let variant = Variant::of(volume, octree, &sampling, self.lanes);
        let iso = stored(volume.rescale(), iso);
        let cast = SurfaceCast {
            iso,
            step_mm: 0.0,
            caps: u32::from(caps),
            refine: refine_number(Refine::default()),
            iterations: 0,
            traverse: traverse_number(&sampling),
            probe: 0,
            iso_error: 0.0,
        };
        let device = self.device;
        let four = |[x, y, z]: [f32; 3]| [x, y, z, 0.0];
        let origins: Vec<[f32; 4]> = rays.iter().map(|ray| four(ray.0)).collect();
        let dirs: Vec<[f32; 4]> = rays.iter().map(|ray| four(ray.1)).collect();
        let origins = Buffer::upload(device, "rays", &origins)?;
        let dirs = Buffer::upload(device, "rays", &dirs)?;
        let voxels = volume.voxels();
        let voxels = AnyBuffer::upload(
            device,
            "voxels",
            voxels.bytes(),
            voxel_cl_name(variant.voxel),
        )?;
        let levels: Vec<[u32; 4]> = octree
            .levels()
            .iter()
            .map(|level| {
                let [nx, ny, nz] = level.size;
                [nx, ny, nz, level.offset]
            })
            .collect();
        let grid = volume_grid(volume, levels.len() as u32);
        let levels = Buffer::upload(device, "octree's levels", &levels)?;
        let classes = classify::by_iso(octree, iso, 0.0)?;
        let cells = cells::crossed(volume, octree, &classes, iso, 0.0)?;
        let classes = Buffer::upload(device, "octree's classes", &classes)?;
        let cells = Buffer::upload(device, "crossed cells", &cells)?;
        let mut hit = Buffer::<f32>::new(device, "hits", rays.len())?;
        let mut kind = Buffer::<u32>::new(device, "kinds", rays.len())?;
        let mut certificate = Buffer::<u32>::new(device, "certificates", rays.len())?;
        let count = rays.len() as u32;
        let size = ImageSize::new(ROW.min(count), count.div_ceil(ROW))?;
        let mut timings = Timings::default();
        self.pass(variant)
            .launch(device)
            .input(&voxels)
            .input(&classes)
            .input(&levels)
            .input(&cells)
            .value(&grid)
            .value(&cast)
            .value(&count)
            .value(&size.width())
            .input(&origins)
            .input(&dirs)
            .output(&mut hit)
            .output(&mut kind)
            .output(&mut certificate)
            .run(size, Some([1, 1]), &mut timings)?;
        timings.finish(device)?;
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

    fn pass(&mut self, variant: Variant) -> &Arc<Pass> {
        self.built.entry(variant).or_insert_with(|| {
            let signature = vec![
                input_of("voxels", voxel_cl_name(variant.voxel)),
                input::<u8>("node_class"),
                input::<[u32; 4]>("levels"),
                input::<u64>("cells"),
                value::<VolumeGrid>("volume"),
                value::<SurfaceCast>("cast"),
                value::<u32>("count"),
                value::<u32>("width"),
                input::<[f32; 4]>("origins"),
                input::<[f32; 4]>("dirs"),
                output::<f32>("hit"),
                output::<u32>("kind"),
                output::<u32>("certificate"),
            ];
            let lanes = variant.lanes;
            let defines = variant.defines().with("LANES", lanes);
            let defines = defines.with("CERTIFICATE", 1);
            let pass = Pass::new("test", "aimed_rays", defines, signature);
            let pass = pass.with_tile([lanes.get() as usize, 1]);
            Arc::new(pass)
        })
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
