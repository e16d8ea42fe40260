//! The scenes of the hard cases, as the texts of scene files: a function a case, from its volume.

pub mod effects;
pub mod emission;
pub mod isosurface;
pub mod kinds;
pub mod pixels;
pub mod rays;
mod view;
