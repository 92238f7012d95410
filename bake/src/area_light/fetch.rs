//! Reading the packed mip chain at run time, as a sampler with linear filtering within and between mips does. f32, plain
//! functions, as in WGSL.

use super::eval::Roughness;
use super::material::AreaLightMaterial;
use super::spread;
use crate::wrap::{filtered_texels, wrapped};
use glam::{IVec2, Vec2, Vec3, Vec4};
use glint_formats::Wrap;
use glint_formats::area_light::NormalStorage;
use glint_formats::container::full_mip_count;

/// Most mips of a map.
const MAX_MIPS: usize = 15;

/// The textures of a material.
#[derive(Clone, Copy, Debug)]
pub struct Maps<'a> {
    width: u32,
    height: u32,
    mips: u32,
    wrap: Wrap,
    storage: NormalStorage,
    /// First texel of each mip.
    first: [usize; MAX_MIPS],
    normals: &'a [u8],
    roughness: &'a [u8],
}

/// What lies under a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Mean normal, unit.
    pub normal: Vec3,
    /// Length of the mean normal before it was made a unit vector.
    pub length: f32,
    /// Meso roughness α, the same in all directions.
    pub alpha: f32,
    /// Meso roughness by direction; `alpha` in all directions where the material is isotropic.
    pub by_direction: Roughness,
}

impl<'a> Maps<'a> {
    /// The textures of a material that passed verification.
    pub fn new(material: &'a AreaLightMaterial) -> Maps<'a> {
        let params = &material.params;
        let mips = full_mip_count(params.width, params.height).min(MAX_MIPS as u32);
        let mut first = [0; MAX_MIPS];
        for mip in 1..mips {
            let (width, height) = ((params.width >> (mip - 1)).max(1), (params.height >> (mip - 1)).max(1));
            first[mip as usize] = first[mip as usize - 1] + width as usize * height as usize;
        }
        Maps {
            width: params.width,
            height: params.height,
            mips,
            wrap: params.wrap,
            storage: params.storage,
            first,
            normals: &material.normals,
            roughness: &material.roughness,
        }
    }

    /// Columns and rows of the first mip that is there, over those of a map of `width` × `height` texels.
    pub fn scale(&self, width: u32, height: u32) -> Vec2 {
        Vec2::new(self.width as f32 / width as f32, self.height as f32 / height as f32)
    }

    /// Whether there is roughness by direction.
    pub fn is_anisotropic(&self) -> bool {
        !self.roughness.is_empty()
    }
}

/// Texel of a mip from the bytes of its texture.
fn texel(maps: &Maps<'_>, bytes: &[u8], mip: u32, i: i32, j: i32) -> Vec4 {
    let (width, height) = ((maps.width >> mip).max(1) as i32, (maps.height >> mip).max(1) as i32);
    let (i, j) = (wrapped(i, width, maps.wrap), wrapped(j, height, maps.wrap));
    let size = maps.storage.texel_bytes();
    let at = (maps.first[mip as usize] + j as usize * width as usize + i as usize) * size;
    Vec4::from_array(maps.storage.decode(&bytes[at..at + size]))
}

/// Bilinear look-up in one mip at `position` in texels of the map.
fn bilinear(maps: &Maps<'_>, bytes: &[u8], mip: u32, position: Vec2) -> Vec4 {
    let size = Vec2::new((maps.width >> mip).max(1) as f32, (maps.height >> mip).max(1) as f32);
    let (IVec2 { x: i, y: j }, f) = filtered_texels(position / Vec2::new(maps.width as f32, maps.height as f32) * size);
    let low = texel(maps, bytes, mip, i, j).lerp(texel(maps, bytes, mip, i.saturating_add(1), j), f.x);
    let j = j.saturating_add(1);
    let high = texel(maps, bytes, mip, i, j).lerp(texel(maps, bytes, mip, i.saturating_add(1), j), f.x);
    low.lerp(high, f.y)
}

/// Look-up between mips.
fn trilinear(maps: &Maps<'_>, bytes: &[u8], level: f32, position: Vec2) -> Vec4 {
    let low = (level as u32).min(maps.mips - 1);
    let high = (low + 1).min(maps.mips - 1);
    let near = bilinear(maps, bytes, low, position);
    near.lerp(bilinear(maps, bytes, high, position), level - low as f32)
}

/// `position` brought into the map: textures repeat, and far out f32 has no fractions of texels.
fn into_map(maps: &Maps<'_>, position: Vec2) -> Vec2 {
    let size = Vec2::new(maps.width as f32, maps.height as f32);
    let inside = match maps.wrap {
        Wrap::Repeat => position - (position / size).floor() * size,
        Wrap::Clamp => position,
    };
    let inside = inside.clamp(-size, 2.0 * size);
    if inside.is_finite() { inside } else { Vec2::ZERO }
}

/// Roughness α of a code of the textures, see [`spread::code_of`].
pub fn alpha_of_code(code: f32) -> f32 {
    let code = code.clamp(0.0, 0.99);
    if code > 0.0 {
        (spread::KAPPA as f32 * (code / (1.0 - code)).powf(1.0 / spread::CODE_POWER as f32)).min(1.0)
    } else {
        0.0
    }
}

/// Larger and smaller eigenvalue of xx, xy, yy, 0 to 1, and the direction of the larger.
pub fn principal(matrix: Vec3) -> Roughness {
    let middle = 0.5 * (matrix.x + matrix.z);
    let half = 0.5 * (matrix.x - matrix.z);
    let gap = (half * half + matrix.y * matrix.y).sqrt();
    let axis = if half >= 0.0 { Vec2::new(gap + half, matrix.y) } else { Vec2::new(matrix.y, gap - half) };
    let length = axis.length();
    Roughness {
        major: (middle + gap).clamp(0.0, 1.0),
        minor: (middle - gap).clamp(0.0, 1.0),
        axis: if length > 1.0e-12 { axis / length } else { Vec2::X },
    }
}

/// What lies under a footprint of `footprint_texels` (twice its standard deviation, which is the edge of the texels whose
/// bilinear look-up averages over as much) around `position`, in texels of the map.
pub fn fetch(maps: &Maps<'_>, position: Vec2, footprint_texels: f32) -> Surface {
    let position = into_map(maps, position);
    let footprint = footprint_texels.clamp(0.0, 1.0e9);
    let level = footprint.max(1.0).log2().clamp(0.0, (maps.mips - 1) as f32);
    let mean = trilinear(maps, maps.normals, level, position);
    // Under less than a texel the map is all but plane, and normals differ in proportion to the footprint.
    let fade = footprint.min(1.0);
    let alpha = alpha_of_code(mean.w) * fade;
    let by_direction = if maps.is_anisotropic() {
        let code = principal(trilinear(maps, maps.roughness, level, position).truncate());
        Roughness { major: alpha_of_code(code.major) * fade, minor: alpha_of_code(code.minor) * fade, axis: code.axis }
    } else {
        Roughness { major: alpha, minor: alpha, axis: Vec2::X }
    };
    let length = mean.truncate().length();
    // Normals of opposite sides can cancel; what is left has no direction then.
    let normal = if length > 1.0e-4 { mean.truncate() / length } else { Vec3::Z };
    Surface { normal, length, alpha, by_direction }
}
