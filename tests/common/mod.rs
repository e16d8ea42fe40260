//! What the tests that need an OpenCL device share.
#![allow(dead_code)] // each test program uses its own part

use std::path::{Path, PathBuf};

use angioray::extent::{Dims, ImageSize};
use angioray::frame::error::{color_error, depth_error, normal_error, value_error};
use angioray::frame::{DEPTH, Frame, KIND, NORMAL, Plane, VALUE, Wanted};
use angioray::gpu::Device;
use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::reference;
use angioray::render::{Options, Renderer};
use angioray::scene::{
    Camera, Gradient, Lens, Light, Picture, Sampling, SamplingMethod, Scene, Storage, Tone,
};
use angioray::volume::{Geometry, NonFinite, ReadOptions, Rescale, Volume, Voxels, read};
use glam::DVec3;

/// The device under test: `ANGIORAY_TEST_DEVICE`, or the default one. Without any, says why and
/// gives `None`, unless `REQUIRE_OPENCL=1`.
pub fn device() -> Option<Device> {
    let choice = std::env::var("ANGIORAY_TEST_DEVICE").unwrap_or_default();
    match Device::select(&choice) {
        Ok(device) => Some(device),
        Err(error) => {
            skip(&error.to_string());
            None
        }
    }
}

/// Whether a device can hold volumes of 8 bits in images; else why not.
pub fn has_images(device: &Device) -> angioray::error::Result<()> {
    let volume = volume_of([2, 2, 2], |x, _, _| x as u8);
    let octree = octree(&volume);
    let renderer = Renderer::new(device, &volume, &octree, Options::default())?;
    renderer.check_storage(Storage::Image)
}

/// The [`device`] under test as a flag of the program.
pub fn device_flag() -> Option<String> {
    device().map(|device| format!("--device {}", device.info().id))
}

/// Says why a test cannot be made here; fails it under `REQUIRE_OPENCL=1`.
pub fn skip(reason: &str) {
    let required = std::env::var("REQUIRE_OPENCL").is_ok_and(|v| v == "1");
    assert!(!required, "REQUIRE_OPENCL=1, but {reason}");
    eprintln!("skipped: {reason}");
}

/// A volume of unit spacing from a function of the voxel.
pub fn volume_of<T>(dims: [u64; 3], voxel: impl Fn(f64, f64, f64) -> T) -> Volume
where
    Voxels: From<Vec<T>>,
{
    volume_with(dims, Geometry::default(), voxel)
}

pub fn volume_with<T>(
    dims: [u64; 3],
    geometry: Geometry,
    voxel: impl Fn(f64, f64, f64) -> T,
) -> Volume
where
    Voxels: From<Vec<T>>,
{
    let mut voxels = Vec::new();
    for z in 0..dims[2] {
        for y in 0..dims[1] {
            for x in 0..dims[0] {
                voxels.push(voxel(x as f64, y as f64, z as f64));
            }
        }
    }
    let dims = Dims::new(dims).unwrap();
    Volume::new(
        dims,
        Voxels::from(voxels),
        geometry,
        Rescale::IDENTITY,
        NonFinite::Refuse,
    )
    .unwrap()
}

pub fn octree(volume: &Volume) -> Octree {
    Octree::build(volume, Leaf::default(), &Silent).unwrap()
}

/// Real volumes, below the folder that `ANGIORAY_DATA` names.
pub const ANEURISM: &str = "aneurism_toxi/aneurism.raw.gz";
pub const CT_AVM: &str = "niivue_CT_AVM/CT_AVM.nii.gz";
pub const CHRIS_MRA: &str = "niivue_chris_MRA/chris_MRA.nii.gz";
pub const AORTA: &str = "vmtk_aorta/aorta.mha";
pub const STENT: &str = "stent_npz/stent.npz";

/// One of them; if there is none, says why and returns `None`.
pub fn real_volume(file: &str) -> Option<Volume> {
    let Some(folder) = std::env::var_os("ANGIORAY_DATA").map(PathBuf::from) else {
        eprintln!("skipped: ANGIORAY_DATA does not name a folder of real volumes");
        return None;
    };
    let path = folder.join(file);
    if !path.exists() {
        eprintln!("skipped: there is no {}", path.display());
        return None;
    }
    let mut options = ReadOptions::default();
    if file.ends_with(".raw.gz") {
        options.raw.size = Some("256x256x256".parse().unwrap());
        options.raw.element = Some("u8".parse().unwrap());
    }
    Some(read(&path, &options, &Silent).unwrap())
}

/// The whole volume seen in perspective from an oblique direction.
pub fn camera(volume: &Volume, toward_eye: DVec3) -> Camera {
    let (center, radius_mm) = volume.bounding_sphere();
    let eye = center + toward_eye.normalize() * (radius_mm * 4.0);
    let up = if toward_eye.x == 0.0 && toward_eye.y == 0.0 {
        DVec3::Y
    } else {
        DVec3::Z
    };
    Camera::look_at(eye, center, up, Lens::Perspective { fov_deg: 30.0 }).unwrap()
}

pub const OBLIQUE: DVec3 = DVec3::new(1.0, -2.0, 0.7);

pub fn scene(volume: &Volume, size_px: u32, picture: Picture) -> Scene {
    Scene {
        size: ImageSize::new(size_px, size_px).unwrap(),
        camera: camera(volume, OBLIQUE),
        picture,
        clip_planes: Vec::new(),
        sampling: Sampling {
            method: SamplingMethod::Fixed,
            ..Sampling::default()
        },
        lights: vec![Light::default()],
        ambient_occlusion: None,
        shadows: None,
        depth_of_field: None,
        depth_cues: None,
        gradient: Gradient::default(),
        anti_aliasing: Default::default(),
        sparse: None,
        tone: Tone::default(),
    }
}

/// A hash of three coordinates in 0..1: noise that is the same everywhere.
pub fn hash(x: f64, y: f64, z: f64) -> f64 {
    let n = (x as u64 * 73_856_093) ^ (y as u64 * 19_349_663) ^ (z as u64 * 83_492_791);
    (n.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / (1u64 << 24) as f64
}

/// All planes on the device.
pub fn on_device(device: &Device, volume: &Volume, scenes: &[Scene]) -> Vec<Frame> {
    let octree = octree(volume);
    let mut renderer = Renderer::new(device, volume, &octree, Options::default()).unwrap();
    let frame = |scene| renderer.render(scene, Wanted::ALL).unwrap().frame;
    scenes.iter().map(frame).collect()
}

/// All planes by the reference.
pub fn on_reference(volume: &Volume, scene: &Scene) -> Frame {
    reference::render(volume, scene, Wanted::ALL, &Silent).unwrap()
}

/// A figure of how far a picture is from the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Figure {
    /// Pixels that met another kind of thing, as a share of all.
    Kind,
    /// Voxels of the smallest spacing, over pixels that both hit.
    DepthMean,
    DepthP99,
    /// Degrees.
    NormalMean,
    NormalP99,
    /// Share of the volume's value range.
    ValueMean,
    ValueMax,
    /// Linear light, the largest difference of opacity.
    AlphaMax,
    /// Display, sRGB-encoded 0..1.
    ColorMean,
    ColorP99,
    ColorMax,
}

impl Figure {
    pub fn of(self, reference: &Frame, frame: &Frame, volume: &Volume) -> f64 {
        let voxel_mm = volume.geometry().smallest_spacing_mm();
        let range = volume.range();
        let unit = if range.width() > 0.0 {
            range.width()
        } else {
            range.max.abs().max(1.0)
        };
        let depth = || depth_error(reference, frame, voxel_mm).unwrap();
        let normal = || normal_error(reference, frame).unwrap();
        let value = || value_error(reference, frame, unit).unwrap();
        // Nothing to compare is no error: whether anything was hit is `Kind`'s business.
        match self {
            Self::Kind => {
                differing_pixels(reference, frame) as f64 / reference.size.pixels() as f64
            }
            Self::DepthMean => depth().mean.unwrap_or(0.0),
            Self::DepthP99 => depth().p99.unwrap_or(0.0),
            Self::NormalMean => normal().mean_deg.unwrap_or(0.0),
            Self::NormalP99 => normal().p99_deg.unwrap_or(0.0),
            Self::ValueMean => value().mean.unwrap_or(0.0),
            Self::ValueMax => value().max.unwrap_or(0.0),
            Self::AlphaMax => {
                let alphas = reference.color.iter().zip(&frame.color);
                alphas.fold(0.0, |max, (a, b)| max.max(f64::from((a[3] - b[3]).abs())))
            }
            Self::ColorMean => color_mean(reference, frame),
            Self::ColorP99 => color_error(reference, frame).unwrap().p99,
            Self::ColorMax => color_error(reference, frame).unwrap().max,
        }
    }
}

/// Pixels that met another kind of thing.
pub fn differing_pixels(reference: &Frame, frame: &Frame) -> usize {
    let (reference, frame) = (reference.plane(KIND).unwrap(), frame.plane(KIND).unwrap());
    reference.iter().zip(frame).filter(|(a, b)| a != b).count()
}

fn color_mean(reference: &Frame, frame: &Frame) -> f64 {
    let (reference, frame) = (
        reference.display.as_ref().unwrap(),
        frame.display.as_ref().unwrap(),
    );
    let channels = reference.iter().flatten().zip(frame.iter().flatten());
    let total: f64 = channels.map(|(a, b)| f64::from((a - b).abs())).sum();
    total / (3 * reference.len()) as f64
}

/// The picture moved by one pixel along its rows: what every comparison must see.
pub fn moved_by_a_pixel(frame: &Frame) -> Frame {
    fn moved<T: Copy>(plane: &mut [T], width: usize) {
        plane.chunks_mut(width).for_each(|row| row.rotate_right(1));
    }
    let width = frame.size.width() as usize;
    let mut frame = frame.clone();
    moved(&mut frame.color, width);
    frame.display.iter_mut().for_each(|p| moved(p, width));
    for (_, plane) in frame.layers.iter_mut() {
        match plane {
            Plane::Scalars(plane) => moved(plane, width),
            Plane::Vectors(plane) => moved(plane, width),
            Plane::Counts(plane) => moved(plane, width),
        }
    }
    frame
}

/// That no plane holds a NaN, and only depth infinities.
pub fn assert_sound(what: &str, frame: &Frame) {
    let finite = |name: &str, sound: bool| assert!(sound, "{what}: {name} is not finite");
    let (normals, values) = (frame.plane(NORMAL), frame.plane(VALUE));
    finite("color", frame.color.iter().flatten().all(|v| v.is_finite()));
    finite(
        "display",
        frame
            .display
            .iter()
            .flatten()
            .flatten()
            .all(|v| v.is_finite()),
    );
    finite(
        "normal",
        normals
            .into_iter()
            .flatten()
            .flatten()
            .all(|v| v.is_finite()),
    );
    finite("value", values.into_iter().flatten().all(|v| v.is_finite()));
    let mut depths = frame.plane(DEPTH).into_iter().flatten();
    assert!(
        depths.all(|d| *d >= 0.0),
        "{what}: a depth is NaN or negative"
    );
    let mut alphas = frame.color.iter().map(|c| c[3]);
    assert!(
        alphas.all(|a| (0.0..=1.0).contains(&a)),
        "{what}: an opacity is not in 0..1"
    );
}

/// Copies the kernels' sources below a folder, so that `ANGIORAY_KERNELS` may name it.
pub fn copy_kernels(folder: &Path) {
    let kernels = Path::new(env!("CARGO_MANIFEST_DIR")).join("kernels");
    for file in angioray::gpu::files() {
        let copy = folder.join(file);
        std::fs::create_dir_all(copy.parent().unwrap()).unwrap();
        std::fs::copy(kernels.join(file), copy).unwrap();
    }
}
