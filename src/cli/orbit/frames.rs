//! The frames of an orbit: the scene of the first, seen by each one's camera.

use crate::error::Result;
use crate::options::Resolved;
use crate::scene::Orbit;

use super::plan::Plan;

/// The scene of an orbit and the cameras from which it is seen.
pub struct Frames {
    first: Resolved,
    pub orbit: Orbit,
}

impl Frames {
    /// The frames that a plan makes of the first one.
    ///
    /// # Errors
    /// As [`Orbit::new`].
    pub fn new(first: Resolved, plan: &Plan) -> Result<Self> {
        let orbit = Orbit::new(first.scene.camera, plan.axis, plan.degrees, plan.frames)?;
        Ok(Self { first, orbit })
    }

    /// The first frame.
    pub fn first(&self) -> &Resolved {
        &self.first
    }

    /// A frame: what rendering with its eye, its up and its jitter would make.
    pub fn at(&self, frame: u32) -> Resolved {
        let seen = self.first.seen_by(self.orbit.camera(frame));
        seen.frames_later(frame)
    }
}
