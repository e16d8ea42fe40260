#!/usr/bin/env bash
# Makes the report that docs/measuring.md shows, and the pictures of it, anew in docs/report. Needs Chromium for
# the pictures. ANGIORAY names the program; without it a release build is made.
set -euo pipefail
program="${ANGIORAY:+$(realpath "$ANGIORAY")}"
cd "$(dirname "$0")/.."

if [ -z "$program" ]; then
    cargo build --release --locked
    program="$PWD/target/release/angioray"
fi
docs="$PWD/docs/report"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

cd "$work"
"$program" phantom vessels -o vessels.nrrd --size 128 --seed 7
cp "$docs/settings.toml" .
"$program" compare vessels.nrrd -o report --modes iso,mip,dvr --configs settings.toml --size 128x128 \
    --azimuth 30 --elevation 15 --fit volume --zoom 1.3 --repeats 9 --cache off
cp report/report.html "$docs/report.html"

# A page as a picture: its file, the picture's, the window's width and height.
shoot() {
    chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --virtual-time-budget=3000 \
        "--user-data-dir=$work/profile" "--window-size=$3,$4" "--screenshot=$2" "file://$1" 2>/dev/null
}

# From the first mode's pictures on.
sed 's/<\/body>/<script>document.querySelector("header").remove();<\/script><\/body>/' report/report.html >page.html
shoot "$work/page.html" "$docs/page.png" 1200 1740
cat >missed.html <<'HTML'
<body style="margin:0;display:flex;gap:6px;background:#fff;image-rendering:pixelated">
<img src="report/pictures/iso-00-reference.png" width="256"><img src="report/pictures/iso-01-step-1-plain.png" width="256"><img src="report/pictures/iso-01-step-1-plain-error.png" width="256">
HTML
shoot "$work/missed.html" "$docs/missed.png" 780 256
