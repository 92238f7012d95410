//! The loop of events: draws when something changed, and goes on when surface or device are lost.

use super::controls::{Action, Controls, Press};
use super::interface::Interface;
use super::panel::{self, Facts};
use super::stage::{Load, Recovery, Stage};
use super::surface::{Acquired, Surface};
use crate::gpu::{GpuError, Wish};
use crate::render::{Picture, Shown};
use crate::scene::{Mesh, Orbit};
use crate::settings::Settings;
use glam::Vec2;
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Window, WindowId};

/// Time to the next try where a surface gave nothing to draw to.
const PAUSE: Duration = Duration::from_millis(50);
/// Tries for a surface in a row that may fail.
const MAX_TRIES: u32 = 100;

/// Settings that the window opens with, for what can be shown and a camera that sees all of the first mesh; or what is wrong
/// with the user's wishes.
pub type Prepare = Box<dyn FnOnce(&[Shown], Orbit) -> Result<Settings, String>>;
/// Saves a picture; what it did, or why it could not.
pub type Save = Box<dyn FnMut(&Picture) -> Result<String, String>>;

/// What a window shows, and what it is to be told.
pub struct Start {
    /// Title of the window.
    pub title: String,
    /// Pixels of the picture.
    pub size: [u32; 2],
    /// Which adapter.
    pub wish: Wish,
    /// Meshes to choose from with their names, at least one.
    pub meshes: Vec<(String, Mesh)>,
    /// Brings the data to a device.
    pub load: Load,
    /// Chooses the settings that the window opens with.
    pub prepare: Prepare,
    /// Saves a screenshot; the text (or the error) is shown in the panel.
    pub save: Save,
    /// For tests.
    pub hooks: Hooks,
}

/// What tests ask for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hooks {
    /// Ends after this many frames, which then follow each other without a pause.
    pub frames: Option<u32>,
    /// Frames before which the device is lost.
    pub lose_device_at: Vec<u32>,
}

/// Why a window ended.
#[derive(Debug, thiserror::Error)]
pub enum WindowError {
    /// There is no display, or it refuses windows.
    #[error("no window can be opened: {0}; use --headless FILE.png to draw without one")]
    NoWindow(String),
    /// The user asked for something that is not there.
    #[error("{0}")]
    Settings(String),
    /// Device or data failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// Opens a window and returns when it is closed.
pub fn run(start: Start) -> Result<(), WindowError> {
    let no_window = |error: winit::error::EventLoopError| WindowError::NoWindow(error.to_string());
    let events = EventLoop::new().map_err(no_window)?;
    let prepare = Some(start.prepare);
    let mut app = App {
        title: start.title,
        size: start.size,
        wish: start.wish,
        meshes: start.meshes,
        load: start.load,
        save: start.save,
        hooks: start.hooks,
        prepare,
        open: None,
        set: None,
        recovery: Recovery::default(),
        drawn: 0,
        tries: 0,
        wake: None,
        error: None,
    };
    events.run_app(&mut app).map_err(no_window)?;
    app.error.map_or(Ok(()), Err)
}

struct App {
    title: String,
    size: [u32; 2],
    wish: Wish,
    meshes: Vec<(String, Mesh)>,
    load: Load,
    save: Save,
    hooks: Hooks,
    prepare: Option<Prepare>,
    open: Option<Open>,
    set: Option<(Settings, Controls)>,
    recovery: Recovery,
    /// Frames that were shown.
    drawn: u32,
    /// Tries for a surface since the last frame.
    tries: u32,
    /// When to draw again although nothing happened.
    wake: Option<Instant>,
    error: Option<WindowError>,
}

/// The window and all that lives on the device. The interface and the surface are dropped before the device.
struct Open {
    interface: Interface,
    surface: Surface,
    stage: Stage,
    window: Arc<Window>,
}

impl App {
    /// Device, surface and data for a window, the first time or after a loss.
    fn open(&mut self, events: &ActiveEventLoop, window: Arc<Window>) -> Result<(), WindowError> {
        let (gpu, surface) = Surface::new(&window, events.owned_display_handle(), &self.wish)?;
        let mesh = self.set.as_ref().map_or(0, |(_, controls)| controls.mesh);
        let Some((_, mesh)) = self.meshes.get(mesh) else {
            return Err(GpuError::BadPack("there is no mesh to show".to_owned()).into());
        };
        let stage = Stage::new(gpu, &mut self.load, mesh)?;
        if self.set.is_none() {
            let camera = Orbit::fit(mesh.bounds());
            let settings = match self.prepare.take() {
                Some(prepare) => prepare(&stage.list, camera).map_err(WindowError::Settings)?,
                None => Settings::new(&stage.list, camera),
            };
            let controls = Controls::of(&settings);
            self.set = Some((settings, controls));
        }
        let interface = Interface::new(&stage.gpu, &window, surface.format());
        window.request_redraw();
        self.open = Some(Open { interface, surface, stage, window });
        Ok(())
    }

    /// Ends the loop with an error.
    fn fail(&mut self, events: &ActiveEventLoop, error: WindowError) {
        self.error = Some(error);
        events.exit();
    }

    /// Draws a frame; for tests, loses the device before it.
    fn redraw(&mut self, events: &ActiveEventLoop) {
        if let Some(open) = self.open.as_ref().filter(|_| self.hooks.lose_device_at.contains(&self.drawn)) {
            open.stage.gpu.device.destroy();
            self.hooks.lose_device_at.retain(|&frame| frame != self.drawn);
        }
        if let Err(error) = self.frame(events) {
            self.recover(events, error);
        }
    }

    /// Goes on with a new device where the old one was lost, ends otherwise.
    fn recover(&mut self, events: &ActiveEventLoop, error: GpuError) {
        let Some(Open { interface, surface, stage, window }) = self.open.take() else { return };
        let verdict = self.recovery.lost(&stage.gpu, error);
        // A window has one surface at a time.
        drop((interface, surface, stage));
        let opened = verdict.map_err(WindowError::Gpu).and_then(|()| self.open(events, window));
        match opened {
            Ok(()) => {
                if let Some((_, controls)) = &mut self.set {
                    controls.message = "The device was lost; this is a new one.".to_owned();
                }
            }
            Err(error) => self.fail(events, error),
        }
    }

    fn frame(&mut self, events: &ActiveEventLoop) -> Result<(), GpuError> {
        let (Some(open), Some((settings, controls))) = (&mut self.open, &mut self.set) else { return Ok(()) };
        let window_size: [u32; 2] = open.window.inner_size().into();
        if window_size.contains(&0) {
            return Ok(());
        }
        open.surface.resize(&open.stage.gpu, window_size);
        let target = match open.surface.acquire(&open.stage.gpu, &open.window)? {
            Acquired::Texture(texture) => texture,
            Acquired::Later => {
                self.wake = Some(Instant::now() + PAUSE);
                return Ok(());
            }
            Acquired::Again => {
                self.tries += 1;
                if self.tries > MAX_TRIES {
                    return Err(GpuError::Failed(format!(
                        "the window's surface was renewed {MAX_TRIES} times in vain"
                    )));
                }
                open.window.request_redraw();
                return Ok(());
            }
        };
        self.tries = 0;
        let size = open.surface.size();
        let stage = &mut open.stage;
        let facts = Facts {
            adapter: stage.gpu.adapter_line(),
            notes: stage.notes.iter().chain(&self.meshes[controls.mesh].1.notes).cloned().collect(),
            meshes: self.meshes.iter().map(|(name, _)| name.clone()).collect(),
            size,
            frames: stage.renderer.frames(),
            passes: if controls.times { stage.renderer.pass_seconds(&stage.gpu)? } else { None },
        };
        let mut action = None;
        let shapes = open.interface.run(&stage.gpu, &open.window, |context| {
            // egui may run this twice a frame.
            action = panel::show(context, controls, settings, &stage.list, &facts).or(action);
        });
        controls.apply(settings);
        let renewed = stage.wants_frame(settings, size) && stage.draw(settings, size)?;
        if let Some(picture) = stage.target().filter(|_| renewed) {
            open.interface.set_picture(&stage.gpu, picture);
        }
        self.wake = Instant::now().checked_add(shapes.repaint_after);
        let view = target.texture.create_view(&Default::default());
        open.interface.draw(&stage.gpu, &view, size, shapes);
        open.window.pre_present_notify();
        stage.gpu.queue.present(target);
        if let Some(error) = stage.gpu.lost() {
            return Err(error);
        }
        self.recovery.frame();
        self.drawn += 1;
        let ends = self.hooks.frames.is_some_and(|frames| self.drawn >= frames);
        if self.hooks.frames.is_some() || stage.wants_frame(settings, size) {
            open.window.request_redraw();
        }
        if ends {
            events.exit();
        } else if let Some(action) = action {
            self.act(events, action)?;
        }
        Ok(())
    }

    fn act(&mut self, events: &ActiveEventLoop, action: Action) -> Result<(), GpuError> {
        let (Some(open), Some((settings, controls))) = (&mut self.open, &mut self.set) else { return Ok(()) };
        match action {
            Action::Quit => events.exit(),
            Action::Frame => settings.camera = Orbit::fit(self.meshes[controls.mesh].1.bounds()),
            Action::Mesh(index) => {
                controls.mesh = index;
                open.stage.set_mesh(&self.meshes[index].1);
                settings.camera = Orbit::fit(self.meshes[index].1.bounds());
            }
            Action::Save => {
                if let Some(picture) = open.stage.picture()? {
                    controls.message = (self.save)(&picture).unwrap_or_else(|error| error);
                }
            }
        }
        open.window.request_redraw();
        Ok(())
    }

    /// Keys and mouse, where the panel did not take them.
    fn input(&mut self, events: &ActiveEventLoop, event: &WindowEvent) {
        let (Some(open), Some((settings, controls))) = (&mut self.open, &mut self.set) else { return };
        let [width, height] = open.surface.size();
        let size = Vec2::new(width as f32, height as f32);
        let before = settings.clone();
        let mut action = None;
        match event {
            WindowEvent::KeyboardInput { event, .. } if !open.interface.takes_keys() => {
                let Some(press) = pressed(event) else { return };
                action = controls.press(press, settings);
                open.window.request_redraw();
            }
            WindowEvent::CursorMoved { position, .. } => {
                controls.moved(Vec2::new(position.x as f32, position.y as f32), size, &mut settings.camera);
            }
            WindowEvent::MouseInput { state: ElementState::Pressed, button, .. } => match button {
                MouseButton::Left => controls.grab(true, size),
                MouseButton::Right | MouseButton::Middle => controls.grab(false, size),
                _ => {}
            },
            WindowEvent::MouseWheel { delta, .. } => {
                let notches = match delta {
                    MouseScrollDelta::LineDelta(_, lines) => *lines,
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y as f32 / 50.0,
                };
                controls.wheel(notches, size, &self.meshes[controls.mesh].1, &mut settings.camera);
            }
            _ => {}
        }
        controls.apply(settings);
        if *settings != before {
            open.window.request_redraw();
        }
        if let Some(Err(error)) = action.map(|action| self.act(events, action)) {
            self.recover(events, error);
        }
    }
}

/// What a key that went down means here.
fn pressed(event: &KeyEvent) -> Option<Press> {
    if event.state != ElementState::Pressed || event.repeat {
        return None;
    }
    match &event.logical_key {
        Key::Named(NamedKey::Escape) => Some(Press::Quit),
        Key::Named(NamedKey::Space) => Some(Press::Toggle),
        Key::Character(text) => Press::of_character(text),
        _ => None,
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        let [width, height] = self.size;
        let attributes =
            Window::default_attributes().with_title(&self.title).with_inner_size(PhysicalSize::new(width, height));
        let window = events.create_window(attributes).map_err(|error| WindowError::NoWindow(error.to_string()));
        if let Err(error) = window.and_then(|window| self.open(events, Arc::new(window))) {
            self.fail(events, error);
        }
    }

    fn new_events(&mut self, _events: &ActiveEventLoop, cause: StartCause) {
        let due = matches!(cause, StartCause::ResumeTimeReached { .. })
            && self.wake.is_some_and(|wake| wake <= Instant::now());
        if let Some(open) = self.open.as_ref().filter(|_| due) {
            self.wake = None;
            open.window.request_redraw();
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _window: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        match event {
            WindowEvent::CloseRequested => return events.exit(),
            WindowEvent::RedrawRequested => return self.redraw(events),
            WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. } | WindowEvent::Occluded(false) => {
                open.window.request_redraw();
            }
            WindowEvent::MouseInput { state: ElementState::Released, .. } => {
                if let Some((_, controls)) = &mut self.set {
                    controls.release();
                }
            }
            _ => {}
        }
        let response = open.interface.event(&open.window, &event);
        if response.repaint {
            open.window.request_redraw();
        }
        if !response.consumed {
            self.input(events, &event);
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        events.set_control_flow(self.wake.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }
}
