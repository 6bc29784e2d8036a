//! A force that is early, as behind a displacement sensor that is late or filtered.
//!
//! Under small shifts a dashpot and a mass make a force look in time, so that no passive damper contradicts an early force until its effects
//! are known. Here the effects that were found are fitted again with the force at several times. The time at which they leave least is that
//! of the force.

use std::collections::BTreeMap;
use std::sync::Arc;

use mesh_damper_model::AddedEffect;
use mesh_damper_recording::faults::{Shift, ShiftPolicy};
use mesh_damper_recording::motion::MotionEstimate;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_recording::trajectory::strides::{Stride, strides};

use super::closing::Closed;
use super::sought::Sought;
use super::split::Role;
use crate::families::{delay, inertia, viscous};
use crate::known_terms::{KnownTerm, known_terms};
use crate::problem::Problem;
use crate::rows::{Purpose, Rows};
use crate::shape::Extent;
use crate::term::Term;

mesh_damper_recording::numbers! {
    /// A force that is early although a damper could have it.
    EarlyPolicy {
        /// The force is early by at most this fraction of the shortest period.
        reach: f64 = 0.15, Convention("beyond it the specimen would seem to lose all of its energy");
        /// The effects are fitted at about this many times within that, and then at ticks beside the best.
        steps: usize = 10, Convention("the time is then sought between the ticks beside the best");
        /// The time is known to this fraction of a tick.
        within: f64 = 0.05, Convention("below what a model measures of it later");
    }
}

/// The delay of the force in s, below 0, with which the effects of `closed` leave clearly less of `fitted`. `None` if it is not early, or if
/// the recordings have a single frequency, where a time is a phase.
pub(super) fn found(fitted: &[Trajectory], closed: &Closed, sought: &Sought) -> Option<f64> {
    let steady = fitted.iter().flat_map(|one| &one.blocks);
    let steady = steady.filter(|block| block.cycles.len() >= ShiftPolicy::in_use().steady);
    let (lowest, highest) = steady.fold((f64::INFINITY, 0.0_f64), |(low, high), block| {
        (low.min(block.frequency), high.max(block.frequency))
    });
    if highest <= ShiftPolicy::in_use().several * lowest {
        return None;
    }
    let effects = closed.model.effects.iter();
    let mut found = Vec::new();
    for effect in effects {
        if effect.family == delay::FORMS[0].family() {
            return None;
        }
        if !stands_for_it(effect) {
            found.extend(known_terms(effect)?);
        }
    }
    found.retain(|term| {
        sought
            .known
            .iter()
            .all(|known| known.term.form != term.term.form)
    });
    let known = sought.known.iter().cloned();
    let all: Vec<_> = known.chain(found).collect();
    let EarlyPolicy {
        reach,
        steps,
        within,
    } = *EarlyPolicy::in_use();
    let tick = fitted.first()?.tick;
    let is_open = |which: usize, sample: usize| closed.forces[which].roles[sample] != Role::HeldOut;
    let strides = Arc::new(strides(fitted, Purpose::InTurn.rows(), is_open));
    let left_at = |ticks: f64| left_at(fitted, &strides, is_open, sought, &all, ticks);
    let left = |ticks: usize| left_at(ticks as f64);
    let most = ((reach / (highest * tick)) as usize).max(2);
    let mut stride = most.div_ceil(steps);
    let mut known: BTreeMap<usize, f64> = BTreeMap::new();
    for ticks in (0..=most).step_by(stride) {
        known.insert(ticks, left(ticks));
    }
    let least_of = |known: &BTreeMap<usize, f64>| -> Option<usize> {
        let least = known.iter().min_by(|a, b| a.1.total_cmp(b.1));
        least.map(|(ticks, _)| *ticks)
    };
    let mut best = least_of(&known)?;
    while best > 0
        && best < most
        && !(known.contains_key(&(best - 1)) && known.contains_key(&(best + 1)))
    {
        stride = stride.div_ceil(2);
        for ticks in [best.saturating_sub(stride), best + stride] {
            known.entry(ticks).or_insert_with(|| left(ticks));
        }
        best = least_of(&known)?;
    }
    let better = ShiftPolicy::in_use().better;
    if best == 0 || best >= most || known[&best] >= better * better * known[&0] {
        return None;
    }
    // The law's damping can stand for a part of an early force and for none of a late one, so that what is left is no parabola.
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (best as f64 - 1.0, best as f64 + 1.0);
    let inner = |low: f64, high: f64| [high - golden * (high - low), low + golden * (high - low)];
    let [mut a, mut b] = inner(low, high).map(|ticks| (ticks, left_at(ticks)));
    while high - low > within {
        if a.1 < b.1 {
            (high, b) = (b.0, a);
            let ticks = inner(low, high)[0];
            a = (ticks, left_at(ticks));
        } else {
            (low, a) = (a.0, b);
            let ticks = inner(low, high)[1];
            b = (ticks, left_at(ticks));
        }
    }
    Some(-tick * 0.5 * (low + high))
}

/// Whether an effect may stand for an early force: of F(t + τ) ≈ F + τ·dF/dt a spring makes a dashpot, and a dashpot a mass.
pub(super) fn stands_for_it(effect: &AddedEffect) -> bool {
    [inertia::FORMS[0].family(), viscous::FORMS[0].family()].contains(&effect.family)
}

/// Sum of the squared errors of a fit of these terms with the force moved on by `ticks`. It moves by whole ticks, and the motion by the
/// rest: between ticks the interpolated force has less noise, and the motion has none to lose.
fn left_at(
    fitted: &[Trajectory],
    strides: &Arc<Vec<Vec<Stride>>>,
    is_open: impl Fn(usize, usize) -> bool,
    sought: &Sought,
    known: &[KnownTerm],
    ticks: f64,
) -> f64 {
    let whole = ticks.round();
    let moved = fitted.iter().map(|one| Trajectory {
        force: Shift { late: -whole }.undone(&one.force),
        motion: later(&one.motion, (ticks - whole) * one.tick, one.tick),
        ..one.clone()
    });
    let moved: Vec<Trajectory> = moved.collect();
    let purpose = Purpose::InTurn;
    let rows = Rows::along(strides, &moved, sought.law, vec![0.0], purpose, is_open);
    let extent = Extent::of(&moved);
    let mut terms: Vec<Term> = Vec::new();
    let mut law = Problem::new(&rows, &extent, &terms).solve();
    for known in known {
        terms.push(known.term);
        law = Problem::new(&rows, &extent, &terms).solve_from(&law, &known.shapes);
    }
    law.squares
}

/// The motion `by` s later, at most half a tick.
fn later(motion: &MotionEstimate, by: f64, tick: f64) -> MotionEstimate {
    let mut moved = motion.clone();
    let last = motion.acceleration.len() - 1;
    for index in 0..=last {
        let (y, v, a) = (
            motion.displacement[index],
            motion.velocity[index],
            motion.acceleration[index],
        );
        let (before, after) = (index.saturating_sub(1), (index + 1).min(last));
        let jerk = (motion.acceleration[after] - motion.acceleration[before]) / (2.0 * tick);
        moved.displacement[index] = y + by * (v + 0.5 * by * a);
        moved.velocity[index] = v + by * (a + 0.5 * by * jerk);
        moved.acceleration[index] = a + by * jerk;
    }
    moved
}
