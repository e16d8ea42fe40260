#!/usr/bin/env bash
# Sets up what is missing, and nothing else. Safe to run again.
#
#   scripts/setup.sh        what running needs: Rust, a C linker, the OpenCL loader and a driver (PoCL)
#   scripts/setup.sh test   and what the tests need: clang (kernel lint), oclgrind (kernel checks),
#                           Chromium (the report page)
#
# On Debian and Ubuntu, as root, from the distribution's packages. Elsewhere it says what to install.
set -euo pipefail

say() { printf 'setup: %s\n' "$*" >&2; }

if [ $# -gt 1 ] || [ "${1:-test}" != test ]; then
    say "'$*' is not understood: scripts/setup.sh takes nothing, or the word test"
    exit 2
fi

if ! command -v cargo >/dev/null; then
    say "cargo is missing: install Rust 1.90 or later (rustup, or your distribution's package)"
    exit 1
fi

libraries="$(PATH="$PATH:/sbin:/usr/sbin" ldconfig -p 2>/dev/null || true)"
have_library() {
    case "$1" in /*) [ -e "$1" ] && return 0 ;; esac
    case "$libraries" in *"$1"*) return 0 ;; esac
    compgen -G "/usr/lib*/$1" >/dev/null || compgen -G "/usr/lib/*/$1" >/dev/null
}
have_loader() {
    [ "$(uname -s)" = Darwin ] && return 0 # a framework of the system
    have_library libOpenCL.so.1
}
# A driver's .icd file names its library; the file can outlive the package that brought both.
have_driver() {
    [ "$(uname -s)" = Darwin ] && return 0
    [ -n "${OCL_ICD_VENDORS:-}" ] && return 0
    local icd library
    for icd in /etc/OpenCL/vendors/*.icd; do
        [ -r "$icd" ] || continue
        read -r library <"$icd" || true
        [ -n "$library" ] && have_library "$library" && return 0
    done
    return 1
}
have_chromium() {
    command -v chromium || command -v chromium-browser || command -v google-chrome
} >/dev/null
have_clang() { command -v clang >/dev/null || compgen -G '/usr/bin/clang-[0-9]*' >/dev/null; }

missing=()
command -v cc >/dev/null || missing+=(gcc libc6-dev)
have_loader || missing+=(ocl-icd-libopencl1)
have_driver || missing+=(pocl-opencl-icd)
if [ "${1:-}" = test ]; then
    have_clang || missing+=(clang)
    command -v oclgrind >/dev/null || missing+=(oclgrind)
    have_chromium || missing+=(chromium)
fi

if [ ${#missing[@]} -eq 0 ]; then
    exit 0
fi

case "$(uname -s)" in
Linux) ;;
Darwin)
    say "missing: ${missing[*]} (Debian's names); install their like with Homebrew: brew install llvm oclgrind, brew install --cask chromium"
    exit 1
    ;;
*)
    say "missing: ${missing[*]}; install an OpenCL driver for your device, such as PoCL, clang and Chromium"
    exit 1
    ;;
esac

if ! command -v apt-get >/dev/null; then
    say "missing: ${missing[*]} (Debian's names); install their like, on Fedora: dnf install ocl-icd pocl clang oclgrind chromium"
    exit 1
fi
apt_offers() { [[ "$(LC_ALL=C apt-cache policy "$1" 2>/dev/null)" == *"Candidate: "[0-9]* ]]; }
# Ubuntu has Chromium as a snap only. Package lists that know gcc would know it.
leave_out_chromium() {
    case " ${missing[*]} " in *" chromium "*) ;; *) return 0 ;; esac
    if apt_offers chromium || ! apt_offers gcc; then
        return 0
    fi
    say "apt has no Chromium here (Ubuntu has a snap only): the report page's tests are skipped until one is installed"
    local remaining=() package
    for package in "${missing[@]}"; do
        [ "$package" = chromium ] || remaining+=("$package")
    done
    missing=("${remaining[@]}")
    [ ${#missing[@]} -gt 0 ] || exit 0
}
leave_out_chromium
if [ "$(id -u)" -ne 0 ]; then
    say "missing: ${missing[*]}; run: sudo apt-get install --no-install-recommends ${missing[*]}"
    exit 1
fi
export DEBIAN_FRONTEND=noninteractive
apt-get update -qq
leave_out_chromium
say "installing ${missing[*]}"
apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
