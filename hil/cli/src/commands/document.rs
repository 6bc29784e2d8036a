//! The JSON documents of the commands.

use std::path::PathBuf;

use mesh_damper_identify::trace::result::TraceResult;
use mesh_damper_model::file::ModelFile;
use mesh_damper_output::error::InputError;
use mesh_damper_output::{Label, LabelField, Labelled, Outputs};
use serde::Serialize;

/// A JSON document of a command. It states its type and version.
pub trait Document: Serialize {
    /// The document's type and version.
    const LABEL: Label;
}

/// Outputs that take documents.
pub trait AddDocument {
    /// Adds `document` under a planned path, as indented JSON.
    ///
    /// # Errors
    /// A value that JSON cannot hold.
    fn add_document<T: Document>(
        &mut self,
        path: impl Into<PathBuf>,
        document: &T,
    ) -> Result<(), InputError>;

    /// [`Self::add_document`] under the path that an option gives, if it does.
    ///
    /// # Errors
    /// As [`Self::add_document`].
    fn add_document_if<T: Document>(
        &mut self,
        path: &Option<PathBuf>,
        document: &T,
    ) -> Result<(), InputError> {
        path.as_ref()
            .map_or(Ok(()), |path| self.add_document(path, document))
    }
}

impl AddDocument for Outputs {
    fn add_document<T: Document>(
        &mut self,
        path: impl Into<PathBuf>,
        document: &T,
    ) -> Result<(), InputError> {
        match T::LABEL.field {
            // The document may be an array, which can have no additional fields.
            LabelField::Own => self.add_json(path, document),
            LabelField::Format | LabelField::Document => {
                self.add_json(path, &Labelled::new(T::LABEL, document))
            }
        }
    }
}

impl Document for TraceResult {
    const LABEL: Label = Self::LABEL;
}

impl Document for ModelFile {
    const LABEL: Label = Label::new("model", LabelField::Own);
}

impl Document for super::demo::Summary<'_> {
    const LABEL: Label = Label::new("demo", LabelField::Format);
}

impl Document for super::predict::Summary<'_> {
    const LABEL: Label = Label::new("predict", LabelField::Format);
}

impl Document for super::predict::LawMotion<'_> {
    const LABEL: Label = Label::new("motion", LabelField::Format);
}

impl Document for super::respond::Summary<'_> {
    const LABEL: Label = Label::new("respond", LabelField::Format);
}

impl Document for super::respond_sweep::Summary<'_> {
    const LABEL: Label = Label::new("transmissibility", LabelField::Format);
}

impl Document for super::inspect::Report<'_> {
    const LABEL: Label = Label::new("inspect", LabelField::Format);
}
