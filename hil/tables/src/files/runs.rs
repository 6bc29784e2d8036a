//! Groups with the same channels: runs of one test, which are separate tables even if their times are the same.

use std::collections::HashMap;

use mesh_damper_output::error::InputError;

use super::groups::{Group, Groups};
use crate::budget::{of_list, of_text};

/// An array in a group: its name, and whether it holds times.
pub(super) struct Member<'m> {
    pub group: Group,
    pub name: &'m str,
    pub is_time: bool,
}

/// Members that belong together.
#[derive(Clone, Debug, Default)]
pub(super) struct Run {
    /// The groups that distinguish them from the others, in one text.
    pub name: String,
    /// Their indices, in order.
    pub members: Vec<usize>,
}

/// Divides members of the same times into runs: parallel groups that share at least two channel names. Members elsewhere belong to
/// all of them. A single shared name is not enough: `force/value` and `displacement/value` are channels of one table. `None` if all
/// members belong together.
///
/// # Errors
/// A budget that is used up.
pub(super) fn runs(
    groups: &Groups,
    members: &[Member<'_>],
) -> Result<Option<Vec<Run>>, InputError> {
    let mut within = members.iter().map(|member| member.group);
    let first = within.next();
    if within.all(|group| Some(group) == first) {
        return Ok(None);
    }
    let tree = Tree::of(groups, members);
    let mut runs = tree.below(0)?;
    for run in runs.iter_mut().flatten() {
        run.members.sort_unstable();
    }
    Ok(runs)
}

/// Steps of comparing a channel with those of other groups: its number is computed, and sorted among the others.
const STEPS: u64 = 16;

/// A group of members, those directly in it first, then those of each group in it.
struct Branch {
    group: Group,
    /// The groups in it, in the order of their first members, by their places.
    inside: Vec<usize>,
    /// Members directly in it, and all: ranges of `ordered`.
    here: std::ops::Range<usize>,
    end: usize,
}

/// Members by their groups.
struct Tree<'t> {
    groups: &'t Groups,
    members: &'t [Member<'t>],
    /// Hashes of the members' names.
    hashes: Vec<u64>,
    branches: Vec<Branch>,
    /// The members' indices, so that those of a branch follow one another.
    ordered: Vec<usize>,
}

impl<'t> Tree<'t> {
    fn of(groups: &'t Groups, members: &'t [Member<'t>]) -> Self {
        let branch = |group| Branch {
            group,
            inside: Vec::new(),
            here: 0..0,
            end: 0,
        };
        let mut branches = vec![branch(Group::FILE)];
        let mut places = HashMap::from([(Group::FILE, 0)]);
        let mut here: Vec<Vec<usize>> = vec![Vec::new()];
        for (index, member) in members.iter().enumerate() {
            let new = groups.upward(member.group);
            let new: Vec<Group> = new.take_while(|each| !places.contains_key(each)).collect();
            for group in new.into_iter().rev() {
                let above = groups.upward(group).nth(1).unwrap_or(Group::FILE);
                let place = branches.len();
                branches[places[&above]].inside.push(place);
                branches.push(branch(group));
                here.push(Vec::new());
                places.insert(group, place);
            }
            here[places[&member.group]].push(index);
        }
        let mut tree = Self {
            groups,
            members,
            hashes: members.iter().map(|each| groups.hash(each.name)).collect(),
            branches,
            ordered: Vec::new(),
        };
        tree.order(0, &here);
        tree
    }

    fn order(&mut self, place: usize, here: &[Vec<usize>]) {
        let begin = self.ordered.len();
        self.ordered.extend(&here[place]);
        self.branches[place].here = begin..self.ordered.len();
        for inside in self.branches[place].inside.clone() {
            self.order(inside, here);
        }
        self.branches[place].end = self.ordered.len();
    }

    fn here(&self, branch: &Branch) -> &[usize] {
        &self.ordered[branch.here.clone()]
    }

    fn all(&self, branch: &Branch) -> &[usize] {
        &self.ordered[branch.here.start..branch.end]
    }

    /// The runs in a branch; `None` if its members belong together.
    fn below(&self, place: usize) -> Result<Option<Vec<Run>>, InputError> {
        let branch = &self.branches[place];
        let inside: Vec<&Branch> = (branch.inside.iter())
            .map(|&place| &self.branches[place])
            .collect();
        // The channels outside the groups may be a run too.
        let alike = self.alike(branch, &inside)?;
        if alike.iter().filter(|&&is_alike| is_alike).count() > 1 {
            return self.divided(branch, &alike).map(Some);
        }
        self.charge(0, 0)?;
        let mut found = vec![Run::default()];
        let mut shared = self.here(branch).to_vec();
        for (&place, each) in branch.inside.iter().zip(inside) {
            let Some(inner) = self.below(place)? else {
                shared.extend(self.all(each));
                continue;
            };
            let mut both = Vec::new();
            for run in &found {
                for more in &inner {
                    both.push(self.joined(run, each.group, more)?);
                }
            }
            self.forget(&found);
            self.forget(&inner);
            found = both;
        }
        if found.len() == 1 {
            self.forget(&found);
            return Ok(None);
        }
        for run in &mut found {
            self.charge(shared.len(), 0)?;
            run.members.extend(&shared);
        }
        Ok(Some(found))
    }

    /// The runs of a branch some of whose groups, and maybe the channels outside of them, are `alike`.
    fn divided(&self, branch: &Branch, alike: &[bool]) -> Result<Vec<Run>, InputError> {
        let here = self.here(branch).to_vec();
        let is_here = alike.last() == Some(&true);
        let mut shared = if is_here { Vec::new() } else { here.clone() };
        let groups = || branch.inside.iter().zip(alike);
        for (&place, _) in groups().filter(|(_, is_alike)| !**is_alike) {
            shared.extend(self.all(&self.branches[place]));
        }
        let mut found: Vec<Run> = Vec::new();
        if is_here {
            self.charge(here.len() + shared.len(), 0)?;
            found.push(Run {
                name: String::new(),
                members: [here, shared.clone()].concat(),
            });
        }
        for (&place, _) in groups().filter(|(_, is_alike)| **is_alike) {
            let inside = &self.branches[place];
            let inner = match self.below(place)? {
                Some(inner) => inner,
                None => {
                    self.charge(self.all(inside).len(), 0)?;
                    vec![Run {
                        name: String::new(),
                        members: self.all(inside).to_vec(),
                    }]
                }
            };
            let shared = Run {
                name: String::new(),
                members: shared.clone(),
            };
            for run in &inner {
                found.push(self.joined(&shared, inside.group, run)?);
            }
            self.forget(&inner);
        }
        Ok(found)
    }

    /// The members of a run and those of another in a group.
    fn joined(&self, run: &Run, group: Group, inner: &Run) -> Result<Run, InputError> {
        let names = [&run.name, self.groups.name(group), &inner.name];
        let length: usize = names.iter().map(|name| name.len() + 1).sum();
        self.charge(run.members.len() + inner.members.len(), length)?;
        let is_named = |(place, name): &(usize, &str)| *place == 1 || !name.is_empty();
        let names = names.into_iter().enumerate().filter(is_named);
        let names: Vec<&str> = names.map(|(_, name)| name).collect();
        Ok(Run {
            name: names.join("/"),
            members: [&run.members[..], &inner.members].concat(),
        })
    }

    /// Charges a run of this number of members, whose name has this length in bytes.
    fn charge(&self, members: usize, name: usize) -> Result<(), InputError> {
        let bytes = of_list::<usize>(members) + of_text(name);
        let budget = self.groups.budget();
        budget.work(members as u64, "dividing its groups into runs")?;
        budget.hold(bytes, "the runs into which its groups are divided")
    }

    /// Runs that are part of others now.
    fn forget(&self, runs: &[Run]) {
        for run in runs {
            let bytes = of_list::<usize>(run.members.len()) + of_text(run.name.len());
            self.groups.budget().release(bytes);
        }
    }

    /// Whether each group in a branch, and at last its own members, share at least two channels with others of these.
    fn alike(&self, branch: &Branch, inside: &[&Branch]) -> Result<Vec<bool>, InputError> {
        let mut alike = vec![0_u32; inside.len() + 1];
        let parts = || {
            let inside = inside.iter().map(|each| (each.group, self.all(each)));
            inside.chain([(branch.group, self.here(branch))])
        };
        if parts().filter(|(_, members)| !members.is_empty()).count() < 2 {
            return Ok(vec![false; alike.len()]);
        }
        let steps = self.all(branch).len() as u64;
        (self.groups.budget()).work(STEPS * steps, "comparing the channels of its groups")?;
        let mut keys: Vec<(u64, usize)> = Vec::new();
        for (part, (from, members)) in parts().enumerate() {
            let channels = members
                .iter()
                .filter(|&&index| !self.members[index].is_time);
            keys.extend(channels.map(|&index| {
                let group = self.members[index].group;
                (self.groups.alike(from, group, self.hashes[index]), part)
            }));
        }
        keys.sort_unstable();
        keys.dedup();
        for same in keys.chunk_by(|one, other| one.0 == other.0) {
            if same.len() > 1 {
                same.iter().for_each(|(_, part)| alike[*part] += 1);
            }
        }
        Ok(alike.into_iter().map(|channels| channels > 1).collect())
    }
}

#[cfg(test)]
mod tests {
    use std::rc::Rc;

    use super::*;
    use crate::budget::Budget;
    use crate::read_limit::ReadLimit;

    fn groups(limit: u64) -> Groups {
        Groups::new(Rc::new(Budget::new("a.h5", ReadLimit::new(limit))))
    }

    /// The runs of members with these paths.
    fn of(limit: u64, paths: &[&str]) -> Result<Vec<Run>, InputError> {
        let mut groups = groups(limit);
        let mut members = Vec::new();
        for path in paths {
            let (above, name) = path.rsplit_once('/').unwrap_or(("", path));
            let parts = above.split('/').filter(|part| !part.is_empty());
            let group = parts.fold(Group::FILE, |above, name| {
                groups.inside(above, name).unwrap()
            });
            members.push(Member {
                group,
                name,
                is_time: name == "t",
            });
        }
        let one = || Run {
            name: String::new(),
            members: (0..paths.len()).collect(),
        };
        Ok(runs(&groups, &members)?.unwrap_or_else(|| vec![one()]))
    }

    /// `name: member, member` of each run.
    fn said(paths: &[&str]) -> Vec<String> {
        let each = of(1 << 20, paths).unwrap().into_iter().map(|run| {
            let inside: Vec<&str> = run.members.iter().map(|&index| paths[index]).collect();
            format!("{}: {}", run.name, inside.join(", "))
        });
        each.collect()
    }

    #[test]
    fn groups_with_the_same_channels_are_runs() {
        assert_eq!(
            said(&["1/t", "1/y", "1/F", "2/t", "2/y", "2/F"]),
            ["1: 1/t, 1/y, 1/F", "2: 2/t, 2/y, 2/F"]
        );
        // Deeper, with times and a channel that all of them have.
        assert_eq!(
            said(&[
                "t",
                "T",
                "rig/1/y",
                "rig/1/F",
                "rig/2/y",
                "rig/2/F",
                "rig/note/p"
            ]),
            [
                "rig/1: t, T, rig/1/y, rig/1/F, rig/note/p",
                "rig/2: t, T, rig/2/y, rig/2/F, rig/note/p"
            ]
        );
        // Each channel in its own group.
        assert_eq!(
            said(&["1/y/v", "1/F/v", "2/y/v", "2/F/v", "2/T/v"]),
            ["1: 1/y/v, 1/F/v", "2: 2/y/v, 2/F/v, 2/T/v"]
        );
        // Raw channels below the channels computed from them.
        assert_eq!(
            said(&["t", "y", "F", "raw/y", "raw/F"]),
            [": t, y, F", "raw: raw/y, raw/F"]
        );
    }

    #[test]
    fn groups_of_other_channels_are_none() {
        for paths in [
            &["0/t", "0/y", "1/t", "1/F"][..],
            &["t/v", "y/v", "F/v"],
            &["left/F", "right/F", "axis/y"],
            &["t", "y", "F"],
        ] {
            assert_eq!(said(paths), [format!(": {}", paths.join(", "))]);
        }
    }

    #[test]
    fn runs_of_two_kinds_are_combined() {
        assert_eq!(
            said(&[
                "a/1/y", "a/1/F", "a/2/y", "a/2/F", "b/x/T", "b/x/p", "b/z/T", "b/z/p", "c"
            ]),
            [
                "a/1/b/x: a/1/y, a/1/F, b/x/T, b/x/p, c",
                "a/1/b/z: a/1/y, a/1/F, b/z/T, b/z/p, c",
                "a/2/b/x: a/2/y, a/2/F, b/x/T, b/x/p, c",
                "a/2/b/z: a/2/y, a/2/F, b/z/T, b/z/p, c",
            ]
        );
    }

    #[test]
    fn as_many_runs_as_the_budget_bears_are_divided() {
        let paths = |runs: usize, shared: usize| -> Vec<String> {
            let runs = (0..runs).flat_map(|run| ["y", "F"].map(|name| format!("{run}/{name}")));
            runs.chain((0..shared).map(|index| format!("c{index}")))
                .collect()
        };
        let count = |limit, paths: &[String]| {
            let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
            of(limit, &paths).map(|runs| runs.len())
        };
        assert_eq!(count(8 << 20, &paths(3000, 2)), Ok(3000));
        let error = count(8 << 20, &paths(300, 1000)).unwrap_err().to_string();
        assert!(
            error.contains("the runs") && error.contains("--max-read"),
            "{error}"
        );
        // Two runs of each of twenty kinds are a million combinations.
        let kinds = (0..20).flat_map(|kind| ["1", "2"].map(|run| (kind, run)));
        let each = |(kind, run)| ["y", "F"].map(|name| format!("{kind}/{run}/{name}{kind}"));
        let kinds: Vec<String> = kinds.flat_map(each).collect();
        assert!(count(8 << 20, &kinds).is_err());
    }
}
