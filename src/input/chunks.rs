//! Parts of PNG, JPEG and WebP files that their decoders do not show: what kind of picture it is, and what is written beside it.

/// Chunks of a PNG file, in order: kind and content. Ends where the file is damaged; the decoder says how.
pub(super) fn png(bytes: &[u8]) -> impl Iterator<Item = ([u8; 4], &[u8])> {
    let mut rest = bytes.get(8..).unwrap_or_default();
    std::iter::from_fn(move || {
        let length = u32::from_be_bytes(*rest.first_chunk()?) as usize;
        let kind = *rest.get(4..)?.first_chunk()?;
        let content = rest.get(8..8usize.checked_add(length)?)?;
        rest = rest.get(length + 12..).unwrap_or_default();
        Some((kind, content))
    })
}

/// Chunks of a WebP file, in order: kind and content.
pub(super) fn webp(bytes: &[u8]) -> impl Iterator<Item = ([u8; 4], &[u8])> {
    let mut rest = bytes.get(12..).unwrap_or_default();
    std::iter::from_fn(move || {
        let kind = *rest.first_chunk()?;
        let length = u32::from_le_bytes(*rest.get(4..)?.first_chunk()?) as usize;
        let content = rest.get(8..8usize.checked_add(length)?)?;
        // Contents of odd length are padded.
        rest = rest.get(8 + length + length % 2..).unwrap_or_default();
        Some((kind, content))
    })
}

/// The frame of a JPEG file.
#[derive(Clone, Copy)]
pub(super) struct JpegFrame {
    /// The low byte of its marker.
    pub kind: u8,
    /// Bits of a sample.
    pub bits: u8,
    /// Width and height.
    pub size: (u16, u16),
    pub channels: u8,
}

/// What the segments of a JPEG file say before its first scan.
#[derive(Default)]
pub(super) struct Jpeg {
    /// The frame.
    pub frame: Option<JpegFrame>,
    /// Whether the file goes on to an end marker; where it does not, decoders fill the missing rest with grey.
    pub has_end: bool,
}

impl Jpeg {
    pub fn of(bytes: &[u8]) -> Jpeg {
        const SCAN: u8 = 0xda;
        let mut jpeg = Jpeg::default();
        let mut at = 2;
        while at + 4 <= bytes.len() {
            if bytes[at] != 0xff {
                // Not a marker: the decoder says what is wrong.
                jpeg.has_end = true;
                break;
            }
            let marker = bytes[at + 1];
            if marker == 0xff {
                at += 1; // Fill byte.
                continue;
            }
            if marker == SCAN {
                jpeg.has_end = bytes[at..].windows(2).any(|w| w == [0xff, 0xd9]);
                break;
            }
            // Frames are C0 to CF but for tables (C4, CC) and a reserved one, and JPEG-LS's F7.
            if matches!(marker, 0xc0..=0xcf | 0xf7) && !matches!(marker, 0xc4 | 0xc8 | 0xcc) {
                let word = |s: &[u8], at: usize| u16::from_be_bytes([s[at], s[at + 1]]);
                jpeg.frame = bytes.get(at..at + 10).map(|s| JpegFrame {
                    kind: marker,
                    bits: s[4],
                    size: (word(s, 7), word(s, 5)),
                    channels: s[9],
                });
            }
            at += 2 + u16::from_be_bytes([bytes[at + 2], bytes[at + 3]]) as usize;
        }
        jpeg
    }
}
