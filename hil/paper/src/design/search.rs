//! Finds every density and amplitude with the required stiffness and loss factor.
//!
//! The search covers a grid of densities and amplitudes. Its lines include those of the tables, so that the coefficients are smooth
//! in every cell. Newton's method searches a cell wherever the logarithms of K/K* and η/η* may both pass through 0 in it. A region
//! of the grid within the tolerance where they do not is a near miss. At one given amplitude there is one unknown for two figures:
//! then the search looks for the density at which they are nearest.

use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_reference::tables::{AMPLITUDES, DENSITIES};

use super::figures::Figures;
use super::newton::Cell;
use super::regions::regions;
use super::{Meets, Point, Reachable, Wanted};

/// Cells between two lines of the tables, in each direction.
const CELLS: usize = 24;
/// The same along the densities of a single amplitude.
const CELLS_OF_LINE: usize = 400;
/// Possible excess of a figure within a cell beyond its corners: this fraction of their difference, plus this much of its
/// logarithm.
const BEYOND: (f64, f64) = (0.5, 2e-3);
/// Solutions closer to each other than this, g/cm³ and mm, are one.
const SAME: (f64, f64) = (1e-4, 1e-5);
/// Fraction of a cell that shows the slope of a figure at the cell's end.
const PROBE: f64 = 1e-3;
/// At a single amplitude both figures are met where their distance is below this.
const MET: f64 = 1e-6;
/// A region within the tolerance has a solution that is this many nodes away: it may end between two nodes.
const BESIDE: f64 = 1.0;
/// How often the surroundings of the nearest point are searched with a finer grid.
const ZOOMS: usize = 12;

/// ln(K/K*) and ln(η/η*).
type Misfit = [f64; 2];

/// The densities and amplitudes of the search.
pub(super) struct Search<'w> {
    wanted: &'w Wanted,
    densities: Vec<f64>,
    amplitudes: Vec<f64>,
    /// By amplitude and density.
    misfits: Vec<Vec<Misfit>>,
}

impl<'w> Search<'w> {
    pub(super) fn new(wanted: &'w Wanted) -> Self {
        let (low, high) = wanted.amplitudes;
        let is_line = low == high;
        let cells = if is_line { CELLS_OF_LINE } else { CELLS };
        let densities = nodes(&DENSITIES, (DENSITIES[0], DENSITIES[4]), cells);
        let amplitudes = if is_line {
            vec![low]
        } else {
            nodes(&AMPLITUDES, (low, high), CELLS)
        };
        let along = |&amplitude: &f64| {
            let of = |&density: &f64| misfit(wanted, density, amplitude);
            densities.iter().map(of).collect()
        };
        Self {
            wanted,
            misfits: amplitudes.iter().map(along).collect(),
            densities,
            amplitudes,
        }
    }

    /// The points that meet both figures. For every other region of densities and amplitudes that keeps both within the tolerance,
    /// also its nearest point.
    pub(super) fn solutions(&self) -> Vec<(Point, Meets)> {
        let mut found: Vec<(f64, f64, Meets)> = Vec::new();
        for (density, amplitude, meets) in self.candidates() {
            let same = |other: &(f64, f64, Meets)| {
                (other.0 - density).abs() < SAME.0 && (other.1 - amplitude).abs() < SAME.1
            };
            if !found.iter().any(same) {
                found.push((density, amplitude, meets));
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let points = found.into_iter();
        points
            .map(|(density, amplitude, meets)| (Point::at(self.wanted, density, amplitude), meets))
            .collect()
    }

    fn candidates(&self) -> Vec<(f64, f64, Meets)> {
        let mark = |meets| move |(density, amplitude)| (density, amplitude, meets);
        let all = |exact: Vec<(f64, f64)>, near: Vec<(f64, f64)>| {
            let exact = exact.into_iter().map(mark(Meets::Both));
            let near = near.into_iter().map(mark(Meets::WithinTolerance));
            exact.chain(near).collect()
        };
        if self.amplitudes.len() == 1 {
            let of_line = self.of_line().into_iter();
            let (exact, near) = of_line.partition::<Vec<_>, _>(|point| self.missed(point) < MET);
            let near = self.apart(&exact, near);
            return all(exact, near);
        }
        let exact = self.of_cells();
        let mut near = self.near_misses(&exact);
        if exact.is_empty() && near.is_empty() {
            // A region may be narrow enough to lie between the nodes.
            let Point {
                density, amplitude, ..
            } = self.nearest();
            let misfit = misfit(self.wanted, density, amplitude);
            near.extend(within(misfit, self.wanted.tolerance).then_some((density, amplitude)));
        }
        all(exact, near)
    }

    /// The nearest point of every region of the grid within the tolerance that has none of the `exact` solutions in it or next to
    /// it.
    fn near_misses(&self, exact: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let (rows, columns) = (self.amplitudes.len(), self.densities.len());
        let keeps =
            |row: usize, column: usize| within(self.misfits[row][column], self.wanted.tolerance);
        // Places among the nodes, with a fraction of the way to the next.
        let place = |nodes: &[f64], value: f64| {
            let above = nodes.partition_point(|&node| node < value).max(1);
            let (low, high) = (nodes[above - 1], nodes[above]);
            above as f64 - (high - value) / (high - low)
        };
        let places: Vec<(f64, f64)> = exact
            .iter()
            .map(|&(density, amplitude)| {
                (
                    place(&self.amplitudes, amplitude),
                    place(&self.densities, density),
                )
            })
            .collect();
        let beside = |place: f64, node: usize| (place - node as f64).abs() <= BESIDE;
        let has_solution = |region: &Vec<(usize, usize)>| {
            region.iter().any(|&(row, column)| {
                let mut solutions = places.iter();
                solutions.any(|&(a, b)| beside(a, row) && beside(b, column))
            })
        };
        let of = |&(row, column): &(usize, usize)| distance(self.misfits[row][column]);
        let nearest = regions(rows, columns, keeps)
            .into_iter()
            .filter(|region| !has_solution(region))
            .filter_map(|region| region.into_iter().min_by(|a, b| of(a).total_cmp(&of(b))))
            .map(|(row, column)| {
                self.refined(row, column, |misfit| within(misfit, self.wanted.tolerance))
            });
        // A narrow region breaks up on the grid.
        self.apart(exact, nearest.collect())
    }

    /// Those of `near`, the nearest first, that points outside the tolerance separate from the `exact` solutions and from each
    /// other.
    fn apart(&self, exact: &[(f64, f64)], mut near: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
        near.sort_by(|a, b| self.missed(a).total_cmp(&self.missed(b)));
        let mut kept: Vec<(f64, f64)> = Vec::new();
        for one in near {
            let mut known = exact.iter().chain(&kept);
            if !known.any(|&solution| self.joined(one, solution)) {
                kept.push(one);
            }
        }
        kept
    }

    /// The distance of a density and amplitude from the requirements.
    fn missed(&self, &(density, amplitude): &(f64, f64)) -> f64 {
        distance(misfit(self.wanted, density, amplitude))
    }

    /// Whether both figures are within the tolerance on the whole straight line between two densities and amplitudes.
    fn joined(&self, from: (f64, f64), to: (f64, f64)) -> bool {
        const PARTS: u32 = 100;
        (1..PARTS).all(|part| {
            let between =
                |from: f64, to: f64| from + (to - from) * f64::from(part) / f64::from(PARTS);
            let (density, amplitude) = (between(from.0, to.0), between(from.1, to.1));
            within(
                misfit(self.wanted, density, amplitude),
                self.wanted.tolerance,
            )
        })
    }

    /// The possible figures, and the point nearest to the requirements.
    pub(super) fn reachable(&self) -> Reachable {
        let all = || self.misfits.iter().flatten();
        let of = |index: usize, wanted: f64| {
            least_and_largest(all().map(|misfit| wanted * misfit[index].exp()))
        };
        let (stiffness, loss_factor) = (self.wanted.stiffness, self.wanted.loss_factor);
        let other = |index: usize, wanted: f64| {
            let passages = self.passages(1 - index);
            (!passages.is_empty()).then(|| {
                least_and_largest(passages.iter().map(|misfit| wanted * misfit[index].exp()))
            })
        };
        Reachable {
            stiffness: of(0, stiffness),
            loss_factor: of(1, loss_factor),
            loss_factor_at_stiffness: other(1, loss_factor),
            stiffness_at_loss_factor: other(0, stiffness),
            nearest: self.nearest(),
        }
    }

    /// The misfits where figure `index` passes through its required value along the lines of the grid, interpolated.
    fn passages(&self, index: usize) -> Vec<Misfit> {
        let mut passages = Vec::new();
        let mut pass = |a: Misfit, b: Misfit| {
            if (a[index] <= 0.0) != (b[index] <= 0.0) {
                let part = a[index] / (a[index] - b[index]);
                passages.push([0, 1].map(|i| a[i] + part * (b[i] - a[i])));
            }
        };
        for (row, line) in self.misfits.iter().enumerate() {
            for (column, &here) in line.iter().enumerate() {
                if let Some(&next) = line.get(column + 1) {
                    pass(here, next);
                }
                if let Some(next) = self.misfits.get(row + 1) {
                    pass(here, next[column]);
                }
            }
        }
        passages
    }

    fn nearest(&self) -> Point {
        let nodes = (0..self.amplitudes.len())
            .flat_map(|row| (0..self.densities.len()).map(move |column| (row, column)));
        let of = |&(row, column): &(usize, usize)| distance(self.misfits[row][column]);
        let (row, column) = nodes
            .min_by(|a, b| of(a).total_cmp(&of(b)))
            .unwrap_or_default();
        let (density, amplitude) = self.refined(row, column, |_| true);
        Point::at(self.wanted, density, amplitude)
    }

    /// The place near a node where the distance is smallest, among those that `may_be`.
    fn refined(&self, row: usize, column: usize, may_be: impl Fn(Misfit) -> bool) -> (f64, f64) {
        let mut best = (
            self.densities[column],
            self.amplitudes[row],
            distance(self.misfits[row][column]),
        );
        let bounds = |nodes: &[f64]| (nodes[0], nodes[nodes.len() - 1]);
        let (of_density, of_amplitude) = (bounds(&self.densities), bounds(&self.amplitudes));
        let cell = |nodes: &[f64]| (bounds(nodes).1 - bounds(nodes).0) / nodes.len() as f64;
        let mut reach = (cell(&self.densities), cell(&self.amplitudes));
        for _ in 0..ZOOMS {
            let centre = best;
            for i in -4..=4 {
                for j in -4..=4 {
                    let part = |i: i32| f64::from(i) / 4.0;
                    let density = centre.0 + part(i) * reach.0;
                    let density = density.clamp(of_density.0, of_density.1);
                    let amplitude = centre.1 + part(j) * reach.1;
                    let amplitude = amplitude.clamp(of_amplitude.0, of_amplitude.1);
                    let misfit = misfit(self.wanted, density, amplitude);
                    if distance(misfit) < best.2 && may_be(misfit) {
                        best = (density, amplitude, distance(misfit));
                    }
                }
            }
            reach = (0.4 * reach.0, 0.4 * reach.1);
        }
        (best.0, best.1)
    }

    /// The densities at which the distance is smallest, if it is within the tolerance.
    fn of_line(&self) -> Vec<(f64, f64)> {
        let amplitude = self.amplitudes[0];
        let at = |density: f64| self.missed(&(density, amplitude));
        // Figures may turn at a node, which is then the minimum; if they fall into a cell from both its ends, the minimum is
        // inside.
        let in_cell = |cell: &[f64]| {
            let (low, high) = (cell[0], cell[1]);
            let aside = PROBE * (high - low);
            (at(low + aside) < at(low) && at(high - aside) < at(high))
                .then(|| minimum(at, low, high))
        };
        let at_node = |&index: &usize| {
            let here = at(self.densities[index]);
            let beside = |other: Option<&f64>| {
                let node = self.densities[index];
                other.is_none_or(|other| at(node + PROBE * (other - node)) >= here)
            };
            let below = index
                .checked_sub(1)
                .and_then(|below| self.densities.get(below));
            beside(below) && beside(self.densities.get(index + 1))
        };
        let nodes = (0..self.densities.len()).filter(at_node);
        let in_cells = self.densities.windows(2).filter_map(in_cell);
        nodes
            .map(|index| self.densities[index])
            .chain(in_cells)
            .map(|density| (density, amplitude))
            .filter(|&(density, amplitude)| {
                within(
                    misfit(self.wanted, density, amplitude),
                    self.wanted.tolerance,
                )
            })
            .collect()
    }

    fn of_cells(&self) -> Vec<(f64, f64)> {
        let mut found = Vec::new();
        for (row, amplitudes) in self.amplitudes.windows(2).enumerate() {
            for (column, densities) in self.densities.windows(2).enumerate() {
                let (near, far) = (&self.misfits[row], &self.misfits[row + 1]);
                let corners = [near[column], near[column + 1], far[column], far[column + 1]];
                if (0..2).all(|index| may_vanish(corners.map(|corner| corner[index]))) {
                    let cell = Cell {
                        wanted: self.wanted,
                        density: (densities[0], densities[1]),
                        amplitude: (amplitudes[0], amplitudes[1]),
                    };
                    found.extend(cell.solutions());
                }
            }
        }
        found
    }
}

impl Point {
    pub(super) fn at(wanted: &Wanted, density: f64, amplitude: f64) -> Self {
        let law = wanted.law.coefficients(density, amplitude);
        let Figures {
            stiffness,
            loss_factor,
        } = Figures::of(&law, amplitude, wanted.frequency);
        Self {
            density,
            amplitude,
            stiffness,
            loss_factor,
        }
    }
}

/// The amplitudes around `point` at which its density keeps both figures within the tolerance, mm.
pub(super) fn amplitudes_about(wanted: &Wanted, point: &Point) -> (f64, f64) {
    const PARTS: usize = 400;
    const HALVINGS: usize = 40;
    let keeps = |amplitude: f64| within(misfit(wanted, point.density, amplitude), wanted.tolerance);
    let towards = |end: f64| {
        let place = |i: usize| point.amplitude + (end - point.amplitude) * i as f64 / PARTS as f64;
        let Some(first_out) = (1..=PARTS).find(|&i| !keeps(place(i))) else {
            return end;
        };
        let (mut kept, mut out) = (place(first_out - 1), place(first_out));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (kept + out);
            if keeps(middle) {
                kept = middle;
            } else {
                out = middle;
            }
        }
        kept
    };
    (towards(AMPLITUDES[0]), towards(AMPLITUDES[4]))
}

pub(super) fn within(misfit: Misfit, tolerance: f64) -> bool {
    misfit
        .iter()
        .all(|misfit| misfit.exp_m1().abs() <= tolerance)
}

pub(super) fn misfit(wanted: &Wanted, density: f64, amplitude: f64) -> Misfit {
    let point = Point::at(wanted, density, amplitude);
    [
        (point.stiffness / wanted.stiffness).ln(),
        (point.loss_factor / wanted.loss_factor).ln(),
    ]
}

fn distance(misfit: Misfit) -> f64 {
    misfit[0].hypot(misfit[1])
}

/// Whether a figure with these misfits at a cell's corners may reach its required value somewhere in the cell.
fn may_vanish(corners: [f64; 4]) -> bool {
    let (low, high) = least_and_largest(corners);
    let beyond = BEYOND.0 * (high - low) + BEYOND.1;
    low - beyond <= 0.0 && high + beyond >= 0.0
}

/// The ends of the range and the lines of the tables in between, with `cells` cells between them.
fn nodes(lines: &[f64], (low, high): (f64, f64), cells: usize) -> Vec<f64> {
    let mut ends = vec![low];
    ends.extend(
        lines
            .iter()
            .copied()
            .filter(|&line| low < line && line < high),
    );
    ends.push(high);
    let mut nodes: Vec<f64> = ends
        .windows(2)
        .flat_map(|pair| {
            let place = |i: usize| pair[0] + (pair[1] - pair[0]) * i as f64 / cells as f64;
            (0..cells).map(place).collect::<Vec<f64>>()
        })
        .collect();
    nodes.push(high);
    nodes
}

/// The minimum of a function that falls and then rises between `low` and `high`.
fn minimum(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    // Each step leaves two thirds.
    for _ in 0..80 {
        let third = (high - low) / 3.0;
        let (a, b) = (low + third, high - third);
        if function(a) < function(b) {
            high = b;
        } else {
            low = a;
        }
    }
    0.5 * (low + high)
}
