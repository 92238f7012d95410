//! Comparison, keys and mouse: what a user sets beyond [`Settings`], and how it becomes part of them.

use crate::render::Overlay;
use crate::scene::{Mesh, Orbit};
use crate::settings::{Against, Layout, Settings};
use glam::Vec2;

/// How two sides are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Mode {
    /// One side alone.
    #[default]
    None,
    /// Left and right of a line.
    Split,
    /// In turn.
    Ab,
    /// Relative difference.
    Error,
}

/// What is asked of the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Action {
    /// Fit the camera to the mesh.
    Frame,
    /// Show another mesh.
    Mesh(usize),
    /// Save the picture.
    Save,
    /// End.
    Quit,
}

/// Keys that mean something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Press {
    /// 1 to 9: the method of this index.
    Method(usize),
    /// Space: A or B.
    Toggle,
    /// R: the reference in the method's place.
    Reference,
    /// O: next overlay.
    Overlay,
    /// F: fit the camera.
    Frame,
    /// H: panel on or off.
    Hide,
    /// S: save a screenshot.
    Save,
    /// Escape or Q.
    Quit,
}

impl Press {
    /// The meaning of a key, by the character that it types.
    pub fn of_character(text: &str) -> Option<Press> {
        match text {
            " " => Some(Press::Toggle),
            "r" | "R" => Some(Press::Reference),
            "o" | "O" => Some(Press::Overlay),
            "f" | "F" => Some(Press::Frame),
            "h" | "H" => Some(Press::Hide),
            "s" | "S" => Some(Press::Save),
            "q" | "Q" => Some(Press::Quit),
            _ => match text.parse() {
                Ok(number @ 1..=9) => Some(Press::Method(number - 1)),
                _ => None,
            },
        }
    }
}

/// State of panel, keys and mouse.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Controls {
    /// How two sides are compared.
    pub mode: Mode,
    /// With what.
    pub against: Against,
    /// Whether B of A and B is shown.
    pub showing_b: bool,
    /// Place of the line between two sides, as a share of the width.
    pub split: f32,
    /// Whether the panel is shown.
    pub panel: bool,
    /// Whether frame times are taken: that waits for the device.
    pub times: bool,
    /// Index of the mesh.
    pub mesh: usize,
    /// What was done last.
    pub message: String,
    drag: Option<Drag>,
    mouse: Vec2,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Drag {
    Orbit,
    Pan,
    Split,
}

/// Pixels beside the line between two sides where it can be taken.
const GRIP: f32 = 6.0;

impl Controls {
    /// The controls that show what `settings` say.
    pub fn of(settings: &Settings) -> Controls {
        let (mode, split) = match (settings.against, settings.layout) {
            (Against::Nothing, _) => (Mode::None, 0.5),
            (_, Layout::Split(at)) => (Mode::Split, at),
            (_, Layout::Swapped) => (Mode::Ab, 0.5),
            (_, Layout::Error) => (Mode::Error, 0.5),
        };
        let against = if mode == Mode::None { Against::Reference } else { settings.against };
        Controls {
            mode,
            against,
            showing_b: mode == Mode::Ab,
            split,
            panel: true,
            times: false,
            mesh: 0,
            message: String::new(),
            drag: None,
            mouse: Vec2::ZERO,
        }
    }

    /// Writes the comparison into `settings`.
    pub fn apply(&self, settings: &mut Settings) {
        (settings.against, settings.layout) = match self.mode {
            Mode::None => (Against::Nothing, settings.layout),
            Mode::Split => (self.against, Layout::Split(self.split)),
            Mode::Ab if self.showing_b => (self.against, Layout::Swapped),
            Mode::Ab => (Against::Nothing, Layout::Swapped),
            Mode::Error => (self.against, Layout::Error),
        };
    }

    /// What a key does.
    pub fn press(&mut self, press: Press, settings: &mut Settings) -> Option<Action> {
        match press {
            Press::Method(index) if index < settings.materials.len() => settings.shown = index,
            Press::Method(_) => {}
            Press::Toggle => {
                self.showing_b = self.mode != Mode::Ab || !self.showing_b;
                self.mode = Mode::Ab;
            }
            Press::Reference => settings.reference = !settings.reference,
            Press::Overlay => {
                settings.overlay = match settings.overlay {
                    Overlay::None => Overlay::Footprint,
                    Overlay::Footprint => Overlay::Lod,
                    Overlay::Lod => Overlay::Loads,
                    Overlay::Loads => Overlay::Operations,
                    Overlay::Operations => Overlay::None,
                }
            }
            Press::Hide => self.panel = !self.panel,
            Press::Frame => return Some(Action::Frame),
            Press::Save => return Some(Action::Save),
            Press::Quit => return Some(Action::Quit),
        }
        None
    }

    /// A mouse button went down in a picture of `size`: the `primary` one orbits or takes the line, another pans.
    pub fn grab(&mut self, primary: bool, size: Vec2) {
        let at_line = self.mode == Mode::Split && (self.mouse.x - self.split * size.x).abs() <= GRIP;
        self.drag = Some(match primary {
            true if at_line => Drag::Split,
            true => Drag::Orbit,
            false => Drag::Pan,
        });
    }

    /// The mouse button went up.
    pub fn release(&mut self) {
        self.drag = None;
    }

    /// The mouse is at `place` now.
    pub fn moved(&mut self, place: Vec2, size: Vec2, camera: &mut Orbit) {
        let by = place - self.mouse;
        self.mouse = place;
        match self.drag {
            None => {}
            Some(Drag::Orbit) => camera.orbit(by, size),
            Some(Drag::Pan) => camera.pan(by, size),
            Some(Drag::Split) => self.split = (place.x / size.x.max(1.0)).clamp(0.0, 1.0),
        }
    }

    /// The wheel turned by `notches`, upwards to go nearer to what is under the mouse.
    pub fn wheel(&mut self, notches: f32, size: Vec2, mesh: &Mesh, camera: &mut Orbit) {
        let seen = mesh.hit(camera.position(), camera.ray(self.mouse, size));
        camera.zoom((-0.15 * notches.clamp(-20.0, 20.0)).exp(), seen);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Material;
    use crate::settings::LightSettings;

    fn settings() -> Settings {
        let mut settings = Settings::new(&[], Orbit::fit(Mesh::sphere(4).bounds()));
        settings.materials = vec![Material::default(); 3];
        settings.lights = LightSettings::for_camera(&settings.camera);
        settings
    }

    fn press(controls: &mut Controls, settings: &mut Settings, text: &str) -> Option<Action> {
        let action = Press::of_character(text).and_then(|press| controls.press(press, settings));
        controls.apply(settings);
        action
    }

    #[test]
    fn each_key_does_its_work() {
        let mut settings = settings();
        let mut controls = Controls::of(&settings);
        let c = &mut controls;
        assert_eq!(press(c, &mut settings, "3"), None);
        assert_eq!(settings.shown, 2);
        press(c, &mut settings, "9");
        assert_eq!(settings.shown, 2, "there is no ninth method");
        press(c, &mut settings, "r");
        assert!(settings.reference);
        for overlay in [Overlay::Footprint, Overlay::Lod, Overlay::Loads, Overlay::Operations, Overlay::None] {
            press(c, &mut settings, "o");
            assert_eq!(settings.overlay, overlay);
        }
        press(c, &mut settings, "H");
        assert!(!c.panel);
        for (key, action) in [("f", Action::Frame), ("s", Action::Save), ("q", Action::Quit)] {
            assert_eq!(press(c, &mut settings, key), Some(action));
        }
        for key in ["0", "x", "", "10", "é"] {
            assert_eq!(Press::of_character(key), None);
        }
    }

    #[test]
    fn space_toggles_between_a_and_b() {
        let mut settings = settings();
        let mut controls = Controls::of(&settings);
        controls.against = Against::Other(1);
        for shown in [Against::Other(1), Against::Nothing, Against::Other(1)] {
            press(&mut controls, &mut settings, " ");
            assert_eq!((settings.against, settings.layout), (shown, Layout::Swapped));
        }
    }

    #[test]
    fn a_comparison_is_kept_over_settings_and_back() {
        for (against, layout) in [
            (Against::Other(2), Layout::Split(0.3)),
            (Against::Reference, Layout::Error),
            (Against::Other(0), Layout::Swapped),
            (Against::Nothing, Layout::Split(0.5)),
        ] {
            let mut settings = settings();
            (settings.against, settings.layout) = (against, layout);
            let before = settings.clone();
            Controls::of(&settings).apply(&mut settings);
            assert_eq!(settings, before);
        }
    }

    #[test]
    fn the_mouse_orbits_pans_zooms_and_moves_the_line() {
        let (mut settings, mesh, size) = (settings(), Mesh::sphere(4), Vec2::new(200.0, 100.0));
        let mut controls = Controls::of(&settings);
        let start = settings.camera;
        let camera = &mut settings.camera;
        controls.moved(Vec2::new(50.0, 50.0), size, camera);
        assert_eq!(*camera, start, "nothing is held");
        controls.grab(true, size);
        controls.moved(Vec2::new(60.0, 50.0), size, camera);
        assert!(camera.azimuth != start.azimuth && camera.target == start.target);
        controls.grab(false, size);
        controls.moved(Vec2::new(70.0, 50.0), size, camera);
        assert!(camera.target != start.target);
        controls.release();
        let distance = camera.distance;
        controls.moved(Vec2::new(100.0, 50.0), size, camera);
        controls.wheel(1.0, size, &mesh, camera);
        assert!(camera.distance < distance);
        controls.mode = Mode::Split;
        controls.grab(true, size);
        controls.moved(Vec2::new(150.0, 50.0), size, camera);
        assert_eq!(controls.split, 0.75);
    }
}
