//! The spans of depths that a picture's rays spend inside the surface, and the camera that sees them.

use crate::error::Result;
use crate::gpu::{Args, Buffer, Device, Group};
use crate::scene::Camera;

use super::rays::RaySource;

/// Of each pixel the depths at which its ray enters the surface and leaves it, mm along the view axis from the base plane; 0
/// and −1 where it meets nothing (`kernels/pass/thickness.cl`).
pub struct Spans {
    /// The depths.
    pub depths: Buffer<[f32; 2]>,
    /// How the picture's rays run.
    pub screen: Screen,
}

/// How a picture's rays run: its axes, and how far neighbouring rays are from each other.
#[derive(Debug, Clone, Copy)]
pub struct Screen {
    /// The unit direction along the rows, world space.
    pub right: [f32; 4],
    /// The unit direction down the columns, world space.
    pub down: [f32; 4],
    /// The view axis, world space.
    pub forward: [f32; 4],
    /// The distance of neighbouring rays across the view axis, mm, at the base plane and its growth per mm.
    pub px: [f32; 2],
}

impl Screen {
    /// The screen of a camera whose neighbouring rays are that far from each other.
    pub fn of(camera: &Camera, px: [f32; 2]) -> Self {
        let axis = |v: glam::DVec3| [v.x as f32, v.y as f32, v.z as f32, 0.0];
        Self {
            right: axis(camera.right()),
            down: axis(-camera.up()),
            forward: axis(camera.forward()),
            px,
        }
    }
}

impl Group for &Screen {
    fn add_to(self, args: Args) -> Args {
        args.value("right", &self.right)
            .value("down", &self.down)
            .value("px", &self.px)
    }
}

impl Spans {
    /// Room for the spans of a picture.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(device: &Device, rays: &RaySource, screen: Screen) -> Result<Self> {
        Ok(Self {
            depths: rays.plane(device, "spans of depths", [0.0, -1.0])?,
            screen,
        })
    }
}
