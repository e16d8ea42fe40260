#!/usr/bin/env bash
# Sets up VTK as a peer, and nothing else. Safe to run again. Prints the Python to run it with.
#
# VTK comes from PyPI into a virtual environment of its own, target/peers-venv; what it draws with
# without a screen, EGL and Mesa, from the distribution.
set -euo pipefail
cd "$(dirname "$0")/../.."

VTK=9.7.2
NUMPY=2.4.6
venv=target/peers-venv
python=$venv/bin/python

say() { printf 'setup: %s\n' "$*" >&2; }

libraries="$(PATH="$PATH:/sbin:/usr/sbin" ldconfig -p 2>/dev/null || true)"
have_library() { case "$libraries" in *"$1"*) return 0 ;; *) return 1 ;; esac; }

missing=()
command -v python3 >/dev/null || missing+=(python3)
[ -x "$python" ] || python3 -c 'import ensurepip, venv' 2>/dev/null || missing+=(python3-venv)
have_library libEGL.so.1 || missing+=(libegl1)
have_library libEGL_mesa.so.0 || missing+=(libegl-mesa0)
have_library libGL.so.1 || missing+=(libgl1)
compgen -G '/usr/lib*/dri/swrast_dri.so' >/dev/null || compgen -G '/usr/lib/*/dri/swrast_dri.so' >/dev/null ||
    missing+=(libgl1-mesa-dri)

if [ ${#missing[@]} -gt 0 ]; then
    if ! command -v apt-get >/dev/null; then
        say "missing: ${missing[*]} (Debian's names); install their like"
        exit 1
    fi
    if [ "$(id -u)" -ne 0 ]; then
        say "missing: ${missing[*]}; run: sudo apt-get install --no-install-recommends ${missing[*]}"
        exit 1
    fi
    say "installing ${missing[*]}"
    export DEBIAN_FRONTEND=noninteractive
    apt-get update -qq
    apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
fi

if ! "$python" -c "import sys, numpy, vtkmodules.vtkCommonCore as c; sys.exit(c.vtkVersion.GetVTKVersion() != '$VTK')" 2>/dev/null; then
    say "installing VTK $VTK from PyPI into $venv"
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check "vtk==$VTK" "numpy==$NUMPY" >&2
fi
printf '%s\n' "$PWD/$python"
