//! Accuracy and size of NDF maps on real maps: every tile's decoded NDF against that tile's exact one.

use glint_bake::input::{Crop, InputOptions, load_normal_map};
use glint_bake_core::ndf_maps::bake::{self, NdfMapsOptions};
use glint_bake_core::ndf_maps::reference::ReferenceNdf;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::quality::metrics::{Summary, e1};
use glint_formats::ndf_maps::DensityStorage;

use std::path::PathBuf;

fn main() {}

fn data() -> PathBuf { PathBuf::from("../shared/data") }

fn load(name: &str, crop: Option<(u32,u32,u32)>) -> NormalMap {
    let options = InputOptions { crop: crop.map(|(x,y,n)| Crop{x,y,w:n,h:n}), assume_linear: true, ..InputOptions::default() };
    load_normal_map(&data().join(name), &options).unwrap().map
}

#[test]
fn sweep() {
    let mut cases: Vec<(String, NormalMap)> = Vec::new();
    for t in ["flakes_8x8","brushed_16x16","scratches_32x32","leather_64x64","diamond_plate_64x32","wicker_box16_32x32"] {
        cases.push((t.into(), load(&format!("tiny/{t}.png"), None)));
    }
    for (f,x,y,n) in [("brushed_aluminium_godot_745.png",300,300,16),("carpaint_flakes_khronos_128.png",40,40,16),("ground037_ambientcg_rgba_roughness.png",512,512,16),
      ("scratched_gold_cgbookcase_rgba.png",500,500,32),("technical_fabric_sheencloth_256_rgba.png",100,100,32),("hammered_pebbles_pmndrs0015.jpg",500,500,32),("snow_02_polyhaven_gl.jpg",300,300,32),("bluenoise_bevy_512_rgba.png",100,100,16),("carpaint_flakes_khronos_128.png",0,0,32)] {
        cases.push((format!("{f}:{n}"), load(&format!("normals/{f}"), Some((x,y,n)))));
    }
    for (name, map) in &cases {
      for (rough, ask) in [(0.02, 0.01), (0.01,0.02), (0.005,0.05)] {
        let t0 = std::time::Instant::now();
        let baked = bake::bake(map, &NdfMapsOptions{ roughness: rough, max_error: ask, storage: DensityStorage::SqrtU8 }, &Silent).unwrap();
        let dt = t0.elapsed();
        let mut spans = 0usize; let mut spans2=0; let mut rows=0; let mut blocks=0;
        for t in &baked.tiles { let (w,h)=(t.width() as usize,t.height() as usize); let d=&baked.density[t.texel_offset as usize..][..w*h];
          rows+=h;
          for r in d.chunks_exact(w) { for (th,acc) in [(0u8,&mut spans),(5,&mut spans2)] { if let (Some(a),Some(b)) = (r.iter().position(|v| *v>th), r.iter().rposition(|v| *v>th)) { *acc += b-a+1; } } }
          for by in 0..h.div_ceil(4) { for bx in 0..w.div_ceil(4) { let mut any=false; for y in by*4..(by*4+4).min(h) { for x in bx*4..(bx*4+4).min(w) { any|=d[y*w+x]>5; } } if any {blocks+=16;} } }
        }
        println!("{name:50} σ_r {rough:5} bytes {:7.1} spans {:.1} {:.1} rowtab {:.1} blocks {:.1} KiB baked {:.4}/{:.4} {:?}", baked.gpu_bytes() as f64/1024.0, spans as f64/1024., spans2 as f64/1024., rows as f64*4./1024., blocks as f64/1024., baked.params.measured.mean, baked.params.measured.worst, dt);
      } } }
