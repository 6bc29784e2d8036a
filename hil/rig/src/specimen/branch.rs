//! Effects parallel to eq 13, and their states.

use std::f64::consts::TAU;

use super::hidden::{HiddenEffect, SlipShape};
use super::{REFERENCE_TEMPERATURE, unlisted};

/// Longest substep of a yielding dashpot, s: its implicit first-order rule is late by half of it, a thousandth of a period of 100
/// Hz.
const YIELDING_SUBSTEP: f64 = 2e-5;

/// One call of the specimen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// Time since the test began, s.
    pub time: f64,
    /// Displacement, mm.
    pub displacement: f64,
    /// Velocity, mm/s.
    pub velocity: f64,
    /// Acceleration, mm/s².
    pub acceleration: f64,
    /// Time since the previous call, s.
    pub dt: f64,
    /// Frequency of the running block in Hz, if known.
    pub frequency: Option<f64>,
    /// Force of eq 13, kN.
    pub law: f64,
    /// Damping force of eq 13, kN.
    pub damping: f64,
}

/// An effect and its state.
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

    /// Reuses the memory, because an actuator tries copies of its specimen every tick.
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
    Controlled {
        /// The part of the input that has arrived; `None` before the first call.
        arrived: Option<f64>,
        force: f64,
        displacement: f64,
    },
    Slack {
        /// Position of the spring's free end relative to the middle of the play, mm.
        place: f64,
        displacement: f64,
    },
    Largest(f64),
    Cycles(CycleCount),
    Heat {
        temperature: f64,
    },
    Unlisted(unlisted::Memory),
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
            HiddenEffect::Relaxation { .. } | HiddenEffect::Yielding { .. } => Memory::Branch {
                force: 0.0,
                displacement: 0.0,
            },
            HiddenEffect::ControlInput { .. } => Memory::Controlled {
                arrived: None,
                force: 0.0,
                displacement: 0.0,
            },
            HiddenEffect::Backlash { .. } => Memory::Slack {
                place: 0.0,
                displacement: 0.0,
            },
            HiddenEffect::Degradation { .. } => Memory::Largest(0.0),
            HiddenEffect::Drift { .. } => Memory::Cycles(CycleCount::default()),
            HiddenEffect::Temperature { .. } => Memory::Heat {
                temperature: REFERENCE_TEMPERATURE,
            },
            HiddenEffect::Unlisted(effect) => Memory::Unlisted(effect.at_rest()),
            _ => Memory::None,
        };
        Self { effect, memory }
    }

    /// Temperature in °C, for the effect that sets it.
    pub fn temperature(&self) -> Option<f64> {
        match self.memory {
            Memory::Heat { temperature } => Some(temperature),
            _ => None,
        }
    }

    /// Force in addition to eq 13, kN.
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
            (
                HiddenEffect::Yielding {
                    stiffness,
                    force: yields,
                    rate,
                    c,
                },
                Memory::Branch {
                    force,
                    displacement,
                },
            ) => {
                let moved = y - *displacement;
                *displacement = y;
                yielded(force, moved, step.dt, [stiffness, yields, rate, c]);
                *force
            }
            (
                HiddenEffect::ControlInput {
                    stiffness,
                    force: yields,
                    rate,
                    c,
                    lag,
                    schedule,
                },
                Memory::Controlled {
                    arrived,
                    force,
                    displacement,
                },
            ) => {
                let input = schedule.at(step.time);
                let before = arrived.unwrap_or(input);
                let now = input + (before - input) * (-step.dt / lag.max(f64::MIN_POSITIVE)).exp();
                *arrived = Some(now);
                let moved = y - *displacement;
                *displacement = y;
                if stiffness == 0.0 {
                    return 0.0;
                }
                // Its branch is that of an input of 1; its viscosity is added separately.
                yielded(force, moved, step.dt, [stiffness, yields, rate, 0.0]);
                now * (*force + c * step.velocity)
            }
            (HiddenEffect::Directional { difference }, _) => difference * step.damping.abs(),
            (
                HiddenEffect::Backlash {
                    stiffness,
                    slip_limit,
                    slack,
                },
                Memory::Slack {
                    place,
                    displacement,
                },
            ) => {
                let reach = 0.5 * slack + slip_limit;
                *place = (*place + y - *displacement).clamp(-reach, reach);
                *displacement = y;
                let stretch = (place.abs() - 0.5 * slack).max(0.0);
                stiffness * stretch.copysign(*place)
            }
            (
                HiddenEffect::Degradation {
                    stiffness,
                    softening,
                },
                Memory::Largest(largest),
            ) => {
                *largest = largest.max(y.abs());
                stiffness * y * softening / (softening + *largest)
            }
            (HiddenEffect::Drift { stiffness, cycles }, Memory::Cycles(count)) => {
                let run = match step.frequency {
                    Some(frequency) => count.run_on(frequency * step.dt),
                    None => count.update(y),
                };
                stiffness * (1.0 - (-run / cycles).exp()) * y
            }
            (HiddenEffect::Temperature { beta, rise, time }, Memory::Heat { temperature }) => {
                let warmed = rise * (1.0 - (-step.time / time).exp());
                *temperature = REFERENCE_TEMPERATURE + warmed;
                -beta * warmed * step.law
            }
            (HiddenEffect::Stop { stiffness, gap }, _) => {
                let side = gap.signum();
                side * stiffness * (side * y - gap.abs()).max(0.0)
            }
            (
                HiddenEffect::Periodic {
                    force,
                    frequency,
                    phase,
                },
                _,
            ) => force * (TAU * frequency * step.time + phase).sin(),
            (HiddenEffect::Unlisted(effect), Memory::Unlisted(memory)) => {
                effect.force(memory, step)
            }
            _ => unreachable!("at_rest() gives every effect its own memory"),
        }
    }
}

/// Moves a spring with a yielding dashpot behind it by `moved` mm within `dt` s; `force` is that of both, kN.
fn yielded(force: &mut f64, moved: f64, dt: f64, [stiffness, yields, rate, c]: [f64; 4]) {
    let substeps = (dt / YIELDING_SUBSTEP).ceil().max(1.0);
    let dt = dt / substeps;
    for _ in 0..substeps as usize {
        // The spring's force if the dashpot stood still, minus its loss within the substep.
        let held = *force + stiffness * moved / substeps;
        let dashpot = |w: f64| yields * (w / rate).tanh() + c * w;
        let slope = |w: f64| {
            let tanh = (w / rate).tanh();
            yields / rate * (1.0 - tanh * tanh) + c + stiffness * dt
        };
        let excess = |w: f64| dashpot(w) + stiffness * dt * w - held.abs();
        let w = root(excess, slope, held.abs() / (c + stiffness * dt));
        *force = held - stiffness * dt * w.copysign(held);
    }
}

/// The zero of a rising function between 0 and `most`: by Newton steps, and by bisection if one leaves the remaining interval.
fn root(function: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64, most: f64) -> f64 {
    let (mut low, mut high) = (0.0, most);
    let mut at = 0.0;
    for _ in 0..100 {
        let value = function(at);
        if value > 0.0 {
            high = at;
        } else {
            low = at;
        }
        let newton = at - value / slope(at);
        let next = if low < newton && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - at).abs() <= 1e-12 * most || high <= low {
            return next;
        }
        at = next;
    }
    at
}

/// Moves the sliders by `moved` mm and returns their mean stretch, mm.
fn slip(stretch: &mut [f64], moved: f64, limit: f64, shape: SlipShape) -> f64 {
    let count = stretch.len() as f64;
    match shape {
        SlipShape::Smooth { exponent } => {
            // Substeps keep the explicit midpoint rule accurate, however far the caller moves at once.
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

/// Counts cycles. With a known frequency it counts them as they run; otherwise it counts half cycles, which are passages through
/// zero after a swing of at least a fifth of the largest so far.
#[derive(Clone, Debug, Default)]
struct CycleCount {
    largest: f64,
    /// Side of the last such swing, −1 or 1; 0 before the first.
    side: f64,
    completed: f64,
}

impl CycleCount {
    /// Cycles run, after `part` of one more.
    fn run_on(&mut self, part: f64) -> f64 {
        self.completed += part;
        self.completed
    }

    /// Cycles completed, in half cycles.
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
