//! Tables of results: for reading (Markdown, HTML), for programs (CSV and JSON, unrounded).

use base64::prelude::{BASE64_STANDARD, Engine};
use maud::{Markup, html};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::figure::figure;

/// The contents of one cell of a table; as JSON a string, a number or `null`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Cell {
    /// Words, written as they are.
    Text(String),
    /// A number, unrounded.
    Number(f64),
    /// There is no such figure.
    Nothing,
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

/// Counts beyond 2^53 are rounded.
impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::Number(count as f64)
    }
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(cell: Option<T>) -> Self {
        cell.map_or(Self::Nothing, Into::into)
    }
}

/// How a column's numbers are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// A fixed number of digits behind the point.
    Fixed(usize),
    /// A share, times 100, with so many digits behind the point; one too small for them as a
    /// [`figure`].
    Percent(usize),
    /// Three significant digits, as [`figure`] writes them.
    Short,
}

impl Shown {
    fn text(self, number: f64) -> String {
        match self {
            Self::Fixed(digits) => format!("{number:.digits$}"),
            Self::Percent(digits) => {
                let percent = 100.0 * number;
                let min_shown = 0.5 * 10_f64.powi(-(digits as i32));
                if percent.abs() < min_shown {
                    figure(percent)
                } else {
                    format!("{percent:.digits$}")
                }
            }
            Self::Short => figure(number),
        }
    }
}

impl Cell {
    fn csv(&self) -> String {
        match self {
            Self::Text(text) => csv_text(text),
            Self::Number(number) => number.to_string(),
            Self::Nothing => String::new(),
        }
    }

    fn html(&self, heads_row: bool, shown: Shown) -> Markup {
        let (text, value) = match self {
            Self::Text(text) => (text.clone(), None),
            Self::Number(number) => (shown.text(*number), Some(number.to_string())),
            Self::Nothing => ("–".to_owned(), Some(String::new())),
        };
        let class = value.as_ref().map(|_| "number");
        html! {
            @if heads_row {
                th scope="row" class=[class] data-value=[value] { (text) }
            } @else {
                td class=[class] data-value=[value] { (text) }
            }
        }
    }
}

/// Text as a field of a CSV file.
fn csv_text(text: &str) -> String {
    let formula = is_formula_like(text);
    match formula || text.contains([',', '"', '\n', '\r']) {
        true => {
            let apostrophe = if formula { "'" } else { "" };
            format!("\"{apostrophe}{}\"", text.replace('"', "\"\""))
        }
        false => text.to_owned(),
    }
}

/// Whether a spreadsheet could take text for a formula, by how it begins (OWASP, CSV injection; the last
/// four are the same signs in full width). A number is not one, whatever its sign.
fn is_formula_like(text: &str) -> bool {
    const BEGINNINGS: [char; 11] = ['=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠'];
    text.starts_with(BEGINNINGS) && text.parse::<f64>().is_err()
}

/// A column: its name for programs (unit behind it), for people, and how it is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// The name for programs, with the unit behind it: `frame_ms`.
    pub key: &'static str,
    /// The name for people: `frame, ms`.
    pub title: &'static str,
    /// How the column's numbers are written for people.
    pub shown: Shown,
}

/// Rows of as many cells as there are columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    columns: Vec<Column>,
    rows: Vec<Vec<Cell>>,
    /// Rows of settings on the Pareto front, by their number.
    on_front: Vec<usize>,
}

impl Table {
    /// Makes an empty table of columns given as key, title and form.
    pub fn new(columns: &[(&'static str, &'static str, Shown)]) -> Self {
        let column = |&(key, title, shown)| Column { key, title, shown };
        Self {
            columns: columns.iter().map(column).collect(),
            rows: Vec::new(),
            on_front: Vec::new(),
        }
    }

    /// Appends a row; what is missing at its end is nothing, what is too much is left out.
    pub fn push(&mut self, mut row: Vec<Cell>) {
        row.resize(self.columns.len(), Cell::Nothing);
        self.rows.push(row);
    }

    /// Appends the row of a setting on the Pareto front, which a page makes stand out.
    pub fn push_on_front(&mut self, row: Vec<Cell>) {
        self.on_front.push(self.rows.len());
        self.push(row);
    }

    /// The rows, each of as many cells as there are columns.
    pub fn rows(&self) -> &[Vec<Cell>] {
        &self.rows
    }

    /// The table for reading, a line of Markdown each; numbers rounded as their columns say.
    pub fn markdown(&self) -> Vec<String> {
        let line = |cells: &mut dyn Iterator<Item = String>| {
            let cells = cells.map(|cell| format!(" {cell} |"));
            cells.fold(String::from("|"), |line, cell| line + &cell)
        };
        let head = line(&mut self.columns.iter().map(|column| column.title.to_owned()));
        let rule = format!("|{}", "---|".repeat(self.columns.len()));
        let rows = self.rows.iter().map(|row| {
            let cells = self.columns.iter().zip(row);
            line(&mut cells.map(|(column, cell)| match cell {
                Cell::Text(text) => text.replace('|', "\\|"),
                Cell::Number(number) => column.shown.text(*number),
                Cell::Nothing => "–".to_owned(),
            }))
        });
        [head, rule].into_iter().chain(rows).collect()
    }

    /// A row for reading: each column's title and what the row has there; without what it has not.
    pub fn named(&self, row: usize) -> Vec<(String, String)> {
        let cells = self.columns.iter().zip(&self.rows[row]);
        let named = cells.filter_map(|(column, cell)| {
            let text = match cell {
                Cell::Text(text) => text.clone(),
                Cell::Number(number) => column.shown.text(*number),
                Cell::Nothing => return None,
            };
            Some((column.title.to_owned(), text))
        });
        named.collect()
    }

    /// The table for a page, about `what`, under so many plots with a front; rounded like
    /// [`Self::markdown`], with the unrounded figures to sort by and, as CSV, to take along.
    pub(super) fn html(&self, what: &str, plots: usize) -> Markup {
        let on_front = match plots {
            0 => "on a Pareto front",
            1 => "on the Pareto front above",
            _ => "on a Pareto front above",
        };
        html! {
            div.table.card {
                @if self.rows.is_empty() {
                    p.none { "There are no rows." }
                } @else {
                    div.scroll tabindex="0" role="region" aria-label={ "Table: " (what) } {
                        table.sortable {
                            thead { tr { @for (n, column) in self.columns.iter().enumerate() {
                                th scope="col" class=[self.is_number(n).then_some("number")] {
                                    (column.title)
                                }
                            } } }
                            tbody { @for (n, row) in self.rows.iter().enumerate() {
                                tr class=[self.on_front.contains(&n).then_some("front")] {
                                    @for (n, (column, cell)) in self.columns.iter().zip(row).enumerate() {
                                        (cell.html(n == 0, column.shown))
                                    }
                                }
                            } }
                        }
                    }
                    p.note {
                        @if !self.on_front.is_empty() { span.front { (on_front) } }
                        a download="table.csv" href={
                            "data:text/csv;charset=utf-8;base64," (BASE64_STANDARD.encode(self.csv()))
                        } { "Take the unrounded figures along (CSV)" }
                    }
                }
            }
        }
    }

    /// Whether a column has figures and no text.
    fn is_number(&self, column: usize) -> bool {
        let mut cells = self.rows.iter().map(|row| &row[column]);
        cells.clone().any(|cell| matches!(cell, Cell::Number(_)))
            && !cells.any(|cell| matches!(cell, Cell::Text(_)))
    }

    /// The table as CSV (RFC 4180), the keys in the first line; unrounded, empty where there is no figure.
    ///
    /// Text that a spreadsheet would take for a formula has an apostrophe in front, by which it is read as text.
    pub fn csv(&self) -> String {
        let keys = self.columns.iter().map(|column| column.key.to_owned());
        let mut text = keys.collect::<Vec<_>>().join(",") + "\r\n";
        for row in &self.rows {
            let cells = row.iter().map(Cell::csv);
            text.push_str(&(cells.collect::<Vec<_>>().join(",") + "\r\n"));
        }
        text
    }

    /// The table as JSON, an object a row; unrounded, `null` where there is no figure.
    pub fn json(&self) -> Value {
        let object = |row: &Vec<Cell>| {
            let pairs = self.columns.iter().zip(row).map(|(column, cell)| {
                let value = match cell {
                    Cell::Text(text) => Value::from(text.as_str()),
                    Cell::Number(number) => Value::from(*number),
                    Cell::Nothing => Value::Null,
                };
                (column.key.to_owned(), value)
            });
            Value::Object(pairs.collect::<Map<_, _>>())
        };
        self.rows.iter().map(object).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new(&[
            ("name", "name", Shown::Short),
            ("missed_share", "missed, %", Shown::Percent(2)),
            ("ms", "ms", Shown::Fixed(1)),
        ]);
        table.push(vec!["a, \"b\"".into(), 0.123_456.into(), 2.25.into()]);
        table.push(vec!["c|d".into(), 0.0.into()]);
        table.push(vec!["e".into(), 3e-7.into(), None::<f64>.into()]);
        table
    }

    #[test]
    fn people_read_rounded_figures() {
        let expected = "| name | missed, % | ms |\n|---|---|---|\n\
            | a, \"b\" | 12.35 | 2.2 |\n| c\\|d | 0 | – |\n| e | 3×10⁻⁵ | – |\n";
        assert_eq!(table().markdown().join("\n") + "\n", expected);
    }

    #[test]
    fn a_spreadsheet_takes_no_text_for_a_formula() {
        let field = |cell: Cell| {
            let mut table = Table::new(&[("a", "a", Shown::Short), ("b", "b", Shown::Short)]);
            table.push(vec![cell, "x".into()]);
            let csv = table.csv();
            let row = csv.strip_prefix("a,b\r\n").unwrap();
            row.strip_suffix(",x\r\n").unwrap().to_owned()
        };
        for text in ["=1+1", "+a", "-a", "@SUM(1)", "\t=1", "\r=1", "\n=1", "＝1"] {
            assert_eq!(field(text.into()), format!("\"'{text}\""));
        }
        let with_quotes = "=HYPERLINK(\"x\",\"y\")";
        assert_eq!(
            field(with_quotes.into()),
            "\"'=HYPERLINK(\"\"x\"\",\"\"y\"\")\""
        );
        // The control: other texts, and numbers, are unchanged.
        for text in ["1+1=2", "a-b", "-5", "+1e3", "", "'a", "a=b"] {
            assert_eq!(field(text.into()), text);
        }
        assert_eq!(field((-5.25).into()), "-5.25");
        assert_eq!(field(f64::NEG_INFINITY.into()), "-inf");
    }

    #[test]
    fn programs_read_whole_figures() {
        let expected =
            "name,missed_share,ms\r\n\"a, \"\"b\"\"\",0.123456,2.25\r\nc|d,0,\r\ne,0.0000003,\r\n";
        assert_eq!(table().csv(), expected);
        let json = table().json();
        assert_eq!(json[0]["missed_share"], 0.123_456);
        assert_eq!(json[1]["ms"], Value::Null);
    }
}
