//! The effects that a specimen can hide.

use serde::{Deserialize, Serialize};

use super::unlisted::Unlisted;

/// An effect that eq 13 does not contain. A size may have either sign where physics allows it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "family", rename_all = "snake_case", deny_unknown_fields)]
pub enum HiddenEffect {
    /// F = f0: a preload.
    Offset {
        /// Force f0, kN.
        force: f64,
    },
    /// F = k2·y²: a stiffness that differs between the directions.
    Asymmetry {
        /// Stiffness k2, kN/mm².
        k2: f64,
    },
    /// F = k5·y⁵: wires that close up under compression.
    Hardening {
        /// Stiffness k5, kN/mm⁵.
        k5: f64,
    },
    /// Friction joints behind a spring.
    StickSlip {
        /// Stiffness while everything sticks, kN/mm.
        stiffness: f64,
        /// Stretch at which it slips, mm: the largest force is stiffness · slip limit.
        slip_limit: f64,
        /// The transition from sticking to slipping.
        shape: SlipShape,
    },
    /// F = c·v: viscous damping.
    Viscous {
        /// Damping c, kN·s/mm.
        c: f64,
    },
    /// A Maxwell branch: Ḟ = stiffness·v − F/time.
    Relaxation {
        /// Stiffness, kN/mm.
        stiffness: f64,
        /// Relaxation time, s.
        time: f64,
    },
    /// A spring and a dashpot in series: Ḟ = stiffness·(v − w) with F = force·tanh(w/rate) + c·w.
    Yielding {
        /// Stiffness of the spring, kN/mm.
        stiffness: f64,
        /// Force at which the dashpot yields, kN.
        force: f64,
        /// Rate of the dashpot at which it has yielded, mm/s.
        rate: f64,
        /// Damping c, kN·s/mm.
        c: f64,
    },
    /// F = m·a: a mass that the load cell carries.
    Inertia {
        /// Mass, kg, that is 1e-6 kN·s²/mm.
        mass: f64,
    },
    /// F = k·(1 − e^(−n/N))·y after n cycles: wires that bed in (k > 0) or break (k < 0).
    Drift {
        /// The final change k, kN/mm.
        stiffness: f64,
        /// Number of cycles N.
        cycles: f64,
    },
    /// F = −β·(T − T0)·(force of eq 13), in a chamber that warms as T0 + rise·(1 − e^(−t/time)) with T0 = 20 °C.
    Temperature {
        /// β, loss of force per degree, 1/°C.
        beta: f64,
        /// Final rise of the temperature, °C.
        rise: f64,
        /// Time constant of the warming, s.
        time: f64,
    },
    /// F = k·max(s·y − gap, 0)·s with s = ±1: a stop on one side.
    Stop {
        /// Stiffness of the contact, kN/mm.
        stiffness: f64,
        /// Displacement at contact, mm: on the positive side if positive, otherwise on the negative side.
        gap: f64,
    },
    /// Play in the clamping: the specimen feels only the displacement beyond ±half_width.
    Gap {
        /// Half of the play, mm.
        half_width: f64,
        /// Whether the specimen does not feel the velocity inside the play either.
        loose: bool,
    },
    /// The force channel is delayed.
    Delay {
        /// Delay, s.
        time: f64,
    },
    /// A spring between specimen and clamping: the sensor measures the motion of both.
    Compliance {
        /// Compliance of the spring, mm/kN.
        compliance: f64,
    },
    /// F = force·sin(2π·frequency·t + phase), with t from the beginning of the test: a tone from another source.
    Periodic {
        /// Amplitude of the force, kN.
        force: f64,
        /// Frequency, Hz.
        frequency: f64,
        /// Phase, rad.
        phase: f64,
    },
    /// The branch of [`HiddenEffect::Yielding`] without its c, and F = c·v parallel to it, both multiplied by w. An input u
    /// controls w: lag·dw/dt = u − w.
    ControlInput {
        /// Stiffness of the spring at an input of 1, kN/mm.
        stiffness: f64,
        /// Force at which the dashpot yields at an input of 1, kN.
        force: f64,
        /// Rate of the dashpot at which it has yielded, mm/s.
        rate: f64,
        /// Viscosity at an input of 1, kN·s/mm.
        c: f64,
        /// Time constant of w, s.
        lag: f64,
        /// The input u over time.
        schedule: Schedule,
    },
    /// F = difference·|damping force of eq 13|: a damping that differs between the directions.
    Directional {
        /// Difference between the directions, −1…1.
        difference: f64,
    },
    /// A friction joint behind a spring, with play between the two that moves with the joint.
    Backlash {
        /// Stiffness of the spring, kN/mm.
        stiffness: f64,
        /// Stretch of the spring at which the joint slips, mm.
        slip_limit: f64,
        /// The full play, mm.
        slack: f64,
    },
    /// F = stiffness·y/(1 + m/softening) with m the largest displacement so far: contacts that a larger motion has opened.
    Degradation {
        /// Stiffness without softening, kN/mm.
        stiffness: f64,
        /// Displacement at which the stiffness is halved, mm.
        softening: f64,
    },
    /// An effect without a family in the tracer.
    Unlisted(Unlisted),
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
    /// The family under which a trace names it, or the kind of an unlisted one.
    pub fn family(&self) -> &'static str {
        match self {
            Self::Offset { .. } => "offset",
            Self::Asymmetry { .. } => "asymmetry",
            Self::Hardening { .. } => "hardening",
            Self::StickSlip { .. } => "stick_slip",
            Self::Viscous { .. } => "viscous",
            Self::Relaxation { .. } => "relaxation",
            Self::Yielding { .. } => "yielding",
            Self::Inertia { .. } => "inertia",
            Self::Drift { .. } => "drift",
            Self::Temperature { .. } => "temperature",
            Self::Stop { .. } => "stop",
            Self::Gap { .. } => "gap",
            Self::Delay { .. } => "delay",
            Self::Compliance { .. } => "compliance",
            Self::Periodic { .. } => "periodic",
            Self::ControlInput { .. } => "control_input",
            Self::Directional { .. } => "directional",
            Self::Backlash { .. } => "backlash",
            Self::Degradation { .. } => "degradation",
            Self::Unlisted(effect) => effect.kind(),
        }
    }

    /// Its control input at a time in s.
    pub fn control_at(&self, time: f64) -> Option<f64> {
        match self {
            Self::ControlInput { schedule, .. } => Some(schedule.at(time)),
            _ => None,
        }
    }

    /// The same effect with `factor` times the force; a gap, a delay or a compliance with `factor` times the width, delay or
    /// compliance.
    pub fn scaled(mut self, factor: f64) -> Self {
        if let Self::Yielding { force, c, .. } | Self::ControlInput { force, c, .. } = &mut self {
            *force *= factor;
            *c *= factor;
        }
        *match &mut self {
            Self::Offset { force } => force,
            Self::Asymmetry { k2 } => k2,
            Self::Hardening { k5 } => k5,
            Self::StickSlip { stiffness, .. } => stiffness,
            Self::Viscous { c } => c,
            Self::Relaxation { stiffness, .. }
            | Self::Yielding { stiffness, .. }
            | Self::ControlInput { stiffness, .. }
            | Self::Backlash { stiffness, .. }
            | Self::Degradation { stiffness, .. } => stiffness,
            Self::Directional { difference } => difference,
            Self::Inertia { mass } => mass,
            Self::Drift { stiffness, .. } => stiffness,
            Self::Temperature { beta, .. } => beta,
            Self::Stop { stiffness, .. } => stiffness,
            Self::Gap { half_width, .. } => half_width,
            Self::Delay { time } => time,
            Self::Compliance { compliance } => compliance,
            Self::Periodic { force, .. } => force,
            Self::Unlisted(effect) => effect.size_mut(),
        } *= factor;
        self
    }

    /// Its parameters as (name, value, unit).
    pub fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        match *self {
            Self::Offset { force } => vec![("force", force, "kN")],
            Self::Asymmetry { k2 } => vec![("k2", k2, "kN/mm2")],
            Self::Hardening { k5 } => vec![("k5", k5, "kN/mm5")],
            Self::StickSlip {
                stiffness,
                slip_limit,
                ..
            } => vec![
                ("stiffness", stiffness, "kN/mm"),
                ("slip_limit", slip_limit, "mm"),
            ],
            Self::Viscous { c } => vec![("c", c, "kN*s/mm")],
            Self::Relaxation { stiffness, time } => {
                vec![("stiffness", stiffness, "kN/mm"), ("time", time, "s")]
            }
            Self::Yielding {
                stiffness,
                force,
                rate,
                c,
            } => vec![
                ("stiffness", stiffness, "kN/mm"),
                ("force", force, "kN"),
                ("rate", rate, "mm/s"),
                ("c", c, "kN*s/mm"),
            ],
            Self::Inertia { mass } => vec![("mass", mass, "kg")],
            Self::Drift { stiffness, cycles } => {
                vec![
                    ("stiffness", stiffness, "kN/mm"),
                    ("cycles", cycles, "cycles"),
                ]
            }
            Self::Temperature { beta, rise, time } => vec![
                ("beta", beta, "1/degC"),
                ("rise", rise, "degC"),
                ("time", time, "s"),
            ],
            Self::Stop { stiffness, gap } => {
                vec![("stiffness", stiffness, "kN/mm"), ("gap", gap, "mm")]
            }
            Self::Gap { half_width, .. } => vec![("half_width", half_width, "mm")],
            Self::Delay { time } => vec![("time", time, "s")],
            Self::Compliance { compliance } => vec![("compliance", compliance, "mm/kN")],
            Self::Periodic {
                force,
                frequency,
                phase,
            } => vec![
                ("force", force, "kN"),
                ("frequency", frequency, "Hz"),
                ("phase", phase, "rad"),
            ],
            Self::ControlInput {
                stiffness,
                force,
                rate,
                c,
                lag,
                schedule,
            } => vec![
                ("stiffness", stiffness, "kN/mm"),
                ("force", force, "kN"),
                ("rate", rate, "mm/s"),
                ("c", c, "kN*s/mm"),
                ("lag", lag, "s"),
                ("most", schedule.most, "A"),
                ("hold", schedule.hold, "s"),
            ],
            Self::Directional { difference } => vec![("difference", difference, "1")],
            Self::Backlash {
                stiffness,
                slip_limit,
                slack,
            } => vec![
                ("stiffness", stiffness, "kN/mm"),
                ("slip_limit", slip_limit, "mm"),
                ("slack", slack, "mm"),
            ],
            Self::Degradation {
                stiffness,
                softening,
            } => vec![
                ("stiffness", stiffness, "kN/mm"),
                ("softening", softening, "mm"),
            ],
            Self::Unlisted(effect) => effect.parameters(),
        }
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
