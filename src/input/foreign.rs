//! Files of kinds that are not read, known by how they begin, so that the refusal can name them and say what to do.

/// What a file is, and what to do with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Kind {
    /// In words, after "the file is".
    pub name: &'static str,
    /// In words, as an instruction.
    pub advice: &'static str,
}

const CONVERT: &str = "convert it without changing its values";
const UNPACK: &str = "unpack it first";
const DECODE: &str = "convert what it was made of (block compression loses precision), or itself";
const EXPORT: &str = "export the map from it";
const DOWNLOAD: &str = "download the image itself";

/// How files begin, the longer ones before those that they begin with.
const MAGIC: &[(&[u8], &str, &str)] = &[
    (
        b"version https://git-lfs.github.com/spec/",
        "a Git LFS pointer, not the file that it stands for",
        "run git lfs pull",
    ),
    (b"\xabKTX 20\xbb\r\n\x1a\n", "KTX2", DECODE),
    (b"\xabKTX 11\xbb\r\n\x1a\n", "KTX", DECODE),
    (b"DDS ", "DDS", DECODE),
    (b"PVR\x03", "PVR", DECODE),
    (b"\x13\xab\xa1\x5c", "ASTC", DECODE),
    (b"VTF\0", "VTF", DECODE),
    (b"BLP2", "BLP", DECODE),
    (b"\0\0\0\x0cjP  \r\n\x87\n", "JPEG 2000", CONVERT),
    (b"\xff\x4f\xff\x51", "JPEG 2000", CONVERT),
    (b"\0\0\0\x0cJXL \r\n\x87\n", "JPEG XL", CONVERT),
    (b"\xff\x0a", "JPEG XL", CONVERT),
    (b"II\xbc\x01", "JPEG XR", CONVERT),
    (b"GIF8", "GIF", CONVERT),
    (b"8BPS", "a Photoshop document", EXPORT),
    (b"gimp xcf", "a GIMP document", EXPORT),
    (b"BLENDER", "a Blender document", EXPORT),
    (b"RIFX", "big-endian RIFF", CONVERT),
    (b"qoif", "QOI", CONVERT),
    (b"farbfeld", "farbfeld", CONVERT),
    (b"SDPX", "DPX", CONVERT),
    (b"XPDS", "DPX", CONVERT),
    (b"\x80\x2a\x5f\xd7", "Cineon", CONVERT),
    (b"SIMPLE  =", "FITS", CONVERT),
    (b"PF\n", "PFM", CONVERT),
    (b"Pf\n", "PFM", CONVERT),
    (b"\x01\xda", "SGI RGB", CONVERT),
    (b"\x59\xa6\x6a\x95", "Sun raster", CONVERT),
    (b"\x8aMNG\r\n\x1a\n", "MNG", CONVERT),
    (b"\0\0\x01\0", "an icon", CONVERT),
    (b"\x93NUMPY", "a NumPy array", "write it as TIFF or EXR"),
    (b"%PDF", "PDF", EXPORT),
    (b"\x1f\x8b", "compressed by gzip", UNPACK),
    (b"PK\x03\x04", "a ZIP archive, or a document that is one", UNPACK),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive", UNPACK),
    (b"Rar!\x1a\x07", "a RAR archive", UNPACK),
    (b"\xfd7zXZ\0", "compressed by xz", UNPACK),
    (b"BZh", "compressed by bzip2", UNPACK),
    (b"\x28\xb5\x2f\xfd", "compressed by Zstandard", UNPACK),
    (b"glTF", "a glTF mesh", "give its image of normals"),
    (b"\xabGLINTP\xbb", "a pack of this program", "give the map that it was baked of"),
];

/// The kind of a file that is not read; `None` for what is unknown, text that is nothing else included.
pub(super) fn kind_of(bytes: &[u8]) -> Option<Kind> {
    let kind = |name, advice| Some(Kind { name, advice });
    if let Some(&(_, name, advice)) = MAGIC.iter().find(|(magic, ..)| bytes.starts_with(magic)) {
        return kind(name, advice);
    }
    match bytes {
        // Both bytes of BM are letters that text may begin with: the file's size or zeros follow, and its reserved words.
        [b'B', b'M', _, _, _, _, 0, 0, 0, 0, ..] => return kind("BMP", CONVERT),
        [b'P', b'1'..=b'6', b'\n' | b'\r' | b' ' | b'\t', ..] => return kind("PNM", CONVERT),
        [0x0a, 0 | 2..=5, 0 | 1, 1 | 2 | 4 | 8, ..] => return kind("PCX", CONVERT),
        [_, _, _, _, b'f', b't', b'y', b'p', b'a', b'v', b'i', b'f' | b's', ..] => return kind("AVIF", CONVERT),
        [_, _, _, _, b'f', b't', b'y', b'p', b'h' | b'm', b'e' | b'i', b'i' | b'v' | b'f', ..] => {
            return kind("HEIF", CONVERT);
        }
        [_, _, _, _, b'f', b't', b'y', b'p', ..] => return kind("a film", EXPORT),
        _ => {}
    }
    let text = markup(bytes)?;
    if text.starts_with("<!doctype html") || text.starts_with("<html") {
        return kind("a web page", DOWNLOAD);
    }
    if text.contains("<svg") {
        return kind("SVG", "draw it as an image");
    }
    text.starts_with("<?xml").then_some(Kind { name: "XML", advice: DOWNLOAD })
}

/// The beginning of a file of markup in small letters.
fn markup(bytes: &[u8]) -> Option<String> {
    /// Comments and declarations may come before what names the kind.
    const FAR_ENOUGH: usize = 1024;
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    bytes.starts_with(b"<").then(|| String::from_utf8_lossy(&bytes[..bytes.len().min(FAR_ENOUGH)]).to_ascii_lowercase())
}

/// How an unknown file begins, as far as it is printable.
pub(super) fn beginning(bytes: &[u8]) -> String {
    if bytes.iter().all(|&b| b == 0) {
        return format!("{} bytes that are all 0: the file was never filled", bytes.len());
    }
    let what = match std::str::from_utf8(bytes) {
        Ok(text) if text.chars().all(|c| !c.is_control() || c.is_whitespace()) => "text",
        _ => "bytes",
    };
    format!("{what} starting with \"{}\"", bytes[..bytes.len().min(12)].escape_ascii())
}
