//! Pictures of what a pack holds.

use crate::exit::Failure;
use crate::methods::ALL;
use crate::output;
use glint_formats::Pack;
use std::path::{Path, PathBuf};

/// Writes the pictures of everything that has one into `folder`, which is created, and says which they are.
///
/// # Errors
/// A folder or file that cannot be written; a section that cannot be used.
pub fn write_all(pack: &Pack, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    output::create_folder(folder)?;
    let mut written = Vec::new();
    let mut write = |name: String, bytes: Vec<u8>| {
        let path = folder.join(name);
        output::write(&path, &bytes)?;
        written.push(path);
        Ok::<(), Failure>(())
    };
    ALL.iter().try_for_each(|method| method.plot(pack, &mut write))?;
    Ok(written)
}
