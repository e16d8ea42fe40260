//! The values of a picture's options that are written otherwise than as numbers (shares of the range,
//! percentiles of the voxels, Otsu's threshold), and what is said of them.

use super::numbers::concise_within;
use super::picture::PictureOptions;
use super::values::{Threshold, WindowEnds};
use super::words::Switch;
use crate::extent::Range;

impl PictureOptions {
    /// Of filled options: why a surface's iso value outside the volume's values shows no surface, and
    /// what it shows.
    pub(super) fn no_surface_note(&self, range: Range) -> Option<String> {
        let Some(Threshold::Value(iso)) = self.iso else {
            return None;
        };
        if range.contains(iso) {
            return None;
        }
        let capped = self.caps.is_none_or(Switch::is_on);
        let (side, shown) = match (iso < range.min, capped) {
            (true, true) => (
                "below",
                "all of the volume is inside, and only its caps are shown, where it ends or is clipped",
            ),
            (true, false) => (
                "below",
                "all of the volume is inside, and without caps nothing is shown",
            ),
            (false, _) => ("above", "nothing is shown"),
        };
        Some(format!(
            "iso = {} lies {side} the volume's values, {} to {}: there is no surface, {shown}",
            concise_within(iso, range),
            concise_within(range.min, range),
            concise_within(range.max, range)
        ))
    }

    /// A sentence on each value that was written otherwise than as the number that `by` has for it.
    pub(super) fn replaced(&self, by: &Self, range: Range) -> Vec<String> {
        let shown = |threshold| match threshold {
            Threshold::Value(value) => concise_within(value, range),
            other => other.to_string(),
        };
        let of = |key: &str, written: Option<Threshold>, by: Option<Threshold>| {
            let (written, by) = (written?, by?);
            (written != by).then(|| format!("{key} = {written} is {}", shown(by)))
        };
        let window = self.window.zip(by.window);
        let window = window.filter(|(written, by)| written != by);
        [
            of("iso", self.iso, by.iso),
            of("lmip-threshold", self.lmip_threshold, by.lmip_threshold),
            window.map(|(written, by)| {
                format!(
                    "window = {written} is {},{}",
                    shown(by.black),
                    shown(by.white)
                )
            }),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// With each order statistic of the voxels replaced by the value that it has among `known`.
    pub(super) fn measured(self, known: &[(f64, f64)]) -> Self {
        let value = |threshold: Threshold| {
            let known = threshold
                .percentile()
                .and_then(|percent| known.iter().find(|(of, _)| *of == percent));
            known.map_or(threshold, |(_, value)| Threshold::Value(*value))
        };
        Self {
            iso: self.iso.map(value),
            lmip_threshold: self.lmip_threshold.map(value),
            window: self.window.map(|ends| WindowEnds {
                black: value(ends.black),
                white: value(ends.white),
            }),
            ..self
        }
    }

    /// The percentages of the order statistics that are named, each once.
    pub(super) fn percentiles(&self) -> Vec<f64> {
        let ends = self.window.map(|ends| [ends.black, ends.white]);
        let named = ends.into_iter().flatten();
        let named = named.chain(self.iso).chain(self.lmip_threshold);
        let mut percents: Vec<f64> = named.filter_map(Threshold::percentile).collect();
        percents.sort_by(f64::total_cmp);
        percents.dedup();
        percents
    }
}
