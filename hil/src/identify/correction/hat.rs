//! What tables are made of around their trends: cells, or several that stand between two knots.

use std::collections::BTreeMap;

use mesh_damper::effects::correction::{CELLS, DISPLACEMENTS, FINE, MEMORY_CELLS, SPEEDS};

use super::trend::{SIDES, Trend, Variable};
use crate::correction::Remembered;

/// Nodes over speed at which T, or a side of U, bends around its trends: every other one.
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
    Trend::of(cells)
}

/// The same of U: its cells, or the knots over speed of its sides, one after the other.
pub(super) fn hats_of_memory(of: Remembered) -> Vec<Trend> {
    let half = MEMORY_CELLS / 2;
    let each_way = |used: usize| {
        let cells = [CELLS, CELLS + half].into_iter();
        let cells = cells.flat_map(move |first| first..first + used);
        cells.map(|cell| Trend::of(vec![(cell, 1.0)])).collect()
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
            joined.entry(kept(number)).or_default().extend(hat.cells);
        }
        joined.into_values().map(Trend::of).collect::<Vec<_>>()
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
