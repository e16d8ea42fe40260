#!/usr/bin/env bash
# Sets up what is missing, builds, makes a vessel-tree phantom and renders it as isosurface, maximum
# intensity projection and volume rendering into out/.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh
cargo build --release --locked
program=target/release/angioray
mkdir -p out

"$program" phantom vessels --size 256 --seed 7 -o out/vessels.nrrd
view=(--size 768x768 --azimuth 30 --elevation 15)
"$program" render out/vessels.nrrd -o out/vessels_iso.png --mode iso "${view[@]}"
"$program" render out/vessels.nrrd -o out/vessels_mip.png --mode mip "${view[@]}"
"$program" render out/vessels.nrrd -o out/vessels_dvr.png --mode dvr --tf 3dra --shading phong "${view[@]}"
echo "pictures: $PWD/out/vessels_iso.png $PWD/out/vessels_mip.png $PWD/out/vessels_dvr.png"
