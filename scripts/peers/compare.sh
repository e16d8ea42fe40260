#!/usr/bin/env bash
# angioray and VTK side by side on a volume: sets up what is missing, builds, and compares.
#
#   scripts/peers/compare.sh VOLUME -o DIR [more options of angioray compare]
set -euo pipefail
home="$(cd "$(dirname "$0")/../.." && pwd)"

"$home/scripts/setup.sh"
python="$("$home/scripts/peers/setup.sh")"
cargo build --release --locked --manifest-path "$home/Cargo.toml"
exec "$home/target/release/angioray" compare "$@" --peer "'$python' '$home/scripts/peers/vtk_peer.py'"
