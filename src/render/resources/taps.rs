//! Places around a pixel, from which its blur is gathered.

use crate::error::Result;
use crate::gpu::{Args, Buffer, Device, Group};
use crate::scene::DepthOfField;

/// Places in a quarter around a pixel on the device, the near before the far: column and row from it, the distance, and how
/// many pixels each stands for. The others are those turned by quarters; the pixel itself is in each.
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

/// So far around a pixel every pixel counts.
const ALL_WITHIN_PX: f64 = 3.2;

/// The places less than `reach_px` away in the quarter that begins on the row and ends before the column. Near the pixel all are, where discs are small; farther out those of a chessboard, then those of every second row and column, then of
/// those a chessboard, and so on.
fn places(reach_px: f64) -> Vec<[f64; 4]> {
    let reach = reach_px.ceil() as i32;
    let quarter = (0..=reach).flat_map(|y| (0..=reach).map(move |x| [x, y]));
    let mut places: Vec<[f64; 4]> = quarter
        .filter(|&[x, y]| x > 0 || y == 0)
        .filter_map(|[x, y]| {
            let distance = f64::from(x * x + y * y).sqrt();
            let stands_for = spacing(distance);
            let side = 1 << (stands_for.ilog2() / 2);
            let on_grid = x % side == 0 && y % side == 0;
            let on_chessboard =
                stands_for.ilog2().is_multiple_of(2) || (x / side + y / side) % 2 == 0;
            (distance < reach_px && on_grid && on_chessboard).then(|| {
                [
                    f64::from(x),
                    f64::from(y),
                    distance,
                    share(distance, stands_for),
                ]
            })
        })
        .collect();
    places.sort_by(|a, b| a[2].total_cmp(&b[2]).then(a[1].total_cmp(&b[1])));
    places
}

/// What a place counts: the pixel itself, which stands in all quarters, a quarter.
fn share(distance_px: f64, stands_for: u32) -> f64 {
    if distance_px == 0.0 {
        0.25
    } else {
        f64::from(stands_for)
    }
}

/// How many pixels a place stands for at a distance: twice as many for each √2 of it.
fn spacing(distance_px: f64) -> u32 {
    let doublings = (2.0 * (distance_px / ALL_WITHIN_PX).log2()).ceil();
    1 << doublings.max(0.0) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Turned by quarters the places stand for all pixels of a disc, each once, wherever its rim is.
    #[test]
    fn places_stand_for_all_pixels() {
        for radius_px in [0.5_f64, 1.5, 2.5, 3.0, 5.0, 8.0, 13.0, 21.0, 32.0] {
            let counted: f64 = 4.0 * places(radius_px).iter().map(|place| place[3]).sum::<f64>();
            let reach = radius_px.ceil() as i64;
            let squares =
                (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| x * x + y * y));
            let pixels = squares
                .filter(|&square| (square as f64) < radius_px * radius_px)
                .count() as f64;
            let apart = (counted / pixels - 1.0).abs();
            let most = if radius_px <= ALL_WITHIN_PX {
                0.0
            } else {
                0.12
            };
            assert!(apart <= most, "{radius_px}: {counted} {pixels}");
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
