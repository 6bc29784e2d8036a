//! The address of a board.

use std::borrow::Cow;
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Serialize, Serializer};

/// A serial port, `serial:PORT`.
#[derive(Clone, Debug, PartialEq)]
pub struct Port(PathBuf);

impl Port {
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl FromStr for Port {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.strip_prefix("serial:") {
            Some(port) if !port.is_empty() => Ok(Self(port.into())),
            _ => Err("give serial:PORT, such as serial:/dev/ttyACM0".into()),
        }
    }
}

impl Display for Port {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "serial:{}", self.0.display())
    }
}

impl JsonSchema for Port {
    fn schema_name() -> Cow<'static, str> {
        "Port".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({"type": "string", "description": "A serial port, as `serial:PORT`."})
    }
}

impl Serialize for Port {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
