#!/usr/bin/env bash
# Sets up what is missing, lints host and kernels, runs every test.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh test
# Caches of built kernels per checkout: runs of other versions cannot disturb them.
export POCL_CACHE_DIR="${POCL_CACHE_DIR:-$PWD/target/pocl-cache}"
export ANGIORAY_KERNEL_CACHE="${ANGIORAY_KERNEL_CACHE:-$PWD/target/kernel-cache}"
mkdir -p "$POCL_CACHE_DIR"
# Here tests that need OpenCL or a browser must not skip, where setup.sh can bring a browser.
chromium=1
command -v chromium chromium-browser google-chrome >/dev/null || chromium=0
export REQUIRE_OPENCL="${REQUIRE_OPENCL:-1}" REQUIRE_CHROMIUM="${REQUIRE_CHROMIUM:-$chromium}" REQUIRE_EXAMPLES=1

# A checkout that is built once has no use for what speeds up the next build.
export CARGO_INCREMENTAL="${CARGO_INCREMENTAL:-0}"

cargo fmt --check
cargo clippy --locked --all-targets -- -D warnings
if cargo nextest --version >/dev/null 2>&1; then
    # Most tests build more than they render. Kernels that are not optimised are built in a third of the time and make the same
    # bits (cli_device has the test); those that measure, render long or are held against the reference stay as users have them.
    optimised='test(aimed::) | test(cli_bench_pareto) | test(cli_bench_effects) | test(quadrature::) | test(agreement::) | test(kernel_memory)'
    status=0
    ANGIORAY_KERNEL_OPTIONS=-cl-opt-disable cargo nextest run --locked --no-fail-fast -E "not ($optimised)" || status=$?
    cargo nextest run --locked --no-fail-fast -E "$optimised" || status=$?
    [ "$status" -eq 0 ] || exit "$status"
    cargo test --locked --doc
else
    cargo test --locked --no-fail-fast
fi
RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps --quiet
