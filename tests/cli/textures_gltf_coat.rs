//! `glint-bake textures --gltf`: clear coats, whose normals and roughness are their own.

use crate::foreign::{node, npm_package};
use crate::gltf_file::{Gltf, glb, levels, quad_parts};
use crate::support::bake;
use serde_json::json;
use std::fs;

/// A coat with a map and factors, one without a factor, and one whose normals are those below it.
const MATERIALS: &str = r#"[
    {"name": "car", "normalTexture": {"index": 0}, "pbrMetallicRoughness": {"roughnessFactor": 0.5},
     "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 0.9, "clearcoatTexture": {"index": 1},
      "clearcoatRoughnessFactor": 0.6, "clearcoatRoughnessTexture": {"index": 1},
      "clearcoatNormalTexture": {"scale": 0.5, "index": 0}}}},
    {"name": "orange", "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 1,
      "clearcoatNormalTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [ 3, 3 ]}}}}}},
    {"name": "flat", "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.2}}}
]"#;

#[test]
fn clear_coats_get_filtered_textures_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (old, binary) = quad_parts(MATERIALS);
    let old = old.replace("\"ACME_unknown\"],", "\"ACME_unknown\", \"KHR_materials_clearcoat\"],");
    fs::write(at.join("in.glb"), glb(&old, &binary)).unwrap();
    bake(at, &["textures", "--gltf", "in.glb", "-o", "out.glb"]).ok();
    let new = Gltf::read(&at.join("out.glb"));
    let coat = |material: usize| &new.json["materials"][material]["extensions"]["KHR_materials_clearcoat"];
    const COAT: &str = "/extensions/KHR_materials_clearcoat";
    let finest = |material: usize, place: &str| levels(new.basisu(material, &format!("{COAT}/{place}")))[0][0];
    let last = |material: usize, place: &str| levels(new.basisu(material, &format!("{COAT}/{place}")))[3][0];
    // 0.6 · 100 in green, and rougher from afar; a scale of a half: x of 0.38 against z of 0.93 becomes 0.2.
    let (roughness, normal) = ("clearcoatRoughnessTexture", "clearcoatNormalTexture");
    assert_eq!(finest(0, roughness)[1], 60);
    assert!(last(0, roughness)[1] > 70 && finest(0, normal)[0].abs_diff(153) <= 1);
    assert_eq!((&coat(0)["clearcoatRoughnessFactor"], &coat(0)[normal]["scale"]), (&json!(1), &json!(1)));
    // What else is there stays, the strength in red of the same image too.
    assert_eq!((&coat(0)["clearcoatFactor"], &coat(0)["clearcoatTexture"]), (&json!(0.9), &json!({"index": 1})));
    assert_eq!(new.json["textures"][1], json!({"sampler": 0, "source": 1}));
    // The base is filtered by itself: 0.5 · 255.
    let base = levels(new.basisu(0, "/pbrMetallicRoughness/metallicRoughnessTexture"));
    assert_eq!(base[0][0][1], 128);
    // A coat without a factor is smooth where nothing was averaged away, and its map lies as its normals do.
    assert_eq!(finest(1, roughness)[1], 0);
    assert!(last(1, roughness)[1] > 60);
    assert_eq!(coat(1)["clearcoatRoughnessFactor"], json!(1));
    let transform = json!({"KHR_texture_transform": {"scale": [3, 3]}});
    assert_eq!(coat(1)[roughness]["extensions"], transform);
    assert_eq!(new.json["materials"][1].get("pbrMetallicRoughness"), None);
    let flat = r#"{"name": "flat", "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.2}}}"#;
    assert!(old.contains(flat) && new.text.contains(flat));
    let Some(package) = npm_package("gltf-validator") else { return };
    bake(at, &["textures", "--gltf", "in.glb", "-o", "png.glb", "--gltf-images", "png", "--max-size", "4"]).ok();
    let found = node("gltf_validator.mjs", &package, &[&at.join("png.glb"), &at.join("out.glb")]);
    let of = |file: usize, severity: u64| {
        found[file].as_array().unwrap().iter().filter(|issue| issue["severity"] == severity).count()
    };
    assert_eq!((of(0, 0), of(0, 1), of(1, 0)), (0, 0, 0), "{found}");
}
