//! The extremes of a transfer function on a whole range of values, in O(1) a range.
//!
//! Colour and opacity are linear between knots, so that their extremes on a range are those at its
//! ends and at the knots inside. Knots are found through bins of equal width; transparency by a
//! prefix count of the knots that are not (Scharsach 2005, §3, with sums over knots instead of
//! values); extremes by a sparse table over the knots (Bender and Farach-Colton 2000). All of it is
//! exact, but for the rounding of a value between two knots.

use crate::render::resources::Knots;

/// A transfer function prepared for many ranges of values.
pub struct OpacityRanges<'a> {
    knots: &'a Knots,
    /// The number of bins per stored unit.
    per_unit: f64,
    /// `first[b]`: how many knots lie in bins before b.
    first: Vec<u32>,
    /// `opaque[k]`: how many of the first k knots have some opacity.
    opaque: Vec<u32>,
    /// `extremes[l][k]`: minimum and maximum of the 2^l knots from k on, per channel.
    extremes: Vec<Vec<[[f32; 4]; 2]>>,
    /// The values outside of which nothing absorbs.
    absorbing: [f32; 2],
}

const BINS: usize = 4096;

impl<'a> OpacityRanges<'a> {
    /// Prepares a transfer function for queries of ranges.
    pub fn new(knots: &'a Knots) -> Self {
        let count = knots.values.len();
        let width = f64::from(knots.values[count - 1]) - f64::from(knots.values[0]);
        let mut ranges = Self {
            knots,
            per_unit: if width > 0.0 {
                BINS as f64 / width
            } else {
                0.0
            },
            first: vec![0; BINS + 1],
            opaque: vec![0],
            extremes: vec![knots.colors.iter().map(|&c| [c, c]).collect()],
            absorbing: knots.absorbing(),
        };
        for k in 0..count {
            let bin = ranges.bin(knots.values[k]);
            ranges.first[bin + 1] += 1;
            ranges
                .opaque
                .push(ranges.opaque[k] + u32::from(knots.colors[k][3] > 0.0));
        }
        for bin in 0..BINS {
            ranges.first[bin + 1] += ranges.first[bin];
        }
        while let Some(below) = ranges.extremes.last()
            && 2 << (ranges.extremes.len() - 1) <= count
        {
            let half = 1 << (ranges.extremes.len() - 1);
            let pairs = below.iter().zip(&below[half..]);
            let joined = pairs.map(|(a, b)| join(*a, *b)).collect();
            ranges.extremes.push(joined);
        }
        ranges
    }

    /// The bin of a value, which never falls as the value grows.
    fn bin(&self, value: f32) -> usize {
        let from_first = f64::from(value) - f64::from(self.knots.values[0]);
        ((from_first * self.per_unit) as usize).min(BINS - 1)
    }

    /// How many knots lie at or below a value, or only below it.
    fn knots_before(&self, value: f32, with_equal: bool) -> usize {
        let bin = self.bin(value);
        let (from, to) = (self.first[bin] as usize, self.first[bin + 1] as usize);
        let before = |&v: &f32| if with_equal { v <= value } else { v < value };
        from + self.knots.values[from..to].partition_point(before)
    }

    /// Whether some value of a range absorbs.
    pub fn absorbs(&self, min: f32, max: f32) -> bool {
        let [from, to] = self.absorbing;
        max >= from && min <= to && !self.is_transparent(min, max)
    }

    /// Whether the opacity vanishes on all of a range.
    pub fn is_transparent(&self, min: f32, max: f32) -> bool {
        // The knots that shape the range: from the last at or below min to the first above max, or
        // to the last at max when max is a knot itself.
        let first = self.knots_before(min, true).saturating_sub(1);
        let to_max = self.knots_before(max, true);
        let touches = to_max > 0 && self.knots.values[to_max - 1] == max;
        let end = if touches {
            to_max
        } else {
            (to_max + 1).min(self.knots.values.len())
        };
        self.opaque[end] == self.opaque[first]
    }

    /// Smallest and greatest red, green, blue and opacity on a range.
    pub fn bounds(&self, min: f32, max: f32) -> [[f32; 4]; 2] {
        let (inside, end) = (self.knots_before(min, true), self.knots_before(max, true));
        let [at_min, at_max] = [(min, inside), (max, end)].map(|(v, after)| self.at(v, after));
        let ends = join([at_min; 2], [at_max; 2]);
        if inside == end {
            return ends;
        }
        let level = (end - inside).ilog2() as usize;
        let row = &self.extremes[level];
        join(ends, join(row[inside], row[end - (1 << level)]))
    }

    /// The channels at a value with `after` knots at or below it.
    fn at(&self, value: f32, after: usize) -> [f32; 4] {
        let colors = &self.knots.colors;
        if after == 0 || after == colors.len() {
            return colors[after.saturating_sub(1)];
        }
        let (below, above) = (self.knots.values[after - 1], self.knots.values[after]);
        let f = (value - below) / (above - below);
        std::array::from_fn(|c| {
            colors[after - 1][c] + (colors[after][c] - colors[after - 1][c]) * f
        })
    }
}

fn join(a: [[f32; 4]; 2], b: [[f32; 4]; 2]) -> [[f32; 4]; 2] {
    [
        std::array::from_fn(|c| a[0][c].min(b[0][c])),
        std::array::from_fn(|c| a[1][c].max(b[1][c])),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Jumps, a spike, plateaus; the colours their own.
    const POINTS: [(f32, f32); 9] = [
        (0.0, 0.0),
        (10.0, 0.0),
        (10.0, 0.5),
        (12.0, 0.0),
        (20.0, 0.0),
        (30.0, 1.0),
        (30.01, 0.25),
        (30.02, 0.75),
        (40.0, 0.75),
    ];

    fn knots() -> Knots {
        Knots {
            values: POINTS.iter().map(|p| p.0).collect(),
            colors: POINTS
                .iter()
                .map(|&(v, a)| [v / 40.0, 1.0 - a, 0.5, a])
                .collect(),
        }
    }

    /// The definition, in double precision; below: the limit from below at a jump.
    fn at(value: f64, below: bool) -> [f64; 4] {
        let knots = knots();
        let before = |&v: &f32| f64::from(v) < value || !below && f64::from(v) <= value;
        let after = knots.values.partition_point(before);
        if after == 0 || after == knots.values.len() {
            return knots.colors[after.saturating_sub(1)].map(f64::from);
        }
        let [v0, v1] = [knots.values[after - 1], knots.values[after]].map(f64::from);
        std::array::from_fn(|c| {
            let [a, b] = [knots.colors[after - 1][c], knots.colors[after][c]].map(f64::from);
            a + (b - a) * (value - v0) / (v1 - v0)
        })
    }

    /// Values of a range, dense, its ends and the limits at its jumps included.
    fn dense(min: f64, max: f64) -> Vec<[f64; 4]> {
        let mut values: Vec<f64> = (0..=1000)
            .map(|i| min + (max - min) * f64::from(i) / 1000.0)
            .collect();
        let knots = POINTS.iter().map(|p| f64::from(p.0));
        values.extend(knots.filter(|&k| min < k && k <= max));
        let mut seen: Vec<_> = values.iter().map(|&v| at(v, false)).collect();
        seen.extend(values.iter().filter(|&&v| v > min).map(|&v| at(v, true)));
        seen
    }

    fn every_range(mut test: impl FnMut(f64, f64)) {
        for lo in -4..=90 {
            for hi in lo..=90 {
                test(f64::from(lo) * 0.5, f64::from(hi) * 0.5);
            }
        }
        for lo in 0..=60 {
            for hi in lo..=60 {
                let [lo, hi] = [lo, hi].map(|i| f64::from((29.98 + f64::from(i) * 0.001) as f32));
                test(lo, hi);
            }
        }
    }

    #[test]
    fn transparency_agrees_with_dense_sampling() {
        let knots = knots();
        let ranges = OpacityRanges::new(&knots);
        let mut seen = [0, 0];
        every_range(|min, max| {
            let clear = dense(min, max).iter().all(|seen| seen[3] == 0.0);
            let answer = ranges.is_transparent(min as f32, max as f32);
            assert!(!answer || clear, "{min}..{max} is called transparent");
            // Only ranges that begin at a knot's exact value between an opaque and a transparent
            // interval are visited although they vanish.
            let begins_at_knot = POINTS.iter().any(|p| f64::from(p.0) == min);
            assert!(
                answer || !clear || begins_at_knot,
                "{min}..{max} is needlessly visited"
            );
            seen[usize::from(answer)] += 1;
        });
        assert!(seen[0] > 100 && seen[1] > 100, "{seen:?}");
    }

    #[test]
    fn bounds_are_those_of_dense_sampling() {
        let knots = knots();
        let ranges = OpacityRanges::new(&knots);
        let mut without_knots = 0;
        every_range(|min, max| {
            let [low, high] = ranges.bounds(min as f32, max as f32);
            for c in 0..4 {
                let seen = || dense(min, max).into_iter().map(|seen| seen[c]);
                let exact = [seen().fold(1.0, f64::min), seen().fold(0.0, f64::max)];
                let off = [f64::from(low[c]) - exact[0], f64::from(high[c]) - exact[1]];
                assert!(
                    off.iter().all(|o| o.abs() < 1e-4),
                    "{min}..{max} {c}: {off:?}"
                );
                // The control: the ends alone are not enough.
                let ends = at(min, false)[c].max(at(max, false)[c]);
                without_knots += usize::from((ends - exact[1]).abs() > 1e-3);
            }
        });
        assert!(without_knots > 100);
    }
}
