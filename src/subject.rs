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

/// The bounds, spacing and values of a volume: all that a scene's defaults depend on.
///
/// [`Subject::of`] makes it of a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Subject {
    /// The volume's bounding sphere.
    pub sphere: Sphere,
    /// The bounding sphere of what is shown of the volume, about which a camera is placed where nothing else
    /// is given. It depends on the picture (`render::content_sphere`): until one is known it is the volume's.
    pub content: Sphere,
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
