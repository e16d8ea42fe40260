//! What a measurement leaves for people and programs: tables, and one self-contained page.

mod bars;
mod content;
mod figure;
mod gallery;
mod page;
mod pairs;
mod passed_on;
mod scatter;
mod table;

pub use content::{
    Axis, Bar, Bars, ErrorMap, Gallery, Mark, PairSetting, PairedPicture, Pairs, Picture, Point,
    Report, Scale, Scatter, Section,
};
pub use figure::figure;
pub use passed_on::{command_line, peer_command, without_folders};
pub use table::{Cell, Column, Shown, Table};
