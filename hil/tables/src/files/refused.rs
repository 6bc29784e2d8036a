//! Why a file cannot be read.

use std::borrow::Cow;

use mesh_damper_output::error::InputError;

use super::guard::damaged;

/// What a reader of a format finds, before it is an error of the file.
#[derive(Debug)]
pub(super) enum Refused {
    /// The file, or the part that is read, is damaged; in words.
    Damaged(Cow<'static, str>),
    /// It uses a part of its format that is not read, in words; and how to write it without it.
    Unread(String, &'static str),
    /// What is to be said is known already.
    Said(InputError),
}

impl From<&'static str> for Refused {
    fn from(why: &'static str) -> Self {
        Self::Damaged(why.into())
    }
}

impl From<InputError> for Refused {
    fn from(error: InputError) -> Self {
        Self::Said(error)
    }
}

impl Refused {
    /// The error of a file of `format`.
    pub fn error(self, format: &str, file: &str) -> InputError {
        match self {
            Self::Damaged(why) => damaged(format, file, why),
            Self::Unread(what, otherwise) => {
                let problem = format!("uses a part of {format} that hil does not read: {what}");
                InputError::new(file, problem, otherwise)
            }
            Self::Said(error) => error,
        }
    }
}
