//! Pixels: what is as thin as they are.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::super::HardCase;
use super::super::scenes::pixels::{self as scenes, LINE_RADIUS_MM};
use super::grid::{hash, volume_of};
use super::unit;

/// The voxels of the slab that straight vessels lie in.
const SLAB: [u64; 3] = [384, 384, 5];

/// How many vessels there are.
const LINES: u32 = 7;

/// The centrelines of the vessels of the hard case `pixel-lines`, in mm: a point of each, and the unit vector along
/// it. All lie in the middle of a slab across z, one in each seventh of a half turn.
pub fn line_axes() -> Vec<(DVec3, DVec3)> {
    let middle = (DVec3::from_array(SLAB.map(|n| n as f64)) - 1.0) / 2.0;
    let line = |n: u32| {
        let random = |k: u32| hash(DVec3::new(f64::from(n) + 3.0, f64::from(k) + 11.0, 29.0));
        let along = DVec2::from_angle(PI * (f64::from(n) + random(0)) / f64::from(LINES));
        let aside = along.perp() * (random(1) - 0.5) * 0.7 * SLAB[0] as f64;
        (middle + aside.extend(0.0), along.extend(0.0))
    };
    (0..LINES).map(line).collect()
}

/// 127.5 on the vessels' surfaces, falling by 40 a mm.
fn value(axes: &[(DVec3, DVec3)], p: DVec3) -> u8 {
    let distance = |(on, along): &(DVec3, DVec3)| (p - *on).cross(*along).length();
    let nearest = axes.iter().map(distance).fold(f64::INFINITY, f64::min);
    (127.5 + 40.0 * (LINE_RADIUS_MM - nearest)).clamp(0.0, 255.0) as u8
}

pub(super) const CASES: &[HardCase] = &[HardCase {
    name: "pixel-lines",
    number: 27,
    about: "Straight vessels at all angles, seen so that they are a quarter, a half, one, two and three pixels wide: a grid of rays steps over them.",
    answer: "Every pixel whose centre's ray meets a vessel is hit, however few rays are cast.",
    members: &[],
    scenes: scenes::pixel_lines,
    make: |_| {
        let axes = line_axes();
        volume_of(SLAB, unit(), |p| value(&axes, p)).map(Into::into)
    },
}];
