//! docs/examples/bind_pack.py: a host that knows docs/FORMAT.md alone binds a pack on a GPU and gets the CPU's answers.

use crate::foreign::python_with;
use crate::support::{bake, root};
use glam::{Vec2, Vec3};
use glint_bake_core::dictionary::eval::{DictionaryMaterial, patch_sdf};
use glint_bake_core::dictionary::sections;
use glint_bake_core::footprint::PixelOnSurface;
use glint_formats::{Limits, Pack};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::fs;
use std::process::Command;

/// Queries that are asked.
const QUERIES: usize = 2000;

/// A query as `DictionaryQuery` lies in memory.
fn bytes_of(material: &DictionaryMaterial, pixel: PixelOnSurface, slope: Vec2) -> Vec<u8> {
    let words = [
        material.alpha.x.to_bits(),
        material.alpha.y.to_bits(),
        slope.x.to_bits(),
        slope.y.to_bits(),
        pixel.position.x.to_bits(),
        pixel.position.y.to_bits(),
        pixel.d_dx.x.to_bits(),
        pixel.d_dx.y.to_bits(),
        pixel.d_dy.x.to_bits(),
        pixel.d_dy.y.to_bits(),
        material.normal_target,
        material.density.to_bits(),
        material.relative_area.to_bits(),
        material.density_randomisation.to_bits(),
        material.max_anisotropy.to_bits(),
        material.seed,
        0,
        0,
        0,
        0,
        1f32.to_bits(),
        1f32.to_bits(),
        1f32.to_bits(),
        0,
    ];
    words.into_iter().flat_map(u32::to_le_bytes).collect()
}

#[test]
fn a_host_of_the_documentation_alone_gets_the_answers_of_the_cpu() {
    let Some(python) = python_with("wgpu") else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    bake(folder.path(), &["dictionary", "-o", "dictionary.glintpack", "-q"]).ok();
    bake(folder.path(), &["shaders", "--lang", "wgsl", "--method", "dictionary", "-o", "shaders"]).ok();
    let pack = Pack::open(path("dictionary.glintpack"), &Limits::default()).unwrap();
    let (dictionary, _) = sections::from_pack(&pack, "dictionary").unwrap();
    let tables = dictionary.tables();

    let mut rng = Pcg64::seed_from_u64(11);
    let mut uniform = |low: f32, high: f32| low + (high - low) * rng.random::<f32>();
    let (mut asked, mut expected) = (Vec::new(), Vec::new());
    for k in 0..QUERIES {
        let alpha = uniform(-4.0, -0.5).exp2();
        let material = DictionaryMaterial {
            alpha: Vec2::new(alpha, alpha * uniform(0.5, 2.0)),
            normal_target: (k % 2) as u32,
            density: uniform(0.0, 40.0).exp2(),
            relative_area: 1.0,
            density_randomisation: uniform(0.0, 2.0),
            max_anisotropy: uniform(1.0, 16.0),
            seed: k as u32,
            colours: Vec::new(),
            mean_colour: Vec3::ONE,
        };
        let size = uniform(-18.0, -8.0).exp2();
        let along = Vec2::from_angle(uniform(0.0, std::f32::consts::TAU));
        let pixel = PixelOnSurface {
            position: Vec2::new(uniform(-9.0, 9.0), uniform(-9.0, 9.0)),
            d_dx: along * size,
            d_dy: along.perp() * size * uniform(0.1, 1.0),
        };
        let slope = material.alpha * Vec2::new(uniform(-1.0, 1.0), uniform(-1.0, 1.0));
        asked.extend(bytes_of(&material, pixel, slope));
        let sum = patch_sdf(&tables, &material, pixel, slope);
        // In units of the peak of the smooth target, so that small differences of small values are small.
        let unit = std::f32::consts::PI * material.alpha.x * material.alpha.y;
        expected.push((unit, [sum.sdf.x, sum.sdf.y, sum.sdf.z, sum.coverage]));
    }
    fs::write(path("queries"), asked).unwrap();
    let script = root().join("docs/examples/bind_pack.py");
    // Without -B a folder of compiled files would appear in docs.
    let output = Command::new(python)
        .current_dir(folder.path())
        .arg("-B")
        .arg(script)
        .args(["dictionary.glintpack", "shaders", "queries", "answers"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));

    let answers = fs::read(path("answers")).unwrap();
    assert_eq!(answers.len(), 16 * QUERIES);
    let mut lit = 0;
    for (k, (bytes, (unit, expected))) in answers.chunks_exact(16).zip(&expected).enumerate() {
        for (c, (bytes, expected)) in bytes.chunks_exact(4).zip(expected).enumerate() {
            let unit = if c < 3 { *unit } else { 1.0 };
            let (found, expected) = (f32::from_le_bytes(bytes.try_into().unwrap()) * unit, expected * unit);
            let bound = 1e-3 * expected.abs() + 1e-5;
            assert!((found - expected).abs() <= bound, "query {k}, component {c}: {found}, on the CPU {expected}");
        }
        lit += u32::from(expected[0] > 0.0);
    }
    assert!(lit as usize > QUERIES / 4, "only {lit} queries see a glint");
}
