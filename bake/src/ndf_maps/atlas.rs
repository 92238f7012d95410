//! The tables of all nodes in one texture: shelves of tables of about one height, a texel of zeros around each.

use super::table_fit::FittedTable;
use crate::error::{BakeError, Result};
use glint_formats::ndf_maps::MAX_EDGE;

/// Widths are multiples of this, so that rows of bytes are copied whole.
const WIDTH_UNIT: usize = 256;
/// What the shelves' ends leave empty, about.
const ROOM: f64 = 1.05;

/// An atlas, and where each table's texel (0, 0) lies in it.
pub(super) struct Atlas {
    pub size: [u32; 2],
    pub texels: Vec<u8>,
    pub places: Vec<[u32; 2]>,
}

/// Packs tables.
///
/// # Errors
/// `LimitExceeded` where they do not fit in a texture.
pub(super) fn pack(tables: &[FittedTable]) -> Result<Atlas> {
    let area: usize = tables.iter().map(FittedTable::bytes).sum();
    let widest = tables.iter().map(|table| table.size[0] + 2).max().unwrap_or(0);
    let square = (area as f64 * ROOM).sqrt() as usize;
    let width = square.max(widest).next_multiple_of(WIDTH_UNIT).min(MAX_EDGE as usize);
    // The tallest first; equal ones in their order.
    let mut order: Vec<usize> = (0..tables.len()).collect();
    order.sort_by_key(|k| (usize::MAX - tables[*k].size[1], *k));
    let mut places = vec![[0; 2]; tables.len()];
    let (mut x, mut y, mut shelf) = (1, 1, 0);
    for k in order {
        let [w, h] = tables[k].size;
        if x + w + 1 > width {
            y += shelf + 1;
            (x, shelf) = (1, 0);
        }
        shelf = shelf.max(h);
        places[k] = [x as u32, y as u32];
        x += w + 1;
    }
    let height = y + shelf + 1;
    if height > MAX_EDGE as usize {
        return Err(BakeError::LimitExceeded(format!(
            "the tables of all nodes take {width} × {height} texels, a texture has {MAX_EDGE} at most; a larger maximum error, a wider \
             finest window or a smaller part of the map takes fewer"
        )));
    }
    let mut texels = vec![0; width * height];
    for (table, place) in tables.iter().zip(&places) {
        for (j, row) in table.roots.chunks_exact(table.size[0]).enumerate() {
            let at = (place[1] as usize + j) * width + place[0] as usize;
            texels[at..at + row.len()].copy_from_slice(row);
        }
    }
    Ok(Atlas { size: [width as u32, height as u32], texels, places })
}
