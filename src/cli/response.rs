//! Response files: `@args.rsp` stands for the arguments in that file, so that build tools need no long command lines.
//!
//! Arguments are separated by white space; double or single quotes keep it. A backslash is a plain character, since
//! it separates folders on Windows. A `#` at the start of an argument begins a comment up to the line's end.

use crate::exit::Failure;
use crate::reading;
use std::ffi::OsString;
use std::path::Path;

/// The arguments with every `@FILE` replaced. Files name no further files. The program's name is left alone.
pub fn expand(args: impl Iterator<Item = OsString>) -> Result<Vec<OsString>, Failure> {
    let mut out = Vec::new();
    for (i, arg) in args.enumerate() {
        match arg.to_str().and_then(|text| text.strip_prefix('@')) {
            Some(path) if i > 0 && !path.is_empty() => out.extend(read(Path::new(path))?),
            _ => out.push(arg),
        }
    }
    Ok(out)
}

fn read(path: &Path) -> Result<Vec<OsString>, Failure> {
    let cannot = "the response file cannot be read (write ./@name for a file whose name starts with @)";
    let text = reading::text(path, cannot)?;
    let words = split(&text).map_err(|why| Failure::usage(format!("{}: {why}", path.display())))?;
    match words.iter().find(|word| word.starts_with('@')) {
        Some(nested) => Err(Failure::usage(format!(
            "{}: found {nested}, but a response file names no further ones; put their arguments in this file",
            path.display()
        ))),
        None => Ok(words.into_iter().map(OsString::from).collect()),
    }
}

/// Lines of any system: they end with CR LF, LF or CR.
fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.lines().flat_map(|line| line.split('\r'))
}

fn split(text: &str) -> Result<Vec<String>, String> {
    let mut words = Vec::new();
    for (number, line) in lines(text).enumerate() {
        let mut word: Option<String> = None;
        let mut quote: Option<char> = None;
        for c in line.chars() {
            match quote {
                Some(open) if c == open => quote = None,
                Some(_) => word.get_or_insert_default().push(c),
                None if c == '"' || c == '\'' => {
                    word.get_or_insert_default();
                    quote = Some(c);
                }
                None if c.is_whitespace() => words.extend(word.take()),
                None if c == '#' && word.is_none() => break,
                None => word.get_or_insert_default().push(c),
            }
        }
        if let Some(open) = quote {
            return Err(format!("line {}: expected a closing {open}, found the line's end", number + 1));
        }
        words.extend(word);
    }
    Ok(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_quotes_and_comments() {
        let words =
            split("ndf-maps 'a b.png'\n# a comment\n  -o \"out dir\\x.glintpack\" # another\n--name \"\" c#d\n");
        assert_eq!(words.unwrap(), ["ndf-maps", "a b.png", "-o", "out dir\\x.glintpack", "--name", "", "c#d"]);
    }

    #[test]
    fn an_open_quote_is_named_with_its_line() {
        assert_eq!(split("a\n\"b").unwrap_err(), "line 2: expected a closing \", found the line's end");
    }
}
