//! Finds which arrays of a file are columns of one table.
//!
//! Programs that write arrays show in several ways which belong together: a group of channels with its times, a group for each
//! channel with the same times repeated, a variable `t` next to `y` and `F`. There is one rule: arrays of one length with the same
//! times are a table.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

use super::beside::Beside;
pub(super) use super::names::name_of;
use super::names::tell_apart;
use super::runs;
use super::table::{Clock, StatedStep};
use super::{Column, Table};
use crate::columns::{is_time, may_be_time};
use mesh_damper_output::error::{InputError, quoted};

/// The most columns that a file may have. Convention: more than any bus logger writes, and little enough to hold their names.
pub(super) const MOST_COLUMNS: usize = 1 << 17;
/// The most columns into which one array is split. Convention: the number of channels of all of a rig's loggers.
pub(super) const MOST_OF_ARRAY: u64 = 1024;

/// An array of a file, or a column of one.
#[derive(Clone, Debug)]
pub(super) struct Array<S> {
    /// The groups that contain it, the outermost first.
    pub group: Vec<String>,
    /// Its column in a table; its name is the one within the group.
    pub column: Column,
    /// Number of values.
    pub rows: u64,
    /// Times of its values, if the file states them without an array.
    pub clock: Option<Clock>,
    /// Where its values are.
    pub source: S,
}

impl<S> Array<S> {
    /// Its groups and its name.
    fn path(&self) -> Vec<String> {
        let name = std::iter::once(&self.column.name);
        self.group.iter().chain(name).cloned().collect()
    }
}

/// The tables made of arrays, and the source of the values of each of their columns.
pub(super) type Arranged<S> = (Vec<Table>, Vec<Vec<S>>);

/// Combines arrays into tables, in the order of the file, with the file's other statements in `beside`. `values` returns an array's
/// values.
///
/// # Errors
/// The errors of `values`.
pub(super) fn arranged<S: Clone>(
    arrays: Vec<Array<S>>,
    beside: &Beside,
    values: &mut dyn FnMut(&S) -> Result<Vec<f64>, InputError>,
) -> Result<Arranged<S>, InputError> {
    let paths: Vec<Vec<String>> = arrays.iter().map(Array::path).collect();
    let beside = &beside.spread(&paths);
    let mut lengths: Vec<(u64, Vec<Array<S>>)> = Vec::new();
    let mut place = HashMap::new();
    for array in arrays {
        let at = *place.entry(array.rows).or_insert(lengths.len());
        match lengths.get_mut(at) {
            Some((_, of_length)) => of_length.push(array),
            None => lengths.push((array.rows, vec![array])),
        }
    }
    let mut tables = Vec::new();
    let mut sources = Vec::new();
    for (rows, arrays) in lengths {
        for members in divided(arrays, values)? {
            for (name, members) in of_runs(members) {
                let (table, of_table) = table(rows, name, members, beside);
                tables.push(table);
                sources.push(of_table);
            }
        }
    }
    tell_apart(&mut tables);
    Ok((tables, sources))
}

/// The common property of the arrays of one table.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Times {
    /// The values of an array of times, as a number that other values do not have.
    Array(u64),
    Clock(Clock),
    None,
}

#[derive(Clone)]
struct Member<S> {
    array: Array<S>,
    /// Whether it is the table's column of times.
    is_time: bool,
    /// Whether its times lie in another group, so that only their number connects them.
    is_guessed: bool,
}

/// Arrays of one length, divided by their times.
fn divided<S>(
    arrays: Vec<Array<S>>,
    values: &mut dyn FnMut(&S) -> Result<Vec<f64>, InputError>,
) -> Result<Vec<Vec<Member<S>>>, InputError> {
    let times = axes_of_groups(&arrays);
    let several = times.iter().filter(|&&is_time| is_time).count() > 1;
    // Each array of times: its group and its values.
    let mut axes: Vec<(Vec<String>, u64)> = Vec::new();
    let mut of_array = Vec::new();
    for (array, is_time) in arrays.iter().zip(&times) {
        let mark = match is_time {
            true if several => Some(mark(&values(&array.source)?)),
            true => Some(0),
            false => None,
        };
        if let Some(mark) = mark {
            axes.push((array.group.clone(), mark));
        }
        of_array.push(mark);
    }
    let mut found: Vec<(Times, Vec<Member<S>>)> = Vec::new();
    for (array, mark) in arrays.into_iter().zip(of_array) {
        let is_time = mark.is_some();
        let (times, is_guessed) = match (mark, array.clock) {
            (Some(mark), _) => (Times::Array(mark), false),
            (None, clock) => match nearest(&array.group, &axes) {
                // Times in its own group have precedence over a clock, and a clock over times elsewhere.
                Some((mark, true)) => (Times::Array(mark), false),
                Some((mark, false)) if clock.is_none() => (Times::Array(mark), true),
                _ => (clock.map_or(Times::None, Times::Clock), false),
            },
        };
        let member = Member {
            array,
            is_time,
            is_guessed,
        };
        match found.iter_mut().find(|(known, _)| *known == times) {
            Some((_, members)) => members.push(member),
            None => found.push((times, vec![member])),
        }
    }
    Ok(found.into_iter().map(|(_, members)| members).collect())
}

/// The arrays that are the times of their groups: at most one in each, that which the file marks as such if there is one.
fn axes_of_groups<S>(arrays: &[Array<S>]) -> Vec<bool> {
    let mut axes: HashMap<&[String], usize> = HashMap::new();
    for (index, array) in arrays.iter().enumerate() {
        if array.column.is_time || is_time(&array.column) {
            let known = axes.entry(&array.group).or_insert(index);
            if array.column.is_time && !arrays[*known].column.is_time {
                *known = index;
            }
        }
    }
    let is_axis = |(index, array): (usize, &Array<S>)| axes.get(&array.group[..]) == Some(&index);
    arrays.iter().enumerate().map(is_axis).collect()
}

/// The times nearest to a group, and whether they lie in it or around it; `None` if two are equally near.
fn nearest(group: &[String], axes: &[(Vec<String>, u64)]) -> Option<(u64, bool)> {
    let shared = |axis: &[String]| axis.iter().zip(group).take_while(|(a, b)| a == b).count();
    let most = axes.iter().map(|(axis, _)| shared(axis)).max()?;
    let mut near = axes.iter().filter(|(axis, _)| shared(axis) == most);
    let (axis, mark) = near.next()?;
    let around = near.all(|(_, other)| other == mark);
    around.then_some((*mark, group.starts_with(axis)))
}

/// A hash of values, which other values share only with a probability of 2⁻⁶⁴, so that many columns of times need not be held at
/// once.
fn mark(values: &[f64]) -> u64 {
    let mut hasher = DefaultHasher::new();
    values
        .iter()
        .for_each(|value| value.to_bits().hash(&mut hasher));
    hasher.finish()
}

/// The members of each run in its order, with one column of times, and the run's name if there are several.
fn of_runs<S: Clone>(members: Vec<Member<S>>) -> Vec<(Option<String>, Vec<Member<S>>)> {
    let described: Vec<runs::Member<'_>> = (members.iter())
        .map(|member| runs::Member {
            group: &member.array.group,
            name: &member.array.column.name,
            is_time: member.is_time,
        })
        .collect();
    let found = runs::runs(&described);
    let is_one = found.len() == 1;
    let time = (0..members.len()).find(|&index| members[index].is_time);
    let each = found.into_iter().map(|(path, mut run)| {
        let mut has_time = false;
        // A repetition of the same times is dropped.
        run.retain(|&index| !members[index].is_time || !std::mem::replace(&mut has_time, true));
        if let (Some(time), false) = (time, has_time) {
            run.insert(0, time);
        }
        let name = match path.join("/") {
            _ if is_one => None,
            name if name.is_empty() => Some("/".to_owned()),
            name => Some(name),
        };
        (
            name,
            run.into_iter()
                .map(|index| members[index].clone())
                .collect(),
        )
    });
    each.collect()
}

fn table<S>(
    rows: u64,
    name: Option<String>,
    members: Vec<Member<S>>,
    beside: &Beside,
) -> (Table, Vec<S>) {
    let mut group: Option<Vec<String>> = None;
    for member in &members {
        let of_member = &member.array.group;
        let shared = match &group {
            Some(group) => (group.iter().zip(of_member).take_while(|(a, b)| a == b)).count(),
            None => of_member.len(),
        };
        group = Some(of_member[..shared].to_vec());
    }
    let group = group.unwrap_or_default();
    let mut table = Table {
        name: name.unwrap_or_else(|| group.join("/")),
        rows: Some(rows),
        ..Table::default()
    };
    let time = members.iter().find(|member| member.is_time);
    let is_guessed = members.iter().any(|member| member.is_guessed);
    if let (Some(time), true) = (time, is_guessed) {
        let path = time.array.path();
        table.guesses.push(format!(
            "the times of {} are used for other groups without times, which have as many samples",
            path.join("/")
        ));
    }
    let clock = |member: &Member<S>| member.array.clock;
    let mut clocks = members.iter().filter_map(clock);
    if let (Some(time), Some(first)) = (time, clocks.next())
        && clocks.any(|other| other != first)
    {
        table.guesses.push(format!(
            "the times of column {} are used for all columns of its group, although their own clocks differ",
            quoted(&time.array.column.name)
        ));
    }
    let paths: Vec<Vec<String>> = members.iter().map(|each| each.array.path()).collect();
    table.guesses.extend(beside.notes(&paths));
    let has_times = members
        .iter()
        .any(|member| member.array.clock.is_some() || may_be_time(&member.array.column));
    let (clock, said) = match time.is_some() || has_times {
        true => (None, None),
        false => beside.clock(&paths),
    };
    if clock.is_none() && said.is_none() {
        table.skipped.extend(beside.rates(&paths));
    }
    table.clock = clock;
    table.guesses.extend(said);
    table.stated_steps = beside.steps(&paths);
    for (member, path) in members.iter().zip(&paths) {
        if let Some(Clock { step, .. }) = member.array.clock {
            let taken = format!("the clock of {}, with a step of {step} s,", path.join("/"));
            table.stated_steps.push(StatedStep { step, taken });
        }
    }
    let mut seen = HashMap::new();
    for member in &members {
        *seen.entry(member.array.column.name.clone()).or_insert(0) += 1;
    }
    let mut sources = Vec::new();
    for Member { array, .. } in members {
        let mut column = array.column;
        if seen.get(&column.name).is_some_and(|&times| times > 1) {
            let mut path = array.group[group.len()..].to_vec();
            path.push(column.name);
            column.name = path.join("/");
        }
        table.clock = table.clock.or(array.clock);
        table.columns.push(column);
        sources.push(array.source);
    }
    (table, sources)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(path: &str, values: &[f64]) -> Array<Vec<f64>> {
        let mut group: Vec<String> = path.split('/').map(str::to_owned).collect();
        let name = group.pop().unwrap();
        Array {
            group,
            column: Column {
                name,
                is_numeric: true,
                ..Column::default()
            },
            rows: values.len() as u64,
            clock: None,
            source: values.to_vec(),
        }
    }

    /// `name: column, column`, each table.
    fn said(arrays: Vec<Array<Vec<f64>>>) -> Vec<String> {
        let (tables, sources) =
            arranged(arrays, &Beside::default(), &mut |values| Ok(values.clone())).unwrap();
        assert_eq!(tables.len(), sources.len());
        let each = tables.iter().zip(sources).map(|(table, sources)| {
            assert_eq!(table.columns.len(), sources.len());
            let names: Vec<&str> = table
                .columns
                .iter()
                .map(|each| each.name.as_str())
                .collect();
            format!("{}: {}", table.name, names.join(", "))
        });
        each.collect()
    }

    #[test]
    fn arrays_of_the_same_times_are_one_table() {
        let (t, late, y) = ([0.0, 1.0, 2.0], [5.0, 6.0, 7.0], [0.1, 0.2, 0.3]);
        // Variables next to each other.
        let flat = vec![array("t", &t), array("y", &y), array("F", &y)];
        assert_eq!(said(flat), [": t, y, F"]);
        // A group for each channel, with the same times repeated.
        let appended = vec![
            array("0/time", &t),
            array("0/y", &y),
            array("1/time", &t),
            array("1/F", &y),
        ];
        assert_eq!(said(appended), [": time, y, F"]);
        // Two tests in one file.
        let two = vec![
            array("a/t", &t),
            array("a/y", &y),
            array("b/t", &late),
            array("b/y", &y),
        ];
        assert_eq!(said(two), ["a: t, y", "b: t, y"]);
        // Two runs of one test with the same times, also if only one contains them.
        let runs = vec![
            array("1/t", &t),
            array("1/y", &y),
            array("1/F", &y),
            array("2/t", &t),
            array("2/y", &y),
            array("2/F", &y),
        ];
        assert_eq!(said(runs.clone()), ["1: t, y, F", "2: t, y, F"]);
        let shared: Vec<Array<Vec<f64>>> = (runs.into_iter().enumerate())
            .filter(|(index, _)| *index != 3)
            .map(|(_, array)| array)
            .collect();
        assert_eq!(said(shared), ["1: t, y, F", "2: t, y, F"]);
        // Times in their own group.
        let apart = vec![
            array("x/time", &t),
            array("y/disp", &y),
            array("z/disp", &y),
        ];
        assert_eq!(said(apart), [": time, y/disp, z/disp"]);
        // Another rate.
        let rates = vec![
            array("t", &t),
            array("y", &y),
            array("slow/t", &t[..2]),
            array("slow/T", &y[..2]),
        ];
        assert_eq!(said(rates), [": t, y", "slow: t, T"]);
    }

    #[test]
    fn times_that_two_groups_could_have_are_none() {
        let (t, late, y) = ([0.0, 1.0], [5.0, 6.0], [0.1, 0.2]);
        let arrays = vec![array("a/t", &t), array("b/t", &late), array("y", &y)];
        assert_eq!(said(arrays), ["a: t", "b: t", ": y"]);
    }

    #[test]
    fn a_clock_counts_where_no_times_lie_beside() {
        let y = [0.1, 0.2];
        let clocked = |path, step| {
            let clock = Some(Clock { start: 0.0, step });
            Array {
                clock,
                ..array(path, &y)
            }
        };
        let arrays = vec![
            clocked("g/y", 0.1),
            clocked("g/F", 0.1),
            clocked("h/T", 0.5),
        ];
        assert_eq!(said(arrays), ["g: y, F", "h: T"]);
    }
}
