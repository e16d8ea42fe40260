//! The histogram as text.

use super::Histogram;
use crate::extent::Range;

impl Histogram {
    /// A bar chart of `width` columns (at least 40), up to 16 lines, each with the lower edge of
    /// its values, their share of the voxels, and a bar as long as the logarithm of their count:
    /// sparse volumes are nearly all background.
    pub fn text(&self, width: usize) -> String {
        const LINES: usize = 16;
        const LABELS: usize = 24;
        let group = self.counts.len().div_ceil(LINES);
        let sums: Vec<u64> = self.counts.chunks(group).map(|c| c.iter().sum()).collect();
        let height = |count: u64| (1.0 + count as f64).ln();
        let tallest = sums.iter().map(|&sum| height(sum)).fold(1.0, f64::max);
        let room = (width.max(40) - LABELS) as f64;
        let total = self.total().max(1) as f64;
        let mut text = String::new();
        for (line, &sum) in sums.iter().enumerate() {
            let bar = "█".repeat((room * height(sum) / tallest).round() as usize);
            let share = format!("{:.3}%", 100.0 * sum as f64 / total);
            let edge = short(self.edge(line * group), self.range);
            text.push_str(format!("{edge:>12} {share:>9}  {bar}").trim_end());
            text.push('\n');
        }
        text
    }
}

/// `value` with as many decimals as distinguish 1/1000 of the range.
fn short(value: f64, range: Range) -> String {
    let decimals = if range.width() > 0.0 {
        (3.0 - range.width().log10()).ceil().clamp(0.0, 9.0) as usize
    } else {
        3
    };
    let magnitude = range.min.abs().max(range.max.abs());
    // With an exponent, values far from zero would all look alike.
    let is_far = magnitude < 1e12 && range.width() < 1e-3 * magnitude;
    let is_large = magnitude >= 1e9 && !is_far;
    if is_large || (magnitude > 0.0 && magnitude < 1e-6) {
        format!("{value:.3e}")
    } else {
        format!("{value:.decimals$}")
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::histogram;
    use super::*;

    #[test]
    fn edges_far_from_zero_are_distinguished() {
        let edges = |min: f64, max: f64| -> Vec<String> {
            let range = Range { min, max };
            let counts = vec![1; 16];
            let text = Histogram { range, counts }.text(60);
            let first = |line: &str| line.split_whitespace().next().unwrap_or("").to_owned();
            let mut edges: Vec<String> = text.lines().map(first).collect();
            edges.dedup();
            edges
        };
        assert_eq!(edges(1e9, 1e9 + 102.6).len(), 16);
        assert_eq!(edges(1e9, 1e9 + 102.6)[8], "1000000051.3");
        // The control: a range that begins at zero is short with an exponent.
        assert_eq!(edges(0.0, 1.6e10)[1], "1.000e9");
    }

    #[test]
    fn the_chart_keeps_to_its_width() {
        let chart = histogram((0..256).map(|n| n * n).collect()).text(72);
        assert_eq!(chart.lines().count(), 16);
        let longest = |chart: &str| chart.lines().map(|line| line.chars().count()).max();
        assert_eq!(longest(&chart), Some(72));
        assert!(longest(&histogram(vec![1; 3]).text(100)) > Some(72));
        assert_eq!(histogram(vec![0]).text(0).lines().count(), 1);
    }
}
