//! Which pixels are compared with the reference: random tiles, one out of every stratum.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use crate::extent::ImageSize;

/// Edge of a tile, pixels. Small: pixels side by side err alike, so that many small tiles say
/// more than a few large ones of as many pixels.
const SIDE_PX: u32 = 8;

/// The tiles of a picture that were not drawn yet.
pub struct Tiles {
    size: ImageSize,
    /// Column and row of each, along a Morton curve: a run of them is a compact part of the picture.
    left: Vec<[u32; 2]>,
    rng: Pcg64,
}

impl Tiles {
    pub fn new(size: ImageSize, seed: u64) -> Self {
        let (columns, rows) = (
            size.width().div_ceil(SIDE_PX),
            size.height().div_ceil(SIDE_PX),
        );
        let every = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
        let mut left: Vec<[u32; 2]> = every.collect();
        left.sort_by_key(|&tile| morton(tile));
        Self {
            size,
            left,
            rng: Pcg64::seed_from_u64(seed),
        }
    }

    /// Tiles of about `pixels` pixels in all, as their pixels' numbers: what is left of the picture
    /// is cut into as many parts of equal size, and of each one tile is drawn, all with equal
    /// probability. None comes twice; fewer than requested if no more are left.
    pub fn draw(&mut self, pixels: usize) -> Vec<Vec<u32>> {
        let wanted = pixels.div_ceil((SIDE_PX * SIDE_PX) as usize);
        let strata = wanted.min(self.left.len());
        let mut drawn = Vec::with_capacity(strata);
        let mut rest = Vec::with_capacity(self.left.len() - strata);
        for stratum in 0..strata {
            let bound = |at: usize| at * self.left.len() / strata;
            let part = &self.left[bound(stratum)..bound(stratum + 1)];
            let chosen = (self.rng.next_u64() % part.len() as u64) as usize;
            drawn.push(self.pixels(part[chosen]));
            rest.extend_from_slice(&part[..chosen]);
            rest.extend_from_slice(&part[chosen + 1..]);
        }
        if strata > 0 {
            self.left = rest;
        }
        drawn
    }

    fn pixels(&self, [column, row]: [u32; 2]) -> Vec<u32> {
        let (width, height) = (self.size.width(), self.size.height());
        let span = |at: u32, end: u32| at * SIDE_PX..((at + 1) * SIDE_PX).min(end);
        span(row, height)
            .flat_map(|y| span(column, width).map(move |x| y * width + x))
            .collect()
    }
}

/// The bits of both, in turn.
fn morton([x, y]: [u32; 2]) -> u64 {
    let spread = |v: u32| (0..32).fold(0, |bits, k| bits | u64::from(v >> k & 1) << (2 * k));
    spread(x) | spread(y) << 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn size() -> ImageSize {
        ImageSize::new(100, 50).unwrap()
    }

    #[test]
    fn no_pixel_comes_twice_and_in_the_end_all_have_come() {
        let mut tiles = Tiles::new(size(), 3);
        let mut seen = vec![0; size().pixels()];
        let mut count = |tiles: Vec<Vec<u32>>| {
            for pixel in tiles.iter().flatten() {
                seen[*pixel as usize] += 1;
            }
            tiles.len()
        };
        // 13 x 7 tiles, those at the right and below narrower.
        assert_eq!(count(tiles.draw(640)), 10);
        assert_eq!(count(tiles.draw(1_000_000)), 81);
        assert_eq!(count(tiles.draw(640)), 0);
        assert!(seen.iter().all(|&times| times == 1));
    }

    #[test]
    fn every_part_of_the_picture_has_its_tile_and_seeds_differ() {
        let size = ImageSize::new(128, 128).unwrap();
        for seed in 0..20 {
            let drawn = Tiles::new(size, seed).draw(1024);
            assert_eq!(drawn.len(), 16);
            // 16 strata of a square of 16 x 16 tiles are squares of 4 x 4.
            let mut squares: Vec<u32> = drawn
                .iter()
                .map(|tile| tile[0] % 128 / 32 + 4 * (tile[0] / 128 / 32))
                .collect();
            squares.sort_unstable();
            assert_eq!(squares, (0..16).collect::<Vec<_>>());
        }
        let draw = |seed| Tiles::new(size, seed).draw(1024);
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
    }

    #[test]
    fn tiles_are_drawn_with_equal_probability() {
        let size = ImageSize::new(32, 16).unwrap();
        let mut times = [0; 8];
        for seed in 0..4000 {
            for tile in Tiles::new(size, seed).draw(128) {
                times[(tile[0] % 32 / 8 + 4 * (tile[0] / 32 / 8)) as usize] += 1;
            }
        }
        // Binomial, 4000 of 1/4: 1000, standard deviation 27.
        assert!(times.iter().all(|n| (860..1140).contains(n)), "{times:?}");
    }
}
