//! One ray's answer held against the reference's.

use std::f64::consts::FRAC_PI_4;

use glam::DVec3;

use crate::error::Result;
use crate::frame::Kind;
use crate::reference::{Sight, Tracer};
use crate::scene::{Picture, Ray, Scene};
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
    /// Another answer, but the reference's own of a ray moved by at most [`Judge::NEAR_VOXELS`], or
    /// of the iso value that the field has so far away or within [`Judge::NEAR_VALUE`]: the ray is
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
    volume: &'a Volume,
    scene: &'a Scene,
    tracer: Tracer<'a>,
    voxel_mm: f64,
}

impl<'a> Judge<'a> {
    /// How near to a tangent a ray may be for its answer to be anyone's, in voxels of the smallest
    /// spacing.
    pub const NEAR_VOXELS: f64 = 1e-4;
    /// The farthest that two equal answers may be apart, in voxels of the smallest spacing.
    pub const APART_VOXELS: f64 = 1e-3;
    /// How near to the iso value the field may come for either answer to be right, as a share of the
    /// value range: what single precision leaves of a field's value.
    pub const NEAR_VALUE: f64 = 2e-6;

    /// # Errors
    /// As [`Tracer::new`].
    pub fn new(volume: &'a Volume, scene: &'a Scene) -> Result<Self> {
        Ok(Self {
            volume,
            scene,
            tracer: Tracer::new(volume, scene)?,
            voxel_mm: volume.geometry().smallest_spacing_mm(),
        })
    }

    /// The reference's own answer.
    pub fn truth(&self, ray: Ray) -> Met {
        Met::from(&self.tracer.cast(ray))
    }

    /// Whether the reference's answer is not itself decided by its rounding: a hit or none also for
    /// iso values a few of its last digits away.
    pub fn is_certain(&self, ray: Ray, truth: Met) -> bool {
        let near = 1e-12 * self.volume.range().width();
        [-near, near].into_iter().all(|iso| {
            let off = Off {
                by: DVec3::ZERO,
                iso,
            };
            (self.seen(ray, off).kind == Kind::Nothing) == (truth.kind == Kind::Nothing)
        })
    }

    /// Of an answer that differs from the `truth` of its ray, or not. `resolution_mm` is what the
    /// answer's own depth tells apart. The ray's direction need not be of unit length: depths are in
    /// its lengths.
    pub fn verdict(&self, ray: Ray, truth: Met, met: Met, resolution_mm: f64) -> Verdict {
        let voxel = self.voxel_mm / ray.dir_world.length();
        let most = Self::APART_VOXELS + resolution_mm / voxel;
        match apart(truth, met, voxel) {
            Some(apart) if apart <= most => return Verdict::Agrees { apart },
            _ => {}
        }
        // Where two surfaces touch several may follow each other.
        const MOST_TOUCHES: u32 = 4;
        if self.is_borderline(ray, truth, met, 5.0 * most, MOST_TOUCHES) {
            return Verdict::Borderline;
        }
        match (truth.kind, met.kind) {
            (_, Kind::Nothing) => Verdict::Missed,
            (Kind::Nothing, _) => Verdict::Extra,
            _ => Verdict::Displaced {
                apart: apart(truth, met, voxel).unwrap_or(f64::INFINITY),
            },
        }
    }

    /// Whether the reference answers like `met`, to within `most` voxels, for a ray and an iso value
    /// so near that they are no others.
    fn is_borderline(&self, ray: Ray, truth: Met, met: Met, most: f64, touches: u32) -> bool {
        let voxel = self.voxel_mm / ray.dir_world.length();
        let likewise = |other: Met| apart(other, met, voxel).is_some_and(|apart| apart <= most);
        let first_mm = truth.depth_mm.min(met.depth_mm);
        let iso_off = self.iso_off(ray, first_mm);
        if met.kind == Kind::Surface
            && met.depth_mm <= truth.depth_mm
            && self.is_near(ray, met.depth_mm)
        {
            return true;
        }
        let here = Off {
            by: DVec3::ZERO,
            iso: 0.0,
        };
        // The nearest answers before and behind, nothing being behind all.
        let mut before: Option<(Off, Met)> = None;
        let mut behind: Option<(Off, Met)> = None;
        // Whether near rays pass the truth's place.
        let mut passes = false;
        for by in self.moves(ray) {
            for iso in [0.0, -iso_off, iso_off] {
                let off = Off { by, iso };
                let near = if off == here {
                    truth
                } else {
                    self.seen(ray, off)
                };
                if likewise(near) {
                    return true;
                }
                passes |= near.depth_mm > truth.depth_mm + most * voxel || near.kind != truth.kind;
                let nearest = if near.depth_mm < met.depth_mm {
                    &mut before
                } else {
                    &mut behind
                };
                let is_nearer = nearest.is_none_or(|(_, other)| {
                    (near.depth_mm - met.depth_mm).abs() < (other.depth_mm - met.depth_mm).abs()
                });
                if is_nearer {
                    *nearest = Some((off, near));
                }
            }
        }
        // Between them the answer is somewhere met, unless the depth jumps there.
        if let (Some((mut low, _)), Some((mut high, _))) = (before, behind) {
            for _ in 0..60 {
                let middle = low.middle(high);
                let near = self.seen(ray, middle);
                if likewise(near) {
                    return true;
                }
                if near.depth_mm < met.depth_mm {
                    low = middle;
                } else {
                    high = middle;
                }
            }
        }
        // A cap where the surface is, too.
        let at_once = (truth.depth_mm - met.depth_mm).abs() <= most * voxel;
        if at_once && passes {
            return true;
        }
        // The truth only touches where it hits: what lies behind decides.
        if touches == 0 || !passes || truth.depth_mm >= met.depth_mm {
            return false;
        }
        let on_mm = truth.depth_mm + 2.0 * most * voxel;
        let rest = Ray {
            origin_world: ray.origin_world + ray.dir_world * on_mm,
            ..ray
        };
        let met = Met {
            depth_mm: met.depth_mm - on_mm,
            ..met
        };
        let truth = self.truth(rest);
        apart(truth, met, voxel).is_some_and(|apart| apart <= most)
            || self.is_borderline(rest, truth, met, most, touches - 1)
    }

    /// The reference's answer for a ray and an iso value moved a little.
    fn seen(&self, ray: Ray, off: Off) -> Met {
        let ray = Ray {
            origin_world: ray.origin_world + off.by,
            ..ray
        };
        if off.iso == 0.0 {
            return self.truth(ray);
        }
        let mut scene = self.scene.clone();
        if let Picture::Surface { iso, .. } = &mut scene.picture {
            *iso += off.iso;
        }
        // `new` has seen that a tracer can be made.
        Tracer::new(self.volume, &scene)
            .map_or(self.truth(ray), |tracer| Met::from(&tracer.cast(ray)))
    }

    /// Moves of a ray by [`Judge::NEAR_VOXELS`]: none, in eight directions sideways, and along
    /// itself.
    fn moves(&self, ray: Ray) -> impl Iterator<Item = DVec3> {
        let along = ray.dir_world.normalize();
        let side = along.any_orthonormal_vector();
        let other = along.cross(side);
        let near_mm = Self::NEAR_VOXELS * self.voxel_mm;
        let around = (0..8).map(move |eighth| {
            let (sin, cos) = (f64::from(eighth) * FRAC_PI_4).sin_cos();
            side * cos + other * sin
        });
        let all = [DVec3::ZERO]
            .into_iter()
            .chain(around)
            .chain([along, -along]);
        all.map(move |way| way * near_mm)
    }

    /// Whether the field at a place of the ray is so near to the iso value that the surface is
    /// within [`Judge::NEAR_VOXELS`].
    fn is_near(&self, ray: Ray, depth_mm: f64) -> bool {
        let Picture::Surface { iso, .. } = self.scene.picture else {
            return false;
        };
        let p = self.index_point(ray, depth_mm);
        let low = p.floor();
        let f = p - low;
        let mut field = 0.0;
        for corner in 0..8 {
            let at = [0, 1, 2].map(|axis| corner >> axis & 1);
            let weights = [0, 1, 2].map(|axis| {
                if at[axis] == 1 {
                    f[axis]
                } else {
                    1.0 - f[axis]
                }
            });
            field += self.value_at(low, at) * weights.iter().product::<f64>();
        }
        (field - iso).abs() <= self.iso_off(ray, depth_mm)
    }

    /// How much the field changes in [`Judge::NEAR_VOXELS`] about a place of the ray, or
    /// [`Judge::NEAR_VALUE`]. Physical.
    fn iso_off(&self, ray: Ray, depth_mm: f64) -> f64 {
        let least = Self::NEAR_VALUE * self.volume.range().width();
        if !depth_mm.is_finite() {
            return least;
        }
        let low = self.index_point(ray, depth_mm).floor();
        // The largest difference of two voxels side by side.
        let mut steepest: f64 = 0.0;
        for corner in 0..64 {
            let at = [corner % 4 - 1, corner / 4 % 4 - 1, corner / 16 - 1];
            for axis in 0..3 {
                let mut next = at;
                next[axis] += 1;
                let difference = self.value_at(low, at) - self.value_at(low, next);
                steepest = steepest.max(difference.abs());
            }
        }
        least.max(Self::NEAR_VOXELS * steepest)
    }

    fn index_point(&self, ray: Ray, depth_mm: f64) -> DVec3 {
        let p_world = ray.origin_world + ray.dir_world * depth_mm;
        self.volume
            .geometry()
            .index_from_world()
            .transform_point3(p_world)
    }

    /// The physical value of the voxel `step` from `low`, or of the nearest one that there is.
    fn value_at(&self, low: DVec3, step: [i64; 3]) -> f64 {
        let n = self.volume.dims().usize();
        let side = |axis: usize| {
            let at = low[axis] as i64 + step[axis];
            at.clamp(0, n[axis] as i64 - 1) as usize
        };
        let index = side(0) + n[0] * (side(1) + n[1] * side(2));
        self.volume
            .rescale()
            .physical(self.volume.voxels().stored(index))
    }
}

/// A small change of a ray and of the iso value.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Off {
    /// World space, mm.
    by: DVec3,
    /// Physical.
    iso: f64,
}

impl Off {
    fn middle(self, other: Self) -> Self {
        Self {
            by: (self.by + other.by) * 0.5,
            iso: (self.iso + other.iso) * 0.5,
        }
    }
}

/// How far two answers are apart, in voxels along a ray of which a voxel is so long; `None` where
/// they are of different kinds.
fn apart(a: Met, b: Met, voxel: f64) -> Option<f64> {
    match (a.kind, b.kind) {
        (Kind::Nothing, Kind::Nothing) => Some(0.0),
        (one, other) if one == other => Some((a.depth_mm - b.depth_mm).abs() / voxel),
        _ => None,
    }
}
