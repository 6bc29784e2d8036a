//! Names of tables with equal names, and of the columns of two-dimensional arrays.

use super::Table;
use crate::columns::is_own;

/// Adds the number of samples to the names of tables with equal names.
pub(super) fn tell_apart(tables: &mut [Table]) {
    let names: Vec<String> = tables.iter().map(|table| table.name.clone()).collect();
    for (index, table) in tables.iter_mut().enumerate() {
        let same = names.iter().filter(|name| **name == table.name).count();
        if same > 1 {
            let before = names[..index]
                .iter()
                .filter(|name| **name == table.name)
                .count();
            let samples = table.rows.unwrap_or_default();
            let name = table.name.trim();
            let place = before + 1;
            table.name = format!("{name} #{place} ({samples} samples)")
                .trim()
                .to_owned();
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
