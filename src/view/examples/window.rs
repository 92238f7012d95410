//! A window with the smooth BRDF and a slope dictionary that is baked on the spot, without a pack: for tests of the window,
//! and to see what a program has to bring. `--frames N` ends after N frames, `--lose N` loses the device before frame N.

use glint_bake_core::dictionary::{self, quality, sections};
use glint_bake_core::progress::Silent;
use glint_formats::Codec;
use glint_view::gpu::{AdapterChoice, ResourceSet};
use glint_view::methods;
use glint_view::render::{Material, Method, Picture, Subject};
use glint_view::scene::Mesh;
use glint_view::settings::Settings;
use glint_view::window::{Hooks, Loaded, Start, run};
use std::io::Write;
use std::process::ExitCode;
use std::rc::Rc;

fn main() -> ExitCode {
    let hooks = match hooks(std::env::args().skip(1)) {
        Ok(hooks) => hooks,
        Err(usage) => {
            eprintln!("{usage}");
            return ExitCode::from(2);
        }
    };
    let baked = match dictionary::bake(&Default::default(), &Silent) {
        Ok(baked) => baked,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    let start = Start {
        title: "glint-view".to_owned(),
        size: [1280, 720],
        adapter: AdapterChoice::default(),
        meshes: vec![("sphere".to_owned(), Mesh::sphere(64)), ("plane".to_owned(), Mesh::plane(2.0))],
        load: Box::new(move |gpu| {
            let material = Material { density: 2.0e5, ..Material::default() };
            let shown = |method, data| Subject {
                name: String::new(),
                method,
                data: Rc::new(data),
                parts: Vec::new(),
                material,
                files: Vec::new(),
                constants: Vec::new(),
                rim_roughness: 0.0,
            };
            let sections = sections::to_sections("", &baked, quality::measure(&baked), Codec::None);
            let list = vec![
                shown(Method::Smooth, ResourceSet::default().finish(gpu)),
                shown(Method::Dictionary, methods::dictionary::upload_sections(gpu, &sections, &[])?),
            ];
            Ok(Loaded { list, environment: None, notes: Vec::new() })
        }),
        prepare: Box::new(|list, camera| Ok(Settings::new(list, camera))),
        save: Box::new(|picture| save(picture).map_err(|error| format!("window.ppm: {error}"))),
        hooks,
    };
    match run(start) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn hooks(mut words: impl Iterator<Item = String>) -> Result<Hooks, String> {
    let mut hooks = Hooks::default();
    while let Some(word) = words.next() {
        let number = words.next().and_then(|number| number.parse().ok());
        match (word.as_str(), number) {
            ("--frames", Some(frames)) => hooks.frames = Some(frames),
            ("--lose", Some(frame)) => hooks.lose_device_at.push(frame),
            _ => return Err("usage: window [--frames N] [--lose N]...".to_owned()),
        }
    }
    Ok(hooks)
}

/// Writes window.ppm into the working folder.
fn save(picture: &Picture) -> std::io::Result<String> {
    let mut file = std::io::BufWriter::new(std::fs::File::create("window.ppm")?);
    write!(file, "P6\n{} {}\n255\n", picture.size[0], picture.size[1])?;
    for pixel in picture.rgba.chunks_exact(4) {
        file.write_all(&pixel[..3])?;
    }
    file.flush()?;
    Ok("saved window.ppm".to_owned())
}
