//! UDIM sets: maps with `<UDIM>` in their names stand for a file a tile, whose number is 1001 + column + 10 · row. Each tile is filtered
//! by itself, at its own size, and its edges are clamped: what lies beyond them is another part of the surface.

use super::args::Args;
use super::tile_names::{MARK, is_set, name_of, numbered};
use crate::cli::normal_maps::WrapArg;
use crate::exit::{Exit, Failure};
use crate::output::folder_of;
use crate::reading;
use std::path::{Path, PathBuf};

/// First and last number of a tile.
const NUMBERS: std::ops::RangeInclusive<u32> = 1001..=9999;

/// The arguments of each tile; none where no map is a set. Every file of every tile is there.
///
/// # Errors
/// Usage, for flags that are about one map; input or output, for a set without tiles, and for a tile that lacks a map that others
/// have.
pub fn tiles(args: &Args) -> Result<Option<Vec<Args>>, Failure> {
    let maps = [
        ("NORMAL_MAP", &args.map),
        ("--roughness-map", &args.roughness_map),
        ("--occlusion", &args.occlusion),
        ("--metallic", &args.metallic),
    ];
    let mut set = false;
    for (flag, path) in maps {
        let Some(path) = path.as_deref() else { continue };
        if folder_of(path).to_string_lossy().contains(MARK) {
            return Err(Failure::usage(format!(
                "{flag}: {MARK} stands for a number in the name of a file, not of a folder"
            )));
        }
        if flag == "NORMAL_MAP" {
            set = is_set(path);
        } else if is_set(path) && !set {
            return Err(Failure::usage(format!("{flag}: has {MARK}, and the normal map has not; give it to both")));
        }
    }
    let Some(map) = args.map.as_deref().filter(|_| set) else { return Ok(None) };
    for (flag, given) in [("--depfile", args.depfile.is_some()), ("--json", args.json)] {
        if given {
            return Err(Failure::usage(format!(
                "{flag}: is about one list, and {MARK} makes one a tile; leave it out"
            )));
        }
    }
    let name = match &args.name {
        Some(name) if name.contains(MARK) => {
            return Err(Failure::usage(format!("--name: leave out {MARK}; the number comes last in each name")));
        }
        Some(name) => name.clone(),
        None => name_of(map),
    };
    let mut tiles = Vec::new();
    for number in numbers(map)? {
        let of = |path: &Option<PathBuf>| path.as_deref().map(|path| numbered(path, number));
        let mut tile = Args {
            map: of(&args.map),
            roughness_map: of(&args.roughness_map),
            occlusion: of(&args.occlusion),
            metallic: of(&args.metallic),
            name: Some(name.clone()),
            tile: Some(number),
            ..args.clone()
        };
        tile.input.wrap = WrapArg::Clamp;
        for path in tile.inputs() {
            reading::check_readable(&path).map_err(|error| {
                let what =
                    format!("cannot be read ({error}); {} has tile {number}, and all maps need it", map.display());
                Failure::new(Exit::InputOutput, format!("{}: {what}", path.display()))
            })?;
        }
        tiles.push(tile);
    }
    Ok(Some(tiles))
}

/// Numbers of the tiles that lie in the folder, ascending.
fn numbers(map: &Path) -> Result<Vec<u32>, Failure> {
    let folder = folder_of(map);
    let name = map.file_name().unwrap_or_default().to_string_lossy();
    let (before, after) = name.split_once(MARK).unwrap_or((&name, ""));
    if after.contains(MARK) {
        return Err(Failure::usage(format!("{}: expected {MARK} once in the name", map.display())));
    }
    let entries = std::fs::read_dir(folder).map_err(|e| Failure::io(folder, "cannot be read", &e))?;
    let mut numbers = Vec::new();
    for entry in entries {
        let entry = entry.map_err(|e| Failure::io(folder, "cannot be read", &e))?.file_name();
        let digits = entry.to_str().and_then(|name| name.strip_prefix(before)?.strip_suffix(after));
        let digits = digits.filter(|digits| digits.len() == 4 && digits.bytes().all(|b| b.is_ascii_digit()));
        numbers.extend(digits.and_then(|digits| digits.parse().ok()).filter(|number| NUMBERS.contains(number)));
    }
    numbers.sort_unstable();
    if numbers.is_empty() {
        let example = numbered(map, *NUMBERS.start());
        let what = format!("there is no tile; expected files as {}", example.display());
        return Err(Failure::new(Exit::InputOutput, format!("{}: {what}", map.display())));
    }
    Ok(numbers)
}
