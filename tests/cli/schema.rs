//! The JSON of glint-info against docs/schema/glint-info.schema.json, by a checker of the few keywords that it uses.

use crate::support::{bake, info, json, maps, root};
use serde_json::Value;
use std::fs;

/// Every keyword that the checker knows; another one in the schema would go unchecked.
const KEYWORDS: [&str; 13] = [
    "$schema",
    "$id",
    "$defs",
    "$ref",
    "title",
    "description",
    "type",
    "required",
    "properties",
    "items",
    "enum",
    "minimum",
    "additionalProperties",
];

/// Checks a document against a schema of docs/schema, whose `$id` it names.
pub fn check_against(schema: &str, document: &Value, at: &str) {
    let schema = json(&fs::read_to_string(root().join("docs/schema").join(schema)).unwrap());
    assert_eq!(document["$schema"], schema["$id"], "{at}");
    check(&schema, &schema, document, at);
}

fn check(schema: &Value, root: &Value, value: &Value, at: &str) {
    for key in schema.as_object().unwrap().keys() {
        assert!(KEYWORDS.contains(&key.as_str()), "{at}: the checker does not know {key}");
    }
    if let Some(reference) = schema.get("$ref") {
        let target = root.pointer(reference.as_str().unwrap().trim_start_matches('#')).unwrap();
        return check(target, root, value, at);
    }
    if let Some(kind) = schema.get("type") {
        let kinds: Vec<&str> = kind
            .as_array()
            .map_or(vec![kind], |all| all.iter().collect())
            .iter()
            .map(|k| k.as_str().unwrap())
            .collect();
        assert!(kinds.iter().any(|kind| is(value, kind)), "{at}: expected {kinds:?}, found {value}");
    }
    if let Some(values) = schema.get("enum") {
        assert!(values.as_array().unwrap().contains(value), "{at}: expected one of {values}, found {value}");
    }
    if let Some(least) = schema.get("minimum") {
        assert!(value.as_f64().is_none_or(|v| v >= least.as_f64().unwrap()), "{at}: {value} is below {least}");
    }
    if let (Some(items), Some(values)) = (schema.get("items"), value.as_array()) {
        for (i, item) in values.iter().enumerate() {
            check(items, root, item, &format!("{at}[{i}]"));
        }
    }
    if let (Some(properties), Some(fields)) = (schema.get("properties"), value.as_object()) {
        for name in schema.get("required").and_then(Value::as_array).into_iter().flatten() {
            assert!(fields.contains_key(name.as_str().unwrap()), "{at}: {name} is missing");
        }
        for (name, field) in fields {
            let property = properties.get(name).unwrap_or_else(|| panic!("{at}: {name} is not in the schema"));
            check(property, root, field, &format!("{at}.{name}"));
        }
    }
}

fn is(value: &Value, kind: &str) -> bool {
    match kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_u64() || value.is_i64(),
        "number" => value.is_number(),
        "null" => value.is_null(),
        other => panic!("the checker does not know the type {other}"),
    }
}

#[test]
fn reports_keep_to_the_schema() {
    let folder = maps();
    let args = ["ndf-maps", "flakes.png", "scratches.png", "-o", "out.glintpack", "--layers", "scratches:flakes"];
    bake(folder.path(), &[&args[..], &["--placement", "stochastic"]].concat()).ok();
    bake(folder.path(), &["ndf-maps", "flakes.png", "-o", "tiled.glintpack", "--compress"]).ok();
    bake(folder.path(), &["dictionary", "-o", "lobes.glintpack", "--marginals", "3"]).ok();
    let pixels = (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n".iter().copied()).chain([128; 8]);
    fs::write(folder.path().join("sky.hdr"), pixels.collect::<Vec<u8>>()).unwrap();
    bake(folder.path(), &["environment", "sky.hdr", "-o", "sky.glintpack", "--face-size", "4"]).ok();
    bake(folder.path(), &["area-light", "flakes.png", "-o", "light.glintpack", "--anisotropic"]).ok();
    bake(folder.path(), &["lobes", "flakes.png", "-o", "hide.glintpack"]).ok();
    let sample = glint_bake::input::synthetic::scratches(32, 32, 1);
    sample.save(folder.path().join("sample.png")).unwrap();
    let surface = ["lobes", "sample.png", "-o", "surface.glintpack", "--synthesize", "64x48", "--patch", "16"];
    bake(folder.path(), &[&surface[..], &["--overlap", "4"]].concat()).ok();
    let mut files = vec![
        "surface.glintpack".to_owned(),
        "light.glintpack".into(),
        "hide.glintpack".into(),
        "out.glintpack".into(),
        "lobes.glintpack".into(),
        "sky.glintpack".into(),
        "tiled.glintpack".into(),
        "missing.glintpack".into(),
        "flakes.png".into(),
    ];
    for entry in fs::read_dir(root().join("fixtures/corrupt")).unwrap() {
        let files_of_issue = fs::read_dir(entry.unwrap().path()).unwrap();
        files.extend(files_of_issue.map(|e| e.unwrap().path().display().to_string()));
    }
    for file in files {
        let report = json(&info(folder.path(), &[&file, "--json"]).stdout);
        check_against("glint-info.schema.json", &report, &file);
    }
}
