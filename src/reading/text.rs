//! Text files as editors and shells of all systems write them: UTF-8, with or without a byte order mark.

use super::stream::{ReadError, read};
use crate::exit::{Exit, Failure};
use std::path::Path;

/// Most bytes of a text file.
pub const MOST_TEXT: u64 = 64 << 20;

/// The text of a file, without its byte order mark. `cannot` is what is said of a file that cannot be read.
///
/// # Errors
/// A file that cannot be read; bad input, when it is no UTF-8; limit exceeded, beyond [`MOST_TEXT`].
pub fn text(path: &Path, cannot: &str) -> Result<String, Failure> {
    let bytes = read(path, MOST_TEXT).map_err(|error| match error {
        ReadError::Io(error) => Failure::io(path, cannot, &error),
        ReadError::TooLarge(_) => Failure::new(
            Exit::LimitExceeded,
            format!("{}: expected text of at most {MOST_TEXT} bytes, found more", path.display()),
        ),
    })?;
    decode(bytes).map_err(|why| Failure::new(Exit::BadInput, format!("{}: {why}", path.display())))
}

/// UTF-8 without its mark; else what it is.
fn decode(mut bytes: Vec<u8>) -> Result<String, String> {
    if bytes.starts_with(b"\xef\xbb\xbf") {
        bytes.drain(..3);
    }
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err("the text is UTF-16, as PowerShell and Notepad may save it; save it as UTF-8".into());
    }
    let line = |at: usize| 1 + bytes[..at].iter().filter(|&&byte| byte == b'\n').count();
    if let Some(at) = bytes.iter().position(|&byte| byte == 0) {
        return Err(format!(
            "line {}: expected text, found a zero byte; if it is UTF-16 without a mark, save it as UTF-8",
            line(at)
        ));
    }
    if let Err(error) = std::str::from_utf8(&bytes) {
        let at = error.valid_up_to();
        return Err(format!("line {}: expected UTF-8, found the byte 0x{:02x}; save it as UTF-8", line(at), bytes[at]));
    }
    String::from_utf8(bytes).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_no_text_and_other_encodings_are_named() {
        assert_eq!(decode(b"\xef\xbb\xbfa = 1\r\n".to_vec()).unwrap(), "a = 1\r\n");
        assert_eq!(decode(b"a\xef\xbb\xbf".to_vec()).unwrap(), "a\u{feff}");
        assert_eq!(decode(Vec::new()).unwrap(), "");
        for (bytes, part) in [
            (&b"\xff\xfea\0"[..], "UTF-16"),
            (b"\xfe\xff\0a", "UTF-16"),
            (b"a\0b\0", "line 1: expected text, found a zero byte"),
            (b"a\nna\xefve", "line 2: expected UTF-8, found the byte 0xef"),
        ] {
            let why = decode(bytes.to_vec()).unwrap_err();
            assert!(why.contains(part), "{why}");
        }
    }
}
