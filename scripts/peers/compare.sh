#!/usr/bin/env bash
# angioray and VTK side by side on a volume: sets up what is missing, builds, and compares.
#
#   scripts/peers/compare.sh VOLUME -o DIR [more options of angioray compare]
set -euo pipefail

case "${1:---help}" in -h | --help)
    printf 'usage: scripts/peers/compare.sh VOLUME -o DIR [more options of angioray compare]\n'
    exit 0
    ;;
esac

exec "$(dirname "$0")/with_vtk.sh" compare "$@"
