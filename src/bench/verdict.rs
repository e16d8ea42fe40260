//! One ray's answer held against the reference's.

use glam::DVec3;

use crate::error::Result;
use crate::frame::Kind;
use crate::reference::{Sight, Tracer};
use crate::scene::{Ray, Scene};
use crate::volume::Volume;

/// What a renderer says that a ray meets first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Met {
    pub kind: Kind,
    /// mm from the ray's origin; +∞: nothing.
    pub depth_mm: f64,
}

impl From<&Sight> for Met {
    fn from(sight: &Sight) -> Self {
        Self {
            kind: sight.kind,
            depth_mm: sight.depth_mm,
        }
    }
}

/// What an answer is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// The reference's answer, at a distance from it of so many voxels along the ray.
    Agrees { apart: f64 },
    /// Another answer, but the reference's own of a ray within [`Judge::NEAR_VOXELS`]: the ray is
    /// that near to a tangent of the surface, or begins that near to it.
    Borderline,
    /// The reference hits, the answer is nothing.
    Missed,
    /// The reference meets nothing, the answer is a hit.
    Extra,
    /// Both hit, but different things or not at the same place: so many voxels apart.
    Displaced { apart: f64 },
}

/// Judges answers for the rays of one volume and one surface.
pub struct Judge<'a> {
    tracer: Tracer<'a>,
    voxel_mm: f64,
}

impl<'a> Judge<'a> {
    /// How near to a tangent a ray may be for its answer to be anyone's, in voxels of the smallest
    /// spacing.
    pub const NEAR_VOXELS: f64 = 1e-4;
    /// The farthest that two equal answers may be apart, in voxels of the smallest spacing.
    pub const APART_VOXELS: f64 = 1e-3;

    /// # Errors
    /// As [`Tracer::new`].
    pub fn new(volume: &'a Volume, scene: &'a Scene) -> Result<Self> {
        Ok(Self {
            tracer: Tracer::new(volume, scene)?,
            voxel_mm: volume.geometry().smallest_spacing_mm(),
        })
    }

    /// The reference's own answer.
    pub fn truth(&self, ray: Ray) -> Met {
        Met::from(&self.tracer.cast(ray))
    }

    /// `resolution_mm` is what the answer's own depth tells apart. The ray's direction need not be
    /// of unit length: depths are in its lengths.
    pub fn verdict(&self, ray: Ray, met: Met, resolution_mm: f64) -> Verdict {
        let truth = self.truth(ray);
        let voxel = self.voxel_mm / ray.dir_world.length();
        let most = Self::APART_VOXELS + resolution_mm / voxel;
        let apart = |truth: Met| match (truth.kind, met.kind) {
            (Kind::Nothing, Kind::Nothing) => Some(0.0),
            (a, b) if a == b => Some((truth.depth_mm - met.depth_mm).abs() / voxel),
            _ => None,
        };
        match apart(truth) {
            Some(apart) if apart <= most => return Verdict::Agrees { apart },
            _ => {}
        }
        let likewise = |near: Met| apart(near).is_some_and(|apart| apart <= 2.0 * most);
        if self.neighbours(ray).any(|near| likewise(self.truth(near))) {
            return Verdict::Borderline;
        }
        match (truth.kind, met.kind) {
            (_, Kind::Nothing) => Verdict::Missed,
            (Kind::Nothing, _) => Verdict::Extra,
            _ => Verdict::Displaced {
                apart: apart(truth).unwrap_or(f64::INFINITY),
            },
        }
    }

    /// The rays moved by [`Judge::NEAR_VOXELS`]: in eight directions sideways, and along themselves.
    fn neighbours(&self, ray: Ray) -> impl Iterator<Item = Ray> {
        let along = ray.dir_world.normalize();
        let side = along.any_orthonormal_vector();
        let other = along.cross(side);
        let near_mm = Self::NEAR_VOXELS * self.voxel_mm;
        let around = (0..8).map(move |eighth| {
            let (sin, cos) = (f64::from(eighth) * std::f64::consts::FRAC_PI_4).sin_cos();
            side * cos + other * sin
        });
        around
            .chain([along, -along])
            .map(move |way: DVec3| Ray {
                origin_world: ray.origin_world + way * near_mm,
                ..ray
            })
    }
}
