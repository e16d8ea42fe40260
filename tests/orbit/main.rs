//! Camera paths, and `angioray orbit` from outside.

#[path = "../cli_place/mod.rs"]
mod cli_place;
#[path = "../common/mod.rs"]
mod common;

mod camera_path;
mod cli_orbit;
