#!/usr/bin/env bash
# Casts ten million pixels (or as many as are given: scripts/sparse-campaign.sh 500000) of random pictures sparsely, with
# --refill certified, and whole; fails where one is lost or at another depth. Volumes named after the number are looked
# at in every second picture. With RESULTS=DIR a run that is stopped can be resumed. The test suite takes a hundredth.
set -euo pipefail
pixels="${1:-10000000}"
shift || true

manifest="$(dirname "$0")/../Cargo.toml"
options=(--rays "$pixels" --seed "${SEED:-4}")
if [ -n "${RESULTS:-}" ]; then
    options+=(--output "$RESULTS")
fi
exec cargo run --release --locked --quiet --manifest-path "$manifest" -- bench sparse-rays "$@" "${options[@]}"
