//! Volumes: of any size, type, value and orientation.

use glam::{DMat3, DVec3};

use super::super::scenes::kinds as scenes;
use super::super::{HardCase, HardVolume};
use super::grid::{bump, hash, noise, volume_of, voxels_of};
use super::unit;
use crate::error::Result;
use crate::extent::Dims;
use crate::volume::{Geometry, NonFinite, Rescale, Volume, Voxels};

const SIZES: [&str; 16] = [
    "1x1x1", "1x9x9", "9x1x9", "9x9x1", "1x1x9", "9x1x1", "2x2x2", "3x5x7", "7x7x7", "8x8x8",
    "9x9x9", "15x16x17", "31x32x33", "63x2x2", "64x2x2", "65x2x2",
];

fn sized(member: usize) -> Result<HardVolume> {
    let mut dims = [1; 3];
    for (side, text) in dims.iter_mut().zip(SIZES[member].split('x')) {
        *side = text.parse().unwrap_or(1);
    }
    noise(dims).map(HardVolume::from)
}

const TYPES: [&str; 11] = [
    "u8",
    "u16",
    "i16",
    "i8",
    "u32",
    "i32",
    "f32",
    "f64",
    "f32-tiny",
    "f32-huge",
    "f32-denormal",
];

/// 9 x 8 x 7 voxels of noise over the whole range of a type, both its ends among them.
fn typed(member: usize) -> Result<HardVolume> {
    const DIMS: [u64; 3] = [9, 8, 7];
    /// Values from `low` to `high`, which the volume's first two voxels are.
    fn spread(low: f64, high: f64) -> impl Fn(DVec3) -> f64 {
        move |p| match [p.x, p.y, p.z] {
            [0.0, 0.0, 0.0] => low,
            [1.0, 0.0, 0.0] => high,
            _ => low + (high - low) * hash(p),
        }
    }
    fn made<T>(low: f64, high: f64, voxel: impl Fn(f64) -> T) -> Result<HardVolume>
    where
        Voxels: From<Vec<T>>,
    {
        let value = spread(low, high);
        volume_of(DIMS, unit(), |p| voxel(value(p))).map(HardVolume::from)
    }
    /// Voxels that are read as f32.
    fn stored<const N: usize>(
        name: &'static str,
        (low, high): (f64, f64),
        bytes: impl Fn(f64) -> ([u8; N], f32),
    ) -> Result<HardVolume> {
        let value = spread(low, high);
        let volume = volume_of(DIMS, unit(), |p| bytes(value(p)).1)?;
        let voxels = voxels_of(DIMS, |p| bytes(value(p)).0);
        Ok(HardVolume {
            volume,
            stored: Some((name, voxels.concat())),
        })
    }
    match TYPES[member] {
        "u8" => made(0.0, 255.0, |v| v as u8),
        "u16" => made(0.0, 65_535.0, |v| v as u16),
        "i16" => made(-32_768.0, 32_767.0, |v| v as i16),
        "i8" => {
            let value = spread(-128.0, 127.0);
            let volume = volume_of(DIMS, unit(), |p| i16::from(value(p) as i8))?;
            let voxels = voxels_of(DIMS, |p| (value(p) as i8) as u8);
            Ok(HardVolume {
                volume,
                stored: Some(("int8", voxels)),
            })
        }
        "u32" => stored("uint32", (0.0, f64::from(u32::MAX)), |v| {
            ((v as u32).to_le_bytes(), v as u32 as f32)
        }),
        "i32" => stored("int32", (f64::from(i32::MIN), f64::from(i32::MAX)), |v| {
            ((v as i32).to_le_bytes(), v as i32 as f32)
        }),
        "f64" => stored("double", (-1.0, 1.0), |v| (v.to_le_bytes(), v as f32)),
        "f32-tiny" => made(1e-31, 1e-30, |v| v as f32),
        "f32-huge" => made(-3e30, 1e30, |v| v as f32),
        "f32-denormal" => made(1e-42, 1e-40, |v| v as f32),
        _ => made(-1.0, 1.0, |v| v as f32),
    }
}

/// Noise with NaN, +Inf, -Inf and denormal voxels strewn in.
fn non_finite() -> Result<HardVolume> {
    let dims = [9, 8, 7];
    let voxels = voxels_of(dims, |p| {
        let strewn = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e-41];
        let n = p.x + 9.0 * (p.y + 8.0 * p.z);
        if n % 23.0 == 7.0 {
            strewn[(n / 23.0) as usize % 4]
        } else {
            (90.0 * hash(p) - 50.0) as f32
        }
    });
    let bytes = voxels.iter().flat_map(|v| v.to_le_bytes()).collect();
    let volume = Volume::new(
        Dims::new(dims)?,
        Voxels::from(voxels),
        unit(),
        Rescale::IDENTITY,
        NonFinite::Replace,
    )?;
    Ok(HardVolume {
        volume,
        stored: Some(("float", bytes)),
    })
}

/// A solid letter F of unequal arms and a bright dot, in a slope: no turn or mirror image of it is
/// itself. p runs from 0 to (13, 10, 16).
fn lettered(p: DVec3) -> u8 {
    let within = |v: f64, low: f64, high: f64| (low..=high).contains(&v);
    let stem = within(p.x, 3.0, 5.0) && within(p.z, 2.0, 14.0);
    let top = within(p.x, 3.0, 11.0) && within(p.z, 12.0, 14.0);
    let arm = within(p.x, 3.0, 9.0) && within(p.z, 7.0, 9.0);
    if p.distance(DVec3::new(9.0, 8.0, 4.0)) < 1.6 {
        250
    } else if within(p.y, 3.0, 5.0) && (stem || top || arm) {
        200
    } else {
        (2.0 * p.x + p.y + 0.5 * p.z) as u8
    }
}

const LETTERED_DIMS: [u64; 3] = [14, 11, 17];

const ORIENTATIONS: [&str; 48] = [
    "0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "15", "16",
    "17", "18", "19", "20", "21", "22", "23", "24", "25", "26", "27", "28", "29", "30", "31", "32",
    "33", "34", "35", "36", "37", "38", "39", "40", "41", "42", "43", "44", "45", "46", "47",
];

/// The axes of orientation `member`, 0 to 47: which content axis each stored axis runs along, and
/// whether against it. Number 0 is the content as it is.
pub fn orientation_of(member: usize) -> ([usize; 3], [bool; 3]) {
    const ORDERS: [[usize; 3]; 6] = [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ];
    let flips = [0, 1, 2].map(|axis| member >> axis & 1 == 1);
    (ORDERS[member / 8 % 6], flips)
}

/// The lettered content stored along other axes, which the geometry undoes.
fn oriented(member: usize) -> Result<HardVolume> {
    let (along, against) = orientation_of(member);
    let content_mm = DVec3::new(1.0, 1.3, 0.8);
    let (mut origin, mut direction) = (DVec3::new(3.0, -4.0, 5.0), DMat3::IDENTITY);
    let (mut spacing, mut dims) = (DVec3::ONE, LETTERED_DIMS);
    for axis in 0..3 {
        let from = along[axis];
        let column = [DVec3::X, DVec3::Y, DVec3::Z][from];
        spacing[axis] = content_mm[from];
        dims[axis] = LETTERED_DIMS[from];
        *direction.col_mut(axis) = if against[axis] { -column } else { column };
        if against[axis] {
            origin += column * (spacing[axis] * (dims[axis] - 1) as f64);
        }
    }
    volume_of(dims, Geometry::new(origin, direction, spacing)?, |stored| {
        let mut content = DVec3::ZERO;
        for axis in 0..3 {
            let last = (dims[axis] - 1) as f64;
            content[along[axis]] = if against[axis] {
                last - stored[axis]
            } else {
                stored[axis]
            };
        }
        lettered(content)
    })
    .map(HardVolume::from)
}

pub(super) const CASES: &[HardCase] = &[
    HardCase {
        name: "sizes",
        number: 22,
        about: "Noise of awkward sizes: a single voxel, sheets, rods, powers of two and one beside.",
        answer: "An axis with one voxel is half a voxel long either way and constant: every picture is the reference's.",
        members: &SIZES,
        scenes: scenes::whole,
        make: sized,
    },
    HardCase {
        name: "constant",
        number: 22,
        about: "A volume of one value, 77.",
        answer: "The maximum and the mean are 77; 77 and less is a cap everywhere, more is nothing.",
        members: &[],
        scenes: scenes::constant,
        make: |_| volume_of([9; 3], unit(), |_| 77_u8).map(HardVolume::from),
    },
    HardCase {
        name: "types",
        number: 23,
        about: "Noise over the whole range of a voxel type, both its ends among them; floats of extreme magnitude.",
        answer: "Voxels keep their values, those of 32 bits to single precision: every picture is the reference's.",
        members: &TYPES,
        scenes: scenes::whole,
        make: typed,
    },
    HardCase {
        name: "non-finite",
        number: 23,
        about: "Floats with NaN, +Inf, -Inf and denormals strewn in.",
        answer: "The 17 voxels that are not finite are read as the smallest finite value, and a note says so.",
        members: &[],
        scenes: scenes::whole,
        make: |_| non_finite(),
    },
    HardCase {
        name: "orientations",
        number: 24,
        about: "A solid letter F stored in all 48 orders and directions of axes, left-handed ones among them.",
        answer: "All 48 are one picture.",
        members: &ORIENTATIONS,
        scenes: scenes::orientations,
        make: oriented,
    },
    HardCase {
        name: "wide-index",
        number: 25,
        about: "Noise of more voxels than 16 bits count, on which a too narrow index can be tried without a volume of gigabytes.",
        answer: "An index of 64 bits changes nothing, one of 16 bits everything.",
        members: &[],
        scenes: scenes::wide_index,
        make: |_| noise([70, 40, 30]).map(HardVolume::from),
    },
    HardCase {
        name: "clip-planes",
        number: 26,
        about: "A bump cut by planes: 64 of them, redundant, contradictory, through the eye, parallel to the rays, not normalised.",
        answer: "The kept side of every plane is what is seen: a redundant or scaled plane changes nothing, contradictory ones leave nothing.",
        members: &[],
        scenes: scenes::clip_planes,
        make: |_| bump([17; 3], unit()).map(HardVolume::from),
    },
];
