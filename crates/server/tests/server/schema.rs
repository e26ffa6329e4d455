//! The part of JSON Schema that `openapi.json` uses.

use serde_json::Value;

use crate::client::Answer;
use crate::running::Running;
use crate::support::get;

/// What a route answers with this status, which is as its server describes it.
pub(crate) fn told(server: &Running, method: &str, route: &str, status: u16, answer: &Answer) -> Value {
    let json = answer.json();
    assert_eq!(answer.status, status, "{method} {route}: {json}");
    Description(get(server, "/api/openapi.json").json()).check(method, route, status, &json);
    json
}

struct Description(Value);

impl Description {
    /// Checks a response against the description of this route and status.
    fn check(&self, method: &str, path: &str, status: u16, answer: &Value) {
        let responses = &self.0["paths"][path][method]["responses"];
        let response = &responses[status.to_string()];
        assert!(response.is_object(), "{method} {path} answers {status}, which is not described: {answer}");
        let schema = &response["content"]["application/json"]["schema"];
        let mut faults = Vec::new();
        self.compare(schema, answer, "answer", &mut faults);
        assert!(faults.is_empty(), "{method} {path} {status}: {}", faults.join("; "));
    }

    fn compare(&self, schema: &Value, value: &Value, place: &str, faults: &mut Vec<String>) {
        if let Some(name) = schema["$ref"].as_str() {
            let name = name.strip_prefix("#/components/schemas/").unwrap();
            let named = &self.0["components"]["schemas"][name];
            assert!(named.is_object(), "no schema {name}");
            return self.compare(named, value, place, faults);
        }
        if let Some(choices) = schema["anyOf"].as_array() {
            // The choices are null and something else; faults are those of the latter.
            let is_null = |choice: &&Value| choice["type"] == "null";
            if !(value.is_null() && choices.iter().any(|choice| is_null(&choice))) {
                for choice in choices.iter().filter(|choice| !is_null(choice)) {
                    self.compare(choice, value, place, faults);
                }
            }
            return;
        }
        let types: Vec<&str> = match &schema["type"] {
            Value::String(one) => vec![one],
            Value::Array(several) => several.iter().filter_map(Value::as_str).collect(),
            other => panic!("{place}: the schema has no type: {other}"),
        };
        let is_of = |kind: &&str| match *kind {
            "string" => value.is_string(),
            "number" => value.is_number(),
            "integer" => value.is_u64() || value.is_i64(),
            "boolean" => value.is_boolean(),
            "null" => value.is_null(),
            "array" => value.is_array(),
            "object" => value.is_object(),
            other => panic!("{place}: no type {other}"),
        };
        if !types.iter().any(is_of) {
            faults.push(format!("{place} is not {}: {value}", types.join(" or ")));
            return;
        }
        if let Some(allowed) = schema["enum"].as_array()
            && !allowed.contains(value)
        {
            faults.push(format!("{place} is {value}, none of {allowed:?}"));
        }
        if let Some(items) = value.as_array() {
            let length = |bound: &str| schema[bound].as_u64().map(|n| n as usize);
            let (least, most) = (length("minItems").unwrap_or(0), length("maxItems").unwrap_or(usize::MAX));
            if !(least..=most).contains(&items.len()) {
                faults.push(format!("{place} has {} items", items.len()));
            }
            for (i, item) in items.iter().enumerate() {
                self.compare(&schema["items"], item, &format!("{place}[{i}]"), faults);
            }
        }
        if let (Some(fields), Some(properties)) = (value.as_object(), schema["properties"].as_object()) {
            for name in schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str) {
                if !fields.contains_key(name) {
                    faults.push(format!("{place} lacks {name}"));
                }
            }
            assert_eq!(schema["additionalProperties"], false, "{place}: the schema is open");
            for (name, field) in fields {
                match properties.get(name) {
                    Some(schema) => self.compare(schema, field, &format!("{place}.{name}"), faults),
                    None => faults.push(format!("{place}.{name} is not described")),
                }
            }
        }
    }
}

#[test]
fn differences_from_the_schema_are_found() {
    let schema: Value = serde_json::from_str(
        r##"{"type": "object", "required": ["n"], "additionalProperties": false, "properties": {
            "n": {"type": ["integer", "null"]}, "list": {"type": "array", "maxItems": 1, "items": {"type": "string", "enum": ["x"]}},
            "more": {"anyOf": [{"$ref": "#/components/schemas/A"}, {"type": "null"}]}}}"##,
    )
    .unwrap();
    let description = Description(serde_json::json!({"components": {"schemas": {"A": &schema}}}));
    let faults = |answer: &str| {
        let mut faults = Vec::new();
        description.compare(&schema, &serde_json::from_str(answer).unwrap(), "answer", &mut faults);
        faults.len()
    };
    for (answer, n_faults) in [
        (r#"{"n": null, "list": ["x"], "more": {"n": 2}}"#, 0),
        (r#"{"n": 1.5, "other": 2, "list": ["x", "y"], "more": {}}"#, 5),
    ] {
        assert_eq!(faults(answer), n_faults, "{answer}");
    }
}
