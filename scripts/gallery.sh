#!/bin/sh
# Pictures of every method on three maps and in three environments, from the data of GLINT_DATA, as two contact sheets in
# docs/images: `scripts/gallery.sh [FOLDER]`. Needs ImageMagick's montage and a GPU adapter.
set -eu
cd "$(dirname "$0")/.."
data="${GLINT_DATA:-../shared/data}"
bin="${GLINT_BIN:-target/release}"
out="${1:-docs/images}"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

bake() { "$bin/glint-bake" "$@" -q; }
# draw SHOT PACK... FLAGS...
draw() {
    shot="$1"
    shift
    "$bin/glint-view" "$@" --size 320x200 --headless "$work/$shot.png" -q
}
normals="$data/normals"
leather="$normals/leather_008_3dtextures.jpg"
brushed="$normals/brushed_aluminium_godot_745.png"
gold="$normals/scratched_gold_cgbookcase_rgba.png"
plate="$normals/diamond_plate_pmndrs0008.jpg"
part="--crop 256x256+0+0"

bake dictionary -o "$work/dictionary.glintpack"
for example in flakes_8x8 scratches_32x32 brushed_16x16; do
    bake ndf-maps "$data/tiny/$example.png" --placement stochastic -o "$work/ndf-$example.glintpack"
done
for name in leather brushed gold plate; do
    eval "map=\$$name"
    # shellcheck disable=SC2086 # two words
    bake lobes "$map" $part -o "$work/lobes-$name.glintpack"
    # shellcheck disable=SC2086
    bake lobes "$map" $part --synthesize 2048x2048 -o "$work/surface-$name.glintpack"
    bake area-light "$map" --anisotropic -o "$work/area-$name.glintpack"
done
for sky in dancing_hall studio_small_03 st_peters_square_night; do
    bake environment "$data/hdri/${sky}_1k.hdr" -o "$work/$sky.glintpack"
done

# Maps: a row a method.
draw a1 "$work/dictionary.glintpack" --shape sphere --alpha 0.3 --density 2e5 --samples 8
draw a2 "$work/dictionary.glintpack" --shape sphere --alpha 0.6,0.08 --density 1e7 --samples 8
draw a3 "$work/dictionary.glintpack" --shape sphere --alpha 0.5 --density 3e4 --samples 8 \
    --colour 1,0.3,0.2 --colour 0.3,0.6,1 --colour 1,0.9,0.4 --f0 0.7,0.7,0.7
row=1
for example in flakes_8x8 scratches_32x32 brushed_16x16; do
    draw b$row "$work/ndf-$example.glintpack" --shape sphere --texels-per-unit 300 --samples 8
    row=$((row + 1))
done
row=1
for name in leather brushed gold; do
    draw c$row "$work/lobes-$name.glintpack" --texels-per-unit 512 --samples 8
    draw d$row "$work/surface-$name.glintpack" --texels-per-unit 1024 --samples 8
    row=$((row + 1))
done
draw e1 "$work/area-leather.glintpack" --samples 8
draw e2 "$work/area-brushed.glintpack" --samples 8
draw e3 "$work/area-plate.glintpack" --samples 8

# Environments: a row a method, with the sun where the method's glints need one.
row=1
for sky in dancing_hall studio_small_03 st_peters_square_night; do
    pack="$work/$sky.glintpack"
    view="--shape sphere --samples 8"
    # shellcheck disable=SC2086
    {
        draw f$row "$pack" $view --alpha 0.25 --density 3e4
        draw g$row "$work/dictionary.glintpack" "$pack" $view --alpha 0.3 --density 2e5 --light sun,environment
        draw h$row "$work/ndf-flakes_8x8.glintpack" "$pack" $view --texels-per-unit 300 --alpha 0.2 --light sun,environment
        draw i$row "$work/lobes-leather.glintpack" "$pack" $view --texels-per-unit 256 --alpha 0.2 --light sun,environment
        draw j$row "$work/area-leather.glintpack" "$pack" $view --alpha 0.2 --light rect,environment
    }
    row=$((row + 1))
done
# sheet NAME PICTURE...: colours chosen by how they look, or dark surfaces turn green.
sheet() {
    name="$1"
    shift
    montage "$@" -tile 3x -geometry 320x200+2+2 -background '#181818' miff:- |
        convert - -quantize sRGB -colors 255 PNG8:"$out/$name.png"
}
sheet methods "$work"/[a-e]?.png
sheet environments "$work"/[f-j]?.png
