//! Dependency files in Make's syntax: `target: input input`.
//!
//! Make and ninja read them by rules that are not the same, and neither can read every name. A name is written when GNU
//! Make 4.3 and ninja 1.11 both read it back, and refused otherwise: a name that is read as another one would make a build
//! run again every time, or not at all. Tests hold the rules against both programs.

use crate::exit::Failure;
use std::path::Path;

/// A rule: `target` depends on `inputs`.
///
/// # Errors
/// Usage, for a path that the syntax cannot express; the first such path and what is in it.
pub fn rule(target: &Path, inputs: &[&Path]) -> Result<String, Failure> {
    let mut text = written(target, true)?;
    text.push(':');
    for input in inputs {
        text.push_str(" \\\n  ");
        text.push_str(&written(input, false)?);
    }
    text.push('\n');
    Ok(text)
}

/// A path as it is written.
fn written(path: &Path, is_target: bool) -> Result<String, Failure> {
    let refuse = |what: String| {
        Failure::usage(format!("--depfile: {path:?} has {what}, which Make or ninja cannot read; rename it"))
    };
    let text = path.to_str().ok_or_else(|| refuse("bytes that are no UTF-8".into()))?;
    match fault(text, is_target) {
        Some(what) => Err(refuse(what)),
        None => Ok(escape(text)),
    }
}

/// What in a path cannot be written.
fn fault(text: &str, is_target: bool) -> Option<String> {
    let drive = |at: usize| cfg!(windows) && at == 1;
    let foreign = |&(at, c): &(usize, char)| {
        c.is_ascii_control() || "\"&'*;<=>?^`|".contains(c) || (c == ':' && !drive(at)) || (c == '%' && is_target)
    };
    if let Some((_, c)) = text.char_indices().find(foreign) {
        return Some(format!("the character {c:?}"));
    }
    if text.starts_with('~') {
        return Some("a ~ at its start".into());
    }
    // To Make, `a(b` and a later `c)` are members of an archive.
    if text.ends_with([' ', '\\', ')']) {
        return Some("a space, a backslash or a parenthesis at its end".into());
    }
    let joined = ["\\#", "\\$"].into_iter().find(|pair| text.contains(pair));
    joined.map(|pair| format!("the characters {pair}"))
}

/// `$` doubles; spaces, `#` and the backslashes before a space take a backslash.
fn escape(text: &str) -> String {
    let mut out = String::new();
    let mut backslashes = 0;
    for c in text.chars() {
        match c {
            '$' => out.push('$'),
            ' ' => out.push_str(&"\\".repeat(backslashes + 1)),
            '#' => out.push('\\'),
            _ => {}
        }
        backslashes = if c == '\\' { backslashes + 1 } else { 0 };
        out.push(c);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_make_would_misread_is_escaped() {
        let text = rule(Path::new("out dir/a.glintpack"), &[Path::new("cost$.png"), Path::new("b#1\\ 2.png")]).unwrap();
        assert_eq!(text, "out\\ dir/a.glintpack: \\\n  cost$$.png \\\n  b\\#1\\\\\\ 2.png\n");
    }

    #[test]
    fn what_it_cannot_express_is_refused_by_name() {
        for (name, part) in [
            ("a;b", "';'"),
            ("a:b", "':'"),
            ("a|b", "'|'"),
            ("a\tb", "'\\t'"),
            ("a\nb", "'\\n'"),
            ("a`b", "'`'"),
            ("~/a", "a ~ at its start"),
            ("a\\", "backslash or a parenthesis at its end"),
            ("a\\#b", "\\#"),
            ("a(b)", "parenthesis at its end"),
        ] {
            let failure = rule(Path::new("out"), &[Path::new(name)]).unwrap_err();
            assert!(failure.message.contains(part), "{name}: {failure:?}");
        }
        assert!(rule(Path::new("a%b"), &[Path::new("in")]).is_err());
        assert!(rule(Path::new("out"), &[Path::new("a%b")]).is_ok());
    }
}
