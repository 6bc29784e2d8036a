//! Equivalent stiffness and static loss factor of load–unload cycles, eqs 1 and 2.
//!
//! Each cycle is measured from the start of its loading. The displacement there and the force of the middle line, a preload or a
//! sensor's zero, are subtracted first. The middle line is the mean of the branches at equal displacement, so the number of samples
//! in each branch does not matter. An unloading that ends above the starting displacement has left a residual set; over it, the
//! force is that of the preload.

use std::ops::Range;

use mesh_damper_output::error::{InputError, Place};
use mesh_damper_recording::Recording;
use mesh_damper_reference::static_test::{self, StaticResult};
use serde::Serialize;

use super::branches::{Curve, Cycle};
use super::{Spread, spread};

/// A straight line through a branch between these fractions of x_max gives its force at the start. The turning sample itself may be
/// anywhere in the jump that friction makes there.
const EDGE: (f64, f64) = (0.005, 0.035);
/// Fewest samples for that line.
const EDGE_SAMPLES: usize = 3;
/// Points of the middle line.
const LINE_POINTS: usize = 101;

/// One load–unload cycle.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StaticCycle {
    /// Start of the loading, turning point and end of the unloading, s.
    pub times: [f64; 3],
    /// Displacement at the start of the loading, mm; compression is positive.
    pub start: f64,
    /// Force of the middle line at the start, kN.
    pub preload: f64,
    /// Largest displacement x_max, relative to the start, mm.
    pub displacement_max: f64,
    /// Largest force, relative to the preload, kN.
    pub force_max: f64,
    /// Elastic potential U, J.
    pub elastic_potential: f64,
    /// Dissipated energy ΔW, J.
    pub dissipated: f64,
    /// Equivalent stiffness k_eq, eq 1, kN/mm.
    pub equivalent_stiffness: f64,
    /// Static loss factor η_s, eq 2.
    pub loss_factor: f64,
    /// Force over displacement, both relative to the start, kN and mm: loading, then unloading.
    #[serde(skip)]
    pub curve: Vec<(f64, f64)>,
    /// The middle line, in the same form.
    #[serde(skip)]
    pub middle: Vec<(f64, f64)>,
}

/// A quasistatic recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StaticTest {
    /// The whole cycles in order.
    pub cycles: Vec<StaticCycle>,
    /// Equivalent stiffness k_eq of the cycles, kN/mm.
    pub equivalent_stiffness: Spread,
    /// Static loss factor η_s of the cycles.
    pub loss_factor: Spread,
    /// Corrections to the recording, and its peculiarities.
    pub notes: Vec<String>,
}

/// Eqs 1 and 2 for every whole load–unload cycle of a recording.
///
/// # Errors
/// The recording has no such cycle.
pub fn static_test(recording: &Recording) -> Result<StaticTest, InputError> {
    let curve = Curve::new(&recording.displacement, &recording.force);
    let found = curve.cycles();
    let whole: Vec<&Cycle> = found.iter().filter(|cycle| cycle.is_whole).collect();
    let cycles: Vec<StaticCycle> = whole
        .iter()
        .filter_map(|cycle| StaticCycle::of(&curve, cycle, &recording.time))
        .collect();
    let refused = |problem: &str, remedy: &str| {
        InputError::new(&recording.name, problem, remedy).at(Place::Column("displacement".into()))
    };
    if found.is_empty() {
        return Err(refused(
            "there is no load–unload cycle: the displacement does not go there and back",
            "record loading and unloading of the same specimen",
        ));
    }
    if whole.is_empty() {
        return Err(refused(
            "no load–unload cycle is whole: it begins or ends in the middle",
            "record from before a loading to after its unloading",
        ));
    }
    if cycles.is_empty() {
        return Err(refused(
            "no cycle has an elastic potential: its middle line has no area above the force at its start",
            "check the signs of force and displacement",
        ));
    }
    let mut notes: Vec<String> = recording.faults().iter().map(ToString::to_string).collect();
    for (turned, channel) in [(curve.turned.0, "displacement"), (curve.turned.1, "force")] {
        if turned {
            notes.push(format!(
                "{channel}: compression was recorded as negative, and is turned"
            ));
        }
    }
    let cut = found.len() - whole.len();
    if cut > 0 {
        notes.push(format!(
            "cycles that the recording cuts off, left out: {cut}"
        ));
    }
    if whole.len() > cycles.len() {
        let dropped = whole.len() - cycles.len();
        notes.push(format!(
            "cycles without elastic potential, left out: {dropped}"
        ));
    }
    if cycles.iter().any(|cycle| cycle.dissipated < 0.0) {
        notes.push(
            "the unloading lies above the loading, as of a specimen that gives energy: check the order of time and signs"
                .into(),
        );
    }
    let stiffness: Vec<f64> = cycles.iter().map(|c| c.equivalent_stiffness).collect();
    let loss: Vec<f64> = cycles.iter().map(|c| c.loss_factor).collect();
    Ok(StaticTest {
        equivalent_stiffness: spread(&stiffness),
        loss_factor: spread(&loss),
        cycles,
        notes,
    })
}

impl StaticCycle {
    /// `None` if there is no elastic potential.
    fn of(curve: &Curve, cycle: &Cycle, time: &[f64]) -> Option<Self> {
        let (first, last) = (cycle.samples.start, cycle.samples.end - 1);
        let start = curve.displacement[first];
        let travelled = |i: usize| (curve.displacement[i] - start, curve.force[i]);
        let turn = travelled(cycle.peak).0;
        let edge = |samples: Range<usize>, outer: usize| {
            force_at_start(samples.map(travelled), turn).unwrap_or(curve.force[outer])
        };
        let preload = 0.5 * (edge(first..cycle.peak, first) + edge(cycle.peak..last + 1, last));
        let point = |i: usize| {
            let (x, f) = travelled(i);
            (x, f - preload)
        };
        let loading = (first..=cycle.peak).map(point);
        let unloading: Vec<(f64, f64)> = (cycle.peak..=last).map(point).collect();
        let points: Vec<(f64, f64)> = loading
            .chain(down_to_zero(&unloading).into_iter().skip(1))
            .collect();
        let (x, f): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        let StaticResult {
            elastic_potential,
            dissipated,
            equivalent_stiffness,
            loss_factor,
        } = static_test::characterize(&x, &f)?;
        let peak = cycle.peak - first;
        Some(Self {
            times: [first, cycle.peak, last].map(|index| time[index]),
            start,
            preload,
            displacement_max: turn,
            force_max: f.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            elastic_potential,
            dissipated,
            equivalent_stiffness,
            loss_factor,
            middle: middle_line(&points[..=peak], &points[peak..]),
            curve: points,
        })
    }
}

/// The force at displacement 0 of the straight line through a branch's points in [`EDGE`].
fn force_at_start(branch: impl Iterator<Item = (f64, f64)>, turn: f64) -> Option<f64> {
    let points: Vec<(f64, f64)> = branch
        .filter(|(x, _)| (EDGE.0 * turn..=EDGE.1 * turn).contains(x))
        .collect();
    if points.len() < EDGE_SAMPLES {
        return None;
    }
    let count = points.len() as f64;
    let mean_x = points.iter().map(|point| point.0).sum::<f64>() / count;
    let mean_f = points.iter().map(|point| point.1).sum::<f64>() / count;
    let square: f64 = points.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
    let product: f64 = points
        .iter()
        .map(|(x, f)| (x - mean_x) * (f - mean_f))
        .sum();
    (square > 0.0).then(|| mean_f - mean_x * product / square)
}

/// The part of an unloading at displacements of 0 and more, with the last point interpolated.
fn down_to_zero(unloading: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let Some(below) = unloading.iter().position(|&(x, _)| x < 0.0) else {
        return unloading.to_vec();
    };
    let ((x0, f0), (x1, f1)) = (unloading[below - 1], unloading[below]);
    let at_zero = f0 + (f1 - f0) * x0 / (x0 - x1);
    let kept = unloading[..below].iter().copied();
    kept.chain([(0.0, at_zero)]).collect()
}

/// The mean of both branches at equal displacements from 0 to the turning point.
fn middle_line(loading: &[(f64, f64)], unloading: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let turn = loading.last().map_or(0.0, |point| point.0);
    (0..LINE_POINTS)
        .map(|i| {
            let x = turn * i as f64 / (LINE_POINTS - 1) as f64;
            let up = at(loading.iter().copied(), x);
            let down = at(unloading.iter().rev().copied(), x);
            (x, 0.5 * (up + down))
        })
        .collect()
}

/// The force of a branch, in order of rising displacement, where it first reaches `x`; 0 below its beginning.
fn at(branch: impl Iterator<Item = (f64, f64)>, x: f64) -> f64 {
    let mut before: Option<(f64, f64)> = None;
    for (x1, f1) in branch {
        if x1 >= x {
            return match before {
                Some((x0, f0)) => f0 + (f1 - f0) * (x - x0) / (x1 - x0),
                None if x1 > x => 0.0,
                None => f1,
            };
        }
        before = Some((x1, f1));
    }
    before.map_or(0.0, |point| point.1)
}
