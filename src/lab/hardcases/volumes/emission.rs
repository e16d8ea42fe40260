//! Emission and absorption: media whose opacity is known in closed form.

use glam::{DMat3, DQuat, DVec3};

use super::super::scenes::emission as scenes;
use super::super::{HardCase, HardVolume};
use super::grid::volume_of;
use super::unit;
use crate::error::Result;
use crate::volume::Geometry;

fn constant(dims: [u64; 3], geometry: Geometry) -> Result<HardVolume> {
    volume_of(dims, geometry, |_| 100_u8).map(HardVolume::from)
}

/// A field along x alone.
fn profile(dims: [u64; 3], value: impl Fn(f64) -> f64) -> Result<HardVolume> {
    volume_of(dims, unit(), |p| value(p.x) as f32).map(HardVolume::from)
}

fn oblique() -> Result<Geometry> {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.7);
    Geometry::new(
        DVec3::new(12.0, -7.0, 30.0),
        DMat3::from_quat(turn),
        DVec3::new(0.7, 1.1, 1.9),
    )
}

/// Waves in all directions: what a transfer function is tried on.
fn waves() -> Result<HardVolume> {
    volume_of([12, 13, 11], unit(), |p| {
        (20.0 * p.x + 3.0 * p.y + 2.0 * (p.z * 0.7).sin() * p.z) as u8
    })
    .map(HardVolume::from)
}

pub(super) const CASES: &[HardCase] = &[
    HardCase {
        name: "homogeneous",
        number: 16,
        about: "A constant medium in an oblique volume with three spacings, seen through a wide lens.",
        answer: "The opacity of a path of L mm is 1 - 0.97^(L/2), at the picture's edge too.",
        members: &[],
        scenes: scenes::homogeneous,
        make: |_| constant([21, 15, 11], oblique()?),
    },
    HardCase {
        name: "slab",
        number: 17,
        about: "A plate along x: 0 to x = 10, rising to 1 at 12, falling from 20 to 0 at 22.",
        answer: "With opacity a = 0.3 v a mm, the optical depth along x is -8 ln(0.7) + (4/0.3) (0.7 ln(0.7) + 0.3).",
        members: &[],
        scenes: scenes::slab,
        make: |_| {
            profile([33, 3, 3], |x| {
                ((x - 10.0) / 2.0).min((22.0 - x) / 2.0).clamp(0.0, 1.0)
            })
        },
    },
    HardCase {
        name: "ramp",
        number: 17,
        about: "Values rising by 1 a voxel along x from 0 to 64.",
        answer: "With opacity 0.95 v/64 each 40 mm, the optical depth along x is (64/0.95) (0.05 ln(0.05) + 0.95) / 40.",
        members: &[],
        scenes: scenes::ramp,
        make: |_| profile([65, 2, 2], |x| x),
    },
    HardCase {
        name: "gaussian",
        number: 17,
        about: "A smooth bump, exp(-|p|^2/72) about its centre.",
        answer: "Every picture is the reference's, which integrates until it changes no more.",
        members: &[],
        scenes: scenes::gaussian,
        make: |_| {
            volume_of([33; 3], unit(), |p| {
                (-(p - 16.0).length_squared() / 72.0).exp() as f32
            })
            .map(HardVolume::from)
        },
    },
    HardCase {
        name: "tf-spike",
        number: 18,
        about: "Values rising by 1 a mm, seen by a transfer function with a spike a tenth of a value wide, narrower than a bin of any table.",
        answer: "The spike is seen: of opacity 0.9, rising and falling over 0.05 each, its optical depth is (0.1/0.9) (0.1 ln(0.1) + 0.9).",
        members: &[],
        scenes: scenes::tf_spike,
        make: |_| volume_of([256, 3, 3], unit(), |p| p.x as u8).map(HardVolume::from),
    },
    HardCase {
        name: "tf-stairs",
        number: 18,
        about: "Waves seen by a transfer function of stairs, where opacity jumps.",
        answer: "Every picture is the reference's.",
        members: &[],
        scenes: scenes::tf_stairs,
        make: |_| waves(),
    },
    HardCase {
        name: "tf-outside",
        number: 18,
        about: "Waves seen by transfer functions whose points lie below or above all values, all transparent or all opaque.",
        answer: "Outside its points a transfer function is constant: the opacity is 0, or that of a constant medium.",
        members: &[],
        scenes: scenes::tf_outside,
        make: |_| waves(),
    },
    HardCase {
        name: "opaque-step",
        number: 19,
        about: "A medium that is opaque within a millionth of a mm.",
        answer: "The opacity is 1 and the colour is the medium's, wherever the volume is.",
        members: &[],
        scenes: scenes::opaque_step,
        make: |_| constant([9; 3], unit()),
    },
    HardCase {
        name: "faint-4096",
        number: 19,
        about: "A medium of opacity 1e-6 a mm, 4096 mm long: sums in single precision lose it.",
        answer: "The opacity along x is 1 - (1 - 1e-6)^4096.",
        members: &[],
        scenes: scenes::faint_4096,
        make: |_| constant([4097, 2, 2], unit()),
    },
    HardCase {
        name: "thin-bright-sheet",
        number: 20,
        about: "A bright layer one voxel thin in a transparent medium.",
        answer: "With opacity 0 to 200 rising to 0.5 at 255, the optical depth along x is (110/255) (0.5 ln(0.5) + 0.5) / 0.5.",
        members: &[],
        scenes: scenes::thin_bright_sheet,
        make: |_| {
            volume_of([33; 3], unit(), |p| if p.x == 16.0 { 255_u8 } else { 0 })
                .map(HardVolume::from)
        },
    },
    HardCase {
        name: "false-homogeneous",
        number: 20,
        about: "Values from 100 to 102, nearly constant, under a transfer function that jumps from nothing to 0.5 between 100.9 and 101.1.",
        answer: "The optical depth along x is -14.4 ln(0.5) + (3.2/0.5) (0.5 ln(0.5) + 0.5).",
        members: &[],
        scenes: scenes::false_homogeneous,
        make: |_| profile([33, 9, 9], |x| 100.0 + x / 16.0),
    },
    HardCase {
        name: "anisotropic-1-1-10",
        number: 21,
        about: "A constant medium of 40 x 20 x 40 mm in voxels of 1 x 1 x 10 mm.",
        answer: "The opacity of a path of L mm is 1 - 0.97^(L/2): the same along x and z.",
        members: &[],
        scenes: scenes::along_axes,
        make: |_| {
            let spacing = DVec3::new(1.0, 1.0, 10.0);
            constant(
                [41, 21, 5],
                Geometry::new(DVec3::ZERO, DMat3::IDENTITY, spacing)?,
            )
        },
    },
];
