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

cat <<'HEAD'
# Frame times: speed against error

Written by `scripts/view_report.sh > docs/viewer-report.md` (arguments go to `glint-view --bench`, as in `--size 960x540 --frames 9`);
do not edit. A wall fills the picture, from straight ahead (a pixel spans two texels of maps; of a dictionary's cells, halfway
between two levels of detail) and from 60° to the side, in the light that the method is made for.

- *ratio*: median time of a frame, its passes over surface and display, over that of the baseline's, whose frames take turns with
  the method's. *surface alone*: the same of the surface's pass.
- *look-ups*: elements of tables and filtered texels that a pixel reads, counted by the program, mean over the picture.
- *operations*: arithmetic that a pixel executes, and its baseline's, counted by the program likewise: sums, products, comparisons,
  conversions as one for each component, divisions, roots, exponentials as four; sides of branches that are not taken count nothing.
- *instructions*: of the whole program as SPIR-V, all lights, both sides of branches, and what constants leave out.
- *error*: sum over pixels of the luminance's difference from the method's reference over the sum of the reference's; of single
  pixels, not of their distribution, so sparse glints weigh heavily, and the reference's own noise of 256 samples is in it.

What bounds each, a pixel:

| method | loads and fetches | arithmetic |
| --- | --- | --- |
| smooth | none | an exponential |
| dictionary | two 4-byte loads a cell, for all cells under the footprint on two levels | a cell: its hash, three rounds of integer products in a row; a rotation |
| NDF maps | a tile: nine texels in one 16-byte load, two 16-byte loads of its place; random placement: four places or more, each one tile, and for it one 16-byte load of its owner and two of its transform; one word of a mask outside the highlight | a tile: two splines; a box: four error functions |
| lobes, surfaces | one 8-byte load a bilinear patch of the finest level and one more for each row of them, one 16-byte load a lobe of the others; surfaces: an offset and paths of seams besides, of one patch for a footprint's boxes and of one for each cell | a lobe: a 2 × 2 inverse, two exponentials |
| environment | smooth: a cube and a table; glints: one cube more for every four levels | four hashes for a word; a word and a binomial draw for each level but one, and one word more |
| area light | as plain LTC: one map (two with directions), two tables | a power and two roots more than plain LTC, once a lobe |

A software adapter has no texture units: a look-up is many instructions there. It
executes both sides of branches and the longest of eight pixels' loops for all of them, and has no fixed costs of a frame to divide by. What of
a ratio is look-ups and divergence does not stand for a GPU; its counts do.

HEAD
# One table: the header of the first run and the rows of all.
first=1
for pack in dictionary tiled stochastic lobes32 lobes16 surface sky4 sky8 round brushed; do
    "$bin/glint-view" "$work/$pack.glintpack" --bench "$@" > "$work/table"
    if [ $first = 1 ]; then cat "$work/table"; else sed '1,/^| ---/d' "$work/table"; fi
    first=0
done
