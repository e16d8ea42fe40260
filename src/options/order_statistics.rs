//! Order statistics of the voxels, such as p99.5: which a picture's options name, and their values in
//! their place.

use super::SceneOptions;
use super::notes::replaced;
use super::picture::PictureOptions;
use super::threshold::{Threshold, WindowEnds};
use crate::extent::Range;

impl SceneOptions {
    /// Replaces each order statistic of the voxels, such as p99.5, by its value, and returns a sentence
    /// on each option that named one. `values` gives the physical values of percentages, which are each
    /// passed once; `range` is that of the volume, by which the sentences round.
    #[must_use]
    pub fn measured(
        mut self,
        range: Range,
        values: impl FnOnce(&[f64]) -> Vec<f64>,
    ) -> (Self, Vec<String>) {
        let percents = self.picture.percentiles();
        if percents.is_empty() {
            return (self, Vec::new());
        }
        let values = values(&percents);
        let known: Vec<(f64, f64)> = percents.into_iter().zip(values).collect();
        let named = self.picture.clone();
        self.picture = self.picture.measured(&known);
        let notes = replaced(&named, &self.picture, range);
        (self, notes)
    }
}

impl PictureOptions {
    /// Replaces each order statistic of the voxels by the value that it has among `known`.
    fn measured(self, known: &[(f64, f64)]) -> Self {
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
    fn percentiles(&self) -> Vec<f64> {
        let ends = self.window.map(|ends| [ends.black, ends.white]);
        let named = ends.into_iter().flatten();
        let named = named.chain(self.iso).chain(self.lmip_threshold);
        let mut percents: Vec<f64> = named.filter_map(Threshold::percentile).collect();
        percents.sort_by(f64::total_cmp);
        percents.dedup();
        percents
    }
}
