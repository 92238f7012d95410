//! The list that `glint-bake textures` writes beside its textures: one material of what they hold, whatever engine they were packed for.

use super::images::{Image, bytes_of};
use super::ktx2_file::{self, Mips, is_ktx2};
use crate::exit::Failure;
use crate::gltf::fault::Fault;
use crate::input::Texels;
use crate::output;
use glam::Affine2;
use glint_formats::provenance::InputDigest;
use glint_view::methods::textures::{Edge, NORMAL, SLOTS, Texture, Textured, TexturedMaterial};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// What the list says of its files.
#[derive(Debug, Deserialize)]
struct List {
    #[serde(rename = "$schema")]
    schema: String,
    green: String,
    roughness: String,
    options: BTreeMap<String, String>,
    files: Vec<File>,
}

#[derive(Debug, Deserialize)]
struct File {
    file: String,
    xxh3_128: String,
}

/// Where occlusion, roughness and metallic are: how a name ends, and the channel.
const CHANNELS: [[(&str, usize); 3]; 3] = [
    [("orm", 0), ("mask", 1), ("occlusion", 0)],
    [("orm", 1), ("mask", 3), ("roughness", 0)],
    [("orm", 2), ("mask", 0), ("metallic", 0)],
];

/// What the textures hold, and what the user should know of them. At most `limit` bytes are read of each file, and decompressed.
///
/// # Errors
/// A list or a file that can't be read, is damaged, was changed since, or of a kind that is not drawn.
pub fn material_of(path: &Path, limit: u64) -> Result<(Textured, Vec<String>), Failure> {
    let fault = |fault: Fault| fault.at(path);
    let read: Result<List, _> = serde_json::from_slice(&bytes_of(path, limit)?);
    let list = read.ok().filter(|list| list.schema.ends_with("/glint-textures.schema.json"));
    let list = list.ok_or_else(|| fault(Fault::bad("it is no list of glint-bake textures, such as DIR/NAME.json")))?;
    let mut notes = Vec::new();
    let mut files = BTreeMap::new();
    for file in &list.files {
        let role = role(&file.file);
        if role == "anisotropy" {
            notes.push(format!("{} is not drawn: highlights are round", file.file));
            continue;
        }
        files.insert(role, (file.file.as_str(), read_file(path, file, limit)?));
    }
    let edges =
        [if list.options.get("wrap").is_some_and(|wrap| wrap == "clamp") { Edge::Clamp } else { Edge::Repeat }; 2];
    let texture = |levels: &[Texels], size| {
        let Image { image, plain } = Image::of_levels(size, levels, false);
        Some(Texture { image, plain, edges, uv: Affine2::IDENTITY })
    };
    let (_, normals) = files.get("normal").ok_or_else(|| fault(Fault::bad("it lists no normals; write them anew")))?;
    let size = normals.size;
    if let Some((name, mips)) =
        files.values().find(|(_, mips)| mips.size != size || mips.levels.len() != normals.levels.len())
    {
        let (found, expected) = (mips.size, size);
        let what = format!(
            "{name} has {} × {} texels, the normals have {} × {}; write them anew",
            found.0, found.1, expected.0, expected.1
        );
        return Err(fault(Fault::bad(what)));
    }
    let down = list.green == "down";
    let levels: Vec<Texels> =
        normals.levels.iter().map(|level| normals_up(level, down, normals.channels == 2)).collect();
    let mut textures = [const { None }; SLOTS];
    textures[NORMAL] = texture(&levels, size);
    let rough = packed(&files, &list.roughness, normals.levels.len());
    if rough.is_empty() {
        return Err(fault(Fault::bad("it lists no roughness; write them anew")));
    }
    textures[2] = texture(&rough, size);
    textures[3] = textures[2].clone();
    let material = TexturedMaterial { base_colour: None, textures, ..TexturedMaterial::default() };
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok((Textured { name, materials: vec![material], parts: Vec::new() }, notes))
}

/// How a name ends: `orm` of `skin_orm.1001.ktx2`.
fn role(file: &str) -> &str {
    let end = file.rsplit('_').next().unwrap_or_default();
    end.split('.').next().unwrap_or_default()
}

/// The mips of a file beside the list.
fn read_file(path: &Path, file: &File, limit: u64) -> Result<Mips, Failure> {
    let fault = |fault: Fault| fault.of(&file.file).at(path);
    let name = Path::new(&file.file);
    if name.file_name() != Some(name.as_os_str()) {
        return Err(fault(Fault::bad("it is no name of a file beside the list; write them anew")));
    }
    let beside = output::folder_of(path).join(name);
    if name.extension().is_none_or(|extension| extension != "ktx2") {
        let what = "only KTX2 is drawn; write them with glint-bake textures --format ktx2";
        return Err(fault(Fault::unsupported(what)));
    }
    let bytes = bytes_of(&beside, limit)?;
    if InputDigest::of(&file.file, &bytes).xxh3_128 != file.xxh3_128 {
        return Err(fault(Fault::bad("it was changed after the list was written; write them anew")));
    }
    if !is_ktx2(&bytes) {
        return Err(fault(Fault::bad("it does not begin as KTX2; write them anew")));
    }
    ktx2_file::read(&bytes, limit).map_err(|what| what.at(&beside))
}

/// Texels of a level by number, as many bits a channel as another level has.
fn level_like(other: &Texels, texel: impl Fn(usize) -> [f32; 4]) -> Texels {
    let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    match other {
        Texels::Bytes(all) => Texels::Bytes((0..all.len()).map(|k| texel(k).map(byte)).collect()),
        Texels::Floats(all) => Texels::Floats((0..all.len()).map(texel).collect()),
    }
}

/// Normals whose green points up, with z.
fn normals_up(level: &Texels, down: bool, two_channels: bool) -> Texels {
    level_like(level, |k| {
        let [x, y, z, _] = level.texel(k);
        let (s, t) = (2.0 * x - 1.0, 2.0 * y - 1.0);
        let z = if two_channels { 0.5 + 0.5 * (1.0 - s * s - t * t).max(0.0).sqrt() } else { z };
        [x, if down { 1.0 - y } else { y }, z, 1.0]
    })
}

/// Occlusion, perceptual roughness and metallic in red, green and blue, 1 where no file has them.
fn packed(files: &BTreeMap<&str, (&str, Mips)>, stored: &str, levels: usize) -> Vec<Texels> {
    let found = CHANNELS.map(|places| places.iter().find_map(|(role, channel)| Some((&files.get(role)?.1, *channel))));
    let Some((first, _)) = found.iter().flatten().next() else { return Vec::new() };
    let perceptual = |value: f32| match stored {
        "alpha" => value.sqrt(),
        "smoothness" => 1.0 - value,
        _ => value,
    };
    let level = |level: usize| {
        level_like(&first.levels[level], |k| {
            let value =
                |of: Option<(&Mips, usize)>| of.map_or(1.0, |(mips, channel)| mips.levels[level].texel(k)[channel]);
            let [occlusion, roughness, metallic] = found.map(value);
            [occlusion, if found[1].is_some() { perceptual(roughness) } else { 1.0 }, metallic, 1.0]
        })
    };
    (0..levels).map(level).collect()
}
