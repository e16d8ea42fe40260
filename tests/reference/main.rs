//! The reference renderer against closed forms and against brute force written independently of it.

mod common;
mod degenerate;
mod emission;
mod invariance;
mod occlusion;
#[path = "../common/occlusion.rs"]
mod occlusion_cases;
mod picture;
mod projection;
#[path = "../common/slab.rs"]
mod slab;
mod surface;
mod thickness;
