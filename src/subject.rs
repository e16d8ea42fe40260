//! A volume as scenes see it: what their defaults are made of.

use glam::DVec3;

use crate::extent::Range;

/// The bounds, spacing and values of a volume: all that a scene's defaults depend on.
///
/// [`Subject::of`] makes it of a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Subject {
    /// Centre of the bounding sphere, world.
    pub center_world: DVec3,
    /// Radius of the bounding sphere, mm.
    pub radius_mm: f64,
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
