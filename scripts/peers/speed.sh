#!/usr/bin/env bash
# How fast angioray is, and how fast VTK is in the same run: sets up what is missing, builds, and
# measures. Without a volume on vessel phantoms of its own.
#
#   scripts/peers/speed.sh [VOLUME...] -o DIR [more options of angioray bench speed]
set -euo pipefail

case "${1:---help}" in -h | --help)
    printf 'usage: scripts/peers/speed.sh [VOLUME...] -o DIR [more options of angioray bench speed]\n'
    exit 0
    ;;
esac

exec "$(dirname "$0")/with_vtk.sh" bench speed "$@"
