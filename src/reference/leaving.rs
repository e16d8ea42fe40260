//! Rays that leave a point of the volume: what of them is left of what clip planes keep.

use glam::{DMat3, DVec3};

use crate::extent::Dims;
use crate::scene::LightFrom;
use crate::volume::Volume;

use super::clip::IndexPlane;
use super::interval::{IndexRay, Interval};

/// How far from a point of the surface the rays that leave it begin, in voxels of the smallest spacing: so far that no
/// rounding puts their beginning on the other side, unless they leave it within 1e-7 of its tangents.
const START_VOXELS: f64 = 1e-6;

/// What rays that leave a point pass through.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a> {
    /// The map from world-space vectors to index-space vectors.
    pub index_from_world: DMat3,
    /// The volume's origin, world space.
    pub origin_world: DVec3,
    /// The volume's size.
    pub dims: Dims,
    /// The clip planes.
    pub clip_planes: &'a [IndexPlane],
    /// How far from a surface rays that leave it begin, mm.
    pub start_mm: f64,
}

impl<'a> Surroundings<'a> {
    /// The kept part of a volume.
    pub fn new(
        volume: &Volume,
        index_from_world: DMat3,
        clip_planes: &'a [IndexPlane],
    ) -> Surroundings<'a> {
        Self {
            index_from_world,
            origin_world: volume.geometry().origin_mm(),
            dims: volume.dims(),
            clip_planes,
            start_mm: START_VOXELS * volume.geometry().smallest_spacing_mm(),
        }
    }

    /// The part of a ray that leaves a point, index space, in a unit direction, world space, from `start_mm` to
    /// `distance_mm` along it; `None` where there is none.
    pub fn interval_from(
        &self,
        index: [f64; 3],
        dir_world: DVec3,
        start_mm: f64,
        distance_mm: f64,
    ) -> Option<Interval> {
        let dir = (self.index_from_world * dir_world).to_array();
        let ray = IndexRay {
            origin: std::array::from_fn(|a| index[a] + dir[a] * start_mm),
            dir,
        };
        let inside = Interval::new(&ray, self.dims)?;
        let mut interval = inside.clipped(self.clip_planes, self.dims)?;
        interval.length_mm = interval
            .length_mm
            .min(distance_mm - start_mm - interval.enter_mm);
        (interval.length_mm > 0.0).then_some(interval)
    }

    /// The part of a ray from a point of a medium to a light; `None` where there is none.
    pub fn interval_to_light(
        &self,
        at_world: DVec3,
        to_viewer: DVec3,
        light: LightFrom,
    ) -> Option<Interval> {
        let index = self.index_from_world * (at_world - self.origin_world);
        let toward = light.toward(at_world, to_viewer);
        let distance_mm = light.distance_mm(at_world);
        self.interval_from(index.to_array(), toward, 0.0, distance_mm)
    }
}
