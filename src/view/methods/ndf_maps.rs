//! NDF maps on the GPU: which sections of a pack `bind_ndf_maps.wgsl` binds, and for what its programs are made.

use crate::gpu::{Gpu, GpuError, Resources, bind_parts};
use glint_formats::ndf_maps::{BINDINGS, COAT_BINDINGS, LAYERS_BINDINGS, MaterialUniform};
use glint_formats::{Pack, Wrap};

/// Binds the material `base` of a pack, or that and the coat over it: the names of the coat's material and of the two-layer material.
///
/// # Errors
/// [`GpuError::BadPack`] for a section that is damaged, or larger than the device binds.
pub fn bind(gpu: &Gpu, pack: &Pack, base: &str, coat: Option<(&str, &str)>) -> Result<Resources, GpuError> {
    let (coat, layers) = coat.unzip();
    let parts = [(Some(base), BINDINGS), (coat, COAT_BINDINGS), (layers, LAYERS_BINDINGS)];
    bind_parts(gpu, pack, &parts, Wrap::Repeat)
}

/// Pipeline constants that follow from the data: `NDF_MAPS_LAYERED` and, where layers share it, `NDF_MAPS_CELLS`.
pub fn constants(base: &MaterialUniform, coat: Option<&MaterialUniform>) -> Vec<(&'static str, f64)> {
    let mut constants = vec![("NDF_MAPS_LAYERED", f64::from(u8::from(coat.is_some())))];
    if coat.is_none_or(|coat| coat.cells == base.cells) {
        constants.push(("NDF_MAPS_CELLS", f64::from(base.cells)));
    }
    constants
}
