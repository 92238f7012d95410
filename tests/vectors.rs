//! Golden vectors, proved on every language that an adapter can be made to run: the files of `glint-bake shaders` as they are written, their
//! example called with the vectors' pixels on the vectors' pack. HLSL and GLSL reach the adapter as SPIR-V of glslang.

#![cfg(feature = "view")]

use glint_formats::{Limits, Pack, Wrap};
use glint_view::gpu::{Gpu, ResourceSet, Resources, answer_by, bind_pack};
use glint_view::methods::{dictionary, ndf_maps};
use std::borrow::Cow;
use std::fs;
use std::path::Path;
use std::process::Command;

const METHODS: [&str; 7] = ["dictionary", "ndf_maps", "lobes", "surface", "glints", "area_light", "environment"];
/// Methods without textures: in GLSL textures come with their samplers, which the adapter's interface has apart.
const WITHOUT_TEXTURES: [&str; 3] = ["dictionary", "lobes", "surface"];
/// Words of `ExamplePixel` and of `ExampleAnswer`.
type Pixel = [u32; 20];
type Answer = [f32; 12];

/// A device that takes SPIR-V as it is, or nothing where there is none and none is required.
fn gpu() -> Option<Gpu> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let made = pollster::block_on(async {
        let adapter =
            instance.request_adapter(&wgpu::RequestAdapterOptions::default()).await.map_err(|e| e.to_string())?;
        let required_features = wgpu::Features::PASSTHROUGH_SHADERS;
        let descriptor = wgpu::DeviceDescriptor { required_features, ..Default::default() };
        let (device, queue) = adapter.request_device(&descriptor).await.map_err(|e| e.to_string())?;
        Ok::<_, String>((adapter, device, queue))
    });
    match made {
        Ok((adapter, device, queue)) => Some(Gpu::of_host(instance, adapter, device, queue)),
        Err(error) if std::env::var_os("GLINT_REQUIRE_ADAPTER").is_some_and(|value| value == "1") => panic!("{error}"),
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    }
}

/// Runs `glint-bake shaders` in `folder`.
fn shaders(folder: &Path, args: &[&str]) {
    let done = Command::new(env!("CARGO_BIN_EXE_glint-bake")).arg("shaders").args(args).current_dir(folder).output();
    let done = done.unwrap();
    assert!(done.status.success(), "{args:?}: {}", String::from_utf8_lossy(&done.stderr));
}

/// The vectors of a method.
struct Vectors {
    pack: Pack,
    pixels: Vec<Pixel>,
    answers: Vec<Answer>,
    share_beyond: f64,
    tolerance: [f64; 2],
}

impl Vectors {
    fn read(folder: &Path, method: &str) -> Vectors {
        let read = |end: &str| fs::read(folder.join(format!("vectors_{method}{end}"))).unwrap();
        let words = |bytes: Vec<u8>| -> Vec<u32> {
            bytes.chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect()
        };
        let text: serde_json::Value = serde_json::from_slice(&read(".json")).unwrap();
        let pixels: Vec<Pixel> = words(read("_pixels.bin")).as_chunks().0.to_vec();
        let answers: Vec<Answer> = words(read("_answers.bin"))
            .as_chunks()
            .0
            .iter()
            .map(|answer: &[u32; 12]| answer.map(f32::from_bits))
            .collect();
        // Both forms say the same.
        assert_eq!(text["pixels"].as_array().unwrap().len(), pixels.len());
        for (json, raw) in text["answers"].as_array().unwrap().iter().zip(&answers) {
            assert_eq!(json["brdf"][1].as_f64().unwrap() as f32, raw[1]);
            assert_eq!(json["pdf"].as_f64().unwrap() as f32, raw[3]);
            assert_eq!(json["radiance"][2].as_f64().unwrap() as f32, raw[10]);
        }
        let pack = Pack::from_bytes(read(".glintpack"), &Limits::default()).unwrap();
        assert_eq!(pack.verify(), []);
        let number = |value: &serde_json::Value| value.as_f64().unwrap();
        Vectors {
            pack,
            pixels,
            answers,
            share_beyond: number(&text["share_beyond"]),
            tolerance: [number(&text["tolerance"][0]), number(&text["tolerance"][1])],
        }
    }

    /// The method's data in its group, after empty groups where it is not the first.
    fn bind(&self, gpu: &Gpu, method: &str) -> Vec<Resources> {
        let bound = |name, bindings, wrap| bind_pack(gpu, &self.pack, name, bindings, wrap).unwrap();
        match method {
            "dictionary" => vec![dictionary::upload(gpu, &self.pack, "dictionary", &[]).unwrap()],
            "ndf_maps" => vec![ndf_maps::bind(gpu, &self.pack, "waves", None).unwrap()],
            "lobes" | "surface" => vec![bound("waves", glint_formats::lobes::BINDINGS, Wrap::Repeat)],
            "glints" => vec![bound("facets", glint_formats::glints::BINDINGS, Wrap::Clamp)],
            "area_light" => vec![bound("waves", glint_formats::area_light::BINDINGS, Wrap::Repeat)],
            _ => vec![
                ResourceSet::default().finish(gpu),
                bound("sky", glint_formats::environment::BINDINGS, Wrap::Clamp),
            ],
        }
    }

    /// Fails where more numbers than are allowed are off by more than the tolerance.
    fn prove(&self, what: &str, found: &[Answer]) {
        let mut beyond = 0;
        let mut worst = 0f64;
        for part in [0..3, 3..4, 4..7, 8..11] {
            let numbers = || self.answers.iter().zip(found).flat_map(|(a, b)| part.clone().map(move |k| (a[k], b[k])));
            let largest = numbers().map(|(expected, _)| f64::from(expected.abs())).fold(0.0, f64::max);
            for (expected, found) in numbers() {
                let (expected, found) = (f64::from(expected), f64::from(found));
                let off = (expected - found).abs();
                let allowed = self.tolerance[0] * expected.abs().max(found.abs()) + self.tolerance[1] * largest;
                let is_right = off <= allowed;
                beyond += usize::from(!is_right);
                if is_right && expected.abs() > 0.01 * largest {
                    worst = worst.max(off / expected.abs());
                }
            }
        }
        let numbers = 10 * self.answers.len();
        println!("{what}: {beyond} of {numbers} numbers beyond the tolerance, the others within {worst:.1e}");
        // A tenth of what ports are allowed, whose filters may round more.
        assert!(beyond as f64 <= 0.1 * self.share_beyond * numbers as f64, "{what}: {beyond} of {numbers}");
        let lit = self.answers.iter().filter(|answer| answer[0] + answer[8] > 0.0).count();
        assert!(4 * lit > self.answers.len(), "{what}: {lit} pixels reflect anything");
    }
}

/// The module of a compute program that glslang compiles; nothing where there is no glslang.
fn through_spirv(gpu: &Gpu, folder: &Path, args: &[&str], example: &str) -> Option<wgpu::ShaderModule> {
    let out = folder.join(format!("{example}.spv"));
    let glslang = Command::new("glslangValidator")
        .args(args)
        .args(["-V", "-I.", "-o"])
        .arg(&out)
        .arg(example)
        .current_dir(folder)
        .output();
    let compiled = match glslang {
        Ok(compiled) => compiled,
        Err(error) => {
            eprintln!("skipped: glslangValidator cannot be run: {error}");
            return None;
        }
    };
    assert!(compiled.status.success(), "{example}: {}", String::from_utf8_lossy(&compiled.stdout));
    let words: Vec<u32> = fs::read(out).unwrap().as_chunks().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
    let entry = wgpu::PassthroughShaderEntryPoint { name: "main".into(), workgroup_size: (64, 1, 1) };
    let descriptor = wgpu::ShaderModuleDescriptorPassthrough {
        label: Some(example),
        entry_points: Cow::Owned(vec![entry]),
        spirv: Some(words.into()),
        ..Default::default()
    };
    // SAFETY: glslang has written it, and spirv-val accepts its like in the tests of glint-shaders.
    Some(unsafe { gpu.device.create_shader_module_passthrough(descriptor) })
}

/// The one file of a method with its bindings and example, as `docs/CLI.md` says.
fn wgsl(folder: &Path, method: &str) -> String {
    shaders(folder, &["--lang", "wgsl", "--method", method, "-o", &format!("wgsl_{method}")]);
    let folder = folder.join(format!("wgsl_{method}"));
    let mut text = fs::read_to_string(folder.join(format!("glint_{method}.wgsl"))).unwrap();
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        let name = path.file_name().unwrap().to_str().unwrap();
        if name.starts_with("bind_") || name.starts_with("example_") {
            text.push_str(&fs::read_to_string(&path).unwrap());
        }
    }
    text
}

#[test]
fn every_language_gives_the_vectors() {
    let Some(gpu) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    shaders(folder, &["--vectors", "-o", "vectors"]);
    for language in ["hlsl", "glsl"] {
        shaders(folder, &["--lang", language, "-o", language]);
    }
    for method in METHODS {
        let vectors = Vectors::read(&folder.join("vectors"), method);
        let data = vectors.bind(&gpu, method);
        let data: Vec<&Resources> = data.iter().collect();
        let prove = |language: &str, module: &wgpu::ShaderModule| {
            let what = format!("{method} in {language}");
            let found: Vec<Answer> = answer_by(&gpu, &what, module, &data, &vectors.pixels).unwrap();
            vectors.prove(&what, &found);
        };
        prove("wgsl", &gpu.shader(method, &wgsl(folder, method)).unwrap());
        let hlsl = ["-D", "-S", "comp", "-e", "main"];
        if let Some(module) = through_spirv(&gpu, &folder.join("hlsl"), &hlsl, &format!("example_{method}.hlsl")) {
            prove("hlsl", &module);
        }
        if WITHOUT_TEXTURES.contains(&method)
            && let Some(module) = through_spirv(&gpu, &folder.join("glsl"), &[], &format!("example_{method}.comp"))
        {
            prove("glsl", &module);
        }
    }
}
