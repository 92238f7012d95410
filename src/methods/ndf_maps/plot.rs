//! Pictures of the NDFs of nodes, of the example's normals, and of who owns which sub-region of a stochastic surface.

use super::histogram;
use crate::canvas::{Canvas, colour_wheel, heat};
use crate::exit::{Exit, Failure};
use crate::methods::plots::{WritePlot, stems};
use glam::Vec2;
use glint_bake_core::ndf_maps::baked::{BakedNdfMaps, BakedPlacement};
use glint_bake_core::ndf_maps::sections;
use glint_formats::Pack;
use glint_formats::ndf_maps::{Level, PARAMS, PlacementKind};

const BACKGROUND: [u8; 3] = [16, 16, 20];
const CIRCLE: [u8; 3] = [70, 74, 84];
/// Most nodes a row and a column of a sheet; more would be too small to see.
const MAX_NODES: u32 = 64;
/// Most cells a side of a placement picture.
const MAX_CELLS: u32 = 64;

/// Pictures of every material: nodes of each level, normals, placement, and errors of nodes.
///
/// # Errors
/// Bad input, when a material cannot be used; those of `write`.
pub fn write_all(pack: &Pack, write: &mut WritePlot<'_>) -> Result<(), Failure> {
    for (stem, name) in stems(pack, PARAMS) {
        let material = sections::from_pack(pack, name)
            .map_err(|e| Failure::new(Exit::BadInput, format!("material {name}: {e}")))?;
        for (k, level) in material.maps.params.levels.iter().enumerate() {
            let sheet = contact_sheet(&material.maps, level);
            write(format!("{stem}-nodes-{k}.png"), sheet.to_png())?;
        }
        write(format!("{stem}-normals.png"), normals(&material.maps).to_png())?;
        if let Some(owners) = owners(&material.placement) {
            write(format!("{stem}-placement.png"), owners.to_png())?;
        }
        write(format!("{stem}-errors.svg"), histogram::svg(name, &material.maps).into_bytes())?;
    }
    Ok(())
}

/// All nodes of a level, row by row: each a unit disk with +Y up, brightness the square root of density relative to the level's peak.
fn contact_sheet(maps: &BakedNdfMaps, level: &Level) -> Canvas {
    let (columns, rows) = (level.nodes_x.min(MAX_NODES), level.nodes_y.min(MAX_NODES));
    let cell = (1024 / columns.max(rows)).clamp(24, 320);
    let mut values = vec![0.0f32; (columns * cell * rows * cell) as usize];
    for y in 0..rows * cell {
        for x in 0..columns * cell {
            let node = level.first_node + (y / cell) * level.nodes_x + x / cell;
            values[(y * columns * cell + x) as usize] = mean_density(maps, node, x % cell, y % cell, cell);
        }
    }
    let peak = values.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
    let mut canvas = Canvas::new(columns * cell, rows * cell, BACKGROUND);
    for y in 0..canvas.height {
        for x in 0..canvas.width {
            let value = (values[(y * canvas.width + x) as usize] / peak).sqrt();
            let radius = disk_point(x % cell, y % cell, cell, Vec2::splat(0.5)).length();
            if value > 0.02 {
                canvas.set(x, y, heat(value));
            } else if (radius - 1.0).abs() < 2.0 / cell as f32 {
                canvas.set(x, y, CIRCLE);
            }
        }
    }
    canvas
}

/// Density of a pixel, from four points of it, since a narrow peak may lie between pixel centres.
fn mean_density(maps: &BakedNdfMaps, node: u32, x: u32, y: u32, cell: u32) -> f32 {
    let offsets = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)];
    offsets.iter().map(|&(a, b)| 0.25 * maps.node_density(node, disk_point(x, y, cell, Vec2::new(a, b)))).sum()
}

/// Projected normal at a point of pixel (x, y) of a node's square, which is a little wider than the disk.
fn disk_point(x: u32, y: u32, cell: u32, inside: Vec2) -> Vec2 {
    let p = (Vec2::new(x as f32, y as f32) + inside) / cell as f32 * 2.0 - 1.0;
    Vec2::new(p.x, -p.y) * 1.04
}

/// The example's normals in the usual colours, enlarged.
fn normals(maps: &BakedNdfMaps) -> Canvas {
    let (width, height) = (maps.params.width, maps.params.height);
    let zoom = (512 / width.max(height)).clamp(1, 16);
    let mut canvas = Canvas::new(width * zoom, height * zoom, BACKGROUND);
    for j in 0..height {
        for i in 0..width {
            let [x, y] = maps.normals[(j * width + i) as usize].map(|v| f32::from(v) / 32767.0);
            let z = (1.0 - x * x - y * y).max(0.0).sqrt();
            let colour = [x, y, z].map(|c| (127.5 * c + 127.5) as u8);
            canvas.fill((i * zoom, j * zoom), (zoom, zoom), colour);
        }
    }
    canvas
}

/// Sub-regions of a stochastic surface in the colours of their owners' transforms, with the centres as dots.
fn owners(placement: &BakedPlacement) -> Option<Canvas> {
    let PlacementKind::Stochastic { cells_x, cells_y, .. } = placement.params.kind else { return None };
    let (columns, rows) = (cells_x.min(MAX_CELLS), cells_y.min(MAX_CELLS));
    let region = (384 / columns.max(rows)).clamp(4, 64);
    let mut canvas = Canvas::new(columns * 2 * region, rows * 2 * region, BACKGROUND);
    let texel = |x: u32, y: u32| placement.noise[(y * 2 * cells_x + x) as usize];
    let owner = |x: u32, y: u32| {
        let [dx, dy] = texel(x, y).neighbour();
        ((x / 2 + cells_x).wrapping_add_signed(dx) % cells_x, (y / 2 + cells_y).wrapping_add_signed(dy) % cells_y)
    };
    for y in 0..rows * 2 {
        for x in 0..columns * 2 {
            let (owner, class) = (owner(x, y), texel(x, y).class());
            // Owners of one class differ a little, so that single examples can be told apart.
            let shade = 0.8 + 0.2 * ((owner.0 * 7 + owner.1 * 13) % 5) as f32 / 4.0;
            let hue = class as f32 / placement.params.palette_len as f32;
            canvas.fill(
                (x * region, y * region),
                (region, region),
                colour_wheel(hue).map(|c| (f32::from(c) * shade) as u8),
            );
        }
    }
    for y in 0..rows * 2 {
        for x in 0..columns * 2 {
            let (owner, centre) = (owner(x, y), texel(x, y).centre);
            let at = |cell: u32, part: u32| (2 * region) * cell + (2 * region) * part / 65536;
            let (px, py) = (at(owner.0, centre & 0xffff), at(owner.1, centre >> 16));
            canvas.fill((px.saturating_sub(1), py.saturating_sub(1)), (2, 2), [255; 3]);
        }
    }
    Some(canvas)
}
