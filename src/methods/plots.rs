//! What the plots of several methods stand on: names of files, and textures of a pack as pictures.

use crate::canvas::Canvas;
use crate::exit::Failure;
use glint_formats::export::{Texels, Texture};
use glint_formats::{FourCc, Pack};
use std::borrow::Cow;

/// Writes a picture's bytes to a file of this name.
pub type WritePlot<'a> = dyn FnMut(String, Vec<u8>) -> Result<(), Failure> + 'a;

/// A texture of a pack and its bytes.
pub fn payload<'a>(pack: &'a Pack, kind: FourCc, name: &str) -> Option<(Texture, Cow<'a, [u8]>)> {
    let entry = pack.find(kind, name)?;
    Some((Texture::of(&entry.resource)?, pack.payload(entry).ok()?))
}

/// What `draw` makes of a texture; `None` when the pack has none of this kind.
pub fn picture_of(pack: &Pack, kind: FourCc, name: &str, draw: impl Fn(&Texels) -> Canvas) -> Option<Canvas> {
    let (texture, bytes) = payload(pack, kind, name)?;
    Texels::new(texture, &bytes).map(|texels| draw(&texels))
}

/// Names that have a section of this kind, each with the beginning of its files' names: a number and what of the name
/// files can have.
pub fn stems(pack: &Pack, kind: FourCc) -> Vec<(String, &str)> {
    let names = pack.names().into_iter().filter(|name| pack.find(kind, name).is_some());
    names.enumerate().map(|(index, name)| (file_stem(index, name), name)).collect()
}

/// A file name for a material, whose own name may hold anything.
fn file_stem(index: usize, name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
    format!("{index}-{}", name.chars().map(plain).collect::<String>())
}
