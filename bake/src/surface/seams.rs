//! A block of a synthesised surface that follows every seam: one of the two ways to read a surface.
//!
//! Tan et al. 2022, section 5.2, splits a footprint at the edges of patches, and takes unclustered lobes at seams. Here a block
//! that lies clear of seams is one cell of the sample, moved. Where seams cross, the cells of all patches that show a corner of
//! the block are read, and of each the quarters of lobes that lie where the surface shows that patch. Smaller blocks are read by
//! blocks of the finest level, and those by boxes of a texel, which follow every seam; boxes are also all that footprints of a
//! texel or two see.

use super::query::{SurfaceQuery, boxes_of, patch_at};
use crate::lobes::eval::{ConditionalLobe, Lobe, Patch, Query, box_lobe, conditional};
use glam::{IVec2, Mat2, UVec2, Vec2};
use glint_formats::Wrap;
use glint_formats::lobes::{Filter, LevelUniform};

/// Cells of the patches that a block shows at its corners.
struct Cells {
    count: usize,
    sources: [UVec2; 4],
}

/// Bits 0, 2, 4 … of a number as a number of their own.
fn even_bits(v: u32) -> i32 {
    let mut bits = v & 0x5555_5555;
    bits = (bits | bits >> 1) & 0x3333_3333;
    bits = (bits | bits >> 2) & 0x0f0f_0f0f;
    bits = (bits | bits >> 4) & 0x00ff_00ff;
    ((bits | bits >> 8) & 0xffff) as i32
}

/// Cells of `edge` texels of the patches that the block at surface texel `at` shows at its corners. `None` if one of them is not
/// in the sample.
fn cells_at_corners(q: &SurfaceQuery<'_>, at: IVec2, edge: i32, step: i32) -> Option<Cells> {
    let mut cells = Cells { count: 0, sources: [UVec2::ZERO; 4] };
    let params = &q.surface.lobes.params;
    let size = IVec2::new(params.width as i32, params.height as i32);
    for corner in 0..4 {
        let within = IVec2::new(corner & 1, corner >> 1) * (edge - 1);
        let texel = at.wrapping_add(within);
        let (x, y) = q.surface.synthesis.source_texel(texel.x, texel.y);
        let mut cell = IVec2::new(x as i32, y as i32) - within;
        match params.wrap {
            Wrap::Repeat => cell = cell.rem_euclid(size),
            Wrap::Clamp if cell.min_element() < 0 || (cell + edge).cmpgt(size).any() => return None,
            Wrap::Clamp => {}
        }
        if cell % step != IVec2::ZERO {
            return None;
        }
        let cell = cell.as_uvec2();
        if !cells.sources[..cells.count].contains(&cell) {
            cells.sources[cells.count] = cell;
            cells.count += 1;
        }
    }
    Some(cells)
}

/// Hands one lobe, `d` from the footprint's centre, to `visit`.
fn lobe(query: &Query, lobe: &Lobe, d: Vec2, visit: &mut impl FnMut(&ConditionalLobe)) {
    visit(&conditional(query, lobe, d));
}

/// Hands boxes of `edge` texels under the footprint to `visit`. Returns how many.
pub(super) fn boxes(q: &SurfaceQuery<'_>, edge: f32, visit: &mut impl FnMut(&ConditionalLobe)) -> u32 {
    boxes_of(q, edge, |centre| patch_at(q, centre), visit)
}

/// Offset of a quarter of a lobe from its mean, by its signs along the columns of the factor. Four quarters have the lobe's
/// moments, as the quarters of a box have: at ±√3/2 standard deviations, with half of them each.
fn quarter_offset(lobe: &Lobe, signs: Vec2) -> Vec2 {
    let d = signs * 0.866_025_4; // √3 / 2
    lobe.factor * d
}

/// The part of a lobe that is made of `count` of its quarters, whose signs sum to `signs`: weight, mean and standard deviations
/// along both columns are theirs.
fn part_of(lobe: &Lobe, count: f32, signs: Vec2) -> Lobe {
    let mean = signs / count.max(1.0);
    let d = quarter_offset(lobe, mean);
    // A quarter of the variance lies within quarters, the rest between their means.
    let narrow = |m: f32| (1.0 - 0.75 * m * m).sqrt();
    Lobe {
        weight: 0.25 * count * lobe.weight,
        position: lobe.position + d,
        normal: lobe.normal + lobe.jacobian * d,
        factor: Mat2::from_cols(lobe.factor.x_axis * narrow(mean.x), lobe.factor.y_axis * narrow(mean.y)),
        ..*lobe
    }
}

/// Hands the lobes of the cell at sample texel `source` where the block `at` lies to `visit`; if `owned`, the parts of them that
/// the surface shows there.
fn cell(
    q: &SurfaceQuery<'_>,
    level: &LevelUniform,
    source: UVec2,
    at: IVec2,
    owned: bool,
    visit: &mut impl FnMut(&ConditionalLobe),
) {
    let lobes = &q.surface.lobes;
    let params = &lobes.params;
    let place = source / params.step(level.cell_texels);
    let first = level.first_lobe + (place.y * level.cells_x + place.x) * params.lobes_per_cell;
    let corner = at.as_vec2();
    let size = UVec2::new(params.width, params.height);
    let last = IVec2::splat(level.cell_texels as i32 - 1);
    for k in 0..params.lobes_per_cell {
        let mut part = lobes.lobe(level, first + k);
        if part.weight <= 0.0 {
            continue;
        }
        if owned {
            let mut count = 0.0;
            let mut signs = Vec2::ZERO;
            for quarter in 0..4 {
                let sign = Vec2::new((quarter & 1) as f32, (quarter >> 1) as f32) * 2.0 - 1.0;
                let middle = part.position + quarter_offset(&part, sign);
                let texel = middle.as_ivec2().clamp(IVec2::ZERO, last);
                let on_surface = q.origin.wrapping_add(at).wrapping_add(texel);
                let (x, y) = q.surface.synthesis.source_texel(on_surface.x, on_surface.y);
                if UVec2::new(x, y) == (source + texel.as_uvec2()) % size {
                    count += 1.0;
                    signs += sign;
                }
            }
            if count == 0.0 {
                continue;
            }
            part = part_of(&part, count, signs);
        }
        lobe(&q.point, &part, q.point.frame.mean - corner - part.position, visit);
    }
}

/// Hands a block by cells of its own edge to `visit`, if `owned` where seams cross too. Returns whether there are such cells.
fn whole_block(
    q: &SurfaceQuery<'_>,
    level_index: usize,
    at: IVec2,
    owned: bool,
    visit: &mut impl FnMut(&ConditionalLobe),
) -> bool {
    let level = q.surface.lobes.level(level_index);
    let edge = level.cell_texels as i32;
    let step = q.surface.lobes.params.step(level.cell_texels);
    let on_surface = q.origin.wrapping_add(at);
    if let Some((x, y)) = q.surface.synthesis.block_source(on_surface.x, on_surface.y, edge, step) {
        cell(q, &level, UVec2::new(x, y), at, false, visit);
        return true;
    }
    if !owned {
        return false;
    }
    let Some(cells) = cells_at_corners(q, on_surface, edge, step as i32) else { return false };
    for source in &cells.sources[..cells.count] {
        cell(q, &level, *source, at, true, visit);
    }
    true
}

/// Hands the box of this size around `centre` to `visit`, halved along each axis over which its normals spread so far that they
/// are no Gaussian: cells beside it hold lobes of fewer normals.
fn halved(q: &SurfaceQuery<'_>, centre: Vec2, size: Vec2, visit: &mut impl FnMut(&ConditionalLobe)) {
    let place = patch_at(q, centre);
    let most = q.settings.box_range * q.point.roughness;
    let ranges = [place.jacobian.x_axis.length() * size.x, place.jacobian.y_axis.length() * size.y];
    // Larger footprints see many boxes: there only the wider range is halved.
    let least = if q.point.frame.major <= q.settings.halves_until { 0.0 } else { ranges[0].max(ranges[1]) };
    let [columns, rows] = ranges.map(|range| if range > most && range >= least { 2 } else { 1 });
    let part = size / Vec2::new(columns as f32, rows as f32);
    for j in 0..rows {
        for i in 0..columns {
            let d = part * (Vec2::new(i as f32, j as f32) + 0.5) - 0.5 * size;
            let here = place.normal + place.jacobian * d + place.twist * (d.x * d.y);
            let slopes = place.jacobian + Mat2::from_cols(place.twist * d.y, place.twist * d.x);
            let box_of = box_lobe(&Patch { normal: here, jacobian: slopes, twist: place.twist }, part);
            lobe(&q.point, &box_of, q.point.frame.mean - (centre + d), visit);
        }
    }
}

/// Hands the boxes of a block of `edge` texels to `visit`. Those of a bilinear map lie between texel centres; at the block's
/// border they are half as wide.
fn texels(q: &SurfaceQuery<'_>, at: IVec2, edge: i32, visit: &mut impl FnMut(&ConditionalLobe)) {
    let nearest = q.surface.lobes.params.filter == Filter::Nearest;
    let shift = if nearest { 0.0 } else { 0.5 };
    let last = if nearest { edge - 1 } else { edge };
    let most = Vec2::splat(edge as f32);
    for j in 0..=last {
        for i in 0..=last {
            let k = Vec2::new(i as f32, j as f32) - shift;
            let low = k.max(Vec2::ZERO);
            let high = (k + 1.0).min(most);
            halved(q, at.as_vec2() + 0.5 * (low + high), high - low, visit);
        }
    }
}

/// Hands the block of a level's edge that lies `block_place` of them from the origin to `visit`: as one block where that can be
/// read, else by its quarters and theirs, down to the finest level.
pub(super) fn block(q: &SurfaceQuery<'_>, level: usize, block_place: IVec2, visit: &mut impl FnMut(&ConditionalLobe)) {
    let levels = &q.surface.lobes.params.levels;
    let of_level = &levels[level];
    let at = block_place * of_level.cell_texels as i32;
    let finest = levels[0].cell_texels as i32;
    let frame = &q.point.frame;
    let large = (frame.minor * frame.major).sqrt() >= q.settings.owned_sigma;
    let owned = of_level.cell_texels as f32 >= q.settings.owned_from || large;
    // Blocks of the finest level in the order of their quarters: those of a larger block follow each other.
    let mut block = 0u32;
    while block < 1 << (2 * level) {
        let place = at + finest * IVec2::new(even_bits(block), even_bits(block >> 1));
        let mut size = if block == 0 { level } else { block.trailing_zeros() as usize / 2 };
        let mut found = whole_block(q, size, place, owned && size > 0, visit);
        while !found && size > 0 {
            size -= 1;
            found = whole_block(q, size, place, owned && size > 0, visit);
        }
        if !found {
            texels(q, place, finest, visit);
        }
        block += 1 << (2 * size);
    }
}
