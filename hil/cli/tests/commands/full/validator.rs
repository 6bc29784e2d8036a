//! Whether JSON conforms to a schema, by the keywords that the commands' schemas use. Another keyword is an error, so that none is
//! ignored.
//!
//! A library for all of JSON Schema would take a third of the command's compile time; `.ci/install` also validates with one.

use std::collections::BTreeSet;

use serde_json::Value;

/// The parts of `value` that do not conform to `schema`, one line each with its place. Fields that the schema does not define are
/// among them: a reader accepts them, because they may be added, but a command writes none.
pub fn problems(schema: &Value, value: &Value) -> Vec<String> {
    let mut problems = Vec::new();
    Validator { root: schema }.judge(schema, value, "", &mut problems);
    problems
}

/// Keywords without a requirement.
const WORDS: [&str; 6] = [
    "$schema",
    "$defs",
    "title",
    "description",
    "format",
    "default",
];

struct Validator<'a> {
    root: &'a Value,
}

impl<'a> Validator<'a> {
    /// Checks all of `value` against all keywords.
    fn judge(&self, schema: &'a Value, value: &Value, at: &str, problems: &mut Vec<String>) {
        let known = self.apply(schema, value, at, problems);
        for name in value
            .as_object()
            .into_iter()
            .flat_map(|fields| fields.keys())
        {
            if !known.contains(name) {
                problems.push(format!("{at}/{name}: the schema has no such field"));
            }
        }
    }

    /// Checks `value` against one of several schemas, and returns the fields that this one defines.
    fn apply(
        &self,
        schema: &'a Value,
        value: &Value,
        at: &str,
        problems: &mut Vec<String>,
    ) -> BTreeSet<String> {
        let mut known = BTreeSet::new();
        let asked = match schema {
            Value::Bool(true) => {
                known.extend(
                    value
                        .as_object()
                        .into_iter()
                        .flat_map(|all| all.keys().cloned()),
                );
                return known;
            }
            Value::Object(asked) => asked,
            other => panic!("{at}: {other} is not a schema"),
        };
        for (keyword, asked) in asked {
            let all = || asked.as_array().expect("a list").iter();
            let holds = match keyword.as_str() {
                word if WORDS.contains(&word) => true,
                "$ref" => {
                    known.extend(self.apply(self.referred(asked), value, at, problems));
                    true
                }
                "allOf" => {
                    all().for_each(|each| known.extend(self.apply(each, value, at, problems)));
                    true
                }
                "anyOf" | "oneOf" => {
                    let mut count = 0;
                    for each in all() {
                        let mut left = Vec::new();
                        let names = self.apply(each, value, at, &mut left);
                        if left.is_empty() {
                            count += 1;
                            known.extend(names);
                        }
                    }
                    count == 1 || count > 1 && keyword == "anyOf"
                }
                "const" => asked == value,
                "enum" => all().any(|each| each == value),
                "type" => match asked {
                    Value::Array(kinds) => kinds.iter().any(|kind| is_a(kind, value)),
                    kind => is_a(kind, value),
                },
                "minimum" => value.is_null() || value.as_f64() >= asked.as_f64(),
                "maximum" => value.is_null() || value.as_f64() <= asked.as_f64(),
                _ => self.apply_to_parts(schema, keyword, value, at, (&mut known, problems)),
            };
            if !holds {
                problems.push(format!("{at}: {value} is not as {keyword} {asked} says"));
            }
        }
        known
    }

    /// The keywords about fields and elements.
    fn apply_to_parts(
        &self,
        schema: &'a Value,
        keyword: &str,
        value: &Value,
        at: &str,
        (known, problems): (&mut BTreeSet<String>, &mut Vec<String>),
    ) -> bool {
        let asked = &schema[keyword];
        let length = asked.as_u64().unwrap_or_default() as usize;
        match (keyword, value) {
            ("properties", Value::Object(fields)) => {
                for (name, asked) in asked.as_object().expect("fields") {
                    if let Some(value) = fields.get(name) {
                        known.insert(name.clone());
                        self.judge(asked, value, &format!("{at}/{name}"), problems);
                    }
                }
                true
            }
            ("additionalProperties", Value::Object(fields)) => {
                for (name, value) in fields {
                    if schema["properties"].get(name).is_none() && *asked != Value::Bool(false) {
                        known.insert(name.clone());
                        self.judge(asked, value, &format!("{at}/{name}"), problems);
                    }
                }
                true
            }
            ("required", Value::Object(fields)) => {
                let mut names = asked.as_array().expect("names").iter();
                names.all(|name| fields.contains_key(name.as_str().expect("a name")))
            }
            ("items", Value::Array(values)) => {
                let first = schema["prefixItems"].as_array().map_or(0, Vec::len);
                for (index, value) in values.iter().enumerate().skip(first) {
                    self.judge(asked, value, &format!("{at}/{index}"), problems);
                }
                true
            }
            ("prefixItems", Value::Array(values)) => {
                let each = asked.as_array().expect("schemas").iter().zip(values);
                for (index, (asked, value)) in each.enumerate() {
                    self.judge(asked, value, &format!("{at}/{index}"), problems);
                }
                true
            }
            ("minItems", Value::Array(values)) => values.len() >= length,
            ("maxItems", Value::Array(values)) => values.len() <= length,
            (
                "properties"
                | "additionalProperties"
                | "required"
                | "items"
                | "prefixItems"
                | "minItems"
                | "maxItems",
                _,
            ) => true,
            (other, _) => panic!("{at}: the validator lacks the keyword {other}"),
        }
    }

    /// The schema to which a reference points.
    fn referred(&self, reference: &Value) -> &'a Value {
        let place = reference.as_str().and_then(|text| text.strip_prefix('#'));
        let found = place.and_then(|place| self.root.pointer(place));
        found.unwrap_or_else(|| panic!("{reference} has no target"))
    }
}

fn is_a(kind: &Value, value: &Value) -> bool {
    match kind.as_str() {
        Some("null") => value.is_null(),
        Some("boolean") => value.is_boolean(),
        Some("object") => value.is_object(),
        Some("array") => value.is_array(),
        Some("string") => value.is_string(),
        Some("number") => value.is_number(),
        Some("integer") => value.is_i64() || value.is_u64(),
        _ => panic!("{kind} is not a type"),
    }
}
