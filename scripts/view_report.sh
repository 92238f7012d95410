#!/bin/sh
# Speed against error of the viewer's methods, as docs/viewer-report.md has it: bakes packs of every method from GLINT_DATA and
# prints the tables of glint-view --bench. Arguments go to every bench, as in --frames 3 --size 480x270.
set -eu
cd "$(dirname "$0")/.."
data="${GLINT_DATA:-../shared/data}"
bin="${GLINT_BIN:-target/release}"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

bake() { "$bin/glint-bake" "$@" -q; }
bake dictionary -o "$work/dictionary.glintpack"
bake ndf-maps "$data/tiny/scratches_32x32.png" -o "$work/tiled.glintpack"
bake ndf-maps "$data/tiny/flakes_8x8.png" --placement stochastic -o "$work/stochastic.glintpack"
for k in 32 16; do
    bake lobes "$data/normals/leather_008_3dtextures.jpg" --crop 256x256+0+0 --k $k --name "leather, k = $k" -o "$work/lobes$k.glintpack"
done
bake lobes "$data/normals/scratched_gold_cgbookcase_rgba.png" --crop 256x256+0+0 --synthesize 4096x4096 -o "$work/surface.glintpack"
for k in 4 8; do
    # A material is named after its file.
    cp "$data/hdri/dancing_hall_1k.hdr" "$work/dancing_hall_K$k.hdr"
    bake environment "$work/dancing_hall_K$k.hdr" --levels $k -o "$work/sky$k.glintpack"
done
bake area-light "$data/normals/leather_008_3dtextures.jpg" -o "$work/round.glintpack"
bake area-light "$data/normals/brushed_aluminium_godot_745.png" --anisotropic -o "$work/brushed.glintpack"

# One table: the header of the first run and the rows of all.
first=1
for pack in dictionary tiled stochastic lobes32 lobes16 surface sky4 sky8 round brushed; do
    "$bin/glint-view" "$work/$pack.glintpack" --bench "$@" > "$work/table"
    if [ $first = 1 ]; then cat "$work/table"; else sed '1,/^| ---/d' "$work/table"; fi
    first=0
done
