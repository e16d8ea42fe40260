#!/usr/bin/env bash
# Reads a million changed headers (or as many as are given: scripts/fuzz.sh 50000) and prints what came
# of them, by kind of file. The test suite takes every hundredth.
set -euo pipefail
cd "$(dirname "$0")/.."

# In memory where there is such a place: every case is a file.
if [ -z "${TMPDIR:-}" ] && [ -w /dev/shm ]; then
    export TMPDIR=/dev/shm
fi
ANGIORAY_FUZZ_CASES="${1:-1000000}" exec cargo test --locked --test readers -- \
    --exact --nocapture reader_robustness::campaign::changed_headers_are_read_or_refused_and_nothing_else
