//! The program from outside.

#[path = "../cli_place/mod.rs"]
mod cli_place;
#[path = "../common/mod.rs"]
mod common;

mod cli_device;
mod cli_files;
mod cli_fit;
mod cli_flags;
mod cli_hardcase;
mod cli_info;
mod cli_limits;
mod cli_program;
mod cli_sampling;
mod library_examples;
