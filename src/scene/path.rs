//! A camera path: the camera turned about an axis through its target, frame after frame.

use std::str::FromStr;

use glam::DVec3;

use super::options::plain::readable;
use super::options::{Resolved, Triple};
use crate::error::{Error, Result};

/// What an orbit turns about: a line through the camera's target (`--axis`).
///
/// The camera's own up is how 3D Slicer spins a view (its yaw) and what ParaView's orbit takes for
/// its normal; it is never the line of sight. World z is the patient's long axis, about which a
/// C-arm turns: where the eye is raised it stays as high, and the patient upright.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum OrbitAxis {
    /// Up in the first frame's picture, at a right angle to its line of sight.
    #[default]
    Up,
    /// To the right in the first frame's picture.
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
        let direction = text.parse::<Triple>().ok().map(|Triple(d)| d);
        let unit = direction.and_then(DVec3::try_normalize);
        unit.map(Self::World).ok_or_else(|| {
            Error::usage(format!(
                "'{text}' is not an axis: write up, right, x, y, z, or a direction x,y,z in world space"
            ))
        })
    }
}

readable!(OrbitAxis);

/// How many frames a path has (`--frames`): from 1 to [`FrameCount::MOST`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameCount(u32);

impl FrameCount {
    /// Nine hours at 30 a second.
    pub const MOST: u32 = 1_000_000;

    /// # Errors
    /// No frames, or more than [`Self::MOST`] (usage).
    pub fn new(frames: u32) -> Result<Self> {
        if (1..=Self::MOST).contains(&frames) {
            return Ok(Self(frames));
        }
        Err(Error::usage(format!(
            "an orbit of {frames} frames: there must be 1 to {}",
            Self::MOST
        )))
    }

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
                Self::MOST
            ))
        })?;
        Self::new(frames)
    }
}

readable!(FrameCount);

/// A scene seen from all around: frame k of N is turned by k·degrees/N, so that a whole turn closes
/// without a repeated frame.
///
/// Turning is right-handed: about the camera's up the eye moves to the picture's right when
/// positive, as with `--azimuth`.
#[derive(Debug, Clone)]
pub struct Orbit {
    /// Frame 0.
    first: Resolved,
    axis: DVec3,
    degrees: f64,
    frames: FrameCount,
}

impl Orbit {
    /// Around the target of `first`, which is frame 0; the camera of all `frames` of them would have
    /// turned by `degrees`.
    ///
    /// # Errors
    /// An angle that is not finite (usage).
    pub fn new(first: Resolved, axis: OrbitAxis, degrees: f64, frames: FrameCount) -> Result<Self> {
        if !degrees.is_finite() {
            return Err(Error::usage("an orbit's angle must be finite"));
        }
        let camera = &first.scene.camera;
        let axis = match axis {
            OrbitAxis::Up => camera.up(),
            OrbitAxis::Right => camera.right(),
            OrbitAxis::World(direction) => direction,
        };
        Ok(Self {
            first,
            axis,
            degrees,
            frames,
        })
    }

    /// How many frames it has, numbered from 0.
    pub fn frames(&self) -> u32 {
        self.frames.get()
    }

    /// Unit, world space.
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// By how much a frame is turned; frame `frames()`, which is not part of the orbit, by all of
    /// its degrees.
    pub fn degrees_at(&self, frame: u32) -> f64 {
        f64::from(frame) * self.degrees / f64::from(self.frames())
    }

    /// The scene as a frame sees it, everything but the eye and its up as in the first: what
    /// rendering with this eye and up would make.
    ///
    /// # Errors
    /// None, for what is a camera stays one when it is turned.
    pub fn at(&self, frame: u32) -> Result<Resolved> {
        let mut seen = self.first.clone();
        let options = &mut seen.options.camera;
        let Some(Triple(target)) = options.target else {
            return Ok(seen);
        };
        let first = self.first.scene.camera;
        let turned = first.turned(self.axis, target, self.degrees_at(frame));
        // A whole turn leaves the options as they are too, to the last bit.
        if turned != first {
            options.eye = Some(Triple(turned.eye_world()));
            options.up = Some(Triple(turned.up()));
            seen.scene.camera = options.camera()?;
        }
        Ok(seen)
    }
}
