//! Small random volumes to aim at.

use glam::DVec3;

use crate::error::Result;
use crate::extent::Dims;
use crate::lab::bench::rng::Rng;
use crate::volume::{Geometry, NonFinite, Rescale, Volume, Voxels};

/// A volume of unit spacing at the world's origin, so that world and index space are one, and the
/// iso value of the surface in it.
pub struct Target {
    /// The voxels; they start at the world's origin, 1 mm apart.
    pub volume: Volume,
    /// The surface's iso value, physical: a number that single precision holds.
    pub iso: f64,
    /// Whether the surface is closed by caps where it leaves the volume.
    pub caps: bool,
}

/// Kinds of fields, each the worst for something.
const KINDS: u32 = 5;

/// Target number `n` of a seed: noise, a field of few values (plateaus at the iso value), a smooth
/// one, signed floats, thin vessels in turn. Sides of 2 to 15 voxels, now and then 32.
///
/// # Errors
/// The volume is refused, as it is if there is no memory for it.
pub fn target(seed: u64, n: u32) -> Result<Target> {
    let mut rng = Rng::new(seed ^ (u64::from(n) << 32 | 0x7a61));
    let longest = if rng.one_in(12) { 32 } else { 15 };
    let dims = [(); 3].map(|()| u64::from(2 + rng.below(longest - 1)));
    let count = dims.iter().product::<u64>() as usize;
    let (voxels, iso): (Voxels, f64) = match n % KINDS {
        0 => {
            let voxels: Vec<u8> = (0..count).map(|_| rng.bits() as u8).collect();
            (voxels.into(), f64::from(rng.below(250)) + 2.5)
        }
        1 => {
            let voxels: Vec<u8> = (0..count).map(|_| rng.below(4) as u8).collect();
            (voxels.into(), 0.5 * f64::from(1 + rng.below(6)))
        }
        2 => {
            let waves: Vec<(DVec3, f64)> = (0..4)
                .map(|_| {
                    (
                        rng.direction() * rng.between(0.2, 1.2),
                        rng.between(0.0, 6.3),
                    )
                })
                .collect();
            let value = |p: DVec3| -> f64 {
                let sum: f64 = waves
                    .iter()
                    .map(|(k, phase)| (k.dot(p) + phase).sin())
                    .sum();
                127.5 + 30.0 * sum
            };
            let voxels: Vec<u8> = positions(dims).map(|p| value(p).round() as u8).collect();
            (voxels.into(), f64::from(rng.below(120)) + 68.0)
        }
        3 => {
            let voxels: Vec<f32> = (0..count).map(|_| rng.between(-1.0, 1.0) as f32).collect();
            (voxels.into(), f64::from(rng.between(-0.8, 0.8) as f32))
        }
        _ => {
            let far = DVec3::from_array(dims.map(|n| n as f64));
            let vessels: Vec<(DVec3, DVec3, f64)> = (0..3)
                .map(|_| {
                    let on = far * DVec3::new(rng.unit(), rng.unit(), rng.unit());
                    (on, rng.direction(), rng.between(0.3, 1.5))
                })
                .collect();
            let value = |p: DVec3| {
                let soft_edge = |(on, along, radius): &(DVec3, DVec3, f64)| {
                    (0.5 + radius - (p - *on).cross(*along).length()).clamp(0.0, 1.0)
                };
                255.0 * vessels.iter().map(soft_edge).fold(0.0, f64::max)
            };
            let voxels: Vec<u8> = positions(dims).map(|p| value(p).round() as u8).collect();
            (voxels.into(), f64::from(rng.below(200)) + 20.0)
        }
    };
    let volume = Volume::new(
        Dims::new(dims)?,
        voxels,
        Geometry::default(),
        Rescale::IDENTITY,
        NonFinite::Refuse,
    )?;
    Ok(Target {
        volume,
        iso,
        caps: rng.one_in(2),
    })
}

/// The positions of all voxels, x fastest.
fn positions([nx, ny, nz]: [u64; 3]) -> impl Iterator<Item = DVec3> {
    let at = |x: u64, y: u64, z: u64| DVec3::new(x as f64, y as f64, z as f64);
    (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| at(x, y, z))))
}
