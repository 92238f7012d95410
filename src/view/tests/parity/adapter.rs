//! The adapter of the tests.

use glint_view::gpu::{AdapterChoice, Gpu};
use std::sync::OnceLock;

/// The device, or nothing where there is none and none is required.
pub fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    let gpu = GPU.get_or_init(|| match Gpu::headless(&AdapterChoice::default()) {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var_os("GLINT_REQUIRE_ADAPTER").is_some_and(|v| v == "1") => panic!("{error}"),
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    });
    gpu.as_ref()
}
