//! The window: a picture of the scene with a panel over it, mouse and keys. The program around it brings the data.
//!
//! - `stage`: device, what is shown, renderer and the picture; knows nothing of windows and is made anew when the device is
//!   lost.
//! - `controls`: what keys and the panel set beyond [`crate::settings::Settings`].
//! - `panel`, `lights`: the panel.
//! - `interface`: egui between the window and the device.
//! - `surface`: what is drawn to. `app`: the loop of events.

mod app;
mod controls;
mod interface;
mod lights;
mod panel;
mod stage;
mod surface;

pub use app::{Hooks, Prepare, Save, Start, WindowError, run};
pub use stage::{Load, Loaded};
