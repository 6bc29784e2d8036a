//! Finds which arrays of a file are columns of one table.
//!
//! Programs that write arrays show in several ways which belong together: a group of channels with its times, a group for each
//! channel with the same times repeated, a variable `t` next to `y` and `F`. There is one rule: arrays of one length with the same
//! times are a table.

use std::collections::HashMap;

use super::about::{About, Named};
use super::beside::Beside;
use super::groups::{Group, Groups};
pub(super) use super::names::name_of;
use super::names::tell_apart;
use super::number::shown;
use super::runs;
use super::same_times::{Found, keep_first};
use super::table::{Clock, StatedStep};
use super::{Column, Table};
use crate::budget::{Budget, of_list};
use crate::columns;
use mesh_damper_output::error::{InputError, quoted};

/// The most columns into which one array is split. Convention: an array with more is an image or a spectrum, not channels.
pub(super) const MOST_OF_ARRAY: u64 = 1024;

/// An array of a file, or a column of one.
#[derive(Clone, Debug)]
pub(super) struct Array<S> {
    /// The group that contains it.
    pub group: Group,
    /// Its column in a table; its name is the one within the group.
    pub column: Column,
    /// Number of values.
    pub rows: u64,
    /// Times of its values, if the file states them without an array.
    pub clock: Option<Clock>,
    /// Where its values are.
    pub source: S,
}

/// Where the values of an array are.
pub(super) trait Located: Clone {
    /// What only other places of the same values have.
    fn key(&self) -> [usize; 4];
}

impl<S> Array<S> {
    /// Adds it to others of a file, and charges it, its values not counted.
    ///
    /// # Errors
    /// A budget that is used up.
    pub fn add_to(self, arrays: &mut Vec<Self>, budget: &Budget) -> Result<(), InputError> {
        let part = "its arrays";
        budget.hold(self.column.bytes() - size_of::<Column>() as u64, part)?;
        budget.push(arrays, self, part)
    }

    fn named(&self) -> Named<'_> {
        (self.group, &self.column.name)
    }
}

/// The tables made of arrays, and the source of the values of each of their columns.
pub(super) type Arranged<S> = (Vec<Table>, Vec<Vec<S>>);

/// Combines arrays into tables, in the order of the file, with the file's other statements in `beside`. `values` returns an array's
/// values, charged as held.
///
/// # Errors
/// The errors of `values`; a budget that is used up.
pub(super) fn arranged<S: Located>(
    groups: &Groups,
    arrays: Vec<Array<S>>,
    beside: Beside,
    values: &mut dyn FnMut(&S) -> Result<Vec<f64>, InputError>,
) -> Result<Arranged<S>, InputError> {
    let columns = arrays.iter().map(|array| &array.column);
    groups
        .budget()
        .work(columns::steps(columns), super::NAMES)?;
    let about = About::of(beside, groups, arrays.iter().map(Array::named));
    let mut lengths: Vec<Vec<usize>> = Vec::new();
    let mut place = HashMap::new();
    for (index, array) in arrays.iter().enumerate() {
        let at = *place.entry(array.rows).or_insert(lengths.len());
        match lengths.get_mut(at) {
            Some(of_length) => of_length.push(index),
            None => lengths.push(vec![index]),
        }
    }
    let room = size_of::<Array<S>>() * arrays.capacity();
    let mut arranging = Arranging {
        groups,
        about,
        found: Found::of(arrays),
        tables: Vec::new(),
        sources: Vec::new(),
    };
    for of_length in lengths {
        for members in arranging.found.divided(groups, &of_length, values)? {
            arranging.tables_of(members)?;
        }
    }
    let Arranging {
        mut tables,
        sources,
        ..
    } = arranging;
    tell_apart(&mut tables);
    groups.budget().release(room as u64);
    for (table, sources) in tables.iter_mut().zip(&sources) {
        first_times(table, sources, groups.budget(), values)?;
    }
    Ok((tables, sources))
}

/// Adds what a file has besides its tables to the first of them; a file without one gets an empty one.
pub(super) fn say_skipped(tables: &mut Vec<Table>, skipped: Vec<String>) {
    if tables.is_empty() {
        tables.push(Table::default());
    }
    tables[0].skipped.extend(skipped);
}

/// The first times of a table, from which its rate follows.
fn first_times<S>(
    table: &mut Table,
    sources: &[S],
    budget: &Budget,
    values: &mut dyn FnMut(&S) -> Result<Vec<f64>, InputError>,
) -> Result<(), InputError> {
    budget.work(columns::steps(table.columns.iter()), super::NAMES)?;
    let mut columns = table.columns.iter_mut().zip(sources);
    if let Some((column, source)) = columns.find(|(column, _)| columns::is_time(column))
        && column.first.is_empty()
    {
        keep_first(column, &values(source)?, budget)?;
    }
    Ok(())
}

/// Arrays while they are arranged.
struct Arranging<'g, S> {
    groups: &'g Groups,
    about: About<'g>,
    found: Found<S>,
    tables: Vec<Table>,
    sources: Vec<Vec<S>>,
}

impl<S: Located> Arranging<'_, S> {
    /// Makes the tables of arrays with the same times: one for each run.
    fn tables_of(&mut self, members: Vec<usize>) -> Result<(), InputError> {
        let described = self
            .found
            .each(&members)
            .map(|(member, array)| runs::Member {
                group: array.group,
                name: &array.column.name,
                is_time: member.is_time,
            });
        let described: Vec<runs::Member<'_>> = described.collect();
        let Some(runs) = runs::runs(self.groups, &described)? else {
            return self.tables_with(vec![(None, self.found.once(members))]);
        };
        let time = (members.iter().copied()).find(|&index| self.found.members[index].is_time);
        let mut named = Vec::new();
        for run in runs {
            let places = run.members.into_iter().map(|place| members[place]);
            let mut places = self.found.once(places.collect());
            let has_time = |&index: &usize| self.found.members[index].is_time;
            if let (Some(time), false) = (time, places.iter().any(has_time)) {
                places.insert(0, time);
            }
            named.push((Some(run.name), places));
        }
        self.tables_with(named)
    }

    fn tables_with(&mut self, runs: Vec<(Option<String>, Vec<usize>)>) -> Result<(), InputError> {
        for &index in runs.iter().flat_map(|(_, members)| members) {
            self.found.members[index].tables += 1;
        }
        for (name, members) in runs {
            let name = match name {
                Some(name) if name.is_empty() => Some("/".to_owned()),
                name => name,
            };
            let (table, longer) = self.described(name, &members)?;
            self.add(table, &members, longer)?;
        }
        Ok(())
    }

    /// A table without its columns, and the names of those that need longer ones.
    fn described(
        &mut self,
        name: Option<String>,
        members: &[usize],
    ) -> Result<(Table, Vec<Option<String>>), InputError> {
        let Self {
            groups,
            about,
            found,
            ..
        } = self;
        let each = || found.each(members);
        let mut within = each().map(|(_, array)| array.group);
        let group = within.next().unwrap_or(Group::FILE);
        let group = within.fold(group, |one, other| groups.shared(one, other));
        let mut table = Table {
            name: match name {
                Some(name) => name,
                None => groups.label([Group::FILE, group], None, "/", "the names of its tables")?,
            },
            rows: each().next().map(|(_, array)| array.rows),
            ..Table::default()
        };
        let place = |array: &Array<S>| {
            let name = Some(array.column.name.as_str());
            let part = "what is said of its times";
            groups.label([Group::FILE, array.group], name, "/", part)
        };
        let time = each().find(|(member, _)| member.is_time);
        let is_guessed = each().any(|(member, _)| member.is_guessed);
        if let (Some((_, time)), true) = (time, is_guessed) {
            table.guesses.push(format!(
                "the times of {} are used for other groups without times, which have as many samples",
                place(time)?
            ));
        }
        let mut clocks = each().filter_map(|(_, array)| array.clock);
        if let (Some((_, time)), Some(first)) = (time, clocks.next())
            && clocks.any(|other| other != first)
        {
            table.guesses.push(format!(
                "the times of column {} are used for all columns of its group, although their own clocks differ",
                quoted(&time.column.name)
            ));
        }
        let named: Vec<Named<'_>> = each().map(|(_, array)| array.named()).collect();
        table.guesses.extend(about.notes(&named)?);
        let has_times = each().any(|(member, array)| array.clock.is_some() || member.may_be_time);
        let (clock, said) = match time.is_some() || has_times {
            true => (None, None),
            false => about.clock(&named)?,
        };
        if clock.is_none() && said.is_none() {
            table.skipped.extend(about.rates(&named)?);
        }
        table.guesses.extend(said);
        table.stated_steps = about.steps(&named)?;
        for (_, array) in each() {
            if let Some(Clock { step, .. }) = array.clock {
                let (of, shown) = (place(array)?, shown(step));
                let taken = ["the clock of ", &of, ", with a step of ", &shown, " s,"].concat();
                let more = (taken.len() - of.len() + 2 * size_of::<StatedStep>()) as u64;
                groups.budget().hold(more, "the steps of its clocks")?;
                table.stated_steps.push(StatedStep { step, taken });
            }
        }
        table.clock = clock.or(each().find_map(|(_, array)| array.clock));
        let mut seen = HashMap::new();
        for (_, name) in &named {
            *seen.entry(*name).or_insert(0_usize) += 1;
        }
        let longer = named.iter().map(|&(below, name)| match seen.get(name) {
            Some(2..) => {
                let part = "the names of its columns";
                groups
                    .label([group, below], Some(name), "/", part)
                    .map(Some)
            }
            _ => Ok(None),
        });
        Ok((table, longer.collect::<Result<_, InputError>>()?))
    }

    /// Adds a table with its columns, of which some have a longer name.
    fn add(
        &mut self,
        mut table: Table,
        members: &[usize],
        longer: Vec<Option<String>>,
    ) -> Result<(), InputError> {
        let budget = self.groups.budget();
        let count = members.len();
        let lists = of_list::<Column>(count) + of_list::<S>(count);
        budget.hold(size_of::<Table>() as u64 + lists, "its tables")?;
        table.columns.reserve_exact(count);
        let mut sources = Vec::with_capacity(count);
        for (&index, longer) in members.iter().zip(longer) {
            let left = &mut self.found.members[index].tables;
            *left -= 1;
            let array = &mut self.found.arrays[index];
            let array = if *left == 0 {
                array.take()
            } else {
                let copied = array.as_ref().map_or(0, |array| array.column.bytes());
                budget.hold(copied, "the columns that its runs share")?;
                array.clone()
            };
            if let Some(Array {
                mut column, source, ..
            }) = array
            {
                column.name = longer.unwrap_or(column.name);
                table.columns.push(column);
                sources.push(source);
            }
        }
        self.tables.push(table);
        self.sources.push(sources);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::rc::Rc;

    use super::*;
    use crate::read_limit::ReadLimit;

    impl Located for Vec<f64> {
        fn key(&self) -> [usize; 4] {
            [self.as_ptr().addr(), 0, 0, 0]
        }
    }

    /// An array by its path.
    #[derive(Clone)]
    struct Known {
        path: &'static str,
        values: Vec<f64>,
        clock: Option<Clock>,
    }

    fn array(path: &'static str, values: &[f64]) -> Known {
        Known {
            path,
            values: values.to_vec(),
            clock: None,
        }
    }

    fn arranged_within(
        limit: u64,
        arrays: Vec<Known>,
    ) -> Result<(Arranged<Vec<f64>>, u64), InputError> {
        let budget = Rc::new(Budget::new("a.h5", ReadLimit::new(limit)));
        let mut groups = Groups::new(Rc::clone(&budget));
        let mut all = Vec::new();
        for Known {
            path,
            values,
            clock,
        } in arrays
        {
            let (above, name) = path.rsplit_once('/').unwrap_or(("", path));
            let parts = above.split('/').filter(|part| !part.is_empty());
            let group = parts.fold(Group::FILE, |above, name| {
                groups.inside(above, name).unwrap()
            });
            let array = Array {
                group,
                column: Column {
                    name: name.to_owned(),
                    is_numeric: true,
                    ..Column::default()
                },
                rows: values.len() as u64,
                clock,
                source: values,
            };
            array.add_to(&mut all, &budget)?;
        }
        let mut values = |values: &Vec<f64>| {
            budget.hold(of_list::<f64>(values.len()), "its values")?;
            Ok(values.clone())
        };
        let arranged = arranged(&groups, all, Beside::default(), &mut values)?;
        Ok((arranged, budget.used().0))
    }

    /// `name: column, column`, each table.
    fn said(arrays: Vec<Known>) -> Vec<String> {
        let ((tables, sources), _) = arranged_within(1 << 20, arrays).unwrap();
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
        let shared: Vec<Known> = (runs.into_iter().enumerate())
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
            Known {
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
