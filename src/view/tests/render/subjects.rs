//! A pack of each method, baked small, on the GPU; and a wall in its light.

use glam::Vec3;
use glint_bake_core::dictionary::{self, DictionaryOptions, quality};
use glint_formats::{Codec, Limits, Pack, PackBuilder, Section};
use glint_view::gpu::Gpu;
use glint_view::render::{Camera, Method, Renderer, View, picture};
use glint_view::scene::{Mesh, Orbit};
use glint_view::settings::Settings;
use glint_view::subjects::Subjects;

fn pack(sections: Vec<Section>) -> Pack {
    let mut builder = PackBuilder::new();
    for section in sections {
        builder.push(section).unwrap();
    }
    Pack::from_bytes(builder.finish().unwrap(), &Limits::default()).unwrap()
}

fn dictionary_pack() -> Pack {
    let options = DictionaryOptions::default();
    let baked = dictionary::bake(&options).unwrap();
    pack(dictionary::sections::to_sections("glitter", &baked, quality::measure(&baked), Codec::None))
}

/// Every method's subjects.
pub fn subjects(gpu: &Gpu) -> Subjects {
    let packs = [dictionary_pack()];
    let packs: Vec<&Pack> = packs.iter().collect();
    Subjects::of_packs(gpu, &packs, &[]).unwrap()
}

/// A wall of height 1 that fills the picture from the distance at which a pixel is `1 / size[1]` high, lit alone by the light
/// that the method of entry `index` is made for.
pub fn wall(subjects: &Subjects, index: usize, size: [u32; 2]) -> (Mesh, Settings, View) {
    let mesh = Mesh::wall(40.0, 40.0);
    let mut settings = Settings::new(&subjects.shown, Orbit::fit(mesh.bounds()));
    settings.shown = index;
    settings.lights.only(&[subjects.shown[index].method.usual_light()]);
    settings.lights.room_on = false;
    settings.lights.sun.direction = Vec3::new(0.1, 0.2, 1.0);
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
