//! An effect in a coefficient pack: its kind and its numbers, as postcard lays out a `(u8, Vec<f32>)`.

use super::periodic::Tone;
use super::relaxation::Branch;
use super::stick_slip::Element;
use super::stop::Contact;
use super::{
    Asymmetry, BoucWen, Compliance, Delay, Drift, Effect, Gap, Hardening, Inertia, LoadFriction,
    MAX_BRANCHES, MAX_STICK_SLIP_ELEMENTS, MAX_TONES, Offset, Periodic, Relaxation, StickSlip,
    Stop, Temperature, Viscous,
};
use crate::frame::{Reader, Writer};

const OFFSET: u8 = 0;
const ASYMMETRY: u8 = 1;
const HARDENING: u8 = 2;
const VISCOUS: u8 = 3;
const INERTIA: u8 = 4;
const DRIFT: u8 = 5;
const TEMPERATURE: u8 = 6;
const STICK_SLIP: u8 = 7;
const RELAXATION: u8 = 8;
const STOP: u8 = 9;
const GAP: u8 = 10;
const BOUC_WEN: u8 = 11;
const PERIODIC: u8 = 12;
const COMPLIANCE: u8 = 13;
const DELAY: u8 = 14;
const LOAD_FRICTION: u8 = 15;

/// Most numbers of an effect.
const MOST: usize = 5 * MAX_TONES;

impl Effect<f32> {
    /// Writes kind and numbers.
    pub(crate) fn pack(&self, writer: &mut Writer<'_>) {
        let mut put = |kind: u8, numbers: &[f32]| {
            // A length below 128 is one byte.
            writer.bytes(&[kind, numbers.len() as u8]);
            for number in numbers {
                writer.f32(*number);
            }
        };
        match self {
            Self::Offset(effect) => put(OFFSET, &[effect.force]),
            Self::Asymmetry(effect) => put(ASYMMETRY, &[effect.k2]),
            Self::Hardening(effect) => put(HARDENING, &[effect.k5]),
            Self::Viscous(effect) => put(VISCOUS, &[effect.c1]),
            Self::Inertia(effect) => put(INERTIA, &[effect.mass]),
            Self::LoadFriction(effect) => put(LOAD_FRICTION, &[effect.load]),
            Self::Drift(effect) => {
                let numbers = [effect.stiffness, effect.elastic, effect.beyond, effect.rate];
                put(DRIFT, &numbers);
            }
            Self::Temperature(effect) => {
                put(TEMPERATURE, &[effect.beta, effect.beyond, effect.reference])
            }
            Self::Stop(effect) => {
                let [one, other] = effect.contacts;
                put(STOP, &[one.stiffness, one.gap, other.stiffness, other.gap]);
            }
            Self::Gap(effect) => put(GAP, &[effect.half_width, effect.inside]),
            Self::BoucWen(effect) => put(
                BOUC_WEN,
                &[effect.stiffness, effect.slip_limit, effect.sharpness],
            ),
            Self::Periodic(effect) => {
                let tones = effect.tones.map(|tone| {
                    let [increment_low, increment_high] = tone.increment.map(f32::from_bits);
                    let [phase_low, phase_high] = tone.phase.map(f32::from_bits);
                    let amplitude = tone.amplitude;
                    [
                        amplitude,
                        increment_low,
                        increment_high,
                        phase_low,
                        phase_high,
                    ]
                });
                put(PERIODIC, used(&tones, effect.used));
            }
            Self::Compliance(effect) => put(COMPLIANCE, &[effect.stiffness, effect.step]),
            Self::Delay(effect) => put(DELAY, &[f32::from(effect.whole), effect.rest]),
            Self::Relaxation(effect) => {
                let branches = effect.branches.map(|branch| [branch.gain, branch.loss]);
                put(RELAXATION, used(&branches, effect.used));
            }
            Self::StickSlip(effect) => {
                let elements = effect.elements.map(|one| [one.stiffness, one.slip_limit]);
                put(STICK_SLIP, used(&elements, effect.used));
            }
        }
    }

    /// What [`Effect::pack`] wrote; `None` where it is no effect. Its numbers are still to be checked.
    pub(crate) fn unpack(reader: &mut Reader<'_>) -> Option<Self> {
        let kind = reader.u8()?;
        let count = usize::from(reader.u8()?);
        let mut numbers = [0.0; MOST];
        let numbers = numbers.get_mut(..count)?;
        for number in &mut *numbers {
            *number = reader.f32()?;
        }
        Some(match (kind, &*numbers) {
            (OFFSET, &[force]) => Self::Offset(Offset { force }),
            (ASYMMETRY, &[k2]) => Self::Asymmetry(Asymmetry { k2 }),
            (HARDENING, &[k5]) => Self::Hardening(Hardening { k5 }),
            (VISCOUS, &[c1]) => Self::Viscous(Viscous { c1 }),
            (INERTIA, &[mass]) => Self::Inertia(Inertia { mass }),
            (LOAD_FRICTION, &[load]) => Self::LoadFriction(LoadFriction { load }),
            (DRIFT, &[stiffness, elastic, beyond, rate]) => Self::Drift(Drift {
                stiffness,
                elastic,
                beyond,
                rate,
            }),
            (TEMPERATURE, &[beta, beyond, reference]) => Self::Temperature(Temperature {
                beta,
                beyond,
                reference,
            }),
            (STOP, &[stiffness, gap, other_stiffness, other_gap]) => Self::Stop(Stop {
                contacts: [(stiffness, gap), (other_stiffness, other_gap)]
                    .map(|(stiffness, gap)| Contact { stiffness, gap }),
            }),
            (GAP, &[half_width, inside]) => Self::Gap(Gap { half_width, inside }),
            (BOUC_WEN, &[stiffness, slip_limit, sharpness]) => Self::BoucWen(BoucWen {
                stiffness,
                slip_limit,
                sharpness,
            }),
            (PERIODIC, numbers) => {
                let packed = groups(numbers)?;
                let mut tones = [Tone::NONE; MAX_TONES];
                for (tone, &[amplitude, a, b, c, d]) in tones.iter_mut().zip(packed) {
                    *tone = Tone {
                        amplitude,
                        increment: [a, b].map(f32::to_bits),
                        phase: [c, d].map(f32::to_bits),
                    };
                }
                Self::Periodic(Periodic {
                    tones,
                    used: packed.len(),
                })
            }
            (COMPLIANCE, &[stiffness, step]) => Self::Compliance(Compliance { stiffness, step }),
            (DELAY, &[whole, rest]) => Self::Delay(Delay {
                whole: whole as u8,
                rest,
            }),
            (RELAXATION, numbers) => {
                let pairs = groups(numbers)?;
                let mut branches = [Branch::NONE; MAX_BRANCHES];
                for (branch, &[gain, loss]) in branches.iter_mut().zip(pairs) {
                    *branch = Branch { gain, loss };
                }
                Self::Relaxation(Relaxation {
                    branches,
                    used: pairs.len(),
                })
            }
            (STICK_SLIP, numbers) => {
                let pairs = groups(numbers)?;
                let mut elements = [Element::default(); MAX_STICK_SLIP_ELEMENTS];
                for (element, &[stiffness, slip_limit]) in elements.iter_mut().zip(pairs) {
                    *element = Element {
                        stiffness,
                        slip_limit,
                    };
                }
                Self::StickSlip(StickSlip {
                    elements,
                    used: pairs.len(),
                })
            }
            _ => return None,
        })
    }
}

/// The numbers of the first `used` groups.
fn used<const N: usize>(groups: &[[f32; N]], used: usize) -> &[f32] {
    groups.get(..used).unwrap_or_default().as_flattened()
}

/// Numbers that are whole groups.
fn groups<const N: usize>(numbers: &[f32]) -> Option<&[[f32; N]]> {
    let (groups, rest) = numbers.as_chunks();
    rest.is_empty().then_some(groups)
}
