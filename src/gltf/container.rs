//! A glTF file as its JSON and, in GLB, its binary chunk (specification, section 4.4). What is not looked at is written as it was
//! read.

use super::fault::Fault;

const MAGIC: &[u8; 4] = b"glTF";
const JSON: [u8; 4] = *b"JSON";
const BINARY: [u8; 4] = *b"BIN\0";
const MARK: &[u8] = b"\xef\xbb\xbf";

/// Which of the two files it is.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Form {
    /// Chunks; those after the binary one, as they are.
    Glb { rest: Vec<u8> },
    /// Text, with a byte order mark or without.
    Gltf { mark: bool },
}

/// A file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Container {
    form: Form,
    /// The JSON.
    pub text: String,
    /// The binary chunk with its padding.
    pub binary: Option<Vec<u8>>,
}

impl Container {
    /// The parts of a file.
    ///
    /// # Errors
    /// Bad, where a chunk does not fit or text is no UTF-8; unsupported, for another version of GLB.
    pub fn read(bytes: &[u8]) -> Result<Container, Fault> {
        if !bytes.starts_with(MAGIC) {
            let rest = bytes.strip_prefix(MARK);
            let text = text_of(rest.unwrap_or(bytes))?;
            return Ok(Container { form: Form::Gltf { mark: rest.is_some() }, text, binary: None });
        }
        let version = word(bytes, 4)?;
        if version != 2 {
            return Err(Fault::unsupported(format!("it is GLB version {version}; export it as version 2")));
        }
        let length = word(bytes, 8)? as usize;
        let Some(bytes) = bytes.get(..length) else {
            let found = bytes.len();
            return Err(Fault::bad(format!("it has {found} bytes where its header says {length}; export it anew")));
        };
        let (kind, json, mut next) = chunk(bytes, 12)?;
        if kind != JSON {
            return Err(Fault::bad("its first chunk is not JSON; export it anew"));
        }
        let mut binary = None;
        if next < bytes.len() {
            let (kind, data, after) = chunk(bytes, next)?;
            if kind == BINARY {
                binary = Some(data.to_vec());
                next = after;
            }
        }
        Ok(Container { form: Form::Glb { rest: bytes[next..].to_vec() }, text: text_of(json)?, binary })
    }

    /// The same kind of file with another JSON and another binary chunk.
    pub fn with(&self, text: String, binary: Option<Vec<u8>>) -> Container {
        Container { form: self.form.clone(), text, binary }
    }

    /// Whether it is a GLB.
    pub fn is_glb(&self) -> bool {
        matches!(self.form, Form::Glb { .. })
    }

    /// The file.
    ///
    /// # Errors
    /// Limit, for a GLB of 4 GiB and more, whose length its header can't say.
    pub fn write(&self) -> Result<Vec<u8>, Fault> {
        let rest = match &self.form {
            Form::Gltf { mark } => {
                let mark = if *mark { MARK } else { b"" };
                return Ok([mark, self.text.as_bytes()].concat());
            }
            Form::Glb { rest } => rest,
        };
        let mut out = [MAGIC.as_slice(), &2u32.to_le_bytes(), &[0; 4]].concat();
        add(&mut out, JSON, self.text.trim_end_matches(' ').as_bytes(), b' ')?;
        if let Some(binary) = &self.binary {
            add(&mut out, BINARY, binary, 0)?;
        }
        out.extend(rest);
        let length = length_of(out.len())?;
        out[8..12].copy_from_slice(&length);
        Ok(out)
    }
}

/// Adds a chunk, padded to four bytes.
fn add(out: &mut Vec<u8>, kind: [u8; 4], data: &[u8], padding: u8) -> Result<(), Fault> {
    let padded = data.len().next_multiple_of(4);
    out.extend(length_of(padded)?);
    out.extend(kind);
    out.extend(data);
    out.resize(out.len() + padded - data.len(), padding);
    Ok(())
}

fn length_of(bytes: usize) -> Result<[u8; 4], Fault> {
    let too_long =
        |_| Fault::limit(format!("{bytes} bytes do not fit a GLB, 4 GiB are the limit; use .gltf, or --zstd"));
    u32::try_from(bytes).map(u32::to_le_bytes).map_err(too_long)
}

fn word(bytes: &[u8], at: usize) -> Result<u32, Fault> {
    let four = bytes.get(at..at + 4).and_then(|four| four.try_into().ok());
    four.map(u32::from_le_bytes).ok_or_else(|| Fault::bad(format!("it ends at byte {}; export it anew", bytes.len())))
}

/// Kind and bytes of the chunk at a byte, and the byte after it.
fn chunk(bytes: &[u8], at: usize) -> Result<([u8; 4], &[u8], usize), Fault> {
    let (size, kind) = (word(bytes, at)? as usize, word(bytes, at + 4)?);
    let data = bytes[at + 8..].get(..size);
    let data = data.ok_or_else(|| Fault::bad(format!("its chunk at byte {at} ends after the file; export it anew")))?;
    Ok((kind.to_le_bytes(), data, at + 8 + size))
}

fn text_of(bytes: &[u8]) -> Result<String, Fault> {
    let fault = |error: std::str::Utf8Error| {
        Fault::bad(format!("its JSON is no UTF-8 at byte {}; export it anew", error.valid_up_to()))
    };
    std::str::from_utf8(bytes).map(str::to_owned).map_err(fault)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut out = [MAGIC.as_slice(), &2u32.to_le_bytes(), &[0; 4]].concat();
        for (kind, data) in chunks {
            out.extend((data.len() as u32).to_le_bytes());
            out.extend(*kind);
            out.extend(*data);
        }
        let length = out.len() as u32;
        out[8..12].copy_from_slice(&length.to_le_bytes());
        out
    }

    #[test]
    fn files_are_written_as_they_were_read() {
        let whole = glb(&[(b"JSON", b"{\"a\":[1.0]} "), (b"BIN\0", &[1, 2, 3, 4]), (b"OWN\0", &[9; 8])]);
        for bytes in
            [whole.as_slice(), &glb(&[(b"JSON", b"{}  "), (b"OWN\0", b"none")]), b"\xef\xbb\xbf{\r\n}", b"{ }\n"]
        {
            assert_eq!(Container::read(bytes).unwrap().write().unwrap(), bytes);
        }
        let read = Container::read(&whole).unwrap();
        assert_eq!((read.text.as_str(), read.binary.as_deref()), ("{\"a\":[1.0]} ", Some(&[1, 2, 3, 4][..])));
        // No cut and no other length than the header's makes a panic.
        for cut in 0..whole.len() {
            let _ = Container::read(&whole[..cut]);
            let mut damaged = whole.clone();
            damaged[cut] ^= 0xff;
            let _ = Container::read(&damaged);
        }
    }
}
