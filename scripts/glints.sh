#!/bin/sh
# Pictures of counted facets, from the environments of GLINT_DATA, as one contact sheet docs/images/glints.png: `scripts/glints.sh
# [FOLDER]`. Car paint under lamps and a studio, snow under a sun and a sky, glitter under lamps and a window; below, glitter while
# the sun moves by 1 degree from picture to picture. Needs ImageMagick's montage and a GPU adapter.
set -eu
cd "$(dirname "$0")/.."
data="${GLINT_DATA:-../shared/data}"
bin="${GLINT_BIN:-target/release}"
out="${1:-docs/images}"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

bake() { "$bin/glint-bake" "$@" -q; }
draw() { "$bin/glint-view" "$@" --method glints --samples 16 -q; }

bake environment "$data/hdri/studio_small_03_1k.hdr" -o "$work/studio.glintpack"
bake environment "$data/hdri/noon_grass_1k.hdr" -o "$work/noon.glintpack"
bake glints --alpha 0.15 --density 4e6 --f0 0.6,0.05,0.03 --diffuse 0.1,0,0 --coat 1 -o "$work/paint.glintpack"
bake glints --alpha 0.8 --target beckmann --f0 0.02,0.02,0.02 --diffuse 0.85,0.88,0.92 --density 5e4 --facet-spread 0.5 \
    -o "$work/snow.glintpack"
bake glints --alpha 0.5 --density 3e4 --facet-spread 1 --f0 0.9,0.9,0.9 --diffuse 0.05,0.05,0.06 --coat 1 --coat-alpha 0.1 \
    --colour 1,0.1,0.1 --colour 0.1,1,0.2 --colour 0.1,0.3,1 --colour 1,0.7,0.1 -o "$work/glitter.glintpack"

draw "$work/paint.glintpack" "$work/studio.glintpack" --shape sphere --light environment --light points \
    --size 432x324 --headless "$work/a1.png"
draw "$work/snow.glintpack" "$work/noon.glintpack" --light sun --light environment --sun 0.3,0.25,-1 \
    --camera 20,14,0.9 --exposure -1 --size 432x324 --headless "$work/a2.png"
draw "$work/glitter.glintpack" --shape sphere --light points --light rect --exposure -3 --size 432x324 \
    --headless "$work/a3.png"
for step in 0 1 2 3 4 5; do
    # The direction turns about the vertical axis.
    sun="$(awk "BEGIN { a = (20 + $step) * 3.14159265 / 180; print 0.8 * sin(a) \",0.6,\" 0.8 * cos(a) }")"
    draw "$work/glitter.glintpack" --shape sphere --light sun --sun "$sun" --camera 20,20,1.5 --density 5e6 --exposure -2 \
        --size 212x160 --headless "$work/b$step.png"
done
montage "$work"/a*.png -tile 3x1 -geometry +4+4 -background white "$work/top.png"
montage "$work"/b*.png -tile 6x1 -geometry +4+4 -background white "$work/below.png"
montage "$work/top.png" "$work/below.png" -tile 1x2 -geometry +0+0 -background white -depth 8 "$out/glints.png"
