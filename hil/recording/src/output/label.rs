//! What a JSON document says of itself: which it is, and in which version.

use serde::Serialize;

/// How a document says which it is. It does so beside its version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LabelField {
    /// By a field `format`: `mesh-damper` and its name.
    Format,
    /// By a field `document` with the same, where `format` has meant something else from the start.
    Document,
    /// By fields of its own.
    Own,
}

/// Which document it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Label {
    /// As `hil schema` knows it.
    pub name: &'static str,
    /// Another one when a field goes, or changes its type or its meaning; not when one is added.
    pub version: u32,
    /// How it says so.
    pub field: LabelField,
}

impl Label {
    /// The first version of the document `name`, which says so by `field`.
    pub const fn new(name: &'static str, field: LabelField) -> Self {
        Self {
            name,
            version: 1,
            field,
        }
    }

    /// What the field `format` or `document` says.
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

/// A document, which has fields, with what it says of itself before all else.
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
