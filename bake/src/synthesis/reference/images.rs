//! Look-ups by definition: patches, and the strips of corner tiles, are pasted into an image, one over the other.

use super::Texel;
use crate::synthesis::bake::Synthesis;
use glint_formats::synthesis::{Layout, PathShape};

/// Entries of path number `path` of paths of one shape that begin at word `first`.
pub fn entries(surface: &Synthesis, first: usize, path: usize, shape: PathShape) -> Vec<u32> {
    let words = &surface.seams[first + path * shape.words as usize..][..shape.words as usize];
    let mut bits = Vec::new();
    for word in words {
        let used = shape.per_word * shape.bits;
        bits.extend((0..used).map(|bit| word >> bit & 1));
    }
    let entry = |k: usize| (0..shape.bits as usize).map(|b| bits[k * shape.bits as usize + b] << b).sum();
    if shape.bits == 0 { vec![0; shape.entries as usize] } else { (0..shape.entries as usize).map(entry).collect() }
}

/// An image of sample texels, with its first column and row.
pub struct Image {
    /// Surface column and row of the first texel.
    pub origin: (i64, i64),
    /// Columns.
    pub width: i64,
    /// Texels row by row; `None` where nothing was pasted.
    pub texels: Vec<Option<Texel>>,
}

impl Image {
    /// An empty image.
    pub fn new(origin: (i64, i64), width: i64, height: i64) -> Image {
        Image { origin, width, texels: vec![None; (width * height) as usize] }
    }

    /// What is pasted at a texel of the surface; `None` outside too.
    pub fn at(&self, x: i64, y: i64) -> Option<Texel> {
        self.texels.get(self.index(x, y)?).copied().flatten()
    }

    fn index(&self, x: i64, y: i64) -> Option<usize> {
        let (x, y) = (x - self.origin.0, y - self.origin.1);
        ((0..self.width).contains(&x) && y >= 0).then(|| (y * self.width + x) as usize)
    }

    /// Pastes the texels (x, y) of a patch for which `shows` holds; its texel (0, 0) lies at `at` and shows `offset`.
    pub fn paste(
        &mut self,
        surface: &Synthesis,
        at: (i64, i64),
        offset: [u16; 2],
        range: std::ops::Range<i64>,
        shows: &dyn Fn(i64, i64) -> bool,
    ) {
        for y in range.clone() {
            for x in range.clone() {
                let index = self.index(at.0 + x, at.1 + y);
                let Some(texel) = index.and_then(|index| self.texels.get_mut(index)) else { continue };
                if shows(x, y) {
                    let column = (i64::from(offset[0]) + x).rem_euclid(i64::from(surface.params.sample_width));
                    let row = (i64::from(offset[1]) + y).rem_euclid(i64::from(surface.params.sample_height));
                    *texel = Some((column as u32, row as u32));
                }
            }
        }
    }
}

/// The surface of a grid of patches, by pasting them in raster order into an image of one period; called with the image
/// before each is pasted, its column and row, its left and its upper path.
///
/// # Panics
/// When the surface is no grid of patches.
pub fn pasted(surface: &Synthesis, mut before: impl FnMut(&Image, (u32, u32), [&[u32]; 2])) -> Image {
    let Layout::Patches { columns, rows, .. } = surface.params.layout else { panic!("expected a grid of patches") };
    let (patch, overlap) = (i64::from(surface.params.patch), i64::from(surface.params.overlap));
    let mut image = Image::new((0, 0), i64::from(columns) * patch, i64::from(rows) * patch);
    // One more row and column: the first ones again, whose overlaps lie on the last.
    for row in 0..=rows {
        for column in 0..=columns {
            let number = (row % rows * columns + column % columns) as usize;
            let [left, upper] = [0, 1].map(|k| entries(surface, 0, 2 * number + k, surface.params.patch_path()));
            before(&image, (column, row), [&left, &upper]);
            let at = (i64::from(column) * patch, i64::from(row) * patch);
            image.paste(surface, at, surface.offsets[number], -overlap..patch, &|x, y| {
                (x >= 0 || x + overlap >= i64::from(left[(y + overlap) as usize]))
                    && (y >= 0 || y + overlap >= i64::from(upper[(x + overlap) as usize]))
            });
        }
    }
    image
}

/// A window of `tiles`² corner tiles from the tile `first` on, by pasting: corner patches, then middle patches over them.
/// `corner` and `variant` are the hashes of the lattice. Texels away from the edges of tiles, which middle patches hide,
/// are pasted as well.
///
/// # Panics
/// When the surface has no corner tiles.
pub fn pasted_tiles(
    surface: &Synthesis,
    first: (i64, i64),
    tiles: i64,
    corner: impl Fn(i64, i64) -> u32,
    variant: impl Fn(i64, i64) -> u32,
) -> Image {
    let Layout::CornerTiles { colours, variants, margin, .. } = surface.params.layout else { panic!("expected tiles") };
    let params = &surface.params;
    let (edge, overlap, margin_texels) = (i64::from(params.patch), i64::from(params.overlap), i64::from(margin));
    let (half, reach) = (edge / 2, margin_texels + overlap);
    let mut image = Image::new((first.0 * edge, first.1 * edge), tiles * edge, tiles * edge);
    let shape = params.colour_path(margin);
    for j in first.1..=first.1 + tiles {
        for i in first.0..=first.0 + tiles {
            let pair = |other: u32, which: usize| {
                entries(surface, 0, (2 * (other * colours + corner(i, j)) + which as u32) as usize, shape)
            };
            let (left, upper) = (pair(corner(i - 1, j), 0), pair(corner(i, j - 1), 1));
            // A corner patch goes from half an edge before its corner; its cut is known around the corner only.
            let cut = |path: &[u32], along: i64| match along - half + reach {
                k if (0..2 * reach).contains(&k) => i64::from(path[k as usize]) - overlap,
                _ => 0,
            };
            let at = (i * edge - half, j * edge - half);
            image.paste(surface, at, surface.offsets[corner(i, j) as usize], -overlap..edge, &|x, y| {
                let (x_cut, y_cut) = (cut(&left, y.max(0)), cut(&upper, x.max(0)));
                (x >= 0 || (y >= 0 && x >= x_cut)) && (y >= 0 || (x >= 0 && y >= y_cut))
            });
        }
    }
    let pairs = (colours * colours * 2 * shape.words) as usize;
    let shape = params.middle_path(margin);
    for j in first.1..first.1 + tiles {
        for i in first.0..first.0 + tiles {
            let corners = [corner(i, j), corner(i + 1, j), corner(i, j + 1), corner(i + 1, j + 1)];
            let number = corners.iter().rev().fold(0, |all, colour| all * colours + colour) * variants + variant(i, j);
            let sides: [Vec<u32>; 4] =
                std::array::from_fn(|side| entries(surface, pairs, 4 * number as usize + side, shape));
            let offset = surface.offsets[(colours + number) as usize];
            image.paste(surface, (i * edge, j * edge), offset, margin_texels..edge - margin_texels, &|x, y| {
                let (x, y) = (x - margin_texels, y - margin_texels);
                let last = edge - 2 * margin_texels - 1;
                [(x, y), (y, x), (last - x, y), (last - y, x)]
                    .iter()
                    .zip(&sides)
                    .all(|(&(depth, along), side)| depth >= i64::from(side[along as usize]))
            });
        }
    }
    image
}
