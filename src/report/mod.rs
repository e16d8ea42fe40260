//! What a measurement leaves for people and programs: tables, and one self-contained page.

mod table;

pub use table::{Cell, Column, Shown, Table};
