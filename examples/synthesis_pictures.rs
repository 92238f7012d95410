//! Pictures of synthesised normal maps, and what they measure, as markdown on stdout.
//!
//! `synthesis_pictures DATA OUT` reads the real maps in `DATA/normals`; of each it writes to the folder `OUT` the whole
//! surface four times smaller and a piece at full size, as a grid of patches and without end.

use glint_bake::canvas::Canvas;
use glint_bake::input::{Crop, InputOptions, load_normal_map};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::synthesis::measure::{repetition, whole_share};
use glint_bake_core::synthesis::{Synthesis, SynthesisOptions, Target, assemble, bake};
use glint_formats::ndf_maps::Wrap;
use std::path::Path;
use std::time::Instant;

fn main() {
    let a: Vec<String> = std::env::args().skip(1).collect();
    let get = |k: &str, d: f64| {
        a.iter().find_map(|s| s.strip_prefix(&format!("{k}=")).map(|v| v.parse().unwrap())).unwrap_or(d)
    };
    let (data, out, file) = (&a[0], &a[1], &a[2]);
    let size = get("size", 4096.0) as u32;
    let crop = get("crop", 256.0) as u32;
    let wrap = if get("clamp", 1.0) > 0.0 { Wrap::Clamp } else { Wrap::Repeat };
    let c = (crop > 0).then_some(Crop { x: get("x", 0.0) as u32, y: get("y", 0.0) as u32, w: crop, h: crop });
    let path = Path::new(data).join("normals").join(file);
    let map = load_normal_map(&path, &InputOptions { crop: c, wrap, ..Default::default() }).unwrap().map;
    let target = if get("tiles", 0.0) > 0.0 {
        Target::Unbounded { colours: get("tiles", 0.0) as u32, variants: get("variants", 1.0) as u32 }
    } else {
        Target::Patches { width: size, height: size }
    };
    let options = SynthesisOptions {
        target,
        patch: get("patch", 64.0) as u32,
        overlap: get("overlap", 8.0) as u32,
        alignment: get("align", 8.0) as u32,
        error_tolerance: get("tol", 0.5),
        max_candidates: get("cand", 1024.0) as u32,
        alpha: get("alpha", 0.9),
        seed: get("seed", 0.0) as u64,
    };
    let t = Instant::now();
    let s = bake(&map, &options, &Silent).unwrap();
    let dt = t.elapsed().as_secs_f64();
    let n = size / options.patch;
    println!(
        "{file} {}x{} bake {dt:.2}s seam {:.3} distinct {} bytes {} whole 8/16/32 {:.3} {:.3} {:.3} (step) {:.3} {:.3} repetition {:.4}",
        map.width, map.height,
        s.params.measured.seam_ratio,
        s.params.measured.distinct_offsets,
        4 * (s.offsets.len() + s.seams.len()),
        whole_share(&s, size as i32 / 8, 0, true),
        whole_share(&s, size as i32 / 16, 1, true),
        whole_share(&s, size as i32 / 32, 2, true),
        whole_share(&s, size as i32 / 16, 1, false),
        whole_share(&s, size as i32 / 32, 2, false),
        repetition(&s, n as i32, 12.min(n as i32 / 2)),
    );
    let tag = get("tag", 0.0) as u32;
    let name = format!("{}_{tag}", &file[..6]);
    picture(&s, &map, size, get("down", 4.0) as u32, Path::new(out).join(format!("{name}_all.png")).as_path(), (0, 0));
    picture(&s, &map, 640, 1, Path::new(out).join(format!("{name}_crop.png")).as_path(), (700, 900));
}

fn picture(s: &Synthesis, map: &NormalMap, size: u32, down: u32, path: &Path, at: (i32, i32)) {
    let m = assemble(s, map, at, (size, size)).unwrap();
    let mut canvas = Canvas::new(size / down, size / down, [0; 3]);
    let mut gain = 0.0f64;
    for p in &map.projected {
        gain += (p[0] * p[0] + p[1] * p[1]) as f64;
    }
    let gain = (0.35 / (gain / map.projected.len() as f64).sqrt().max(1e-3)).max(1.0);
    for y in 0..size / down {
        for x in 0..size / down {
            let mut sum = [0.0f64; 2];
            for j in 0..down {
                for i in 0..down {
                    let [a, b] = m.projected[((y * down + j) * size + x * down + i) as usize];
                    sum[0] += a as f64;
                    sum[1] += b as f64;
                }
            }
            let n = (down * down) as f64;
            let (a, b) = (sum[0] / n * gain, sum[1] / n * gain);
            let z = (1.0 - a * a - b * b).max(0.0).sqrt();
            canvas.set(x, y, [a, b, z].map(|v| ((v * 0.5 + 0.5).clamp(0.0, 1.0) * 255.0) as u8));
        }
    }
    std::fs::write(path, canvas.to_png()).unwrap();
}
