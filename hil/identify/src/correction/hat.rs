//! The building blocks of a table around its trends: single cells, or groups of cells between two knots.

use std::collections::BTreeMap;

use mesh_damper::effects::residual_table::{CELLS, DISPLACEMENTS, FINE, NODES};
use mesh_damper_model::correction::Remembered;

use super::trend::{SIDES, Trend, Variable};

/// Nodes over speed at which a table or a side can bend around its trends: every other one.
pub(super) const KNOTS: usize = NODES.div_ceil(2);

/// Displacement runs fastest, then the knots over speed or the nodes over the quantity in its place, then direction. For sides it
/// is the knots, then direction, then the side.
pub(super) fn hats(of: Option<Remembered>) -> Vec<Trend> {
    let each_way = |used: usize| {
        let cells = [0, CELLS / 2].into_iter();
        let cells = cells.flat_map(move |first| first..first + used);
        cells.map(|cell| Trend::of(vec![(cell, 1.0)])).collect()
    };
    match of {
        None => over_speed(),
        Some(Remembered::Place) => each_way(FINE),
        Some(Remembered::Sides { .. }) => {
            let lines = SIDES.into_iter().flatten();
            let knots = lines.flat_map(|first| (0..KNOTS).map(move |knot| (first, knot)));
            knots
                .map(|(first, knot)| hat(knot, |node| first + node))
                .collect()
        }
        Some(_) => each_way(CELLS / 2),
    }
}

fn over_speed() -> Vec<Trend> {
    let mut hats = Vec::new();
    for way in 0..2 {
        for knot in 0..KNOTS {
            let hat = |place: usize| hat(knot, |node| (way * NODES + node) * DISPLACEMENTS + place);
            hats.extend((0..DISPLACEMENTS).map(hat));
        }
    }
    hats
}

/// A hat over speed, 1 at its knot, in the cells of its nodes.
fn hat(knot: usize, cell: impl Fn(usize) -> usize) -> Trend {
    let middle = 2 * knot;
    let mut cells = vec![(cell(middle), 1.0)];
    if knot > 0 {
        cells.push((cell(middle - 1), 0.5));
    }
    if middle + 1 < NODES {
        cells.push((cell(middle + 1), 0.5));
    }
    Trend::of(cells)
}

/// The parts of a table that are not over displacement, or not over speed and direction. Hats that differ in nothing else count as
/// one.
pub(super) fn hats_without(variable: Variable, of: Option<Remembered>) -> Vec<Trend> {
    let hats = hats(of);
    let way = hats.len() / 2;
    let kept = |number: usize| match (of, variable) {
        (None, Variable::Velocity) => number % DISPLACEMENTS,
        (Some(Remembered::Place), Variable::Displacement)
        | (Some(Remembered::Sides { .. }), Variable::Velocity) => number / way,
        (_, Variable::Velocity) => number % way,
        (_, Variable::Displacement) => number / DISPLACEMENTS,
    };
    // The displacement decides the side.
    if let (Some(Remembered::Sides { .. }), Variable::Displacement) = (of, variable) {
        return Vec::new();
    }
    let mut joined: BTreeMap<usize, Vec<(usize, f64)>> = BTreeMap::new();
    for (number, hat) in hats.into_iter().enumerate() {
        joined.entry(kept(number)).or_default().extend(hat.cells);
    }
    joined.into_values().map(Trend::of).collect()
}
