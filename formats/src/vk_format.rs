//! The texture formats packs use, by their `VkFormat` number.

macro_rules! formats {
    ($($name:ident = $code:literal, $bytes:literal;)*) => {
        $(
            #[doc = concat!("`VK_FORMAT_", stringify!($name), "`, ", stringify!($bytes), " bytes a texel.")]
            pub const $name: u32 = $code;
        )*

        /// Code, name and bytes of a texel of every format above.
        const TABLE: &[(u32, &str, u32)] = &[$(($code, stringify!($name), $bytes),)*];
    };
}

formats! {
    R8_UNORM = 9, 1;
    R8_SNORM = 10, 1;
    R8_UINT = 13, 1;
    R8G8_UNORM = 16, 2;
    R8G8_SNORM = 17, 2;
    R8G8B8A8_UNORM = 37, 4;
    R8G8B8A8_SNORM = 38, 4;
    R8G8B8A8_UINT = 41, 4;
    R16_UNORM = 70, 2;
    R16_SNORM = 71, 2;
    R16_UINT = 74, 2;
    R16_SFLOAT = 76, 2;
    R16G16_UNORM = 77, 4;
    R16G16_SNORM = 78, 4;
    R16G16_UINT = 81, 4;
    R16G16_SFLOAT = 83, 4;
    R16G16B16A16_UNORM = 91, 8;
    R16G16B16A16_SNORM = 92, 8;
    R16G16B16A16_UINT = 95, 8;
    R16G16B16A16_SFLOAT = 97, 8;
    R32_UINT = 98, 4;
    R32_SFLOAT = 100, 4;
    R32G32_UINT = 101, 8;
    R32G32_SFLOAT = 103, 8;
    R32G32B32A32_UINT = 107, 16;
    R32G32B32A32_SFLOAT = 109, 16;
    B10G11R11_UFLOAT_PACK32 = 122, 4;
    E5B9G9R9_UFLOAT_PACK32 = 123, 4;
}

/// Bytes of one texel; `None` for a format packs of this version do not use.
pub fn texel_bytes(code: u32) -> Option<u32> {
    TABLE.iter().find(|row| row.0 == code).map(|row| row.2)
}

/// Name without the `VK_FORMAT_` in front; `None` for a format packs of this version do not use.
pub fn name(code: u32) -> Option<&'static str> {
    TABLE.iter().find(|row| row.0 == code).map(|row| row.1)
}
