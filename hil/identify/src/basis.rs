//! The columns in which a fit is linear, for given exponents and shapes.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use mesh_damper::limits::COEFFICIENT;
use mesh_damper_model::LawNode;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_recording::trajectory::strides::Stride;

use super::families::{Entry, Form, Moment, Path, Step};
use super::known_forces::UnitForces;
use super::moved::{delayed, moved};
use super::rows::{RowMotion, Rows};
use super::shape::{Extent, Shape};
use super::solution::{Deflection, Solution};
use super::term::{Term, TermValue};

/// Step of a finite difference for a derivative.
pub(super) const STEP: f64 = 1e-4;
/// Samples for which eq 13 is computed at once. The number does not affect the result.
const PART: usize = 4096;

/// Eq 13 and added terms over the rows of a fit.
///
/// The searched parameters are the exponents of the nodes, then those of each term: the sizes of terms that scale eq 13, and
/// logarithms of shapes.
#[derive(Clone)]
pub(super) struct Basis<'r, 'a> {
    pub rows: &'r Rows<'a>,
    pub terms: Vec<Term>,
    shapes: Vec<Vec<Shape>>,
    /// The place of each term's searched parameters.
    slots: Vec<Range<usize>>,
    /// The deflections of a spring in series, if there is one.
    deflections: Option<Vec<Deflection>>,
}

/// The columns for one set of searched parameters.
#[derive(Clone)]
pub(super) struct Columns {
    at: Vec<f64>,
    /// Whether other fits may start from here too.
    is_start: bool,
    moved: Option<Arc<Moved>>,
    law: Arc<LawColumns>,
    /// The forces of each term with size 1 at every row.
    added: Vec<Vec<Arc<Vec<f64>>>>,
    /// The force of the terms with a held size at every row, kN; `None` without such a term.
    held: Option<Arc<Vec<f64>>>,
}

/// The columns of eq 13 at every row, scaled if a term scales them.
struct LawColumns {
    /// y, y³ and |v|^α·sgn v.
    unit: Vec<[f64; 3]>,
    /// |v|^α·ln |v|·sgn v, the derivative of the last by α.
    by_exponent: Vec<f64>,
}

struct Moved {
    /// The terms that change the recorded motion, each with its shape. The changed motion is computed where it is needed: stored at
    /// every sample, the motions of all searches took as much memory as everything else together.
    by: Vec<(Form, f64)>,
    /// `None` if the motion stays as recorded and only the readings of the force differ.
    rows: Option<RowMotion>,
}

impl<'r, 'a> Basis<'r, 'a> {
    pub fn new(rows: &'r Rows<'a>, extent: &Extent, terms: &[Term]) -> Self {
        let mut from = rows.nodes.len();
        let slots = terms
            .iter()
            .map(|term| {
                let slot = from..from + term.form.searched();
                from = slot.end;
                slot
            })
            .collect();
        Self {
            rows,
            shapes: terms
                .iter()
                .map(|term| (term.form.shapes)(extent))
                .collect(),
            terms: terms.to_vec(),
            slots,
            deflections: None,
        }
    }

    /// As [`Basis::new`], with a spring in series that deflects as in `solution`, if there is one.
    #[must_use]
    pub fn around(mut self, solution: &Solution) -> Self {
        if self.terms.iter().any(|term| term.form.gives_way) {
            self.deflections = Some(solution.deflections(self.rows.trajectories));
        }
        self
    }

    /// Whether a size, counted over all terms, must not be negative.
    pub fn is_positive(&self, size: usize) -> bool {
        self.terms
            .iter()
            .flat_map(|term| std::iter::repeat_n(term.form.size_is_positive, term.fitted_sizes()))
            .nth(size)
            .unwrap_or(false)
    }

    /// The solution for the searched parameters `at` and the `linear` unknowns; `squares` is the sum of its squared errors, kN².
    pub fn solution(&self, at: &[f64], linear: &[f64], squares: f64) -> Solution {
        let nodes = self.rows.nodes.len();
        let law = (0..nodes)
            .map(|node| LawNode {
                amplitude: self.rows.nodes[node],
                // Limited to the crate's range: a force over almost no displacement asks for more.
                k1: linear[3 * node].clamp(-COEFFICIENT, COEFFICIENT),
                k3: linear[3 * node + 1].clamp(-COEFFICIENT, COEFFICIENT),
                c: linear[3 * node + 2].min(COEFFICIENT),
                alpha: self.alpha(at, node),
            })
            .collect();
        let mut sizes = linear.iter().skip(3 * nodes).copied();
        let terms = self
            .terms
            .iter()
            .enumerate()
            .map(|(index, &term)| TermValue {
                term,
                sizes: match (term.held, term.form.entry) {
                    (Some(size), _) => vec![size],
                    (None, Entry::Adds(count)) => sizes.by_ref().take(count).collect(),
                    (None, Entry::Scales(_)) => self.scales(at, index),
                    (None, Entry::Moves) => Vec::new(),
                },
                shapes: self.shapes(at, index),
            })
            .collect();
        Solution {
            law,
            terms,
            search: at.to_vec(),
            squares,
        }
    }

    /// The place of a term's searched parameters.
    pub fn slot(&self, term: usize) -> Range<usize> {
        self.slots[term].clone()
    }

    /// The exponent of a node.
    pub fn alpha(&self, at: &[f64], node: usize) -> f64 {
        let given = self.rows.law.exponent();
        given.unwrap_or(at[node]).clamp(0.0, 1.0)
    }

    /// The shapes of a term.
    pub fn shapes(&self, at: &[f64], term: usize) -> Vec<f64> {
        let searched = &at[self.slot(term)][self.terms[term].form.scales()..];
        self.shapes[term]
            .iter()
            .zip(searched)
            .map(|(shape, x)| x.exp().clamp(shape.low, shape.high))
            .collect()
    }

    /// The sizes of a term that scales eq 13, limited to the crate's range.
    fn scales(&self, at: &[f64], term: usize) -> Vec<f64> {
        let form = self.terms[term].form;
        let [least, largest] = form.scale_range;
        let sizes = at[self.slot(term)].iter().take(form.scales());
        sizes.map(|size| size.clamp(least, largest)).collect()
    }

    /// The columns at `at`; unchanged ones are taken from `known`.
    pub fn columns(&self, at: &[f64], known: Option<&Columns>) -> Columns {
        self.columns_as(at, known, known.is_none())
    }

    fn columns_as(&self, at: &[f64], known: Option<&Columns>, is_start: bool) -> Columns {
        let same = |range: Range<usize>| known.filter(|known| known.at[range.clone()] == at[range]);
        let stays = |is_of: fn(Entry) -> bool| {
            (0..self.terms.len())
                .filter(|&term| is_of(self.terms[term].form.entry))
                .all(|term| same(self.slot(term)).is_some())
        };
        let motion_stays = stays(|entry| entry == Entry::Moves);
        let moved = match known.filter(|_| motion_stays) {
            Some(known) => known.moved.clone(),
            None => self.moved(at).map(Arc::new),
        };
        let law_stays = motion_stays && stays(|entry| matches!(entry, Entry::Scales(_)));
        let law = match known.filter(|_| law_stays && same(0..self.rows.nodes.len()).is_some()) {
            Some(known) => known.law.clone(),
            None => Arc::new(self.law(at, &moved)),
        };
        let added = (0..self.terms.len())
            .map(
                |term| match same(self.slot(term)).filter(|_| motion_stays) {
                    Some(known) => known.added[term].clone(),
                    None => self.added(at, term, &moved, is_start),
                },
            )
            .collect();
        let held = match known.filter(|_| motion_stays) {
            Some(known) => known.held.clone(),
            None => self.held(&moved).map(Arc::new),
        };
        Columns {
            at: at.to_vec(),
            is_start,
            moved,
            law,
            added,
            held,
        }
    }

    /// The force of the terms with a held size at every row, kN. A mass is never refused.
    fn held(&self, moved: &Option<Arc<Moved>>) -> Option<Vec<f64>> {
        let mut total: Option<Vec<f64>> = None;
        for term in &self.terms {
            let Some(size) = term.held else { continue };
            let units = self.forces(term.form, &[], moved, true).unwrap_or_default();
            let total = total.get_or_insert_with(|| vec![0.0; self.rows.len()]);
            for (total, unit) in total
                .iter_mut()
                .zip(units.iter().flat_map(|unit| unit.iter()))
            {
                *total += size * unit;
            }
        }
        total
    }

    /// The measured force at every row without that of the terms with a held size, kN: what the unknowns have to explain.
    pub fn to_explain(&self, columns: &Columns) -> Cow<'_, [f64]> {
        match &columns.held {
            Some(held) => {
                let rows = self.rows.force.iter().zip(held.iter());
                Cow::Owned(rows.map(|(force, held)| force - held).collect())
            }
            None => Cow::Borrowed(&self.rows.force),
        }
    }

    /// The force at every row with the `linear` unknowns: k1, k3 and c of every node, then the sizes; kN.
    pub fn force(&self, columns: &Columns, linear: &[f64]) -> Vec<f64> {
        let sizes = &linear[3 * self.rows.nodes.len()..];
        let mut force = self.law_force(columns, linear);
        if let Some(held) = &columns.held {
            for (force, held) in force.iter_mut().zip(held.iter()) {
                *force += held;
            }
        }
        for (size, column) in sizes.iter().zip(columns.added()) {
            for (force, unit) in force.iter_mut().zip(column) {
                *force += size * unit;
            }
        }
        force
    }

    /// Whether each term adds to every row less than `part` of the largest magnitude of that force.
    pub fn adds_nothing(&self, columns: &Columns, linear: &[f64], part: f64) -> Vec<bool> {
        let largest = |force: &[f64]| force.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
        let least = part * largest(&self.force(columns, linear));
        let mut sizes = &linear[3 * self.rows.nodes.len()..];
        let each = self.terms.iter().zip(&columns.added);
        each.map(|(term, units)| {
            let (own, others) = sizes.split_at(units.len());
            sizes = others;
            let mut added = units.iter().zip(own);
            term.fitted_sizes() > 0 && added.all(|(unit, size)| size.abs() * largest(unit) < least)
        })
        .collect()
    }

    /// The part of that force due to eq 13.
    fn law_force(&self, columns: &Columns, linear: &[f64]) -> Vec<f64> {
        let rows = columns.law.unit.iter();
        rows.zip(&self.motion(columns).node)
            .map(|(row, node)| (0..3).map(|i| linear[3 * node + i] * row[i]).sum())
            .collect()
    }

    /// The derivative of that force with respect to one searched parameter, at every row.
    pub fn slope(&self, columns: &Columns, linear: &[f64], slot: usize) -> Vec<f64> {
        if slot < self.rows.nodes.len() {
            return self.exponent_slope(columns, linear, slot);
        }
        if let Some(units) = self.unit_slopes(columns, slot) {
            return self.slope_of(&units, linear, slot);
        }
        let (columns, beside, step) = self.beside(columns, slot);
        let (here, there) = (self.force(&columns, linear), self.force(&beside, linear));
        let pairs = here.iter().zip(there);
        pairs.map(|(here, there)| (there - here) / step).collect()
    }

    /// The derivatives of a term's forces with size 1 with respect to one of its searched parameters, at every row; `None` for a term that
    /// does not only add a force.
    pub fn unit_slopes(&self, columns: &Columns, slot: usize) -> Option<Vec<Vec<f64>>> {
        let term = self.term_of(slot)?;
        if !matches!(self.terms[term].form.entry, Entry::Adds(_)) {
            return None;
        }
        let (columns, beside, step) = self.beside(columns, slot);
        let pairs = columns.added[term].iter().zip(&beside.added[term]);
        let slopes = pairs.map(|(here, there)| {
            let rows = here.iter().zip(there.iter());
            rows.map(|(here, there)| (there - here) / step).collect()
        });
        Some(slopes.collect())
    }

    /// The derivative of the force with the `linear` unknowns, from those with size 1.
    pub fn slope_of(&self, units: &[Vec<f64>], linear: &[f64], slot: usize) -> Vec<f64> {
        let before = self
            .terms
            .iter()
            .take(self.term_of(slot).unwrap_or_default());
        let before: usize = before.map(Term::fitted_sizes).sum();
        let sizes = &linear[3 * self.rows.nodes.len() + before..];
        let mut slope = vec![0.0; self.rows.len()];
        for (size, unit) in sizes.iter().zip(units) {
            let rows = slope.iter_mut().zip(unit);
            rows.for_each(|(slope, unit)| *slope += size * unit);
        }
        slope
    }

    /// The columns at both ends of a difference, and the change of the parameter between them.
    fn beside(&self, columns: &Columns, slot: usize) -> (Columns, Columns, f64) {
        let [from, to] = self.ends(columns.at[slot], slot);
        let at = |value: f64| {
            let mut at = columns.at.clone();
            at[slot] = value;
            self.columns_as(&at, Some(columns), columns.is_start)
        };
        (at(from), at(to), to - from)
    }

    /// The term that a searched parameter belongs to; `None` for an exponent of the law.
    fn term_of(&self, slot: usize) -> Option<usize> {
        (0..self.terms.len()).find(|&term| self.slot(term).contains(&slot))
    }

    /// Whether a term's force with size 1 and its derivatives are practically the same at two places: its shapes and those of terms that
    /// move the motion differ by less than `part`. A tone turns over a whole recording with its frequency.
    pub fn is_near(&self, slot: usize, [here, there]: [&[f64]; 2], part: f64) -> bool {
        let own = self.term_of(slot);
        if own.is_some_and(|term| self.terms[term].form.follows_clock) {
            return false;
        }
        let moves = |term: &usize| self.terms[*term].form.entry == Entry::Moves;
        let mut terms = (0..self.terms.len()).filter(|term| Some(*term) == own || moves(term));
        terms.all(|term| {
            let mut slots = self.slot(term);
            slots.all(|slot| (here[slot] - there[slot]).abs() < part)
        })
    }

    /// The two values of a term's searched parameter between which the difference is taken, for the present value `at`: from here
    /// away from the nearer end of its range, where it is held.
    fn ends(&self, at: f64, slot: usize) -> [f64; 2] {
        let term = self.term_of(slot);
        let form = term.map(|term| self.terms[term].form);
        let shape = term.zip(form).and_then(|(term, form)| {
            let place = slot - self.slot(term).start;
            self.shapes[term].get(place.checked_sub(form.scales())?)
        });
        let step = match (form.map(|form| form.step), shape) {
            (Some(Step::Tick), Some(shape)) => {
                let tick = self
                    .rows
                    .trajectories
                    .iter()
                    .fold(0.0, |most: f64, each| most.max(each.tick));
                let beside = |time: f64| time.clamp(shape.low, shape.high).ln();
                return [beside(at.exp() - tick), beside(at.exp() + tick)];
            }
            (Some(Step::Part(part)), _) => part,
            _ => STEP,
        };
        let toward = match shape {
            Some(shape) if 2.0 * at > (shape.low * shape.high).ln() => -1.0,
            None if at > 0.0 => -1.0,
            _ => 1.0,
        };
        [at, at + toward * step]
    }

    /// c·|v|^α·ln |v|·sgn v at the rows of a node.
    fn exponent_slope(&self, columns: &Columns, linear: &[f64], node: usize) -> Vec<f64> {
        let motion = self.motion(columns);
        let damping = linear[3 * node + 2];
        (0..self.rows.len())
            .map(|index| {
                if motion.node[index] == node {
                    damping * columns.law.by_exponent[index]
                } else {
                    0.0
                }
            })
            .collect()
    }

    /// The forces of another term with each size 1 at every row. Empty if the crate refuses the shapes, which can happen at the end
    /// of their range at some tick.
    pub fn unit_forces(&self, form: Form, shapes: &[f64], columns: &Columns) -> Vec<Arc<Vec<f64>>> {
        self.forces(form, shapes, &columns.moved, true)
            .unwrap_or_default()
    }

    /// The inputs of eq 13 at every row.
    pub fn motion<'c>(&'c self, columns: &'c Columns) -> &'c RowMotion {
        self.motion_of(&columns.moved)
    }

    fn motion_of<'c>(&'c self, moved: &'c Option<Arc<Moved>>) -> &'c RowMotion {
        moved
            .as_ref()
            .and_then(|moved| moved.rows.as_ref())
            .unwrap_or(&self.rows.motion)
    }

    fn moved(&self, at: &[f64]) -> Option<Moved> {
        let moves: Vec<(Form, f64)> = (0..self.terms.len())
            .filter(|&term| self.terms[term].form.entry == Entry::Moves)
            .map(|term| (self.terms[term].form, self.shapes(at, term)[0]))
            .collect();
        if moves.is_empty() {
            return None;
        }
        let stays = moves.iter().all(|(form, _)| form.shows.is_some());
        let rows = (!stays).then(|| {
            let each = 0..self.rows.trajectories.len();
            let trajectories: Vec<Trajectory> =
                each.map(|which| self.motion_by(&moves, which).0).collect();
            self.rows.motion_in(&trajectories)
        });
        Some(Moved { by: moves, rows })
    }

    /// The readings of the channels at the rows, for a force known at every sample of every trajectory.
    fn shown(&self, moved: &Option<Arc<Moved>>, mut force: Vec<Vec<f64>>) -> Vec<f64> {
        let by = moved.iter().flat_map(|moved| &moved.by);
        let shows = by.filter_map(|&(form, shape)| Some((form.shows?, shape)));
        for (shows, shape) in shows {
            let each = force.iter_mut().zip(self.rows.trajectories);
            each.for_each(|(force, trajectory)| shows(force, shape, trajectory.tick));
        }
        self.rows.shown(force)
    }

    /// The motion of a trajectory after these changes, and the delay of the force in ticks.
    fn motion_by(&self, moves: &[(Form, f64)], which: usize) -> (Trajectory, usize) {
        let deflection = self.deflections.as_ref().map(|each| &each[which]);
        moved(&self.rows.trajectories[which], moves, deflection)
    }

    fn law(&self, at: &[f64], moved: &Option<Arc<Moved>>) -> LawColumns {
        let mut by = moved.iter().flat_map(|moved| &moved.by);
        if !self.rows.are_averaged() && by.all(|(form, _)| form.shows.is_none()) {
            return self.law_of(at, self.motion_of(moved));
        }
        // The coefficients for a row's amplitude apply to everything that its channel still shows: where one amplitude follows
        // another, a force that continued there would contain both. The rows are computed in parts: the inputs of eq 13 at every
        // sample would take more memory than the recordings.
        let mut columns: [Vec<Vec<f64>>; 4] = Default::default();
        for (which, recorded) in self.rows.trajectories.iter().enumerate() {
            let through = moved.as_ref().filter(|moved| moved.rows.is_some());
            let through = through.map(|moved| self.motion_by(&moved.by, which).0);
            let motion = through.as_ref().unwrap_or(recorded);
            let mut own = [(); 4].map(|()| Vec::with_capacity(motion.len()));
            for start in (0..motion.len()).step_by(PART) {
                let samples = start..(start + PART).min(motion.len());
                let part = self.law_of(at, &self.rows.motion_at(motion, samples));
                for ([y, y3, damping], slope) in part.unit.into_iter().zip(part.by_exponent) {
                    let values = [y, y3, damping, slope];
                    own.iter_mut()
                        .zip(values)
                        .for_each(|(own, value)| own.push(value));
                }
            }
            for (column, own) in columns.iter_mut().zip(own) {
                column.push(own);
            }
        }
        let [y, y3, damping, by_exponent] = columns.map(|column| self.shown(moved, column));
        LawColumns {
            unit: (0..self.rows.len())
                .map(|row| [y[row], y3[row], damping[row]])
                .collect(),
            by_exponent,
        }
    }

    /// At each instant of `motion`.
    fn law_of(&self, at: &[f64], motion: &RowMotion) -> LawColumns {
        let scaling: Vec<(&Term, Vec<f64>, Vec<f64>)> = (0..self.terms.len())
            .filter(|&term| matches!(self.terms[term].form.entry, Entry::Scales(_)))
            .map(|term| {
                let sizes = self.scales(at, term);
                (&self.terms[term], sizes, self.shapes(at, term))
            })
            .collect();
        let alphas: Vec<f64> = (0..self.rows.nodes.len())
            .map(|node| self.alpha(at, node))
            .collect();
        let has = self.rows.law.has();
        let unit: Vec<[f64; 3]> = (0..motion.displacement.len())
            .map(|index| {
                let y = motion.displacement[index];
                let [elastic, damping] =
                    scaling
                        .iter()
                        .fold([1.0; 2], |[elastic, damping], (term, sizes, shapes)| {
                            let moment = Moment {
                                displacement: y,
                                direction: motion.direction[index],
                                cycles: motion.cycles[index],
                                temperature: motion.temperature[index],
                                reference: term.reference,
                            };
                            let [more_elastic, more_damping] =
                                (term.form.gains)(sizes, shapes, &moment);
                            [elastic + more_elastic, damping + more_damping]
                        });
                let speed = (alphas[motion.node[index]] * motion.log_speed[index]).exp();
                let all = [
                    elastic * y,
                    elastic * y * y * y,
                    damping * motion.direction[index] * speed,
                ];
                // A term that is not in the law has no column: its coefficient stays 0.
                std::array::from_fn(|slot| if has[slot] { all[slot] } else { 0.0 })
            })
            .collect();
        let given = self.rows.law.exponent();
        let damping = unit.iter().zip(&motion.log_speed);
        LawColumns {
            by_exponent: damping
                .map(|(row, log_speed)| match given {
                    Some(_) => 0.0,
                    None => row[2] * log_speed,
                })
                .collect(),
            unit,
        }
    }

    /// `is_start`: other fits may start from these shapes too.
    fn added(
        &self,
        at: &[f64],
        term: usize,
        moved: &Option<Arc<Moved>>,
        is_start: bool,
    ) -> Vec<Arc<Vec<f64>>> {
        let count = self.terms[term].fitted_sizes();
        if count == 0 {
            return Vec::new();
        }
        let shapes = self.shapes(at, term);
        self.forces(self.terms[term].form, &shapes, moved, is_start)
            .unwrap_or_else(|| {
                let none = Arc::new(vec![0.0; self.rows.len()]);
                vec![none; count]
            })
    }

    fn forces(
        &self,
        form: Form,
        shapes: &[f64],
        moved: &Option<Arc<Moved>>,
        is_start: bool,
    ) -> UnitForces {
        // The channel shows more than a row's sample, a clock stands behind the force, or the motion is another.
        let needs_all = self.rows.are_averaged() || form.follows_clock || moved.is_some();
        let work = || {
            let mut columns: Vec<Vec<Vec<f64>>> = Vec::new();
            for (which, recorded) in self.rows.trajectories.iter().enumerate() {
                let through = moved.as_ref().filter(|moved| moved.rows.is_some());
                let through = through.map(|moved| self.motion_by(&moved.by, which));
                let (motion, late) = match &through {
                    Some((moved, late)) => (moved, *late),
                    None => (recorded, 0),
                };
                let all = needs_all.then(|| Stride::each(motion.len()));
                let strides = all.as_ref().unwrap_or(&self.rows.strides[which]);
                let path = Path { motion, strides };
                let mut forces = (form.unit_forces)(shapes, &path).ok()?;
                if form.follows_clock && late > 0 {
                    // It follows the clock, not the motion, which is already delayed.
                    let on_time = forces.iter().map(|force| delayed(force, late));
                    forces = on_time.collect();
                }
                columns.resize(forces.len(), Vec::new());
                for (column, force) in columns.iter_mut().zip(forces) {
                    column.push(force);
                }
            }
            let columns = columns.into_iter();
            Some(
                columns
                    .map(|column| Arc::new(self.shown(moved, column)))
                    .collect(),
            )
        };
        if moved.is_none() && is_start {
            self.rows.known_forces.of(form, shapes, work)
        } else {
            work()
        }
    }
}

impl Columns {
    /// y, y³ and |v|^α·sgn v at every row.
    pub fn law(&self) -> &[[f64; 3]] {
        &self.law.unit
    }

    /// The derivative of the last by α.
    pub fn by_exponent(&self) -> &[f64] {
        &self.law.by_exponent
    }

    /// The added columns, term by term.
    pub fn added(&self) -> Vec<&[f64]> {
        self.added
            .iter()
            .flatten()
            .map(|column| column.as_slice())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base_law::BaseLaw;
    use crate::families::{offset, periodic, stop};

    /// A preload, a tone and a wall that contribute almost nothing.
    #[test]
    fn what_adds_nothing_is_known() {
        let moved = |index| 0.1 * (0.02 * f64::from(index)).sin();
        let displacement: Vec<f64> = (0..3000).map(moved).collect();
        let force = displacement.clone();
        let trajectories = [Trajectory::new(
            "sine",
            1e-3,
            &displacement,
            force,
            None,
            None,
        )];
        let rows = Rows::gather(&trajectories, BaseLaw::Mixed, vec![0.1], 1000, |_, _| true);
        let extent = Extent::of(&trajectories);
        // The tone has two sizes: of its sine and of its cosine.
        let forms = [offset::FORMS[0], periodic::FORMS[0], stop::FORMS[0]];
        let terms = forms.map(|form| Term::sought(form, 0.0));
        let basis = Basis::new(&rows, &extent, &terms);
        let columns = basis.columns(&[0.5, 5.0_f64.ln(), 0.05_f64.ln()], None);
        // The law's largest force is 0.1 kN, and the wall's deepest contact 0.05 mm.
        let adds_nothing = |preload: f64, tone: [f64; 2], stiffness: f64| {
            let sizes = [1.0, 0.0, 0.0, preload, tone[0], tone[1], stiffness];
            basis.adds_nothing(&columns, &sizes, 1e-7)
        };
        assert_eq!(adds_nothing(1e-3, [0.0; 2], 1.0), [false, true, false]);
        assert_eq!(
            adds_nothing(0.9e-8, [0.0, 1e-3], 1.7e-7),
            [true, false, true]
        );
        assert_eq!(adds_nothing(-1.1e-8, [-1e-3, 0.0], 2.3e-7), [false; 3]);
    }
}
