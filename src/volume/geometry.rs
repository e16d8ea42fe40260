//! Where the voxels are: index space to world space (mm, LPS) and back.

use glam::{DAffine3, DMat3, DVec3};

use crate::error::{Error, Result};

/// `world = origin + direction · diag(spacing) · index`. Direction columns are unit vectors, not
/// necessarily orthogonal (a sheared NIfTI affine) nor right-handed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometry {
    origin_mm: DVec3,
    direction: DMat3,
    spacing_mm: DVec3,
}

impl Default for Geometry {
    /// Spacing 1, origin 0, identity direction: a file without geometry.
    fn default() -> Self {
        Self {
            origin_mm: DVec3::ZERO,
            direction: DMat3::IDENTITY,
            spacing_mm: DVec3::ONE,
        }
    }
}

impl Geometry {
    /// The spacings with which rays can be computed.
    pub const SPACING_MM: std::ops::RangeInclusive<f64> = 1e-9..=1e9;
    /// The farthest origin from world 0 along any axis, mm.
    pub const FARTHEST_ORIGIN_MM: f64 = 1e12;

    /// `direction`'s columns are the world directions of the index axes; they are normalised here.
    ///
    /// # Errors
    /// A spacing outside [`Geometry::SPACING_MM`], an origin beyond
    /// [`Geometry::FARTHEST_ORIGIN_MM`], directions that do not span space.
    pub fn new(origin_mm: DVec3, direction: DMat3, spacing_mm: DVec3) -> Result<Self> {
        let [x, y, z] = spacing_mm.to_array();
        if ![x, y, z].iter().all(|s| Self::SPACING_MM.contains(s)) {
            return Err(Error::input(format!(
                "the spacing {x:e}, {y:e}, {z:e} mm: each must be {:e} to {:e} mm",
                Self::SPACING_MM.start(),
                Self::SPACING_MM.end()
            )));
        }
        let [x, y, z] = origin_mm.to_array();
        if ![x, y, z]
            .iter()
            .all(|o| o.abs() <= Self::FARTHEST_ORIGIN_MM)
        {
            return Err(Error::input(format!(
                "the origin {x:e}, {y:e}, {z:e} mm: each must be at most {:e} mm from 0",
                Self::FARTHEST_ORIGIN_MM
            )));
        }
        let columns = [direction.x_axis, direction.y_axis, direction.z_axis];
        let units = columns.map(DVec3::normalize_or_zero);
        let direction = DMat3::from_cols(units[0], units[1], units[2]);
        if !direction.is_finite() || direction.determinant().abs() < 1e-6 {
            return Err(Error::input(format!(
                "the axis directions {}, {}, {} do not span space",
                columns[0], columns[1], columns[2]
            )));
        }
        Ok(Self {
            origin_mm,
            direction,
            spacing_mm,
        })
    }

    /// Makes a geometry like [`Geometry::new`], but an axis of negative spacing is turned round while
    /// its origin stays, as ITK reads such files.
    ///
    /// # Errors
    /// As [`Geometry::new`].
    pub fn of_signed_spacing(
        origin_mm: DVec3,
        direction: DMat3,
        spacing_mm: DVec3,
    ) -> Result<Self> {
        let sign = DVec3::select(spacing_mm.cmplt(DVec3::ZERO), DVec3::NEG_ONE, DVec3::ONE);
        let turned = direction * DMat3::from_diagonal(sign);
        Self::new(origin_mm, turned, spacing_mm * sign)
    }

    /// Converts a whole affine map, such as NIfTI's sform after conversion to LPS.
    ///
    /// # Errors
    /// As [`Geometry::new`].
    pub fn from_affine(world_from_index: DAffine3) -> Result<Self> {
        let m = world_from_index.matrix3;
        let spacing_mm = DVec3::new(m.x_axis.length(), m.y_axis.length(), m.z_axis.length());
        Self::new(world_from_index.translation, m, spacing_mm)
    }

    /// The centre of the first voxel, world space, mm.
    pub fn origin_mm(&self) -> DVec3 {
        self.origin_mm
    }

    /// The unit directions of the index axes in world space, as columns.
    pub fn direction(&self) -> DMat3 {
        self.direction
    }

    /// The distance of neighbouring voxel centres along each index axis, mm.
    pub fn spacing_mm(&self) -> DVec3 {
        self.spacing_mm
    }

    /// The edge of the step's voxel: the smallest spacing.
    pub fn smallest_spacing_mm(&self) -> f64 {
        self.spacing_mm.min_element()
    }

    /// The map from index space to world space (mm).
    pub fn world_from_index(&self) -> DAffine3 {
        DAffine3 {
            matrix3: self.direction * DMat3::from_diagonal(self.spacing_mm),
            translation: self.origin_mm,
        }
    }

    /// The map from world space (mm) to index space.
    pub fn index_from_world(&self) -> DAffine3 {
        self.world_from_index().inverse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn index_and_world_are_inverse() {
        let g = Geometry::new(
            DVec3::new(1e6, -3.0, 7.0),
            DMat3::from_cols(DVec3::NEG_Y, DVec3::new(0.6, 0.0, 0.8), DVec3::X),
            DVec3::new(0.5, 2.0, 10.0),
        )
        .unwrap();
        let p_index = DVec3::new(3.0, 5.0, 7.0);
        let p_world = g.world_from_index().transform_point3(p_index);
        let expected = DVec3::new(1e6, -3.0, 7.0)
            + DVec3::NEG_Y * 1.5
            + DVec3::new(0.6, 0.0, 0.8) * 10.0
            + DVec3::X * 70.0;
        assert!(p_world.distance(expected) < 1e-9);
        assert!(
            g.index_from_world()
                .transform_point3(p_world)
                .distance(p_index)
                < 1e-7
        );
    }

    #[test]
    fn a_negative_spacing_turns_its_axis_round() {
        let direction = DMat3::from_rotation_z(0.3);
        let (origin, spacing) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.5, -2.0, 4.0));
        let g = Geometry::of_signed_spacing(origin, direction, spacing).unwrap();
        assert_eq!(g.spacing_mm(), spacing.abs());
        assert_eq!(g.origin_mm(), origin);
        let step = |axis: DVec3| g.world_from_index().transform_vector3(axis);
        assert!(step(DVec3::Y).distance(direction * DVec3::Y * -2.0) < 1e-12);
        assert!(step(DVec3::X).distance(direction * DVec3::X * 0.5) < 1e-12);
    }

    #[test]
    fn unusable_geometry_is_refused() {
        let new = |spacing, direction| Geometry::new(DVec3::ZERO, direction, spacing);
        assert!(new(DVec3::new(1.0, 0.0, 1.0), DMat3::IDENTITY).is_err());
        assert!(new(DVec3::new(1.0, f64::NAN, 1.0), DMat3::IDENTITY).is_err());
        assert!(new(DVec3::ONE, DMat3::from_cols(DVec3::X, DVec3::X, DVec3::Z)).is_err());
        assert!(new(DVec3::ONE, DMat3::ZERO).is_err());
    }
}
