//! The rules that sum light along a ray: with what order they converge.

use super::super::convergence::{ORDERS, Smooth, errors, halvings, observed_order};
use super::super::{Bench, Experiment, Outcome};
use crate::error::Result;
use crate::lab::report::{Cell, Shown, Table};

pub const EXPERIMENT: Experiment = Experiment {
    name: "convergence",
    about: "the observed order of each quadrature rule of emission and absorption, on a path along \
            which the field is linear and on one along which it is a cubic",
    takes_volumes: false,
    counts_rays: false,
    times_frames: false,
    takes_peer: false,
    run,
};

const COLUMNS: [(&str, &str, Shown); 9] = [
    ("path", "field", Shown::Short),
    ("rule", "rule", Shown::Short),
    ("known_order", "order, known", Shown::Fixed(0)),
    ("color_order", "of colour", Shown::Fixed(2)),
    ("opacity_order", "of opacity", Shown::Fixed(2)),
    ("error_1", "colour error, 1 panel", Shown::Short),
    ("error_4", "4 panels", Shown::Short),
    ("error_16", "16", Shown::Short),
    ("error_64", "64", Shown::Short),
];

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = Outcome::of(Table::new(&COLUMNS));
    for smooth in [Smooth::ramp()?, Smooth::cubic()?] {
        for (method, order) in ORDERS {
            let row = bench.unit(&format!("{}/{method}", smooth.name), || {
                let errors = errors(bench.device, &smooth, method, &halvings())?;
                Ok::<Vec<Cell>, _>(vec![
                    smooth.name.into(),
                    method.to_string().into(),
                    order.into(),
                    observed_order(&errors.color, order).into(),
                    observed_order(&errors.opacity, order).into(),
                    errors.color[0].into(),
                    errors.color[2].into(),
                    errors.color[4].into(),
                    errors.color[6].into(),
                ])
            })?;
            outcome.table.push(row);
            bench.so_far(&outcome)?;
        }
    }
    outcome.findings.push(
        "an order is the slope of the error's logarithm between two steps, one half of the other, \
         above what rounding leaves; none where the errors are below that at once"
            .into(),
    );
    Ok(outcome)
}
