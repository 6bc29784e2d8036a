//! The units that pandas keeps with a table, in `DataFrame.attrs["units"]`.

use std::collections::HashMap;
use std::fmt;

use mesh_damper_output::error::InputError;
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};

use crate::room::Room;

/// Bytes held for a byte of the text: an entry of eight takes two texts and their place.
const OF_BYTE: u64 = 16;

/// The unit of each column by its name. `room` holds them.
///
/// # Errors
/// The budget has no room for them.
pub(super) fn units(said: &str, room: &mut Room) -> Result<HashMap<String, String>, InputError> {
    room.more(OF_BYTE * said.len() as u64, "the units that pandas wrote")?;
    let said: Option<Said> = serde_json::from_str(said).ok();
    let attributes = said.map(|said| said.attributes).unwrap_or_default();
    let units = attributes.units.or(attributes.unit).unwrap_or_default();
    let texts = units
        .into_iter()
        .filter_map(|(name, unit)| Some((name, unit.0?)));
    Ok(texts.collect())
}

#[derive(Deserialize)]
struct Said {
    attributes: Attributes,
}

#[derive(Default, Deserialize)]
struct Attributes {
    units: Option<HashMap<String, Text>>,
    unit: Option<HashMap<String, Text>>,
}

/// A text, or `None` for anything else.
struct Text(Option<String>);

impl<'de> Deserialize<'de> for Text {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(OfAny)
    }
}

struct OfAny;

impl<'de> Visitor<'de> for OfAny {
    type Value = Text;

    fn expecting(&self, to: &mut fmt::Formatter) -> fmt::Result {
        to.write_str("any value")
    }

    fn visit_str<E>(self, text: &str) -> Result<Text, E> {
        Ok(Text(Some(text.to_owned())))
    }

    fn visit_unit<E>(self) -> Result<Text, E> {
        Ok(Text(None))
    }

    fn visit_bool<E>(self, _: bool) -> Result<Text, E> {
        Ok(Text(None))
    }

    fn visit_i64<E>(self, _: i64) -> Result<Text, E> {
        Ok(Text(None))
    }

    fn visit_u64<E>(self, _: u64) -> Result<Text, E> {
        Ok(Text(None))
    }

    fn visit_f64<E>(self, _: f64) -> Result<Text, E> {
        Ok(Text(None))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut each: A) -> Result<Text, A::Error> {
        while each.next_element::<IgnoredAny>()?.is_some() {}
        Ok(Text(None))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut each: A) -> Result<Text, A::Error> {
        while each.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(Text(None))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::Budget;
    use crate::read_limit::ReadLimit;

    #[test]
    fn units_are_the_texts_among_what_pandas_wrote() {
        let budget = Budget::new("a.parquet", ReadLimit::default());
        let of = |said: &str| {
            let mut units: Vec<_> = (units(said, &mut Room::of(&budget)).unwrap())
                .into_iter()
                .collect();
            units.sort();
            units
                .iter()
                .map(|(name, unit)| format!("{name} {unit}"))
                .collect::<Vec<_>>()
        };
        let said = r#"{"columns": [{"a": 1}], "attributes": {"units": {"F": "kN", "n": 1, "l": [{}], "m": {"a": null}}, "rig": "B"}}"#;
        assert_eq!(of(said), ["F kN"]);
        assert_eq!(of(r#"{"attributes": {"unit": {"F": "kN"}}}"#), ["F kN"]);
        for none in [
            "",
            "{}",
            r#"{"attributes": 1}"#,
            r#"{"attributes": {"units": "kN"}}"#,
        ] {
            assert!(of(none).is_empty(), "{none}");
        }
    }
}
