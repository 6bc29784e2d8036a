//! Names of tables with equal names, and of the columns of two-dimensional arrays.

use std::collections::HashMap;

use super::Table;
use crate::columns::is_own;

/// Adds the number of samples to the names of tables with equal names.
pub(super) fn tell_apart(tables: &mut [Table]) {
    let mut places: HashMap<&str, Vec<usize>> = HashMap::new();
    for (index, table) in tables.iter().enumerate() {
        places.entry(&table.name).or_default().push(index);
    }
    let several: Vec<Vec<usize>> =
        (places.into_values().filter(|places| places.len() > 1)).collect();
    for places in several {
        for (index, table) in places.into_iter().enumerate() {
            let table = &mut tables[table];
            let samples = table.rows.unwrap_or_default();
            let place = index + 1;
            let name = format!("{} #{place} ({samples} samples)", table.name.trim());
            name.trim().clone_into(&mut table.name);
        }
    }
}

/// The names of the columns into which a two-dimensional array is split: `name #1`, `name #2`; for a single one, `name`. In
/// brackets a number would look like a unit. A name in our own form keeps its unit: `force #1 [kN]`.
pub(super) fn name_of(name: &str, index: u64, columns: u64) -> String {
    let number = index.saturating_add(1);
    match name.split_once('_').filter(|_| is_own(name)) {
        _ if columns == 1 => name.to_owned(),
        Some((quantity, unit)) => format!("{quantity} #{number} [{unit}]"),
        None => format!("{name} #{number}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_in_a_name_is_no_unit() {
        for (name, of) in [
            ("data", "data #2"),
            ("Force [kN]", "Force [kN] #2"),
            ("force_kN", "force #2 [kN]"),
            ("velocity_mm_s", "velocity #2 [mm_s]"),
            ("force", "force #2"),
            ("load_cell", "load_cell #2"),
        ] {
            assert_eq!(name_of(name, 1, 2), of);
            assert_eq!(name_of(name, 0, 1), name);
        }
    }
}
