//! Jitter: where on each ray the samples at fixed steps lie.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// How the samples at fixed steps of each ray are shifted (`--jitter`).
///
/// Without it the samples of all rays lie equally far from where their rays enter the volume, so that what
/// the step loses or adds is alike in neighbouring pixels and shows as bands, the grain of cut wood. With it they
/// lie at (k + ξ)·step from the entry, k = 0, 1, …, and at the entry and the exit as ever; ξ from 0 up to 1, which
/// [`Jitter::shift`] gives, differs from ray to ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Jitter {
    /// ξ is 0 everywhere.
    #[default]
    None,
    /// ξ is one of N² offsets that repeat every N × N rays (interleaved sampling: Keller and Heidrich 2001;
    /// Scharsach 2005, §5).
    Interleaved(Interleaved),
    /// ξ is a hash of the ray's place, the frame and the seed.
    Hash {
        /// What tells one noise from another.
        seed: u32,
        /// The number of the picture in a film.
        frame: u32,
    },
    /// ξ is the same for all rays.
    Shift(Shift),
}

/// The same ξ for all rays, in parts of 2^-24 of a step: what single precision holds of every number
/// below 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Shift(u32);

/// Offsets that repeat every N × N rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Interleaved {
    side: u32,
    frame: u32,
}

/// How many values ξ has where it is no one of N² offsets.
const SHIFTS: u32 = 1 << 24;

/// For N from 2 to 16 what an offset gains per ray along x, and N times what it gains along y; see
/// [`Interleaved::rank`].
const GAINS: [(u32, u32); 15] = [
    (1, 1),
    (1, 1),
    (7, 1),
    (9, 1),
    (17, 1),
    (10, 3),
    (11, 3),
    (35, 2),
    (49, 3),
    (27, 5),
    (29, 5),
    (77, 3),
    (97, 3),
    (52, 7),
    (127, 3),
];

impl Shift {
    /// Half a step.
    pub const HALF: Self = Self(SHIFTS / 2);

    /// Makes a shift of this share of a step, from 0 up to 1, to the nearest 2^-24.
    ///
    /// # Errors
    /// Usage: a share outside [0, 1).
    pub fn new(share: f64) -> Result<Self> {
        let parts = (share * f64::from(SHIFTS)).round();
        if (0.0..f64::from(SHIFTS)).contains(&parts) && share >= 0.0 {
            return Ok(Self(parts as u32));
        }
        Err(Error::usage(format!(
            "a shift of {share} steps: it must be from 0 to below 1"
        )))
    }

    /// The share of a step.
    pub fn share(self) -> f64 {
        f64::from(self.0) / f64::from(SHIFTS)
    }

    /// The share of a step, in parts of 2^-24.
    pub fn parts(self) -> u32 {
        self.0
    }
}

impl Interleaved {
    /// The least side of the pattern.
    pub const MIN_SIDE: u32 = 2;
    /// The greatest side of the pattern.
    pub const MAX_SIDE: u32 = GAINS.len() as u32 + 1;

    /// Makes the pattern of `side` × `side` offsets, as it lies in a frame of a film.
    ///
    /// # Errors
    /// Usage: a side outside [`Self::MIN_SIDE`] to [`Self::MAX_SIDE`].
    pub fn new(side: u32, frame: u32) -> Result<Self> {
        if (Self::MIN_SIDE..=Self::MAX_SIDE).contains(&side) {
            return Ok(Self { side, frame });
        }
        Err(Error::usage(format!(
            "a pattern of {side} x {side} offsets: its side must be from {} to {}",
            Self::MIN_SIDE,
            Self::MAX_SIDE
        )))
    }

    /// The rays after which the pattern repeats, along x and along y.
    pub fn side(self) -> u32 {
        self.side
    }

    /// What an offset gains per ray along x and along y, in parts of 1/N² of a step.
    ///
    /// With g and N·h no offset occurs twice in N × N rays where g and h have no divisor in common with N.
    /// Of those they are the pair whose neighbouring offsets are furthest apart: for which the sum of
    /// 1/d² over all pairs of neighbours, across the pattern's edges and diagonals too, is least, d being their
    /// difference round the step (and of equal ones the first).
    pub fn gains(self) -> [u32; 2] {
        let (along_x, along_y) = GAINS[(self.side - Self::MIN_SIDE) as usize];
        [along_x, self.side * along_y]
    }

    /// What all offsets have gained up to this frame, in parts of 1/N² of a step: by nearly the golden section of
    /// the N² parts from frame to frame, so that each ray meets all offsets in N² frames.
    pub fn gained(self) -> u32 {
        const SECTION: f64 = 0.618_033_988_749_895;
        let all = self.side * self.side;
        let wanted = (f64::from(all) * SECTION).round() as u32;
        let coprime = |gain: &u32| gcd(*gain, self.side) == 1;
        let gain = (wanted..all).find(coprime).unwrap_or(1);
        (u64::from(gain) * u64::from(self.frame) % u64::from(all)) as u32
    }

    /// N²·ξ of the ray at column x and row y: (g·(x mod N) + N·h·(y mod N) + the frames' gain) mod N².
    pub fn rank(self, x: u32, y: u32) -> u32 {
        let [along_x, along_y] = self.gains();
        let sum = along_x * (x % self.side) + along_y * (y % self.side) + self.gained();
        sum % (self.side * self.side)
    }
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

impl Jitter {
    /// ξ of the ray at column x and row y of a picture's rays, as a fraction: its numerator and denominator.
    ///
    /// Where a pixel has n × n rays, x and y count rays: the pixel (i, j) has those from (n·i, n·j) on.
    pub fn shift(self, x: u32, y: u32) -> (u32, u32) {
        match self {
            Self::None => (0, 1),
            Self::Shift(shift) => (shift.parts(), SHIFTS),
            Self::Interleaved(pattern) => (pattern.rank(x, y), pattern.side() * pattern.side()),
            Self::Hash { seed, frame } => {
                let hash = mixed(mixed(Self::hash_key(seed, frame), x), y);
                (hash >> 8, SHIFTS)
            }
        }
    }

    /// What seed and frame put into the hash of each ray.
    pub fn hash_key(seed: u32, frame: u32) -> u32 {
        mixed(mixed(0, seed), frame)
    }

    /// Whether samples lie elsewhere than without it, in some ray.
    pub fn is_on(self) -> bool {
        self != Self::None
    }

    /// The jitter of a film's frame, counted from this one.
    #[must_use]
    pub fn at_frame(self, later: u32) -> Self {
        match self {
            Self::Interleaved(pattern) => Self::Interleaved(Interleaved {
                frame: pattern.frame.wrapping_add(later),
                ..pattern
            }),
            Self::Hash { seed, frame } => Self::Hash {
                seed,
                frame: frame.wrapping_add(later),
            },
            Self::None | Self::Shift(_) => self,
        }
    }
}

/// A number mixed into a hash: every bit of both reaches every bit of the outcome (MurmurHash3's finaliser, Appleby
/// 2011, after a step of the golden section, without which zeros would stay zeros).
fn mixed(hash: u32, number: u32) -> u32 {
    let mut bits = (hash ^ number).wrapping_add(0x9e37_79b9);
    bits = (bits ^ (bits >> 16)).wrapping_mul(0x85eb_ca6b);
    bits = (bits ^ (bits >> 13)).wrapping_mul(0xc2b2_ae35);
    bits ^ (bits >> 16)
}

impl FromStr for Jitter {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::usage(format!(
                "'{text}' is not a jitter: write none, interleaved:N, hash:SEED or shift:XI; interleaved and hash \
                 may be followed by :FRAME"
            ))
        };
        let mut parts = text.split(':');
        let name = parts.next().unwrap_or_default();
        let [first, second, third] = [parts.next(), parts.next(), parts.next()];
        let whole = |text: Option<&str>| -> Result<u32> {
            text.and_then(|text| text.parse().ok()).ok_or_else(wrong)
        };
        let frame = || second.map_or(Ok(0), |_| whole(second));
        match (name, first, second, third) {
            ("none", None, None, None) => Ok(Self::None),
            ("shift", Some(share), None, None) => {
                Shift::new(share.parse().map_err(|_| wrong())?).map(Self::Shift)
            }
            ("interleaved", Some(_), _, None) => {
                Interleaved::new(whole(first)?, frame()?).map(Self::Interleaved)
            }
            ("hash", Some(_), _, None) => Ok(Self::Hash {
                seed: whole(first)?,
                frame: frame()?,
            }),
            _ => Err(wrong()),
        }
    }
}

impl fmt::Display for Jitter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("none"),
            Self::Interleaved(Interleaved { side, frame }) => {
                write!(f, "interleaved:{side}:{frame}")
            }
            Self::Hash { seed, frame } => write!(f, "hash:{seed}:{frame}"),
            Self::Shift(shift) => write!(f, "shift:{}", shift.share()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(side: u32) -> Interleaved {
        Interleaved::new(side, 0).unwrap()
    }

    #[test]
    fn jitters_parse_and_print() {
        for (text, printed) in [
            ("none", "none"),
            ("interleaved:4", "interleaved:4:0"),
            ("interleaved:16:7", "interleaved:16:7"),
            ("hash:1", "hash:1:0"),
            ("hash:4294967295:12", "hash:4294967295:12"),
            ("shift:0.5", "shift:0.5"),
            ("shift:0", "shift:0"),
            ("shift:0.1", "shift:0.10000002384185791"),
        ] {
            let parsed: Jitter = text.parse().unwrap();
            assert_eq!(parsed.to_string(), printed);
            assert_eq!(printed.parse::<Jitter>().unwrap(), parsed);
        }
        for bad in [
            "",
            "none:1",
            "interleaved",
            "interleaved:1",
            "interleaved:17",
            "interleaved:4:x",
            "interleaved:4:1:2",
            "hash",
            "hash:",
            "hash:-1",
            "hash:4294967296",
            "hash:1:2:3",
            "shift:1",
            "shift:-0.1",
            "shift:-0.00000001",
            "shift:0.99999999",
            "shift:nan",
            "shift:0.5:1",
            "blue",
        ] {
            let refused = bad.parse::<Jitter>().unwrap_err().to_string();
            assert!(!refused.contains('\n') && !refused.is_empty(), "{refused}");
        }
    }

    #[test]
    fn every_offset_occurs_once_in_a_pattern_and_once_in_as_many_frames() {
        for side in Interleaved::MIN_SIDE..=Interleaved::MAX_SIDE {
            let all: Vec<u32> = (0..side * side).collect();
            let sorted = |mut ranks: Vec<u32>| {
                ranks.sort_unstable();
                ranks
            };
            let here = pattern(side);
            let (x0, y0) = (5, 3);
            let tile = (0..side).flat_map(|y| (0..side).map(move |x| (x0 + x, y0 + y)));
            let tile = tile.map(|(x, y)| here.rank(x, y)).collect();
            assert_eq!(sorted(tile), all, "{side}");
            let frames = (0..side * side).map(|frame| {
                let Jitter::Interleaved(later) = Jitter::Interleaved(here).at_frame(frame) else {
                    panic!("another kind");
                };
                later.rank(1, 2)
            });
            assert_eq!(sorted(frames.collect()), all, "{side}");
            assert_eq!(here.rank(1, 2), here.rank(1 + side, 2 + 7 * side));
        }
    }

    /// The sum of 1/d² over the pairs of neighbours in a pattern, per ray and by a step of 1; infinite where an offset
    /// occurs twice.
    fn crowding(side: u32, (along_x, along_y): (u32, u32)) -> f64 {
        let all = side * side;
        if gcd(along_x, side) > 1 || gcd(along_y, side) > 1 {
            return f64::INFINITY;
        }
        let rank = |x: u32, y: u32| (along_x * (x % side) + side * along_y * (y % side)) % all;
        let mut sum = 0.0;
        for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
            for (dx, dy) in [(1, 0), (0, 1), (1, 1), (1, side - 1)] {
                let apart = rank(x, y).abs_diff(rank(x + dx, y + dy));
                let apart = f64::from(apart.min(all - apart)) / f64::from(all);
                sum += 1.0 / (apart * apart);
            }
        }
        sum / f64::from(all)
    }

    #[test]
    fn neighbouring_offsets_are_as_far_apart_as_such_a_pattern_allows() {
        for side in Interleaved::MIN_SIDE..=8 {
            let of = |gains| crowding(side, gains);
            let chosen = GAINS[(side - Interleaved::MIN_SIDE) as usize];
            let pairs = (1..side * side).flat_map(|x| (1..side).map(move |y| (x, y)));
            let least = pairs.map(of).fold(f64::INFINITY, f64::min);
            assert!(of(chosen) <= least * (1.0 + 1e-12), "{side}");
        }
        // The control: offsets that rise along x are crowded.
        assert!(crowding(8, (1, 1)) > 2.0 * crowding(8, GAINS[6]));
    }

    #[test]
    fn hashes_are_even_and_differ_by_place_frame_and_seed() {
        let of = |seed, frame, x, y| Jitter::Hash { seed, frame }.shift(x, y).0;
        let n = 64;
        let all = || (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
        for (seed, frame) in [(0, 0), (1, 0), (0, 1), (u32::MAX, 9)] {
            let mut bins = [0_u32; 16];
            all().for_each(|(x, y)| bins[(of(seed, frame, x, y) >> 20) as usize] += 1);
            // 256 in each on average, with a standard deviation of 15.5.
            assert!(bins.iter().all(|&bin| bin.abs_diff(256) < 78), "{bins:?}");
            let alike = |a: (u32, u32), b: (u32, u32)| {
                let same = all().filter(|&(x, y)| of(a.0, a.1, x, y) == of(b.0, b.1, x, y));
                same.count()
            };
            assert!(alike((seed, frame), (seed, frame + 1)) < 3);
            assert!(alike((seed, frame), (seed ^ 1, frame)) < 3);
            assert_eq!(alike((seed, frame), (seed, frame)), (n * n) as usize);
        }
        // Transposed places and swapped seed and frame are others.
        assert_ne!(of(1, 2, 3, 4), of(1, 2, 4, 3));
        assert_ne!(of(1, 2, 3, 4), of(2, 1, 3, 4));
    }
}
