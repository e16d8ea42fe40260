//! A choice in a sentence.

use std::fmt;

use crate::number_text::concise;
use crate::options::ErrorMetric;

use super::{CONFIDENCE, Choice};

/// The setting chosen, its error and the confidence in it, and what choosing took.
impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Choice {
            bound,
            setting,
            verified,
            cost,
            ..
        } = self;
        let metric = bound.metric();
        let limit = match metric {
            ErrorMetric::Psnr => "at least",
            _ => "at most",
        };
        let outcome = if self.met {
            format!("chose {}", setting.flags())
        } else {
            format!("nothing meets it, {} is used", setting.flags())
        };
        let views = match verified.views {
            1 => String::new(),
            views => format!(" in {views} views"),
        };
        let tiles = match (verified.tiles, self.met) {
            (0, _) => "every pixel was compared with the reference".to_owned(),
            (tiles, true) => format!("verified on {tiles} fresh tiles{views}"),
            (tiles, false) => format!("by {tiles} fresh tiles{views}"),
        };
        write!(
            f,
            "max-error {metric}:{}: {outcome}: estimated {metric} {} ({limit} {} with {:.0} % confidence), \
             {tiles}; {} settings tried in {:.1} s",
            concise(bound.bound()),
            concise(rounded(self.estimate)),
            concise(rounded(self.upper)),
            100.0 * CONFIDENCE,
            self.tried.len(),
            cost.ms / 1e3,
        )
    }
}

/// Rounds to three digits, as no more are known.
fn rounded(figure: f64) -> f64 {
    format!("{figure:.2e}").parse().unwrap_or(figure)
}
