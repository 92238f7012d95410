//! `glint-bake textures`: what its files hold, read back by other people's readers, by target and format; what it refuses.

use crate::schema::check_against;
use crate::support::{bake, json};
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
use image::{DynamicImage, GrayImage, Luma, Rgb, RgbImage, Rgba, RgbaImage};
use std::fs;
use std::path::Path;
use std::process::Command;

/// A normal map of 12 × 6 with a slope to the right and one up, a coloured map, a grey one of half the size.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    RgbImage::from_fn(12, 6, |i, _| Rgb(if i % 4 < 2 { [176, 164, 240] } else { [128, 166, 249] }))
        .save(at("n.png"))
        .unwrap();
    RgbaImage::from_fn(12, 6, |i, j| Rgba([200, 51, if (i + j).is_multiple_of(2) { 0 } else { 255 }, 102]))
        .save(at("orm.png"))
        .unwrap();
    GrayImage::from_fn(6, 3, |_, _| Luma([128])).save(at("grey.png")).unwrap();
    folder
}

fn png(folder: &Path, name: &str) -> DynamicImage {
    image::open(folder.join("out").join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn textures(folder: &Path, flags: &[&str]) -> crate::support::Outcome {
    bake(folder, &[&["textures", "n.png", "-o", "out"], flags].concat())
}

/// Every mip of an uncompressed KTX2 file of 8 bits.
fn mips(folder: &Path, name: &str) -> Vec<Vec<u8>> {
    let file = fs::read(folder.join("out").join(name)).unwrap();
    let reader = ktx2::Reader::new(&file).unwrap();
    reader.levels().map(|level| level.data.to_vec()).collect()
}

#[test]
fn a_gltf_material_has_its_channels_and_rougher_mips() {
    let folder = folder();
    let flags = [
        "--roughness-map",
        "orm.png",
        "--roughness-channel",
        "g",
        "--occlusion",
        "orm.png",
        "--occlusion-channel",
        "r",
    ];
    let more = ["--metallic", "orm.png", "--metallic-channel", "b", "--target", "gltf", "--format", "png"];
    textures(folder.path(), &[&flags[..], &more].concat()).ok();
    let normal = png(folder.path(), "n_normal.mip0.png").to_rgb8();
    let original = image::open(folder.path().join("n.png")).unwrap().to_rgb8();
    for (found, expected) in normal.pixels().zip(original.pixels()) {
        assert!(found.0.iter().zip(expected.0).all(|(a, b)| a.abs_diff(b) <= 2), "{found:?} {expected:?}");
    }
    let finest = png(folder.path(), "n_orm.mip0.png").to_rgb8();
    assert_eq!((finest.get_pixel(0, 0).0, finest.get_pixel(1, 0).0), ([200, 51, 0], [200, 51, 255]));
    for (mip, size) in [(1, (6, 3)), (2, (3, 1)), (3, (1, 1))] {
        let orm = png(folder.path(), &format!("n_orm.mip{mip}.png")).to_rgb8();
        assert_eq!(orm.dimensions(), size);
        assert!(orm.pixels().all(|pixel| pixel.0[0] == 200 && pixel.0[1] >= 51), "{mip}");
        assert!(orm.pixels().all(|pixel| pixel.0[2].abs_diff(127) <= 1), "{mip}");
    }
    // Two normals 0.4 apart under the last mip are rougher than either; the mean leans as they do.
    let last = png(folder.path(), "n_orm.mip3.png").to_rgb8().get_pixel(0, 0).0;
    assert!(last[1] > 75, "{last:?}");
    assert!(!folder.path().join("out/n_normal.mip4.png").exists());
}

#[test]
fn targets_have_their_green_and_their_channels() {
    let folder = folder();
    let level = |target: &str, file: &str| {
        let flags = ["--target", target, "--roughness", "0.5", "--occlusion", "grey.png", "--format", "png", "-q"];
        textures(folder.path(), &flags).ok();
        png(folder.path(), file).to_rgba8().get_pixel(0, 0).0
    };
    for target in ["gltf", "filament", "bevy", "godot", "unreal"] {
        assert_eq!(level(target, "n_orm.mip0.png"), [128, 128, 255, 255], "{target}");
    }
    assert_eq!(level("unity", "n_mask.mip0.png"), [255, 128, 255, 128]);
    assert_eq!(level("generic", "n_roughness.mip0.png")[0], 128);
    assert_eq!(level("generic", "n_occlusion.mip0.png")[0], 128);
    assert!(!folder.path().join("out/n_metallic.mip0.png").exists(), "what is 1 everywhere is no file of its own");
    let (up, down) = (level("gltf", "n_normal.mip0.png"), level("unreal", "n_normal.mip0.png"));
    assert!(up[1] > 160 && down[1] == 255 - up[1] && up[0] == down[0], "{up:?} {down:?}");
    textures(folder.path(), &["--target", "unreal", "--output-y", "up", "--format", "png", "--normal-y", "down"]).ok();
    assert!(png(folder.path(), "n_normal.mip0.png").to_rgba8().get_pixel(0, 0).0[1] < 95);
}

/// A slope that comes and goes along u: highlights are wider along u, and both ways of storing that say the same two widths.
#[test]
fn anisotropy_is_stored_as_the_engine_combines_it() {
    let folder = folder();
    let widths = |target: &str| {
        let flags =
            ["--anisotropy", "normal", "--target", target, "--roughness", "0.5", "--format", "png", "--bits", "16"];
        textures(folder.path(), &flags).ok();
        let texel = |file: &str| png(folder.path(), file).to_rgb16().get_pixel(0, 0).0.map(|v| f64::from(v) / 65535.0);
        let ([x, y, strength], [_, roughness, _]) = (texel("n_anisotropy.mip2.png"), texel("n_orm.mip2.png"));
        assert!(x > 0.98 && (0.4..0.6).contains(&y) && strength > 0.05, "{target}: {x} {y} {strength}");
        let finest = texel("n_anisotropy.mip0.png");
        assert!(finest[2] == 0.0 && finest[0] > 0.9, "the map itself is not stretched: {finest:?}");
        let alpha = roughness * roughness;
        match target {
            "filament" => [alpha * (1.0 + strength), alpha * (1.0 - strength)],
            _ => [alpha + (1.0 - alpha) * strength * strength, alpha],
        }
    };
    let [along, across] = widths("gltf");
    assert!(across >= 0.249 && along > 1.05 * across, "{along} {across}");
    for target in ["filament", "bevy"] {
        let found = widths(target);
        assert!((found[0] - along).abs() < 1e-3 && (found[1] - across).abs() < 1e-3, "{target}: {found:?}");
    }
}

#[test]
fn roughness_is_read_and_stored_as_it_is_said() {
    let folder = folder();
    let roughness = |flags: &[&str]| {
        textures(folder.path(), &[&["--target", "generic", "--format", "png"], flags].concat()).ok();
        png(folder.path(), "n_roughness.mip0.png").to_luma16().get_pixel(0, 0).0[0] as f32 / 65535.0
    };
    let close = |found: f32, expected: f32| assert!((found - expected).abs() < 3e-3, "{found}, {expected}");
    close(roughness(&["--roughness", "0.5"]), 0.5);
    close(roughness(&["--roughness", "0.49", "--roughness-is", "alpha"]), 0.7);
    close(roughness(&["--roughness", "0.3", "--roughness-is", "smoothness"]), 0.7);
    close(roughness(&["--roughness", "0.6", "--store", "alpha"]), 0.36);
    close(roughness(&["--roughness", "0.6", "--store", "smoothness", "--bits", "16"]), 0.4);
    // A map of another size is resampled, and that is said.
    let done = textures(folder.path(), &["--roughness-map", "grey.png", "--target", "generic", "--format", "png"]).ok();
    assert!(done.stderr.contains("grey.png: 6 × 3 texels, used at 12 × 6"), "{}", done.stderr);
}

#[test]
fn ktx2_dds_and_exr_are_read_by_others() {
    let folder = folder();
    textures(folder.path(), &["--name", "m", "--two-channel"]).ok();
    let plain = mips(folder.path(), "m_normal.ktx2");
    assert_eq!(plain.iter().map(Vec::len).collect::<Vec<_>>(), [12 * 6 * 2, 6 * 3 * 2, 3 * 2, 2]);
    let orm = mips(folder.path(), "m_orm.ktx2");
    assert_eq!(orm[0].len(), 12 * 6 * 4);

    textures(folder.path(), &["--zstd", "--name", "z", "--two-channel"]).ok();
    let file = fs::read(folder.path().join("out/z_normal.ktx2")).unwrap();
    let reader = ktx2::Reader::new(&file).unwrap();
    assert_eq!(reader.header().supercompression_scheme, Some(ktx2::SupercompressionScheme::Zstandard));
    for (level, plain) in reader.levels().zip(&plain) {
        let raw = zstd::bulk::decompress(level.data, level.uncompressed_byte_length as usize).unwrap();
        assert!(raw == *plain && level.uncompressed_byte_length as usize == plain.len());
    }

    textures(folder.path(), &["--format", "dds", "--name", "m", "--two-channel"]).ok();
    let dds = ddsfile::Dds::read(&*fs::read(folder.path().join("out/m_normal.dds")).unwrap()).unwrap();
    assert_eq!(dds.get_dxgi_format(), Some(ddsfile::DxgiFormat::R8G8_UNorm));
    assert_eq!((dds.get_width(), dds.get_height(), dds.get_num_mipmap_levels()), (12, 6, 4));
    assert!(dds.get_data(0).unwrap() == plain.concat());

    textures(folder.path(), &["--format", "exr", "--name", "m", "--two-channel"]).ok();
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().all_layers();
    let image = reader.all_attributes().from_file(folder.path().join("out/m_normal.exr")).unwrap();
    assert_eq!(image.layer_data.len(), 4);
    for (part, plain) in image.layer_data.iter().zip(&plain) {
        for (k, name) in ["R", "G"].into_iter().enumerate() {
            let channel = part.channel_data.list.iter().find(|channel| channel.name.eq(name)).unwrap();
            let FlatSamples::F16(values) = &channel.sample_data else { panic!() };
            for (value, texel) in values.iter().zip(plain.chunks_exact(2)) {
                assert!((value.to_f32() - f32::from(texel[k]) / 255.0).abs() < 3e-3, "{value} {texel:?}");
            }
        }
    }
    for name in ["m_normal.ktx2", "m_orm.ktx2", "z_normal.ktx2"] {
        let run = |program: &str, args: &[&str]| {
            Command::new(program).args(args).arg(folder.path().join("out").join(name)).output()
        };
        let Ok(output) = run("ktx", &["validate"]).or_else(|_| run("ktx2check", &[])) else {
            return eprintln!("skipped: neither ktx nor ktx2check can be run");
        };
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stdout));
    }
}

#[test]
fn blocks_are_those_of_gpus_in_ktx2_and_dds() {
    let folder = folder();
    let formats = |name: &str| {
        let file = fs::read(folder.path().join("out").join(name)).unwrap();
        let reader = ktx2::Reader::new(&file).unwrap();
        let lengths: Vec<u64> = reader.levels().map(|level| level.uncompressed_byte_length).collect();
        (reader.header().format.unwrap(), lengths)
    };
    textures(folder.path(), &["--blocks", "--occlusion", "grey.png"]).ok();
    assert_eq!(formats("n_normal.ktx2"), (ktx2::Format::BC5_UNORM_BLOCK, vec![96, 32, 16, 16]));
    assert_eq!(formats("n_orm.ktx2"), (ktx2::Format::BC7_UNORM_BLOCK, vec![96, 32, 16, 16]));
    let plain = mips(folder.path(), "n_normal.ktx2");
    textures(folder.path(), &["--blocks", "--zstd", "--target", "generic", "--name", "z"]).ok();
    assert_eq!(formats("z_roughness.ktx2"), (ktx2::Format::BC4_UNORM_BLOCK, vec![48, 16, 8, 8]));
    let file = fs::read(folder.path().join("out/z_normal.ktx2")).unwrap();
    let reader = ktx2::Reader::new(&file).unwrap();
    assert_eq!(reader.header().supercompression_scheme, Some(ktx2::SupercompressionScheme::Zstandard));
    for (level, plain) in reader.levels().zip(&plain) {
        assert!(zstd::bulk::decompress(level.data, plain.len()).unwrap() == *plain);
    }
    textures(folder.path(), &["--blocks", "--format", "dds", "-j", "7"]).ok();
    let dds = ddsfile::Dds::read(&*fs::read(folder.path().join("out/n_normal.dds")).unwrap()).unwrap();
    assert_eq!(dds.get_dxgi_format(), Some(ddsfile::DxgiFormat::BC5_UNorm));
    assert!(dds.get_data(0).unwrap() == plain.concat());
    // BC5 by its definition: the first texel of the first block is 176, 164, and both ends of what varies are stored.
    let ends = |block: &[u8]| [block[0].min(block[1]), block[0].max(block[1])];
    let near = |found: [u8; 2], expected: [u8; 2]| found.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 2);
    let (red, green) = (ends(&plain[0][..8]), ends(&plain[0][8..16]));
    assert!(near(red, [128, 176]) && near(green, [164, 166]), "{red:?} {green:?}");
}

#[test]
fn the_list_is_as_its_schema_says_and_names_every_file() {
    let folder = folder();
    let flags = ["--json", "--depfile", "d", "--occlusion", "grey.png", "--assume-linear", "--channels", "xyz"];
    let done = textures(folder.path(), &flags).ok();
    let printed = json(&done.stdout);
    check_against("glint-textures.schema.json", &printed, "textures");
    assert_eq!(done.stdout, fs::read_to_string(folder.path().join("out/n.json")).unwrap());
    assert_eq!((&printed["inputs"][1]["name"], &printed["width"]), (&"grey.png".into(), &12.into()));
    let files: Vec<&str> = printed["files"].as_array().unwrap().iter().map(|f| f["file"].as_str().unwrap()).collect();
    assert_eq!(files, ["n_normal.ktx2", "n_orm.ktx2"]);
    let rule = fs::read_to_string(folder.path().join("d")).unwrap();
    assert_eq!(rule, "out/n.json: \\\n  n.png \\\n  grey.png\n");
}

#[test]
fn the_same_bytes_come_on_any_threads_and_again() {
    let folder = folder();
    let flags = ["--roughness-map", "orm.png", "--roughness-channel", "a", "--wrap", "clamp"];
    let files = |threads: &str| {
        textures(folder.path(), &[&flags[..], &["-j", threads]].concat()).ok();
        ["n_normal.ktx2", "n_orm.ktx2", "n.json"].map(|name| fs::read(folder.path().join("out").join(name)).unwrap())
    };
    let one = files("1");
    assert!(one == files("2") && one == files("7"));
    let again = textures(folder.path(), &flags).ok().stderr;
    assert_eq!((again.matches("unchanged").count(), again.contains(": written")), (3, false), "{again}");
}

#[test]
fn crops_heights_and_single_texels_are_textures_too() {
    let folder = folder();
    textures(folder.path(), &["--crop", "5x3+2+1", "--roughness-map", "orm.png", "--roughness-channel", "b"]).ok();
    assert_eq!(mips(folder.path(), "n_orm.ktx2").iter().map(Vec::len).collect::<Vec<_>>(), [60, 8, 4]);
    textures(folder.path(), &["--crop", "1x1+0+0"]).ok();
    assert_eq!(mips(folder.path(), "n_normal.ktx2").len(), 1);
    bake(folder.path(), &["textures", "grey.png", "--height", "2", "-o", "out"]).ok();
    // A flat map keeps its roughness on every mip.
    for level in mips(folder.path(), "grey_orm.ktx2") {
        assert!(level.chunks_exact(4).all(|texel| texel == [255, 128, 255, 255]), "{level:?}");
    }
}

#[test]
fn one_texture_may_be_one_file() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let all = ["--roughness-map", "grey.png", "--format", "dds"];
    textures(folder.path(), &all).ok();
    for (kind, output) in [("normal", "a.dds"), ("orm", "b.dds")] {
        bake(
            folder.path(),
            &[&["textures", "n.png", "-o", output, "--only", kind, "--depfile", "d"], &all[..]].concat(),
        )
        .ok();
        assert!(fs::read(at(output)).unwrap() == fs::read(at("out").join(format!("n_{kind}.dds"))).unwrap());
        assert!(fs::read_to_string(at("d")).unwrap().starts_with(&format!("{output}: \\\n  n.png")));
        assert!(!at("n.json").exists());
    }
    // Into a folder it has its list.
    bake(folder.path(), &["textures", "n.png", "-o", "one", "--only", "normal", "--format", "png"]).ok();
    assert!(at("one/n_normal.mip3.png").exists() && at("one/n.json").exists() && !at("one/n_orm.mip0.png").exists());
    for (output, flags, part) in [
        ("c.ktx2", &[][..], "say which with --only, or name a folder"),
        ("c.png", &["--only", "normal", "--format", "png"], "each mip has a file"),
        ("out", &["--only", "mask"], "--only: expected normal or orm, found mask"),
    ] {
        let refused = bake(folder.path(), &[&["textures", "n.png", "-o", output], flags].concat());
        assert!(refused.code == 2 && refused.stderr.contains(part), "{output}: {}", refused.stderr);
    }
    let refused = bake(folder.path(), &["textures", "n.png", "-o", "none/c.ktx2", "--only", "normal"]);
    assert!(refused.code == 3 && refused.stderr.contains("does not exist"), "{}", refused.stderr);
}

#[test]
fn a_dry_run_and_refusals_write_nothing() {
    let folder = folder();
    let done = textures(folder.path(), &["-n"]).ok();
    assert!(done.stderr.contains("n_normal.ktx2") && done.stderr.contains("nothing was written"), "{}", done.stderr);
    fs::write(folder.path().join("file"), b"in the way").unwrap();
    let mut broken = fs::read(folder.path().join("orm.png")).unwrap();
    broken.truncate(60);
    fs::write(folder.path().join("cut.png"), broken).unwrap();
    for (flags, code, part) in [
        (&["--roughness", "1.5"][..], 2, "expected 0 to 1, found 1.5"),
        (&["--roughness", "0.5", "--roughness-map", "grey.png"], 2, "--roughness-map"),
        (&["--roughness-map", "orm.png"], 4, "orm.png: expected a grey image, found colours at texel (0, 0)"),
        (
            &["--roughness-map", "grey.png", "--roughness-channel", "a"],
            4,
            "grey.png: --roughness-channel asks for alpha",
        ),
        (&["--roughness-map", "none.png"], 3, "none.png"),
        (&["--metallic", "cut.png", "--metallic-channel", "r"], 4, "cut.png"),
        (
            &["--crop", "8x4+0+0", "--occlusion", "grey.png"],
            4,
            "grey.png: the crop of 8×4 at (0, 0) leaves the 6×3 map",
        ),
        (&["--zstd", "--format", "png"], 2, "--zstd"),
        (&["--bits", "16", "--format", "exr"], 2, "--bits"),
        (&["--blocks", "--format", "png"], 2, "--blocks"),
        (&["--blocks", "--bits", "16"], 2, "--blocks: holds 8 bits"),
        (&["--bits", "12"], 2, "expected 8 or 16, found 12"),
        (&["--name", "a/b"], 2, "--name"),
        (&["--target", "blender"], 2, "blender"),
        (&["--anisotropy", "normal", "--target", "unreal"], 2, "--anisotropy: --target unreal"),
        (&["--anisotropy", "view"], 2, "--anisotropy"),
        (&["--depfile", "-"], 2, "--depfile"),
        (&["--depfile", "n.png"], 2, "is an input as well"),
        (&["--max-memory", "1K"], 6, "--max-memory"),
        (&["--layer", "a"], 4, "--layer"),
    ] {
        let refused = textures(folder.path(), flags);
        assert_eq!(refused.code, code, "{flags:?}: {}", refused.stderr);
        assert!(refused.stderr.contains(part), "{flags:?}: {}", refused.stderr);
    }
    for (output, code) in [("file", 3), ("-", 2)] {
        let refused = bake(folder.path(), &["textures", "n.png", "--output", output]);
        assert_eq!(refused.code, code, "{output}: {}", refused.stderr);
    }
    assert!(!folder.path().join("out").exists());
}
