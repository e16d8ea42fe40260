//! The sections in which the surroundings of points are looked at, and what sectors of them weigh.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::error::Result;
use crate::gpu::{Args, Buffer, Device, Group};
use crate::render::abi::{SECTION_SQUARE, SECTORS};

/// The angles of sections about a ray, of each pixel of a square other ones, and the weights of their sectors
/// (`kernels/lib/light/section.clh`), on the device.
pub struct Sections {
    turns: Buffer<[f32; 2]>,
    sectors: Buffer<[f32; 2]>,
    sections: u32,
    steps: u32,
}

impl Sections {
    /// Uploads the tables of so many sections, in each of which so many steps are taken to either side.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device, sections: u32, steps: u32) -> Result<Self> {
        let turns: Vec<[f32; 2]> = turns(sections).map(narrowed).collect();
        let sectors: Vec<[f32; 2]> = (0..SECTORS).map(sector).map(narrowed).collect();
        Ok(Self {
            turns: Buffer::upload(device, "angles of sections", &turns)?,
            sectors: Buffer::upload(device, "weights of sectors", &sectors)?,
            sections,
            steps,
        })
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.turns.bytes() + self.sectors.bytes()
    }
}

impl Group for &Sections {
    fn add_to(self, args: Args) -> Args {
        args.value("sections", &self.sections)
            .value("steps", &self.steps)
            .read("turns", &self.turns)
            .read("sectors", &self.sectors)
    }
}

fn narrowed(two: [f64; 2]) -> [f32; 2] {
    two.map(|number| number as f32)
}

/// Cosine and sine of the angles of each pixel's sections: all pixels' divide half a turn into equal parts.
fn turns(sections: u32) -> impl Iterator<Item = [f64; 2]> {
    let pixels = SECTION_SQUARE * SECTION_SQUARE;
    (0..pixels).flat_map(move |pixel| {
        (0..sections).map(move |section| {
            let part = f64::from(section * pixels + pixel) + 0.5;
            let (sin, cos) = (PI * part / f64::from(sections * pixels)).sin_cos();
            [cos, sin]
        })
    })
}

/// The integrals of cos a · sin a and of cos² a over a sector, a the angle from the normal: sectors are equal in x/(|x| + y),
/// x = sin a and y = cos a.
fn sector(n: u32) -> [f64; 2] {
    let integrals = |n: u32| {
        let place = 2.0 * f64::from(n) / f64::from(SECTORS) - 1.0;
        let angle = if place.abs() < 1.0 {
            place.atan2(1.0 - place.abs())
        } else {
            FRAC_PI_2 * place
        };
        let (sin, cos) = angle.sin_cos();
        [sin * sin / 2.0, (angle + sin * cos) / 2.0]
    };
    let ([a, b], [c, d]) = (integrals(n), integrals(n + 1));
    [c - a, d - b]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ cos a |sin(a + g)| da over some of the sectors, as kernels sum it up.
    fn weight(degrees: f64, sectors: impl Iterator<Item = u32>) -> f64 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let weight = |n| {
            let [x, y] = sector(n);
            (cos * x + sin * y).abs()
        };
        sectors.map(weight).sum()
    }

    #[test]
    fn sectors_weigh_what_the_integral_says() {
        // The whole half circle: cos g + g sin g, from its antiderivative.
        for degrees in [0.0_f64, 30.0, 60.0, 80.0] {
            let g = degrees.to_radians();
            let whole = g.cos() + g * g.sin();
            let off = weight(degrees, 0..SECTORS) - whole;
            assert!(off.abs() < 0.003, "{degrees}: {off}");
            // The control: without |sin| it is 2, halved 1, at every angle.
            assert!(degrees < 1.0 || (whole - 1.0).abs() > 0.1);
        }
        // The sectors on one side of the normal, seen along it: a half, but for what the one in the middle has of it.
        assert!((weight(0.0, 0..SECTORS / 2) - 0.5).abs() < 1e-3);
    }

    #[test]
    fn sections_of_a_square_divide_half_a_turn() {
        for sections in [1, 2, 5] {
            let mut angles: Vec<f64> = turns(sections).map(|[cos, sin]| sin.atan2(cos)).collect();
            angles.sort_by(f64::total_cmp);
            let count = f64::from(16 * sections);
            for (n, angle) in (0..).zip(&angles) {
                assert!((angle - PI * (f64::from(n) + 0.5) / count).abs() < 1e-12);
            }
            assert_eq!(angles.len(), count as usize);
        }
    }
}
