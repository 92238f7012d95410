//! `glint-bake shaders`: the run time of the methods in an engine's shading language, and vectors that prove a port of it.

mod cases;
mod pixel;
mod vectors;

use crate::cli::Terminal;
use crate::exit::{Exit, Failure};
use crate::output;
use clap::ValueEnum;
use clap::builder::PossibleValuesParser;
use glint_formats::WriteOutcome;
use glint_formats::provenance::InputDigest;
use glint_shaders::describe;
use glint_shaders::translate::{self, ShaderFile};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Lines that `--help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake shaders --lang wgsl -o shaders
  glint-bake shaders --lang hlsl --method area_light -o shaders
  glint-bake shaders --vectors -o vectors";

/// Where the schema of the JSON lives; its `$id`.
const SCHEMA: &str =
    "https://raw.githubusercontent.com/glint-bake/glint-bake/main/docs/schema/glint-shaders.schema.json";

/// Write the run time of the methods for engines, in a shading language
///
/// A method is one file to include, glint_METHOD, which has no entry point: functions that take a pixel, two directions and a material
/// and give a BRDF, with bindings that a host may replace. example_METHOD is a compute program that calls it.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Shading language
    #[arg(long, value_name = "LANGUAGE", required_unless_present = "vectors")]
    pub lang: Option<Language>,
    /// Write golden vectors: of each method a small pack, pixels and what the method gives for them, as JSON and raw
    #[arg(long)]
    pub vectors: bool,
    /// Folder to write into; it is created
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Only this method; may be given more than once [default: all]
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(translate::methods()))]
    pub method: Vec<String>,
    /// Check everything, say what would be done, write nothing
    #[arg(short = 'n', long, conflicts_with = "json")]
    pub dry_run: bool,
    /// Print the list of files to standard output
    #[arg(long)]
    pub json: bool,
}

/// Languages that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Language {
    /// WebGPU's, as the library is written (.wgsl)
    Wgsl,
    /// Direct3D's, shader model 5.1 (.hlsl)
    Hlsl,
    /// OpenGL's, version 4.50 (.glsl)
    Glsl,
    /// Metal's, version 2.0 (.metal)
    Msl,
    /// Vulkan's binary, version 1.0, of the examples (.spv)
    Spirv,
}

impl Language {
    fn translated(self) -> translate::Language {
        match self {
            Language::Wgsl => translate::Language::Wgsl,
            Language::Hlsl => translate::Language::Hlsl,
            Language::Glsl => translate::Language::Glsl,
            Language::Msl => translate::Language::Msl,
            Language::Spirv => translate::Language::Spirv,
        }
    }
}

/// Where the schema of an interface lives; its `$id`.
const INTERFACE_SCHEMA: &str =
    "https://raw.githubusercontent.com/glint-bake/glint-bake/main/docs/schema/glint-interface.schema.json";

/// The JSON of an interface.
#[derive(Debug, Serialize)]
struct Described {
    #[serde(rename = "$schema")]
    schema: &'static str,
    tool_version: &'static str,
    #[serde(flatten)]
    interface: describe::Interface,
}

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct List {
    #[serde(rename = "$schema")]
    schema: &'static str,
    tool_version: &'static str,
    language: Option<Language>,
    files: Vec<FileInfo>,
}

/// One file.
#[derive(Debug, Serialize)]
struct FileInfo {
    file: String,
    bytes: u64,
    xxh3_128: String,
}

/// Runs the subcommand.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    let wanted = |method: &&str| args.method.is_empty() || args.method.iter().any(|name| name == method);
    let methods: Vec<&str> = translate::methods().into_iter().filter(wanted).collect();
    let mut files = Vec::new();
    if let Some(language) = args.lang {
        let translated = translate::files(language.translated(), &methods);
        files = translated.map_err(|e| Failure::new(Exit::Unexpected, format!("{e}; please report this")))?;
        files.extend(methods.iter().map(|method| interface(method)));
    }
    if args.vectors {
        for method in methods {
            files.extend(vectors::files(method)?);
        }
    }
    let paths: Vec<PathBuf> = files.iter().map(|file| args.output.join(&file.name)).collect();
    if args.dry_run {
        let there = paths.iter().filter(|path| path.parent().is_some_and(Path::exists));
        there.into_iter().try_for_each(|path| output::check_writable(path))?;
        for path in &paths {
            terminal.say(&format!("would write {}", path.display()));
        }
        terminal.say("dry run, nothing was written");
        return Ok(());
    }
    for folder in paths.iter().filter_map(|path| path.parent()) {
        output::create_folder(folder)?;
    }
    paths.iter().try_for_each(|path| output::check_writable(path))?;
    for (file, path) in files.iter().zip(&paths) {
        let said = match output::write(path, &file.bytes)? {
            WriteOutcome::Written => "written",
            WriteOutcome::Unchanged => "unchanged",
        };
        terminal.say(&format!("{}: {said}", path.display()));
    }
    if args.json {
        output::print(&list(args.lang, &files))?;
    }
    Ok(())
}

/// What a method's files say of themselves, `glint_<method>.json`.
fn interface(method: &str) -> ShaderFile {
    let described = Described {
        schema: INTERFACE_SCHEMA,
        tool_version: env!("CARGO_PKG_VERSION"),
        interface: describe::interface(method),
    };
    let mut text = serde_json::to_string_pretty(&described).expect("interfaces have string keys only");
    text.push('\n');
    ShaderFile { name: format!("glint_{method}.json"), bytes: text.into_bytes() }
}

/// The list as JSON, with a line end.
fn list(language: Option<Language>, files: &[ShaderFile]) -> String {
    let describe = |file: &ShaderFile| FileInfo {
        file: file.name.clone(),
        bytes: file.bytes.len() as u64,
        xxh3_128: InputDigest::of(&file.name, &file.bytes).xxh3_128,
    };
    let list = List {
        schema: SCHEMA,
        tool_version: env!("CARGO_PKG_VERSION"),
        language,
        files: files.iter().map(describe).collect(),
    };
    let mut text = serde_json::to_string_pretty(&list).expect("lists have string keys only");
    text.push('\n');
    text
}
