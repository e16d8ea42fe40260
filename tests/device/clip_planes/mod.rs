//! Clip planes, by the reference and on the device: what is kept, where it begins, and how it is
//! capped, against closed forms and a test of points.

use crate::common;

mod caps;
mod points;
mod special;
mod volumes;

use angioray::extent::ImageSize;
use angioray::frame::{DEPTH, Frame};
use angioray::gpu::Device;
use angioray::scene::{
    Camera, ClipPlane, Emission, Knot, Lens, Picture, Projection, Refine, Rgb, SamplingMethod,
    Scene, Termination, TransferFunction, Window,
};
use angioray::volume::{Geometry, Volume};
use common::{on_device, on_reference, volume_with};
use glam::{DMat3, DQuat, DVec3};

/// What renders, and how far its depths (voxels) may be from the expected ones.
struct Engine {
    name: &'static str,
    device: Option<Device>,
    /// On the device, of surfaces and projections.
    method: SamplingMethod,
    depth_voxels: f64,
}

/// The reference, and the device where there is one.
fn engines() -> Vec<Engine> {
    let reference = Engine {
        name: "reference",
        device: None,
        method: SamplingMethod::Exact,
        // Planes hold single precision.
        depth_voxels: 1e-5,
    };
    let on_device = |(name, method)| {
        common::device().map(|device| Engine {
            name,
            device: Some(device),
            method,
            depth_voxels: 2e-4,
        })
    };
    let on_device = [
        ("fixed steps", SamplingMethod::Fixed),
        ("exact", SamplingMethod::Exact),
    ]
    .into_iter()
    .filter_map(on_device);
    std::iter::once(reference).chain(on_device).collect()
}

impl Engine {
    fn frames(&self, volume: &Volume, scenes: &[Scene]) -> Vec<Frame> {
        match &self.device {
            None => scenes.iter().map(|s| on_reference(volume, s)).collect(),
            Some(device) => {
                let mut scenes = scenes.to_vec();
                for scene in &mut scenes {
                    if !matches!(scene.picture, Picture::Emission(_)) {
                        scene.sampling.method = self.method;
                    }
                }
                on_device(device, volume, &scenes)
            }
        }
    }
}

/// Every voxel 200: an interval begins where its maximum is first reached, and its length is its
/// optical depth.
fn uniform(dims: [u64; 3], geometry: Geometry) -> Volume {
    volume_with(dims, geometry, |_, _, _| 200u8)
}

/// 11 x 9 x 6 voxels of three spacings, turned about no axis of the grid, about `center_world`.
fn oblique(center_world: DVec3) -> Volume {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.7);
    let at = |origin| {
        let spacing_mm = DVec3::new(0.8, 1.0, 2.5);
        let geometry = Geometry::new(origin, DMat3::from_quat(turn), spacing_mm).unwrap();
        uniform([11, 9, 6], geometry)
    };
    let (center, _) = at(DVec3::ZERO).bounding_sphere();
    at(center_world - center)
}

fn maximum() -> Picture {
    Picture::Projection {
        of: Projection::Maximum,
        window: Window::new(0.0, 255.0).unwrap(),
    }
}

const ABSORPTION_PER_MM: f64 = 0.05;

/// A medium whose optical depth is [`ABSORPTION_PER_MM`] times the length of path.
fn medium() -> Picture {
    let knot = Knot {
        value: 100.0,
        color: Rgb([1.0; 3]),
        opacity: -(-ABSORPTION_PER_MM).exp_m1(),
    };
    Picture::Emission(Emission {
        termination: Termination::NEVER,
        ..Emission::of(TransferFunction::new(vec![knot], 1.0).unwrap())
    })
}

/// A surface at 100: with caps, the interval's beginning; without, nothing.
fn surface(caps: bool) -> Picture {
    Picture::Surface {
        iso: 100.0,
        caps,
        refine: Refine::default(),
        color: Rgb([0.8; 3]),
        phong: None,
    }
}

fn plane(normal_world: DVec3, offset: f64) -> ClipPlane {
    ClipPlane::new(normal_world, offset).unwrap()
}

/// Keeps the side of `point` toward which `normal` points.
fn plane_at(point_world: DVec3, normal_world: DVec3) -> ClipPlane {
    plane(normal_world, -normal_world.dot(point_world))
}

/// `size_px` pixels of `height_mm` in all, looking along +y at `target`, x to the right.
fn straight(target: DVec3, size_px: u32, height_mm: f64) -> (Camera, ImageSize) {
    let lens = Lens::Orthographic { height_mm };
    let eye = target - DVec3::Y * 100.0;
    let camera = Camera::look_at(eye, target, DVec3::Z, lens).unwrap();
    (camera, ImageSize::new(size_px, size_px).unwrap())
}

fn scene(
    volume: &Volume,
    picture: Picture,
    (camera, size): (Camera, ImageSize),
    planes: &[ClipPlane],
) -> Scene {
    Scene {
        camera,
        size,
        clip_planes: planes.to_vec(),
        ..common::scene(volume, 1, picture)
    }
}

/// Length of each ray's interval, from the opacity of [`medium`].
fn lengths_mm(frame: &Frame) -> impl Iterator<Item = f64> {
    let alphas = frame.color.iter().map(|c| f64::from(c[3]));
    alphas.map(|alpha| -(-alpha).ln_1p() / ABSORPTION_PER_MM)
}

fn depths_mm(frame: &Frame) -> Vec<f64> {
    frame
        .plane(DEPTH)
        .into_iter()
        .flatten()
        .map(|&d| d.into())
        .collect()
}

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1u64 << 53) as f64)
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::from_array([(); 3].map(|()| self.within(-1.0, 1.0)));
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
}
