fn main() {
    use glam::Vec3;
    use glint_view::{gpu::*, render::*, scene::*};
    use std::rc::Rc;
    let gpu = Gpu::headless(&Wish::default()).unwrap();
    let d = glint_bake_core::dictionary::bake(&Default::default()).unwrap();
    let data = Rc::new(glint_view::methods::dictionary::upload(&gpu, &d, &[]));
    let empty = Rc::new(ResourceSet::default().finish(&gpu));
    let mesh = Mesh::plane(50.0);
    let mut r = Renderer::new(&gpu, &mesh).unwrap();
    let material = Material { density: 2e5, ..Default::default() };
    let side = |method, data: &Rc<Resources>| {
        Compare::Single(Side {
            shown: Shown { name: String::new(), method, data: data.clone(), material },
            reference: false,
        })
    };
    for (what, position) in [("facing", Vec3::new(0.0, 3.0, 0.01)), ("tilted", Vec3::new(0.0, 2.0, 3.0))] {
        let mut v = View {
            size: [640, 360],
            scene: Scene {
                camera: Camera { position, target: Vec3::ZERO, field_of_view: 0.8, near: 0.01 },
                lights: Lights {
                    sun: Some(Sun { direction: position * Vec3::new(1.0, 1.0, -1.0), irradiance: Vec3::splat(3.0) }),
                    ..Default::default()
                },
                uv_scale: 1.0,
            },
            compare: side(Method::Smooth, &empty),
            display: Display::default(),
            antialias: false,
            vary_seed: false,
        };
        let mut time = [f64::MAX; 2];
        for _ in 0..6 {
            for (k, c) in [side(Method::Smooth, &empty), side(Method::Dictionary, &data)].into_iter().enumerate() {
                v.compare = c;
                picture(&gpu, &mut r, &v, 1).unwrap();
                let t = r.pass_seconds(&gpu).unwrap().unwrap()[0].1;
                time[k] = time[k].min(t);
            }
        }
        println!(
            "{what} smooth {:.1} ms, dictionary {:.1} ms, ratio {:.1}",
            1e3 * time[0],
            1e3 * time[1],
            time[1] / time[0]
        );
    }
}
