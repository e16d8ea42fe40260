//! What the replications of the field's papers share: cases beside the figures that a paper gives for
//! them, their measurement, table and plot.

mod case;
mod lazy_dataset;
mod measurement;
mod plot;
mod table;

pub use case::{Case, Paper, plain_steps, sparsely, unskipped};
pub use lazy_dataset::LazyDataset;
pub use measurement::{Measurement, SurfaceError, measure};
pub use plot::{axis, section};
pub use table::{Errors, outcome, percent_missed, speedups, tabulate};

use crate::error::Result;

use super::{Bench, Dataset, Outcome};

/// Measures a group of cases as one unit of work, and appends its rows.
///
/// # Errors
/// As [`measure`]; those of `cases`; the disk; stopped.
pub fn run_group(
    bench: &Bench,
    outcome: &mut Outcome,
    volume: &LazyDataset,
    series: &str,
    cases: impl FnOnce(&Dataset) -> Result<Vec<Case>>,
) -> Result<Vec<Measurement>> {
    let measured = bench.unit(&format!("{}/{series}", volume.name), || {
        let dataset = volume.get()?;
        measure(bench, bench.protocol(), dataset, &cases(dataset)?)
    })?;
    tabulate(outcome, &volume.name, series, &measured);
    let section = section(&volume.name, series, &measured);
    outcome.sections.push(section);
    bench.so_far(outcome)?;
    Ok(measured)
}
