//! The experiments of `angioray bench`, from outside, and the choice by an error bound.

#[path = "../cli_place/mod.rs"]
mod cli_place;
#[path = "../common/mod.rs"]
mod common;

mod cli_bench;
mod cli_bench_effects;
mod cli_bench_papers;
mod cli_bench_pareto;
mod cli_bench_resume;
mod cli_bench_sampling;
mod cli_bench_sparse;
mod cli_bench_speed;
mod tolerance;
