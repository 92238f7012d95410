//! `glint-bake textures --gltf`: a glTF file whose materials have filtered normals and roughness.

mod binary;
mod jobs;
mod pictures;
mod rewrite;
mod uses;

use super::args::Args;
use super::gltf_flags::GltfImages;
use crate::cli::Terminal;
use crate::depfile;
use crate::exit::{Exit, Failure};
use crate::gltf::container::Container;
use crate::gltf::document::Document;
use crate::gltf::fault::Fault;
use crate::gltf::source::Source;
use crate::output;
use crate::reading::{self, ReadError};
use glint_formats::WriteOutcome;
use pictures::Making;
use rewrite::rewrite;
use std::path::{Path, PathBuf};

/// Checks everything, then bakes and writes.
///
/// # Errors
/// What is wrong with the file, an image or a path.
pub fn run(path: &Path, args: &Args, terminal: Terminal) -> Result<(), Failure> {
    check_paths(path, args)?;
    let bytes = read(path, args.max_memory)?;
    let at = |fault: Fault| fault.at(path);
    let container = Container::read(&bytes).map_err(at)?;
    let document = Document::read(&container.text).map_err(at)?;
    check_kind(path, &args.output, &container)?;
    let json = serde_json::from_str(&container.text)
        .map_err(|error| at(Fault::bad(format!("its JSON is not that of glTF: {error}; export it anew"))))?;
    let found = jobs::gather(&document, &json).map_err(at)?;
    for note in &found.notes {
        terminal.warn(&format!("{}: {note}", path.display()));
    }
    if found.jobs.is_empty() {
        let what = "no material has a normal texture to filter; nothing is written";
        return Err(at(Fault::bad(what)));
    }
    let folder = output::folder_of(path);
    let source = Source { document: &document, binary: container.binary.as_deref(), folder, limit: args.max_memory };
    let beside = document.files().map_err(at)?;
    let inputs: Vec<PathBuf> =
        std::iter::once(path.to_owned()).chain(beside.iter().map(|file| folder.join(file))).collect();
    let depends: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
    let rule = args.depfile.as_ref().map(|_| depfile::rule(&args.output, &depends)).transpose()?;
    let mut paths = vec![args.output.clone()];
    paths.extend(args.depfile.clone());
    output::check_distinct(&paths.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &depends)?;
    paths.iter().try_for_each(|path| output::check_writable(path))?;
    if args.gltf.images() == GltfImages::Png && args.gltf.max_size.is_none() {
        terminal.warn("--gltf-images png: without --max-size the texels stay as they are, and the engine makes mips that lose the highlight");
    }
    if args.dry_run {
        for path in &paths {
            terminal.say(&format!("would write {}", path.display()));
        }
        terminal.say("dry run, nothing was written");
        return Ok(());
    }
    let mut baked = Vec::new();
    for job in found.jobs {
        let pictures = Making { path, args, source: &source, terminal }.of(&job)?;
        baked.push((job, pictures));
    }
    let stem = args.output.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let required = args.gltf.images() == GltfImages::Ktx2Only;
    let new = rewrite(&container, &document, &json, &baked, &stem, required).map_err(at)?;
    let target = output::folder_of(&args.output);
    let mut written: Vec<(PathBuf, Vec<u8>)> = Vec::new();
    // What stays beside the file goes with it; files that nothing names any more do not.
    let still = Document::read(&new.container.text).and_then(|new| new.files()).map_err(at)?;
    for file in still.iter().filter(|file| beside.contains(file)) {
        let (from, to) = (folder.join(file), target.join(file));
        let same = from.canonicalize().ok().zip(to.canonicalize().ok()).is_some_and(|(from, to)| from == to);
        if !same {
            written.push((to, read(&from, args.max_memory)?));
        }
    }
    written.extend(new.files.into_iter().map(|(name, bytes)| (target.join(name), bytes)));
    paths.extend(written.iter().map(|(path, _)| path.clone()));
    output::check_distinct(&paths.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &depends)?;
    for (path, bytes) in &written {
        output::create_folder(output::folder_of(path))?;
        write(path, bytes, terminal)?;
    }
    let bytes = new.container.write().map_err(at)?;
    if let (Some(path), Some(rule)) = (&args.depfile, rule) {
        output::write(path, rule.as_bytes())?;
    }
    // The file itself comes last: who finds it finds the others.
    write(&args.output, &bytes, terminal)
}

/// Pipes are read once, and there is more than one file.
fn check_paths(path: &Path, args: &Args) -> Result<(), Failure> {
    if reading::is_stream(path) || reading::is_standard(&args.output) {
        return Err(Failure::usage(
            "--gltf: expected files, since a glTF file may have others beside it; save it first",
        ));
    }
    if args.depfile.as_deref().is_some_and(reading::is_standard) {
        return Err(Failure::usage("--depfile: - is not taken; name a file"));
    }
    Ok(())
}

/// A file is written as the kind that it was.
fn check_kind(path: &Path, output: &Path, container: &Container) -> Result<(), Failure> {
    let expected = if container.is_glb() { "glb" } else { "gltf" };
    if output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(expected)) {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "{}: expected a name that ends in .{expected}, which {} is",
        output.display(),
        path.display()
    )))
}

/// The bytes of a file.
fn read(path: &Path, limit: u64) -> Result<Vec<u8>, Failure> {
    reading::read(path, limit).map_err(|error| match error {
        ReadError::Io(error) => Failure::io(path, "cannot be read", &error),
        ReadError::TooLarge(_) => Failure::new(
            Exit::LimitExceeded,
            format!("{}: has more than {limit} bytes, the limit; raise --max-memory", path.display()),
        ),
    })
}

fn write(path: &Path, bytes: &[u8], terminal: Terminal) -> Result<(), Failure> {
    let said = match output::write(path, bytes)? {
        WriteOutcome::Written => "written",
        WriteOutcome::Unchanged => "unchanged",
    };
    terminal.say(&format!("{}: {said}", path.display()));
    Ok(())
}
