//! The part of JSON Schema that `openapi.json` uses.

use std::slice::from_ref;

use serde_json::{Value, json};

use crate::client::Answer;
use crate::support::{Served, get};

/// What a route answers with this status, which is as its server describes it.
pub(crate) fn told(server: &Served, method: &str, route: &str, status: u16, answer: &Answer) -> Value {
    let json = answer.json();
    assert_eq!(answer.status, status, "{method} {route}: {json}");
    let description = get(server, "/api/openapi.json").json();
    let response = &description["paths"][route][method]["responses"][status.to_string()];
    let response = resolved(&description, response);
    assert!(response.is_object(), "{method} {route} answers {status}, which is not described: {json}");
    let schema = &response["content"]["application/json"]["schema"];
    compare(&description, schema, &json, &format!("{method} {route} {status}"));
    json
}

/// A part of the description, or the one that it refers to.
fn resolved<'a>(description: &'a Value, part: &'a Value) -> &'a Value {
    part["$ref"].as_str().map_or(part, |name| description.pointer(&name[1..]).unwrap())
}

/// Fails where a value is not as its schema describes it.
fn compare(description: &Value, schema: &Value, value: &Value, place: &str) {
    let schema = resolved(description, schema);
    if let Some(choices) = schema["anyOf"].as_array() {
        // Null and something else.
        let (null, others): (Vec<_>, Vec<_>) = choices.iter().partition(|choice| choice["type"] == "null");
        if null.is_empty() || !value.is_null() {
            others.into_iter().for_each(|choice| compare(description, choice, value, place));
        }
        return;
    }
    let is_of = |kind: &Value| match kind.as_str().unwrap() {
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("{place}: no type {other}"),
    };
    let kinds = schema["type"].as_array().map_or(from_ref(&schema["type"]), Vec::as_slice);
    assert!(kinds.iter().any(is_of), "{place} is not {}: {value}", schema["type"]);
    let allowed = schema["enum"].as_array();
    assert!(allowed.is_none_or(|allowed| allowed.contains(value)), "{place} is {value}, none of {allowed:?}");
    if let Some(items) = value.as_array() {
        let bound = |name: &str, usual: u64| schema[name].as_u64().unwrap_or(usual) as usize;
        let n_items = bound("minItems", 0)..=bound("maxItems", u64::MAX);
        assert!(n_items.contains(&items.len()), "{place} has {} items", items.len());
        for (i, item) in items.iter().enumerate() {
            compare(description, &schema["items"], item, &format!("{place}[{i}]"));
        }
    }
    if let (Some(fields), Some(properties)) = (value.as_object(), schema["properties"].as_object()) {
        for name in schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str) {
            assert!(fields.contains_key(name), "{place} lacks {name}");
        }
        assert_eq!(schema["additionalProperties"], false, "{place}: the schema is open");
        for (name, field) in fields {
            let schema = properties.get(name).unwrap_or_else(|| panic!("{place}.{name} is not described"));
            compare(description, schema, field, &format!("{place}.{name}"));
        }
    }
}

#[test]
#[should_panic(expected = "answer.other is not described")]
fn differences_from_the_schema_are_found() {
    let schema = json!({"type": "object", "additionalProperties": false, "properties": {}});
    compare(&Value::Null, &schema, &json!({"other": 2}), "answer");
}
