//! The identity of a volume by its content.

use super::Volume;

impl Volume {
    /// A hash of everything that a picture of the volume depends on: its size, the voxels' type and
    /// values as they are held, geometry and calibration. Where the volume was read from does not
    /// matter.
    pub fn content_hash(&self) -> blake3::Hash {
        let (dims, kind) = (self.dims().array(), self.voxels().voxel_type().name());
        let (geometry, rescale) = (self.geometry(), self.rescale());
        let mut hasher = blake3::Hasher::new();
        // Debug output names every field, and prints floats so that they read back as they were.
        hasher.update(format!("{dims:?} {kind} {geometry:?} {rescale:?}").as_bytes());
        hasher.update(self.voxels().bytes());
        hasher.finalize()
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::super::{Geometry, NonFinite, Rescale, Voxels};
    use super::*;
    use crate::extent::Dims;

    fn hash(side: [u64; 3], voxels: Voxels, spacing_mm: f64, slope: f64) -> blake3::Hash {
        let (dims, intercept) = (Dims::new(side).unwrap(), 0.0);
        let geometry = Geometry::new(DVec3::ZERO, DMat3::IDENTITY, DVec3::splat(spacing_mm));
        let rescale = Rescale { slope, intercept };
        let volume = Volume::new(dims, voxels, geometry.unwrap(), rescale, NonFinite::Refuse);
        volume.unwrap().content_hash()
    }

    #[test]
    fn volumes_of_another_content_have_another_hash() {
        let voxels = |last: u16| Voxels::from(vec![1_u16, 2, 3, last]);
        let one = hash([2, 2, 1], voxels(4), 1.0, 1.0);
        assert_eq!(one, hash([2, 2, 1], voxels(4), 1.0, 1.0));
        for other in [
            hash([2, 2, 1], voxels(5), 1.0, 1.0),
            hash([4, 1, 1], voxels(4), 1.0, 1.0),
            hash([2, 2, 1], voxels(4), 1.5, 1.0),
            hash([2, 2, 1], voxels(4), 1.0, 2.0),
            hash([2, 2, 1], Voxels::from(vec![1_i16, 2, 3, 4]), 1.0, 1.0),
        ] {
            assert_ne!(one, other);
        }
    }
}
