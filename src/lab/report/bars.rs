//! Stacked bars in a page, drawn by style alone, with all their figures behind them.

use maud::{Markup, html};

use super::content::{Bar, Bars};
use super::figure::figure;

/// The number of colours that the style defines; further parts begin again.
const COLORS: usize = 8;

/// The part of the longest bar from which a figure of so many characters fits into it, on a phone too:
/// where the longest has 240 pixels, a character 8, and its ends 12.
fn wide_enough(characters: usize) -> f64 {
    (8.0 * characters as f64 + 12.0) / 240.0
}

pub(super) fn html(bars: &Bars) -> Markup {
    let names = names(bars);
    let longest = bars.rows.iter().map(Bar::total).fold(0.0, f64::max);
    html! {
        @if longest > 0.0 {
            figure.bars.card {
                figcaption { h3 { (bars.title) } }
                ul.legend {
                    @for (n, name) in names.iter().enumerate() {
                        li { i class={ "part-" (n % COLORS) } {} (name) }
                    }
                }
                ul.rows { @for row in &bars.rows { (row_html(row, &names, longest, &bars.unit)) } }
                details {
                    summary { "All figures" }
                    (figures(bars, &names))
                }
            }
        }
    }
}

/// The parts' names in the order of their first appearance.
fn names(bars: &Bars) -> Vec<&str> {
    let mut names = Vec::new();
    for (name, _) in bars.rows.iter().flat_map(|row| &row.parts) {
        if !names.contains(&name.as_str()) {
            names.push(name.as_str());
        }
    }
    names
}

impl Bar {
    fn total(&self) -> f64 {
        self.lengths().map(|(_, length)| length).sum()
    }

    /// The parts that have a length.
    fn lengths(&self) -> impl Iterator<Item = (&str, f64)> {
        let parts = self
            .parts
            .iter()
            .map(|(name, length)| (name.as_str(), *length));
        parts.filter(|(_, length)| length.is_finite() && *length > 0.0)
    }
}

fn row_html(row: &Bar, names: &[&str], longest: f64, unit: &str) -> Markup {
    html! {
        li {
            span.label { (row.label) }
            div.track {
                @for (name, length) in row.lengths() {
                    @let share = length / longest;
                    @let n = names.iter().position(|other| *other == name).unwrap_or(0);
                    span class={ "part-" (n % COLORS) } title={ (name) ": " (figure(length)) " " (unit) }
                        style={ "width:" (format!("{:.3}", 100.0 * share)) "%" } {
                        @if share >= wide_enough(figure(length).chars().count()) { (figure(length)) }
                    }
                }
                b { (figure(row.total())) " " (unit) }
            }
        }
    }
}

fn figures(bars: &Bars, names: &[&str]) -> Markup {
    html! {
        div.scroll tabindex="0" role="region" aria-label={ (bars.title) ", all figures" } {
            table {
                thead {
                    tr {
                        th scope="col" { (bars.unit) }
                        @for name in names { th.number scope="col" { (name) } }
                        th.number scope="col" { "total" }
                    }
                }
                tbody {
                    @for row in &bars.rows {
                        tr {
                            th scope="row" { (row.label) }
                            @for name in names {
                                @let lengths = row.lengths().filter(|(of, _)| of == name);
                                td.number { (figure(lengths.map(|(_, length)| length).sum())) }
                            }
                            td.number { (figure(row.total())) }
                        }
                    }
                }
            }
        }
    }
}
