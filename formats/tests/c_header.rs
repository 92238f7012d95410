//! The reader in C, `formats/c/glint_pack.h`: it compiles without warnings, finds what the Rust reader finds, and reads nothing
//! outside a pack, whatever the bytes. Skipped where there is no C compiler `cc`.

use crate::samples::*;
use glint_formats::container::{FourCc, Limits};
use glint_formats::dictionary::{TABLE, UNIFORM};
use glint_formats::{Codec, IssueCode, Pack, Resource, Section, SectionEntry, Severity, kinds, vk_format};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;
use xxhash_rust::xxh3::xxh3_64;

/// Every warning is an error.
const WARNINGS: [&str; 7] =
    ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wsign-conversion", "-Wshadow", "-Werror"];
/// A read outside a pack, or a step that C does not define, ends the program with another code than 0.
const SANITIZERS: [&str; 3] = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-O1"];
/// Damaged copies that `mutate` makes.
const MUTATIONS: u64 = 1_000_000;
/// What they are made of, besides the dictionary of version 1: small packs of `fixtures/corrupt` with each type of resource and
/// codec. Their container is sound, so copies are damaged where `mutate` damages them.
const MUTATED: [&str; 11] =
    ["G1028", "G1029", "G1031", "G2001", "G2002", "G2004", "G3002", "G3020", "G3030", "G3044", "G3060"];

fn folder_of_c() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("c")
}

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures")
}

fn files_of(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

fn damaged_fixture(id: &str) -> PathBuf {
    fixtures().join("corrupt").join(id).join("bad.glintpack")
}

/// Whether a compiler turns a program of nothing into one that runs, with these flags.
fn compiles(compiler: &str, flags: &[&str]) -> bool {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("nothing.c");
    fs::write(&source, "int main(void) { return 0; }\n").unwrap();
    let program = folder.path().join("nothing");
    let compiled = Command::new(compiler).args(flags).arg("-o").arg(&program).arg(&source).output();
    compiled.is_ok_and(|output| output.status.success())
        && Command::new(&program).status().is_ok_and(|status| status.success())
}

/// Whether tests of compiled programs can run; says so where they cannot.
fn can_compile(flags: &[&str]) -> bool {
    let can = compiles("cc", flags);
    if !can {
        eprintln!("skipped: `cc {}` makes no program", flags.join(" "));
    }
    can
}

/// Compiles one of the programs beside the header, or beside another one in `include`.
fn build(include: &Path, name: &str, flags: &[&str]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join(name);
    // A quoted include looks beside its file first, so the source goes with the header that is meant.
    let source = include.join(name).with_extension("c");
    let output =
        Command::new("cc").args(["-std=c99"]).args(WARNINGS).args(flags).arg("-o").arg(&program).arg(source).output();
    let output = output.unwrap();
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    (folder, program)
}

#[test]
fn it_compiles_without_warnings() {
    let folder = tempfile::tempdir().unwrap();
    let header_alone = folder.path().join("header_alone.c");
    fs::write(&header_alone, "#include \"glint_pack.h\"\n").unwrap();
    let program = |name: &str| folder_of_c().join(name);
    for compiler in ["cc", "clang"] {
        for (language, standard, source) in [
            ("c", "-std=c99", &header_alone),
            ("c", "-std=c99", &program("example_list.c")),
            ("c", "-std=c99", &program("issues.c")),
            ("c", "-std=c99", &program("mutate.c")),
            ("c", "-std=c17", &header_alone),
            ("c++", "-std=c++11", &header_alone),
            ("c++", "-std=c++11", &program("example_list.c")),
            ("c++", "-std=c++20", &header_alone),
        ] {
            if !compiles(compiler, &["-x", language, standard]) {
                eprintln!("skipped: `{compiler} -x {language} {standard}` makes no program");
                continue;
            }
            let mut command = Command::new(compiler);
            command.args(["-x", language, standard, "-O2", "-c", "-o"]).arg(folder.path().join("object"));
            let output = command.args(WARNINGS).arg("-I").arg(folder_of_c()).arg(source).output().unwrap();
            let message = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{compiler} {standard} {}: {message}", source.display());
        }
    }
}

#[test]
fn it_is_one_file_that_includes_only_what_c_always_has() {
    let header = fs::read_to_string(folder_of_c().join("glint_pack.h")).unwrap();
    let included: Vec<&str> = header.lines().filter(|line| line.starts_with("#include")).collect();
    assert_eq!(included, ["#include <stddef.h>", "#include <stdint.h>", "#include <string.h>"]);
    assert!(fs::read_to_string(folder_of_c().join("example_list.c")).unwrap().lines().count() <= 150);
}

/// The line of `example_list` about a section.
fn line_of(entry: &SectionEntry) -> String {
    let resource = match entry.resource {
        Resource::Parameters => String::from("parameters"),
        Resource::Buffer { stride, count } => format!("buffer {count} x {stride} bytes"),
        Resource::Texture { vk_format, width, height, layers, faces, mips } => {
            let name = vk_format::name(vk_format).unwrap();
            format!("texture {name} {width} x {height}, layers {layers}, faces {faces}, mips {mips}")
        }
    };
    let codec = if entry.codec == Codec::None { "plain" } else { "zstd" };
    let (stored, offset, raw, checksum) = (entry.stored_len, entry.offset, entry.raw_len, entry.checksum);
    format!("{}: {resource}; {stored} bytes at {offset}, {codec}, {raw} raw, checksum {checksum:016x}\n", entry.label())
}

/// Density of a slope in a row, from the words of SDTB as the format says.
fn density(words: &[u8], entries: u32, domain: f32, row: u32, slope: f32) -> f32 {
    let half = |word: usize, upper: usize| {
        let at = 4 * (row * entries) as usize + 4 * word + 2 * upper;
        half::f16::from_le_bytes([words[at], words[at + 1]]).to_f32()
    };
    if slope.abs() > domain {
        return 0.0;
    }
    let place = (slope.abs() * entries as f32 / domain - 0.5).clamp(0.0, (entries - 1) as f32);
    half(place as usize, 0) + (half(place as usize, 1) - half(place as usize, 0)) * place.fract()
}

/// The lines of `example_list` about a dictionary that is not compressed.
fn dictionary_lines(pack: &Pack) -> String {
    let Some(uniform) = pack.sections().iter().find(|entry| entry.kind == UNIFORM) else { return String::new() };
    let payload = pack.payload(uniform).unwrap();
    let table = pack.payload(pack.find(TABLE, &uniform.name).unwrap()).unwrap();
    let word = |at: usize| u32::from_le_bytes(payload[4 * at..4 * at + 4].try_into().unwrap());
    let (marginals, levels, entries, domain) = (word(0), word(1), word(2), f32::from_bits(word(4)));
    let mut lines = format!(
        "{}: {marginals} marginals, {levels} levels, {entries} entries up to slope {domain:.5}\n",
        uniform.name
    );
    for level in 0..levels {
        let at = |slope| density(&table, entries, domain, level * marginals, slope);
        let (middle, near, far) = (at(0.0), at(0.1), at(-0.5));
        writeln!(lines, "level {level}: P(0) = {middle:.5}, P(0.1) = {near:.5}, P(-0.5) = {far:.5}").unwrap();
    }
    lines
}

#[test]
fn the_example_prints_what_the_rust_reader_says() {
    if !can_compile(&[]) {
        return;
    }
    let (folder, program) = build(&folder_of_c(), "example_list", &["-O2"]);
    let mut files = files_of(&fixtures().join("packs/v1"));
    assert!(files.len() >= 3);
    let compressed = placed(&noise_texels()).into_iter().map(Section::compressed).collect();
    for (name, bytes) in [("full", full_pack()), ("compressed", pack(compressed)), ("empty", pack(Vec::new()))] {
        files.push(folder.path().join(name).with_extension("glintpack"));
        fs::write(files.last().unwrap(), bytes).unwrap();
    }
    for file in files {
        let pack = Pack::open(&file, &Limits::default()).unwrap();
        let lines: String = pack.sections().iter().map(line_of).collect();
        let output = Command::new(&program).arg(&file).output().unwrap();
        assert_eq!(String::from_utf8_lossy(&output.stdout), lines + &dictionary_lines(&pack), "{}", file.display());
        assert_eq!(output.status.code(), Some(0));
    }
}

#[test]
fn the_example_s_exit_codes_are_those_of_glint_info() {
    if !can_compile(&[]) {
        return;
    }
    let (_folder, program) = build(&folder_of_c(), "example_list", &["-O2"]);
    let run = |arguments: &[PathBuf]| Command::new(&program).args(arguments).output().unwrap();
    assert_eq!(run(&[]).status.code(), Some(2));
    assert_eq!(run(&[fixtures().join("none")]).status.code(), Some(3));
    let refused = run(&[damaged_fixture("G1027")]);
    assert_eq!(refused.status.code(), Some(4));
    assert!(String::from_utf8_lossy(&refused.stderr).ends_with(": G1027 section checksum differs\n"));
}

/// The issue that the header is to find: the first one that is an error of the container and can be found without
/// decompression. Where there is none the fault of a damaged pack, if any, is in what a payload says.
fn expected(bytes: &[u8]) -> Option<IssueCode> {
    match Pack::from_bytes(bytes.to_vec(), &Limits::default()) {
        Err(issues) => issues.iter().find(|issue| issue.severity == Severity::Error).map(|issue| issue.code),
        Ok(pack) => {
            let changed = |entry| {
                let code = pack.payload(entry).err()?.code;
                (code == IssueCode::SectionChecksum).then_some(code)
            };
            pack.sections().iter().find_map(changed)
        }
    }
}

/// Has the header read packs and compares issue, its title and the checksum of all bytes with ours. Gives the issues.
fn compare(packs: &[Vec<u8>]) -> Vec<Option<IssueCode>> {
    let flags: &[&str] = if compiles("cc", &SANITIZERS) { &SANITIZERS } else { &["-O2"] };
    let (folder, program) = build(&folder_of_c(), "issues", flags);
    let mut stream = Vec::new();
    for bytes in packs {
        stream.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
        stream.extend_from_slice(bytes);
    }
    let file = folder.path().join("packs");
    fs::write(&file, stream).unwrap();
    let output = Command::new(&program).stdin(Stdio::from(File::open(&file).unwrap())).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> = printed.lines().collect();
    assert_eq!(lines.len(), packs.len());
    let mut issues = Vec::new();
    for (i, (bytes, line)) in packs.iter().zip(lines).enumerate() {
        let issue = expected(bytes);
        let (number, title) = issue.map_or((0, "no error"), |code| (code as u16, code.title()));
        assert_eq!(line, format!("{number} {:016x} {title}", xxh3_64(bytes)), "pack {i} of {} bytes", bytes.len());
        issues.push(issue);
    }
    issues
}

#[test]
fn it_refuses_every_damaged_pack_whose_container_is_at_fault() {
    if !can_compile(&[]) {
        return;
    }
    let files: Vec<PathBuf> = IssueCode::ALL
        .iter()
        .map(|code| damaged_fixture(&code.to_string()))
        .chain(files_of(&fixtures().join("packs/v1")))
        .collect();
    let packs: Vec<Vec<u8>> = files.iter().map(|file| fs::read(file).unwrap()).collect();
    let found = compare(&packs);
    for (&code, found) in IssueCode::ALL.iter().zip(found) {
        // Decompression is the caller's, and a section that may be skipped is no error.
        let left_out = [IssueCode::BadCompression, IssueCode::DecompressedLength, IssueCode::UnknownOptional];
        let is_container_s = (code as u16) < 2000 && !left_out.contains(&code);
        assert_eq!(found, is_container_s.then_some(code));
    }
}

/// The `i`th random number.
fn random(i: u64) -> u64 {
    xxh3_64(&i.to_le_bytes())
}

#[test]
fn it_finds_the_same_issue_first_in_packs_with_many() {
    if !can_compile(&[]) {
        return;
    }
    let compressed = placed(&noise_texels()).into_iter().map(Section::compressed).collect();
    let sources = [pack(good_dictionary()), pack(compressed), pack(good_area_light()), full_pack()];
    let mut packs = Vec::new();
    for i in 0..12_000u64 {
        let mut bytes = sources[(i % 4) as usize].clone();
        for change in 0..1 + random(16 * i) % 3 {
            let number = |n: u64| random(16 * i + 5 * change + n);
            let table = entry_at(4, 0).min(bytes.len() - 8);
            let at =
                if number(1) % 4 == 0 { number(2) as usize % (bytes.len() - 8) } else { number(2) as usize % table };
            let value = match number(3) % 6 {
                0 => number(4),
                1 => u64::MAX,
                2 => 1 << (number(4) % 64),
                3 => number(4) % 300,
                4 => 256 * (number(4) % 8),
                _ => bytes.len() as u64,
            };
            let width = 1 << (number(4) % 4);
            bytes[at..at + width].copy_from_slice(&value.to_le_bytes()[..width]);
        }
        match i / 4 % 4 {
            0 => {}
            1 => reseal_header(&mut bytes),
            _ => {
                seal(&mut bytes);
                reseal_sections(&mut bytes);
                reseal_header(&mut bytes);
            }
        }
        packs.push(bytes);
    }
    let found: BTreeSet<Option<IssueCode>> = compare(&packs).into_iter().collect();
    assert!(found.len() >= 25, "only {found:?}");
}

#[test]
fn it_judges_names_as_the_rust_reader_does() {
    if !can_compile(&[]) {
        return;
    }
    let good = pack(vec![provenance_section()]);
    let with_name = |name: &[u8]| {
        let mut field = [0; 64];
        field[0] = name.len() as u8;
        field[1..1 + name.len()].copy_from_slice(name);
        patched(good.clone(), entry_at(0, 72), &field)
    };
    let mut packs: Vec<Vec<u8>> = (0..=0x7f).map(|byte| with_name(&[b'a', byte, b'b'])).collect();
    for first in 0x80..=0xff {
        for second in [0x00, 0x7f, 0x80, 0x8f, 0x90, 0x9f, 0xa0, 0xbf, 0xc0, 0xff] {
            let bytes = [first, second, 0x80, 0x80];
            packs.extend((1..=4).map(|len| with_name(&bytes[..len])));
        }
    }
    packs.push(with_name(&[b'n'; 63]));
    packs.push(patched(with_name(&[b'n'; 63]), entry_at(0, 72), &[64]));
    packs.push(patched(with_name(b"n"), entry_at(0, 135), b"n"));
    let found = compare(&packs);
    assert!(found.contains(&None) && found.contains(&Some(IssueCode::BadName)));
}

#[test]
fn it_finds_two_sections_of_one_kind_and_name_wherever_they_stand() {
    if !can_compile(&[]) {
        return;
    }
    let good = pack((0..1300).map(|i| plain_section(&format!("{i}"))).collect());
    let name_of = |i: usize| good[entry_at(i, 72)..entry_at(i, 136)].to_vec();
    let mut packs = vec![good.clone()];
    for (first, second) in [(0, 1), (0, 511), (0, 512), (0, 1299), (511, 512), (512, 1023), (600, 1100), (1298, 1299)] {
        packs.push(patched(good.clone(), entry_at(second, 72), &name_of(first)));
    }
    let found = compare(&packs);
    assert_eq!(found[0], None);
    assert!(found[1..].iter().all(|&issue| issue == Some(IssueCode::DuplicateSection)));
}

#[test]
fn it_knows_the_kinds_and_texture_formats_of_the_rust_reader() {
    if !can_compile(&[]) {
        return;
    }
    let of_kind = |kind, version| {
        let section = Section { version, ..Section::buffer(kind, "", &[1u8]) };
        pack(vec![section])
    };
    let mut packs: Vec<Vec<u8>> = kinds::all().flat_map(|of| [of_kind(of.kind, 1), of_kind(of.kind, 2)]).collect();
    packs.push(of_kind(FourCc(*b"ROVN"), 1));
    let found = compare(&packs);
    for pair in found[..found.len() - 1].chunks(2) {
        assert_eq!(pair, [None, Some(IssueCode::UnsupportedSectionVersion)]);
    }
    assert_eq!(found.last(), Some(&Some(IssueCode::UnknownRequired)));

    let (_folder, program) = build(&folder_of_c(), "issues", &["-O2"]);
    let output = Command::new(program).arg("formats").output().unwrap();
    let row = |code| Some(format!("{code} {} {}\n", vk_format::name(code)?, vk_format::texel_bytes(code)?));
    assert_eq!(String::from_utf8(output.stdout).unwrap(), (0..1000).filter_map(row).collect::<String>());
}

/// Bytes that are no packs do for this; their checksums are compared all the same.
#[test]
fn its_checksum_is_xxh3_at_every_length() {
    if !can_compile(&[]) {
        return;
    }
    let noise: Vec<u8> = (0..700).flat_map(|i| random(i).to_le_bytes()).collect();
    compare(&(0..2200).chain([4095, 4096, 4097]).map(|len| noise[len % 7..len % 7 + len].to_vec()).collect::<Vec<_>>());
}

/// Runs `mutate` with the header in `include`.
fn mutate(include: &Path, count: u64) -> std::process::Output {
    let (_folder, program) = build(include, "mutate", &SANITIZERS);
    let packs = MUTATED.map(damaged_fixture);
    let dictionary = fixtures().join("packs/v1/dictionary.glintpack");
    // The header frees nothing, so memory that was freed need not be kept from use; that, and filling new memory, takes a fifth of
    // the time.
    let mut command = Command::new(program);
    command.env("ASAN_OPTIONS", "quarantine_size_mb=1:max_malloc_fill_size=0");
    command.args([&count.to_string(), "1"]).arg(dictionary).args(packs).output().unwrap()
}

#[test]
fn no_damage_makes_it_read_outside_a_pack() {
    if !can_compile(&SANITIZERS) {
        return;
    }
    let output = mutate(&folder_of_c(), MUTATIONS);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    let printed = String::from_utf8(output.stdout).unwrap();
    let opened: u64 = printed.split_whitespace().nth(3).unwrap().parse().unwrap();
    assert!(opened > MUTATIONS / 10, "too few damaged packs open for what lies behind to be tried: {printed}");
}

/// A header without one of its checks is caught: the test above can fail.
#[test]
fn a_check_that_is_missing_is_found_by_damage() {
    if !can_compile(&SANITIZERS) {
        return;
    }
    let header = fs::read_to_string(folder_of_c().join("glint_pack.h")).unwrap();
    let checks = [
        "table_end > size",
        "section.offset > pack->size || section.stored_len > pack->size - section.offset",
        "len > reader->len - reader->at",
    ];
    for check in checks {
        assert_eq!(header.matches(check).count(), 1, "{check}");
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("glint_pack.h"), header.replace(check, "0")).unwrap();
        fs::copy(folder_of_c().join("mutate.c"), folder.path().join("mutate.c")).unwrap();
        assert!(!mutate(folder.path(), 100_000).status.success(), "nothing was wrong without `{check}`");
    }
}
