//! What is known of each octree node before a ray meets it: once per iso value or transfer function.

use rayon::prelude::*;

use crate::octree::Octree;

/// A node's class, as the kernels read it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Class {
    /// Nothing to see: wholly below the iso value, or wholly transparent.
    Below = 0,
    /// Wholly at or above the iso value.
    Above = 1,
    /// Must be sampled.
    Visit = 2,
}

/// Classes of all nodes against an iso value in stored units; inside is Φ ≥ iso.
pub fn by_iso(octree: &Octree, iso: f32) -> Vec<u8> {
    classes(octree, |[min, max]| {
        if max < iso {
            Class::Below
        } else if min >= iso {
            Class::Above
        } else {
            Class::Visit
        }
    })
}

/// Classes of all nodes against a floor in stored units, of sign · Φ: `Below` where nothing is above
/// it.
pub fn by_floor(octree: &Octree, sign: f32, floor: f32) -> Vec<u8> {
    classes(octree, |[min, max]| {
        if f32::max(sign * min, sign * max) <= floor {
            Class::Below
        } else {
            Class::Visit
        }
    })
}

/// Classes of all nodes under a transfer function given by its knots, in stored units as the
/// device has them: `Below` where every value of the node's range is fully transparent.
pub fn by_opacity(octree: &Octree, values: &[f32], opacities: impl Fn(usize) -> f32) -> Vec<u8> {
    let table = TransparentRanges::new(values, opacities);
    classes(octree, |[min, max]| {
        if table.transparent(min, max) {
            Class::Below
        } else {
            Class::Visit
        }
    })
}

fn classes(octree: &Octree, class: impl Fn([f32; 2]) -> Class + Sync) -> Vec<u8> {
    octree
        .ranges()
        .par_iter()
        .map(|&range| class(range) as u8)
        .collect()
}

/// Answers in O(log knots) whether a piecewise linear opacity vanishes on a whole range, by a
/// prefix count of the knots that do not (Scharsach 2005, §3, with sums over knots instead of bins).
struct TransparentRanges<'a> {
    values: &'a [f32],
    /// `opaque[k]`: how many of the first k knots have some opacity.
    opaque: Vec<u32>,
}

impl<'a> TransparentRanges<'a> {
    fn new(values: &'a [f32], opacities: impl Fn(usize) -> f32) -> Self {
        let mut opaque = vec![0];
        for k in 0..values.len() {
            opaque.push(opaque[k] + u32::from(opacities(k) > 0.0));
        }
        Self { values, opaque }
    }

    fn transparent(&self, min: f32, max: f32) -> bool {
        // The knots that shape [min, max]: from the last at or below min to the first above max,
        // or to the last at max when max is a knot itself.
        let first = self.values.partition_point(|&v| v <= min).saturating_sub(1);
        let to_max = self.values.partition_point(|&v| v <= max);
        let touches = to_max > 0 && self.values[to_max - 1] == max;
        let end = if touches {
            to_max
        } else {
            (to_max + 1).min(self.values.len())
        };
        self.opaque[end] == self.opaque[first]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Knot, Rgb, TransferFunction};

    /// Against the definition: opacity sampled densely and at the ends.
    #[test]
    fn transparent_ranges_agree_with_dense_sampling() {
        let points = [
            (0.0, 0.0),
            (10.0, 0.0),
            (10.0, 0.5),
            (12.0, 0.0),
            (20.0, 0.0),
            (30.0, 1.0),
        ];
        let knots = points.map(|(value, opacity)| Knot {
            value,
            color: Rgb::BLACK,
            opacity,
        });
        let tf = TransferFunction::new(knots.to_vec(), 1.0).unwrap();
        let values = points.map(|(v, _)| v as f32);
        let table = TransparentRanges::new(&values, |k| points[k].1 as f32);
        let mut seen = [0, 0];
        for lo in -4..=80 {
            for hi in lo..=80 {
                let (min, max) = (f64::from(lo) * 0.5, f64::from(hi) * 0.5);
                let dense =
                    (0..=1000).all(|i| tf.at(min + (max - min) * f64::from(i) / 1000.0).1 == 0.0);
                let answer = table.transparent(min as f32, max as f32);
                assert!(!answer || dense, "{min}..{max} is called transparent");
                // Half a unit is enough room: only ranges that begin at a knot's exact value
                // between an opaque and a transparent stretch are kept although they vanish.
                if dense && !answer {
                    assert_eq!(min, 10.0_f64.max(min), "{min}..{max} is needlessly visited");
                }
                seen[usize::from(answer)] += 1;
            }
        }
        assert!(seen[0] > 100 && seen[1] > 100, "{seen:?}");
    }
}
