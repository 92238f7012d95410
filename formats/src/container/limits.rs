//! Caps that a reader sets on what a file may ask of it.

/// Caps that a reader sets on what a file may ask of it. They are checked before anything is allocated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest file that is read.
    pub max_file_bytes: u64,
    /// Most sections in a file.
    pub max_sections: u32,
    /// Most bytes that all sections may have together once they are decompressed.
    pub max_raw_bytes: u64,
}

impl Default for Limits {
    /// 4 GiB of file, 65536 sections, 4 GiB decompressed.
    fn default() -> Self {
        Limits { max_file_bytes: 4 << 30, max_sections: 65536, max_raw_bytes: 4 << 30 }
    }
}
