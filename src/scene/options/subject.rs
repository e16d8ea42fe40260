//! What a scene's defaults need to know about the volume.

use glam::DVec3;

use crate::extent::Range;

/// The volume as the scene sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Subject {
    /// Centre of the bounding sphere, world.
    pub center_world: DVec3,
    /// Radius of the bounding sphere, mm.
    pub radius_mm: f64,
    /// Along the voxel axes.
    pub spacing_mm: DVec3,
    /// Physical values.
    pub range: Range,
    /// Physical values without a few far-away voxels and without padding: what defaults are made
    /// of. Of most volumes the whole range.
    pub robust_range: Range,
    /// Otsu's threshold, physical.
    pub otsu: f64,
    /// The iso value where none is given, physical.
    pub suggested_iso: f64,
}
