//! The headers of an EXR file: first as they lie there, so that what the library hides or cannot take is named, then as the
//! library reads them.

use super::fault::Fault;
use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::MetaData;
use std::io::Cursor;

/// Compressions by the number that stands in a header.
const COMPRESSIONS: [&str; 14] = [
    "none", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB", "HTJ2K256", "HTJ2K32", "LJ2K", "ZSTD",
];
/// Numbers from here on are not known to the library.
const FIRST_UNKNOWN_COMPRESSION: usize = 12;
/// Flags of the version field.
const DEEP: u32 = 1 << 11;
const MULTI_PART: u32 = 1 << 12;
const KNOWN_FLAGS: u32 = (1 << 9) | (1 << 10) | DEEP | MULTI_PART;
/// Longest names of attributes and of their types.
const MAX_NAME: usize = 255;
/// Coordinates that the format allows.
const MAX_COORDINATE: i32 = i32::MAX / 2;

/// An EXR file whose headers are sound.
pub(super) struct File<'a> {
    pub bytes: &'a [u8],
    pub meta: MetaData,
    /// Where the offset tables of all parts begin.
    pub tables_at: usize,
}

impl<'a> File<'a> {
    /// Reads all headers.
    pub fn open(bytes: &'a [u8]) -> Result<File<'a>, Fault> {
        let tables_at = scan(bytes)?;
        let headers = "its header";
        let meta = MetaData::read_from_buffered(Cursor::new(bytes), false)
            .map_err(|error| Fault::from_library(error, headers))?;
        for channel in meta.headers.iter().flat_map(|header| &header.channels.list) {
            if channel.sampling != Vec2(1, 1) {
                let Vec2(x, y) = channel.sampling;
                let chroma = ["RY", "BY"].contains(&channel.name.to_string().as_str());
                let what = if chroma { " (luminance and chroma: Y, RY, BY)" } else { "" };
                return Err(Fault::Unsupported(format!(
                    "channel {} is subsampled {x} × {y}{what}; expected one value a texel: export it as RGB",
                    channel.name
                )));
            }
        }
        MetaData::validate(&meta.headers, false).map_err(|error| Fault::from_library(error, headers))?;
        Ok(File { bytes, meta, tables_at })
    }

    /// The codec of a part that lost precision.
    pub fn lossy(&self, part: usize) -> Option<&'static str> {
        match self.meta.headers[part].compression {
            Compression::B44 => Some("EXR B44"),
            Compression::B44A => Some("EXR B44A"),
            Compression::DWAA(_) => Some("EXR DWAA"),
            Compression::DWAB(_) => Some("EXR DWAB"),
            _ => None,
        }
    }
}

/// Bytes from a place on.
pub(super) struct Bytes<'a> {
    bytes: &'a [u8],
    pub at: usize,
}

impl<'a> Bytes<'a> {
    pub fn new(bytes: &'a [u8], at: usize) -> Bytes<'a> {
        Bytes { bytes, at }
    }

    pub fn take(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        let end = self.at.checked_add(count).ok_or_else(Fault::cut_off)?;
        let taken = self.bytes.get(self.at..end).ok_or_else(Fault::cut_off)?;
        self.at = end;
        Ok(taken)
    }

    pub fn int(&mut self) -> Result<i32, Fault> {
        Ok(i32::from_le_bytes(self.take(4)?.try_into().map_err(|_| Fault::cut_off())?))
    }

    /// A whole number that is no negative one.
    pub fn count(&mut self, what: &str) -> Result<usize, Fault> {
        let (at, value) = (self.at, self.int()?);
        usize::try_from(value).map_err(|_| Fault::damaged(format_args!("{what} is {value} (byte {at})")))
    }

    /// A name that ends with a zero byte; empty at the end of a list.
    fn name(&mut self) -> Result<&'a str, Fault> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let end = rest.iter().take(MAX_NAME + 1).position(|byte| *byte == 0);
        let at = self.at;
        let Some(end) = end else {
            let short = rest.len() <= MAX_NAME;
            return Err(if short {
                Fault::cut_off()
            } else {
                Fault::damaged(format_args!("a name without end (byte {at})"))
            });
        };
        self.at += end + 1;
        std::str::from_utf8(&rest[..end])
            .map_err(|_| Fault::damaged(format_args!("the name of an attribute is no text (byte {at})")))
    }
}

/// Walks all headers; gives where they end.
fn scan(bytes: &[u8]) -> Result<usize, Fault> {
    let mut bytes = Bytes::new(bytes, 4);
    let version = bytes.int()? as u32;
    let number = version & 0xff;
    if number != 2 {
        return Err(Fault::Unsupported(format!("version {number} of the format; expected version 2: export it again")));
    }
    if version & !0xff & !KNOWN_FLAGS != 0 {
        return Err(Fault::Unsupported(format!(
            "the file needs features that are not read (flags {:#x}); export it as flat scan lines with ZIP compression",
            version & !0xff
        )));
    }
    if version & DEEP != 0 {
        return Err(deep());
    }
    loop {
        let mut attributes = 0;
        loop {
            let name = bytes.name()?;
            if name.is_empty() {
                break;
            }
            attributes += 1;
            let kind = bytes.name()?;
            let size = bytes.count("the size of an attribute")?;
            check(name, kind, bytes.take(size)?)?;
        }
        // The headers of several parts end with an empty one.
        if version & MULTI_PART == 0 || attributes == 0 {
            return Ok(bytes.at);
        }
    }
}

fn deep() -> Fault {
    Fault::Unsupported("deep data (several samples a pixel) are not read; flatten the image and export it again".into())
}

/// Looks at attributes that the library reads wrongly, or whose errors it hides.
fn check(name: &str, kind: &str, value: &[u8]) -> Result<(), Fault> {
    let mut bytes = Bytes::new(value, 0);
    match (name, kind) {
        ("compression", "compression") => match value.first().map(|number| usize::from(*number)) {
            Some(number) if number >= FIRST_UNKNOWN_COMPRESSION => {
                let name = COMPRESSIONS.get(number).copied().unwrap_or("unknown");
                Err(Fault::Unsupported(format!(
                    "compression {number} ({name}) is not read; expected one of {}: export it with ZIP compression",
                    COMPRESSIONS[..10].join(", ")
                )))
            }
            Some(_) => Ok(()),
            None => Err(Fault::damaged("its compression is empty")),
        },
        ("type", "string") => match value {
            b"scanlineimage" | b"tiledimage" => Ok(()),
            b"deepscanline" | b"deeptile" => Err(deep()),
            other => Err(Fault::Unsupported(format!(
                "a part of type \"{}\" is not read; expected scanlineimage or tiledimage",
                other.escape_ascii()
            ))),
        },
        ("dataWindow" | "displayWindow", "box2i") => {
            let [left, top, right, bottom] = [bytes.int()?, bytes.int()?, bytes.int()?, bytes.int()?];
            let far = [left, top, right, bottom].iter().any(|c| !(-MAX_COORDINATE..MAX_COORDINATE).contains(c));
            if left > right || top > bottom || far {
                return Err(Fault::damaged(format_args!("its {name} is ({left}, {top}) to ({right}, {bottom})")));
            }
            Ok(())
        }
        ("tiles", "tiledesc") => {
            let (width, height) = (bytes.int()?, bytes.int()?);
            if !(1..MAX_COORDINATE).contains(&width) || !(1..MAX_COORDINATE).contains(&height) {
                return Err(Fault::damaged(format_args!("its tiles are {width} × {height}")));
            }
            Ok(())
        }
        _ => Ok(()),
    }
}
