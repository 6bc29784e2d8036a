//! `hil schema`: the JSON schemas of the commands' documents.

use std::borrow::Cow;
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_batch::Summary as BatchSummary;
use mesh_damper_batch::compare::Comparison;
use mesh_damper_identify::trace::result::TraceResult;
use mesh_damper_model::file::ModelFile;
use mesh_damper_output::error::InputError;
use mesh_damper_output::{Label, LabelField, Plan};
use mesh_damper_paper::amplitude_independent::Study;
use mesh_damper_paper::claims::Paper;
use mesh_damper_rig::campaign;
use mesh_damper_trials::bench::{Baseline, Results};
use mesh_damper_trials::blind;
use mesh_damper_trials::bouc_wen::BoucWenResult;
use mesh_damper_trials::conditions;
use mesh_damper_trials::numbers::Costs;
use mesh_damper_trials::size::Measured;
use schemars::generate::SchemaSettings;
use schemars::transform::transform_subschemas;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Serialize;
use serde_json::{Value, json};

use super::{characterize, design, emulate, orthogonal, record, run, study_size, upload};
use crate::commands::document::{AddDocument as _, Document};
use crate::commands::{Failure, say};
use crate::commands::{demo, inspect, predict, respond, respond_sweep};

/// Print the JSON schemas of all documents that the commands write
///
/// Without a name it lists them. The fields `format` and `version` of a document name its schema. A new field does not change the version.
/// The version changes if a field is removed, or gets another type or meaning.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  hil schema\n  hil schema trace > trace.schema.json\n  hil schema --all --out schemas"
)]
pub struct SchemaCommand {
    /// Name of the document, as in the list
    #[arg(value_name = "NAME", conflicts_with_all = ["all", "json"])]
    name: Option<String>,
    /// Write all schemas into the folder of --out
    #[arg(long, requires = "out")]
    all: bool,
    /// Folder for the schemas, as NAME.json
    #[arg(long, value_name = "DIR", requires = "all")]
    out: Option<PathBuf>,
    /// Write the list as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// The documents that the commands write as JSON.
#[derive(JsonSchema, Serialize)]
pub(in crate::commands) struct Schemas {
    /// The documents.
    schemas: Vec<Listed>,
}

/// A document that commands write.
#[derive(JsonSchema, Serialize)]
struct Listed {
    /// Name of the document, as `hil schema` takes it.
    name: &'static str,
    /// Version of the document.
    schema_version: u32,
    /// The commands that write it.
    written_by: &'static str,
    /// Description of the document.
    description: String,
}

/// A schema and its document.
struct Entry {
    name: &'static str,
    version: u32,
    written_by: &'static str,
    schema: fn() -> Schema,
}

/// A type gets its name as a document only here, so no command writes JSON without a schema.
macro_rules! documents {
    (named elsewhere { $($known:ty, $known_by:literal;)* } $($type:ty, $name:literal $(version $version:literal)? by $label:ident, $by:literal;)*) => {
        $(impl Document for $type {
            const LABEL: Label = Label {
                $(version: $version,)?
                ..Label::new($name, LabelField::$label)
            };
        })*

        const ALL: &[Entry] = &[
            $(entry::<$known>($known_by),)*
            $(entry::<$type>($by),)*
        ];
    };
}

documents! {
    named elsewhere {
        TraceResult, "hil trace, hil demo: trace.json";
        ModelFile, "hil trace, hil demo, hil amplitude-free, hil study bouc-wen: model.json";
        demo::Summary<'_>, "hil demo --json";
        predict::Summary<'_>, "hil predict --json";
        predict::LawMotion<'_>, "hil predict --motion";
        respond::Summary<'_>, "hil respond --json";
        respond_sweep::Summary<'_>, "hil respond --sweep --json";
        inspect::Report<'_>, "hil inspect --json";
    }
    mesh_damper_export::Summary, "export" by Document, "hil export --json";
    run::Summary, "run" by Format, "hil run --json";
    record::Summary, "record" by Format, "hil record --json";
    upload::Uploaded, "upload" by Format, "hil upload --json";
    emulate::Emulated, "emulate" by Format, "hil emulate --json";
    characterize::Summary, "characterize" by Format, "hil characterize --json";
    design::Summary, "design" by Format, "hil design --json";
    orthogonal::Summary, "orthogonal" by Format, "hil orthogonal --json";
    BatchSummary, "batch" by Own, "hil batch --json";
    Comparison, "comparison" by Own, "hil compare --json";
    Study, "amplitude-free" by Format, "hil amplitude-free --json";
    Paper, "paper" by Format, "hil paper --json";
    campaign::Summary, "faults" by Format, "hil faults --json";
    blind::Summary, "blind" by Format, "hil blind --json";
    blind::Summary<blind::MotionOutcome>, "blind-motions" by Format, "hil blind --motions --json";
    conditions::Summary, "blind-conditions" by Format, "hil blind --conditions --json";
    Results, "bench" version 2 by Format, "hil bench --json";
    Baseline, "bench-baseline" by Own, "hil bench --bless";
    Costs, "study-numbers" by Format, "hil study numbers --json";
    BoucWenResult, "study-bouc-wen" by Format, "hil study bouc-wen --json";
    Measured, "size-measurement" by Format, "hil study size --json, an element of it";
    study_size::Sizes<'_>, "study-size" by Own, "hil study size --json";
    Schemas, "schemas" by Format, "hil schema --json";
}

const fn entry<T: Document + JsonSchema>(written_by: &'static str) -> Entry {
    Entry {
        name: T::LABEL.name,
        version: T::LABEL.version,
        written_by,
        schema: schema_of::<T>,
    }
}

fn schema_of<T: Document + JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    let mut schema = settings.into_generator().into_root_schema_for::<Whole<T>>();
    schema.insert("title".into(), T::LABEL.text().into());
    without_code(&mut schema);
    schema
}

/// Replaces links to code and line ends in descriptions with plain text, because a reader of the JSON has no code.
fn without_code(schema: &mut Schema) {
    if let Some(Value::String(text)) = schema.get_mut("description") {
        let plain = text.replace("[`", "`").replace("`]", "`");
        let paragraphs = plain.split("\n\n").map(|text| text.replace('\n', " "));
        *text = paragraphs.collect::<Vec<_>>().join("\n\n");
    }
    transform_subschemas(&mut without_code, schema);
}

/// A document with its label.
pub(super) struct Whole<T>(PhantomData<T>);

impl<T: Document + JsonSchema> JsonSchema for Whole<T> {
    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = T::json_schema(generator);
        let field = match T::LABEL.field {
            LabelField::Format => "format",
            LabelField::Document => "document",
            LabelField::Own => return schema,
        };
        let labels = [
            (field, json!(T::LABEL.text()), "Type of the document."),
            (
                "version",
                json!(T::LABEL.version),
                "Version of the document. It changes if a field is removed, or gets another type or meaning.",
            ),
        ];
        let object = schema.ensure_object();
        for (name, value, description) in labels {
            let kind = if value.is_string() {
                "string"
            } else {
                "integer"
            };
            let described = json!({"type": kind, "const": value, "description": description});
            let properties = object.entry("properties").or_insert_with(|| json!({}));
            if let Value::Object(properties) = properties {
                properties.insert(name.into(), described);
            }
            let required = object.entry("required").or_insert_with(|| json!([]));
            if let Value::Array(required) = required {
                required.push(name.into());
            }
        }
        schema
    }
}

impl Entry {
    fn description(&self) -> String {
        let schema = (self.schema)();
        let text = schema.get("description").and_then(Value::as_str);
        let text = text.unwrap_or_default();
        text.split("\n\n")
            .next()
            .unwrap_or_default()
            .replace('\n', " ")
    }

    fn file_name(&self) -> String {
        format!("{}.json", self.name)
    }

    fn text(&self) -> Result<String, InputError> {
        serde_json::to_string_pretty(&(self.schema)())
            .map(|text| text + "\n")
            .map_err(|error| InputError::new(self.name, error.to_string(), "report this"))
    }
}

impl SchemaCommand {
    pub fn run(self) -> Result<(), Failure> {
        if let Some(name) = &self.name {
            let output = Path::new("-");
            let mut outputs = Plan::new().writes([output]).begin()?;
            outputs.add(output, named(name)?.text()?);
            return Ok(outputs.write()?);
        }
        let names = ALL.iter().map(Entry::file_name);
        let mut outputs = Plan::new()
            .fills(self.out.as_deref(), names)
            .writes(&self.json)
            .begin()?;
        if let Some(out) = &self.out {
            for entry in ALL {
                outputs.add(out.join(entry.file_name()), entry.text()?);
            }
        }
        let listed = ALL.iter().map(|entry| Listed {
            name: entry.name,
            schema_version: entry.version,
            written_by: entry.written_by,
            description: entry.description(),
        });
        let list = Schemas {
            schemas: listed.collect(),
        };
        outputs.add_document_if(&self.json, &list)?;
        outputs.write()?;
        if self.json.as_deref() == Some(Path::new("-")) {
            return Ok(());
        }
        match &self.out {
            Some(out) => say(&format!("{} schemas are in {}", ALL.len(), out.display())),
            None => list.print(),
        }
        Ok(())
    }
}

fn named(name: &str) -> Result<&'static Entry, InputError> {
    ALL.iter().find(|entry| entry.name == name).ok_or_else(|| {
        let names: Vec<&str> = ALL.iter().map(|entry| entry.name).collect();
        InputError::new(
            mesh_damper_output::error::quoted(name),
            "no document has this name",
            format!("give one of {}", names.join(", ")),
        )
    })
}

impl Schemas {
    fn print(&self) {
        for one in &self.schemas {
            say(&format!("{:17} {}", one.name, one.description));
            say(&format!("{:17} written by {}", "", one.written_by));
        }
    }
}
