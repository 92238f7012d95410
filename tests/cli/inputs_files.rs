//! Files as they come: names that file systems allow, pipes and devices, byte order marks, outputs that cannot be written.

use crate::projects::program;
use crate::support::{bake, info, json, maps, packs, sky};
use glint_bake::input::synthetic;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// What a program did that may have got anything as its input and its arguments.
struct Done {
    code: i32,
    stdout: Vec<u8>,
    stderr: String,
}

/// Runs a program with `input` on its standard input; it has to end within a minute.
#[track_caller]
fn run(name: &str, folder: &Path, args: &[&OsStr], input: &[u8]) -> Done {
    let mut command = Command::new(program(name));
    command.current_dir(folder).args(args);
    finish(command, input)
}

#[track_caller]
fn finish(mut command: Command, input: &[u8]) -> Done {
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let (mut stdin, input) = (child.stdin.take().unwrap(), input.to_vec());
    // A program that does not read closes the pipe.
    std::thread::spawn(move || stdin.write_all(&input).ok());
    let id = child.id();
    let (sender, receiver) = std::sync::mpsc::channel();
    std::thread::spawn(move || sender.send(child.wait_with_output()).ok());
    let Ok(output) = receiver.recv_timeout(Duration::from_secs(60)) else { panic!("process {id} hangs: {command:?}") };
    let output = output.unwrap();
    Done {
        code: output.status.code().unwrap(),
        stdout: output.stdout,
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

fn words<'a>(args: &[&'a str]) -> Vec<&'a OsStr> {
    args.iter().map(|&arg| OsStr::new(arg)).collect()
}

/// A map or a sky for a method, and the flags that make its bake quick.
const METHODS: [(&str, &str, &[&str]); 4] = [
    ("ndf-maps", "flakes.png", &["--preset", "draft"]),
    ("area-light", "flakes.png", &[]),
    ("lobes", "flakes.png", &[]),
    ("environment", "sky.hdr", &["--face-size", "4", "--levels", "2"]),
];

fn inputs() -> tempfile::TempDir {
    let folder = maps();
    sky(&folder.path().join("sky.hdr"));
    folder
}

/// Names that file systems allow: the one of the table of cases first.
fn odd_names() -> Vec<OsString> {
    let plain = [
        "back\\slash",
        "pi|pe",
        "semi;colon",
        "dol$lar",
        "co:lon",
        "ha#sh",
        "sp ace ",
        " lead",
        "per%cent",
        "quo\"te's`",
        "st*r?<>^&",
        "tab\tbed",
        "two\nlines",
        "return\r",
        "bell\x07\x1b[31mred",
        "naïve-日本",
        "{a,b}[c]~!=+",
        "..",
        "ends.",
    ];
    let mut names: Vec<OsString> = plain.map(OsString::from).to_vec();
    names.push("n".repeat(240).into());
    #[cfg(target_os = "linux")]
    names.push(std::os::unix::ffi::OsStringExt::from_vec(b"not\xffutf\xfe8".to_vec()));
    names
}

fn with(name: &OsStr, end: &str) -> OsString {
    let mut name = name.to_owned();
    name.push(end);
    name
}

#[cfg(unix)]
#[test]
fn every_method_bakes_every_name() {
    for (method, input, flags) in METHODS {
        let folder = inputs();
        let end = format!(".{}", input.rsplit('.').next().unwrap());
        for name in odd_names() {
            let (file, pack) = (with(&name, &end), with(&name, ".glintpack"));
            fs::copy(folder.path().join(input), folder.path().join(&file)).unwrap();
            let args =
                [words(&[method, "--json", "-q"]), vec!["-o".as_ref(), &pack], words(flags), vec![&file]].concat();
            let done = run("glint-bake", folder.path(), &args, b"");
            assert_eq!(done.code, 0, "{method} {file:?}: {}", done.stderr);
            let report = json(std::str::from_utf8(&done.stdout).unwrap());
            let recorded = report["provenance"][0]["inputs"][0]["name"].as_str().unwrap();
            assert!(!recorded.contains('\\') && !recorded.chars().any(char::is_control), "{recorded:?}");
            assert_eq!(run("glint-info", folder.path(), &[&pack, "--verify".as_ref()], b"").code, 0, "{pack:?}");
            // A name that had to be changed is said, in the pack too.
            let notes = report["provenance"][0]["notes"].to_string();
            assert_eq!(OsStr::new(recorded) != file, notes.contains("the pack records the file's name as"), "{notes}");
        }
    }
}

#[cfg(unix)]
#[test]
fn projects_build_every_name() {
    let above = tempfile::tempdir().unwrap();
    for place in odd_names() {
        let folder = above.path().join(with(&place, "d"));
        fs::create_dir(&folder).unwrap();
        synthetic::flakes(4, 4, 1).save(folder.join("sound.png")).unwrap();
        let name = place.to_str().unwrap_or("plain").to_owned() + ".png";
        fs::copy(folder.join("sound.png"), folder.join(&name)).unwrap();
        let text = format!(
            "output = 'p q'\n[defaults.ndf-maps]\npreset = 'draft'\n[materials.a]\nmethod = 'ndf-maps'\ninput = {name:?}\n\
             report = 'r e.json'\n"
        );
        fs::write(folder.join("glint.toml"), toml_text(&text, &name)).unwrap();
        let project = folder.join("glint.toml");
        let build = |flags: &[&str]| {
            run("glint-bake", above.path(), &[words(&["build"]), words(flags), vec![project.as_os_str()]].concat(), b"")
        };
        let done = build(&[]);
        assert!(done.code == 0 && done.stderr.ends_with("1 written\n"), "{place:?}: {}", done.stderr);
        assert!(folder.join("p q/a.glintpack").is_file() && folder.join("r e.json").is_file(), "{place:?}");
        assert_eq!(build(&["--check"]).code, 0, "{place:?}");
    }
}

/// Rust's quotes of `name` in a text as TOML's.
fn toml_text(text: &str, name: &str) -> String {
    let escape = |c: char| if c.is_control() || "\"\\".contains(c) { format!("\\u{:04x}", c as u32) } else { c.into() };
    text.replace(&format!("{name:?}"), &format!("\"{}\"", name.chars().map(escape).collect::<String>()))
}

/// Every character of a byte and some beyond, within a name.
fn characters() -> Vec<char> {
    (1..127u8).map(char::from).filter(|c| *c != '/').chain(['\u{7f}', 'é', '日']).collect()
}

/// A project with one pack an input of these names.
fn project_of(folder: &Path, names: &[String]) {
    let mut text = String::from("[defaults.ndf-maps]\npreset = 'draft'\n");
    for (k, name) in names.iter().enumerate() {
        synthetic::flakes(2, 2, 1).save(folder.join("sound.png")).unwrap();
        fs::rename(folder.join("sound.png"), folder.join(name)).unwrap();
        text += &toml_text(&format!("[materials.m{k}]\nmethod = 'ndf-maps'\ninput = {name:?}\n"), name);
    }
    fs::write(folder.join("glint.toml"), text).unwrap();
}

#[cfg(unix)]
#[test]
fn ninja_builds_every_name_that_is_not_refused() {
    let mut taken = Vec::new();
    for c in characters() {
        let folder = tempfile::tempdir().unwrap();
        let name = format!("a{c}b.png");
        project_of(folder.path(), std::slice::from_ref(&name));
        let done = bake(folder.path(), &["ninja", "-o", "build.ninja"]);
        if "|\n\r".contains(c) {
            assert_eq!(done.code, 2, "{name:?}");
            assert!(
                done.stderr.contains(&format!("{name:?}")) && done.stderr.contains(&format!("{c:?}")),
                "{}",
                done.stderr
            );
            assert!(!folder.path().join("build.ninja").exists());
        } else {
            assert_eq!(done.code, 0, "{name:?}: {}", done.stderr);
            taken.push(name);
        }
    }
    let folder = tempfile::tempdir().unwrap();
    project_of(folder.path(), &taken);
    let program = program("glint-bake");
    bake(folder.path(), &["ninja", "-o", "build.ninja", "--program", program.to_str().unwrap()]).ok();
    let ninja = || Command::new("ninja").current_dir(folder.path()).output();
    let Ok(first) = ninja() else { return eprintln!("skipped: ninja is not installed") };
    assert!(first.status.success(), "{}", String::from_utf8_lossy(&first.stdout));
    assert_eq!(fs::read_dir(folder.path().join("packs")).unwrap().count(), taken.len());
    let again = ninja().unwrap();
    assert!(String::from_utf8_lossy(&again.stdout).contains("no work to do"), "{again:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn names_that_are_no_utf8_are_refused_where_build_tools_cannot_have_them() {
    use std::os::unix::ffi::OsStrExt;
    let above = tempfile::tempdir().unwrap();
    let name = OsStr::from_bytes(b"bad\xff");
    let folder = above.path().join(name);
    fs::create_dir(&folder).unwrap();
    project_of(&folder, &["sound.png".into()]);
    for (args, output) in [(["ninja"], "-o"), (["build"], "--depfile")] {
        let project = Path::new(name).join("glint.toml");
        let args = [words(&args), vec![project.as_os_str(), output.as_ref(), "written".as_ref()]].concat();
        let done = run("glint-bake", above.path(), &args, b"");
        assert_eq!(done.code, 2, "{}", done.stderr);
        assert!(done.stderr.contains("no UTF-8") && done.stderr.contains("\\xFF"), "{}", done.stderr);
    }
    assert!(!folder.join("packs").exists() && !above.path().join("written").exists());
}

/// Depfiles hold the names that Make and ninja read back, both of them; the others are refused before work.
#[cfg(unix)]
#[test]
fn depfiles_hold_what_make_and_ninja_read() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let sound = || synthetic::flakes(2, 2, 1).save(at("sound.png")).unwrap();
    let mut taken: Vec<String> = Vec::new();
    let patterns = |c: char| {
        let all = [format!("a{c}b"), format!("{c}b"), format!("a{c}"), format!("a{c}#b"), format!("a{c}$b")];
        // Letters and digits are alike.
        if c.is_ascii_alphanumeric() && c != 'a' { all[..0].to_vec() } else { all.to_vec() }
    };
    for name in characters().into_iter().flat_map(patterns).chain(["a(b)".into(), "(a) b".into(), "a\\\\ b".into()]) {
        if [".", ".."].contains(&name.as_str()) || at(&name).exists() {
            continue;
        }
        sound();
        fs::rename(at("sound.png"), at(&name)).unwrap();
        // Before work: a dry run finds it too.
        let path = format!("./{name}");
        let done = bake(folder.path(), &["ndf-maps", "-n", "-o", "out", "--depfile", "out.d", &path]);
        if done.code == 0 {
            // As it is found in the file; a ./ would hide what begins with it.
            taken.push(name);
        } else {
            assert!(done.code == 2 && done.stderr.contains(&format!("{path:?}")), "{name:?}: {}", done.stderr);
        }
    }
    // Those of the table of cases, and no letter, are refused.
    for c in ";:^*<>`\t|\n".chars() {
        assert!(!taken.contains(&format!("a{c}b")), "{c:?}");
    }
    for c in "a $#\\%é日-_.,+@[]{}()!~".chars() {
        assert!(taken.contains(&format!("a{c}b")), "{c:?}");
    }
    let taken: Vec<String> = taken.into_iter().filter(|name| !name.starts_with(['-', '@', '~'])).collect();
    let args: Vec<&str> = ["ndf-maps", "--preset", "draft", "-q", "-o", "out", "--depfile", "out.d"].to_vec();
    bake(folder.path(), &[args, taken.iter().map(String::as_str).collect()].concat()).ok();

    let past = std::time::SystemTime::now() - Duration::from_secs(1000);
    let set = |name: &str, time| fs::File::options().append(true).open(at(name)).unwrap().set_modified(time).unwrap();
    taken.iter().for_each(|name| set(name, past));
    fs::write(at("Makefile"), "out:\n\t@false\n-include out.d\n").unwrap();
    let make = || Command::new("make").arg("-q").current_dir(folder.path()).output();
    if let Ok(output) = make() {
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        for name in &taken {
            set(name, std::time::SystemTime::now() + Duration::from_secs(1000));
            assert_eq!(make().unwrap().status.code(), Some(1), "make does not see {name:?}");
            set(name, past);
        }
    } else {
        eprintln!("skipped: make is not installed");
    }
    // Ninja reads the file into its log once.
    fs::copy(at("out.d"), at("kept.d")).unwrap();
    let rule = "rule r\n  command = cp kept.d out.d && touch out\n  depfile = out.d\n  deps = gcc\nbuild out: r\n";
    fs::write(at("build.ninja"), rule).unwrap();
    let ninja = |args: &[&str]| Command::new("ninja").args(args).current_dir(folder.path()).output();
    let Ok(first) = ninja(&[]) else { return eprintln!("skipped: ninja is not installed") };
    assert!(first.status.success(), "{first:?}");
    let dry = || String::from_utf8_lossy(&ninja(&["-n"]).unwrap().stdout).contains("no work to do");
    assert!(dry(), "{}", String::from_utf8_lossy(&ninja(&["-n", "-d", "explain"]).unwrap().stderr));
    for name in &taken {
        set(name, std::time::SystemTime::now() + Duration::from_secs(1000));
        assert!(!dry(), "ninja does not see {name:?}");
        set(name, past);
    }
}

/// A pipe in the file system, with `bytes` in it.
#[cfg(unix)]
fn fifo(path: &Path, bytes: Vec<u8>) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
    let path = path.to_owned();
    std::thread::spawn(move || fs::write(path, bytes).ok());
}

#[cfg(unix)]
#[test]
fn pipes_are_read_once_by_every_method() {
    for (method, input, flags) in METHODS {
        let folder = inputs();
        // More than a pipe holds at a time, where the method takes that much.
        let input = if method == "area-light" {
            synthetic::scratches(256, 256, 3).save(folder.path().join("large.png")).unwrap();
            "large.png"
        } else {
            input
        };
        let bytes = fs::read(folder.path().join(input)).unwrap();
        fs::copy(folder.path().join(input), folder.path().join("stdin")).unwrap();
        let pack = |args: &[&str], stdin: &[u8]| {
            let done = run(
                "glint-bake",
                folder.path(),
                &[words(&[method, "-o", "out.glintpack"]), words(flags), words(args)].concat(),
                stdin,
            );
            assert_eq!(done.code, 0, "{method} {args:?}: {}", done.stderr);
            fs::read(folder.path().join("out.glintpack")).unwrap()
        };
        let expected = pack(&["stdin"], b"");
        assert!(pack(&["-"], &bytes) == expected, "{method}");
        assert!(pack(&["/dev/stdin"], &bytes) == expected, "{method}");
        let inner = tempfile::tempdir().unwrap();
        let path = inner.path().join("stdin");
        fifo(&path, bytes.clone());
        assert!(pack(&[path.to_str().unwrap()], b"") == expected, "{method}: a FIFO");
        // A shell's own pipes, of whatever number, have one name.
        let shell = |prefix: &str| {
            let script =
                format!("{prefix} exec \"$0\" {method} -o out.glintpack {} -- <(cat {input})", flags.join(" "));
            let mut command = Command::new("bash");
            command.current_dir(folder.path()).args(["-c", &script]).arg(program("glint-bake"));
            let done = finish(command, b"");
            assert_eq!(done.code, 0, "{method}: {}", done.stderr);
            fs::read(folder.path().join("out.glintpack")).unwrap()
        };
        if Command::new("bash").arg("-c").arg(": <(:)").status().is_ok_and(|status| status.success()) {
            assert!(shell("") == shell("exec 63</dev/null;"), "{method}");
        }
        // A stream is bounded by what is read of it, not by what is said. An environment's pack alone is beyond this limit.
        let limit = match method {
            "environment" => "the limit is 100; raise --max-memory",
            _ => "at most 100 bytes, found more; raise --max-memory",
        };
        for (args, code, part) in [
            (&["/dev/zero"][..], 3, "is a device"),
            (&["/dev/null"], 3, "is a device"),
            (&["."], 3, "is a folder"),
            (&["-", "--max-memory", "100"], 6, limit),
        ] {
            let done = run(
                "glint-bake",
                folder.path(),
                &[words(&[method, "-o", "no"]), words(flags), words(args)].concat(),
                &bytes,
            );
            assert_eq!(done.code, code, "{method} {args:?}: {}", done.stderr);
            assert!(done.stderr.contains(part), "{method} {args:?}: {}", done.stderr);
        }
        let endless = format!("cat /dev/zero | \"$0\" {method} -o no {} --max-memory 8M -", flags.join(" "));
        let mut command = Command::new("sh");
        command.current_dir(folder.path()).args(["-c", &endless]).arg(program("glint-bake"));
        assert_eq!(finish(command, b"").code, 6, "{method}");
        assert!(!folder.path().join("no").exists());
    }
}

#[cfg(unix)]
#[test]
fn a_project_refuses_what_it_cannot_read_twice_and_builds_the_rest() {
    let folder = inputs();
    assert!(Command::new("mkfifo").arg(folder.path().join("pipe.png")).status().unwrap().success());
    let mut text = String::new();
    for (name, input) in [("pipe", "pipe.png"), ("zero", "/dev/zero"), ("stdin", "/dev/stdin"), ("sound", "flakes.png")]
    {
        text += &format!("[materials.{name}]\nmethod = 'ndf-maps'\npreset = 'draft'\ninput = '{input}'\n");
    }
    fs::write(folder.path().join("glint.toml"), text).unwrap();
    let done = run("glint-bake", folder.path(), &words(&["build"]), b"x");
    assert_eq!(done.code, 3, "{}", done.stderr);
    for part in [
        "pipe: pipe.png: cannot be read: is a pipe",
        "zero: /dev/zero: cannot be read: is a device",
        "stdin: /dev/stdin: cannot be read: is a pipe",
        "1 written, 3 failed",
    ] {
        assert!(done.stderr.contains(part), "{part}: {}", done.stderr);
    }
    // Nor does a plan, whose drafts read a map again and again.
    let scene =
        "[scene]\nlights = ['point']\n[materials.a]\ninput = 'pipe.png'\ndistance = [1, 2]\ntexels-per-metre = 9\n";
    fs::write(folder.path().join("glint.toml"), scene).unwrap();
    for command in ["plan", "build", "ninja"] {
        let done = run("glint-bake", folder.path(), &words(&[command]), b"");
        assert!(done.code == 3 && done.stderr.contains("is a pipe"), "{command}: {}", done.stderr);
    }
    // Standard input is nothing that a project has.
    fs::write(folder.path().join("glint.toml"), "[materials.a]\nmethod = 'lobes'\ninput = '-'\n").unwrap();
    let done = run("glint-bake", folder.path(), &words(&["build"]), b"");
    assert!(done.code == 2 && done.stderr.contains("./-"), "{}", done.stderr);
}

#[test]
fn standard_input_and_output_are_a_dash() {
    let folder = inputs();
    let at = |name: &str| folder.path().join(name);
    let map = fs::read(at("flakes.png")).unwrap();
    let flags = ["--preset", "draft", "--placement", "stochastic"];
    bake(folder.path(), &[&["ndf-maps", "flakes.png", "--name", "m", "-o", "m.glintpack"], &flags[..]].concat()).ok();
    let pack = fs::read(at("m.glintpack")).unwrap();
    let done = run(
        "glint-bake",
        folder.path(),
        &[words(&["ndf-maps", "flakes.png", "--name", "m", "-o", "-"]), words(&flags)].concat(),
        b"",
    );
    assert!(done.code == 0 && done.stdout == pack, "{}", done.stderr);
    assert!(done.stderr.contains("standard output: written"), "{}", done.stderr);

    // Every program reads a pack from a pipe.
    let of = |args: &[&str]| run(args[0], folder.path(), &words(&args[1..]), &pack);
    let told = of(&["glint-info", "-", "--verify"]);
    assert_eq!((told.code, told.stdout), (0, b"-: intact\n".to_vec()), "{}", told.stderr);
    assert_eq!(of(&["glint-info", "-", "--max-memory", "1K"]).code, 6);
    let section = of(&["glint-info", "-", "--extract", "PROV", "-o", "-"]);
    bake(folder.path(), &["preview", "m.glintpack", "-o", "m.png", "--size", "8x8"]).ok();
    assert!(section.code == 0 && !section.stdout.is_empty(), "{}", section.stderr);
    let picture = of(&["glint-bake", "preview", "-", "-o", "-", "--size", "8x8"]);
    assert!(picture.code == 0 && picture.stdout == fs::read(at("m.png")).unwrap(), "{}", picture.stderr);
    assert_eq!(of(&["glint-bake", "export", "-", "--to", "raw", "-o", "e"]).code, 0);
    assert!(at("e/stdin.json").is_file());

    // A file of that name is written ./-.
    fs::write(at("-"), &map).unwrap();
    bake(folder.path(), &["area-light", "./-", "-o", "./-.glintpack"]).ok();
    assert!(at("-.glintpack").is_file());
    for (args, part) in [
        (&["ndf-maps", "-", "-", "-o", "x"][..], "given twice"),
        (&["ndf-maps", "-", "/dev/stdin", "-o", "x"], "given twice"),
        (&["ndf-maps", "flakes.png", "-o", "-", "--json"], "--json"),
        (&["ndf-maps", "flakes.png", "-o", "x", "--report", "-"], "give --json"),
        (&["ndf-maps", "flakes.png", "-o", "x", "--depfile", "-"], "name a file"),
        (&["ndf-maps", "-", "-o", "x", "--depfile", "d"], "nothing can depend"),
        (&["export", "m.glintpack", "--to", "raw", "-o", "-"], "expected a folder"),
        (&["shaders", "--lang", "wgsl", "-o", "-"], "expected a folder"),
    ] {
        let done = run("glint-bake", folder.path(), &words(args), &map);
        assert!(done.code == 2 && done.stderr.contains(part), "{args:?}: {}", done.stderr);
    }
    assert!(!at("x").exists());
}

/// Folder of the real data; none, said, where it is missing.
pub fn cases() -> Option<PathBuf> {
    let folder = std::env::var_os("GLINT_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from)
        .join("cases");
    if !folder.is_dir() {
        eprintln!("skipped: no cases in {} (set GLINT_DATA)", folder.display());
        return None;
    }
    Some(folder)
}

#[test]
fn marks_in_text_files_are_no_text() {
    let folder = maps();
    let at = |name: &str| folder.path().join(name);
    fs::copy(at("flakes.png"), at("sound.png")).unwrap();
    if let Some(cases) = cases() {
        fs::copy(cases.join("bom.rsp"), at("bom.rsp")).unwrap();
        bake(folder.path(), &["@bom.rsp"]).ok();
        fs::remove_file(at("x.glintpack")).unwrap();
    }
    let utf16 = |text: &str| -> Vec<u8> { text.encode_utf16().flat_map(u16::to_le_bytes).collect() };
    let arguments = "ndf-maps sound.png -o x.glintpack --preset draft -q";
    for text in [
        format!("\u{feff}{arguments}"),
        format!("\u{feff}{}\r\n", arguments.replace(' ', "\r\n")),
        arguments.replace(' ', "\r"),
        format!("\u{feff}# a note\r\n{arguments}"),
        format!("# a note\r{arguments}"),
    ] {
        fs::write(at("a.rsp"), &text).unwrap();
        bake(folder.path(), &["@a.rsp"]).ok();
        fs::remove_file(at("x.glintpack")).unwrap();
    }
    let project = "output = 'packs'\n[materials.a]\nmethod = 'dictionary'\nlevels = 2\n";
    for text in [format!("\u{feff}{project}"), format!("\u{feff}{}", project.replace('\n', "\r\n"))] {
        fs::write(at("glint.toml"), text).unwrap();
        bake(folder.path(), &["build"]).ok();
        fs::remove_dir_all(at("packs")).unwrap();
    }
    for (bytes, part) in [
        (utf16("\u{feff}a"), "UTF-16"),
        (utf16("a b"), "UTF-16"),
        (b"\xfe\xff\0a".to_vec(), "UTF-16"),
        (b"na\xefve".to_vec(), "0xef"),
    ] {
        for (name, args) in [("a.rsp", &["@a.rsp"][..]), ("glint.toml", &["build"]), ("glint.toml", &["plan"])] {
            fs::write(at(name), &bytes).unwrap();
            let done = bake(folder.path(), args);
            assert_eq!(done.code, 4, "{name}: {}", done.stderr);
            assert!(
                done.stderr.contains(name) && done.stderr.contains(part) && done.stderr.contains("UTF-8"),
                "{}",
                done.stderr
            );
        }
    }
    #[cfg(unix)]
    for args in [&["@/dev/zero"][..], &["build", "/dev/zero"], &["build", "."]] {
        assert_eq!(bake(folder.path(), args).code, 3, "{args:?}");
    }
}

#[test]
fn long_response_files_and_projects_take_no_longer_a_word() {
    let folder = maps();
    let begin = Instant::now();
    let text = "flakes.png\r\n".repeat(100_000);
    fs::write(folder.path().join("a.rsp"), format!("ndf-maps --layers none:none -o x\n{text}")).unwrap();
    assert_eq!(bake(folder.path(), &["@a.rsp"]).code, 2);
    let tables: String = (0..3000).map(|k| format!("[materials.m{k}]\nmethod = 'none'\n")).collect();
    fs::write(folder.path().join("glint.toml"), tables).unwrap();
    let done = bake(folder.path(), &["build"]);
    assert!(done.code == 2 && done.stderr.contains("and 2900 more"), "{}", done.stderr.len());
    assert!(begin.elapsed() < Duration::from_secs(60), "{:?}", begin.elapsed());
}

#[test]
fn outputs_that_cannot_be_written_are_said_before_work() {
    let (folder, _) = packs();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("folder")).unwrap();
    fs::write(at("kept"), "kept").unwrap();
    let mut permissions = fs::metadata(at("kept")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(at("kept"), permissions).unwrap();
    let long = "n".repeat(300);
    let mut places = vec![
        ("folder", "it is a folder"),
        ("kept", "the file is read-only"),
        ("none/file", "does not exist; create it first"),
        ("flakes.png/file", "is no folder"),
        (&long, "cannot be written"),
    ];
    if Path::new("/proc/self").exists() {
        places.push(("/proc/file", "cannot be written"));
    }
    let commands: [(&str, &[&str]); 9] = [
        ("glint-bake", &["ndf-maps", "flakes.png", "-o"]),
        ("glint-bake", &["area-light", "flakes.png", "-o", "x", "--report"]),
        ("glint-bake", &["lobes", "flakes.png", "-o", "x", "--depfile"]),
        ("glint-bake", &["environment", "sky.hdr", "-o"]),
        (
            "glint-bake",
            &[
                "lobes",
                "worn.png",
                "--synthesize",
                "96x64",
                "--patch",
                "32",
                "--overlap",
                "4",
                "-o",
                "x",
                "--write-normal-map",
            ],
        ),
        ("glint-bake", &["dictionary", "-o"]),
        ("glint-bake", &["preview", "tiled.glintpack", "-o"]),
        ("glint-info", &["tiled.glintpack", "--extract", "PROV", "-o"]),
        ("glint-bake", &["build", "glint.toml", "--depfile"]),
    ];
    fs::write(at("glint.toml"), "output = 'built'\n[materials.a]\nmethod = 'dictionary'\nlevels = 2\n").unwrap();
    for (name, command) in commands {
        for (place, part) in &places {
            let done = run(name, folder.path(), &words(&[command, &[place]].concat()), b"");
            assert_eq!(done.code, 3, "{command:?} {place}: {}", done.stderr);
            assert!(done.stderr.contains(part), "{command:?} {place}: {}", done.stderr);
        }
    }
    assert!(!at("x").exists() && !at("built/a.glintpack").exists());
    assert_eq!(fs::read(at("kept")).unwrap(), b"kept");
    // Folders that are files, or lie in one.
    let folders: [&[&str]; 6] = [
        &["export", "tiled.glintpack", "--to", "raw", "-o"],
        &["demo", "-o"],
        &["report", "counting", "--quick", "-o"],
        &["generate", "man", "-o"],
        &["shaders", "--lang", "wgsl", "-o"],
        &["build", "-q"],
    ];
    for command in folders {
        for place in ["kept", "kept/in"] {
            let done = if command[0] == "build" {
                fs::write(at("glint.toml"), format!("output = '{place}'\n[materials.a]\nmethod = 'dictionary'\n"))
                    .unwrap();
                bake(folder.path(), command)
            } else {
                bake(folder.path(), &[command, &[place]].concat())
            };
            assert_eq!(done.code, 3, "{command:?} {place}: {}", done.stderr);
            assert!(done.stderr.contains("kept"), "{command:?}: {}", done.stderr);
        }
    }
}

#[test]
fn messages_say_what_to_do_next() {
    let (folder, names) = packs();
    for name in names {
        let done = bake(folder.path(), &["preview", name, "-o", "p.png", "--size", "4x4"]);
        let drawn = ["layered.glintpack", "tiled.glintpack", "clamped.glintpack"].contains(&name);
        if drawn {
            assert_eq!(done.code, 0, "{name}: {}", done.stderr);
        } else {
            let advice = format!("see it with glint-view {name}");
            assert!(done.code == 5 && done.stderr.contains(&advice), "{name}: {}", done.stderr);
        }
    }
    fs::write(folder.path().join("broken.glintpack"), b"no pack at all, and long enough to be one").unwrap();
    let done = bake(folder.path(), &["export", "broken.glintpack", "--to", "raw", "-o", "e"]);
    assert!(done.code == 4 && done.stderr.contains("glint-info --verify"), "{}", done.stderr);
    let done =
        bake(folder.path(), &["export", "dictionary.glintpack", "--to", "raw", "--section", "PROV", "-o", "e"]).ok();
    assert!(done.stderr.contains("parameters are in the JSON"), "{}", done.stderr);

    // A map that is too large for NDF maps: the method for it is named, and no light that is not there gets a pack.
    synthetic::scratches(256, 256, 1).save(folder.path().join("large.png")).unwrap();
    let scene = |lights: &str| {
        let text = format!(
            "[scene]\nlights = [{lights}]\nerror = 2\n[materials.large]\ninput = 'large.png'\ndistance = [20, 40]\n\
             texels-per-metre = 1000\n"
        );
        fs::write(folder.path().join("glint.toml"), text).unwrap();
        bake(folder.path(), &["plan"])
    };
    let done = scene("'point'");
    assert_eq!(done.code, 6, "{}", done.stderr);
    assert!(done.stderr.contains("method = \"lobes\"") && !done.stdout.contains("area-light"), "{}", done.stderr);
    let done = scene("'environment'").ok();
    assert!(!done.stdout.contains("large (area-light)"), "{}", done.stdout);
    for part in
        ["glints of large: the scene has no point", "area-light maps of large: the scene has no rectangle light"]
    {
        assert!(done.stdout.contains(part), "{}", done.stdout);
    }
    let done = scene("'point', 'rectangle'").ok();
    assert!(
        done.stdout.contains("large (area-light)") && done.stdout.contains("method = \"lobes\""),
        "{}",
        done.stdout
    );
    info(folder.path(), &["tiled.glintpack", "--verify"]).ok();
}
