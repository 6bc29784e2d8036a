//! The effects a specimen can hide, and what each remembers.

use serde::Serialize;

use super::REFERENCE_TEMPERATURE;

/// An effect that eq 13 does not have. Sizes may have either sign where physics allows it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "family", rename_all = "snake_case")]
pub enum HiddenEffect {
    /// F = f0: a preload.
    Offset {
        /// f0, kN.
        force: f64,
    },
    /// F = k2·y²: another stiffness in one direction than in the other.
    Asymmetry {
        /// kN/mm².
        k2: f64,
    },
    /// F = k5·y⁵: wires that close up.
    Hardening {
        /// kN/mm⁵.
        k5: f64,
    },
    /// Friction joints behind a spring.
    StickSlip {
        /// Stiffness while everything sticks, kN/mm.
        stiffness: f64,
        /// Stretch at which it slips, mm: the largest force is stiffness · slip limit.
        slip_limit: f64,
        /// How sticking turns into slipping.
        shape: SlipShape,
    },
    /// F = c·v.
    Viscous {
        /// kN·s/mm.
        c: f64,
    },
    /// A Maxwell branch: Ḟ = stiffness·v − F/time.
    Relaxation {
        /// kN/mm.
        stiffness: f64,
        /// s.
        time: f64,
    },
    /// F = m·a: what the load cell carries along.
    Inertia {
        /// kg, that is 1e-6 kN·s²/mm.
        mass: f64,
    },
    /// F = k·(1 − e^(−n/N))·y with n cycles run: wires that bed in (k > 0) or break (k < 0).
    Drift {
        /// The change k in the end, kN/mm.
        stiffness: f64,
        /// N, cycles.
        cycles: f64,
    },
    /// F = −β·(T − T0)·(force of eq 13), in a chamber that warms from T0 = 20 °C as T0 + rise·(1 − e^(−t/time)).
    Temperature {
        /// β, loss of force per degree, 1/°C.
        beta: f64,
        /// °C.
        rise: f64,
        /// s.
        time: f64,
    },
}

/// How the friction joints of [`HiddenEffect::StickSlip`] turn from sticking to slipping.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SlipShape {
    /// All at once: one Jenkins element.
    Sharp,
    /// Smoothly: Bouc–Wen, ẋ = v·(1 − |x/limit|^n·(1 + sgn(v·x))/2).
    Smooth {
        /// n; the larger, the sharper.
        exponent: f64,
    },
    /// One after another: sliders whose limits are spread evenly from 0 to twice the slip limit.
    Spread {
        /// How many.
        sliders: usize,
    },
}

impl HiddenEffect {
    /// The family by which a trace names it.
    pub fn family(&self) -> &'static str {
        match self {
            Self::Offset { .. } => "offset",
            Self::Asymmetry { .. } => "asymmetry",
            Self::Hardening { .. } => "hardening",
            Self::StickSlip { .. } => "stick_slip",
            Self::Viscous { .. } => "viscous",
            Self::Relaxation { .. } => "relaxation",
            Self::Inertia { .. } => "inertia",
            Self::Drift { .. } => "drift",
            Self::Temperature { .. } => "temperature",
        }
    }

    /// The same effect with `factor` times the force.
    pub fn scaled(mut self, factor: f64) -> Self {
        *match &mut self {
            Self::Offset { force } => force,
            Self::Asymmetry { k2 } => k2,
            Self::Hardening { k5 } => k5,
            Self::StickSlip { stiffness, .. } => stiffness,
            Self::Viscous { c } => c,
            Self::Relaxation { stiffness, .. } => stiffness,
            Self::Inertia { mass } => mass,
            Self::Drift { stiffness, .. } => stiffness,
            Self::Temperature { beta, .. } => beta,
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
        }
    }

    /// Whether a specimen can have it: finite sizes, and limits, times, cycles and sliders above zero.
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
                Self::Drift { cycles, .. } => cycles > 0.0,
                _ => true,
            }
    }
}

/// One call of the specimen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// s since the test began.
    pub time: f64,
    /// mm.
    pub displacement: f64,
    /// mm/s.
    pub velocity: f64,
    /// mm/s².
    pub acceleration: f64,
    /// s since the previous call.
    pub dt: f64,
    /// Force of eq 13, kN.
    pub law: f64,
}

/// An effect and what it remembers.
#[derive(Debug)]
pub(super) struct Hidden {
    effect: HiddenEffect,
    memory: Memory,
}

impl Clone for Hidden {
    fn clone(&self) -> Self {
        Self {
            effect: self.effect,
            memory: self.memory.clone(),
        }
    }

    /// Into the room that is there: an actuator tries copies of its specimen every tick.
    #[inline]
    fn clone_from(&mut self, source: &Self) {
        self.effect = source.effect;
        match (&mut self.memory, &source.memory) {
            (
                Memory::Sliders {
                    stretch,
                    displacement,
                },
                Memory::Sliders {
                    stretch: others,
                    displacement: other,
                },
            ) => {
                stretch.clone_from(others);
                *displacement = *other;
            }
            (memory, other) => memory.clone_from(other),
        }
    }
}

#[derive(Clone, Debug)]
enum Memory {
    None,
    Sliders {
        stretch: Vec<f64>,
        displacement: f64,
    },
    Branch {
        force: f64,
        displacement: f64,
    },
    Cycles(CycleCount),
    Heat {
        temperature: f64,
    },
}

impl Hidden {
    /// Everything relaxed at displacement 0.
    pub fn at_rest(effect: HiddenEffect) -> Self {
        let memory = match effect {
            HiddenEffect::StickSlip { shape, .. } => Memory::Sliders {
                stretch: vec![
                    0.0;
                    match shape {
                        SlipShape::Spread { sliders } => sliders,
                        SlipShape::Sharp | SlipShape::Smooth { .. } => 1,
                    }
                ],
                displacement: 0.0,
            },
            HiddenEffect::Relaxation { .. } => Memory::Branch {
                force: 0.0,
                displacement: 0.0,
            },
            HiddenEffect::Drift { .. } => Memory::Cycles(CycleCount::default()),
            HiddenEffect::Temperature { .. } => Memory::Heat {
                temperature: REFERENCE_TEMPERATURE,
            },
            _ => Memory::None,
        };
        Self { effect, memory }
    }

    pub fn effect(&self) -> HiddenEffect {
        self.effect
    }

    /// °C, of the effect that sets it.
    pub fn temperature(&self) -> Option<f64> {
        match self.memory {
            Memory::Heat { temperature } => Some(temperature),
            _ => None,
        }
    }

    /// kN beside eq 13.
    pub fn force(&mut self, step: &Step) -> f64 {
        let y = step.displacement;
        match (self.effect, &mut self.memory) {
            (HiddenEffect::Offset { force }, _) => force,
            (HiddenEffect::Asymmetry { k2 }, _) => k2 * y * y,
            (HiddenEffect::Hardening { k5 }, _) => k5 * y.powi(5),
            (HiddenEffect::Viscous { c }, _) => c * step.velocity,
            (HiddenEffect::Inertia { mass }, _) => mass * 1e-6 * step.acceleration,
            (
                HiddenEffect::StickSlip {
                    stiffness,
                    slip_limit,
                    shape,
                },
                Memory::Sliders {
                    stretch,
                    displacement,
                },
            ) => {
                let moved = y - *displacement;
                *displacement = y;
                stiffness * slip(stretch, moved, slip_limit, shape)
            }
            (
                HiddenEffect::Relaxation { stiffness, time },
                Memory::Branch {
                    force,
                    displacement,
                },
            ) => {
                // Trapezoidal rule over Ḟ = k·v − F/τ, with the displacement's own increment for ∫v dt.
                let half = step.dt / (2.0 * time);
                *force = (*force * (1.0 - half) + stiffness * (y - *displacement)) / (1.0 + half);
                *displacement = y;
                *force
            }
            (HiddenEffect::Drift { stiffness, cycles }, Memory::Cycles(count)) => {
                let run = count.update(y);
                stiffness * (1.0 - (-run / cycles).exp()) * y
            }
            (HiddenEffect::Temperature { beta, rise, time }, Memory::Heat { temperature }) => {
                let warmed = rise * (1.0 - (-step.time / time).exp());
                *temperature = REFERENCE_TEMPERATURE + warmed;
                -beta * warmed * step.law
            }
            _ => unreachable!("at_rest() gives every effect its own memory"),
        }
    }
}

/// Moves the sliders by `moved` mm and returns their mean stretch, mm.
fn slip(stretch: &mut [f64], moved: f64, limit: f64, shape: SlipShape) -> f64 {
    let count = stretch.len() as f64;
    match shape {
        SlipShape::Smooth { exponent } => {
            // Substeps keep the explicit midpoint rule accurate however far the caller moves at once.
            let substeps = (moved.abs() / (0.02 * limit)).ceil().max(1.0);
            let by = moved / substeps;
            let slope = |x: f64| {
                if by * x > 0.0 {
                    1.0 - (x / limit).abs().powf(exponent)
                } else {
                    1.0
                }
            };
            for x in stretch.iter_mut() {
                for _ in 0..substeps as usize {
                    let middle = *x + 0.5 * by * slope(*x);
                    *x += by * slope(middle);
                }
            }
        }
        SlipShape::Sharp => {
            for x in stretch.iter_mut() {
                *x = (*x + moved).clamp(-limit, limit);
            }
        }
        SlipShape::Spread { .. } => {
            for (i, x) in stretch.iter_mut().enumerate() {
                let own = 2.0 * limit * (i as f64 + 0.5) / count;
                *x = (*x + moved).clamp(-own, own);
            }
        }
    }
    stretch.iter().sum::<f64>() / count
}

/// Counts half cycles: passages through zero after a swing of at least a fifth of the largest so far.
#[derive(Clone, Debug, Default)]
struct CycleCount {
    largest: f64,
    /// Side of the last such swing, −1 or 1; 0 before the first.
    side: f64,
    completed: f64,
}

impl CycleCount {
    /// Cycles completed, by halves.
    fn update(&mut self, displacement: f64) -> f64 {
        self.largest = self.largest.max(displacement.abs());
        if displacement * self.side < 0.0 {
            self.side = 0.0;
            self.completed += 0.5;
        }
        if displacement.abs() > 0.2 * self.largest {
            self.side = displacement.signum();
        }
        self.completed
    }
}
