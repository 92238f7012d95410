//! The panel: method and material, comparison, display, lights, camera, and what is known of the frame.

use super::controls::{Action, Controls, Mode};
use super::lights;
use crate::render::{ACCURATE, IN_SPACE, Material, Method, Overlay, SWAP_LAYERS, Subject, ToneMapping};
use crate::settings::{Against, Settings};
use egui::{Context, Slider, Ui};

/// Width of the panel in points.
const WIDTH: f32 = 336.0;

/// What the panel tells beside what it sets.
#[derive(Clone, Debug, Default)]
pub(super) struct Facts {
    /// Adapter in one line.
    pub adapter: String,
    /// Conversions and completions that the user should know of.
    pub notes: Vec<String>,
    /// Names of the meshes.
    pub meshes: Vec<String>,
    /// Pixels of the picture.
    pub size: [u32; 2],
    /// Frames in the mean.
    pub frames: u32,
    /// Seconds of each pass of the last frame; none where the device has no timestamps.
    pub passes: Option<Vec<(&'static str, f64)>>,
}

/// Draws the panel; what it asks of the loop.
pub(super) fn show(
    context: &Context,
    controls: &mut Controls,
    settings: &mut Settings,
    list: &[Subject],
    facts: &Facts,
) -> Option<Action> {
    if !controls.panel {
        return None;
    }
    let mut action = None;
    // As high as its content where the window allows it; longer ones scroll.
    let height = (context.content_rect().height() - 60.0).max(20.0);
    egui::Window::new("glint-view").default_pos([8.0, 8.0]).auto_sized().show(context, |ui| {
        egui::ScrollArea::vertical().max_height(height).show(ui, |ui| {
            ui.set_width(WIDTH);
            ui.spacing_mut().slider_width = 120.0;
            action = parts(ui, controls, settings, list, facts);
        });
    });
    action
}

fn parts(
    ui: &mut Ui,
    controls: &mut Controls,
    settings: &mut Settings,
    list: &[Subject],
    facts: &Facts,
) -> Option<Action> {
    let mut action = None;
    method(ui, settings, list);
    section(ui, "Material", true, |ui| {
        if let (Some(material), Some(shown)) = (settings.materials.get_mut(settings.shown), list.get(settings.shown)) {
            parameters(ui, shown.method, material);
        }
        ui.add(Slider::new(&mut settings.uv_scale, 0.01..=100.0).logarithmic(true).text("surface units / uv"));
    });
    section(ui, "Comparison", true, |ui| comparison(ui, controls, settings, list));
    section(ui, "Display", true, |ui| display(ui, settings));
    section(ui, "Lights", false, |ui| lights::show(ui, &mut settings.lights));
    section(ui, "Camera and mesh", false, |ui| action = camera(ui, controls, settings, facts));
    controls.times = section(ui, "Frame", false, |ui| frame(ui, facts));
    ui.separator();
    ui.horizontal(|ui| {
        if ui.button("Save picture (S)").clicked() {
            action = Some(Action::Save);
        }
        if ui.button("Hide panel (H)").clicked() {
            controls.panel = false;
        }
    });
    if !controls.message.is_empty() {
        ui.label(&controls.message);
    }
    action
}

/// A part that can be closed; whether it is open.
fn section(ui: &mut Ui, title: &str, open: bool, show: impl FnOnce(&mut Ui)) -> bool {
    egui::CollapsingHeader::new(title).default_open(open).show(ui, show).body_returned.is_some()
}

fn name(shown: &Subject) -> String {
    match shown.name.as_str() {
        "" => shown.method.name().to_owned(),
        name => format!("{}: {name}", shown.method.name()),
    }
}

fn method(ui: &mut Ui, settings: &mut Settings, list: &[Subject]) {
    for (index, shown) in list.iter().enumerate() {
        let key = if index < 9 { format!("{}  ", index + 1) } else { String::new() };
        ui.radio_value(&mut settings.shown, index, format!("{key}{}", name(shown)));
    }
    ui.checkbox(&mut settings.reference, "reference in its place (R)");
}

/// The parameters that a method reads.
fn parameters(ui: &mut Ui, method: Method, material: &mut Material) {
    ui.horizontal(|ui| {
        ui.color_edit_button_rgb(&mut material.f0);
        ui.label("reflectance at normal incidence F0");
    });
    match method {
        Method::Smooth => roughness(ui, material),
        Method::Dictionary => {
            roughness(ui, material);
            facets(ui, material);
            ui.add(Slider::new(&mut material.density_randomisation, 0.0..=10.0).text("density randomisation"));
            ui.add(Slider::new(&mut material.max_anisotropy, 1.0..=64.0).logarithmic(true).text("largest anisotropy"));
        }
        Method::NdfMaps => {
            texels(ui, material);
            switch(ui, material, SWAP_LAYERS, "exchange the layers");
            switch(ui, material, ACCURATE, "finer probes: slower, more accurate");
        }
        Method::Lobes | Method::Surface => {
            let slider = Slider::new(&mut material.intrinsic_roughness, 0.001..=0.3).logarithmic(true);
            ui.add(slider.text("intrinsic roughness σ"));
            texels(ui, material);
        }
        Method::Environment => {
            roughness(ui, material);
            facets(ui, material);
        }
        Method::Glints => {
            roughness(ui, material);
            facets(ui, material);
            let slider = Slider::new(&mut material.facet_spread, 1e-4..=0.5).logarithmic(true);
            ui.add(slider.text("spread of a facet, radians"));
            ui.add(Slider::new(&mut material.sky_spread, 0.0..=0.5).text("spread under an environment, radians"));
            switch(ui, material, IN_SPACE, "facets in space, not in uv");
        }
        Method::AreaLight => {
            base_roughness(ui, material);
            ui.add(Slider::new(&mut material.lobes, 0..=9).text("lobes by direction (0: round)"));
            texels(ui, material);
        }
        Method::PlainLtc => {
            base_roughness(ui, material);
            texels(ui, material);
        }
        Method::Textures | Method::PlainTextures => texels(ui, material),
    }
}

fn roughness(ui: &mut Ui, material: &mut Material) {
    for (alpha, axis) in material.alpha.iter_mut().zip(["tangent", "bitangent"]) {
        ui.add(Slider::new(alpha, 0.001..=1.0).logarithmic(true).text(format!("roughness α, {axis}")));
    }
    ui.horizontal(|ui| {
        ui.radio_value(&mut material.normal_target, 0, "Beckmann");
        ui.radio_value(&mut material.normal_target, 1, "GGX");
    });
}

fn base_roughness(ui: &mut Ui, material: &mut Material) {
    ui.add(Slider::new(&mut material.alpha[0], 0.001..=1.0).logarithmic(true).text("base roughness α"));
}

fn facets(ui: &mut Ui, material: &mut Material) {
    ui.add(Slider::new(&mut material.density, 1.0..=1.0e12).logarithmic(true).text("facets / unit²"));
    ui.add(Slider::new(&mut material.relative_area, 0.0..=1.0).text("relative area β"));
    ui.horizontal(|ui| {
        ui.add(egui::DragValue::new(&mut material.seed));
        ui.label("seed");
    });
}

fn switch(ui: &mut Ui, material: &mut Material, bit: u32, label: &str) {
    let mut on = material.switches & bit != 0;
    if ui.checkbox(&mut on, label).changed() {
        material.switches ^= bit;
    }
}

fn texels(ui: &mut Ui, material: &mut Material) {
    ui.add(Slider::new(&mut material.texels_per_unit, 1.0..=65_536.0).logarithmic(true).text("texels / unit"));
}

fn comparison(ui: &mut Ui, controls: &mut Controls, settings: &mut Settings, list: &[Subject]) {
    ui.horizontal_wrapped(|ui| {
        for (mode, label) in
            [(Mode::None, "none"), (Mode::Split, "split"), (Mode::Ab, "A/B (space)"), (Mode::Error, "error")]
        {
            ui.radio_value(&mut controls.mode, mode, label);
        }
    });
    let chosen = match controls.against {
        Against::Other(index) => list.get(index).map_or_else(String::new, name),
        Against::Reference | Against::Nothing => "its reference".to_owned(),
    };
    egui::ComboBox::from_label("against").selected_text(chosen).show_ui(ui, |ui| {
        ui.selectable_value(&mut controls.against, Against::Reference, "its reference");
        for (index, shown) in list.iter().enumerate() {
            ui.selectable_value(&mut controls.against, Against::Other(index), name(shown));
        }
    });
    match controls.mode {
        Mode::None => {}
        Mode::Split => {
            ui.add(Slider::new(&mut controls.split, 0.0..=1.0).text("line"));
        }
        Mode::Ab => {
            ui.horizontal(|ui| {
                ui.radio_value(&mut controls.showing_b, false, "A, the method");
                ui.radio_value(&mut controls.showing_b, true, "B, the other");
            });
        }
        Mode::Error => {
            ui.label("relative difference: 0 blue to 1 red");
        }
    }
    ui.checkbox(&mut settings.vary_seed, "mean over seeds");
}

fn display(ui: &mut Ui, settings: &mut Settings) {
    ui.add(Slider::new(&mut settings.exposure_stops, -10.0..=10.0).text("exposure, stops"));
    ui.horizontal(|ui| {
        ui.radio_value(&mut settings.tone, ToneMapping::Filmic, "filmic");
        ui.radio_value(&mut settings.tone, ToneMapping::Linear, "linear");
    });
    egui::ComboBox::from_label("overlay (O)").selected_text(overlay_name(settings.overlay)).show_ui(ui, |ui| {
        for overlay in [Overlay::None, Overlay::Footprint, Overlay::Lod, Overlay::Loads, Overlay::Operations] {
            ui.selectable_value(&mut settings.overlay, overlay, overlay_name(overlay));
        }
    });
    let [low, high] = settings.overlay.range();
    match settings.overlay {
        Overlay::None => {}
        Overlay::Footprint => {
            ui.label(format!("σ in texels: {} blue to {} red", low.exp2(), high.exp2()));
        }
        Overlay::Lod => {
            ui.label(format!("level {low} (finest) blue to {high} red"));
        }
        Overlay::Loads => {
            ui.label(format!("look-ups a pixel: {} blue to {} red", low.exp2() - 1.0, high.exp2() - 1.0));
        }
        Overlay::Operations => {
            ui.label(format!("operations a pixel: {} blue to {} red", low.exp2() - 1.0, high.exp2() - 1.0));
        }
    }
    ui.checkbox(&mut settings.antialias, "smooth edges, mean over frames");
}

fn overlay_name(overlay: Overlay) -> &'static str {
    match overlay {
        Overlay::None => "none",
        Overlay::Footprint => "footprint",
        Overlay::Lod => "level of detail",
        Overlay::Loads => "look-ups",
        Overlay::Operations => "operations",
    }
}

fn camera(ui: &mut Ui, controls: &Controls, settings: &mut Settings, facts: &Facts) -> Option<Action> {
    let mut action = None;
    for (index, mesh) in facts.meshes.iter().enumerate() {
        if ui.radio(controls.mesh == index, mesh).clicked() {
            action = Some(Action::Mesh(index));
        }
    }
    if ui.button("Fit to the mesh (F)").clicked() {
        action = Some(Action::Frame);
    }
    let mut degrees = settings.camera.field_of_view.to_degrees();
    if ui.add(Slider::new(&mut degrees, 5.0..=100.0).text("field of view, degrees")).changed() {
        settings.camera.field_of_view = degrees.to_radians();
    }
    // What --camera takes, to be copied.
    let text = settings.camera.placement().to_string();
    ui.label(format!("--camera {text}"));
    if ui.button("Copy").clicked() {
        ui.ctx().copy_text(text);
    }
    ui.label("left drag orbits, right drag pans, wheel zooms to the mouse");
    action
}

fn frame(ui: &mut Ui, facts: &Facts) {
    ui.label(&facts.adapter);
    ui.label(format!("{} × {} pixels, {} frames in the mean", facts.size[0], facts.size[1], facts.frames));
    match &facts.passes {
        None => {
            ui.label("pass times: the adapter has no timestamps");
        }
        Some(passes) => {
            egui::Grid::new("passes").show(ui, |ui| {
                for (pass, seconds) in passes {
                    ui.label(*pass);
                    ui.label(format!("{:.2} ms", 1e3 * seconds));
                    ui.end_row();
                }
            });
        }
    }
    for note in &facts.notes {
        ui.label(note);
    }
}
