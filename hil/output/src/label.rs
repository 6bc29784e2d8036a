//! The label of a JSON document: its kind and its version.

use serde::Serialize;

/// Field in which a document states its kind, next to its version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LabelField {
    /// The field `format`: `mesh-damper` and its name.
    Format,
    /// The field `document` with the same content, where `format` has had another meaning from the start.
    Document,
    /// The document's own fields.
    Own,
}

/// Kind of a document.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Label {
    /// Its name in `hil schema`.
    pub name: &'static str,
    /// Version; it changes if a field is removed, or changes its type or its meaning, but not if one is added.
    pub version: u32,
    /// Field that states it.
    pub field: LabelField,
}

impl Label {
    /// The first version of the document `name`, stated in `field`.
    pub const fn new(name: &'static str, field: LabelField) -> Self {
        Self {
            name,
            version: 1,
            field,
        }
    }

    /// Text of the field `format` or `document`.
    pub fn text(self) -> String {
        format!("mesh-damper {}", self.name)
    }
}

#[derive(Serialize)]
#[serde(untagged)]
enum Head {
    Format { format: String, version: u32 },
    Document { document: String, version: u32 },
    Own {},
}

/// A document with fields, preceded by its label.
#[derive(Serialize)]
pub struct Labelled<'a, T> {
    #[serde(flatten)]
    head: Head,
    #[serde(flatten)]
    content: &'a T,
}

impl<'a, T: Serialize> Labelled<'a, T> {
    /// `content` as the document of this label.
    pub fn new(label: Label, content: &'a T) -> Self {
        let (text, version) = (label.text(), label.version);
        let head = match label.field {
            LabelField::Format => Head::Format {
                format: text,
                version,
            },
            LabelField::Document => Head::Document {
                document: text,
                version,
            },
            LabelField::Own => Head::Own {},
        };
        Self { head, content }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_says_first_which_it_is() {
        #[derive(Serialize)]
        struct Content {
            a: f64,
        }
        let of = |field| {
            let label = Label::new("run", field);
            serde_json::to_string(&Labelled::new(label, &Content { a: 0.1 })).unwrap()
        };
        assert_eq!(
            of(LabelField::Format),
            r#"{"format":"mesh-damper run","version":1,"a":0.1}"#
        );
        assert_eq!(
            of(LabelField::Document),
            r#"{"document":"mesh-damper run","version":1,"a":0.1}"#
        );
        assert_eq!(of(LabelField::Own), r#"{"a":0.1}"#);
    }
}
