//! Pictures of what a pack holds: NDF tiles, normals, placement, tile errors, dictionaries, environments, area lights,
//! lobes, seams of surfaces.

use crate::canvas::Canvas;
use crate::exit::{Exit, Failure};
use crate::methods::area_light::plot as mip_rows;
use crate::methods::dictionary::plot as marginals;
use crate::methods::environment::plot as cubes;
use crate::methods::lobes::plot as lobes;
use crate::methods::ndf_maps::{histogram, plot as maps};
use crate::output;
use glam::DVec2;
use glint_bake_core::footprint::Footprint;
use glint_bake_core::lobes::query::QuerySettings;
use glint_bake_core::surface::SurfaceSettings;
use glint_bake_core::{dictionary, lobes::sections as lobe_sections, ndf_maps::sections, surface};
use glint_formats::export::{Texels, Texture};
use glint_formats::{FourCc, Pack, area_light, environment, lobes as lobe_format, synthesis};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Makes a picture of a texture.
type Draw = fn(&Texels) -> Canvas;

/// Writes the pictures of everything that has one into `folder`, which is created, and says which they are.
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
    for (i, name) in names_with(pack, environment::PARAMS).into_iter().enumerate() {
        let stem = file_stem(i, name);
        if let Some(picture) = picture_of(pack, environment::RADIANCE, name, cubes::radiance) {
            write(format!("{stem}-radiance.png"), picture.to_png())?;
        }
        let colours = payload(pack, environment::COLOURS, name);
        let colours = colours.as_ref().and_then(|(texture, bytes)| Texels::new(*texture, bytes));
        let levels = |texels: &Texels| cubes::levels(texels, colours.as_ref());
        if let Some(picture) = picture_of(pack, environment::INDICATORS, name, levels) {
            write(format!("{stem}-levels.png"), picture.to_png())?;
        }
    }
    for (i, name) in names_with(pack, area_light::PARAMS).into_iter().enumerate() {
        let stem = file_stem(i, name);
        let pictures: [(FourCc, &str, Draw); 3] = [
            (area_light::NORMALS, "mean-normals", mip_rows::normals),
            (area_light::NORMALS, "roughness", mip_rows::roughness),
            (area_light::ROUGHNESS, "directions", mip_rows::directions),
        ];
        for (kind, what, draw) in pictures {
            if let Some(picture) = picture_of(pack, kind, name, draw) {
                write(format!("{stem}-{what}.png"), picture.to_png())?;
            }
        }
    }
    for (i, name) in names_with(pack, lobe_format::PARAMS).into_iter().enumerate() {
        let stem = file_stem(i, name);
        let damaged = |e: glint_bake_core::error::BakeError| Failure::new(Exit::BadInput, format!("lobes {name}: {e}"));
        let picture = if pack.find(synthesis::PARAMS, name).is_some() {
            let surface = surface::sections::from_pack(pack, name).map_err(damaged)?;
            write(format!("{stem}-patches.png"), lobes::patches(&surface.synthesis).to_png())?;
            let roughness = surface.lobes.params.intrinsic_roughness.max(lobes::LEAST_ROUGHNESS);
            lobes::density(|s| surface.p_ndf(&whole(), s, roughness, &SurfaceSettings::default()))
        } else {
            let map = lobe_sections::from_pack(pack, name).map_err(damaged)?;
            let roughness = map.params.intrinsic_roughness.max(lobes::LEAST_ROUGHNESS);
            lobes::density(|s| map.p_ndf(&whole(), s, roughness, &QuerySettings::default()))
        };
        write(format!("{stem}-ndf.png"), picture.to_png())?;
    }
    Ok(written)
}

/// A footprint that sees every place of a map or surface.
fn whole() -> Footprint {
    Footprint::new(DVec2::ZERO, 1e6, 1.0, 0.0)
}

/// Names that have a section of this kind.
fn names_with(pack: &Pack, kind: FourCc) -> Vec<&str> {
    pack.names().into_iter().filter(|name| pack.find(kind, name).is_some()).collect()
}

/// A texture of a pack and its bytes.
fn payload<'a>(pack: &'a Pack, kind: FourCc, name: &str) -> Option<(Texture, Cow<'a, [u8]>)> {
    let entry = pack.find(kind, name)?;
    Some((Texture::of(&entry.resource)?, pack.payload(entry).ok()?))
}

/// What `draw` makes of a texture; `None` when the pack has none of this kind.
fn picture_of(pack: &Pack, kind: FourCc, name: &str, draw: impl Fn(&Texels) -> Canvas) -> Option<Canvas> {
    let (texture, bytes) = payload(pack, kind, name)?;
    Texels::new(texture, &bytes).map(|texels| draw(&texels))
}

/// A file name for a material, whose own name may hold anything.
fn file_stem(index: usize, name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
    format!("{index}-{}", name.chars().map(plain).collect::<String>())
}
