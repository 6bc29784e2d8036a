//! `hil schema`: the documents that the commands write conform to it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::command::hil;
use crate::full::validator::problems;

/// Documents that another file of these tests creates and checks with [`is_as_its_schema_says`].
const ELSEWHERE: [(&str, &str); 7] = [
    ("amplitude-free", "amplitude_free_command.rs"),
    ("bench", "bench_command.rs"),
    ("emulate", "board_command.rs"),
    ("paper", "paper_command.rs"),
    ("record", "board_command.rs"),
    ("study-bouc-wen", "schema_command.rs"),
    ("upload", "board_command.rs"),
];

fn tests() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/commands/full")
}

/// The path of the repository's schemas.
fn stored() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/schema")
}

fn read(path: impl AsRef<Path>) -> Value {
    let path = path.as_ref();
    let bytes = fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_slice(&bytes).unwrap()
}

/// All schemas of the command by name.
fn schemas() -> BTreeMap<String, Value> {
    let root = tempfile::tempdir().unwrap();
    hil(root.path(), &["schema", "--all", "--out", "schemas"]);
    let files = fs::read_dir(root.path().join("schemas")).unwrap();
    files
        .map(|file| file.unwrap().path())
        .map(|path| {
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            (name, read(path))
        })
        .collect()
}

/// Asserts that `value` is the document `name` by the command's schema, and has no additional field.
#[track_caller]
pub fn is_as_its_schema_says(name: &str, value: &Value) {
    let root = tempfile::tempdir().unwrap();
    let schema: Value = serde_json::from_str(&hil(root.path(), &["schema", name])).unwrap();
    has_schema(name, &schema, value);
}

#[track_caller]
fn has_schema(name: &str, schema: &Value, value: &Value) {
    let problems = problems(schema, value);
    assert!(problems.is_empty(), "{name}: {}", problems.join("\n"));
}

/// Small documents of the commands, by name. None takes long to create.
fn documents(root: &Path) -> BTreeMap<&'static str, Value> {
    let run = |line: &str| {
        hil(root, &line.split(' ').collect::<Vec<_>>());
    };
    run("demo --seed 4 --out demo --json demo.json");
    fs::create_dir(root.join("recordings")).unwrap();
    let recording = |folder: &str| root.join(folder).join("recording.csv.gz");
    fs::copy(recording("demo"), recording("recordings")).unwrap();
    for line in [
        "predict --model demo/model.json demo/recording.csv.gz --out p.csv --json predict.json --motion motion.json",
        "respond --model demo/model.json --mass 120 --base demo/recording.csv.gz --out r.csv --json respond.json",
        "respond --model demo/model.json --mass 120 --sweep --amplitudes 0.05 --from 20 --to 30 --points 2 --out s.csv --json transmissibility.json",
        "export --model demo/model.json --format pack --tick-rate 10000 --out mount.mdcp --json export.json",
        "run --blocks 0.1:5:3 --model demo/model.json --json run.json",
        "characterize run-out/recording.csv.gz --dynamic --json characterize.json",
        "design --stiffness 3 --loss-factor 0.4 --json design.json",
        "orthogonal --json orthogonal.json",
        "faults --adversary 2 --json faults.json",
        "blind --seeds 1 --json blind.json",
        "blind --motions --seeds 1 --json blind-motions.json",
        "blind --conditions --seeds 1 --json blind-conditions.json",
        "study numbers --seeds 0 --json study-numbers.json",
        "study size --rows 1e4 --json study-size.json",
        "inspect demo/recording.csv.gz --json inspect.json",
        "batch recordings --out batch --json batch.json",
        "trace demo/recording.csv.gz --out trace",
        "compare demo trace --json comparison.json",
        "schema --json schemas.json",
    ] {
        run(line);
    }
    let mut documents = BTreeMap::new();
    for name in [
        "demo",
        "predict",
        "motion",
        "respond",
        "transmissibility",
        "export",
        "run",
        "characterize",
        "design",
        "orthogonal",
        "faults",
        "blind",
        "blind-motions",
        "blind-conditions",
        "study-numbers",
        "study-size",
        "inspect",
        "batch",
        "comparison",
        "schemas",
    ] {
        documents.insert(name, read(root.join(format!("{name}.json"))));
    }
    documents.insert("trace", read(root.join("demo/trace.json")));
    documents.insert("model", read(root.join("demo/model.json")));
    documents.insert("size-measurement", documents["study-size"][0].clone());
    let baseline = "../trials/bench-baseline.json";
    let baseline = Path::new(env!("CARGO_MANIFEST_DIR")).join(baseline);
    documents.insert("bench-baseline", read(baseline));
    documents
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn what_the_commands_write_is_as_their_schemas_say() {
    let root = tempfile::tempdir().unwrap();
    let documents = documents(root.path());
    for (name, schema) in schemas() {
        if let Some(document) = documents.get(name.as_str()) {
            has_schema(&name, &schema, document);
            continue;
        }
        let made = ELSEWHERE.iter().find(|(document, _)| *document == name);
        let (_, file) = made.unwrap_or_else(|| panic!("no test writes the document {name}"));
        let test = fs::read_to_string(tests().join(file)).unwrap();
        let judged = format!("is_as_its_schema_says(\"{name}\"");
        assert!(test.contains(&judged), "{file} does not check {name}");
    }
}

#[test]
#[ignore = "fits a benchmark: 20 s"]
fn the_benchmark_of_others_is_as_its_schema_says() {
    let root = tempfile::tempdir().unwrap();
    let line = ["study", "bouc-wen", "--json", "study-bouc-wen.json"];
    hil(root.path(), &line);
    let document = read(root.path().join("study-bouc-wen.json"));
    is_as_its_schema_says("study-bouc-wen", &document);
}

/// A document identifies its kind. A field that is missing, has another type or is unknown is found.
#[test]
fn a_schema_tells_a_document_from_what_is_none() {
    let root = tempfile::tempdir().unwrap();
    hil(root.path(), &["orthogonal", "--json", "orthogonal.json"]);
    let document = read(root.path().join("orthogonal.json"));
    assert_eq!(document["format"], "mesh-damper orthogonal");
    assert_eq!(document["version"], 1);
    let schema = &schemas()["orthogonal"];
    let spoilt = |spoil: &dyn Fn(&mut Value)| {
        let mut other = document.clone();
        spoil(&mut other);
        assert!(!problems(schema, &other).is_empty());
    };
    spoilt(&|other| other["format"] = json!("mesh-damper run"));
    spoilt(&|other| other["version"] = json!(2));
    spoilt(&|other| other["results"] = json!(1));
    spoilt(&|other| other["more"] = json!(1));
    spoilt(&|other| {
        other.as_object_mut().unwrap().remove("results");
    });
}

/// No code bypasses the schemas: `add_json` accepts anything, so only code that identifies a document may call it.
#[test]
fn the_commands_write_documents_alone() {
    fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                sources(&path, found);
            } else {
                found.push(path);
            }
        }
    }
    let mut found = Vec::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    sources(&root, &mut found);
    let around: Vec<PathBuf> = found
        .into_iter()
        .filter(|path| !path.ends_with("document.rs"))
        .filter(|path| {
            let text = fs::read_to_string(path).unwrap();
            text.contains(".add_json(") || text.contains("to_vec_pretty")
        })
        .collect();
    assert!(
        around.is_empty(),
        "{around:?}: give what is written a schema in schema.rs, and write it by add_document"
    );
}

/// Words that state a number's unit, or that it has none.
const UNITS: &[&str] = &[
    "divided by",
    "multiple of",
    "fraction",
    "relative",
    "mm",
    "kN",
    ", s",
    " s ",
    " s;",
    "s.",
    "Hz",
    "J",
    "kg",
    "°",
    "g/cm³",
    "MPa",
    "rad",
    "%",
    "byte",
    "NRMSE",
    "RMS",
    "part",
    "Part",
    "ratio",
    "Ratio",
    "over ",
    "factor",
    "exponent",
    "error",
    "number",
    "how many",
    "How many",
    "times",
    "cycle",
    "tick",
    "instruction",
    "unit",
    "rate",
    "degree",
    "share",
    "likewise",
    "The same",
    "F of",
    "p of",
    "R²",
    "0…1",
    "−1…1",
    "ticks",
    "count",
    "Error",
    "Cycle",
    "Tick",
    "Number",
    "Rate",
    "probability",
];

/// Fields of the standard library's types, which have no description of their own.
const OF_THE_LIBRARY: [&str; 4] = ["Ok", "Err", "start", "end"];

/// Fields without a description, and numbers without a unit.
struct Bare<'a> {
    root: &'a Value,
    found: Vec<String>,
}

impl Bare<'_> {
    /// The description of a field: its own, that of its reference, or that of its alternative.
    fn said(&self, field: &Value, alternative: &str) -> String {
        let of = |schema: &Value| {
            schema["description"]
                .as_str()
                .unwrap_or_default()
                .to_owned()
        };
        let referred = field["$ref"].as_str();
        let referred = referred.and_then(|place| self.root.pointer(&place[1..]));
        of(field) + &referred.map(of).unwrap_or_default() + alternative
    }

    fn walk(&mut self, schema: &Value, at: &str, alternative: &str) {
        let Value::Object(keywords) = schema else {
            return;
        };
        for (keyword, inner) in keywords {
            match (keyword.as_str(), inner) {
                ("properties", Value::Object(fields)) => {
                    for (name, field) in fields {
                        let at = format!("{at}/{name}");
                        let is_known =
                            field.get("const").is_some() || OF_THE_LIBRARY.contains(&name.as_str());
                        let said = self.said(field, alternative);
                        let is_number = field["type"].to_string().contains("number");
                        let has_unit = UNITS.iter().any(|unit| said.contains(unit));
                        let in_name = ["_mm", "_kn", "_j", "_s", "_cm3"]
                            .iter()
                            .any(|unit| name.ends_with(unit))
                            || name.starts_with("nrmse");
                        if !is_known && (said.is_empty() || is_number && !has_unit && !in_name) {
                            self.found.push(format!("{at}: {said}"));
                        }
                        self.walk(field, &at, "");
                    }
                }
                ("$defs", Value::Object(all)) => {
                    for (kind, schema) in all {
                        self.walk(schema, kind, "");
                    }
                }
                ("anyOf" | "oneOf" | "allOf" | "prefixItems", Value::Array(all)) => {
                    for each in all {
                        let alternative = each["description"].as_str().unwrap_or_default();
                        self.walk(each, at, alternative);
                    }
                }
                ("items" | "additionalProperties", inner) => self.walk(inner, at, ""),
                _ => {}
            }
        }
    }
}

/// Every field has a description, and a number has a unit.
#[test]
fn every_field_is_described() {
    let mut all = Vec::new();
    for (name, schema) in schemas() {
        assert!(schema["description"].is_string(), "{name}");
        let text = schema.to_string();
        assert!(!text.contains("[`"), "{name} links to what is no schema");
        let mut bare = Bare {
            root: &schema,
            found: Vec::new(),
        };
        bare.walk(&schema, &name, "");
        all.extend(bare.found);
    }
    all.sort();
    all.dedup();
    assert!(all.is_empty(), "{}", all.join("\n"));
}

/// Parts of `old` that are missing or changed in `new`: readers rely on them. Additional parts do not affect readers.
fn lost(old: &Value, new: &Value, at: &str, lost: &mut Vec<String>) {
    match (old, new) {
        (Value::Object(old), Value::Object(new)) => {
            for (key, old) in old {
                let at = format!("{at}/{key}");
                match new.get(key) {
                    // The wording may be improved.
                    _ if matches!(key.as_str(), "description" | "title") && old.is_string() => {}
                    Some(new) => self::lost(old, new, &at, lost),
                    None => lost.push(format!("{at} is gone")),
                }
            }
        }
        // A set, such as `required`, `enum` and `oneOf`, may get additional members.
        (Value::Array(old), Value::Array(new)) => {
            for each in old {
                let mut closest = None;
                for other in new {
                    let mut left = Vec::new();
                    self::lost(each, other, at, &mut left);
                    if closest
                        .as_ref()
                        .is_none_or(|before: &Vec<String>| left.len() < before.len())
                    {
                        closest = Some(left);
                    }
                }
                lost.extend(closest.unwrap_or_else(|| vec![format!("{at}: {each} is gone")]));
            }
        }
        (old, new) if old == new => {}
        _ => lost.push(format!("{at}: {old} has become {new}")),
    }
}

#[test]
fn what_goes_or_changes_is_found() {
    let schema = &schemas()["run"];
    let found = |change: &dyn Fn(&mut Value)| {
        let mut other = schema.clone();
        change(&mut other);
        let mut all = Vec::new();
        lost(schema, &other, "", &mut all);
        all.len()
    };
    assert_eq!(found(&|_| {}), 0);
    assert_eq!(
        found(&|other| other["properties"]["more"] = json!({"type": "string"})),
        0
    );
    assert_eq!(
        found(&|other| other["properties"]["seed"]["type"] = json!("string")),
        1
    );
    assert_eq!(
        found(&|other| {
            other["properties"].as_object_mut().unwrap().remove("seed");
        }),
        1
    );
    assert_eq!(
        found(&|other| {
            let required = other["required"].as_array_mut().unwrap();
            required.retain(|name| name != "seed");
        }),
        1
    );
}

/// The schemas in docs/schema: `BLESS=1` writes them again.
#[test]
fn no_field_of_the_stored_schemas_is_lost() {
    let schemas = schemas();
    if std::env::var_os("BLESS").is_some() {
        let root = tempfile::tempdir().unwrap();
        hil(root.path(), &["schema", "--all", "--out", "schemas"]);
        fs::create_dir_all(stored()).unwrap();
        for name in schemas.keys() {
            let file = format!("{name}.json");
            fs::copy(
                root.path().join("schemas").join(&file),
                stored().join(&file),
            )
            .unwrap();
        }
        return;
    }
    let mut all = Vec::new();
    for file in fs::read_dir(stored()).unwrap() {
        let path = file.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        match schemas.get(name) {
            Some(schema) => lost(&read(&path), schema, name, &mut all),
            None => all.push(format!("{name} is gone")),
        }
    }
    for name in schemas.keys() {
        if !stored().join(format!("{name}.json")).exists() {
            all.push(format!("{name} is not stored"));
        }
    }
    assert!(
        all.is_empty(),
        "{}\na field that goes or changes its type takes a new VERSION of the document; then, and of what is new, \
         BLESS=1 cargo test -p mesh-damper-hil --features full --test commands schema writes the stored schemas again",
        all.join("\n")
    );
}

#[test]
fn the_list_says_what_there_is() {
    let root = tempfile::tempdir().unwrap();
    let list = hil(root.path(), &["schema"]);
    for name in schemas().keys() {
        assert!(
            list.lines()
                .any(|line| line.starts_with(&format!("{name} "))),
            "{name}"
        );
    }
    crate::refusal::refuses(
        root.path(),
        &["schema", "none"],
        &["no document has this name", "trace"],
    );
}
