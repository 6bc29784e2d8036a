//! Verdicts and effects by group.

use std::collections::{BTreeMap, BTreeSet};

use maud::{Markup, html};
use mesh_damper_identify::trace::conclusion::Conclusion;
use mesh_damper_identify::trace::result::Estimate;

use super::{BatchEffect, BatchRow, outcomes, pictures};
use crate::html::{figure, table};
use crate::text;

/// Most groups with a separate row: the largest ones. The others share one row.
const MOST_GROUPS: usize = 40;

/// Rows of one group, under its name.
pub struct Group<'a> {
    pub name: String,
    pub rows: Vec<&'a BatchRow>,
}

impl<'a> Group<'a> {
    /// The effects that traces found; an ambiguous trace does not count, because its effect is not known.
    fn found(&self) -> impl Iterator<Item = &'a BatchEffect> {
        let done = self.rows.iter().filter_map(|row| row.outcome.as_ref().ok());
        done.filter(|one| one.conclusion != Conclusion::Ambiguous)
            .flat_map(|one| &one.effects)
    }
}

/// The groups by name; if there are many, the largest, and the others combined.
pub fn groups(rows: &[BatchRow]) -> Vec<Group<'_>> {
    let without = if rows.iter().any(|row| row.group.is_some()) {
        "without a group"
    } else {
        "all"
    };
    let mut by_name: BTreeMap<&str, Vec<&BatchRow>> = BTreeMap::new();
    for row in rows {
        by_name
            .entry(row.group.as_deref().unwrap_or(without))
            .or_default()
            .push(row);
    }
    let mut all: Vec<Group<'_>> = by_name
        .into_iter()
        .map(|(name, rows)| Group {
            name: name.to_owned(),
            rows,
        })
        .collect();
    if all.len() > MOST_GROUPS {
        all.sort_by_key(|group| std::cmp::Reverse(group.rows.len()));
        let others = all.split_off(MOST_GROUPS - 1);
        all.sort_by(|a, b| a.name.cmp(&b.name));
        all.push(Group {
            name: format!("{} other groups", others.len()),
            rows: others.into_iter().flat_map(|group| group.rows).collect(),
        });
    }
    all
}

/// How often each verdict occurred in each group.
pub fn verdicts(rows: &[BatchRow]) -> Markup {
    let of = |rows: &[&BatchRow], conclusion| {
        let given = rows.iter().filter_map(|row| row.outcome.as_ref().ok());
        given.filter(|one| one.conclusion == conclusion).count()
    };
    let counts = |name: &str, rows: &[&BatchRow], is_sum: bool| {
        let failed = rows.iter().filter(|row| row.outcome.is_err()).count();
        html! {
            tr.best[is_sum] {
                th scope="row" { (name) }
                td { (rows.len()) }
                @for conclusion in Conclusion::ALL { td { (of(rows, conclusion)) } }
                td { (failed) }
            }
        }
    };
    let groups = groups(rows);
    let head = html! { tr {
        th scope="col" { "group" } th scope="col" { "traces" }
        @for conclusion in Conclusion::ALL { th scope="col" { (conclusion.words()) } }
        th scope="col" { "failed" }
    } };
    let all: Vec<&BatchRow> = rows.iter().collect();
    let body = html! {
        @if groups.len() > 1 { @for group in &groups { (counts(&group.name, &group.rows, false)) } }
        (counts("all", &all, groups.len() > 1))
    };
    table("Verdicts by group", head, body)
}

/// How often each effect was found in each group, and with which parameters; `None` if there are none.
pub fn effects(rows: &[BatchRow]) -> Option<Markup> {
    let families: BTreeSet<&str> = outcomes(rows)
        .filter(|one| one.conclusion != Conclusion::Ambiguous)
        .flat_map(|one| &one.effects)
        .map(|effect| &effect.family[..])
        .collect();
    if families.is_empty() {
        return None;
    }
    let groups = groups(rows);
    let count = |group: &Group<'_>, family: &str| {
        let has = |effect: &&BatchEffect| effect.family == family;
        group.found().filter(has).count()
    };
    let head = html! { tr {
        th scope="col" { "group" } th scope="col" { "traces" }
        @for family in &families { th scope="col" { (text::name(family)) } }
    } };
    let body = html! {
        @for group in &groups {
            tr {
                th scope="row" { (group.name) }
                td { (group.rows.len()) }
                @for family in &families { td { (count(group, family)) } }
            }
        }
    };
    let pictures = pictures::parameters(&groups);
    Some(html! {
        p { "An effect counts if a trace found it and can tell it from all others." }
        (table("Traces with each effect, by group", head, body))
        (parameters(&groups))
        @if !pictures.is_empty() {
            h3 { "Parameters by group" }
            div.pair { @for picture in &pictures { (figure(html! { (picture.title) }, picture)) } }
        }
    })
}

/// A parameter of an effect: family and name.
pub type Parameter<'a> = (&'a str, &'a str);

/// The estimates of each parameter, group by group in the order of `groups`.
pub fn estimates<'a>(groups: &'a [Group<'_>]) -> BTreeMap<Parameter<'a>, Vec<Vec<&'a Estimate>>> {
    let mut all: BTreeMap<Parameter<'a>, Vec<Vec<&Estimate>>> = BTreeMap::new();
    for (place, group) in groups.iter().enumerate() {
        for effect in group.found() {
            for (name, estimate) in &effect.parameters {
                let of_groups = all
                    .entry((&effect.family, name))
                    .or_insert_with(|| vec![Vec::new(); groups.len()]);
                of_groups[place].push(estimate);
            }
        }
    }
    all
}

fn parameters(groups: &[Group<'_>]) -> Markup {
    let head = html! { tr {
        th scope="col" { "effect" } th.text scope="col" { "parameter" } th.text scope="col" { "group" } th scope="col" { "traces" }
        th scope="col" { "median" } th scope="col" { "least" } th scope="col" { "largest" }
        th scope="col" { "median half width of the interval" } th.text scope="col" { "unit" }
    } };
    let body = html! {
        @for ((family, name), of_groups) in estimates(groups) {
            @for (group, estimates) in groups.iter().zip(of_groups).filter(|(_, estimates)| !estimates.is_empty()) {
                @let values = sorted(estimates.iter().map(|one| one.value));
                @let halves = sorted(estimates.iter().map(|one| 0.5 * (one.high - one.low)));
                tr {
                    th scope="row" { (text::name(family)) }
                    td.text { (name.replace('_', " ")) }
                    td.text { (group.name) }
                    td { (estimates.len()) }
                    td { (text::number(median(&values))) }
                    td { (text::number(values[0])) }
                    td { (text::number(values[values.len() - 1])) }
                    td { (text::number(median(&halves))) }
                    td.text { (text::unit(&estimates[0].unit)) }
                }
            }
        }
    };
    table("Parameters of the effects, by group", head, body)
}

/// For values in order.
fn median(sorted: &[f64]) -> f64 {
    let half = sorted.len() / 2;
    0.5 * (sorted[half] + sorted[(sorted.len() - 1) / 2])
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}
