//! How a host binds the sections of a method: what `docs/FORMAT.md` has as the table *Bindings* of the method, as data.
//!
//! A bind group takes sections as they are. Binding k of the group is row k of the method's `BINDINGS`.

use crate::container::FourCc;

/// One entry of a method's bind group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// A uniform buffer of the section's bytes.
    Uniform(FourCc),
    /// A read-only storage buffer of the section's bytes.
    Storage(FourCc),
    /// A texture of the section's bytes.
    Texture(FourCc, View),
    /// A sampler, linear within and between mips, that goes on beyond the edge as the map does: see the method's `Wrap`.
    MapSampler,
    /// A sampler, linear within and between mips, that clamps.
    ClampSampler,
}

/// How shaders see a texture, and what is bound where a pack has no such section: one texel, or one cube, of zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// `texture_2d<f32>`, read through a sampler or by loads.
    Float2d,
    /// `texture_2d_array<f32>`, read by loads: a cube's faces are layers, face by face of the first layer, then of the next.
    Float2dArray,
    /// `texture_2d<u32>`, read by loads.
    Uint2d,
    /// `texture_cube<f32>`, read through a sampler.
    FloatCube,
    /// `texture_cube_array<f32>`, read through a sampler.
    FloatCubeArray,
}

impl Binding {
    /// The section that is bound; none for samplers.
    pub fn section(self) -> Option<FourCc> {
        match self {
            Binding::Uniform(kind) | Binding::Storage(kind) | Binding::Texture(kind, _) => Some(kind),
            Binding::MapSampler | Binding::ClampSampler => None,
        }
    }
}

/// Bytes that buffers which are bound are a multiple of, so that every host binds them whole.
pub const BUFFER_GRANULARITY: usize = 16;
/// Columns of a table that is stored as a texture of one or four 32-bit numbers: element i is at column i mod 1024 of row
/// i / 1024, and the last row ends with zeros.
pub const TABLE_WIDTH: u32 = 1024;
/// Bytes of a storage buffer that every GPU binds, at most.
pub const MAX_BINDING_BYTES: u64 = 128 << 20;
