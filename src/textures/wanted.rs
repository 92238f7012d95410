//! Which textures are written, and where: all of them into a folder, or one into a file.

use super::args::Args;
use super::encode::{Layout, Plan};
use super::target::Channel;
use crate::exit::Failure;
use std::path::{Path, PathBuf};

/// The texture of normals among the names of textures.
const NORMAL: &str = "normal";

/// A texture to write.
pub struct Wanted {
    pub plan: Plan,
    /// What its channels hold; none for normals.
    pub channels: Option<&'static [Channel]>,
}

/// Textures of a map of this size whose names begin with `stem` and end in `number`.
///
/// # Errors
/// Usage, when `--only` names none of them.
pub fn textures(args: &Args, stem: &str, number: &str, size: (u32, u32)) -> Result<Vec<Wanted>, Failure> {
    let name = |kind: &str| format!("{stem}_{kind}{number}");
    let channels = args.normal_channels();
    let normal = Plan { name: name(NORMAL), channels, opaque: channels == 4 && !args.keeps_alpha(), size };
    let mut all = vec![(NORMAL, Wanted { plan: normal, channels: None })];
    for (kind, channels) in args.companions() {
        let opaque = channels.last() == Some(&Channel::One);
        let plan = Plan { name: name(kind), channels: channels.len(), opaque, size };
        all.push((kind, Wanted { plan, channels: Some(channels) }));
    }
    if let Some(only) = &args.only {
        let kinds: Vec<&str> = all.iter().map(|(kind, _)| *kind).collect();
        if !kinds.contains(&only.as_str()) {
            return Err(Failure::usage(format!("--only: expected {}, found {only}", kinds.join(" or "))));
        }
        all.retain(|(kind, _)| kind == only);
    }
    Ok(all.into_iter().map(|(_, wanted)| wanted).collect())
}

/// The file that the output is, where it is no folder: by a name that ends as files of the format do.
///
/// # Errors
/// Usage, for more than one file.
pub fn file<'a>(args: &'a Args, layout: &Layout) -> Result<Option<&'a Path>, Failure> {
    let output = &args.output;
    let ends = output.extension().is_some_and(|extension| extension == layout.format.extension());
    if !ends || output.is_dir() {
        return Ok(None);
    }
    let several = match (&args.only, layout.format.has_all_mips()) {
        (None, _) => "each texture has a file: say which with --only",
        (_, false) => "each mip has a file in this format: give another one",
        _ if args.tile.is_some() => "each tile has a file: give a map without <UDIM>",
        _ => return Ok(Some(output)),
    };
    Err(Failure::usage(format!("{}: is the name of one file, and {several}, or name a folder", output.display())))
}

/// Where the files of a texture go.
pub fn paths(args: &Args, layout: &Layout, file: Option<&Path>, wanted: &Wanted) -> Vec<PathBuf> {
    match file {
        Some(file) => vec![file.to_owned()],
        None => layout.files(&wanted.plan).into_iter().map(|name| args.output.join(name)).collect(),
    }
}
