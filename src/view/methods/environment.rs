//! An environment on the GPU: `bind_environment.wgsl`, or `bind_environment_exact.wgsl`.

use crate::gpu::{Gpu, GpuTexture, ResourceSet, Resources};
use glint_bake_core::environment::Environment;
use glint_bake_core::environment::baked::decoded;
use glint_formats::environment::{EnvironmentParams, Kernel, LevelChoice, MAX_LEVELS, MeasuredError, Storage};
use half::f16;
use wgpu::{Features, TextureFormat, TextureViewDimension};

/// How shaders look directions up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LookUp {
    /// By a sampler: `bind_environment.wgsl`.
    Sampler,
    /// Texel by texel: `bind_environment_exact.wgsl`.
    Exact,
}

/// Largest radiance that a converted texture stores; the half floats above leave room for filters.
const MAX_STORED: f32 = 32768.0;

/// A cube in the format that the device filters.
struct Cube {
    format: TextureFormat,
    bytes: Vec<u8>,
    /// What stored numbers were divided by.
    scale: f32,
    note: Option<String>,
}

impl Cube {
    fn plain(format: TextureFormat, bytes: &[u8]) -> Cube {
        Cube { format, bytes: bytes.to_vec(), scale: 1.0, note: None }
    }

    /// Half floats of `values`, scaled down by a power of two where they would overflow.
    fn halves(what: &str, feature: &str, values: &[f32]) -> Cube {
        let largest = values.iter().fold(0.0f32, |a, b| a.max(b.abs()));
        let scale = if largest > MAX_STORED { (largest / MAX_STORED).log2().ceil().exp2() } else { 1.0 };
        let bytes = values.iter().flat_map(|value| f16::from_f32(value / scale).to_le_bytes()).collect();
        let note = Some(format!("the adapter lacks {feature}: {what} are half floats on the GPU, to 1 in 2048"));
        Cube { format: TextureFormat::Rgba16Float, bytes, scale, note }
    }
}

/// Radiances of levels as pipeline constants.
const LEVELS: [&str; MAX_LEVELS] = [
    "ENVIRONMENT_LEVEL_0",
    "ENVIRONMENT_LEVEL_1",
    "ENVIRONMENT_LEVEL_2",
    "ENVIRONMENT_LEVEL_3",
    "ENVIRONMENT_LEVEL_4",
    "ENVIRONMENT_LEVEL_5",
    "ENVIRONMENT_LEVEL_6",
    "ENVIRONMENT_LEVEL_7",
    "ENVIRONMENT_LEVEL_8",
    "ENVIRONMENT_LEVEL_9",
    "ENVIRONMENT_LEVEL_10",
    "ENVIRONMENT_LEVEL_11",
    "ENVIRONMENT_LEVEL_12",
    "ENVIRONMENT_LEVEL_13",
    "ENVIRONMENT_LEVEL_14",
    "ENVIRONMENT_LEVEL_15",
];

/// Pipeline constants that follow from the data: what levels there are, so that programs load nothing of them.
pub fn constants(params: &EnvironmentParams) -> Vec<(&'static str, f64)> {
    let mut constants = vec![
        ("ENVIRONMENT_LEVELS", params.levels.len() as f64),
        ("ENVIRONMENT_COLOURED", f64::from(u8::from(params.coloured))),
    ];
    constants.extend(LEVELS.into_iter().zip(params.levels.iter().copied()));
    constants
}

/// Uploads an environment for look-ups by a sampler.
pub fn upload(gpu: &Gpu, environment: &Environment) -> Resources {
    upload_for(gpu, environment, LookUp::Sampler)
}

/// Uploads an environment. What the device cannot filter is converted, which the notes say.
pub fn upload_for(gpu: &Gpu, environment: &Environment, look_up: LookUp) -> Resources {
    upload_as(gpu, environment, look_up, gpu.device.features())
}

/// An environment without light, for scenes that have none.
pub fn empty(gpu: &Gpu) -> Resources {
    let params = EnvironmentParams {
        face_size: 1,
        kernel: Kernel::Ndf,
        storage: Storage::F16,
        roughness: vec![0.0],
        radiance_scale: 1.0,
        levels: vec![0.0],
        level_choice: LevelChoice::Optimal,
        coloured: false,
        albedo_size: 1,
        source_width: 2,
        source_height: 1,
        negative_pixels: 0,
        mean_radiance: [0.0; 3],
        max_error: 0.0,
        measured: MeasuredError::default(),
    };
    let one = f16::ONE.to_bits();
    let environment = Environment {
        uniform: params.uniform(),
        params,
        radiance: vec![0; 6 * 8],
        indicators: Vec::new(),
        colours: Vec::new(),
        albedo: vec![one; 4],
    };
    upload(gpu, &environment)
}

/// As [`upload_for`] on a device that has no more than `features` to filter with.
pub fn upload_as(gpu: &Gpu, environment: &Environment, look_up: LookUp, features: Features) -> Resources {
    let params = &environment.params;
    let radiance = radiance(environment, look_up, features);
    let indicators = indicators(environment, look_up, features);
    let mut uniform = environment.uniform;
    uniform.radiance_scale *= radiance.scale;
    let (cube, cubes) = match look_up {
        LookUp::Sampler => (TextureViewDimension::Cube, TextureViewDimension::CubeArray),
        LookUp::Exact => (TextureViewDimension::D2Array, TextureViewDimension::D2Array),
    };
    let mut set = ResourceSet::default();
    for note in [&radiance.note, &indicators.note].into_iter().flatten() {
        set.note(note.clone());
    }
    set.uniform(gpu, bytemuck::bytes_of(&uniform));
    let shape = |format, layers: u32, dimension| GpuTexture {
        format,
        size: [params.face_size; 2],
        layers: 6 * layers,
        mips: params.mips(),
        dimension,
    };
    set.texture(gpu, shape(radiance.format, 1, cube), true, &radiance.bytes);
    // A binding must be there even where nothing is read from it.
    let black = |format| GpuTexture { size: [1; 2], mips: 1, ..shape(format, 1, cubes) };
    if params.indicator_layers() > 0 {
        set.texture(gpu, shape(indicators.format, params.indicator_layers(), cubes), true, &indicators.bytes);
    } else {
        set.texture(gpu, black(TextureFormat::Rgba16Float), true, &[0; 6 * 8]);
    }
    if params.coloured {
        let shape = shape(TextureFormat::Rgb9e5Ufloat, params.levels.len() as u32 - 1, cubes);
        set.texture(gpu, shape, true, bytemuck::cast_slice(&environment.colours));
    } else {
        set.texture(gpu, black(TextureFormat::Rgb9e5Ufloat), true, &[0; 6 * 4]);
    }
    let albedo = GpuTexture {
        format: TextureFormat::Rgba16Float,
        size: [params.albedo_size; 2],
        layers: 1,
        mips: 1,
        dimension: TextureViewDimension::D2,
    };
    set.texture(gpu, albedo, true, bytemuck::cast_slice(&environment.albedo));
    if look_up == LookUp::Sampler {
        set.sampler(gpu, wgpu::AddressMode::ClampToEdge);
    }
    set.finish(gpu)
}

fn radiance(environment: &Environment, look_up: LookUp, features: Features) -> Cube {
    match environment.params.storage {
        Storage::F16 | Storage::Unorm16 => Cube::plain(TextureFormat::Rgba16Float, &environment.radiance),
        Storage::F32 if look_up == LookUp::Exact || features.contains(Features::FLOAT32_FILTERABLE) => {
            Cube::plain(TextureFormat::Rgba32Float, &environment.radiance)
        }
        Storage::F32 => {
            let values: Vec<f32> = bytemuck::pod_collect_to_vec(&environment.radiance);
            Cube::halves("radiances", "float32-filterable", &values)
        }
    }
}

fn indicators(environment: &Environment, look_up: LookUp, features: Features) -> Cube {
    let bytes = &environment.indicators;
    match environment.params.storage {
        Storage::F16 => Cube::plain(TextureFormat::Rgba16Float, bytes),
        Storage::F32 if look_up == LookUp::Exact || features.contains(Features::FLOAT32_FILTERABLE) => {
            Cube::plain(TextureFormat::Rgba32Float, bytes)
        }
        Storage::F32 => {
            let values: Vec<f32> = bytemuck::pod_collect_to_vec(bytes);
            Cube::halves("shares of radiance levels", "float32-filterable", &values)
        }
        Storage::Unorm16 if features.contains(Features::TEXTURE_FORMAT_16BIT_NORM) => {
            Cube::plain(TextureFormat::Rgba16Unorm, bytes)
        }
        Storage::Unorm16 => {
            let stored: Vec<u16> = bytemuck::pod_collect_to_vec(bytes);
            let values: Vec<f32> =
                stored.iter().map(|bits| decoded(u32::from(*bits), Storage::Unorm16) as f32).collect();
            Cube::halves("shares of radiance levels", "16-bit unorm textures", &values)
        }
    }
}
