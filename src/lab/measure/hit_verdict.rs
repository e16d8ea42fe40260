//! Whether what a renderer says that a ray hits is right, by the reference.

use std::f64::consts::FRAC_PI_4;

use glam::DVec3;

use crate::error::Result;
use crate::frame::Kind;
use crate::reference::{RayResult, Tracer};
use crate::scene::{Picture, Ray, Scene};
use crate::volume::Volume;

/// A renderer's answer: the first thing that a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// What the ray meets: a surface, a cap, or nothing.
    pub kind: Kind,
    /// Distance from the ray's origin, mm; +∞: nothing.
    pub depth_mm: f64,
}

impl From<&RayResult> for Answer {
    fn from(result: &RayResult) -> Self {
        Self {
            kind: result.kind,
            depth_mm: result.depth_mm,
        }
    }
}

/// How an answer compares with the reference's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HitVerdict {
    /// The answer is the reference's, to within [`HitChecker::APART_VOXELS`].
    Agrees {
        /// The distance of the two along the ray, in voxels of the smallest spacing.
        apart: f64,
    },
    /// Another answer, but the reference's own of a ray moved by at most [`HitChecker::NEAR_VOXELS`], or
    /// of the iso value that the field has so far away or within [`HitChecker::NEAR_VALUE`]: the ray is
    /// that near to a tangent of the surface, or begins that near to it.
    Borderline,
    /// The reference hits, the answer is nothing.
    Missed,
    /// The reference meets nothing, the answer is a hit.
    Extra,
    /// Both hit, but different things or not at the same place.
    Displaced {
        /// The distance of the two along the ray, in voxels of the smallest spacing; +∞ for different things.
        apart: f64,
    },
}

/// Gives verdicts on the answers for rays of one volume and one surface.
pub struct HitChecker<'a> {
    volume: &'a Volume,
    scene: &'a Scene,
    tracer: Tracer<'a>,
    voxel_mm: f64,
}

impl<'a> HitChecker<'a> {
    /// How near to a tangent a ray may be for either answer to be right, in voxels of the smallest
    /// spacing.
    pub const NEAR_VOXELS: f64 = 1e-4;
    /// The farthest that two equal answers may be apart, in voxels of the smallest spacing.
    pub const APART_VOXELS: f64 = 1e-3;
    /// How near to the iso value the field may come for either answer to be right, as a share of the
    /// value range: what single precision leaves of a field's value.
    pub const NEAR_VALUE: f64 = 2e-6;

    /// Prepares the reference for a scene.
    ///
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

    /// The reference's answer for a ray.
    pub fn reference(&self, ray: Ray) -> Answer {
        Answer::from(&self.tracer.cast(ray))
    }

    /// Whether the reference's answer does not hang on its own rounding: a hit, or none, also for
    /// iso values a few of its last digits away.
    pub fn is_certain(&self, ray: Ray, reference: Answer) -> bool {
        let near = 1e-12 * self.volume.range().width();
        [-near, near].into_iter().all(|iso| {
            let off = Off { iso, ..Off::NONE };
            (self.seen(ray, off).kind == Kind::Nothing) == (reference.kind == Kind::Nothing)
        })
    }

    /// The verdict on an `answer`, `reference` being the reference's. `resolution_mm` is the
    /// resolution of the answer's depth. The ray's direction need not be of unit length: depths are
    /// in its lengths.
    pub fn verdict(
        &self,
        ray: Ray,
        reference: Answer,
        answer: Answer,
        resolution_mm: f64,
    ) -> HitVerdict {
        let voxel = self.voxel_mm / ray.dir_world.length();
        let max_apart = Self::APART_VOXELS + resolution_mm / voxel;
        match apart(reference, answer, voxel) {
            Some(apart) if apart <= max_apart => return HitVerdict::Agrees { apart },
            _ => {}
        }
        // Where two surfaces touch several may follow each other.
        const MAX_TOUCHES: u32 = 4;
        if self.is_borderline(ray, reference, answer, 5.0 * max_apart, MAX_TOUCHES) {
            return HitVerdict::Borderline;
        }
        match (reference.kind, answer.kind) {
            (_, Kind::Nothing) => HitVerdict::Missed,
            (Kind::Nothing, _) => HitVerdict::Extra,
            _ => HitVerdict::Displaced {
                apart: apart(reference, answer, voxel).unwrap_or(f64::INFINITY),
            },
        }
    }

    /// Whether the reference gives `answer`, to within `max_apart` voxels, for a ray and an iso value
    /// so near that they cannot be distinguished from these.
    fn is_borderline(
        &self,
        ray: Ray,
        reference: Answer,
        answer: Answer,
        max_apart: f64,
        touches: u32,
    ) -> bool {
        let voxel = self.voxel_mm / ray.dir_world.length();
        if answer.kind == Kind::Surface
            && answer.depth_mm <= reference.depth_mm
            && self.is_near(ray, answer.depth_mm)
        {
            return true;
        }
        let agrees = |other: Answer| apart(other, answer, voxel).is_some_and(|by| by <= max_apart);
        let is_past = |other: Answer| {
            other.depth_mm > reference.depth_mm + max_apart * voxel || other.kind != reference.kind
        };
        let Some(nearby) = self.nearby(ray, reference, answer, agrees, is_past) else {
            return true;
        };
        if self.occurs_between(ray, answer, &nearby, agrees) {
            return true;
        }
        // A cap where the surface is, too.
        let at_once = (reference.depth_mm - answer.depth_mm).abs() <= max_apart * voxel;
        if at_once && nearby.passes {
            return true;
        }
        // The reference's hit only touches the surface: what lies behind it decides.
        if touches == 0 || !nearby.passes || reference.depth_mm >= answer.depth_mm {
            return false;
        }
        let on_mm = reference.depth_mm + 2.0 * max_apart * voxel;
        let rest = Ray {
            origin_world: ray.origin_world + ray.dir_world * on_mm,
            ..ray
        };
        let answer = Answer {
            depth_mm: answer.depth_mm - on_mm,
            ..answer
        };
        let reference = self.reference(rest);
        apart(reference, answer, voxel).is_some_and(|by| by <= max_apart)
            || self.is_borderline(rest, reference, answer, max_apart, touches - 1)
    }

    /// The reference's answers for the ray and the iso value moved a little; `None`: one of them
    /// agrees with `answer`.
    fn nearby(
        &self,
        ray: Ray,
        reference: Answer,
        answer: Answer,
        agrees: impl Fn(Answer) -> bool,
        is_past: impl Fn(Answer) -> bool,
    ) -> Option<Nearby> {
        let iso_off = self.iso_off(ray, reference.depth_mm.min(answer.depth_mm));
        let mut nearby = Nearby::default();
        for by in self.moves(ray) {
            for iso in [0.0, -iso_off, iso_off] {
                let off = Off { by, iso };
                let near = if off == Off::NONE {
                    reference
                } else {
                    self.seen(ray, off)
                };
                if agrees(near) {
                    return None;
                }
                nearby.passes |= is_past(near);
                let nearest = if near.depth_mm < answer.depth_mm {
                    &mut nearby.before
                } else {
                    &mut nearby.behind
                };
                let is_nearer = nearest.is_none_or(|(_, other)| {
                    (near.depth_mm - answer.depth_mm).abs()
                        < (other.depth_mm - answer.depth_mm).abs()
                });
                if is_nearer {
                    *nearest = Some((off, near));
                }
            }
        }
        Some(nearby)
    }

    /// Whether the reference gives `answer` for some change between the two nearest; it does not
    /// where the depth jumps there.
    fn occurs_between(
        &self,
        ray: Ray,
        answer: Answer,
        nearby: &Nearby,
        agrees: impl Fn(Answer) -> bool,
    ) -> bool {
        const BISECTIONS: u32 = 60;
        let (Some((mut low, _)), Some((mut high, _))) = (nearby.before, nearby.behind) else {
            return false;
        };
        for _ in 0..BISECTIONS {
            let middle = low.middle(high);
            let near = self.seen(ray, middle);
            if agrees(near) {
                return true;
            }
            if near.depth_mm < answer.depth_mm {
                low = middle;
            } else {
                high = middle;
            }
        }
        false
    }

    /// The reference's answer for a ray and an iso value moved a little.
    fn seen(&self, ray: Ray, off: Off) -> Answer {
        let ray = Ray {
            origin_world: ray.origin_world + off.by,
            ..ray
        };
        if off.iso == 0.0 {
            return self.reference(ray);
        }
        let mut scene = self.scene.clone();
        if let Picture::Surface { iso, .. } = &mut scene.picture {
            *iso += off.iso;
        }
        // `new` has seen that a tracer can be made.
        Tracer::new(self.volume, &scene).map_or(self.reference(ray), |tracer| {
            Answer::from(&tracer.cast(ray))
        })
    }

    /// Moves of a ray by [`HitChecker::NEAR_VOXELS`]: none, in eight directions sideways, and along
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
        all.map(move |direction| direction * near_mm)
    }

    /// Whether the field at a place of the ray is so near to the iso value that the surface is
    /// within [`HitChecker::NEAR_VOXELS`].
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

    /// How much the field changes in [`HitChecker::NEAR_VOXELS`] about a place of the ray, or
    /// [`HitChecker::NEAR_VALUE`]. Physical.
    fn iso_off(&self, ray: Ray, depth_mm: f64) -> f64 {
        let min_off = Self::NEAR_VALUE * self.volume.range().width();
        if !depth_mm.is_finite() {
            return min_off;
        }
        let low = self.index_point(ray, depth_mm).floor();
        // The largest difference of two voxels side by side.
        let mut max_slope: f64 = 0.0;
        for corner in 0..64 {
            let at = [corner % 4 - 1, corner / 4 % 4 - 1, corner / 16 - 1];
            for axis in 0..3 {
                let mut next = at;
                next[axis] += 1;
                let difference = self.value_at(low, at) - self.value_at(low, next);
                max_slope = max_slope.max(difference.abs());
            }
        }
        min_off.max(Self::NEAR_VOXELS * max_slope)
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

/// The reference's answers nearby, not counting the answer in question.
#[derive(Default)]
struct Nearby {
    /// The change whose answer lies nearest before the answer in question.
    before: Option<(Off, Answer)>,
    /// The change whose answer lies nearest behind it, nothing being behind everything.
    behind: Option<(Off, Answer)>,
    /// Whether any of the rays passes the place that the reference hits.
    passes: bool,
}

/// A small change of a ray and of the iso value.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Off {
    /// The offset of the ray, world space, mm.
    by: DVec3,
    /// The iso value, physical.
    iso: f64,
}

impl Off {
    const NONE: Self = Self {
        by: DVec3::ZERO,
        iso: 0.0,
    };

    fn middle(self, other: Self) -> Self {
        Self {
            by: (self.by + other.by) * 0.5,
            iso: (self.iso + other.iso) * 0.5,
        }
    }
}

/// How far two answers are apart, in voxels along a ray of which a voxel is so long; `None` where
/// they are of different kinds.
fn apart(a: Answer, b: Answer, voxel: f64) -> Option<f64> {
    match (a.kind, b.kind) {
        (Kind::Nothing, Kind::Nothing) => Some(0.0),
        (one, other) if one == other => Some((a.depth_mm - b.depth_mm).abs() / voxel),
        _ => None,
    }
}
