//! Sets of directions in which rays leave points of a surface.

use std::f64::consts::TAU;

use crate::error::Result;
use crate::gpu::{Args, Buffer, Device, Group};
use crate::render::abi::RAY_SETS;

/// [`RAY_SETS`] sets of as many unit directions each about z, on the device.
pub struct RaySets {
    directions: Buffer<[f32; 4]>,
    per_set: u32,
}

impl RaySets {
    /// Directions over the hemisphere about z, distributed by their cosine to it.
    ///
    /// # Errors
    /// The device has no room.
    pub fn over_hemisphere(device: &Device, rays: u32) -> Result<Self> {
        // A disc of equal areas, raised to the hemisphere (Malley's method).
        Self::upload(device, rays, |area| (1.0 - area).sqrt())
    }

    /// Directions over the disc of the sky about z that is so many radians from its middle to its edge, distributed by solid
    /// angle; of a disc without a size its middle alone.
    ///
    /// # Errors
    /// The device has no room.
    pub fn over_light(device: &Device, rays: u32, radius: f64) -> Result<Self> {
        let rays = if radius > 0.0 { rays } else { 1 };
        Self::upload(device, rays, |area| height_over_light(area, radius))
    }

    fn upload(device: &Device, rays: u32, height: impl Fn(f64) -> f64) -> Result<Self> {
        let sets = (0..RAY_SETS).flat_map(|set| directions(set, rays, &height));
        let narrowed = sets.map(|[x, y, z]| [x as f32, y as f32, z as f32, 0.0]);
        Ok(Self {
            directions: Buffer::upload(
                device,
                "directions of rays",
                &narrowed.collect::<Vec<_>>(),
            )?,
            per_set: rays,
        })
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.directions.bytes()
    }
}

impl Group for &RaySets {
    fn add_to(self, args: Args) -> Args {
        args.read("ray_sets", &self.directions)
            .value("per_set", &self.per_set)
    }
}

/// The cosine to the middle of a light within which this share of it lies.
fn height_over_light(share: f64, radius: f64) -> f64 {
    1.0 - share * 2.0 * (0.5 * radius).sin().powi(2)
}

/// The directions of a set: Hammersley's points (n/N, and n's bits mirrored about the point; van der Corput 1935), shifted by
/// the set's own number round the unit square (Cranley and Patterson 1976), raised as high as `height` has it of what is
/// within. Neighbouring sets are shifted far apart (Roberts 2018, R₂).
fn directions(set: u32, rays: u32, height: &impl Fn(f64) -> f64) -> impl Iterator<Item = [f64; 3]> {
    /// 1/ρ and 1/ρ², ρ³ = ρ + 1.
    const R2: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    let shift = R2.map(|share| (f64::from(set) * share).fract());
    (0..rays).map(move |n| {
        let mirrored = f64::from(n.reverse_bits()) / 2.0_f64.powi(32);
        let within = ((f64::from(n) + 0.5) / f64::from(rays) + shift[0]).fract();
        let (sin, cos) = (TAU * (mirrored + shift[1]).fract()).sin_cos();
        let height = height(within);
        let radius = ((1.0 - height) * (1.0 + height)).sqrt();
        [radius * cos, radius * sin, height]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How far the share of directions within a cone, or to one side, is from the cosine's own at most, over all sets.
    const OVER_HEMISPHERE: &dyn Fn(f64) -> f64 = &|area| (1.0 - area).sqrt();

    fn worst(rays: u32, is_in: impl Fn([f64; 3]) -> bool, share: f64) -> f64 {
        let apart = |set| {
            let within = directions(set, rays, &OVER_HEMISPHERE)
                .filter(|dir| is_in(*dir))
                .count();
            (within as f64 / f64::from(rays) - share).abs()
        };
        (0..RAY_SETS).map(apart).fold(0.0, f64::max)
    }

    #[test]
    fn directions_are_distributed_by_their_cosine() {
        for [x, y, z] in (0..RAY_SETS).flat_map(|set| directions(set, 100, &OVER_HEMISPHERE)) {
            assert!((x * x + y * y + z * z - 1.0).abs() < 1e-12 && z > 0.0);
        }
        // A cone of the half-angle a has the share sin^2 a of them; a half-space through the normal a half. No better than
        // N^-1/2 they would be off by 0.05 or more somewhere among so many sets.
        let cone = |degrees: f64| move |[_, _, z]: [f64; 3]| z > degrees.to_radians().cos();
        for degrees in [20.0_f64, 45.0, 70.0] {
            let share = degrees.to_radians().sin().powi(2);
            assert!(worst(256, cone(degrees), share) < 0.005, "{degrees}");
        }
        let aside = |angle: f64| move |[x, y, _]: [f64; 3]| x * angle.cos() + y * angle.sin() > 0.0;
        for angle in [0.0, 0.7, 2.0, 4.0] {
            assert!(worst(256, aside(angle), 0.5) < 0.02, "{angle}");
        }
        // The control: a solid angle's own share is another.
        assert!(worst(256, cone(45.0), 1.0 - 0.5_f64.sqrt()) > 0.1);
    }

    #[test]
    fn directions_over_a_light_fill_its_solid_angle() {
        let radius = 0.3_f64;
        let over_light = |area| height_over_light(area, radius);
        let half = 1.0 - (2.0 * (0.5 * radius).sin().powi(2)) / 2.0;
        for set in 0..RAY_SETS {
            let dirs: Vec<_> = directions(set, 64, &over_light).collect();
            assert!(
                dirs.iter()
                    .all(|[x, y, z]| (x * x + y * y + z * z - 1.0).abs() < 1e-12)
            );
            assert!(dirs.iter().all(|[_, _, z]| *z > (radius * 1.0001).cos()));
            let inner = dirs.iter().filter(|[_, _, z]| *z > half).count();
            assert!((31..=33).contains(&inner), "{set}: {inner}");
            // The control: within half the angle lies a quarter.
            let quarter = dirs.iter().filter(|[_, _, z]| *z > (0.5 * radius).cos());
            assert!((14..=18).contains(&quarter.count()));
        }
        let middle = |area| height_over_light(area, 0.0);
        assert_eq!(directions(5, 1, &middle).next().unwrap()[2], 1.0);
    }
}
