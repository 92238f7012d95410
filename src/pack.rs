//! From a map to a material, and from sections to the bytes of a pack that was verified. Shared by bakes and demo.

use crate::cli::git_hash;
use crate::exit::{Exit, Failure};
use glint_bake_core::error::{BakeError, Result as BakeResult};
use glint_bake_core::ndf_maps::bake;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::options::{self, NdfMapsOptions, Options, PlacementOptions, TransformRanges};
use glint_bake_core::ndf_maps::placement::place;
use glint_bake_core::ndf_maps::sections;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Progress;
use glint_formats::ndf_maps::{DensityStorage, LAYERS, LayeredMaterial};
use glint_formats::provenance::{PROVENANCE, Provenance};
use glint_formats::{Codec, Limits, PackBuilder, Section, Severity, validate};

/// Bytes of one tile in the paper's layout: 128 × 128 floats.
pub const PAPER_TILE_BYTES: u64 = 128 * 128 * 4;

/// A material with its name.
pub struct Baked {
    /// Name in the pack.
    pub name: String,
    /// What was baked.
    pub material: Material,
}

/// Bakes one material.
pub fn bake(
    map: &NormalMap,
    options: &NdfMapsOptions,
    placement: &PlacementOptions,
    progress: &dyn Progress,
) -> BakeResult<Material> {
    bake::bake(map, &Options { maps: options.clone(), placement: *placement }, progress)
}

/// What would stop [`bake`], found without the work.
pub fn check(
    map: &NormalMap,
    options: &NdfMapsOptions,
    placement: &PlacementOptions,
    max_memory: u64,
) -> BakeResult<()> {
    options::check_size(map).map_err(|error| match error {
        BakeError::LimitExceeded(why) => BakeError::LimitExceeded(format!("{why} with --crop WxH+X+Y")),
        other => other,
    })?;
    let needed = tile_count(map.width, map.height, options.min_tile) * PAPER_TILE_BYTES;
    if options.storage == DensityStorage::PaperF32 && needed > max_memory {
        return Err(BakeError::LimitExceeded(format!(
            "the paper's layout needs {needed} bytes, the limit is {max_memory}; raise --max-memory or give --storage u8"
        )));
    }
    place(map, options.roughness, placement).map(|_| ())
}

/// Tiles of all levels of an example, from tiles of `min_tile` texels on.
pub fn tile_count(width: u32, height: u32, min_tile: u32) -> u64 {
    bake::levels(width, height, min_tile).iter().map(|level| u64::from(level.tiles_x) * u64::from(level.tiles_y)).sum()
}

/// The bytes of a pack of materials.
pub fn assemble(
    materials: &[Baked],
    layers: Option<&LayeredMaterial>,
    provenance: &Provenance,
    codec: Codec,
) -> Result<Vec<u8>, Failure> {
    let mut all = Vec::new();
    for baked in materials {
        all.extend(sections::to_sections(&baked.name, &baked.material, codec));
    }
    if let Some(layers) = layers {
        all.push(Section::parameters(LAYERS, &format!("{}:{}", layers.coat, layers.base), layers));
    }
    seal(provenance, all)
}

/// The bytes of a pack. They pass verification, or there is a failure: a bake never ships a pack that does not verify.
pub fn seal(provenance: &Provenance, sections: Vec<Section>) -> Result<Vec<u8>, Failure> {
    let fault =
        |what: String| Failure::new(Exit::Unexpected, format!("the pack cannot be built: {what}; please report this"));
    let mut builder = PackBuilder::new();
    let mut push = |section| builder.push(section).map_err(|e| fault(e.to_string()));
    push(Section::parameters(PROVENANCE, "", provenance).optional())?;
    sections.into_iter().try_for_each(push)?;
    let bytes = builder.finish().map_err(|e| fault(e.to_string()))?;
    match validate(&bytes, &Limits::default()).iter().find(|issue| issue.severity == Severity::Error) {
        Some(issue) => Err(fault(issue.to_string())),
        None => Ok(bytes),
    }
}

/// Provenance with what is known of this program.
pub fn provenance(method: &str) -> Provenance {
    Provenance {
        tool_version: env!("CARGO_PKG_VERSION").to_owned(),
        git_hash: git_hash().to_owned(),
        method: method.to_owned(),
        ..Provenance::default()
    }
}

/// The flag's value for a storage.
pub fn storage_name(storage: DensityStorage) -> &'static str {
    match storage {
        DensityStorage::SqrtU8 => "u8",
        DensityStorage::F16 => "f16",
        DensityStorage::PaperF32 => "paper",
    }
}

/// The ranges of a placement.
pub fn ranges(placement: &PlacementOptions) -> &TransformRanges {
    match placement {
        PlacementOptions::Tiled(ranges) => ranges,
        PlacementOptions::Stochastic(options) => &options.ranges,
    }
}

/// Ranges as the flag takes them.
pub fn transforms_text(ranges: &TransformRanges) -> String {
    let mut parts = Vec::new();
    let mut add = |name: &str, (low, high): (f64, f64), neutral: f64| {
        if low != high {
            parts.push(format!("{name}={low}..{high}"));
        } else if low != neutral {
            parts.push(format!("{name}={low}"));
        }
    };
    add("rotate", ranges.rotate_degrees, 0.0);
    add("scale", ranges.scale, 1.0);
    add("stretch", ranges.stretch, 1.0);
    add("shear", ranges.shear, 0.0);
    if ranges.mirror {
        parts.push("mirror".into());
    }
    if parts.is_empty() { "none".into() } else { parts.join(",") }
}
