//! The house rules that the sources themselves must keep.

mod circles;
mod functions;
mod layers;
mod sources;
