//! Results are finite numbers: a NaN or an infinity in one is an error, not a row of a file or a `null`.

use std::fmt::{self, Display};

use serde::ser::{self, Serialize, Serializer};

use crate::error::{InputError, Place};

/// Checks one column of results that the file `name` will hold.
///
/// # Errors
/// The column and the first row, from 1 on, whose value is not finite.
pub fn check_column(name: &str, column: &str, values: &[f64]) -> Result<(), InputError> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(row) => Err(refused(
            name,
            format!("{column} of row {} is {}", row + 1, values[row]),
        )
        .at(Place::Field(column.into()))),
    }
}

/// Checks every number of a document that the file `name` will hold.
///
/// # Errors
/// The field whose value is not finite, or that cannot be written.
pub fn check_document(name: &str, value: &impl Serialize) -> Result<(), InputError> {
    let mut walk = Walk { path: Vec::new() };
    value.serialize(&mut walk).map_err(|NotFinite(problem)| {
        walk.path.reverse();
        let field = walk.path.join(".");
        refused(name, format!("{field} is {problem}")).at(Place::Field(field))
    })
}

fn refused(name: &str, problem: String) -> InputError {
    InputError::new(
        name,
        format!("not written: {problem}"),
        "check the numbers of the model, the recording and the options, and report this if they are right",
    )
}

/// Visits every number of a value.
struct Walk {
    /// After an error: the names that lead to the number, the innermost first.
    path: Vec<String>,
}

/// The number, in words.
#[derive(Debug)]
struct NotFinite(String);

impl Display for NotFinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for NotFinite {}

impl ser::Error for NotFinite {
    fn custom<T: Display>(problem: T) -> Self {
        Self(problem.to_string())
    }
}

type Walked = Result<(), NotFinite>;

impl Walk {
    fn part<T: Serialize + ?Sized>(&mut self, name: impl Display, value: &T) -> Walked {
        value
            .serialize(&mut *self)
            .inspect_err(|_| self.path.push(name.to_string()))
    }
}

macro_rules! without_a_float {
    ($($name:ident($($of:ty),*))*) => {
        $(fn $name(self, $(_: $of),*) -> Walked {
            Ok(())
        })*
    };
}

impl<'w> Serializer for &'w mut Walk {
    type Ok = ();
    type Error = NotFinite;
    type SerializeSeq = Parts<'w>;
    type SerializeTuple = Parts<'w>;
    type SerializeTupleStruct = Parts<'w>;
    type SerializeTupleVariant = Parts<'w>;
    type SerializeMap = Parts<'w>;
    type SerializeStruct = Parts<'w>;
    type SerializeStructVariant = Parts<'w>;

    without_a_float! {
        serialize_bool(bool) serialize_char(char) serialize_str(&str) serialize_bytes(&[u8])
        serialize_i8(i8) serialize_i16(i16) serialize_i32(i32) serialize_i64(i64) serialize_i128(i128)
        serialize_u8(u8) serialize_u16(u16) serialize_u32(u32) serialize_u64(u64) serialize_u128(u128)
        serialize_none() serialize_unit() serialize_unit_struct(&'static str)
        serialize_unit_variant(&'static str, u32, &'static str)
    }

    fn serialize_f32(self, value: f32) -> Walked {
        self.serialize_f64(value.into())
    }

    fn serialize_f64(self, value: f64) -> Walked {
        if value.is_finite() {
            Ok(())
        } else {
            Err(NotFinite(value.to_string()))
        }
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Walked {
        value.serialize(self)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Walked {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        value: &T,
    ) -> Walked {
        self.part(variant, value)
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Parts<'w>, NotFinite> {
        Ok(Parts::of(self))
    }

    fn serialize_tuple(self, _: usize) -> Result<Parts<'w>, NotFinite> {
        Ok(Parts::of(self))
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Parts<'w>, NotFinite> {
        Ok(Parts::of(self))
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Parts<'w>, NotFinite> {
        Ok(Parts::of(self))
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Parts<'w>, NotFinite> {
        Ok(Parts::of(self))
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Parts<'w>, NotFinite> {
        Ok(Parts::of(self))
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Parts<'w>, NotFinite> {
        Ok(Parts::of(self))
    }
}

/// The parts of a list, a map or a structure, by their places or names.
struct Parts<'w> {
    walk: &'w mut Walk,
    place: usize,
    key: String,
}

impl<'w> Parts<'w> {
    fn of(walk: &'w mut Walk) -> Self {
        Self {
            walk,
            place: 0,
            key: String::new(),
        }
    }

    fn next<T: Serialize + ?Sized>(&mut self, value: &T) -> Walked {
        self.place += 1;
        self.walk.part(self.place - 1, value)
    }
}

macro_rules! lists {
    ($($trait:ident: $method:ident;)*) => {
        $(impl ser::$trait for Parts<'_> {
            type Ok = ();
            type Error = NotFinite;

            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Walked {
                self.next(value)
            }

            fn end(self) -> Walked {
                Ok(())
            }
        })*
    };
}

lists! {
    SerializeSeq: serialize_element;
    SerializeTuple: serialize_element;
    SerializeTupleStruct: serialize_field;
    SerializeTupleVariant: serialize_field;
}

macro_rules! structures {
    ($($trait:ident)*) => {
        $(impl ser::$trait for Parts<'_> {
            type Ok = ();
            type Error = NotFinite;

            fn serialize_field<T: Serialize + ?Sized>(
                &mut self,
                name: &'static str,
                value: &T,
            ) -> Walked {
                self.walk.part(name, value)
            }

            fn end(self) -> Walked {
                Ok(())
            }
        })*
    };
}

structures! { SerializeStruct SerializeStructVariant }

impl ser::SerializeMap for Parts<'_> {
    type Ok = ();
    type Error = NotFinite;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Walked {
        // A key that is no text has a place, too.
        let text = serde_json::to_string(key).unwrap_or_default();
        self.key = text.trim_matches('"').to_owned();
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Walked {
        let key = std::mem::take(&mut self.key);
        self.walk.part(key, value)
    }

    fn end(self) -> Walked {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[derive(serde::Serialize)]
    enum Shape {
        Point(f64),
        Pair(f64, f32),
        Named { width: Option<f64> },
    }

    #[derive(serde::Serialize)]
    struct Results {
        name: &'static str,
        counts: [u64; 2],
        shapes: Vec<Shape>,
        more: BTreeMap<String, (f64, f32)>,
    }

    fn results(numbers: [f64; 6]) -> Results {
        let [a, b, c, d, e, f] = numbers;
        Results {
            name: "NaN",
            counts: [1, 2],
            shapes: vec![
                Shape::Point(a),
                Shape::Pair(b, c as f32),
                Shape::Named { width: Some(d) },
                Shape::Named { width: None },
            ],
            more: [("k1".to_owned(), (e, f as f32))].into(),
        }
    }

    #[test]
    fn a_number_that_is_not_finite_is_found_wherever_it_is() {
        let fine = [0.0, -1.0, 1e-300, f64::MAX, 3.0, 4.0];
        assert!(check_document("all.json", &results(fine)).is_ok());
        let fields = [
            "shapes.0.Point",
            "shapes.1.0",
            "shapes.1.1",
            "shapes.2.width",
            "more.k1.0",
            "more.k1.1",
        ];
        for (place, field) in fields.into_iter().enumerate() {
            for (bad, word) in [(f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
                let mut numbers = fine;
                numbers[place] = bad;
                let said = check_document("all.json", &results(numbers))
                    .unwrap_err()
                    .to_string();
                let expected = format!("all.json: field {field}: not written: {field} is {word}");
                assert!(said.starts_with(&expected), "{said}");
            }
        }
    }

    #[test]
    fn a_column_is_finite_from_its_first_row_to_its_last() {
        let mut values = vec![0.5; 10];
        assert!(check_column("a.csv", "force_kN", &values).is_ok());
        values[9] = f64::NAN;
        let said = check_column("a.csv", "force_kN", &values)
            .unwrap_err()
            .to_string();
        assert!(
            said.starts_with("a.csv: field force_kN: not written: force_kN of row 10 is NaN"),
            "{said}"
        );
    }
}
