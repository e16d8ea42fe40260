//! A camera path: the camera turned about an axis through its target, frame after frame.

use std::str::FromStr;

use glam::DVec3;

use super::Camera;
use crate::error::{Error, Result};
use crate::number_text::numbers;

/// The axis of an orbit: a line through the camera's target (`--axis`).
///
/// The camera's own up is how 3D Slicer spins a view (its yaw) and what ParaView's orbit takes for
/// its normal; it is never the line of sight. World z is the patient's long axis, about which a
/// C-arm turns: where the eye is raised it stays as high, and the patient upright.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum OrbitAxis {
    /// The axis points up in the first frame's picture, at a right angle to its line of sight.
    #[default]
    Up,
    /// The axis points to the right in the first frame's picture.
    Right,
    /// A unit direction in world space (LPS).
    World(DVec3),
}

impl FromStr for OrbitAxis {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text.trim().to_ascii_lowercase().as_str() {
            "up" => return Ok(Self::Up),
            "right" => return Ok(Self::Right),
            "x" => return Ok(Self::World(DVec3::X)),
            "y" => return Ok(Self::World(DVec3::Y)),
            "z" => return Ok(Self::World(DVec3::Z)),
            _ => {}
        }
        let direction = numbers(text).map(DVec3::from_array);
        let unit = direction.and_then(DVec3::try_normalize);
        unit.map(Self::World).ok_or_else(|| {
            Error::usage(format!(
                "'{text}' is not an axis: write up, right, x, y, z, or a direction x,y,z in world space"
            ))
        })
    }
}

/// How many frames a path has (`--frames`): from 1 to [`FrameCount::MAX`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameCount(u32);

impl FrameCount {
    /// Nine hours at 30 a second.
    pub const MAX: u32 = 1_000_000;

    /// Makes a number of frames.
    ///
    /// # Errors
    /// No frames, or more than [`Self::MAX`] (usage).
    pub fn new(frames: u32) -> Result<Self> {
        if (1..=Self::MAX).contains(&frames) {
            return Ok(Self(frames));
        }
        Err(Error::usage(format!(
            "an orbit of {frames} frames: there must be 1 to {}",
            Self::MAX
        )))
    }

    /// The number of frames.
    pub fn get(self) -> u32 {
        self.0
    }
}

impl FromStr for FrameCount {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let frames = text.trim().parse().map_err(|_| {
            Error::usage(format!(
                "'{text}' is not a number of frames: there must be 1 to {}",
                Self::MAX
            ))
        })?;
        Self::new(frames)
    }
}

/// Cameras all around a scene: that of frame k of N is turned by k·degrees/N, so that a whole turn closes
/// without a repeated frame.
///
/// Turning is right-handed: about the camera's up the eye moves to the picture's right when
/// positive, as with `--azimuth`.
#[derive(Debug, Clone)]
pub struct Orbit {
    first: Camera,
    axis: DVec3,
    degrees: f64,
    frames: FrameCount,
}

impl Orbit {
    /// Constructs an orbit around the target of `first`, which is the camera of frame 0; over all `frames`
    /// it turns by `degrees`.
    ///
    /// # Errors
    /// Usage: an angle that is not finite.
    pub fn new(first: Camera, axis: OrbitAxis, degrees: f64, frames: FrameCount) -> Result<Self> {
        if !degrees.is_finite() {
            return Err(Error::usage("an orbit's angle must be finite"));
        }
        let axis = match axis {
            OrbitAxis::Up => first.up(),
            OrbitAxis::Right => first.right(),
            OrbitAxis::World(direction) => direction,
        };
        Ok(Self {
            first,
            axis,
            degrees,
            frames,
        })
    }

    /// Returns how many frames there are, numbered from 0.
    pub fn frames(&self) -> u32 {
        self.frames.get()
    }

    /// Returns the unit direction, world space, about which the camera turns.
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// Returns by how much a frame is turned; frame `frames()`, which is not part of the orbit, by all of
    /// its degrees.
    pub fn degrees_at(&self, frame: u32) -> f64 {
        f64::from(frame) * self.degrees / f64::from(self.frames())
    }

    /// Returns the camera of a frame: the one that looks from the turned eye at the same target.
    pub fn camera(&self, frame: u32) -> Camera {
        let target = self.first.target_world();
        let turned = self.first.turned(self.axis, target, self.degrees_at(frame));
        // A whole turn is no turn, to the last bit.
        if turned == self.first {
            return turned;
        }
        let anew = Camera::look_at(turned.eye_world(), target, turned.up(), turned.lens());
        // What is a camera stays one when it is turned.
        anew.unwrap_or(turned)
    }
}
