//! What a measurement leaves for people and programs: tables, and one self-contained page.

mod bars;
mod content;
mod figure;
mod gallery;
mod page;
mod scatter;
mod table;

pub use content::{
    Axis, Bar, Bars, ErrorMap, Gallery, Mark, Picture, Point, Report, Scale, Scatter, Section,
};
pub use figure::figure;
pub use table::{Cell, Column, Shown, Table};
