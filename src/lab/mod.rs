//! The laboratory beside the instrument: what measures the renderer, compares its settings, chooses
//! among them and reports on them. Nothing that makes a picture depends on it.

pub mod bench;
pub mod compare;
pub mod hardcases;
pub mod measure;
pub mod report;
pub mod tolerance;
