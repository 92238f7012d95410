//! The image with the hardest sun, baked as by default, against sums over all its pixels. The report has all images.

#[path = "real_maps/folder.rs"]
mod folder;

use glint_bake::input::environment::load_environment;
use glint_bake_core::environment::image::luminance;
use glint_bake_core::environment::{EnvironmentOptions, bake, quality};
use glint_bake_core::progress::Silent;

#[test]
fn a_noon_sun_keeps_to_the_error_asked_in_every_mip() {
    let Some(data) = folder::data() else { return };
    let loaded = load_environment(&data.join("hdri/noon_grass_1k.hdr"), None, 1 << 30).unwrap();
    let options = EnvironmentOptions { measured_texels: 0, ..EnvironmentOptions::default() };
    let environment = bake(&loaded.image, &options, &Silent).unwrap();
    let params = &environment.params;
    assert!(params.measured.energy < 1e-3);
    let mean = luminance(loaded.image.mean());
    for mip in 0..params.mips() {
        let error = quality::error_of(&quality::compare(&loaded.image, &environment, mip, 24), mean);
        let (rmse, worst) = if params.roughness[mip as usize] < 0.04 { (0.02, 0.25) } else { (0.005, 0.05) };
        assert!(error.rmse <= rmse && error.worst <= worst, "mip {mip}: {error:?}");
        assert!(params.measured.rounding[mip as usize] <= 0.5 * rmse, "mip {mip}: {:?}", params.measured.rounding);
    }
}
