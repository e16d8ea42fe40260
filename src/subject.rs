//! A volume as scenes see it: what their defaults are made of.

use glam::DVec3;

use crate::extent::Range;

/// A sphere in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Its centre, mm (LPS).
    pub center_world: DVec3,
    /// Its radius, mm.
    pub radius_mm: f64,
}

impl From<(DVec3, f64)> for Sphere {
    /// Of a centre and a radius.
    fn from((center_world, radius_mm): (DVec3, f64)) -> Self {
        Self {
            center_world,
            radius_mm,
        }
    }
}

/// A box in world space, of any orientation, by its eight corners, mm (LPS).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corners(pub [DVec3; 8]);

impl Corners {
    /// Those of a box between two opposite corners, along the axes of a space from which `place` leads to world space.
    pub fn between(least: DVec3, greatest: DVec3, place: impl Fn(DVec3) -> DVec3) -> Self {
        let ends = [least, greatest];
        let corner =
            |at: usize| DVec3::from_array([0, 1, 2].map(|axis| ends[at >> axis & 1][axis]));
        Self(std::array::from_fn(|at| place(corner(at))))
    }
}

/// What holds all that pictures can show of a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Content {
    /// A sphere, about which a camera is placed where nothing else is given.
    pub sphere: Sphere,
    /// A box along the voxel axes.
    pub corners: Corners,
}

impl Content {
    /// That of a sphere, without a tighter box.
    pub const fn around(sphere: Sphere) -> Self {
        let (center, radius) = (sphere.center_world, sphere.radius_mm);
        let mut corners = [center; 8];
        let mut at = 0;
        while at < 8 {
            corners[at] = DVec3::new(
                center.x + radius * side(at, 0),
                center.y + radius * side(at, 1),
                center.z + radius * side(at, 2),
            );
            at += 1;
        }
        Self {
            sphere,
            corners: Corners(corners),
        }
    }
}

/// On which side of its centre a corner lies along an axis.
const fn side(corner: usize, axis: usize) -> f64 {
    if corner >> axis & 1 == 0 { -1.0 } else { 1.0 }
}

/// The bounds, spacing and values of a volume: all that a scene's defaults depend on.
///
/// [`Subject::of`] makes it of a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Subject {
    /// The volume's bounding sphere.
    pub sphere: Sphere,
    /// The bounds of what is shown of the volume. They depend on the picture (`render::content`): until one is known they are the
    /// volume's.
    pub content: Content,
    /// Spacing along the voxel axes, mm.
    pub spacing_mm: DVec3,
    /// Range of the physical values.
    pub range: Range,
    /// Range of the physical values without a few far-away voxels and without padding: what defaults are
    /// made of. Of most volumes the whole range.
    pub robust_range: Range,
    /// Otsu's threshold, physical.
    pub otsu: f64,
    /// The iso value where none is given, physical.
    pub suggested_iso: f64,
}
