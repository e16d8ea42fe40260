//! Ways to make a picture, each beside what its paper says of it: what the experiments of the
//! field's papers have in common.

mod found;
mod section;
mod table;
mod test_volume;
mod way;

pub use found::{Found, SurfaceFound, measure};
pub use section::{axis, section};
pub use table::{Errors, outcome, percent_missed, speedups, tabulate};
pub use test_volume::TestVolume;
pub use way::{Paper, Way, plain_steps, unskipped};

use crate::error::Result;

use super::{Bench, Outcome, Specimen};

/// Measures a group as one unit of work, and appends its rows.
///
/// # Errors
/// As [`measure`]; those of `ways`; the disk; stopped.
pub fn run_group(
    bench: &Bench,
    outcome: &mut Outcome,
    subject: &TestVolume,
    case: &str,
    ways: impl FnOnce(&Specimen) -> Result<Vec<Way>>,
) -> Result<Vec<Found>> {
    let found = bench.unit(&format!("{}/{case}", subject.name), || {
        let specimen = subject.specimen()?;
        measure(bench, bench.protocol(), specimen, &ways(specimen)?)
    })?;
    tabulate(outcome, &subject.name, case, &found);
    outcome.sections.push(section(&subject.name, case, &found));
    bench.so_far(outcome)?;
    Ok(found)
}
