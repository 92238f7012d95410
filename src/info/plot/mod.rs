//! Pictures of what a pack holds: NDF tiles, normals, placement, tile errors, dictionaries.

mod histogram;
mod maps;
mod marginals;

use crate::exit::{Exit, Failure};
use crate::output;
use glint_bake_core::{dictionary, ndf_maps::sections};
use glint_formats::Pack;
use std::path::{Path, PathBuf};

/// Writes the pictures of every material and dictionary into `folder`, which is created, and says which they are.
pub fn write_all(pack: &Pack, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    std::fs::create_dir_all(folder).map_err(|e| Failure::io(folder, "cannot be created", &e))?;
    let mut written = Vec::new();
    let mut write = |name: String, bytes: Vec<u8>| {
        let path = folder.join(name);
        output::write(&path, &bytes)?;
        written.push(path);
        Ok::<(), Failure>(())
    };
    for (i, name) in sections::materials(pack).into_iter().enumerate() {
        let material = sections::from_pack(pack, name)
            .map_err(|e| Failure::new(Exit::BadInput, format!("material {name}: {e}")))?;
        let stem = file_stem(i, name);
        for level in &material.maps.params.levels {
            let sheet = maps::contact_sheet(&material.maps, level);
            write(format!("{stem}-tiles-{}.png", level.tile_texels), sheet.to_png())?;
        }
        write(format!("{stem}-normals.png"), maps::normals(&material.maps).to_png())?;
        if let Some(owners) = maps::owners(&material.placement) {
            write(format!("{stem}-placement.png"), owners.to_png())?;
        }
        write(format!("{stem}-errors.svg"), histogram::svg(name, &material.maps).into_bytes())?;
    }
    for (i, name) in dictionary::sections::dictionaries(pack).into_iter().enumerate() {
        let (dictionary, _) = dictionary::sections::from_pack(pack, name)
            .map_err(|e| Failure::new(Exit::BadInput, format!("dictionary {name}: {e}")))?;
        write(format!("{}-marginals.svg", file_stem(i, name)), marginals::svg(name, &dictionary).into_bytes())?;
    }
    Ok(written)
}

/// Text as it stands in an SVG.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// A file name for a material, whose own name may hold anything.
fn file_stem(index: usize, name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
    format!("{index}-{}", name.chars().map(plain).collect::<String>())
}
