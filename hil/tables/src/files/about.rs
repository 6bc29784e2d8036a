//! What a file states about arrays, by the groups that it is about.

use std::collections::{HashMap, HashSet};

use mesh_damper_output::error::InputError;

use super::beside::Beside;
use super::groups::{Group, Groups};
use super::table::{Clock, StatedStep};
use crate::budget::of_text;

/// An array: its group and its name.
pub(super) type Named<'a> = (Group, &'a str);

/// The statements of a file by the groups that they are about.
pub(super) struct About<'g> {
    groups: &'g Groups,
    beside: Beside,
    /// For each group the rates that describe it, by their places in `beside`; those that may describe another; the notes.
    near: HashMap<Group, Vec<usize>>,
    apart: HashMap<Group, Vec<usize>>,
    notes: HashMap<Group, Vec<usize>>,
    /// The group with the rates nearest to each group that was asked for.
    nearest: HashMap<Group, Option<Group>>,
}

impl<'g> About<'g> {
    /// Statements by their groups. Those in a group without any of the file's `arrays` are about the arrays around it.
    pub fn of<'a>(
        mut beside: Beside,
        groups: &'g Groups,
        arrays: impl Iterator<Item = Named<'a>>,
    ) -> Self {
        let (mut near, mut apart, mut notes) = (HashMap::new(), HashMap::new(), HashMap::new());
        let put = |of: &mut HashMap<Group, Vec<usize>>, at: Group, place: usize| {
            of.entry(at).or_default().push(place);
        };
        if !beside.rates.is_empty() || !beside.notes.is_empty() {
            let around = around(groups, arrays);
            for (place, stated) in beside.rates.iter_mut().enumerate() {
                stated.spread(groups, &around);
                let of = if stated.is_apart {
                    &mut apart
                } else {
                    &mut near
                };
                put(of, stated.at, place);
            }
            for (place, stated) in beside.notes.iter_mut().enumerate() {
                stated.spread(groups, &around);
                put(&mut notes, stated.at, place);
            }
        }
        Self {
            groups,
            beside,
            near,
            apart,
            notes,
            nearest: HashMap::new(),
        }
    }

    /// The group with the rates nearest to another.
    fn nearest(&mut self, group: Group) -> Option<Group> {
        let mut asked = Vec::new();
        let mut found = None;
        for each in self.groups.upward(group) {
            if let Some(known) = self.nearest.get(&each) {
                found = *known;
                break;
            }
            asked.push(each);
            if self.near.contains_key(&each) {
                found = Some(each);
                break;
            }
        }
        self.nearest
            .extend(asked.into_iter().map(|each| (each, found)));
        found
    }

    /// The groups with the rates nearest to each of some arrays, each once, and whether every array has some.
    fn nearest_of(&mut self, arrays: &[Named<'_>]) -> (Vec<Group>, bool) {
        let mut seen = HashSet::new();
        let mut found = Vec::new();
        let mut of_all = true;
        if self.near.is_empty() {
            return (found, false);
        }
        for &(group, name) in arrays {
            match self.nearest(own(self.groups, group, name)) {
                Some(near) if seen.insert(near) => found.push(near),
                Some(_) => {}
                None => of_all = false,
            }
        }
        (found, of_all)
    }

    /// The rates of these groups, in their order.
    fn rates_in<'s>(&'s self, groups: &'s [Group]) -> impl Iterator<Item = &'s StatedStep> + Clone {
        let places = groups.iter().flat_map(|group| &self.near[group]);
        places.map(|&place| &self.beside.rates[place].what)
    }

    /// The places of the statements about some arrays, in the file's order.
    fn places(&self, arrays: &[Named<'_>], of: &[&HashMap<Group, Vec<usize>>]) -> Vec<usize> {
        let mut places = Vec::new();
        if of.iter().all(|of| of.is_empty()) {
            return places;
        }
        let mut seen = HashSet::new();
        for &(group, name) in arrays {
            for each in self.groups.upward(own(self.groups, group, name)) {
                if !seen.insert(each) {
                    break;
                }
                places.extend(of.iter().filter_map(|of| of.get(&each)).flatten());
            }
        }
        places.sort_unstable();
        places
    }

    /// Charges a text that one more table holds.
    fn copied(&self, text: &str) -> Result<String, InputError> {
        let part = "what is stated beside its arrays";
        self.groups.budget().hold(of_text(text.len()), part)?;
        Ok(text.to_owned())
    }

    /// Charges a look at the statements beside some arrays.
    fn looked(&self, statements: usize) -> Result<(), InputError> {
        let part = "comparing what is stated beside its arrays";
        self.groups.budget().work(statements as u64, part)
    }

    /// The steps stated for some arrays, by the rates nearest to each of them.
    pub fn steps(&mut self, arrays: &[Named<'_>]) -> Result<Vec<StatedStep>, InputError> {
        let (near, _) = self.nearest_of(arrays);
        self.looked(self.rates_in(&near).count())?;
        let mut seen = HashSet::new();
        let of_each = self.rates_in(&near);
        let once = of_each.filter(|each| seen.insert((each.step.to_bits(), &each.taken)));
        let each = once.map(|each| {
            Ok(StatedStep {
                step: each.step,
                taken: self.copied(&each.taken)?,
            })
        });
        each.collect()
    }

    /// The sentences about some arrays.
    pub fn notes(&self, arrays: &[Named<'_>]) -> Result<Vec<String>, InputError> {
        let places = self.places(arrays, &[&self.notes]);
        self.looked(places.len())?;
        let mut seen = HashSet::new();
        let notes = places
            .into_iter()
            .map(|place| &self.beside.notes[place].what);
        let once = notes.filter(|note| seen.insert(note.as_str()));
        once.map(|note| self.copied(note)).collect()
    }

    /// The rates stated for some arrays, in words, for recordings with other times.
    pub fn rates(&self, arrays: &[Named<'_>]) -> Result<Vec<String>, InputError> {
        let places = self.places(arrays, &[&self.near, &self.apart]);
        self.looked(places.len())?;
        let rates = places
            .into_iter()
            .map(|place| &self.beside.rates[place].what.taken);
        rates.map(|taken| self.copied(taken)).collect()
    }

    /// The clock of arrays without times, by the rate nearest to each of them, and a sentence about it.
    pub fn clock(
        &mut self,
        arrays: &[Named<'_>],
    ) -> Result<(Option<Clock>, Option<String>), InputError> {
        if self.beside.is_said {
            return Ok((None, None));
        }
        let (near, of_all) = self.nearest_of(arrays);
        let mut found = self.rates_in(&near);
        let Some(first) = found.clone().next().filter(|_| of_all) else {
            return Ok((None, None));
        };
        self.looked(found.clone().count())?;
        // A rate and a step of the same clock differ in the last digits.
        let is_other = |rate: &&StatedStep| (rate.step / first.step - 1.0).abs() > 1e-9;
        if let Some(other) = found.find(is_other) {
            let note = format!(
                "{} and {} give different rates, so neither is used; give one with --rate",
                first.taken, other.taken
            );
            return Ok((None, Some(note)));
        }
        let clock = Clock {
            start: 0.0,
            step: first.step,
        };
        let note = format!(
            "there is no time column; the times are computed from {}",
            first.taken
        );
        Ok((Some(clock), Some(note)))
    }
}

/// Whether each group contains one of the arrays, or is one.
fn around<'a>(groups: &Groups, arrays: impl Iterator<Item = Named<'a>>) -> Vec<bool> {
    let mut around = vec![false; groups.count()];
    for (group, name) in arrays {
        for each in groups.upward(own(groups, group, name)) {
            // Those above it are known then.
            if std::mem::replace(&mut around[each.index()], true) {
                break;
            }
        }
    }
    around
}

/// The place of an array about which there is a statement of its own, else its group.
fn own(groups: &Groups, group: Group, name: &str) -> Group {
    groups.found(group, name).unwrap_or(group)
}

#[cfg(test)]
mod tests {
    use std::rc::Rc;

    use super::*;
    use crate::budget::Budget;
    use crate::files::Reading;
    use crate::read_limit::ReadLimit;

    fn groups() -> Groups {
        Groups::new(Rc::new(Budget::new("a.h5", ReadLimit::new(1 << 20))))
    }

    fn group(groups: &mut Groups, path: &str) -> Group {
        let parts = path.split('/').filter(|part| !part.is_empty());
        parts.fold(Group::FILE, |above, name| {
            groups.inside(above, name).unwrap()
        })
    }

    /// Arrays by their paths.
    fn named<'a>(groups: &mut Groups, paths: &[&'a str]) -> Vec<Named<'a>> {
        let each = paths.iter().map(|path| {
            let (above, name) = path.rsplit_once('/').unwrap_or(("", path));
            (group(groups, above), name)
        });
        each.collect()
    }

    /// Numbers called `fs`, each with its group, its name in messages and its value.
    fn rates(groups: &mut Groups, stated: &[(&str, &str, f64)]) -> Beside {
        let mut beside = Beside::default();
        for (path, of, value) in stated {
            let at = group(groups, path);
            (beside.number(at, "fs", of, *value, groups.budget())).unwrap();
        }
        beside
    }

    #[test]
    fn the_nearest_rate_counts_and_two_that_differ_are_said() {
        let mut groups = groups();
        let beside = rates(&mut groups, &[("", "fs", 100.0), ("run", "run/fs", 50.0)]);
        let mut step = |paths: &[&str]| {
            let arrays = named(&mut groups, paths);
            let mut about = About::of(beside.clone(), &groups, arrays.iter().copied());
            let (clock, said) = about.clock(&arrays).unwrap();
            (clock.map(|clock| clock.step), said.unwrap_or_default())
        };
        assert_eq!(step(&["force", "disp"]).0, Some(0.01));
        assert_eq!(step(&["run/force", "run/disp"]).0, Some(0.02));
        let (none, said) = step(&["run/force", "disp"]);
        assert!(none.is_none() && said.contains("different rates"), "{said}");
        // The user's setting has precedence.
        let rate = Reading {
            rate: Some(10.0),
            ..Reading::default()
        };
        let channel = Reading {
            channels: vec![("time".into(), "t".into())],
            ..Reading::default()
        };
        for reading in [rate, channel] {
            let mut beside = beside.clone();
            beside.heed(&reading);
            let arrays = [(Group::FILE, "force")];
            let mut about = About::of(beside, &groups, arrays.into_iter());
            assert_eq!(about.clock(&arrays), Ok((None, None)));
        }
    }

    #[test]
    fn a_description_beside_the_arrays_is_about_them() {
        for (place, step) in [
            ("", Some(0.005)),
            ("data", Some(0.005)),
            ("meta", Some(0.005)),
            ("data/Info", Some(0.005)),
            // The rate of a controller need not be that of the samples.
            ("controller", None),
            ("meta/controller", None),
        ] {
            let mut groups = groups();
            let beside = rates(&mut groups, &[(place, "fs", 200.0)]);
            let arrays = named(&mut groups, &["data/force", "data/disp"]);
            let mut about = About::of(beside, &groups, arrays.iter().copied());
            let clock = about.clock(&arrays).unwrap().0;
            assert_eq!(clock.map(|clock| clock.step), step, "{place}");
            assert_eq!(about.rates(&arrays).unwrap(), ["fs = 200 Hz"]);
        }
    }

    #[test]
    fn a_statement_about_one_array_is_not_about_its_neighbour() {
        let mut groups = groups();
        let force = group(&mut groups, "data/force");
        let mut beside = Beside::default();
        (beside.note(force, "it is a draft".into(), groups.budget())).unwrap();
        let arrays = named(&mut groups, &["data/force", "data/disp"]);
        let about = About::of(beside, &groups, arrays.iter().copied());
        assert_eq!(about.notes(&arrays[..1]).unwrap(), ["it is a draft"]);
        assert!(about.notes(&arrays[1..]).unwrap().is_empty());
    }

    #[test]
    fn the_steps_of_some_arrays_are_those_of_the_nearest_rates() {
        let mut groups = groups();
        let beside = rates(&mut groups, &[("", "fs", 100.0), ("run", "run/fs", 50.0)]);
        let mut taken = |paths: &[&str]| -> Vec<String> {
            let arrays = named(&mut groups, paths);
            let mut about = About::of(beside.clone(), &groups, arrays.iter().copied());
            let steps = about.steps(&arrays).unwrap().into_iter();
            steps.map(|step| step.taken).collect()
        };
        assert_eq!(taken(&["run/time", "run/force"]), ["run/fs = 50 Hz"]);
        assert_eq!(taken(&["time", "force"]), ["fs = 100 Hz"]);
        assert_eq!(
            taken(&["run/force", "time"]),
            ["run/fs = 50 Hz", "fs = 100 Hz"]
        );
    }

    #[test]
    fn what_many_tables_state_is_charged_for_each() {
        let mut groups = groups();
        let beside = rates(&mut groups, &[("", &"long ".repeat(1000), 100.0)]);
        let arrays = [(Group::FILE, "force")];
        let mut about = About::of(beside, &groups, arrays.into_iter());
        let said = (0..100).try_for_each(|_| about.steps(&arrays).map(drop));
        let said = said.unwrap_err().to_string();
        assert!(said.contains("stated beside its arrays"), "{said}");
    }
}
