//! The lights' part of the panel.

use crate::render::{MAX_POINT_LIGHTS, PointLight};
use crate::settings::LightSettings;
use egui::{DragValue, Slider, Ui};
use glam::Vec3;

/// Switches and parameters of all lights.
pub(super) fn show(ui: &mut Ui, lights: &mut LightSettings) {
    ui.checkbox(&mut lights.sun_on, "directional");
    if lights.sun_on {
        direction(ui, &mut lights.sun.direction);
        strength(ui, &mut lights.sun.irradiance, "irradiance");
        let slider = Slider::new(&mut lights.sun.solid_angle_sr, 1e-6..=0.1).logarithmic(true);
        ui.add(slider.text("solid angle, steradians"));
    }
    ui.checkbox(&mut lights.points_on, "points");
    if lights.points_on {
        points(ui, &mut lights.points);
    }
    ui.checkbox(&mut lights.rect_on, "rectangle");
    if lights.rect_on {
        rectangle(ui, &mut lights.rect.corners);
        strength(ui, &mut lights.rect.radiance, "radiance");
        ui.checkbox(&mut lights.rect.two_sided, "two-sided");
    }
    ui.checkbox(&mut lights.environment_on, "environment");
    if lights.environment_on {
        ui.add(
            Slider::from_get_set(-180.0..=180.0, |degrees| {
                if let Some(degrees) = degrees {
                    lights.environment.turn = degrees.to_radians() as f32;
                }
                f64::from(lights.environment.turn.to_degrees())
            })
            .text("turn, degrees"),
        );
        ui.add(Slider::new(&mut lights.environment.gain, 0.001..=1000.0).logarithmic(true).text("gain"));
    }
}

/// Azimuth (0 on +z, 90 on +x) and elevation of a direction.
fn direction(ui: &mut Ui, direction: &mut Vec3) {
    let unit = direction.normalize_or(Vec3::Y);
    let mut azimuth = unit.x.atan2(unit.z).to_degrees();
    let mut elevation = unit.y.clamp(-1.0, 1.0).asin().to_degrees();
    let turned = ui.add(Slider::new(&mut azimuth, -180.0..=180.0).text("azimuth, degrees")).changed();
    // At ±90 the azimuth would be forgotten.
    let raised = ui.add(Slider::new(&mut elevation, -89.9..=89.9).text("elevation, degrees")).changed();
    if turned || raised {
        let (azimuth, elevation) = (azimuth.to_radians(), elevation.to_radians());
        *direction = Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
    }
}

/// Colour and size of a linear RGB value: the largest of the three, and the three in its units.
fn strength(ui: &mut Ui, value: &mut Vec3, label: &str) {
    let mut most = value.max_element();
    let mut colour = if most > 0.0 { (*value / most).to_array() } else { [1.0; 3] };
    ui.horizontal(|ui| {
        let coloured = ui.color_edit_button_rgb(&mut colour).changed();
        let scaled = ui.add(Slider::new(&mut most, 0.01..=10_000.0).logarithmic(true).text(label)).changed();
        if coloured || scaled {
            *value = Vec3::from(colour) * most;
        }
    });
}

/// Three coordinates to be dragged.
fn place(ui: &mut Ui, place: &mut Vec3, label: &str) -> bool {
    ui.horizontal(|ui| {
        let mut changed = false;
        for axis in place.as_mut() {
            changed |= ui.add(DragValue::new(axis).speed(0.02)).changed();
        }
        ui.label(label);
        changed
    })
    .inner
}

fn points(ui: &mut Ui, points: &mut Vec<PointLight>) {
    let mut removed = None;
    for (index, light) in points.iter_mut().enumerate() {
        ui.push_id(index, |ui| {
            place(ui, &mut light.position, "position");
            strength(ui, &mut light.intensity, "intensity");
            ui.add(DragValue::new(&mut light.radius).speed(0.005).range(0.0..=1e3).prefix("radius "));
            if ui.button("Remove").clicked() {
                removed = Some(index);
            }
        });
    }
    if let Some(index) = removed {
        points.remove(index);
    }
    if points.len() < MAX_POINT_LIGHTS && ui.button("Add a point").clicked() {
        let position = points.last().map_or(Vec3::new(0.0, 1.0, 0.0), |light| light.position + 0.3 * Vec3::X);
        points.push(PointLight { position, intensity: Vec3::ONE, radius: 0.02 });
    }
}

/// Middle and edges of a parallelogram.
fn rectangle(ui: &mut Ui, corners: &mut [Vec3; 4]) {
    let mut middle = corners.iter().sum::<Vec3>() * 0.25;
    let (mut width, mut height) = (corners[1] - corners[0], corners[3] - corners[0]);
    let moved = place(ui, &mut middle, "middle");
    let wider = place(ui, &mut width, "edge");
    let higher = place(ui, &mut height, "other edge");
    if moved || wider || higher {
        let first = middle - 0.5 * (width + height);
        *corners = [first, first + width, first + width + height, first + height];
    }
}
