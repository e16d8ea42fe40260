//! Rays: along the grid, from on it, from far away, in odd units.

use glam::{DMat3, DVec3};

use super::super::scenes::rays as scenes;
use super::super::{HardCase, HardVolume};
use super::grid::{bump, noise};
use crate::error::Result;
use crate::volume::Geometry;

fn bump_at(origin_mm: f64, spacing_mm: f64) -> Result<HardVolume> {
    let geometry = Geometry::new(
        DVec3::splat(origin_mm),
        DMat3::IDENTITY,
        DVec3::splat(spacing_mm),
    )?;
    bump([13, 14, 15], geometry).map(HardVolume::from)
}

pub(super) const CASES: &[HardCase] = &[
    HardCase {
        name: "axis-rays",
        number: 1,
        about: "Noise seen along each axis and along the diagonal of two: directions with components +0, -0 and next to 0.",
        answer: "No ray is lost: every picture is the reference's.",
        members: &[],
        scenes: scenes::axis_rays,
        make: |_| noise([9; 3]).map(HardVolume::from),
    },
    HardCase {
        name: "grid-rays",
        number: 2,
        about: "Noise seen along diagonals: rays through cell edges, corners, voxel centres and the corners of octree nodes.",
        answer: "No ray slips between two cells: every picture is the reference's.",
        members: &[],
        scenes: scenes::grid_rays,
        make: |_| noise([17; 3]).map(HardVolume::from),
    },
    HardCase {
        name: "face-rays",
        number: 3,
        about: "Noise seen by rays that lie in cell faces and in the volume's own faces.",
        answer: "A face of the volume belongs to it: the outermost rays hit, and every picture is the reference's.",
        members: &[],
        scenes: scenes::face_rays,
        make: |_| noise([9; 3]).map(HardVolume::from),
    },
    HardCase {
        name: "eye-on-grid",
        number: 4,
        about: "Noise seen from on a face, an edge, a corner, a voxel's centre, the isosurface, and from inside.",
        answer: "What lies behind the eye is not seen, what lies at it is: every picture is the reference's.",
        members: &[],
        scenes: scenes::eye_on_grid,
        make: |_| noise([9; 3]).map(HardVolume::from),
    },
    HardCase {
        name: "far-camera",
        number: 5,
        about: "A bump seen from 100,000 radii away with a lens of a thousandth of a degree.",
        answer: "The picture from far away is the orthographic one, to the pixel.",
        members: &[],
        scenes: scenes::far_camera,
        make: |_| bump([17, 15, 16], Geometry::default()).map(HardVolume::from),
    },
    HardCase {
        name: "lenses",
        number: 5,
        about: "A bump seen through lenses of 0.1 and of 175 degrees, from outside and from within.",
        answer: "Every picture is the reference's.",
        members: &[],
        scenes: scenes::lenses,
        make: |_| bump([17, 15, 16], Geometry::default()).map(HardVolume::from),
    },
    HardCase {
        name: "far-origin",
        number: 5,
        about: "A bump whose world coordinates begin at 1,000,000 mm.",
        answer: "The picture is that of the same bump at the world's origin.",
        members: &[],
        scenes: scenes::whole,
        make: |_| bump_at(1e6, 1.0),
    },
    HardCase {
        name: "tiny-spacing",
        number: 5,
        about: "A bump with voxels of a nanometre: 1e-6 mm.",
        answer: "The picture is that of the same bump with voxels of 1 mm.",
        members: &[],
        scenes: scenes::whole,
        make: |_| bump_at(0.0, 1e-6),
    },
    HardCase {
        name: "huge-spacing",
        number: 5,
        about: "A bump with voxels of a kilometre: 1e6 mm.",
        answer: "The picture is that of the same bump with voxels of 1 mm.",
        members: &[],
        scenes: scenes::whole,
        make: |_| bump_at(0.0, 1e6),
    },
];
