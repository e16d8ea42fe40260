//! The OpenCL device, memory, kernel sources, programs, typed passes and timings. Knows no volumes.

pub mod loader;
