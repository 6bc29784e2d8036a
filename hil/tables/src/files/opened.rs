//! A file whose tables are known, and whose columns are read one by one.

use std::collections::HashMap;
use std::rc::Rc;

use mesh_damper_output::error::{InputError, Place};

use super::guard::guarded;
use super::refused::Refused;
use super::{Kept, Table, Tables, Values, Wanted};
use crate::budget::{Budget, of_list};

/// The values of a column of a table, which is asked for once; `None` if they are not numbers.
type Read<'a> = dyn FnMut(usize, usize) -> Result<Option<Vec<f64>>, Refused> + 'a;

/// A file of any format but text.
pub(super) struct Opened<'a> {
    format: &'static str,
    budget: Rc<Budget>,
    name: String,
    tables: Vec<Table>,
    comments: Vec<String>,
    read: Box<Read<'a>>,
}

impl<'a> Opened<'a> {
    /// A file of `format` called `name`; `read` returns the values of a column of a table, and charges them to `budget`. It may call
    /// decoders of other authors.
    ///
    /// # Errors
    /// A file without a table.
    pub fn new(
        format: &'static str,
        budget: Rc<Budget>,
        name: String,
        tables: Vec<Table>,
        comments: Vec<String>,
        read: impl FnMut(usize, usize) -> Result<Option<Vec<f64>>, Refused> + 'a,
    ) -> Result<Self, InputError> {
        if tables.iter().all(|table| table.columns.is_empty()) {
            let skipped: Vec<&str> = tables
                .iter()
                .flat_map(|table| table.skipped.iter().map(String::as_str))
                .take(8)
                .collect();
            let problem = if skipped.is_empty() {
                "holds no columns of numbers".to_owned()
            } else {
                format!(
                    "holds no columns of numbers; not read: {}",
                    skipped.join(", ")
                )
            };
            return Err(InputError::new(
                name,
                problem,
                "check that it is the right file",
            ));
        }
        Ok(Self {
            format,
            budget,
            name,
            tables,
            comments,
            read: Box::new(read),
        })
    }
}

impl Opened<'_> {
    /// The values of a column, and whether they are as many as the table has rows.
    fn values(&mut self, table: usize, wanted: &Wanted) -> Result<Option<Vec<f64>>, InputError> {
        let column = &self.tables[table].columns[wanted.column];
        let values = match column.is_numeric {
            true => guarded(self.format, &self.name, || {
                let read = (self.read)(table, wanted.column);
                read.map_err(|why| why.error(self.format, &self.name))
            })?,
            false => None,
        };
        let refused = |problem: String, remedy: &str| {
            let place = Place::Column(column.name.clone());
            InputError::new(&self.name, problem, remedy).at(place)
        };
        if values.is_none() && wanted.must_be_numeric {
            return Err(refused(
                "its values are not numbers".into(),
                "name another column, or write numbers",
            ));
        }
        if let (Some(rows), Some(values)) = (self.tables[table].rows, &values)
            && values.len() as u64 != rows
        {
            let problem = format!("it has {} values for {rows} rows", values.len());
            return Err(refused(problem, "check that the file is complete"));
        }
        Ok(values)
    }
}

impl Tables for Opened<'_> {
    fn tables(&self) -> &[Table] {
        &self.tables
    }

    fn read(
        mut self: Box<Self>,
        table: usize,
        wanted: &[Wanted],
        _: Kept,
    ) -> Result<Values, InputError> {
        let mut columns: Vec<Option<Vec<f64>>> = Vec::new();
        let mut places: HashMap<usize, usize> = HashMap::new();
        for (place, wanted) in wanted.iter().enumerate() {
            let known = *places.entry(wanted.column).or_insert(place);
            let values = if known == place {
                self.values(table, wanted)?
            } else {
                columns[known].clone()
            };
            columns.push(values);
        }
        Ok(Values {
            columns,
            comments: self.comments,
            ..Values::default()
        })
    }

    fn look(
        mut self: Box<Self>,
        table: usize,
        wanted: &[Wanted],
        look: &mut dyn FnMut(usize, &[f64]),
    ) -> Result<Values, InputError> {
        for wanted in wanted {
            if let Some(values) = self.values(table, wanted)? {
                look(wanted.column, &values);
                self.budget.release(of_list::<f64>(values.len()));
            }
        }
        Ok(Values {
            comments: self.comments,
            ..Values::default()
        })
    }
}
