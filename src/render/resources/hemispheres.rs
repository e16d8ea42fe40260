//! Directions over hemispheres, in which rays leave points of a surface.

use std::f64::consts::TAU;

use crate::error::Result;
use crate::gpu::{Args, Buffer, Device, Group};
use crate::render::abi::HEMISPHERES;

/// Sets of unit directions over the hemisphere about z, distributed by their cosine to it, on the device.
pub struct Hemispheres {
    directions: Buffer<[f32; 4]>,
    rays: u32,
}

impl Hemispheres {
    /// Uploads [`HEMISPHERES`] sets of so many directions.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, rays: u32) -> Result<Self> {
        let sets = (0..HEMISPHERES).flat_map(|set| directions(set, rays));
        let narrowed = sets.map(|[x, y, z]| [x as f32, y as f32, z as f32, 0.0]);
        Ok(Self {
            directions: Buffer::upload(
                device,
                "directions of rays",
                &narrowed.collect::<Vec<_>>(),
            )?,
            rays,
        })
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.directions.bytes()
    }
}

impl Group for &Hemispheres {
    fn add_to(self, args: Args) -> Args {
        args.read("hemispheres", &self.directions)
            .value("per_hemisphere", &self.rays)
    }
}

/// The directions of a set: Hammersley's points (n/N, and n's bits mirrored about the point; van der Corput 1935), shifted by
/// the set's own number round the unit square (Cranley and Patterson 1976), on a disc of equal areas, and raised from it
/// to the hemisphere (Malley's method). Neighbouring sets are shifted far apart (Roberts 2018, R₂).
fn directions(set: u32, rays: u32) -> impl Iterator<Item = [f64; 3]> {
    /// 1/ρ and 1/ρ², ρ³ = ρ + 1.
    const R2: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    let shift = R2.map(|share| (f64::from(set) * share).fract());
    (0..rays).map(move |n| {
        let mirrored = f64::from(n.reverse_bits()) / 2.0_f64.powi(32);
        let area = ((f64::from(n) + 0.5) / f64::from(rays) + shift[0]).fract();
        let (sin, cos) = (TAU * (mirrored + shift[1]).fract()).sin_cos();
        let radius = area.sqrt();
        [radius * cos, radius * sin, (1.0 - area).sqrt()]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How far the share of directions within a cone, or to one side, is from the cosine's own at most, over all sets.
    fn worst(rays: u32, is_in: impl Fn([f64; 3]) -> bool, share: f64) -> f64 {
        let apart = |set| {
            let within = directions(set, rays).filter(|dir| is_in(*dir)).count();
            (within as f64 / f64::from(rays) - share).abs()
        };
        (0..HEMISPHERES).map(apart).fold(0.0, f64::max)
    }

    #[test]
    fn directions_are_distributed_by_their_cosine() {
        for [x, y, z] in (0..HEMISPHERES).flat_map(|set| directions(set, 100)) {
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
}
