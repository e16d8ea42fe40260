//! Readers of volume files, phantoms, and smoothing.

mod formats;
mod phantoms;
mod reader_messages;
mod reader_robustness;
mod smoothing;
