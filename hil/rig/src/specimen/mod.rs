//! True physics of a simulated metal mesh specimen: eq 13 with the table's coefficients, and effects that the law does not contain.
//! It shares no code with the crate's effects, so that tracing them is a real test.

mod branch;
mod draw;
mod hidden;
mod list;
mod series;
mod unlisted;

pub use draw::{DrawnEffect, LARGEST_SHARE, SMALLEST_SHARE, draw, force_share};
pub use hidden::{HiddenEffect, Schedule, SlipShape};
pub use unlisted::Unlisted;

use branch::{Hidden, Step};
use series::{Late, SUBSTEPS, balance};

use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables;

/// Resistance against the actuator.
pub trait DamperForce {
    /// Force in kN that holds the specimen at `displacement` mm, moving at `velocity` mm/s and `acceleration` mm/s², `time` s after
    /// the test began and `dt` s after the previous call.
    ///
    /// Call it in order of time: the state advances with each call.
    fn force(
        &mut self,
        time: f64,
        displacement: f64,
        velocity: f64,
        acceleration: f64,
        dt: f64,
    ) -> f64;

    /// Temperature, °C, after the last call.
    fn temperature(&self) -> f64;

    /// Its control input at the last call, if it has one.
    fn control(&self) -> Option<f64> {
        None
    }
}

/// The column of a control input in a recording: the current of a coil.
pub const CURRENT: &str = "current_A";

/// Temperature for which the coefficients are valid, and temperature of a specimen that is not warmed, °C.
pub const REFERENCE_TEMPERATURE: f64 = 20.0;

/// A metal mesh damper on a simulated rig.
///
/// A compliance is a spring that holds eq 13 with its parallel effects. An external tone, a preload of the load cell and the mass
/// that it carries act on the other side of that spring, and the delay applies to the force channel. The play is between the spring
/// and eq 13 with its parallel effects.
#[derive(Debug)]
pub struct Specimen {
    coefficients: Coefficients,
    effects: Vec<HiddenEffect>,
    /// Between the sensors and the spring.
    outside: Vec<Hidden>,
    /// Parallel to eq 13.
    inside: Vec<Hidden>,
    /// Half width of the play in mm, and whether it is loose.
    gap: Option<(f64, bool)>,
    spring: Option<Spring>,
    late: Option<Late>,
    /// Frequency of the running block in Hz, if known.
    frequency: Option<f64>,
    temperature: f64,
    /// Time of the last call, s.
    time: f64,
}

/// The spring in series, and the last positions of its ends.
#[derive(Clone, Debug)]
struct Spring {
    /// mm/kN.
    compliance: f64,
    /// Displacement of the specimen, mm.
    specimen: f64,
    /// Displacement and velocity of the sensor's end, mm and mm/s.
    sensor: (f64, f64),
    /// Memory for trials.
    trial: Vec<Hidden>,
}

impl Clone for Specimen {
    fn clone(&self) -> Self {
        Self {
            coefficients: self.coefficients,
            effects: self.effects.clone(),
            outside: self.outside.clone(),
            inside: self.inside.clone(),
            gap: self.gap,
            spring: self.spring.clone(),
            late: self.late.clone(),
            frequency: self.frequency,
            temperature: self.temperature,
            time: self.time,
        }
    }

    /// Reuses the memory.
    #[inline]
    fn clone_from(&mut self, source: &Self) {
        self.coefficients = source.coefficients;
        self.effects.clone_from(&source.effects);
        self.outside.clone_from(&source.outside);
        self.inside.clone_from(&source.inside);
        self.gap = source.gap;
        self.spring.clone_from(&source.spring);
        self.late.clone_from(&source.late);
        self.frequency = source.frequency;
        self.temperature = source.temperature;
        self.time = source.time;
    }
}

impl Specimen {
    /// A specimen that follows eq 13 with these coefficients at every amplitude.
    pub fn new(coefficients: Coefficients) -> Self {
        Self {
            coefficients,
            effects: Vec::new(),
            outside: Vec::new(),
            inside: Vec::new(),
            gap: None,
            spring: None,
            late: None,
            frequency: None,
            temperature: REFERENCE_TEMPERATURE,
            time: 0.0,
        }
    }

    /// A specimen with the paper's coefficients at `density` g/cm³, those identified at `amplitude` mm.
    pub fn of_density(density: f64, amplitude: f64) -> Self {
        Self::new(tables::interpolate(density, amplitude))
    }

    /// The same with one more effect. For gap, delay and compliance the last one counts.
    ///
    /// # Panics
    /// If the effect is not [admissible](HiddenEffect::is_admissible).
    pub fn with(mut self, effect: HiddenEffect) -> Self {
        assert!(effect.is_admissible(), "no specimen can have {effect:?}");
        self.effects.push(effect);
        match effect {
            HiddenEffect::Gap { half_width, loose } => self.gap = Some((half_width, loose)),
            HiddenEffect::Delay { time } => self.late = Some(Late::by(time)),
            HiddenEffect::Compliance { compliance } => {
                self.spring = Some(Spring {
                    compliance,
                    specimen: 0.0,
                    sensor: (0.0, 0.0),
                    trial: Vec::new(),
                });
            }
            HiddenEffect::Offset { .. }
            | HiddenEffect::Inertia { .. }
            | HiddenEffect::Periodic { .. } => self.outside.push(Hidden::at_rest(effect)),
            _ => self.inside.push(Hidden::at_rest(effect)),
        }
        self
    }

    /// The coefficients of its eq 13.
    pub fn coefficients(&self) -> Coefficients {
        self.coefficients
    }

    /// Continues with the coefficients of another amplitude, in a block of `frequency` Hz.
    pub fn begin_block(&mut self, coefficients: Coefficients, frequency: f64) {
        self.coefficients = coefficients;
        self.frequency = Some(frequency);
    }

    /// The effects in it, in the order in which they were added.
    pub fn effects(&self) -> impl Iterator<Item = HiddenEffect> + '_ {
        self.effects.iter().copied()
    }

    /// Its control input at a time in s, if it has one.
    pub fn control_at(&self, time: f64) -> Option<f64> {
        self.effects().find_map(|effect| effect.control_at(time))
    }

    /// The same specimen as new: without state, at the reference temperature.
    pub fn at_rest(&self) -> Self {
        let new = Self {
            frequency: self.frequency,
            ..Self::new(self.coefficients)
        };
        self.effects().fold(new, Self::with)
    }

    /// The part of a displacement and a velocity that is felt behind the play.
    fn felt(&self, y: f64, v: f64) -> (f64, f64) {
        match self.gap {
            None => (y, v),
            Some((half_width, loose)) => {
                let beyond = y - y.clamp(-half_width, half_width);
                (beyond, if loose && beyond == 0.0 { 0.0 } else { v })
            }
        }
    }

    /// Moves the specimen behind its spring to the balance of both forces; returns the force, kN.
    fn behind(&mut self, mut spring: Spring, step: &Step) -> (f64, Spring) {
        let dt = step.dt / SUBSTEPS as f64;
        let (y0, v0) = spring.sensor;
        let mut total = 0.0;
        for i in 1..=SUBSTEPS {
            let part = i as f64 / SUBSTEPS as f64;
            let y = hermite((y0, v0), (step.displacement, step.velocity), step.dt, part);
            let before = spring.specimen;
            let at = |x: f64| {
                let (felt, velocity) = self.felt(x, (x - before) / dt);
                Step {
                    time: step.time - (1.0 - part) * step.dt,
                    displacement: felt,
                    velocity,
                    dt,
                    law: self.coefficients.force(felt, velocity),
                    damping: self.coefficients.damping_force(velocity),
                    ..*step
                }
            };
            let x = balance(y, before, spring.compliance, |x| {
                spring.trial.clone_from(&self.inside);
                let step = at(x);
                step.law + beside(&mut spring.trial, &step)
            });
            let step = at(x);
            total = step.law + beside(&mut self.inside, &step);
            spring.specimen = x;
        }
        spring.sensor = (step.displacement, step.velocity);
        (total, spring)
    }
}

/// Sum of the effects' forces, kN.
fn beside(hidden: &mut [Hidden], step: &Step) -> f64 {
    hidden.iter_mut().map(|hidden| hidden.force(step)).sum()
}

/// The cubic through two displacements with their velocities, at `part` of the distance between them.
fn hermite((y0, v0): (f64, f64), (y1, v1): (f64, f64), dt: f64, part: f64) -> f64 {
    let rest = 1.0 - part;
    rest * rest * ((1.0 + 2.0 * part) * y0 + part * dt * v0)
        + part * part * ((3.0 - 2.0 * part) * y1 - rest * dt * v1)
}

impl DamperForce for Specimen {
    fn force(
        &mut self,
        time: f64,
        displacement: f64,
        velocity: f64,
        acceleration: f64,
        dt: f64,
    ) -> f64 {
        self.time = time;
        let step = Step {
            time,
            displacement,
            velocity,
            acceleration,
            dt,
            frequency: self.frequency,
            law: 0.0,
            damping: 0.0,
        };
        let mut total = match self.spring.take() {
            Some(spring) => {
                let (force, spring) = self.behind(spring, &step);
                self.spring = Some(spring);
                force
            }
            None => {
                let (displacement, velocity) = self.felt(displacement, velocity);
                let felt = Step {
                    displacement,
                    velocity,
                    law: self.coefficients.force(displacement, velocity),
                    damping: self.coefficients.damping_force(velocity),
                    ..step
                };
                felt.law + beside(&mut self.inside, &felt)
            }
        };
        total += beside(&mut self.outside, &step);
        if let Some(temperature) = self.inside.iter().find_map(Hidden::temperature) {
            self.temperature = temperature;
        }
        match &mut self.late {
            Some(late) => late.pass(time, total),
            None => total,
        }
    }

    fn temperature(&self) -> f64 {
        self.temperature
    }

    fn control(&self) -> Option<f64> {
        self.control_at(self.time)
    }
}
