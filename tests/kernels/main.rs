//! The kernels: their functions, their variants, their sources, and what is cached of them.

#[path = "../common/mod.rs"]
mod common;

mod cached_kernels;
mod kernel_abi;
mod kernel_functions;
mod kernel_lint;
mod kernel_memory;
mod pass_variants;
