//! What a build leaves beside each pack for the next one: all that the pack depended on. A record that is missing or
//! damaged costs a bake, never a wrong pack.

use super::model::Target;
use super::stamp::Stamp;
use crate::cli::git_hash;
use crate::exit::Failure;
use glint_formats::container::VERSION;
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::{Path, PathBuf};

/// What one pack was made from, by what, and what came out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Record {
    /// Version and commit of the tool.
    pub tool: String,
    /// Version of the pack format.
    pub format: String,
    /// Method.
    pub method: String,
    /// Options that the bytes may depend on, defaults included.
    pub options: Vec<(String, Vec<String>)>,
    /// Names, without folders, and stamps of the inputs.
    pub inputs: Vec<(String, Stamp)>,
    /// Names, without folders, and stamps of the pack and what is written beside it.
    pub outputs: Vec<(String, Stamp)>,
}

impl Record {
    /// The record of a target as it would be built now; `outputs` may be empty before it is.
    pub fn new(target: &Target, inputs: Vec<Stamp>, outputs: Vec<Stamp>) -> Record {
        let named = |path: &Path, stamp| (file_name(path), stamp);
        Record {
            tool: format!("{} {}", env!("CARGO_PKG_VERSION"), git_hash()),
            format: format!("{}.{}", VERSION.0, VERSION.1),
            method: target.method().to_owned(),
            options: target.options.clone(),
            inputs: target.inputs.iter().zip(inputs).map(|(path, stamp)| named(path, stamp)).collect(),
            outputs: target.outputs().iter().zip(outputs).map(|(path, stamp)| named(path, stamp)).collect(),
        }
    }

    /// The one in `folder` of the pack `name`, if there is a sound one.
    pub fn read(folder: &Path, name: &str) -> Option<Record> {
        serde_json::from_slice(&std::fs::read(path(folder, name)).ok()?).ok()
    }

    /// Writes the record. It is not synced: losing it in a power cut costs a bake.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn write(&self, folder: &Path, name: &str) -> Result<(), Failure> {
        let path = path(folder, name);
        let fault = |e: &std::io::Error| Failure::io(&path, "cannot be written", e);
        let text = serde_json::to_string(self).map_err(|e| fault(&e.into()))?;
        let mut file = tempfile::NamedTempFile::new_in(folder).map_err(|e| fault(&e))?;
        file.write_all(text.as_bytes()).map_err(|e| fault(&e))?;
        file.persist(&path).map_err(|e| fault(&e.error))?;
        Ok(())
    }
}

fn path(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{name}.json"))
}

/// A path's last part.
pub fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
