//! glint-view at work: packs and materials to the GPU, then pictures, a bench or a window.

use super::bench_json;
use super::flags::{Args, CompareWhen, LightFlag, MaterialFlags, OverlayKind, ShapeKind, TargetKind, Tone};
use super::textures::{material_of, materials_of};
use crate::canvas::Canvas;
use crate::cli::Terminal;
use crate::exit::{Exit, Failure};
use crate::info::Report;
use crate::input::guarded;
use crate::output;
use crate::progress::Stages;
use glam::Vec3;
use glint_bake_core::progress::Progress;
use glint_formats::{Limits, Pack};
use glint_view::bench::{BenchSettings, Setup, measure, table};
use glint_view::gpu::{AdapterChoice, Gpu, GpuError};
use glint_view::methods::textures::Textured;
use glint_view::render::{
    IN_SPACE, LightKind, Material, Method, Overlay, Picture, Renderer, SWAP_LAYERS, Subject, ToneMapping, View,
    baseline_of, picture,
};
use glint_view::scene::{Mesh, MeshError, Orbit, Placement};
use glint_view::settings::{Against, Layout, Settings, cone_solid_angle};
use glint_view::subjects::Subjects;
use glint_view::window::{Hooks, Loaded, Start, WindowError};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Pictures of a turntable when --frames does not say.
const TURNTABLE: u32 = 36;

/// Runs glint-view.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    let placement = args.scene.camera.as_deref().map(Placement::from_str).transpose();
    let placement = placement.map_err(|error| Failure::usage(format!("--camera {error}")))?;
    check_outputs(args)?;
    let limits = Limits { max_file_bytes: args.max_memory, max_raw_bytes: args.max_memory, ..Limits::default() };
    let (lists, packs): (Vec<&PathBuf>, Vec<&PathBuf>) =
        args.packs.iter().partition(|path| has_extension(path, "json"));
    let reports: Vec<Report> = packs.iter().map(|path| Report::of_file(path, &limits)).collect();
    reports.iter().try_for_each(|report| report.sound().map(|_| ()))?;
    let mesh = mesh_of(args, terminal)?;
    let mut textured: Vec<Textured> = materials_of_mesh(args, &mesh, terminal)?.into_iter().collect();
    for path in lists {
        let (of_list, notes) = material_of(path, args.max_memory)?;
        say(path, &notes, terminal);
        textured.push(of_list);
    }
    if args.picture.opens_window(args.list) {
        return window(args, placement, Shown { reports, textured }, mesh, terminal);
    }
    let gpu = Gpu::headless(&adapter(args))?;
    check_size(&gpu, size(args))?;
    terminal.detail(&format!("adapter: {}", gpu.adapter_line()));
    let subjects = upload(&gpu, &Shown { reports, textured }, &args.material)?;
    for note in subjects.notes() {
        terminal.say(&note);
    }
    if args.list {
        return output::print(&list(&gpu, &subjects));
    }
    let settings = settings(args, &subjects.shown, Orbit::fit(mesh.bounds()), placement)?;
    if args.picture.bench {
        return bench(args, &gpu, &subjects, &settings, terminal);
    }
    let mut renderer = subjects.renderer(&gpu, &mesh)?;
    if let Some(path) = &args.picture.headless {
        let view = settings.view(&subjects.shown, size(args));
        return shoot(&gpu, &mut renderer, &view, args.picture.samples, path, terminal);
    }
    let Some(folder) = &args.picture.turntable else { return Ok(()) };
    turntable(args, &gpu, &mut renderer, &subjects.shown, settings, folder, terminal)
}

fn adapter(args: &Args) -> AdapterChoice {
    AdapterChoice { name: args.picture.adapter.clone() }
}

/// Says whether the adapter draws pictures of a size.
fn check_size(gpu: &Gpu, [width, height]: [u32; 2]) -> Result<(), Failure> {
    let most = gpu.device.limits().max_texture_dimension_2d;
    if width.max(height) <= most {
        return Ok(());
    }
    let message =
        format!("--size: the adapter draws at most {most} pixels a side, found {width}x{height}; ask for fewer");
    Err(Failure::new(Exit::LimitExceeded, message))
}

fn size(args: &Args) -> [u32; 2] {
    [args.picture.size.0, args.picture.size.1]
}

/// What is brought to a device: packs, which are sound, and materials of textures.
struct Shown {
    reports: Vec<Report>,
    textured: Vec<Textured>,
}

/// Everything of it on a device.
fn upload(gpu: &Gpu, shown: &Shown, flags: &MaterialFlags) -> Result<Subjects, GpuError> {
    let packs: Vec<&Pack> = shown.reports.iter().filter_map(Report::pack).collect();
    let colours: Vec<Vec3> = flags.colour.iter().map(|&colour| colour.into()).collect();
    let mut subjects = Subjects::of_packs(gpu, &packs, &colours)?;
    shown.textured.iter().try_for_each(|textured| subjects.add_textures(gpu, textured))?;
    Ok(subjects)
}

/// Opens a window on the packs and returns when it is closed.
fn window(
    args: &Args,
    placement: Option<Placement>,
    shown: Shown,
    mesh: Mesh,
    terminal: Terminal,
) -> Result<(), Failure> {
    let name = args.scene.mesh.as_deref().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    let mut meshes = vec![("plane".to_owned(), Mesh::plane(2.0)), ("sphere".to_owned(), Mesh::sphere(64))];
    match (name, args.scene.shape) {
        (Some(name), _) => meshes.insert(0, (name, mesh)),
        (None, ShapeKind::Plane) => {}
        (None, ShapeKind::Sphere) => meshes.swap(0, 1),
    }
    let (wishes, flags) = (args.clone(), args.material.clone());
    let files = args.packs.iter().chain(&args.scene.mesh).map(|path| path.display().to_string());
    let files: Vec<String> = files.collect();
    let start = Start {
        title: format!("{} - glint-view", files.join(" ")),
        size: size(args),
        adapter: adapter(args),
        meshes,
        load: Box::new(move |gpu| {
            let subjects = upload(gpu, &shown, &flags)?;
            let notes = subjects.notes();
            Ok(Loaded { list: subjects.shown, environment: subjects.environment, notes })
        }),
        prepare: Box::new(move |list, camera| {
            settings(&wishes, list, camera, placement).map_err(|failure| failure.message)
        }),
        save: Box::new(move |picture| save(picture, terminal)),
        hooks: Hooks { frames: args.picture.frames, ..Hooks::default() },
    };
    glint_view::window::run(start).map_err(|error| match error {
        WindowError::NoWindow(_) => Failure::new(Exit::Unsupported, error.to_string()),
        WindowError::Settings(message) => Failure::usage(message),
        WindowError::Gpu(error) => error.into(),
    })
}

/// Saves a screenshot under the first free name.
fn save(picture: &Picture, terminal: Terminal) -> Result<String, String> {
    let free = (1..).map(|number| PathBuf::from(format!("glint-view-{number}.png"))).find(|path| !path.exists());
    let path = free.ok_or("there is no free file name")?;
    output::write(&path, &png(picture)).map_err(|failure| failure.message)?;
    let said = format!("{}: written", path.display());
    terminal.say(&said);
    Ok(said)
}

fn check_outputs(args: &Args) -> Result<(), Failure> {
    let Some(path) = &args.picture.headless else { return Ok(()) };
    let inputs: Vec<&Path> = args.packs.iter().chain(&args.scene.mesh).map(|path| path.as_path()).collect();
    output::check_distinct(&[path], &inputs)?;
    output::check_writable(path)
}

fn mesh_of(args: &Args, terminal: Terminal) -> Result<Mesh, Failure> {
    let Some(path) = &args.scene.mesh else {
        return Ok(match args.scene.shape {
            ShapeKind::Plane => Mesh::plane(2.0),
            ShapeKind::Sphere => Mesh::sphere(64),
        });
    };
    let failure = |error: MeshError| {
        let exit = match error {
            MeshError::Io { .. } => Exit::InputOutput,
            MeshError::Bad { .. } => Exit::BadInput,
            MeshError::Unsupported { .. } => Exit::Unsupported,
            MeshError::TooLarge { .. } => Exit::LimitExceeded,
        };
        Failure::new(exit, error.to_string())
    };
    let mesh = guarded(path, || Mesh::load(path).map_err(failure))?;
    say(path, &mesh.notes, terminal);
    Ok(mesh)
}

/// The materials of the mesh's file. Where there are packs to be shown, these do not wait for an image that is wrong.
fn materials_of_mesh(args: &Args, mesh: &Mesh, terminal: Terminal) -> Result<Option<Textured>, Failure> {
    let Some(path) = args.scene.mesh.as_deref().filter(|path| !has_extension(path, "obj")) else { return Ok(None) };
    match materials_of(path, mesh, args.max_memory) {
        Ok((textured, notes)) => {
            say(path, &notes, terminal);
            Ok(Some(textured))
        }
        Err(failure) if args.packs.is_empty() => Err(failure),
        Err(failure) => {
            terminal.warn(&format!("{}; its materials are left out", failure.message));
            Ok(None)
        }
    }
}

/// Says what the user should know of a file.
fn say(path: &Path, notes: &[String], terminal: Terminal) {
    notes.iter().for_each(|note| terminal.say(&format!("{}: {note}", path.display())));
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
}

fn entry_name(shown: &Subject) -> String {
    if shown.name.is_empty() {
        shown.method.name().to_owned()
    } else {
        format!("{}:{}", shown.method.name(), shown.name)
    }
}

fn list(gpu: &Gpu, subjects: &Subjects) -> String {
    let mut text = format!("adapter  {}\n", gpu.adapter_line());
    for shown in &subjects.shown {
        // What an environment shows is what lights the scene.
        let environment = subjects.environment.as_ref().filter(|_| shown.method == Method::Environment);
        let bytes = environment.map_or_else(|| shown.bytes(), |environment| environment.bytes);
        text.push_str(&format!("{}  {bytes} bytes on the GPU\n", entry_name(shown)));
    }
    text
}

/// Index of what a flag names: an entry as `--list` prints it, or the first of a method.
fn find(list: &[Subject], flag: &str, name: &str) -> Result<usize, Failure> {
    let fits = |shown: &Subject| entry_name(shown) == name || shown.method.name() == name;
    list.iter().position(fits).ok_or_else(|| {
        let names: Vec<String> = list.iter().map(entry_name).collect();
        Failure::usage(format!("{flag} '{name}': there is no such entry; there is {}", names.join(", ")))
    })
}

/// What the flags ask for, through a camera that sees all of the mesh or is where `placement` says.
fn settings(args: &Args, list: &[Subject], camera: Orbit, placement: Option<Placement>) -> Result<Settings, Failure> {
    let mut settings = Settings::new(list, camera);
    if let Some(placement) = placement {
        settings.camera.place(placement);
    }
    if let Some(name) = &args.view.method {
        settings.shown = find(list, "--method", name)?;
    }
    settings.against = match args.view.against.as_deref() {
        None => Against::Nothing,
        Some("reference") => Against::Reference,
        Some("baseline") => {
            let shown = &list[settings.shown];
            let found = baseline_of(list, settings.shown);
            let none = || Failure::usage(format!("--against baseline: {} has none", shown.method.name()));
            Against::Other(found.ok_or_else(none)?)
        }
        Some(name) => Against::Other(find(list, "--against", name)?),
    };
    settings.layout = match args.view.compare {
        CompareWhen::Split => Layout::Split(0.5),
        CompareWhen::Error => Layout::Error,
    };
    settings.reference = args.view.reference;
    settings.overlay = match args.view.overlay {
        OverlayKind::None => Overlay::None,
        OverlayKind::Footprint => Overlay::Footprint,
        OverlayKind::Lod => Overlay::Lod,
        OverlayKind::Loads => Overlay::Loads,
        OverlayKind::Operations => Overlay::Operations,
    };
    settings.tone = match args.view.tone {
        Tone::Filmic => ToneMapping::Filmic,
        Tone::Linear => ToneMapping::Linear,
    };
    settings.exposure_stops = args.view.exposure;
    settings.vary_seed = args.view.vary_seed;
    settings.antialias = args.picture.samples > 1 && !args.view.vary_seed;
    settings.uv_scale = args.scene.uv_scale as f32;
    settings.lights.environment.turn = args.scene.turn.to_radians();
    if let Some(direction) = args.scene.sun {
        settings.lights.sun.direction = direction.into();
    }
    settings.lights.sun.solid_angle_sr = cone_solid_angle(args.scene.sun_size.min(180.0));
    if let Some(radius) = args.scene.point_radius {
        settings.lights.points.iter_mut().for_each(|point| point.radius = radius);
    }
    let mut lights: Vec<LightKind> = args.scene.light.iter().map(|light| light.kind()).collect();
    if lights.is_empty() {
        lights.push(list[settings.shown].method.usual_light());
    }
    settings.lights.only(&lights);
    for material in &mut settings.materials {
        apply(&args.material, material);
    }
    Ok(settings)
}

impl LightFlag {
    fn kind(self) -> LightKind {
        match self {
            LightFlag::Sun => LightKind::Sun,
            LightFlag::Points => LightKind::Points,
            LightFlag::Rect => LightKind::Rect,
            LightFlag::Environment => LightKind::Environment,
        }
    }
}

/// What the flags say in place of what the pack says.
fn apply(flags: &MaterialFlags, material: &mut Material) {
    if let Some(alpha) = flags.alpha {
        material.alpha = alpha.map(|alpha| alpha as f32);
    }
    let set = |to: &mut f32, value: Option<f64>| *to = value.map_or(*to, |value| value as f32);
    set(&mut material.density, flags.density);
    set(&mut material.max_anisotropy, flags.max_anisotropy);
    set(&mut material.intrinsic_roughness, flags.intrinsic_roughness);
    set(&mut material.texels_per_unit, flags.texels_per_unit);
    material.normal_target = flags.target.map_or(material.normal_target, |target| match target {
        TargetKind::Beckmann => 0,
        TargetKind::Ggx => 1,
    });
    material.relative_area = flags.relative_area.unwrap_or(material.relative_area);
    material.density_randomisation = flags.density_randomisation.unwrap_or(material.density_randomisation);
    material.f0 = flags.f0.unwrap_or(material.f0);
    set(&mut material.facet_spread, flags.facet_spread.map(f64::to_radians));
    material.sky_spread = flags.sky_spread.map_or(material.sky_spread, f32::to_radians);
    if flags.in_space {
        material.switches |= IN_SPACE;
    }
    material.lobes = flags.lobes.unwrap_or(material.lobes);
    material.seed = flags.seed.unwrap_or(material.seed);
    if flags.swap_layers {
        material.switches ^= SWAP_LAYERS;
    }
}

fn png(picture: &Picture) -> Vec<u8> {
    let pixels = picture.rgba.chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect();
    Canvas { width: picture.size[0], height: picture.size[1], pixels }.to_png()
}

fn shoot(
    gpu: &Gpu,
    renderer: &mut Renderer,
    view: &View,
    samples: u32,
    path: &Path,
    terminal: Terminal,
) -> Result<(), Failure> {
    let picture = picture(gpu, renderer, view, samples)?;
    output::write(path, &png(&picture))?;
    terminal.say(&format!("{}: written", path.display()));
    Ok(())
}

fn turntable(
    args: &Args,
    gpu: &Gpu,
    renderer: &mut Renderer,
    list: &[Subject],
    mut settings: Settings,
    folder: &Path,
    terminal: Terminal,
) -> Result<(), Failure> {
    output::create_folder(folder)?;
    let count = args.picture.frames.unwrap_or(TURNTABLE);
    let start = settings.camera.azimuth;
    for index in 0..count {
        settings.camera.azimuth = start + 360.0 * index as f32 / count as f32;
        let view = settings.view(list, size(args));
        let path = folder.join(format!("{index:05}.png"));
        shoot(gpu, renderer, &view, args.picture.samples, &path, terminal)?;
    }
    Ok(())
}

/// Every entry on a wall that fills the picture, each in the light that it is made for.
fn bench(args: &Args, gpu: &Gpu, subjects: &Subjects, settings: &Settings, terminal: Terminal) -> Result<(), Failure> {
    let size = size(args);
    let bench = BenchSettings { size, frames: args.picture.frames.unwrap_or(20), ..BenchSettings::default() };
    let walls: Vec<Setup> = (0..subjects.shown.len())
        .flat_map(|index| Setup::of(&subjects.shown, index, settings, bench, subjects.environment.is_some()))
        .collect();
    let stages = Stages::new(terminal);
    stages.begin("bench", walls.len() as u64);
    let mut rows = Vec::new();
    for wall in &walls {
        rows.push(measure(gpu, subjects, wall, bench)?);
        stages.advance(1);
    }
    stages.end();
    if args.picture.json {
        return output::print(&bench_json::to_json(gpu, bench, &rows));
    }
    output::print(&format!("{}, {} x {}\n\n{}", gpu.adapter_line(), size[0], size[1], table(&rows)))
}
