#!/usr/bin/env bash
# Sets up what building, rendering and testing need, where it is missing. Safe to run again.
#
# On Debian and Ubuntu, as root: PoCL (OpenCL on any CPU), the ICD loader, clang (kernel lint) and
# oclgrind (kernel checks) from the distribution's packages. Elsewhere it says what to install.
set -euo pipefail

say() { printf 'setup: %s\n' "$*" >&2; }

if ! command -v cargo >/dev/null; then
    say "cargo is missing: install Rust 1.90 or later (rustup, or your distribution's package)"
    exit 1
fi

have_library() { ldconfig -p 2>/dev/null | grep -q "$1"; }
have_driver() { [ -n "${OCL_ICD_VENDORS:-}" ] || compgen -G '/etc/OpenCL/vendors/*.icd' >/dev/null; }
have_clang() { compgen -c clang | grep -qE '^clang(-[0-9]+)?$'; }

missing=()
command -v cc >/dev/null || missing+=(gcc libc6-dev)
have_library libOpenCL.so.1 || missing+=(ocl-icd-libopencl1)
have_driver || missing+=(pocl-opencl-icd)
have_clang || missing+=(clang)
command -v oclgrind >/dev/null || missing+=(oclgrind)

if [ ${#missing[@]} -eq 0 ]; then
    exit 0
fi

case "$(uname -s)" in
Linux) ;;
Darwin)
    say "missing: ${missing[*]}; install them with Homebrew: brew install pocl opencl-icd-loader llvm"
    exit 1
    ;;
*)
    say "missing: ${missing[*]}; install an OpenCL driver for your device, such as PoCL, and clang"
    exit 1
    ;;
esac

if ! command -v apt-get >/dev/null; then
    say "missing: ${missing[*]} (Debian's names); install their like, on Fedora: dnf install ocl-icd pocl clang oclgrind"
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
