//! The effects that a specimen can hide.

use serde::{Deserialize, Serialize};

use super::list::effects;
use super::unlisted::Unlisted;

effects! {
    /// An effect that eq 13 does not contain. A size may have either sign where physics allows it.
    #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
    #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
    #[serde(tag = "family", rename_all = "snake_case", deny_unknown_fields)]
    enum HiddenEffect {
        /// F = f0: a preload.
        Offset = "offset" {
            /// Force f0, kN.
            force: "kN" scaled,
        }
        /// F = k2·y²: a stiffness that differs between the directions.
        Asymmetry = "asymmetry" {
            /// Stiffness k2, kN/mm².
            k2: "kN/mm2" scaled,
        }
        /// F = k5·y⁵: wires that close up under compression.
        Hardening = "hardening" {
            /// Stiffness k5, kN/mm⁵.
            k5: "kN/mm5" scaled,
        }
        /// Friction joints behind a spring.
        StickSlip = "stick_slip" {
            /// Stiffness while everything sticks, kN/mm.
            stiffness: "kN/mm" scaled,
            /// Stretch at which it slips, mm: the largest force is stiffness · slip limit.
            slip_limit: "mm",
            ;
            /// The transition from sticking to slipping.
            shape: SlipShape,
        }
        /// F = c·v: viscous damping.
        Viscous = "viscous" {
            /// Damping c, kN·s/mm.
            c: "kN*s/mm" scaled,
        }
        /// A Maxwell branch: Ḟ = stiffness·v − F/time.
        Relaxation = "relaxation" {
            /// Stiffness, kN/mm.
            stiffness: "kN/mm" scaled,
            /// Relaxation time, s.
            time: "s",
        }
        /// A spring and a dashpot in series: Ḟ = stiffness·(v − w) with F = force·tanh(w/rate) + c·w.
        Yielding = "yielding" {
            /// Stiffness of the spring, kN/mm.
            stiffness: "kN/mm" scaled,
            /// Force at which the dashpot yields, kN.
            force: "kN" scaled,
            /// Rate of the dashpot at which it has yielded, mm/s.
            rate: "mm/s",
            /// Damping c, kN·s/mm.
            c: "kN*s/mm" scaled,
        }
        /// F = m·a: a mass that the load cell carries.
        Inertia = "inertia" {
            /// Mass, kg, that is 1e-6 kN·s²/mm.
            mass: "kg" scaled,
        }
        /// F = k·(1 − e^(−n/N))·y after n cycles: wires that bed in (k > 0) or break (k < 0).
        Drift = "drift" {
            /// The final change k, kN/mm.
            stiffness: "kN/mm" scaled,
            /// Number of cycles N.
            cycles: "cycles",
        }
        /// F = −β·(T − T0)·(force of eq 13), in a chamber that warms as T0 + rise·(1 − e^(−t/time)) with T0 = 20 °C.
        Temperature = "temperature" {
            /// β, loss of force per degree, 1/°C.
            beta: "1/degC" scaled,
            /// Final rise of the temperature, °C.
            rise: "degC",
            /// Time constant of the warming, s.
            time: "s",
        }
        /// F = k·max(s·y − gap, 0)·s with s = ±1: a stop on one side.
        Stop = "stop" {
            /// Stiffness of the contact, kN/mm.
            stiffness: "kN/mm" scaled,
            /// Displacement at contact, mm: on the positive side if positive, otherwise on the negative side.
            gap: "mm",
        }
        /// Play in the clamping: the specimen feels only the displacement beyond ±half_width.
        Gap = "gap" {
            /// Half of the play, mm.
            half_width: "mm" scaled,
            ;
            /// Whether the specimen does not feel the velocity inside the play either.
            loose: bool,
        }
        /// The force channel is delayed.
        Delay = "delay" {
            /// Delay, s.
            time: "s" scaled,
        }
        /// A spring between specimen and clamping: the sensor measures the motion of both.
        Compliance = "compliance" {
            /// Compliance of the spring, mm/kN.
            compliance: "mm/kN" scaled,
        }
        /// F = force·sin(2π·frequency·t + phase), with t from the beginning of the test: a tone from another source.
        Periodic = "periodic" {
            /// Amplitude of the force, kN.
            force: "kN" scaled,
            /// Frequency, Hz.
            frequency: "Hz",
            /// Phase, rad.
            phase: "rad",
        }
        /// The branch of [`HiddenEffect::Yielding`] without its c, and F = c·v parallel to it, both multiplied by w. An input u
        /// controls w: lag·dw/dt = u − w.
        ControlInput = "control_input" {
            /// Stiffness of the spring at an input of 1, kN/mm.
            stiffness: "kN/mm" scaled,
            /// Force at which the dashpot yields at an input of 1, kN.
            force: "kN" scaled,
            /// Rate of the dashpot at which it has yielded, mm/s.
            rate: "mm/s",
            /// Viscosity at an input of 1, kN·s/mm.
            c: "kN*s/mm" scaled,
            /// Time constant of w, s.
            lag: "s",
            ;
            /// The input u over time.
            schedule: Schedule,
        }
        /// F = difference·|damping force of eq 13|: a damping that differs between the directions.
        Directional = "directional" {
            /// Difference between the directions, −1…1.
            difference: "1" scaled,
        }
        /// A friction joint behind a spring, with play between the two that moves with the joint.
        Backlash = "backlash" {
            /// Stiffness of the spring, kN/mm.
            stiffness: "kN/mm" scaled,
            /// Stretch of the spring at which the joint slips, mm.
            slip_limit: "mm",
            /// The full play, mm.
            slack: "mm",
        }
        /// F = stiffness·y/(1 + m/softening) with m the largest displacement so far: contacts that a larger motion has opened.
        Degradation = "degradation" {
            /// Stiffness without softening, kN/mm.
            stiffness: "kN/mm" scaled,
            /// Displacement at which the stiffness is halved, mm.
            softening: "mm",
        }
        ;
        /// An effect without a family in the tracer.
        Unlisted(Unlisted)
    }
}

/// An input that takes one of five levels from 0 on and holds it for a while.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Schedule {
    /// The highest level; for a control input, as a fraction of its full range.
    pub most: f64,
    /// Time for which each level is held, s.
    pub hold: f64,
    /// Seed of the sequence of levels.
    pub seed: u64,
}

impl Schedule {
    const LEVELS: u64 = 5;

    /// The input at a time in s.
    pub fn at(&self, time: f64) -> f64 {
        // The mixing of splitmix64 (Steele, Lea and Flood 2014).
        let step = (time / self.hold).max(0.0) as u64;
        let mut mixed = (self.seed ^ step).wrapping_add(0x9e37_79b9_7f4a_7c15);
        mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        let level = (mixed ^ mixed >> 31) % Self::LEVELS;
        self.most * level as f64 / (Self::LEVELS - 1) as f64
    }
}

/// Transition of the friction joints of [`HiddenEffect::StickSlip`] from sticking to slipping.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SlipShape {
    /// Abrupt: one Jenkins element.
    Sharp,
    /// Smooth: Bouc–Wen, ẋ = v·(1 − |x/limit|^n·(1 + sgn(v·x))/2).
    Smooth {
        /// The exponent n. A larger exponent gives a sharper transition.
        exponent: f64,
    },
    /// Gradual: sliders with limits spread evenly from 0 to twice the slip limit.
    Spread {
        /// Number of sliders.
        sliders: usize,
    },
}

impl HiddenEffect {
    /// Its control input at a time in s.
    pub fn control_at(&self, time: f64) -> Option<f64> {
        match self {
            Self::ControlInput { schedule, .. } => Some(schedule.at(time)),
            _ => None,
        }
    }

    /// Its parameters as (name, value, unit).
    pub fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        let mut parameters = self.sizes();
        if let Self::ControlInput { schedule, .. } = self {
            parameters.extend([("most", schedule.most, "A"), ("hold", schedule.hold, "s")]);
        }
        parameters
    }

    /// Whether a specimen can have it: finite sizes; limits, times, cycles and sliders above zero; and a gap, delay or compliance
    /// of at least zero.
    pub fn is_admissible(&self) -> bool {
        let finite = self
            .parameters()
            .iter()
            .all(|(_, value, _)| value.is_finite());
        finite
            && match *self {
                Self::StickSlip {
                    slip_limit, shape, ..
                } => {
                    slip_limit > 0.0
                        && match shape {
                            SlipShape::Sharp => true,
                            SlipShape::Smooth { exponent } => exponent >= 1.0,
                            SlipShape::Spread { sliders } => sliders > 0,
                        }
                }
                Self::Relaxation { time, .. } | Self::Temperature { time, .. } => time > 0.0,
                Self::Yielding {
                    stiffness,
                    force,
                    rate,
                    c,
                } => stiffness > 0.0 && force >= 0.0 && rate > 0.0 && c >= 0.0,
                // With a strength of 0 nothing depends on the input.
                Self::ControlInput {
                    stiffness,
                    force,
                    rate,
                    c,
                    lag,
                    schedule,
                } => {
                    [stiffness, force, c, lag].iter().all(|size| *size >= 0.0)
                        && rate > 0.0
                        && schedule.hold > 0.0
                }
                Self::Directional { difference } => difference.abs() <= 1.0,
                Self::Backlash {
                    slip_limit, slack, ..
                } => slip_limit > 0.0 && slack >= 0.0,
                Self::Degradation { softening, .. } => softening > 0.0,
                Self::Drift { cycles, .. } => cycles > 0.0,
                Self::Gap { half_width, .. } => half_width >= 0.0,
                Self::Delay { time } => time >= 0.0,
                Self::Compliance { compliance } => compliance >= 0.0,
                Self::Unlisted(effect) => effect.is_admissible(),
                _ => true,
            }
    }
}
