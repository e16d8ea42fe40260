//! The metrics by which the settings of a mode are ranked.

use crate::frame::error::Figures;
use crate::scene::Mode;

/// A metric that says in one number how wrong a picture is; 0 is right.
#[derive(Debug, Clone, Copy)]
pub struct RankingMetric {
    /// The metric's key, for programs.
    pub key: &'static str,
    /// The metric's title, for people; its unit is separate.
    pub title: &'static str,
    /// The unit of the figure for people; empty where it has none.
    pub unit: &'static str,
    /// How many of the unit are 1: shares and colours are 0 to 1 for programs.
    pub scale: f64,
    of: fn(&Figures) -> Option<f64>,
}

impl RankingMetric {
    /// The error in its unit, for people; `None` where it was not measured.
    pub fn of(&self, figures: &Figures) -> Option<f64> {
        Some(self.scale * self.unscaled(figures)?)
    }

    /// The error for programs: shares, colours of 0 to 1, voxels; `None` where it was not measured.
    pub fn unscaled(&self, figures: &Figures) -> Option<f64> {
        (self.of)(figures)
    }

    /// The metrics of a mode, the most important first.
    pub fn of_mode(mode: Mode) -> &'static [Self] {
        match mode {
            Mode::Iso => &[WRONG_HITS, COLOR_RMSE, DEPTH_P99],
            Mode::Mip | Mode::Minip | Mode::Lmip | Mode::Mean => &[VALUE_RMSE, COLOR_RMSE],
            Mode::Dvr => &[COLOR_RMSE, COLOR_MAX],
        }
    }
}

const WRONG_HITS: RankingMetric = RankingMetric {
    key: "wrong_hits",
    title: "hits missed or added",
    unit: "% of the reference's",
    scale: 100.0,
    of: |figures| {
        let depth = figures.depth?;
        let wrong = (depth.missed + depth.extra) as f64;
        // Where the reference hits nothing every hit is one too many.
        let hits = depth.reference_hits.max(1) as f64;
        Some(wrong / hits)
    },
};

const DEPTH_P99: RankingMetric = RankingMetric {
    key: "depth_p99",
    title: "depth error, 99th percentile",
    unit: "voxels",
    scale: 1.0,
    of: |figures| figures.depth?.p99,
};

const VALUE_RMSE: RankingMetric = RankingMetric {
    key: "value_rmse",
    title: "error of the projected value, rms",
    unit: "% of the value range",
    scale: 100.0,
    of: |figures| figures.value?.rmse,
};

const COLOR_RMSE: RankingMetric = RankingMetric {
    key: "color_rmse",
    title: "colour error, rms",
    unit: "% of white",
    scale: 100.0,
    of: |figures| Some(figures.color?.rmse),
};

const COLOR_MAX: RankingMetric = RankingMetric {
    key: "color_max",
    title: "colour error, greatest",
    unit: "% of white",
    scale: 100.0,
    of: |figures| Some(figures.color?.max),
};
