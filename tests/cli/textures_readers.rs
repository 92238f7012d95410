//! Files of `glint-bake textures` as programs of other people read them: KTX2 by npm's ktx-parse, DDS by Pillow, which decodes blocks
//! by itself. The crates ktx2 and ddsfile read them in `textures.rs`.

use crate::foreign::{node, npm_package, python, python_with};
use crate::support::{bake, root};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// Writes textures of a map of ours into `folder`.
fn textures(folder: &Path, flags: &[&str]) {
    let map = root().join("fixtures/maps/leather.png");
    bake(folder, &[&["textures", map.to_str().unwrap(), "-o", ".", "-q"], flags].concat()).ok();
}

fn bytes_of(value: &Value) -> Vec<u8> {
    let digits = value.as_str().unwrap().as_bytes();
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap();
    digits.chunks_exact(2).map(byte).collect()
}

#[test]
fn ktx_parse_finds_in_ktx2_what_the_crate_finds() {
    let Some(package) = npm_package("ktx-parse") else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    textures(at, &["--name", "plain"]);
    textures(at, &["--name", "wide", "--bits", "16", "--two-channel", "--target", "generic", "--zstd"]);
    textures(at, &["--name", "blocks", "--blocks", "--zstd", "--target", "generic"]);
    textures(at, &["--name", "odd", "--blocks", "--crop", "5x3+0+0"]);
    // Names, and numbers of the descriptor: Vulkan's format, the colour model, samples.
    let expected = [
        ("plain_normal", 37, 1, 4),
        ("plain_orm", 37, 1, 4),
        ("wide_normal", 77, 1, 2),
        ("wide_roughness", 70, 1, 1),
        ("blocks_normal", 141, 132, 2),
        ("blocks_roughness", 139, 131, 1),
        ("odd_normal", 141, 132, 2),
        ("odd_orm", 145, 134, 1),
    ];
    let files: Vec<PathBuf> = expected.iter().map(|(name, ..)| at.join(format!("{name}.ktx2"))).collect();
    let paths: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    let found = node("ktx_parse.mjs", &package, &paths);
    for ((name, format, model, samples), found) in expected.iter().zip(found.as_array().unwrap()) {
        let number = |key: &str| found[key].as_u64().unwrap();
        assert_eq!((number("vkFormat"), number("model"), number("samples")), (*format, *model, *samples), "{name}");
        // Linear, whatever the importer believes of images.
        assert_eq!(number("transfer"), 1, "{name}");
        let file = fs::read(at.join(format!("{name}.ktx2"))).unwrap();
        let reader = ktx2::Reader::new(&file).unwrap();
        let header = reader.header();
        assert_eq!(found["size"], serde_json::json!([header.pixel_width, header.pixel_height]), "{name}");
        assert_eq!(
            number("scheme"),
            header.supercompression_scheme.map_or(0, |scheme| u64::from(scheme.value())),
            "{name}"
        );
        assert!(found["writer"].as_str().unwrap().starts_with("glint-bake"), "{name}");
        let levels = found["levels"].as_array().unwrap();
        assert_eq!(levels.len(), reader.levels().len(), "{name}");
        for (level, ours) in levels.iter().zip(reader.levels()) {
            assert!(bytes_of(&level["stored"]) == ours.data, "{name}");
            assert_eq!(level["bytes"].as_u64().unwrap(), ours.uncompressed_byte_length, "{name}");
        }
    }
}

/// Mean and largest difference of the first `channels` of two images with texels of so many bytes.
fn difference(a: (&[u8], usize), b: (&[u8], usize), channels: usize) -> (f64, u8) {
    let texels = a.0.chunks_exact(a.1).zip(b.0.chunks_exact(b.1));
    let of = |(a, b): (&'_ [u8], &'_ [u8])| (0..channels).map(|c| a[c].abs_diff(b[c])).collect::<Vec<u8>>();
    let all: Vec<u8> = texels.flat_map(of).collect();
    let mean = all.iter().map(|d| f64::from(*d)).sum::<f64>() / all.len() as f64;
    (mean, all.into_iter().max().unwrap())
}

#[test]
fn pillow_decodes_dds_to_the_texels_of_the_png() {
    let Some(program) = python_with("PIL") else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let scratches = root().join("fixtures/maps/scratches.png");
    let material = ["--roughness-map", scratches.to_str().unwrap(), "--roughness-channel", "r"];
    let write = |flags: &[&str]| textures(at, &[&material[..], flags].concat());
    write(&["--name", "m", "--format", "png"]);
    write(&["--name", "plain", "--format", "dds"]);
    write(&["--name", "blocks", "--format", "dds", "--blocks"]);
    write(&["--name", "one", "--format", "dds", "--blocks", "--target", "generic"]);
    // Alpha of normals goes through BC7.
    let leather = image::open(root().join("fixtures/maps/leather.png")).unwrap().to_rgb8();
    let alpha = |i: u32, j: u32| (40 + i + j / 2) as u8;
    let with_alpha = image::RgbaImage::from_fn(128, 128, |i, j| {
        let [r, g, b] = leather.get_pixel(i, j).0;
        image::Rgba([r, g, b, alpha(i, j)])
    });
    with_alpha.save(at.join("leather.png")).unwrap();
    let keep = ["textures", "leather.png", "--normal-alpha", "keep", "--blocks", "--format", "dds", "-o", "."];
    bake(at, &keep).ok();
    let names = ["plain_normal", "plain_orm", "blocks_normal", "blocks_orm", "one_roughness", "leather_normal"];
    let files: Vec<PathBuf> = names.iter().map(|name| at.join(format!("{name}.dds"))).collect();
    let paths: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    let found = python(&program, "pillow.py", &paths);
    let png = |name: &str| image::open(at.join(name)).unwrap().to_rgb8().into_raw();
    let (normal, orm) = (png("m_normal.mip0.png"), png("m_orm.mip0.png"));
    let green: Vec<u8> = orm.chunks_exact(3).map(|texel| texel[1]).collect();
    for (name, found) in names.iter().zip(found.as_array().unwrap()) {
        assert_eq!(found["size"], serde_json::json!([128, 128]), "{name}");
        let texels = bytes_of(&found["texels"]);
        let (mode, mean, most) = match *name {
            "plain_normal" => ("RGBA", difference((&texels, 4), (&normal, 3), 3), (0.0, 0)),
            "plain_orm" => ("RGBA", difference((&texels, 4), (&orm, 3), 3), (0.0, 0)),
            // x and y; the shader makes z.
            "blocks_normal" => ("RGB", difference((&texels, 3), (&normal, 3), 2), (1.0, 8)),
            "leather_normal" => ("RGBA", difference((&texels, 4), (with_alpha.as_raw(), 4), 4), (2.0, 24)),
            "blocks_orm" => ("RGBA", difference((&texels, 4), (&orm, 3), 3), (1.0, 8)),
            _ => ("L", difference((&texels, 1), (&green, 1), 1), (1.0, 8)),
        };
        assert_eq!(found["mode"], mode, "{name}");
        assert!(mean.0 <= most.0 && mean.1 <= most.1, "{name}: {mean:?}");
    }
}
