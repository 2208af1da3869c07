use serde_json::Value as Json;

use crate::json_schema;

const SCHEMA_FILE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../scenes/scene.schema.json"
);

#[test]
fn the_schema_file_is_up_to_date() {
    let schema = json_schema();
    if std::env::var_os("DEPAL_UPDATE_SCHEMA").is_some() {
        let text = serde_json::to_string_pretty(&schema).unwrap() + "\n";
        std::fs::write(SCHEMA_FILE, text).unwrap();
    }
    let kept: Json = serde_json::from_str(&std::fs::read_to_string(SCHEMA_FILE).unwrap()).unwrap();
    assert!(
        kept == schema,
        "run this test once with DEPAL_UPDATE_SCHEMA=1 to write the file anew"
    );
}

/// Every key below a schema, with its path.
fn keys(schema: &Json, path: &str, found: &mut Vec<(String, Json)>) {
    if let Some(properties) = schema["properties"].as_object() {
        for (name, key) in properties {
            let path = format!("{path}.{name}");
            keys(key, &path, found);
            found.push((path, key.clone()));
        }
    }
    keys_of_items(&schema["items"], path, found);
    for variant in schema["oneOf"].as_array().into_iter().flatten() {
        keys(variant, path, found);
    }
}

fn keys_of_items(items: &Json, path: &str, found: &mut Vec<(String, Json)>) {
    if items.is_object() {
        keys(items, path, found);
    }
}

#[test]
fn every_key_is_described_and_every_default_has_its_reason() {
    let mut lacking = Vec::new();
    let mut found = Vec::new();
    keys(&json_schema(), "", &mut found);
    assert!(found.len() > 120, "{} keys", found.len());
    for (path, key) in found {
        let description = key["description"].as_str().unwrap_or_default();
        assert!(description.len() > 4, "{path} has no description");
        if !key["default"].is_null() && !description.contains("Default") {
            lacking.push(format!("{path}: {description}"));
        }
    }
    assert!(lacking.is_empty(), "no word on the default of {lacking:#?}");
}
