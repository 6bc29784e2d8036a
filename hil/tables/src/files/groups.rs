//! The groups of a file as a tree, in which each name is held once, however many arrays lie below it.

use std::collections::HashMap;
use std::hash::{BuildHasher as _, RandomState};
use std::rc::Rc;

use mesh_damper_output::error::InputError;

use crate::budget::{Budget, of_text};

/// A group of a file, or an array in one, by its place in [`Groups`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Group(u32);

impl Group {
    /// The file itself.
    pub const FILE: Self = Self(0);

    /// Its place, counted from 0.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A group in the tree.
#[derive(Debug)]
struct Node {
    above: Group,
    name: Box<str>,
    /// Groups above it, the file not counted.
    depth: u32,
    /// Bytes of its name and of those above it.
    length: usize,
    /// A polynomial of the hashes of its name and of those above it.
    hash: u64,
}

/// What a group takes beside its name: its node, its place in the map, and room for both to grow.
const COST: u64 = 80;
/// The factor of a polynomial of hashes: any odd number of 64 bits; this is 2⁶⁴ by the golden ratio.
const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
const PART: &str = "the names of its groups";

/// The groups of a file.
#[derive(Debug)]
pub(super) struct Groups {
    budget: Rc<Budget>,
    nodes: Vec<Node>,
    inside: HashMap<u64, Group>,
    hasher: RandomState,
}

impl Groups {
    pub fn new(budget: Rc<Budget>) -> Self {
        let file = Node {
            above: Group::FILE,
            name: Box::default(),
            depth: 0,
            length: 0,
            hash: 0,
        };
        Self {
            budget,
            nodes: vec![file],
            inside: HashMap::new(),
            hasher: RandomState::new(),
        }
    }

    /// What all that is made of the file is charged to.
    pub fn budget(&self) -> &Rc<Budget> {
        &self.budget
    }

    /// Number of groups.
    pub fn count(&self) -> usize {
        self.nodes.len()
    }

    /// The group of this name in another.
    ///
    /// # Errors
    /// A budget that is used up.
    pub fn inside(&mut self, above: Group, name: &str) -> Result<Group, InputError> {
        let key = match self.place(above, name) {
            Ok(known) => return Ok(known),
            Err(key) => key,
        };
        self.budget.hold(COST + of_text(name.len()), PART)?;
        let Ok(place) = u32::try_from(self.nodes.len()) else {
            // More groups than any memory holds.
            return self.budget.hold(u64::MAX, PART).map(|()| above);
        };
        let over = &self.nodes[above.index()];
        self.nodes.push(Node {
            above,
            name: name.into(),
            depth: over.depth + 1,
            length: over.length + name.len(),
            hash: below(over.hash, self.hash(name)),
        });
        let group = Group(place);
        self.inside.insert(key, group);
        Ok(group)
    }

    /// The group of this name in another, if there is one.
    pub fn found(&self, above: Group, name: &str) -> Option<Group> {
        self.place(above, name).ok()
    }

    /// The group, or the key under which it will be found.
    fn place(&self, above: Group, name: &str) -> Result<Group, u64> {
        let mut key = self.hasher.hash_one((above, name));
        while let Some(&known) = self.inside.get(&key) {
            let node = &self.nodes[known.index()];
            if node.above == above && *node.name == *name {
                return Ok(known);
            }
            key = key.wrapping_add(1);
        }
        Err(key)
    }

    /// The name of a group.
    pub fn name(&self, group: Group) -> &str {
        &self.nodes[group.index()].name
    }

    /// Groups above a group and itself, the file not counted.
    pub fn depth(&self, group: Group) -> u32 {
        self.nodes[group.index()].depth
    }

    /// A group and those above it, the file last.
    pub fn upward(&self, group: Group) -> impl Iterator<Item = Group> + '_ {
        let above = |group: &Group| {
            let is_file = *group == Group::FILE;
            (!is_file).then(|| self.nodes[group.index()].above)
        };
        std::iter::successors(Some(group), above)
    }

    /// The group that contains both.
    pub fn shared(&self, one: Group, other: Group) -> Group {
        let (mut one, mut other) = (one, other);
        while one != other {
            let deeper = if self.depth(one) < self.depth(other) {
                &mut other
            } else {
                &mut one
            };
            *deeper = self.nodes[deeper.index()].above;
        }
        one
    }

    /// The names between a group and one above it, and a name in it, in one text, charged as the `part` of the file in words.
    ///
    /// # Errors
    /// A budget that is used up.
    pub fn label(
        &self,
        [from, group]: [Group; 2],
        name: Option<&str>,
        separator: &str,
        part: &str,
    ) -> Result<String, InputError> {
        let (node, above) = (&self.nodes[group.index()], &self.nodes[from.index()]);
        let levels = (node.depth - above.depth) as usize + name.iter().len();
        let length = node.length - above.length + name.map_or(0, str::len);
        let separators = levels.saturating_sub(1) * separator.len();
        self.budget.hold(of_text(length + separators), part)?;
        let between = self.upward(group).take_while(|each| *each != from);
        let mut names: Vec<&str> = between.map(|each| self.name(each)).collect();
        names.reverse();
        names.extend(name);
        Ok(names.join(separator))
    }

    /// A number for a name, as [`Groups::alike`] takes it.
    pub fn hash(&self, name: &str) -> u64 {
        self.hasher.hash_one(name)
    }

    /// A number for the names between a group and one above it, and a name in it by its hash: other names have it only with a
    /// probability of 2⁻⁶⁴.
    pub fn alike(&self, from: Group, group: Group, name: u64) -> u64 {
        let (node, above) = (&self.nodes[group.index()], &self.nodes[from.index()]);
        let between = FACTOR.wrapping_pow(node.depth - above.depth);
        let between = node.hash.wrapping_sub(above.hash.wrapping_mul(between));
        below(between, name)
    }
}

/// The polynomial of a name below others.
fn below(others: u64, name: u64) -> u64 {
    others.wrapping_mul(FACTOR).wrapping_add(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_limit::ReadLimit;

    fn groups(limit: u64) -> Groups {
        Groups::new(Rc::new(Budget::new("a.h5", ReadLimit::new(limit))))
    }

    #[test]
    fn a_group_is_one_however_often_it_is_named() {
        let mut groups = groups(1 << 20);
        let run = groups.inside(Group::FILE, "run").unwrap();
        let inner = groups.inside(run, "inner").unwrap();
        let held = groups.budget().used().0;
        assert_eq!(groups.inside(Group::FILE, "run").unwrap(), run);
        assert_eq!(groups.found(run, "inner"), Some(inner));
        assert_eq!(groups.found(inner, "run"), None);
        assert_eq!((groups.count(), groups.budget().used().0), (3, held));
        let other = groups.inside(run, "other").unwrap();
        assert_eq!(groups.shared(inner, other), run);
        assert_eq!(groups.shared(inner, run), run);
        let label = |from, of, name| groups.label([from, of], name, "/", "a name").unwrap();
        assert_eq!(label(Group::FILE, inner, Some("y")), "run/inner/y");
        assert_eq!(label(run, inner, None), "inner");
        assert_eq!(label(Group::FILE, Group::FILE, Some("y")), "y");
        assert_eq!(label(inner, inner, None), "");
    }

    #[test]
    fn names_below_two_groups_are_compared_without_their_places() {
        let mut groups = groups(1 << 20);
        let mut at = |path: &[&str]| {
            let inside = |above, name: &&str| groups.inside(above, name).unwrap();
            path.iter().fold(Group::FILE, inside)
        };
        let (one, two) = (at(&["1"]), at(&["a", "2"]));
        let (y, same, other) = (
            at(&["1", "y", "v"]),
            at(&["a", "2", "y", "v"]),
            at(&["1", "v", "y"]),
        );
        let of = |from, group, name| groups.alike(from, group, groups.hash(name));
        assert_eq!(of(one, y, "w"), of(two, same, "w"));
        assert_ne!(of(one, y, "w"), of(one, other, "w"));
        assert_ne!(of(one, y, "w"), of(one, y, "u"));
        assert_ne!(of(one, y, "w"), of(Group::FILE, y, "w"));
    }

    #[test]
    fn names_are_charged() {
        let mut groups = groups(1 << 16);
        let error = groups.inside(Group::FILE, &"g".repeat(1 << 13));
        let error = error.unwrap_err().to_string();
        assert!(
            error.contains(PART) && error.contains("--max-read"),
            "{error}"
        );
        let mut group = Group::FILE;
        let long = "g".repeat(1 << 10);
        group = groups.inside(group, &long).unwrap();
        let part = "its notes";
        let all = (0..8).try_for_each(|_| {
            groups
                .label([Group::FILE, group], None, "/", part)
                .map(drop)
        });
        assert!(all.unwrap_err().to_string().contains(part));
    }
}
