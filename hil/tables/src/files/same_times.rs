//! Finds which arrays of one length have the same times.

use std::collections::{BTreeSet, HashMap};
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

use mesh_damper_output::error::InputError;

use super::Column;
use super::arrays::{Array, Located};
use super::groups::{Group, Groups};
use super::table::Clock;
use crate::budget::{Budget, of_list};
use crate::columns::of_times;

const FIRST: &str = "the first of its times";

/// The common property of the arrays of one table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Times {
    /// The values of an array of times, as a number that other values do not have.
    Array(u64),
    /// Start and step of a clock.
    Clock([u64; 2]),
    None,
}

impl Times {
    fn of(clock: Option<Clock>) -> Self {
        clock.map_or(Self::None, |Clock { start, step }| {
            // Zero has two signs.
            Self::Clock([start, step].map(|value| (value + 0.0).to_bits()))
        })
    }
}

/// The place of an array in its table.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Member {
    /// Whether it may have times.
    pub may_be_time: bool,
    /// Whether it is the table's column of times.
    pub is_time: bool,
    /// Whether its times lie in another group, so that only their number connects them.
    pub is_guessed: bool,
    /// Number of tables that it is still to be a column of.
    pub tables: usize,
}

/// The times in a group and below it.
#[derive(Clone, Copy, Debug)]
struct Axes {
    /// The group of the first of them.
    group: Group,
    mark: u64,
    /// Whether all are the same.
    are_one: bool,
}

/// Arrays by their places in the file.
pub(super) struct Found<S> {
    /// Those that the tables have not taken yet.
    pub arrays: Vec<Option<Array<S>>>,
    pub members: Vec<Member>,
}

impl<S: Located> Found<S> {
    pub fn of(arrays: Vec<Array<S>>) -> Self {
        Self {
            members: vec![Member::default(); arrays.len()],
            arrays: arrays.into_iter().map(Some).collect(),
        }
    }

    /// An array that is not taken yet.
    fn array(&self, index: usize) -> Option<&Array<S>> {
        self.arrays[index].as_ref()
    }

    /// Some arrays, by their places.
    pub fn each<'s>(
        &'s self,
        places: &'s [usize],
    ) -> impl Iterator<Item = (Member, &'s Array<S>)> + Clone {
        let array = |&index: &usize| Some((self.members[index], self.array(index)?));
        places.iter().filter_map(array)
    }

    /// The arrays that are the times of their groups: at most one in each, that which the file marks as such if there is one.
    fn axes_of_groups(&mut self, arrays: &[usize]) -> BTreeSet<usize> {
        let mut axes: HashMap<Group, (usize, bool)> = HashMap::new();
        for &index in arrays {
            let Some(Array { group, column, .. }) = &self.arrays[index] else {
                continue;
            };
            let of_times = of_times(column);
            self.members[index].may_be_time = of_times.may_be_time;
            if column.is_time || of_times.is_time {
                let known = axes.entry(*group).or_insert((index, column.is_time));
                if column.is_time && !known.1 {
                    *known = (index, true);
                }
            }
        }
        axes.into_values().map(|(index, _)| index).collect()
    }

    /// Arrays without a repetition of the same times.
    pub fn once(&self, mut members: Vec<usize>) -> Vec<usize> {
        let mut has_time = false;
        members.retain(|&index| {
            !self.members[index].is_time || !std::mem::replace(&mut has_time, true)
        });
        members
    }

    /// Arrays of one length, divided by their times.
    pub fn divided(
        &mut self,
        groups: &Groups,
        arrays: &[usize],
        values: &mut dyn FnMut(&S) -> Result<Vec<f64>, InputError>,
    ) -> Result<Vec<Vec<usize>>, InputError> {
        let times = self.axes_of_groups(arrays);
        let several = times.len() > 1;
        // In each group, the times in it and below it.
        let mut axes: HashMap<Group, Axes> = HashMap::new();
        let mut marks = HashMap::new();
        // The first array with its values, and its mark, by where they are.
        let mut known: HashMap<[usize; 4], (u64, usize)> = HashMap::new();
        let budget = groups.budget();
        for index in times {
            let Some(array) = &self.arrays[index] else {
                continue;
            };
            let (group, key) = (array.group, array.source.key());
            let mark = match known.get(&key) {
                // Many groups may have one array of times.
                Some(&(mark, like)) => {
                    self.copy_first(index, like, budget)?;
                    mark
                }
                None if several => self.compared(index, values, budget)?,
                None => 0,
            };
            known.entry(key).or_insert((mark, index));
            marks.insert(index, mark);
            let own = Axes {
                group,
                mark,
                are_one: true,
            };
            for group in groups.upward(group) {
                let known = axes.entry(group).or_insert(own);
                known.are_one &= known.mark == mark;
            }
        }
        let mut divided: Vec<Vec<usize>> = Vec::new();
        let mut place = HashMap::new();
        let mut nearest_to = HashMap::new();
        for &index in arrays {
            let Some(Array { group, clock, .. }) = self.array(index) else {
                continue;
            };
            let mark = marks.get(&index).copied();
            let mut near = || {
                let known = nearest_to.entry(*group);
                *known.or_insert_with(|| nearest(groups, *group, &axes))
            };
            let (times, is_guessed) = match mark {
                Some(mark) => (Times::Array(mark), false),
                None => match near() {
                    // Times in its own group have precedence over a clock, and a clock over times elsewhere.
                    Some((mark, true)) => (Times::Array(mark), false),
                    Some((mark, false)) if clock.is_none() => (Times::Array(mark), true),
                    _ => (Times::of(*clock), false),
                },
            };
            let member = &mut self.members[index];
            member.is_time = mark.is_some();
            member.is_guessed = is_guessed;
            let at = *place.entry(times).or_insert(divided.len());
            match divided.get_mut(at) {
                Some(members) => members.push(index),
                None => divided.push(vec![index]),
            }
        }
        Ok(divided)
    }

    /// The mark of an array of times, whose first values it keeps.
    fn compared(
        &mut self,
        index: usize,
        values: &mut dyn FnMut(&S) -> Result<Vec<f64>, InputError>,
        budget: &Budget,
    ) -> Result<u64, InputError> {
        let Some(array) = &mut self.arrays[index] else {
            return Ok(0);
        };
        let times = values(&array.source)?;
        budget.work(2 * times.len() as u64, "comparing its times")?;
        keep_first(&mut array.column, &times, budget)?;
        Ok(mark(&times))
    }

    /// Keeps the first values of an array of times that are those of another one.
    fn copy_first(&mut self, index: usize, like: usize, budget: &Budget) -> Result<(), InputError> {
        let first = self.array(like).map(|array| array.column.first.clone());
        if let (Some(first), Some(array)) = (first, &mut self.arrays[index])
            && array.column.first.is_empty()
        {
            budget.hold(of_list::<f64>(first.len()), FIRST)?;
            array.column.first = first;
        }
        Ok(())
    }
}

/// The times nearest to a group, and whether they lie in it or around it; `None` if two are equally near.
fn nearest(groups: &Groups, group: Group, axes: &HashMap<Group, Axes>) -> Option<(u64, bool)> {
    let mut upward = groups.upward(group);
    let (around, near) = upward.find_map(|each| Some((each, axes.get(&each)?)))?;
    near.are_one.then_some((near.mark, near.group == around))
}

/// Keeps the first of some times, which were charged as held.
pub(super) fn keep_first(
    column: &mut Column,
    times: &[f64],
    budget: &Budget,
) -> Result<(), InputError> {
    budget.release(of_list::<f64>(times.len()));
    if column.first.is_empty() {
        let first = &times[..times.len().min(Column::FIRST)];
        budget.hold(of_list::<f64>(first.len()), FIRST)?;
        column.first = first.to_vec();
    }
    Ok(())
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
