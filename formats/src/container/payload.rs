//! One section's bytes: checksum first, then decompression that never makes more than the table says.

use super::entry::SectionEntry;
use super::section::Codec;
use crate::issue::{Issue, IssueCode};
use std::borrow::Cow;
use std::io::Read;
use xxhash_rust::xxh3::xxh3_64;

/// Largest window of a Zstandard frame, as a power of two: 128 MiB. It bounds the decoder's own memory.
const MAX_WINDOW_LOG: u32 = 27;
/// Memory for decompressed bytes grows from here, so that a false length in a small file costs little.
const FIRST_ALLOCATION: u64 = 1 << 20;

/// Payload of `entry` in `bytes`: borrowed when it is stored as it is.
pub(crate) fn read<'a>(bytes: &'a [u8], entry: &SectionEntry) -> Result<Cow<'a, [u8]>, Issue> {
    let fail = |code, message: String| Issue::error(code, message).at(entry.offset).of(entry.label());
    let stored = stored_bytes(bytes, entry)
        .ok_or_else(|| fail(IssueCode::SectionOutOfFile, String::from("the entry does not belong to this pack")))?;
    let found = xxh3_64(stored);
    if found != entry.checksum {
        let message = format!(
            "the table states {:016x}, the payload has {found:016x}; the file is damaged, get it again",
            entry.checksum
        );
        return Err(fail(IssueCode::SectionChecksum, message));
    }
    match entry.codec {
        Codec::None => Ok(Cow::Borrowed(stored)),
        Codec::Zstd => decompress(stored, entry.raw_len).map(Cow::Owned).map_err(|(code, message)| fail(code, message)),
    }
}

fn stored_bytes<'a>(bytes: &'a [u8], entry: &SectionEntry) -> Option<&'a [u8]> {
    let start = usize::try_from(entry.offset).ok()?;
    let len = usize::try_from(entry.stored_len).ok()?;
    bytes.get(start..start.checked_add(len)?)
}

fn decompress(stored: &[u8], raw_len: u64) -> Result<Vec<u8>, (IssueCode, String)> {
    let damaged = |error: std::io::Error| (IssueCode::BadCompression, format!("expected one Zstandard frame: {error}"));
    let mut decoder = zstd::Decoder::with_buffer(stored).map_err(damaged)?.single_frame();
    decoder.window_log_max(MAX_WINDOW_LOG).map_err(damaged)?;
    let mut out = Vec::with_capacity(raw_len.min(FIRST_ALLOCATION) as usize);
    // One byte more than stated tells a longer frame from one that fits.
    decoder.by_ref().take(raw_len.saturating_add(1)).read_to_end(&mut out).map_err(damaged)?;
    if out.len() as u64 != raw_len {
        let found = if out.len() as u64 > raw_len { String::from("more") } else { out.len().to_string() };
        return Err((
            IssueCode::DecompressedLength,
            format!("the table states {raw_len} bytes, the frame has {found}"),
        ));
    }
    let rest = decoder.finish().len();
    if rest != 0 {
        return Err((IssueCode::BadCompression, format!("expected one Zstandard frame, found {rest} bytes after it")));
    }
    Ok(out)
}
