//! A pack of each method, baked small, on the GPU; and a wall in its light.

use glam::{Affine2, Vec3};
use glint_bake_core::area_light::{self, AreaLightOptions};
use glint_bake_core::dictionary::{self, DictionaryOptions, quality};
use glint_bake_core::environment::image::{EnvironmentImage, direction as direction_at};
use glint_bake_core::environment::{self, EnvironmentOptions};
use glint_bake_core::glints::{self, GlintsOptions};
use glint_bake_core::lobes::{self, LobesOptions};
use glint_bake_core::ndf_maps::options::{NdfMapsOptions, PlacementOptions, StochasticOptions};
use glint_bake_core::ndf_maps::placement::place;
use glint_bake_core::ndf_maps::{self, baked};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::surface;
use glint_bake_core::synthesis::{SynthesisOptions, Target};
use glint_bake_core::textures::{self, Level, Roughness, TexturesOptions};
use glint_formats::Wrap;
use glint_formats::{Codec, Limits, Pack, PackBuilder, Section};
use glint_view::gpu::Gpu;
use glint_view::methods::textures::{Edge, ImageFormat, MipImage, Texture, Textured, TexturedMaterial};
use glint_view::render::{Camera, Method, Renderer, View, picture};
use glint_view::scene::{Mesh, Orbit};
use glint_view::settings::Settings;
use glint_view::subjects::Subjects;
use std::rc::Rc;
use std::sync::OnceLock;

/// Perceptual roughness of the textured material.
const ROUGHNESS: f32 = 0.4;

fn pack(sections: Vec<Section>) -> Pack {
    let mut builder = PackBuilder::new();
    for section in sections {
        builder.push(section).unwrap();
    }
    Pack::from_bytes(builder.finish().unwrap(), &Limits::default()).unwrap()
}

fn dictionary_pack() -> Pack {
    let options = DictionaryOptions::default();
    let baked = dictionary::bake(&options, &Silent).unwrap();
    pack(dictionary::sections::to_sections("glitter", &baked, quality::measure(&baked), Codec::None))
}

/// Waves, scratched.
fn map(width: u32, height: u32) -> NormalMap {
    let texel = |at: u32| {
        let (x, y) = ((at % width) as f32 / width as f32, (at / width) as f32 / height as f32);
        let wave = |k: f32| (std::f32::consts::TAU * k).sin();
        let scratch = if (7 * (at % width) + 3 * (at / width)).is_multiple_of(11) { 0.1 } else { 0.0 };
        [0.2 * wave(2.0 * x + y) + scratch, 0.15 * wave(3.0 * y - 2.0 * x) * wave(3.0 * x) - 0.5 * scratch]
    };
    NormalMap { width, height, wrap: Wrap::Repeat, projected: (0..width * height).map(texel).collect() }
}

fn ndf_maps_pack() -> Pack {
    ndf_maps_pack_of(&map(12, 12))
}

/// A map tiled and placed at random.
pub fn ndf_maps_pack_of(map: &NormalMap) -> Pack {
    let options = NdfMapsOptions { roughness: 0.05, max_error: 0.03, ..NdfMapsOptions::default() };
    let stochastic = StochasticOptions { palette: 8, cells: 8, ..StochasticOptions::default() };
    let placements = [PlacementOptions::Tiled(Default::default()), PlacementOptions::Stochastic(stochastic)];
    let sections = ["tiled", "stochastic"].into_iter().zip(placements).flat_map(|(name, placement)| {
        let placement = place(map, options.roughness, &placement).unwrap();
        let maps = ndf_maps::bake::bake_maps(map, &options, &Silent).unwrap();
        ndf_maps::sections::to_sections(name, &baked::Material { maps, placement }, Codec::None)
    });
    pack(sections.collect())
}

fn lobes_pack() -> Pack {
    let baked = lobes::bake(&map(64, 64), &LobesOptions::default(), &Silent).unwrap();
    pack(lobes::sections::to_sections("waves", &baked, Codec::None))
}

fn surface_pack() -> Pack {
    let synthesis = SynthesisOptions {
        target: Target::Patches { width: 256, height: 256 },
        patch: 32,
        overlap: 4,
        ..Default::default()
    };
    let options = surface::SurfaceOptions { lobes: LobesOptions::default(), synthesis };
    let baked = surface::bake(&map(112, 128), &options, &Silent).unwrap();
    pack(surface::sections::to_sections("patches", &baked, Codec::None))
}

/// An even sky with lamps.
pub fn environment_pack() -> Pack {
    const HEIGHT: u32 = 32;
    let mut pixels = Vec::new();
    for y in 0..HEIGHT {
        for x in 0..2 * HEIGHT {
            let longitude = std::f64::consts::PI * ((f64::from(x) + 0.5) / f64::from(HEIGHT) - 1.0);
            let latitude = std::f64::consts::PI * (0.5 - (f64::from(y) + 0.5) / f64::from(HEIGHT));
            let d = direction_at(longitude, latitude.sin());
            let is_lamp = (9.0 * d.x).sin() * (7.0 * d.z).cos() > 0.85;
            pixels.push(if is_lamp { [20.0, 16.0, 8.0] } else { [0.3 + 0.2 * d.y as f32, 0.3, 0.4] });
        }
    }
    let image = EnvironmentImage::new(2 * HEIGHT, HEIGHT, pixels).unwrap();
    let options = EnvironmentOptions { face_size: 32, measured_reads: 0, ..EnvironmentOptions::default() };
    let baked = environment::bake(&image, &options, &Silent).unwrap();
    pack(environment::sections::to_sections("lamps", &baked, Codec::None))
}

fn area_light_pack() -> Pack {
    let options = AreaLightOptions { anisotropic: true, ..AreaLightOptions::default() };
    let baked = area_light::bake(&map(64, 64), &options, &Silent).unwrap();
    pack(area_light::sections::to_sections("waves", &baked, Codec::None))
}

fn glints_pack() -> Pack {
    let colours = vec![[1.0, 0.4, 0.2], [0.3, 0.6, 1.0]];
    let options =
        GlintsOptions { colours, relative_area: 0.8, diffuse: [0.05; 3], coat: 0.5, ..GlintsOptions::default() };
    pack(glints::sections::to_sections("flakes", &glints::bake(&options, &Silent).unwrap(), Codec::None))
}

/// A pack of every method.
pub fn packs() -> &'static [Pack] {
    static PACKS: OnceLock<Vec<Pack>> = OnceLock::new();
    PACKS.get_or_init(|| {
        vec![
            dictionary_pack(),
            ndf_maps_pack(),
            lobes_pack(),
            surface_pack(),
            environment_pack(),
            area_light_pack(),
            glints_pack(),
        ]
    })
}

/// The waves as textures: their filtered normals and roughness, and what an engine makes of the finest of them.
fn textured() -> Textured {
    let map = map(64, 64);
    let baked = textures::bake(&map, &Roughness::Constant(ROUGHNESS), &TexturesOptions::default(), &Silent).unwrap();
    let normal =
        |&[x, y]: &[f32; 2]| [0.5 + 0.5 * x, 0.5 + 0.5 * y, 0.5 + 0.5 * (1.0 - x * x - y * y).max(0.0).sqrt(), 1.0];
    let rough = |alpha: &f32| [1.0, alpha.sqrt(), 1.0, 1.0];
    let finest: Vec<[f32; 4]> = map.projected.iter().map(normal).collect();
    let flat = vec![[1.0, ROUGHNESS, 1.0, 1.0]; finest.len()];
    let mut plain = vec![finest.clone()];
    while plain[plain.len() - 1].len() > 1 {
        plain.push(halved(&plain[plain.len() - 1]));
    }
    let levels = |first, of: &dyn Fn(&Level) -> Vec<[f32; 4]>| {
        let mips: Vec<Vec<[f32; 4]>> = [first].into_iter().chain(baked.levels.iter().map(of)).collect();
        image(&mips)
    };
    let texture = |image, plain| Some(Texture { image, plain, edges: [Edge::Repeat; 2], uv: Affine2::IDENTITY });
    let normals = texture(levels(finest, &|level| level.normals.iter().map(normal).collect()), image(&plain));
    let roughness = texture(levels(flat.clone(), &|level| level.alphas.iter().map(rough).collect()), image(&[flat]));
    let material = TexturedMaterial { textures: [None, normals, roughness, None, None], ..TexturedMaterial::default() };
    Textured { name: "waves".to_owned(), materials: vec![material], parts: Vec::new() }
}

/// Means of 2 × 2 texels of a square.
fn halved(texels: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let side = texels.len().isqrt();
    let mean = |i: usize, j: usize| {
        let of = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(di, dj)| texels[(2 * j + dj) * side + 2 * i + di]);
        [0, 1, 2, 3].map(|c| of.iter().map(|texel| texel[c]).sum::<f32>() / 4.0)
    };
    (0..side / 2).flat_map(|j| (0..side / 2).map(move |i| (i, j))).map(|(i, j)| mean(i, j)).collect()
}

/// A square image in 8 bits.
fn image(mips: &[Vec<[f32; 4]>]) -> Rc<MipImage> {
    let byte = |value: &f32| (value * 255.0).round() as u8;
    let bytes = |mip: &Vec<[f32; 4]>| mip.as_flattened().iter().map(byte).collect();
    let side = mips[0].len().isqrt() as u32;
    Rc::new(MipImage { format: ImageFormat::Linear8, size: [side; 2], mips: mips.iter().map(bytes).collect() })
}

/// Subjects of every method.
pub fn subjects(gpu: &Gpu) -> Subjects {
    let mut subjects = Subjects::of_packs(gpu, &packs().iter().collect::<Vec<_>>(), &[]).unwrap();
    subjects.add_textures(gpu, &textured()).unwrap();
    for method in Method::ALL {
        assert!(subjects.shown.iter().any(|shown| shown.method == *method), "{} is not shown", method.name());
    }
    subjects
}

/// A wall of height 1 that fills the picture from the distance at which a pixel is `1 / size[1]` high, lit alone by the light
/// that the method of entry `index` is made for. A pixel spans about two texels of maps.
pub fn wall(subjects: &Subjects, index: usize, size: [u32; 2]) -> (Mesh, Settings, View) {
    const EDGE: f32 = 40.0;
    let mesh = Mesh::wall(EDGE, EDGE);
    let mut settings = Settings::new(&subjects.shown, Orbit::fit(mesh.bounds()));
    settings.shown = index;
    let shown = &subjects.shown[index];
    settings.lights.only(&[shown.method.usual_light()]);
    settings.lights.room_on = false;
    settings.lights.sun.direction = Vec3::new(0.1, 0.2, 1.0);
    let corner = |x: f32, y: f32| Vec3::new(x, y, 1.5);
    settings.lights.rect.corners = [corner(0.7, -0.2), corner(-0.4, -0.2), corner(-0.4, 0.6), corner(0.7, 0.6)];
    // One unit of uv is the whole wall.
    settings.uv_scale = EDGE;
    if shown.method.has_map() {
        settings.uv_scale *= 2.0 * size[1] as f32 / shown.material.texels_per_unit;
    }
    let mut view = settings.view(&subjects.shown, size);
    view.scene.camera = camera(1.0);
    (mesh, settings, view)
}

/// A camera that sees `height` of the wall.
pub fn camera(height: f32) -> Camera {
    let field_of_view = 0.6;
    let distance = 0.5 * height / (0.5f32 * field_of_view).tan();
    Camera { position: Vec3::new(0.0, 0.0, distance), target: Vec3::ZERO, field_of_view, near: 0.01 * distance }
}

/// Index of the first entry of a method.
pub fn index_of(subjects: &Subjects, method: Method) -> usize {
    subjects.shown.iter().position(|shown| shown.method == method).unwrap()
}

/// Mean radiance over the picture, by colour, and the largest; all pixels are finite and not negative.
pub fn mean_radiance(gpu: &Gpu, renderer: &mut Renderer, view: &View, frames: u32) -> ([f64; 3], f32) {
    picture(gpu, renderer, view, frames).unwrap();
    let pixels = renderer.radiance(gpu, view, 0).unwrap();
    let mut sum = [0.0; 3];
    let mut largest = 0.0f32;
    for pixel in &pixels {
        for c in 0..3 {
            assert!(pixel[c].is_finite() && pixel[c] >= 0.0, "{:?} shows {pixel:?}", view.compare);
            sum[c] += f64::from(pixel[c]);
            largest = largest.max(pixel[c]);
        }
    }
    (sum.map(|channel| channel / pixels.len() as f64), largest)
}
