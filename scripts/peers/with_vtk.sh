#!/usr/bin/env bash
# A command of angioray with VTK as its peer: sets up what is missing, builds, and runs it.
#
#   scripts/peers/with_vtk.sh COMMAND [its arguments and options]
set -euo pipefail
here="$(dirname "$0")"
home="$(cd "$here/../.." && pwd)"

case "${1:---help}" in -h | --help)
    printf 'usage: scripts/peers/with_vtk.sh COMMAND [its arguments and options]\n'
    exit 0
    ;;
esac

"$home/scripts/setup.sh"
python="$("$home/scripts/peers/setup.sh")"
cargo build --release --locked --manifest-path "$home/Cargo.toml"
# The report tells the command: by paths from here, which mean the same on another machine. The
# virtual environment's Python is a link that must not be followed.
from_here() { realpath --no-symlinks --relative-to=. "$1"; }
peer="$(printf '%q %q' "$(from_here "$python")" "$(from_here "$home/scripts/peers/vtk_peer.py")")"
exec "$home/target/release/angioray" "$@" --peer "$peer"
