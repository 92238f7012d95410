//! Reads the sections of a method out of a pack; every method's `sections` is written with these.

use crate::error::{BakeError, Result};
use bytemuck::Pod;
use glint_formats::{FourCc, Pack, params};
use serde::de::DeserializeOwned;
use std::borrow::Cow;

/// Names that have a section of this kind.
pub(crate) fn names_with(pack: &Pack, kind: FourCc) -> Vec<&str> {
    pack.names().into_iter().filter(|name| pack.find(kind, name).is_some()).collect()
}

/// Payload of a section.
pub(crate) fn bytes(pack: &Pack, kind: FourCc, name: &str) -> Result<Vec<u8>> {
    payload(pack, kind, name).map(Cow::into_owned)
}

/// Payload of a section, where it lies if it is not compressed.
fn payload<'a>(pack: &'a Pack, kind: FourCc, name: &str) -> Result<Cow<'a, [u8]>> {
    let entry = pack.find(kind, name).ok_or_else(|| BakeError::BadInput(format!("'{name}' has no section {kind}")))?;
    pack.payload(entry).map_err(|issue| BakeError::BadInput(issue.to_string()))
}

/// Records of a buffer or texels of a texture.
pub(crate) fn records<T: Pod>(pack: &Pack, kind: FourCc, name: &str) -> Result<Vec<T>> {
    let bytes = payload(pack, kind, name)?;
    if bytes.len() % size_of::<T>() != 0 {
        return Err(BakeError::BadInput(format!("section {kind} of '{name}' does not hold whole records")));
    }
    Ok(bytemuck::pod_collect_to_vec(&bytes))
}

/// Parameters in a section.
pub(crate) fn parameters<T: DeserializeOwned>(pack: &Pack, kind: FourCc, name: &str) -> Result<T> {
    params::decode(&payload(pack, kind, name)?)
        .map_err(|e| BakeError::BadInput(format!("section {kind} of '{name}': {e}")))
}
