//! Groups with the same channels: runs of one test, which are separate tables even if their times are the same.

use std::collections::{HashMap, HashSet};

/// The most tables into which arrays of the same times are divided. Convention: more runs than any test has, and few enough to
/// list.
const MOST: usize = 1 << 10;

/// An array in some groups: its groups, its name, and whether it holds times.
pub(super) struct Member<'m> {
    pub group: &'m [String],
    pub name: &'m str,
    pub is_time: bool,
}

/// Members that belong together, by their indices, and the groups that distinguish them from the others.
pub(super) type Run = (Vec<String>, Vec<usize>);

/// Divides members of the same times into runs: parallel groups that share at least two channel names. Members elsewhere belong to
/// all of them. A single shared name is not enough: `force/value` and `displacement/value` are channels of one table.
pub(super) fn runs(members: &[Member<'_>]) -> Vec<Run> {
    below(members, (0..members.len()).collect(), 0)
}

fn below(members: &[Member<'_>], of: Vec<usize>, depth: usize) -> Vec<Run> {
    let mut here = Vec::new();
    let mut groups: Vec<(&str, Vec<usize>)> = Vec::new();
    let mut places: HashMap<&str, usize> = HashMap::new();
    for index in of {
        let Some(name) = members[index].group.get(depth) else {
            here.push(index);
            continue;
        };
        let place = *places.entry(name).or_insert(groups.len());
        match groups.get_mut(place) {
            Some((_, inside)) => inside.push(index),
            None => groups.push((name, vec![index])),
        }
    }
    if groups.is_empty() {
        return vec![(Vec::new(), here)];
    }
    // The channels outside the groups may be a run too.
    let key = |index: usize, depth: usize| {
        (
            members[index].group.get(depth..).unwrap_or_default(),
            members[index].name,
        )
    };
    let keys = |inside: &[usize], depth: usize| -> HashSet<(&[String], &str)> {
        let channels = inside.iter().filter(|&&index| !members[index].is_time);
        channels.map(|&index| key(index, depth)).collect()
    };
    let mut all: Vec<HashSet<(&[String], &str)>> = groups
        .iter()
        .map(|(_, inside)| keys(inside, depth + 1))
        .collect();
    all.push(keys(&here, depth));
    let mut times_seen: HashMap<(&[String], &str), usize> = HashMap::new();
    for key in all.iter().flatten() {
        *times_seen.entry(*key).or_insert(0) += 1;
    }
    let is_alike = |keys: &HashSet<(&[String], &str)>| {
        keys.iter().filter(|key| times_seen[*key] > 1).count() > 1
    };
    let alike: Vec<bool> = all.iter().map(is_alike).collect();
    let count = alike.iter().filter(|&&is_alike| is_alike).count();
    if (2..MOST).contains(&count) {
        let is_here = alike[groups.len()];
        let mut shared = if is_here { Vec::new() } else { here.clone() };
        for ((_, inside), _) in groups
            .iter()
            .zip(&alike)
            .filter(|(_, is_alike)| !**is_alike)
        {
            shared.extend(inside);
        }
        let mut found: Vec<Run> = Vec::new();
        if is_here {
            found.push((Vec::new(), here.iter().chain(&shared).copied().collect()));
        }
        for ((name, inside), _) in groups
            .into_iter()
            .zip(&alike)
            .filter(|(_, is_alike)| **is_alike)
        {
            for (path, run) in below(members, inside, depth + 1) {
                let path = [name.to_owned()].into_iter().chain(path).collect();
                found.push((path, shared.iter().chain(&run).copied().collect()));
            }
        }
        found.iter_mut().for_each(|(_, run)| run.sort_unstable());
        return found;
    }
    let mut found: Vec<Run> = vec![(Vec::new(), here)];
    for (name, inside) in groups {
        let inner = below(members, inside.clone(), depth + 1);
        if inner.len() == 1 || found.len() * inner.len() > MOST {
            found.iter_mut().for_each(|(_, run)| run.extend(&inside));
            continue;
        }
        let with = |(path, run): &Run| {
            let each = inner.iter().map(|(inside, more)| {
                let path = path.iter().cloned().chain([name.to_owned()]);
                let path = path.chain(inside.iter().cloned()).collect();
                (path, run.iter().chain(more).copied().collect())
            });
            each.collect::<Vec<Run>>()
        };
        found = found.iter().flat_map(with).collect();
    }
    found.iter_mut().for_each(|(_, run)| run.sort_unstable());
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `name: member, member` of each run.
    fn said(paths: &[&str]) -> Vec<String> {
        let owned: Vec<Vec<String>> = (paths.iter())
            .map(|path| path.split('/').map(str::to_owned).collect())
            .collect();
        let members: Vec<Member<'_>> = (owned.iter())
            .map(|path| Member {
                group: &path[..path.len() - 1],
                name: path.last().unwrap(),
                is_time: path.last().unwrap() == "t",
            })
            .collect();
        let each = runs(&members).into_iter().map(|(name, run)| {
            let inside: Vec<&str> = run.into_iter().map(|index| paths[index]).collect();
            format!("{}: {}", name.join("/"), inside.join(", "))
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
}
