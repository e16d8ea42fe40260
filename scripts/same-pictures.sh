#!/usr/bin/env bash
# Whether two builds of angioray draw the same pictures, bit by bit: 62 scenes, every layer of each.
#
#   scripts/same-pictures.sh OLD NEW     two programs, such as target/release/angioray of two checkouts
#
# All modes, quadratures, traversals and voxel types, clip planes, oblique and anisotropic volumes, a volume
# one voxel thick, lanes, the reference. Layers that count work (steps, nodes) are compared apart: they are
# reported where they differ, but are no difference of pictures. Ends with 1 where a picture differs.
set -euo pipefail

if [ $# -ne 2 ]; then
    echo "same-pictures: give two programs, OLD and NEW" >&2
    exit 2
fi
old="$(realpath "$1")"
new="$(realpath "$2")"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir old new

phantom() { "$old" phantom "$@" --quiet; }
phantom vessels -o v8.nrrd --size 64
phantom vessels -o v16.nrrd --size 48x56x40 --type u16 --spacing 0.7,0.9,1.3 --noise 0.02 --seed 2
phantom vessels -o i16.nrrd --size 48 --type i16 --noise 0.05 --seed 3
phantom vessels -o f32.nrrd --size 64x48x56 --type f32 --spacing 0.5 --noise 0.01 --seed 4
phantom noise -o noise.nrrd --size 24 --type u8
phantom marschner-lobb -o ml.nrrd --type f32
phantom vessels -o thin.nrrd --size 40x40x1
# A volume that lies askew: the same voxels under turned axes.
LC_ALL=C sed '1,/^$/{/^space directions:/d;/^spacings:/d;/^space:/d;/^space origin:/d;/^type:/i\
space: left-posterior-superior\
space directions: (0.6,0.3,0.1) (-0.3,0.7,0.2) (0.05,-0.2,0.9)\
space origin: (10,-20,5)
}' v8.nrrd >oblique.nrrd

scenes() {
    cat <<'END'
v8 --mode iso
v8 --mode iso --shading none --caps off
v8 --mode iso --iso p95 --gradient fourth-order --azimuth 40
v8 --mode iso --gradient precomputed --shading blinn-phong
v8 --mode iso --sampling fixed
v8 --mode iso --step 1 --refine bisection:4 --probe off
v8 --mode iso --step 0.7 --refine newton:3 --traverse uniform
v8 --mode iso --step 0.7 --refine illinois:3 --traverse revelles
v8 --mode iso --step 0.3 --refine none --traverse hierarchical
v8 --mode iso --skip off
v8 --mode iso --traverse kd-restart
v8 --mode iso --traverse hierarchical --octree-leaf 8
v8 --mode iso --traverse revelles
v8 --mode iso --traverse uniform
v8 --mode iso --filter nearest
v8 --mode iso --filter nearest --sampling fixed
v8 --mode iso --clip-plane 1,0.2,0,-3 --clip-plane 0,-1,0.5,20
v8 --mode iso --clip-plane 1,0.2,0,-3 --sampling fixed
v8 --mode iso --eye 30,32,30 --target 60,40,35
v8 --mode mip
v8 --mode mip --sampling fixed
v8 --mode mip --step 1 --probe off --traverse uniform
v8 --mode mip --skip off
v8 --mode mip --traverse revelles
v8 --mode mip --filter nearest
v8 --mode minip --clip-plane 0.3,0.2,1,-30
v8 --mode mean
v8 --mode mean --sampling fixed
v8 --mode lmip
v8 --mode lmip --sampling fixed
v8 --mode lmip --step 0.8 --traverse hierarchical
v8 --mode lmip --traverse uniform --lmip-threshold 40%
v8 --mode dvr
v8 --mode dvr --quad riemann
v8 --mode dvr --quad midpoint --shading phong
v8 --mode dvr --quad romberg --traverse uniform
v8 --mode dvr --quad rk4 --traverse hierarchical
v8 --mode dvr --quad preintegrated --shading phong --gradient precomputed
v8 --mode dvr --quad adaptive:0.002
v8 --mode dvr --quad adaptive --shading phong --traverse revelles
v8 --mode dvr --quad simpson --skip off
v8 --mode iso --light 0.3,-0.5,0.8 --ambient 0.2 --specular 0.4
v8 --mode dvr --shading blinn-phong --light -1,0.2,0.5 --quad adaptive
v8 --mode dvr --homogeneity 0.02
v8 --mode dvr --homogeneity 0.02 --traverse uniform --quad preintegrated
v8 --mode dvr --filter nearest --quad preintegrated
v8 --mode dvr --filter nearest --quad adaptive
v8 --mode dvr --clip-plane 1,0.2,0,-3 --shading phong
v8 --mode iso --lanes 1
v8 --mode dvr --lanes 1 --quad preintegrated
v16 --mode iso --carm 'LAO 30 CRA 20'
v16 --mode dvr --shading phong --ortho 50
v16 --mode mip --ortho 50 --azimuth 30
i16 --mode iso --roll 20
i16 --mode lmip --elevation 35
f32 --mode dvr --quad adaptive --azimuth 75
f32 --mode mip --window 10%,70%
noise --mode iso --iso 50%
ml --mode iso --iso 50% --zoom 1.7
thin --mode iso --elevation 50
oblique --mode iso --azimuth 20
oblique --mode dvr --device reference --size 24x20
END
}

differ=0
count=0
while read -r volume arguments; do
    count=$((count + 1))
    eval "given=($arguments)"
    size=(--size 67x53)
    [[ "$arguments" == *--size* ]] && size=()
    # By name: a new program may have layers that the old one lacks.
    seen=depth,normal,value,cast,kind
    [[ "$arguments" == *"--mode iso"* ]] && seen=$seen,certificate
    for which in old new; do
        for layers in "picture=$seen" work=steps,nodes; do
            "${!which}" render "$volume.nrrd" -o "$which/${layers%=*}.npy" --aov "${layers#*=}" --quiet \
                "${size[@]}" "${given[@]}"
        done
    done
    cmp -s old/picture.npy new/picture.npy || { echo "DIFFERS: $volume $arguments" && differ=1; }
    cmp -s old/work.npy new/work.npy || echo "work differs: $volume $arguments"
done < <(scenes)
if [ "$differ" -eq 0 ]; then
    echo "$count scenes: every picture is the same"
else
    exit 1
fi
