//! What the tests that need an OpenCL device share.
#![allow(dead_code)] // each test program uses its own part

use angioray::extent::{Dims, ImageSize};
use angioray::gpu::Device;
use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::scene::{Camera, Lens, Light, Picture, Sampling, Scene, Tone};
use angioray::volume::{Geometry, NonFinite, Rescale, Volume, Voxels};
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
        sampling: Sampling::default(),
        light: Light::default(),
        tone: Tone::default(),
    }
}
