//! Isosurfaces: roots that a step misses, iso values on plateaus, thin and touching things.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::super::scenes::isosurface as scenes;
use super::super::{HardCase, HardVolume};
use super::grid::{noise, volume_of};
use super::unit;
use crate::error::Result;
use crate::extent::Dims;
use crate::volume::{Geometry, PhantomKind, PhantomSpec, VoxelType, phantom};

/// One cell whose field along the main diagonal is the cubic with these Bernstein coefficients.
fn diagonal(bernstein: [i16; 4]) -> Result<HardVolume> {
    volume_of([2; 3], unit(), |p| bernstein[p.element_sum() as usize]).map(HardVolume::from)
}

/// 255 at the voxels that `is` selects, 0 at all others.
fn bright(dims: [u64; 3], is: impl Fn(DVec3) -> bool) -> Result<HardVolume> {
    volume_of(dims, unit(), |p| if is(p) { 255_u8 } else { 0 }).map(HardVolume::from)
}

/// Distance of `p` from the line through `on` along the unit vector `along`.
fn from_line(p: DVec3, on: DVec3, along: DVec3) -> f64 {
    (p - on).cross(along).length()
}

/// Bright inside, falling over one voxel about the surface.
fn soft_edge(beyond: f64) -> f64 {
    255.0 * (0.5 - beyond).clamp(0.0, 1.0)
}

/// The edge of one vessel's tile.
const TILE: f64 = 20.0;

/// The radius and direction of vessel `n` of 100: radii 0.3 to 3 voxels, directions spread over the
/// half sphere by the golden angle.
fn vessel(n: u32) -> (f64, DVec3) {
    let radius = 0.3 * 10_f64.powf(f64::from(n * 37 % 100) / 99.0);
    let z = 1.0 - (f64::from(n) + 0.5) / 100.0;
    let turn = PI * (3.0 - 5_f64.sqrt()) * f64::from(n);
    let flat = (1.0 - z * z).sqrt();
    (radius, DVec3::new(flat * turn.cos(), flat * turn.sin(), z))
}

fn thin_vessels() -> Result<HardVolume> {
    volume_of([200, 200, 20], unit(), |p| {
        let tile = (p / TILE).floor();
        let (radius, along) = vessel((tile.x + 10.0 * tile.y) as u32);
        // No centreline runs through voxel centres.
        let middle = (tile * DVec3::new(TILE, TILE, 0.0)) + DVec3::new(9.7, 9.4, 9.6);
        let q = p - middle;
        let end = q - along * q.dot(along).clamp(-7.0, 7.0);
        soft_edge(end.length() - radius).round() as u8
    })
    .map(HardVolume::from)
}

/// The corners of leaves, of nodes of every level, and of the volume, for leaves of 8 cells.
const CORNERS: [f64; 12] = [
    0.0, 1.0, 7.0, 8.0, 9.0, 15.0, 16.0, 17.0, 31.0, 32.0, 33.0, 39.0,
];

fn corner_voxel(n: usize) -> DVec3 {
    let at = |i: usize| CORNERS[i % CORNERS.len()];
    DVec3::new(at(n), at(n + 3), at(2 * n + 1))
}

/// A plateau of 100 in the middle, a single voxel of 200, 20 outside.
fn plateau() -> Result<HardVolume> {
    volume_of([12, 13, 11], unit(), |p| {
        let within = |v: f64, end: f64| (3.0..end).contains(&v);
        if p == DVec3::new(6.0, 6.0, 5.0) {
            200_u8
        } else if within(p.x, 9.0) && within(p.y, 9.0) && within(p.z, 8.0) {
            100
        } else {
            20
        }
    })
    .map(HardVolume::from)
}

/// A Gaussian in world space, in a left-handed volume with three different spacings.
fn mirrored() -> Result<HardVolume> {
    let direction = DMat3::from_cols(DVec3::NEG_X, DVec3::Y, DVec3::Z);
    let spacing = DVec3::new(1.0, 2.0, 0.5);
    let dims = [33, 17, 65];
    let extent = spacing * DVec3::new(32.0, 16.0, 64.0);
    let geometry = Geometry::new(direction * extent * -0.5, direction, spacing)?;
    let world_from_index = geometry.world_from_index();
    volume_of(dims, geometry, |p| {
        let world = world_from_index.transform_point3(p);
        (-world.length_squared() / 128.0).exp() as f32
    })
    .map(HardVolume::from)
}

fn marschner_lobb(size: u64) -> Result<HardVolume> {
    let spec = PhantomSpec {
        voxel_type: VoxelType::U16,
        ..PhantomSpec::new(PhantomKind::MarschnerLobb, Dims::new([size; 3])?)
    };
    Ok(phantom(&spec)?.volume.into())
}

pub(super) const CASES: &[HardCase] = &[
    HardCase {
        name: "tangent",
        number: 7,
        about: "One cell whose field along the diagonal is 600 s (1 - s): it touches 150 in a double root.",
        answer: "Along the diagonal, 149.99 is hit at s = 1/2 - sqrt(1/4 - 149.99/600) of it and 150.01 nowhere.",
        members: &[],
        scenes: scenes::tangent,
        make: |_| diagonal([0, 200, 200, 0]),
    },
    HardCase {
        name: "three-roots",
        number: 7,
        about: "One cell whose field along the diagonal is 900 s - 2400 s^2 + 1600 s^3: it passes 50 three times.",
        answer: "Along the diagonal, 50 is hit at s = 1/2 - sqrt(3)/4 of it.",
        members: &[],
        scenes: scenes::three_roots,
        make: |_| diagonal([0, 300, -200, 100]),
    },
    HardCase {
        name: "two-roots-in-a-step",
        number: 7,
        about: "A layer of 255 one voxel thin, of which only a fiftieth of a voxel lies above 250: steps pass over it.",
        answer: "The layer has no hole: along x the value 250 is hit 5/255 voxel before it.",
        members: &[],
        scenes: scenes::two_roots_in_a_step,
        make: |_| bright([17, 9, 9], |p| p.x == 8.0),
    },
    HardCase {
        name: "plateau",
        number: 8,
        about: "A block of 100 in 20: the iso value is that of the whole block, of a single voxel, or just beside.",
        answer: "What is at the iso value is inside: at 100 the block is hit where it begins, at 100.001 only the voxel of 200 within is.",
        members: &[],
        scenes: scenes::plateau,
        make: |_| plateau(),
    },
    HardCase {
        name: "iso-at-extremes",
        number: 8,
        about: "A block of 100 and a voxel of 200 in 20, with the iso value at the minimum, at the maximum, and outside.",
        answer: "At or below the minimum all is inside: nothing but caps; at the maximum one point; above it nothing.",
        members: &[],
        scenes: scenes::iso_at_extremes,
        make: |_| plateau(),
    },
    HardCase {
        name: "saddle",
        number: 9,
        about: "Voxels of 0 and 255 in turn, as on a chess board: every cell and every face is ambiguous.",
        answer: "The trilinear field decides: every picture is the reference's.",
        members: &[],
        scenes: scenes::saddle,
        make: |_| bright([6, 6, 6], |p| p.element_sum() % 2.0 == 1.0),
    },
    HardCase {
        name: "thin-vessels",
        number: 10,
        about: "A hundred vessels in a hundred directions, of radius 0.3 to 3 voxels.",
        answer: "No pixel whose ray meets a vessel is missed.",
        members: &[],
        scenes: scenes::thin_vessels,
        make: |_| thin_vessels(),
    },
    HardCase {
        name: "touching-vessels",
        number: 11,
        about: "Two vessels side by side with one dark voxel between them.",
        answer: "They are two: rays between them pass through.",
        members: &[],
        scenes: scenes::touching_vessels,
        make: |_| {
            volume_of([17, 17, 24], unit(), |p| {
                let distance = |x| from_line(p, DVec3::new(x, 8.0, 0.0), DVec3::Z);
                soft_edge(distance(5.5).min(distance(10.5)) - 2.0).round() as u8
            })
            .map(HardVolume::from)
        },
    },
    HardCase {
        name: "one-bright-voxel",
        number: 11,
        about: "A single voxel of 255 in nothing.",
        answer: "Along an axis through it, the value v is hit 1 - v/255 voxel before its centre.",
        members: &[],
        scenes: scenes::one_bright_voxel,
        make: |_| bright([9; 3], |p| p == DVec3::splat(4.0)),
    },
    HardCase {
        name: "stenosis",
        number: 11,
        about: "A vessel of radius 3 that is dark over one voxel of its length.",
        answer: "The gap is open: rays through its middle pass.",
        members: &[],
        scenes: scenes::stenosis,
        make: |_| {
            volume_of([33, 17, 17], unit(), |p| {
                let vessel = soft_edge(from_line(p, DVec3::splat(8.0), DVec3::X) - 3.0);
                if p.x == 16.0 {
                    20
                } else {
                    vessel.round() as u8
                }
            })
            .map(HardVolume::from)
        },
    },
    HardCase {
        name: "sheet",
        number: 12,
        about: "A plane one voxel thin, seen from its face to its edge.",
        answer: "It has no hole at any angle: a ray that crosses it where it is half a voxel from the volume's side hits.",
        members: &[],
        scenes: scenes::sheet,
        make: |_| bright([33; 3], |p| p.x == 16.0),
    },
    HardCase {
        name: "step-edge",
        number: 12,
        about: "A step from 0 to 255 with the iso value at one end of it, where regula falsi stalls.",
        answer: "Along x the value v is hit at x = 7 + v/255.",
        members: &[],
        scenes: scenes::step_edge,
        make: |_| bright([17, 9, 9], |p| p.x >= 8.0),
    },
    HardCase {
        name: "corner-voxels",
        number: 13,
        about: "A bright voxel at the corner of each kind of octree node: who forgets the border voxel of a node's range skips it.",
        answer: "All twelve are found, from every side.",
        members: &[],
        scenes: scenes::corner_voxels,
        make: |_| {
            bright([40; 3], |p| {
                (0..CORNERS.len()).any(|n| corner_voxel(n) == p)
            })
        },
    },
    HardCase {
        name: "zero-gradient",
        number: 14,
        about: "Layers of 0 and 255 in turn: seen from inside, central differences vanish at every surface.",
        answer: "Where the gradient vanishes the normal points toward the eye.",
        members: &[],
        scenes: scenes::zero_gradient,
        make: |_| bright([21, 9, 9], |p| p.x % 2.0 == 1.0),
    },
    HardCase {
        name: "mirrored-normals",
        number: 14,
        about: "A Gaussian, round in the world, in a left-handed volume with spacings of 1, 2 and 0.5 mm.",
        answer: "The surface at exp(-1/2) is a sphere of 8 mm and its normals are radial, to within the grid's error of 2 degrees.",
        members: &[],
        scenes: scenes::mirrored_normals,
        make: |_| mirrored(),
    },
    HardCase {
        name: "marschner-lobb-41",
        number: 15,
        about: "The test signal of Marschner and Lobb (1994), just sampled finely enough.",
        answer: "Every picture is the reference's.",
        members: &[],
        scenes: scenes::marschner_lobb,
        make: |_| marschner_lobb(41),
    },
    HardCase {
        name: "marschner-lobb-32",
        number: 15,
        about: "The same signal sampled too coarsely.",
        answer: "Every picture is the reference's.",
        members: &[],
        scenes: scenes::marschner_lobb,
        make: |_| marschner_lobb(32),
    },
    HardCase {
        name: "white-noise",
        number: 15,
        about: "Noise with the iso value at its median: a surface in every cell, the worst a traversal can meet.",
        answer: "Every picture is the reference's.",
        members: &[],
        scenes: scenes::white_noise,
        make: |_| noise([32; 3]).map(HardVolume::from),
    },
];
