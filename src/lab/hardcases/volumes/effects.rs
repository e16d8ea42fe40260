//! Light and lens: edges before what lies far behind them, and planes.

use glam::DVec3;

use super::super::scenes::effects::{
    self as scenes, FAR_SLOPE, NEAR_EDGE_X, PLANE_Y, plane_normal,
};
use super::super::{HardCase, HardVolume};
use super::grid::volume_of;
use super::unit;
use crate::error::Result;

/// A sheet half a voxel thick in the volume's face at y = 0 that ends at [`NEAR_EDGE_X`], and far behind it the tilted plate.
fn edge_before_plate() -> Result<HardVolume> {
    volume_of([80, 60, 17], unit(), |p| {
        let plate = FAR_SLOPE.dot(p - DVec3::new(0.0, 40.0, 8.0));
        let is_sheet = p.y == 0.0 && p.x < NEAR_EDGE_X;
        if is_sheet {
            4.0
        } else {
            plate.clamp(-4.0, 4.0) as f32
        }
    })
    .map(HardVolume::from)
}

/// A ball, and a plane far behind it.
fn ball_before_plane() -> Result<HardVolume> {
    volume_of([49, 45, 49], unit(), |p| {
        let ball = 6.0 - p.distance(DVec3::new(24.0, 10.0, 24.0));
        ball.max(p.y - PLANE_Y).clamp(-2.0, 2.0) as f32
    })
    .map(HardVolume::from)
}

/// A plane through the middle that lies along none of the grid's.
fn tilted_plane() -> Result<HardVolume> {
    volume_of([33; 3], unit(), |p| {
        (DVec3::splat(16.2) - p).dot(plane_normal()) as f32
    })
    .map(HardVolume::from)
}

pub(super) const CASES: &[HardCase] = &[
    HardCase {
        name: "focused-edge",
        number: 28,
        about: "A sheet in focus whose straight edge lies before a plate far out of focus, of another brightness.",
        answer: "To the edge all is the sheet's light, beyond it all is the plate's: neither is smeared over the other.",
        members: &[],
        scenes: scenes::focused_edge,
        make: |_| edge_before_plate(),
    },
    HardCase {
        name: "ball-before-plane",
        number: 28,
        about: "A ball before a plane that is farther from it than occlusion reaches: in the picture they touch.",
        answer: "The plane has an occlusion of 0, beside the ball's silhouette as elsewhere: there is no halo.",
        members: &[],
        scenes: scenes::ball_before_plane,
        make: |_| ball_before_plane(),
    },
    HardCase {
        name: "tilted-plane",
        number: 28,
        about: "A plane seen at 0 to 80 degrees from its normal: estimates from depths alone take its slope for a wall.",
        answer: "Nothing is in the way of a plane: its occlusion is 0 at every tilt.",
        members: &[],
        scenes: scenes::tilted_plane,
        make: |_| tilted_plane(),
    },
    HardCase {
        name: "blurred-edge",
        number: 33,
        about: "The sheet's edge out of focus before the plate: in focus on the plate, on infinity, and through a lens of \
                hardly any width.",
        answer: "Across the edge the sheet's share of the light is that of a disc cut by a line, 1/2 + (asin c + c sqrt(1 - c^2))/pi, \
                 c the distance in radii of the circle of confusion; the plate's is the rest.",
        members: &[],
        scenes: scenes::blurred_edge,
        make: |_| edge_before_plate(),
    },
];
