//! `glint-bake export`: what a pack holds as files that engines and other programs load, and a JSON beside them.

mod format;
mod sidecar;

use crate::cli::{Terminal, values};
use crate::exit::{Exit, Failure};
use crate::exr_file;
use crate::info::Report;
use crate::output;
use crate::reading;
use format::Target;
use glint_formats::export::{Texture, dds, ktx2};
use glint_formats::provenance::{InputDigest, PROVENANCE};
use glint_formats::{Limits, Pack, SectionEntry, WriteOutcome, kinds, vk_format};
use sidecar::{FileInfo, Sidecar};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Lines that `--help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake export sky.glintpack --to ktx2 -o exported
  glint-bake export sky.glintpack --to exr --section ENRA -o radiance";

/// Export textures and buffers of a pack as KTX2, DDS, OpenEXR or raw files
///
/// Every texture becomes a file of the format, with all its mips, layers and cube faces; what the format cannot hold, such
/// as a buffer, becomes a file of its bytes (.bin). PACK's name with .json lists the files and has all parameters.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Pack to export
    #[arg(value_name = "PACK")]
    pub pack: PathBuf,
    /// Folder to write into; it is created
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Format of textures; raw is the bytes as they are
    #[arg(long, value_name = "FORMAT")]
    pub to: Target,
    /// Only sections of this kind, as in ENRA; may be given more than once
    ///
    /// Parameters are in the JSON all the same.
    #[arg(long, value_name = "KIND")]
    pub section: Vec<String>,
    /// Only sections of this name; may be given more than once
    #[arg(long, value_name = "NAME")]
    pub name: Vec<String>,
    /// Most bytes to read and to decompress, as in 512M
    #[arg(long, value_name = "BYTES", default_value = "4G", value_parser = values::bytes)]
    pub max_memory: u64,
    /// Check everything, say what would be done, write nothing
    #[arg(short = 'n', long)]
    pub dry_run: bool,
}

/// A file that is to be written.
struct Item<'a> {
    entry: &'a SectionEntry,
    format: Target,
    note: Option<&'static str>,
    file: String,
}

/// Runs the subcommand.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    let limits = Limits { max_file_bytes: args.max_memory, max_raw_bytes: args.max_memory, ..Limits::default() };
    let report = Report::of_file(&args.pack, &limits);
    let pack = report.sound()?;
    args.check_selection(pack)?;
    let items = items(args, &report, pack);
    let sidecar_path = args.output.join(format!("{}.json", stem(args)));
    let mut paths: Vec<PathBuf> = items.iter().map(|item| args.output.join(&item.file)).collect();
    paths.push(sidecar_path.clone());
    output::check_distinct(&paths.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &[&args.pack])?;
    if args.dry_run {
        for (path, item) in paths.iter().zip(&items) {
            terminal.say(&format!("would write {}{}", path.display(), remark(item.note)));
        }
        terminal.say(&format!("would write {}; dry run, nothing was written", sidecar_path.display()));
        return Ok(());
    }
    output::create_folder(&args.output)?;
    paths.iter().try_for_each(|path| output::check_writable(path))?;

    let (pack_name, _) = reading::recorded_name(&args.pack);
    let mut sidecar = Sidecar::new(InputDigest::of(&pack_name, pack.file_bytes()), args.to, &report.provenance);
    sidecar.parameters = report.parameters.iter().filter(|of| args.wants_name(&of.name)).collect();
    for (item, path) in items.iter().zip(&paths) {
        let payload = pack
            .payload(item.entry)
            .map_err(|issue| Failure::new(Exit::BadInput, format!("{}: {issue}", report.file)))?;
        let bytes = encode(item, &payload)?;
        let outcome = output::write(path, &bytes)?;
        terminal.say(&format!("{}: {}{}", path.display(), said(outcome), remark(item.note)));
        sidecar.files.push(item.describe(&bytes));
    }
    if items.is_empty() {
        terminal.say("no textures or buffers were asked for; parameters are in the JSON");
    }
    // The list comes last: who finds it finds the files.
    let outcome = output::write(&sidecar_path, sidecar.to_json().as_bytes())?;
    terminal.say(&format!("{}: {}", sidecar_path.display(), said(outcome)));
    Ok(())
}

impl Args {
    fn wants_name(&self, name: &str) -> bool {
        self.name.is_empty() || self.name.iter().any(|wanted| wanted == name)
    }

    fn wants(&self, entry: &SectionEntry) -> bool {
        let kind = entry.kind.to_string();
        (self.section.is_empty() || self.section.contains(&kind)) && self.wants_name(&entry.name)
    }

    /// Every selection finds something: a misspelt one would leave files out without a word.
    fn check_selection(&self, pack: &Pack) -> Result<(), Failure> {
        let kinds: Vec<String> = pack.sections().iter().map(|entry| entry.kind.to_string()).collect();
        let names: Vec<String> = pack.names().into_iter().map(str::to_owned).collect();
        for (flag, wanted, there) in [("--section", &self.section, kinds), ("--name", &self.name, names)] {
            if let Some(missing) = wanted.iter().find(|&one| !there.contains(one)) {
                let mut seen = HashSet::new();
                let list: Vec<&str> = there.iter().map(String::as_str).filter(|one| seen.insert(*one)).collect();
                let message = format!("{flag}: expected one of {}, found {missing}", list.join(", "));
                return Err(Failure::usage(message));
            }
        }
        Ok(())
    }
}

impl<'a> Item<'a> {
    fn describe(&self, bytes: &[u8]) -> FileInfo<'a> {
        let entry = self.entry;
        FileInfo {
            file: self.file.clone(),
            format: self.format,
            bytes: bytes.len() as u64,
            xxh3_128: InputDigest::of(&self.file, bytes).xxh3_128,
            kind: entry.kind,
            title: kinds::known(entry.kind).map(|known| known.title),
            name: &entry.name,
            version: entry.version,
            resource: entry.resource,
            vk_format_name: Texture::of(&entry.resource).and_then(|texture| vk_format::name(texture.vk_format)),
            payload_bytes: entry.raw_len,
            note: self.note,
        }
    }
}

/// The files of the selected sections. Parameters are in the JSON instead, where their kind is known.
fn items<'a>(args: &Args, report: &Report, pack: &'a Pack) -> Vec<Item<'a>> {
    let in_json = |entry: &SectionEntry| {
        entry.kind == PROVENANCE || report.parameters.iter().any(|of| of.kind == entry.kind && of.name == entry.name)
    };
    let mut taken = HashSet::new();
    pack.sections()
        .iter()
        .filter(|entry| args.wants(entry) && !in_json(entry))
        .map(|entry| {
            let (format, note) = args.to.for_section(entry);
            Item { entry, format, note, file: file_name(entry, format, &mut taken) }
        })
        .collect()
}

/// `ENRA-sky.ktx2`. Names may hold anything, so what is not plain becomes `_`; names that then look alike, to a file
/// system without upper and lower case too, are numbered.
fn file_name(entry: &SectionEntry, format: Target, taken: &mut HashSet<String>) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
    let mut stem: String = entry.kind.to_string().chars().map(plain).collect();
    if !entry.name.is_empty() {
        stem.push('-');
        stem.extend(entry.name.chars().map(plain));
    }
    let mut file = format!("{stem}.{}", format.extension());
    let mut number = 2;
    while !taken.insert(file.to_lowercase()) {
        file = format!("{stem}-{number}.{}", format.extension());
        number += 1;
    }
    file
}

/// The pack's file name without its extension.
fn stem(args: &Args) -> String {
    let file = reading::file_name(&args.pack);
    Path::new(&file).file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn encode(item: &Item, payload: &[u8]) -> Result<Vec<u8>, Failure> {
    let encoded = match (item.format, Texture::of(&item.entry.resource)) {
        (Target::Ktx2, Some(texture)) => {
            let writer = concat!("glint-bake ", env!("CARGO_PKG_VERSION"));
            let metadata = [("KTXorientation", "rd"), ("KTXwriter", writer)];
            ktx2::write(&texture, payload, &metadata)
        }
        (Target::Dds, Some(texture)) => dds::write(&texture, payload),
        (Target::Exr, Some(texture)) => exr_file::write(&texture, payload)?,
        _ => Some(payload.to_vec()),
    };
    encoded.ok_or_else(|| {
        let (label, extension) = (item.entry.label(), item.format.extension());
        let message = format!("{label}: no {extension} file can have its format; give --to raw");
        Failure::new(Exit::Unsupported, message)
    })
}

fn said(outcome: WriteOutcome) -> &'static str {
    match outcome {
        WriteOutcome::Written => "written",
        WriteOutcome::Unchanged => "unchanged",
    }
}

fn remark(note: Option<&'static str>) -> String {
    note.map_or(String::new(), |note| format!(" ({note})"))
}
