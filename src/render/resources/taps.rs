//! Places around a pixel, from which its blur is gathered.

use crate::error::Result;
use crate::gpu::{Args, Buffer, Device, Group};
use crate::scene::DepthOfField;

/// Places in a quarter around a pixel on the device, the near before the far: column and row from it, the distance, and how
/// many pixels each counts. The others are those turned by quarters; the pixel itself is in each.
pub struct BlurTaps {
    places: Buffer<[f32; 4]>,
}

impl BlurTaps {
    /// Uploads the places of all discs.
    ///
    /// # Errors
    /// The device has no room.
    pub fn upload(device: &Device) -> Result<Self> {
        let places = places(DepthOfField::WIDEST_PX / 2.0 + 0.5);
        let narrowed: Vec<[f32; 4]> = places.iter().map(|of| of.map(|n| n as f32)).collect();
        Ok(Self {
            places: Buffer::upload(device, "places around a pixel", &narrowed)?,
        })
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.places.bytes()
    }
}

impl Group for &BlurTaps {
    fn add_to(self, args: Args) -> Args {
        args.read("taps", &self.places)
            .value("tap_count", &(self.places.count() as u32))
    }
}

/// So far around a pixel every pixel is a place.
const ALL_WITHIN_PX: f64 = 4.3;

/// The places less than `reach_px` away in the quarter that begins on the row and ends before the column. Near the pixel all are,
/// where discs are small; farther out those of a chessboard, then those of every second row and column, then of those a chessboard, and
/// so on. Each pixel is counted by the places next nearer and next farther than it, by how near its distance is to theirs, so
/// that what depends on the distance alone is summed as if every pixel were a place.
fn places(reach_px: f64) -> Vec<[f64; 4]> {
    let reach = reach_px.ceil() as i32;
    let around = |from: i32| (from..=reach).flat_map(move |y| (from..=reach).map(move |x| [x, y]));
    let within = |&[x, y]: &[i32; 2]| f64::from(x * x + y * y) < reach_px * reach_px;
    let mut places: Vec<[i32; 2]> = around(0)
        .filter(|&[x, y]| x > 0 || y == 0)
        .filter(within)
        .filter(is_place)
        .collect();
    places.sort_by_key(|&[x, y]| (x * x + y * y, y));
    let square = |[x, y]: [i32; 2]| x * x + y * y;
    let mut squares: Vec<i32> = places.iter().map(|&place| square(place)).collect();
    squares.dedup();
    let mut counted = vec![0.0; squares.len()];
    for pixel in around(-reach).filter(within) {
        let farther = squares.partition_point(|&of| of <= square(pixel));
        let (near, far) = (farther - 1, farther.min(squares.len() - 1));
        let [from, to, at] =
            [squares[near], squares[far], square(pixel)].map(|of| f64::from(of).sqrt());
        let share = if to > from {
            (at - from) / (to - from)
        } else {
            0.0
        };
        counted[near] += 1.0 - share;
        counted[far] += share;
    }
    let with_counts = |&place: &[i32; 2]| {
        let ring = squares.partition_point(|&of| of < square(place));
        let as_far = places
            .iter()
            .filter(|&&other| square(other) == square(place));
        // The pixel itself is in all quarters.
        let count = counted[ring] / (4 * as_far.count()) as f64;
        let [x, y] = place.map(f64::from);
        [x, y, f64::from(squares[ring]).sqrt(), count]
    };
    places.iter().map(with_counts).collect()
}

/// Whether a pixel is a place: as many as are one double for each √2 of the distance.
fn is_place(&[x, y]: &[i32; 2]) -> bool {
    let distance_px = f64::from(x * x + y * y).sqrt();
    let halvings = (2.0 * (distance_px / ALL_WITHIN_PX).log2()).ceil().max(0.0) as u32;
    let side = 1 << (halvings / 2);
    x % side == 0 && y % side == 0 && (halvings.is_multiple_of(2) || (x / side + y / side) % 2 == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Turned by quarters, the places sum discs as all pixels do.
    #[test]
    fn places_stand_for_all_pixels() {
        let all = places(32.5);
        let count: f64 = 4.0 * all.iter().map(|place| place[3]).sum::<f64>();
        let pixels = (-32_i32..=32).flat_map(|y| (-32..=32).map(move |x| f64::from(x * x + y * y)));
        assert!(
            (count - pixels.filter(|&square| square < 32.5 * 32.5).count() as f64).abs() < 1e-6
        );
        for radius_px in [0.5, 1.0, 2.5, 3.5, 5.0, 8.0, 13.0] {
            let disc = |distance: f64| (radius_px + 0.5 - distance).clamp(0.0, 1.0);
            let by_places: f64 = 4.0
                * all
                    .iter()
                    .map(|place| place[3] * disc(place[2]))
                    .sum::<f64>();
            let pixels =
                (-32_i32..=32).flat_map(|y| (-32..=32).map(move |x| f64::from(x * x + y * y)));
            let by_pixels: f64 = pixels.map(|square| disc(square.sqrt())).sum();
            let apart = (by_places / by_pixels - 1.0).abs();
            // What places farther out miss is made up for by what they miss of a pixel's own disc.
            let most = if radius_px + 0.5 <= ALL_WITHIN_PX {
                1e-9
            } else {
                0.06
            };
            assert!(apart <= most, "{radius_px}: {by_places} {by_pixels}");
        }
    }

    #[test]
    fn near_places_come_first_and_their_number_grows_slowly() {
        let all = places(32.5);
        assert!(all.is_sorted_by(|a, b| a[2] <= b[2]));
        assert_eq!(all[0], [0.0, 0.0, 0.0, 0.25]);
        assert!(
            all.iter()
                .all(|&[x, y, ..]| y >= 0.0 && (x > 0.0 || y == 0.0))
        );
        assert!(all.len() < 70, "{}", all.len());
    }
}
