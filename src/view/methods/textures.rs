//! Materials as textures with mips on the GPU: `bind_textures.wgsl`. Each image is uploaded once, however many materials have it.

use crate::gpu::{Gpu, GpuError, ResourceSet, Resources};
use bytemuck::{Pod, Zeroable};
use glam::Affine2;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::rc::Rc;
use wgpu::util::{DeviceExt, TextureDataOrder};

/// How the bytes of an image are read; four channels each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFormat {
    /// 8 bits that are 0 to 1.
    Linear8,
    /// 8 bits as sRGB encodes them.
    Srgb8,
    /// Half floats.
    Half,
}

/// An image with its mips.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MipImage {
    /// Format.
    pub format: ImageFormat,
    /// Width and height of the first mip, each at least 1.
    pub size: [u32; 2],
    /// Bytes of each mip, row by row; sides are halved from one to the next, rounded down, at least 1.
    pub mips: Vec<Vec<u8>>,
}

/// What lies beyond the edges of an image along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// The image again.
    Repeat,
    /// The image mirrored.
    Mirror,
    /// Its last texels.
    Clamp,
}

/// A texture of a material.
#[derive(Clone, Debug)]
pub struct Texture {
    /// Mips as they are filtered.
    pub image: Rc<MipImage>,
    /// Mips as an engine makes them of the finest.
    pub plain: Rc<MipImage>,
    /// Edges along u and v.
    pub edges: [Edge; 2],
    /// From the mesh's texture coordinates to those of the texture.
    pub uv: Affine2,
}

/// A metallic-roughness material of glTF 2.0 (specification, section 3.9). Where it has no texture, factors say all.
#[derive(Clone, Debug)]
pub struct TexturedMaterial {
    /// Linear RGB; none where the viewer's own reflectance is the colour.
    pub base_colour: Option<[f32; 3]>,
    /// 0 to 1.
    pub metallic: f32,
    /// Perceptual roughness, 0 to 1.
    pub roughness: f32,
    /// What x and y of normals are multiplied with.
    pub normal_scale: f32,
    /// How much of the occlusion counts, 0 to 1.
    pub occlusion_strength: f32,
    /// Radiance, linear RGB.
    pub emissive: [f32; 3],
    /// Colour, normals, roughness (green) and metallic (blue), occlusion (red), emission.
    pub textures: [Option<Texture>; SLOTS],
}

/// Textures of a material.
pub const SLOTS: usize = 5;
/// Slot of the normals.
pub const NORMAL: usize = 1;

/// What a file says of its surfaces.
#[derive(Clone, Debug)]
pub struct Textured {
    /// Name.
    pub name: String,
    /// Materials, at least one.
    pub materials: Vec<TexturedMaterial>,
    /// Material of each part of the file's mesh; none where the first is that of all.
    pub parts: Vec<usize>,
}

impl Textured {
    /// Texels of the finest mip of normals along the longer side, of the first material that has them; 1 where none has.
    pub fn texels(&self) -> f32 {
        let normals = self.materials.iter().find_map(|material| material.textures[NORMAL].as_ref());
        normals.map_or(1.0, |texture| texture.image.size[0].max(texture.image.size[1]) as f32)
    }

    /// Whether a surface emits light.
    pub fn emits(&self) -> bool {
        self.materials.iter().any(|material| material.emissive.iter().any(|&channel| channel > 0.0))
    }
}

impl Default for TexturedMaterial {
    /// The material of what has none, as the specification has it.
    fn default() -> TexturedMaterial {
        TexturedMaterial {
            base_colour: Some([1.0; 3]),
            metallic: 1.0,
            roughness: 1.0,
            normal_scale: 1.0,
            occlusion_strength: 1.0,
            emissive: [0.0; 3],
            textures: [const { None }; SLOTS],
        }
    }
}

/// `TexturesPlace` of bind_textures.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct PlaceUniform {
    linear: [f32; 4],
    offset: [f32; 2],
    size: [f32; 2],
}

/// `TexturesMaterial` of bind_textures.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct MaterialUniform {
    places: [PlaceUniform; SLOTS],
    base_colour: [f32; 3],
    metallic: f32,
    emissive: [f32; 3],
    roughness: f32,
    normal_scale: f32,
    occlusion_strength: f32,
    texels: f32,
    own_colour: f32,
}

impl MaterialUniform {
    fn new(material: &TexturedMaterial, texels: f32) -> MaterialUniform {
        let place = |texture: &Option<Texture>| {
            let uv = texture.as_ref().map_or(Affine2::IDENTITY, |texture| texture.uv);
            let size = texture.as_ref().map_or([1; 2], |texture| texture.image.size);
            PlaceUniform {
                linear: uv.matrix2.to_cols_array(),
                offset: uv.translation.to_array(),
                size: size.map(|side| side as f32),
            }
        };
        MaterialUniform {
            places: material.textures.each_ref().map(place),
            base_colour: material.base_colour.unwrap_or([1.0; 3]),
            metallic: material.metallic,
            emissive: material.emissive,
            roughness: material.roughness,
            normal_scale: material.normal_scale,
            occlusion_strength: material.occlusion_strength,
            texels,
            own_colour: f32::from(u8::from(material.base_colour.is_none())),
        }
    }
}

/// Uploads the materials of a file, with the mips that they have or with plain ones.
///
/// # Errors
/// [`GpuError::TooLarge`] for an image that the device does not hold.
pub fn upload(gpu: &Gpu, textured: &Textured, plain: bool) -> Result<Vec<Rc<Resources>>, GpuError> {
    let mut uploaded: HashMap<*const MipImage, wgpu::Texture> = HashMap::new();
    let white = Rc::new(one_texel([1.0; 3]));
    let up = Rc::new(one_texel([0.5, 0.5, 1.0]));
    let mut all = Vec::new();
    for material in &textured.materials {
        let mut set = ResourceSet::default();
        set.uniform(gpu, bytemuck::bytes_of(&MaterialUniform::new(material, textured.texels())));
        for (slot, texture) in material.textures.iter().enumerate() {
            let image = match texture {
                Some(texture) if plain => &texture.plain,
                Some(texture) => &texture.image,
                None if slot == NORMAL => &up,
                None => &white,
            };
            let known = match uploaded.entry(Rc::as_ptr(image)) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(place) => {
                    set.add_bytes(image.mips.iter().map(Vec::len).sum());
                    place.insert(texture_of(gpu, image)?)
                }
            };
            set.sampled(known);
            let edges = texture.as_ref().map_or([Edge::Repeat; 2], |texture| texture.edges);
            set.sampler_of(gpu, edges.map(address_mode));
        }
        all.push(Rc::new(set.finish(gpu)));
    }
    Ok(all)
}

fn one_texel([r, g, b]: [f32; 3]) -> MipImage {
    let texel = [r, g, b, 1.0].map(half::f16::from_f32);
    MipImage { format: ImageFormat::Half, size: [1; 2], mips: vec![bytemuck::cast_slice(&texel).to_vec()] }
}

fn address_mode(edge: Edge) -> wgpu::AddressMode {
    match edge {
        Edge::Repeat => wgpu::AddressMode::Repeat,
        Edge::Mirror => wgpu::AddressMode::MirrorRepeat,
        Edge::Clamp => wgpu::AddressMode::ClampToEdge,
    }
}

fn texture_of(gpu: &Gpu, image: &MipImage) -> Result<wgpu::Texture, GpuError> {
    let [width, height] = image.size;
    let most = gpu.device.limits().max_texture_dimension_2d;
    if width.max(height) > most {
        return Err(GpuError::TooLarge(format!(
            "an image of {width} x {height} texels: the adapter holds at most {most} a side; scale it down"
        )));
    }
    let descriptor = wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: image.mips.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: match image.format {
            ImageFormat::Linear8 => wgpu::TextureFormat::Rgba8Unorm,
            ImageFormat::Srgb8 => wgpu::TextureFormat::Rgba8UnormSrgb,
            ImageFormat::Half => wgpu::TextureFormat::Rgba16Float,
        },
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    };
    let bytes = image.mips.concat();
    Ok(gpu.device.create_texture_with_data(&gpu.queue, &descriptor, TextureDataOrder::MipMajor, &bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glint_shaders::assert_same_layout;

    #[test]
    fn uniforms_lie_as_the_shader_reads_them() {
        let source = glint_shaders::compose(&["bind_textures"]);
        assert_same_layout!(&source, "TexturesPlace", PlaceUniform, linear, offset, size);
        assert_same_layout!(
            &source,
            "TexturesMaterial",
            MaterialUniform,
            places,
            base_colour,
            metallic,
            emissive,
            roughness,
            normal_scale,
            occlusion_strength,
            texels,
            own_colour
        );
    }
}
