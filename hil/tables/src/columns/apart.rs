//! Channels that lie in different tables of a file, which were sampled at different times.

use mesh_damper_output::error::{InputError, quoted};

use super::meaning::Meanings;
use super::{taken, unit_found};
use crate::channel::Channel;
use crate::files::{Needs, Reading, Table};

/// Message that the required channels are all in the file, but not together in one table; `None` if this is not the problem.
pub(super) fn apart(
    file: &str,
    meanings: &Meanings<'_>,
    meant: &[usize],
    reading: &Reading,
    needs: &Needs,
) -> Option<InputError> {
    let channels = Channel::ALL.into_iter();
    let mut places = Vec::new();
    for channel in channels.filter(|&channel| channel != Channel::Time && needs.has(channel)) {
        let said = reading.channels.iter().find(|(of, _)| of == channel.name());
        let has_it = |&&index: &&usize| match said {
            Some((_, name)) => {
                let mut columns = meanings.tables[index].columns.iter();
                columns.any(|column| *name == column.name)
            }
            None => meanings.of[index].iter().any(|each| each.may_be(channel)),
        };
        let index = *meant.iter().find(has_it)?;
        places.push((channel, index, &meanings.tables[index]));
    }
    let (_, first, _) = *places.first()?;
    if places.iter().all(|(_, index, _)| *index == first) {
        return None;
    }
    let starts = places
        .iter()
        .map(|(.., table)| table.clock.map(|clock| clock.start));
    let starts: Vec<Option<f64>> = starts.collect();
    let differ = starts.windows(2).any(|pair| pair[0] != pair[1]);
    let each = places
        .iter()
        .zip(&starts)
        .map(|((channel, _, table), start)| {
            let times = [
                rate(table).map(|rate| format!("{rate} Hz")),
                table.rows.map(|rows| format!("{rows} samples")),
                start
                    .filter(|_| differ)
                    .map(|start| format!("from {} s", crate::write::decimal(start))),
            ];
            let times: Vec<String> = times.into_iter().flatten().collect();
            let name = quoted(&table.name);
            format!(
                "{} is in table {name} ({})",
                channel.name(),
                times.join(", ")
            )
        });
    let each: Vec<String> = each.collect();
    Some(InputError::new(
        file,
        format!("{}: they were sampled at different times", each.join(", ")),
        "write all channels at one rate and the same times into one table, with the program that recorded them or with pandas' merge_asof",
    ))
}

/// Samples per second, to four digits, if the table states it or its first times show it.
fn rate(table: &Table) -> Option<f64> {
    let of_times = || {
        let time = table
            .columns
            .iter()
            .find(|column| taken::of_times(column).is_time)?;
        let unit = match unit_found::unit_for(time, Channel::Time) {
            unit_found::UnitFound::Known(unit) => unit,
            _ => return None,
        };
        let (first, last) = (time.first.first()?, time.first.last()?);
        Some(unit.to_code(last - first) / (time.first.len() as f64 - 1.0))
    };
    let step = table.clock.map(|clock| clock.step).or_else(of_times)?;
    let rate = format!("{:.3e}", 1.0 / step).parse::<f64>().ok()?;
    (rate.is_finite() && rate > 0.0).then_some(rate)
}
