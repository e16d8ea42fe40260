//! Pictures as files, error figures and error maps.

mod error_maps;
mod frame_errors;
mod frame_metrics;
mod pictures;
