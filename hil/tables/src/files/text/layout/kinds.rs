//! A column holds numbers, stamps of time or words: most of its cells in the head decide.

use mesh_damper_output::error::{InputError, quoted};

use super::super::header::{self, Header};
use super::super::numbers::{Cell, Numbers};
use super::super::stamps::{Since, Stamp};
use super::Found;
use crate::files::Column;

/// Kind of a column's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::files::text) enum Kind {
    Numbers,
    /// Dates or times of day, read as seconds from the first.
    Stamps,
    Words,
}

impl Found<'_> {
    pub(super) fn columns(
        &self,
        header: &Header,
        kinds: &[Kind],
        samples: &[(u64, Vec<&str>)],
        numbers: Numbers,
        guesses: &mut Vec<String>,
    ) -> Result<Vec<Column>, InputError> {
        let first_values = samples.len().min(Column::FIRST) as u64 * size_of::<f64>() as u64;
        let texts = header.names.iter().chain(header.units.iter().flatten());
        let texts: u64 = texts.map(|text| text.len() as u64).sum();
        let of_columns = (size_of::<Column>() as u64 + first_values) * header.names.len() as u64;
        self.budget.hold(of_columns + texts, "its columns")?;
        let names = header::distinct(&header.names, guesses);
        let each = names.into_iter().enumerate().map(|(index, name)| {
            let kind = kinds.get(index).copied().unwrap_or(Kind::Words);
            let cells = samples.iter().map(|(_, row)| row.get(index).copied().unwrap_or_default());
            let is_word = |cell: &&str| {
                matches!(numbers.read(cell), Cell::Words) && Stamp::of(cell).is_none()
            };
            let words = (kind == Kind::Words).then(|| cells.clone().find(is_word)).flatten();
            let mut unit = (header.units.as_ref())
                .and_then(|units| units.get(index))
                .filter(|unit| !unit.is_empty())
                .cloned();
            if kind == Kind::Stamps {
                guesses.push(format!(
                    "column {} holds dates or times of day; they are read as seconds after the first",
                    quoted(&name)
                ));
                unit = Some("s".into());
            }
            Column {
                is_numeric: kind != Kind::Words,
                is_stamp: kind == Kind::Stamps,
                words: words.map(str::to_owned),
                first: first(cells, kind, numbers),
                name,
                unit,
                ..Column::default()
            }
        });
        Ok(each.collect())
    }
}

/// Kinds of the columns, from the rows of the head.
pub(super) fn kinds(samples: &[(u64, Vec<&str>)], cells: usize, numbers: Numbers) -> Vec<Kind> {
    let kind = |column: usize| {
        let (mut figures, mut stamps, mut words) = (0, 0, 0);
        for (_, row) in samples {
            let cell = row.get(column).copied().unwrap_or_default();
            match numbers.read(cell) {
                Cell::Blank => {}
                Cell::Words if Stamp::of(cell).is_some() => stamps += 1,
                Cell::Words => words += 1,
                Cell::Number(_) | Cell::NotFinite | Cell::OtherSign => figures += 1,
            }
        }
        if stamps > figures + words {
            Kind::Stamps
        } else if words > figures {
            Kind::Words
        } else {
            Kind::Numbers
        }
    };
    (0..cells).map(kind).collect()
}

fn first<'c>(cells: impl Iterator<Item = &'c str>, kind: Kind, numbers: Numbers) -> Vec<f64> {
    let mut since = None;
    let value = |cell: &'c str| match kind {
        Kind::Stamps => {
            let stamp = Stamp::of(cell)?;
            let since = since.get_or_insert_with(|| Since::of(&stamp));
            since.seconds(&stamp).ok()
        }
        Kind::Numbers | Kind::Words => match numbers.read(cell) {
            Cell::Number(value) => Some(value),
            _ => None,
        },
    };
    let values = cells.take(Column::FIRST).map(value);
    values.map(|value| value.unwrap_or(f64::NAN)).collect()
}
