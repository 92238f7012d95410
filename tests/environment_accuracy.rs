//! The image with the hardest sun, baked as by default, against sums over all its pixels. The report has all images.

#[path = "real_maps/folder.rs"]
mod folder;

use glint_bake::input::environment::load_environment;
use glint_bake_core::environment::image::luminance;
use glint_bake_core::environment::{EnvironmentOptions, LevelCount, bake, quality, reads};
use glint_bake_core::progress::Silent;

#[test]
fn a_noon_sun_keeps_to_the_error_asked_in_every_roughness_and_between_them() {
    let Some(data) = folder::data() else { return };
    let loaded = load_environment(&data.join("hdri/noon_grass_1k.hdr"), None, 1 << 30).unwrap();
    // Levels are not looked at.
    let levels = LevelCount::Exactly(1);
    let options = EnvironmentOptions { levels, measured_reads: 0, ..EnvironmentOptions::default() };
    let environment = bake(&loaded.image, &options, &Silent).unwrap();
    let params = &environment.params;
    assert!(params.measured.energy < 1e-3);
    let mean = luminance(loaded.image.mean());
    for index in 0..=params.filtered() {
        let error = quality::error_of(&quality::compare(&loaded.image, &environment, index, 8), mean);
        let (rmse, worst) = if params.roughness[index as usize] < 0.04 { (0.02, 0.25) } else { (0.005, 0.05) };
        assert!(error.rmse <= rmse && error.worst <= worst, "roughness {index}: {error:?}");
        let rounding = params.measured.rounding[index as usize];
        assert!(rounding <= 0.5 * rmse, "roughness {index}: {rounding}");
    }
    let read = reads::random(&loaded.image, &environment, (reads::LEAST_ALPHA, 1.0), 3, 256);
    let [sharp, rest] = reads::errors_of(&environment, &read);
    assert!(rest.relative <= 0.01 && rest.worst <= 0.05, "{rest:?}");
    // Lobes of .01 are narrower than two texels, and this sun is a pixel wide.
    assert!(sharp.relative <= 0.05 && sharp.worst <= 0.3, "{sharp:?}");
}
