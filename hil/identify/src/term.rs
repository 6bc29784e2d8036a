//! How each effect enters a fit: what is linear in it, what is not, and where the search starts.

use std::collections::BTreeMap;

use mesh_damper::effects::{
    Asymmetry, BoucWen, ConfinedMotion, Drift, EffectForce, Hardening, Inertia, LawForce,
    MAX_BRANCHES, MAX_STICK_SLIP_ELEMENTS, MAX_TONES, Offset, Periodic, Relaxation, StickSlip,
    Stop, Viscous,
};
use mesh_damper::error::ConfigError;
use mesh_damper::limits;
use mesh_damper_model::{AddedEffect, Family};

use super::shape::Extent;

/// The forms in which effects are fitted. Most families have one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Form {
    /// A constant force.
    Offset,
    /// Even stiffness.
    Asymmetry,
    /// Odd stiffness above the cubic.
    Hardening,
    /// A linear dashpot.
    Viscous,
    /// A moving mass.
    Inertia,
    /// A contact on the side of positive displacement.
    StopAbove,
    /// A contact on the side of negative displacement.
    StopBelow,
    /// Stick-slip as one Jenkins element.
    Jenkins,
    /// Stick-slip as Jenkins elements with evenly spread slip limits (Iwan 1966).
    Iwan,
    /// Stick-slip as Bouc and Wen have it.
    BoucWen,
    /// A Maxwell branch.
    Relaxation,
    /// A stiffness that settles with the cycles.
    Drift,
    /// An elastic force and a damping force that settle with the cycles, each in its own way.
    DriftOfEach,
    /// A force that scales with temperature.
    Temperature,
    /// An elastic force and a damping force that scale with temperature, each in its own way.
    TemperatureOfEach,
    /// A tone.
    Periodic,
    /// A dead zone in which nothing is moved.
    Gap,
    /// A dead zone in which only friction works.
    DampedGap,
    /// A force recorded late.
    Delay,
    /// A spring in series.
    Compliance,
}

/// How the force depends on a form's parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// It adds so many forces, each proportional to a size.
    Adds(usize),
    /// It scales eq 13, or with two sizes its elastic and its damping force.
    Scales(usize),
    /// It changes the motion that all else is given.
    Moves,
}

impl Form {
    /// Every form, the simplest first.
    pub const ALL: [Self; 20] = [
        Self::Offset,
        Self::Asymmetry,
        Self::Hardening,
        Self::Viscous,
        Self::Inertia,
        Self::StopAbove,
        Self::StopBelow,
        Self::Jenkins,
        Self::Relaxation,
        Self::Drift,
        Self::DriftOfEach,
        Self::Temperature,
        Self::TemperatureOfEach,
        Self::Delay,
        Self::Gap,
        Self::DampedGap,
        Self::Compliance,
        Self::Periodic,
        Self::BoucWen,
        Self::Iwan,
    ];

    /// The family it is of.
    pub fn family(self) -> Family {
        match self {
            Self::Offset => Family::Offset,
            Self::Asymmetry => Family::Asymmetry,
            Self::Hardening => Family::Hardening,
            Self::Viscous => Family::Viscous,
            Self::Inertia => Family::Inertia,
            Self::StopAbove | Self::StopBelow => Family::Stop,
            Self::Jenkins | Self::Iwan | Self::BoucWen => Family::StickSlip,
            Self::Relaxation => Family::Relaxation,
            Self::Drift | Self::DriftOfEach => Family::Drift,
            Self::Temperature | Self::TemperatureOfEach => Family::Temperature,
            Self::Periodic => Family::Periodic,
            Self::Gap | Self::DampedGap => Family::Gap,
            Self::Delay => Family::Delay,
            Self::Compliance => Family::Compliance,
        }
    }

    /// How the force depends on its parameters.
    pub fn entry(self) -> Entry {
        match self {
            Self::Temperature => Entry::Scales(1),
            Self::TemperatureOfEach | Self::DriftOfEach => Entry::Scales(2),
            Self::Gap | Self::DampedGap | Self::Delay | Self::Compliance => Entry::Moves,
            // A sine and a cosine.
            Self::Periodic => Entry::Adds(2),
            Self::Iwan => Entry::Adds(MAX_STICK_SLIP_ELEMENTS),
            _ => Entry::Adds(1),
        }
    }

    /// The names of its shapes: positive numbers that are searched on a logarithmic scale.
    pub fn shape_names(self) -> &'static [&'static str] {
        match self {
            Self::StopAbove | Self::StopBelow => &["gap"],
            Self::Jenkins | Self::Iwan => &["slip_limit"],
            Self::BoucWen => &["slip_limit", "sharpness"],
            Self::Relaxation | Self::Delay => &["time"],
            Self::Drift | Self::DriftOfEach => &["cycles"],
            Self::Periodic => &["frequency"],
            Self::Gap | Self::DampedGap => &["half_width"],
            Self::Compliance => &["stiffness"],
            _ => &[],
        }
    }

    /// Whether a negative size would be a source of energy, or a mass or a wall that pulls.
    pub fn size_is_positive(self) -> bool {
        matches!(
            self,
            Self::Viscous
                | Self::Inertia
                | Self::StopAbove
                | Self::StopBelow
                | Self::Jenkins
                | Self::Iwan
                | Self::BoucWen
                | Self::Relaxation
        )
    }

    /// How many terms of this form one model may have.
    pub fn most(self) -> usize {
        match self {
            Self::Jenkins => MAX_STICK_SLIP_ELEMENTS,
            Self::Relaxation => MAX_BRANCHES,
            Self::Periodic => MAX_TONES,
            _ => 1,
        }
    }

    /// Whether both may stand in one model.
    pub fn excludes(self, other: Self) -> bool {
        let gap = |form: Self| matches!(form, Self::Gap | Self::DampedGap);
        let slider = |form: Self| matches!(form, Self::Jenkins | Self::Iwan | Self::BoucWen);
        let warm = |form: Self| form.family() == Family::Temperature;
        let drift = |form: Self| form.family() == Family::Drift;
        let alike = |of: fn(Self) -> bool| of(self) && of(other);
        self != other && (alike(gap) || alike(slider) || alike(warm) || alike(drift))
    }

    /// How many parameters of it are searched.
    pub(super) fn searched(self) -> usize {
        self.scales() + self.shape_names().len()
    }

    /// How many of these are sizes, which come before the shapes.
    pub(super) fn scales(self) -> usize {
        match self.entry() {
            Entry::Scales(count) => count,
            _ => 0,
        }
    }

    /// Least and largest size that scales eq 13: as far as the crate takes them.
    pub(super) fn scale_range(self) -> [f64; 2] {
        match self {
            Self::DriftOfEach => [-1.0, limits::CHANGE],
            _ => [-1.0, 1.0],
        }
    }

    /// The forces in kN of the effect with each size 1 and these shapes at every sample of `motions`, `tick` s apart.
    ///
    /// # Errors
    /// A shape that the crate refuses.
    pub(super) fn unit_forces(
        self,
        shapes: &[f64],
        motions: &[ConfinedMotion<f64>],
        tick: f64,
    ) -> Result<Vec<Vec<f64>>, ConfigError> {
        let shape = |index: usize| shapes.get(index).copied().unwrap_or_default();
        let force = match self {
            Self::Offset => run(&Offset::new(1.0)?, motions),
            Self::Asymmetry => run(&Asymmetry::new(1.0)?, motions),
            Self::Hardening => run(&Hardening::new(1.0)?, motions),
            Self::Viscous => run(&Viscous::new(1.0)?, motions),
            Self::Inertia => run(&Inertia::new(1.0)?, motions),
            Self::StopAbove => run(&Stop::new(&[(1.0, shape(0))])?, motions),
            Self::StopBelow => run(&Stop::new(&[(1.0, -shape(0))])?, motions),
            Self::Jenkins => run(&StickSlip::new(&[(1.0, shape(0))])?, motions),
            Self::Iwan => {
                return iwan_limits(shape(0))
                    .map(|limit| Ok(run(&StickSlip::new(&[(1.0, limit)])?, motions)))
                    .collect();
            }
            Self::BoucWen => run(&BoucWen::new(1.0, shape(0), shape(1))?, motions),
            Self::Relaxation => run(&Relaxation::new(&[(1.0, shape(0))], tick)?, motions),
            Self::Drift => run(&Drift::new(1.0, shape(0))?, motions),
            Self::Periodic => {
                let tone = |phase| {
                    let tone = Periodic::new(&[(1.0, shape(0), phase)], tick)?;
                    Ok(run(&tone, motions))
                };
                return Ok(vec![tone(0.0)?, tone(0.25 * std::f64::consts::TAU)?]);
            }
            Self::Temperature
            | Self::TemperatureOfEach
            | Self::DriftOfEach
            | Self::Gap
            | Self::DampedGap
            | Self::Delay
            | Self::Compliance => return Ok(Vec::new()),
        };
        Ok(vec![force])
    }
}

/// The slip limits of an Iwan model's elements, evenly spread up to `largest`.
fn iwan_limits(largest: f64) -> impl Iterator<Item = f64> {
    let count = MAX_STICK_SLIP_ELEMENTS;
    (1..=count).map(move |i| largest * i as f64 / count as f64)
}

fn run<E: EffectForce<f64>>(effect: &E, motions: &[ConfinedMotion<f64>]) -> Vec<f64> {
    let Some(first) = motions.first() else {
        return Vec::new();
    };
    let mut state = effect.begin(first);
    motions
        .iter()
        .map(|motion| effect.force(&mut state, motion, LawForce::default()))
        .collect()
}

/// One added effect in a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// Which effect, in which form.
    pub form: Form,
    /// The temperature at which the law holds, °C; used by temperature only.
    pub reference: f64,
}

impl Term {
    /// What the size of a term that scales eq 13 is multiplied by after `cycles` at `temperature` °C.
    pub(super) fn scale(&self, shapes: &[f64], cycles: f64, temperature: f64) -> f64 {
        match self.form {
            Form::DriftOfEach => -(-cycles / shapes[0]).exp_m1(),
            _ => self.reference - temperature,
        }
    }
}

/// A term's parameters after a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct TermValue {
    /// The term.
    pub term: Term,
    /// What its forces are proportional to; for temperature β, and β_damping where it is another; of a drift of each force
    /// their changes.
    pub sizes: Vec<f64>,
    /// Its shapes.
    pub shapes: Vec<f64>,
}

impl TermValue {
    /// Whether no size would be a source of energy, or a mass or a wall that pulls.
    pub fn is_admissible(&self) -> bool {
        let positive = |size: &f64| *size > 0.0;
        match self.term.form {
            // Some of its elements may be missing.
            Form::Iwan => self.sizes.iter().any(positive),
            form => !form.size_is_positive() || self.sizes.iter().all(positive),
        }
    }

    /// Whether a shape stands where the effect can no longer be told from a simpler one.
    pub fn is_degenerate(&self, extent: &Extent) -> bool {
        self.shapes
            .iter()
            .zip(extent.shapes(self.term.form))
            .any(|(&value, shape)| shape.is_limit(value))
    }

    /// The elements that it stands for: one, or of an Iwan model those that are there. Which of its sizes each has is given
    /// with it.
    pub fn elements(&self) -> Vec<(usize, Vec<(&'static str, f64)>)> {
        if self.term.form != Form::Iwan {
            return vec![(0, self.parameters())];
        }
        let largest = self.shapes.first().copied().unwrap_or_default();
        let elements = self.sizes.iter().zip(iwan_limits(largest)).enumerate();
        elements
            .filter(|(_, (size, _))| **size > 0.0)
            .map(|(index, (&size, limit))| {
                (index, vec![("stiffness", size), ("slip_limit", limit)])
            })
            .collect()
    }

    /// The parameters of its only element, by the names of [`mesh_damper_model::parameter_unit`].
    fn parameters(&self) -> Vec<(&'static str, f64)> {
        let form = self.term.form;
        let size = |index: usize| self.sizes.get(index).copied().unwrap_or_default();
        let shape = |index: usize| self.shapes.get(index).copied().unwrap_or_default();
        match form {
            Form::Offset => vec![("force", size(0))],
            Form::Asymmetry => vec![("k2", size(0))],
            Form::Hardening => vec![("k5", size(0))],
            Form::Viscous => vec![("c1", size(0))],
            Form::Inertia => vec![("mass", size(0))],
            Form::StopBelow => vec![("stiffness", size(0)), ("gap", -shape(0))],
            Form::StopAbove => vec![("stiffness", size(0)), ("gap", shape(0))],
            Form::Jenkins | Form::Iwan => {
                vec![("stiffness", size(0)), ("slip_limit", shape(0))]
            }
            Form::BoucWen => vec![
                ("stiffness", size(0)),
                ("slip_limit", shape(0)),
                ("sharpness", shape(1)),
            ],
            Form::Relaxation => vec![("stiffness", size(0)), ("time", shape(0))],
            Form::Drift => vec![("stiffness", size(0)), ("cycles", shape(0))],
            Form::DriftOfEach => vec![
                ("elastic_change", size(0)),
                ("damping_change", size(1)),
                ("cycles", shape(0)),
            ],
            Form::Temperature => vec![("beta", size(0)), ("reference", self.term.reference)],
            Form::TemperatureOfEach => vec![
                ("beta", size(0)),
                ("beta_damping", size(1)),
                ("reference", self.term.reference),
            ],
            // a·sin x + b·cos x = √(a² + b²)·sin(x + φ), tan φ = b/a
            Form::Periodic => vec![
                ("amplitude", size(0).hypot(size(1))),
                ("frequency", shape(0)),
                ("phase", size(1).atan2(size(0))),
            ],
            Form::Gap => vec![("half_width", shape(0)), ("damps_inside", 0.0)],
            Form::DampedGap => vec![("half_width", shape(0)), ("damps_inside", 1.0)],
            Form::Delay => vec![("time", shape(0))],
            Form::Compliance => vec![("stiffness", shape(0))],
        }
    }
}

/// The effects that fitted terms stand for.
pub fn added_effects(values: &[TermValue]) -> Vec<AddedEffect> {
    // What a fit held at 0, because it would have been a source of energy, is not there.
    let there = values.iter().filter(|value| value.is_admissible());
    let parts = there.flat_map(|value| {
        let elements = value.elements().into_iter();
        elements.map(|(_, parameters)| (value.term.form, parameters))
    });
    effects_of(parts.collect())
        .into_iter()
        .map(|(family, parameters)| AddedEffect { family, parameters })
        .collect()
}

/// Effects of elements whose parameters are given as anything: Jenkins elements become the elements of one effect, and so do
/// Maxwell branches, tones and the two contacts.
pub(crate) fn effects_of<T>(
    terms: Vec<(Form, Vec<(&'static str, T)>)>,
) -> Vec<(Family, BTreeMap<String, T>)> {
    let mut effects: Vec<(Form, BTreeMap<String, T>)> = Vec::new();
    for (form, parameters) in terms {
        let form = match form {
            Form::StopBelow => Form::StopAbove,
            Form::Iwan => Form::Jenkins,
            form => form,
        };
        let place = match effects.iter().position(|(known, _)| *known == form) {
            Some(place) => place,
            None => {
                effects.push((form, BTreeMap::new()));
                effects.len() - 1
            }
        };
        let effect = &mut effects[place].1;
        let number = effect.len() / parameters.len() + 1;
        for (name, parameter) in parameters {
            let name = match number {
                1 => name.to_owned(),
                _ => format!("{name}_{number}"),
            };
            effect.insert(name, parameter);
        }
    }
    effects
        .into_iter()
        .map(|(form, parameters)| (form.family(), parameters))
        .collect()
}
