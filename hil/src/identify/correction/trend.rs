//! Smooth courses that the tables may follow at no cost: what a force over displacement and velocity mostly is.
//!
//! A table that is only asked to be smooth knows little between two blocks of a test and nothing beyond them. One that
//! follows a few products of a function of displacement and one of speed does, and the table proper is left with the rest.

use std::collections::BTreeMap;

use mesh_damper::effects::correction::{
    CELLS, DISPLACEMENTS, FINE, MEMORIES, MEMORY_CELLS, SPEEDS, part_of_speed,
};
use rayon::prelude::*;

use crate::correction::Remembered;

use super::gram::{Form, Rows};

/// Most trends that are added at once.
const MOST: usize = 5;
/// So many, which save most in the fit, are judged by what is left out of it.
const PROMISING: usize = 24;
/// A trend is taken for an error beyond the noise that is at most this part of that without.
const WORTHWHILE: f64 = 0.93;

/// Values in the cells of T, and in those of U after them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Trend(pub Vec<(usize, f64)>);

/// Functions of displacement over its largest value.
const OVER_DISPLACEMENT: [fn(f64) -> f64; 6] = [
    |_| 1.0,
    |u| u,
    f64::abs,
    |u| u * u,
    |u| u * u.abs(),
    |u| u * u * u,
];

/// Functions of speed over its largest value: powers, friction that grows from rest within a little speed, and what fades.
const OVER_SPEED: [fn(f64) -> f64; 12] = [
    |_| 1.0,
    f64::sqrt,
    |w| w,
    |w| w * w,
    |w| (w / 0.002).min(1.0),
    |w| (w / 0.006).min(1.0),
    |w| (-w / 0.03).exp(),
    |w| (-w / 0.1).exp(),
    |w| (-w / 0.3).exp(),
    |w| (-(w / 0.03).powi(2)).exp(),
    |w| (-(w / 0.1).powi(2)).exp(),
    |w| (-(w / 0.3).powi(2)).exp(),
];

/// Functions of where z stands in its range: some of what grows from its least value, some of what is lost at its middle.
const OVER_MEMORY: [fn(f64) -> f64; 5] = [
    |z| z,
    |z| z * z,
    |z| z - 0.5,
    |z| (z - 0.5).abs(),
    |z| (z - 0.5).powi(2),
];

/// Whether a force is the same or the opposite on the way back.
const OVER_DIRECTION: [[f64; 2]; 2] = [[1.0, 1.0], [1.0, -1.0]];

/// The first cell of each side that U may have, forwards and back.
const SIDES: [[usize; 2]; 2] = [
    [CELLS, CELLS + MEMORY_CELLS / 2],
    [CELLS + SPEEDS, CELLS + MEMORY_CELLS / 2 + SPEEDS],
];

/// What tables may be over beside what is remembered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variable {
    Displacement,
    /// Speed and direction.
    Velocity,
}

/// Every trend of T that eq 13 has not, or those that are not over a variable.
pub(super) fn of_table(without: Option<Variable>) -> Vec<Trend> {
    products(without, 0, SPEEDS, part_of_speed, &OVER_SPEED)
}

/// The same of U; none where it is a line over displacement, which is for what no trend is like.
pub(super) fn of_memory(of: Remembered, without: Option<Variable>) -> Vec<Trend> {
    match of {
        Remembered::Place => return Vec::new(),
        Remembered::Sides { .. } => return of_sides(without),
        _ => {}
    }
    let place = |node: usize| node as f64 / (MEMORIES - 1) as f64;
    products(without, CELLS, MEMORIES, place, &OVER_MEMORY)
}

/// Those of either side.
fn of_sides(without: Option<Variable>) -> Vec<Trend> {
    let mut trends = Vec::new();
    // Which side it is is the displacement.
    if without == Some(Variable::Displacement) {
        return trends;
    }
    for first in SIDES {
        for (j, over_speed) in OVER_SPEED.iter().enumerate() {
            for (back, direction) in OVER_DIRECTION.iter().enumerate() {
                if without.is_some() && j + back > 0 {
                    continue;
                }
                let both = direction.iter().zip(first).flat_map(|(sign, first)| {
                    let value = move |node| sign * over_speed(part_of_speed(node));
                    (0..SPEEDS).map(move |node| (first + node, value(node)))
                });
                trends.push(Trend(both.collect()));
            }
        }
    }
    trends
}

/// Nodes over speed at which T bends around its trends: every other one.
pub(super) const KNOTS: usize = SPEEDS.div_ceil(2);

/// What T is made of around its trends: displacement runs fastest, then the knots over speed, then direction.
pub(super) fn hats_of_table() -> Vec<Trend> {
    let mut hats = Vec::new();
    for way in 0..2 {
        for knot in 0..KNOTS {
            let hat =
                |place: usize| hat(knot, |node| (way * SPEEDS + node) * DISPLACEMENTS + place);
            hats.extend((0..DISPLACEMENTS).map(hat));
        }
    }
    hats
}

/// What is 1 at a knot over speed, in the cells that its nodes have.
fn hat(knot: usize, cell: impl Fn(usize) -> usize) -> Trend {
    let middle = 2 * knot;
    let mut cells = vec![(cell(middle), 1.0)];
    if knot > 0 {
        cells.push((cell(middle - 1), 0.5));
    }
    if middle + 1 < SPEEDS {
        cells.push((cell(middle + 1), 0.5));
    }
    Trend(cells)
}

/// The same of U: its cells, or the knots over speed of its sides, one after the other.
pub(super) fn hats_of_memory(of: Remembered) -> Vec<Trend> {
    let half = MEMORY_CELLS / 2;
    let each_way = |used: usize| {
        let cells = [CELLS, CELLS + half].into_iter();
        let cells = cells.flat_map(move |first| first..first + used);
        cells.map(|cell| Trend(vec![(cell, 1.0)])).collect()
    };
    match of {
        Remembered::Place => each_way(FINE),
        Remembered::Sides { .. } => {
            let lines = SIDES.into_iter().flatten();
            let knots = lines.flat_map(|first| (0..KNOTS).map(move |knot| (first, knot)));
            knots
                .map(|(first, knot)| hat(knot, |node| first + node))
                .collect()
        }
        _ => each_way(half),
    }
}

/// What the tables are made of that are not over displacement, or not over speed and direction: hats that differ in nothing else
/// are one.
pub(super) fn hats_without(variable: Variable, of: Option<Remembered>) -> Vec<Trend> {
    let is_displacement = variable == Variable::Displacement;
    let joined = |hats: Vec<Trend>, kept: &dyn Fn(usize) -> usize| {
        let mut joined: BTreeMap<usize, Vec<(usize, f64)>> = BTreeMap::new();
        for (number, hat) in hats.into_iter().enumerate() {
            joined.entry(kept(number)).or_default().extend(hat.0);
        }
        joined.into_values().map(Trend).collect::<Vec<_>>()
    };
    let mut all = joined(hats_of_table(), &|number| {
        if is_displacement {
            number / DISPLACEMENTS
        } else {
            number % DISPLACEMENTS
        }
    });
    let Some(of) = of else { return all };
    let way = hats_of_memory(of).len() / 2;
    all.extend(match (of, variable) {
        // Which side it is is the displacement.
        (Remembered::Sides { .. }, Variable::Displacement) => Vec::new(),
        (Remembered::Sides { .. }, Variable::Velocity) => {
            joined(hats_of_memory(of), &|number| number / way)
        }
        (Remembered::Place, Variable::Displacement) => {
            joined(hats_of_memory(of), &|number| number / way)
        }
        (_, Variable::Displacement) => joined(hats_of_memory(of), &|number| number / DISPLACEMENTS),
        (_, Variable::Velocity) => joined(hats_of_memory(of), &|number| number % way),
    });
    all
}

fn products(
    without: Option<Variable>,
    first: usize,
    nodes: usize,
    at: impl Fn(usize) -> f64,
    functions: &[fn(f64) -> f64],
) -> Vec<Trend> {
    let mut trends = Vec::new();
    for (i, over_displacement) in OVER_DISPLACEMENT.iter().enumerate() {
        for (j, along) in functions.iter().enumerate() {
            for (back, direction) in OVER_DIRECTION.iter().enumerate() {
                let of_speed = first == 0 && j > 0;
                // y and y³ are in eq 13.
                let is_known = first == 0 && j == 0 && back == 0 && matches!(i, 1 | 5);
                let is_allowed = match without {
                    None => true,
                    Some(Variable::Displacement) => i == 0,
                    Some(Variable::Velocity) => !of_speed && back == 0,
                };
                if is_known || !is_allowed {
                    continue;
                }
                let mut cells = Vec::new();
                for (way, sign) in direction.iter().enumerate() {
                    for node in 0..nodes {
                        for place in 0..DISPLACEMENTS {
                            let u = 2.0 * place as f64 / (DISPLACEMENTS - 1) as f64 - 1.0;
                            let value = sign * over_displacement(u) * along(at(node));
                            let row = way * nodes + node;
                            cells.push((first + row * DISPLACEMENTS + place, value));
                        }
                    }
                }
                trends.push(Trend(cells));
            }
        }
    }
    trends
}

/// `known` with those of `candidates` that make the judged error clearly smaller, one at a time; and that error, kN.
pub(super) fn grown(
    rows: &Rows,
    known: &[Trend],
    candidates: &[Trend],
) -> Option<(f64, Vec<Trend>)> {
    let all: Vec<Trend> = known.iter().chain(candidates).cloned().collect();
    let sums = rows.sums(Form {
        trends: &all,
        ..Form::NONE
    })?;
    let mut taken: Vec<usize> = (0..known.len()).collect();
    let mut error = sums.error_with(&taken)?;
    while taken.len() < known.len() + MOST {
        let savings = sums.savings_beside(&taken)?;
        let mut promising: Vec<usize> = (known.len()..all.len())
            .filter(|candidate| !taken.contains(candidate))
            .collect();
        promising.sort_by(|a, b| savings[*b].total_cmp(&savings[*a]));
        promising.truncate(PROMISING);
        let next = promising
            .into_par_iter()
            .filter_map(|candidate| {
                let more: Vec<usize> = taken.iter().copied().chain([candidate]).collect();
                Some((sums.error_with(&more)?, more))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match next {
            Some((less, more)) if less <= WORTHWHILE * error => (error, taken) = (less, more),
            _ => break,
        }
    }
    let taken = taken.into_iter().map(|index| all[index].clone());
    Some((error, taken.collect()))
}
