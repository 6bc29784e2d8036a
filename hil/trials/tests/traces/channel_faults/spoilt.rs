//! Faults that are injected into clean recordings, and whether they are found.

use mesh_damper_recording::Recording;
use mesh_damper_recording::faults::{ChannelFault, ChannelFaultKind};
use mesh_damper_tables::channel::Channel;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::clean::Clean;

/// The fault that is injected into a clean recording.
#[derive(Clone, Copy, Debug)]
pub enum Spoilt {
    /// The number of spikes of 1 to 3 samples in the force, and their size over its RMS.
    ForceSpikes(usize, f64),
    /// The same in the displacement, over its RMS.
    DisplacementSpikes(usize, f64),
    /// The force is clipped at this fraction of its largest value, on both sides.
    ForceClipped(f64),
    /// The same above only.
    ForceClippedAbove(f64),
    /// The displacement is clipped at this fraction of its largest value.
    DisplacementClipped(f64),
    /// The number of gaps, and the rows that are missing in each.
    Missing(usize, usize),
    /// The force is constant for a while: how often, and for how many samples.
    ForceHeld(usize, usize),
    /// The same for the displacement.
    DisplacementHeld(usize, usize),
    /// Times have errors of up to this fraction of a period; the samples do not.
    Stamps(f64),
    /// The force is early by this many samples.
    Early(usize),
    /// The force has the wrong sign.
    Flipped,
    /// The force is in another unit from this fraction of the recording on.
    ForceUnit(f64),
    /// The displacement is in a unit a thousand times larger up to this fraction of the recording.
    DisplacementUnit(f64),
    /// The whole force is in newtons, of a specimen that is declared.
    Newtons,
    /// The whole displacement is in metres, of a specimen that is declared.
    Metres,
    /// A velocity column is in m/s.
    VelocityUnit,
    /// A velocity column has the wrong sign.
    VelocityFlipped,
    /// A velocity column contains another quantity.
    NoVelocity,
}

pub const SPOILT: [Spoilt; 31] = [
    Spoilt::ForceSpikes(20, 1.0),
    Spoilt::ForceSpikes(60, 5.0),
    Spoilt::ForceSpikes(5, 50.0),
    Spoilt::DisplacementSpikes(20, 0.3),
    Spoilt::DisplacementSpikes(60, 5.0),
    Spoilt::ForceClipped(0.6),
    Spoilt::ForceClipped(0.8),
    Spoilt::ForceClipped(0.9),
    Spoilt::ForceClippedAbove(0.8),
    Spoilt::DisplacementClipped(0.8),
    Spoilt::DisplacementClipped(0.95),
    Spoilt::Missing(200, 1),
    Spoilt::Missing(20, 10),
    Spoilt::Missing(5, 60),
    Spoilt::ForceHeld(10, 10),
    Spoilt::ForceHeld(5, 60),
    Spoilt::DisplacementHeld(10, 10),
    Spoilt::DisplacementHeld(5, 60),
    Spoilt::Stamps(0.1),
    Spoilt::Stamps(0.4),
    Spoilt::Early(2),
    Spoilt::Early(5),
    Spoilt::Flipped,
    Spoilt::ForceUnit(0.4),
    Spoilt::ForceUnit(0.7),
    Spoilt::DisplacementUnit(0.3),
    Spoilt::Newtons,
    Spoilt::Metres,
    Spoilt::VelocityUnit,
    Spoilt::VelocityFlipped,
    Spoilt::NoVelocity,
];

impl Spoilt {
    /// Whether `found` is this fault in `samples` samples and no other.
    pub fn is(self, samples: usize, found: &[ChannelFault]) -> bool {
        let about = |count: usize, part: f64| {
            count as f64 >= part * samples as f64 && count as f64 <= samples as f64 / part
        };
        let all =
            |channel: Channel, counted: &dyn Fn(ChannelFaultKind) -> Option<usize>, part: f64| {
                let counts: Option<Vec<usize>> = found
                    .iter()
                    .map(|fault| counted(fault.kind).filter(|_| fault.channel == channel))
                    .collect();
                counts.is_some_and(|counts| !counts.is_empty() && about(counts.iter().sum(), part))
            };
        let spikes =
            |kind| matches!(kind, ChannelFaultKind::Spikes { .. }).then(|| spoilt_samples(kind));
        let clipped =
            |kind| matches!(kind, ChannelFaultKind::Clipping { .. }).then(|| spoilt_samples(kind));
        let held =
            |kind| matches!(kind, ChannelFaultKind::Held { .. }).then(|| spoilt_samples(kind));
        let missing =
            |kind| matches!(kind, ChannelFaultKind::Missing { .. }).then(|| spoilt_samples(kind));
        let units = |factors: [f64; 2]| {
            move |kind| match kind {
                ChannelFaultKind::Unit {
                    factor,
                    samples,
                    repaired: true,
                } if factors.contains(&factor) => Some(samples),
                _ => None,
            }
        };
        match self {
            // A spike no larger than the change of the force at a reversal may be missed.
            Self::ForceSpikes(_, size) => {
                all(Channel::Force, &spikes, if size > 2.0 { 0.95 } else { 0.5 })
            }
            Self::DisplacementSpikes(_, size) => all(
                Channel::Displacement,
                &spikes,
                if size > 2.0 { 0.95 } else { 0.85 },
            ),
            Self::ForceClipped(_) | Self::ForceClippedAbove(_) => {
                all(Channel::Force, &clipped, 0.95)
            }
            Self::DisplacementClipped(_) => all(Channel::Displacement, &clipped, 0.95),
            Self::Missing(..) => all(Channel::Time, &missing, 1.0),
            Self::ForceHeld(..) => all(Channel::Force, &held, 0.95),
            Self::DisplacementHeld(..) => all(Channel::Displacement, &held, 0.95),
            Self::Stamps(part) => {
                matches!(found, [ChannelFault { kind: ChannelFaultKind::Jitter { rms, stamps_only: true }, .. }]
                // Uniform over ± part.
                if (rms - part / 3f64.sqrt()).abs() < 0.05 * part)
            }
            Self::Early(ticks) => {
                matches!(found, [ChannelFault { kind: ChannelFaultKind::Shifted { late }, .. }]
                if (late / 2e-3 + ticks as f64).abs() < 0.3)
            }
            Self::Flipped => matches!(
                found,
                [ChannelFault {
                    channel: Channel::Force,
                    kind: ChannelFaultKind::Flipped
                }]
            ),
            Self::ForceUnit(_) => all(Channel::Force, &units([1e3, 1e-3]), 0.998),
            Self::DisplacementUnit(_) | Self::Metres => {
                all(Channel::Displacement, &units([1e3, 1e-3]), 0.998)
            }
            Self::Newtons => all(Channel::Force, &units([1e-3, 1e-3]), 1.0),
            Self::VelocityUnit => all(Channel::Velocity, &units([1e3, 1e3]), 1.0),
            Self::VelocityFlipped => matches!(
                found,
                [ChannelFault {
                    channel: Channel::Velocity,
                    kind: ChannelFaultKind::Flipped
                }]
            ),
            Self::NoVelocity => matches!(
                found,
                [ChannelFault {
                    kind: ChannelFaultKind::NotDerivative,
                    ..
                }]
            ),
        }
    }
}

/// The number of samples with the fault.
fn spoilt_samples(kind: ChannelFaultKind) -> usize {
    match kind {
        ChannelFaultKind::Spikes { samples, .. }
        | ChannelFaultKind::Clipping { samples, .. }
        | ChannelFaultKind::Held { samples, .. }
        | ChannelFaultKind::Missing { samples, .. } => samples,
        _ => 0,
    }
}

/// Starts of `count` stretches of `length` samples, none near another stretch or an end.
fn places(count: usize, length: usize, samples: usize, random: &mut ChaCha8Rng) -> Vec<usize> {
    let room = samples / (count + 1);
    assert!(room > 2 * length + 8);
    (0..count)
        .map(|place| room / 2 + place * room + random.random_range(0..room - length - 8))
        .collect()
}

impl Spoilt {
    /// The recording with the fault, and the number of faulty samples.
    pub fn of(self, clean: &Clean, seed: u64) -> (Recording, usize) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut c = clean.clone();
        let count = c.time.len();
        let mut spoilt = 0;
        let rms = |values: &[f64]| {
            (values.iter().map(|f| f * f).sum::<f64>() / values.len() as f64).sqrt()
        };
        let mut comment = None;
        let mut velocity = None;
        match self {
            Self::ForceSpikes(spikes, size) | Self::DisplacementSpikes(spikes, size) => {
                let values = if matches!(self, Self::ForceSpikes(..)) {
                    &mut c.force
                } else {
                    &mut c.displacement
                };
                let size = size * rms(values);
                for start in places(spikes, 3, count, &mut random) {
                    let length = random.random_range(1..=3);
                    let sign = if random.random::<bool>() { size } else { -size };
                    for value in &mut values[start..start + length] {
                        *value += sign * random.random_range(1.0..1.5);
                    }
                    spoilt += length;
                }
            }
            Self::ForceClipped(part)
            | Self::ForceClippedAbove(part)
            | Self::DisplacementClipped(part) => {
                let values = if matches!(self, Self::DisplacementClipped(_)) {
                    &mut c.displacement
                } else {
                    &mut c.force
                };
                let limit = part * values.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
                let low = if matches!(self, Self::ForceClippedAbove(_)) {
                    f64::NEG_INFINITY
                } else {
                    -limit
                };
                for value in values {
                    spoilt += usize::from(*value > limit || *value < low);
                    *value = value.clamp(low, limit);
                }
            }
            Self::Missing(gaps, length) => {
                let starts = places(gaps, length, count, &mut random);
                let gone = |index: usize| {
                    starts
                        .iter()
                        .any(|&start| (start..start + length).contains(&index))
                };
                for values in [&mut c.time, &mut c.displacement, &mut c.force] {
                    let mut index = 0;
                    values.retain(|_| {
                        index += 1;
                        !gone(index - 1)
                    });
                }
                spoilt = gaps * length;
            }
            Self::ForceHeld(stretches, length) | Self::DisplacementHeld(stretches, length) => {
                let values = if matches!(self, Self::ForceHeld(..)) {
                    &mut c.force
                } else {
                    &mut c.displacement
                };
                for start in places(stretches, length, count, &mut random) {
                    let value = values[start];
                    values[start..=start + length].fill(value);
                }
                spoilt = stretches * length;
            }
            Self::Stamps(part) => {
                let period = c.time[1] - c.time[0];
                c.time
                    .iter_mut()
                    .for_each(|t| *t += period * random.random_range(-part..part));
                spoilt = count;
            }
            Self::Early(ticks) => {
                c.force.rotate_left(ticks);
                let last = c.force[count - ticks - 1];
                c.force[count - ticks..].fill(last);
                spoilt = count;
            }
            Self::Flipped => {
                c.force.iter_mut().for_each(|f| *f = -*f);
                spoilt = count;
            }
            Self::ForceUnit(part) => {
                let from = (part * count as f64) as usize;
                c.force[from..].iter_mut().for_each(|f| *f *= 1000.0);
                spoilt = from.min(count - from);
            }
            Self::DisplacementUnit(part) => {
                let to = (part * count as f64) as usize;
                c.displacement[..to].iter_mut().for_each(|y| *y *= 1e-3);
                spoilt = to.min(count - to);
            }
            Self::Newtons => {
                c.force.iter_mut().for_each(|f| *f *= 1000.0);
                comment = Some("specimen: MMD 22x12x15 mm");
                spoilt = count;
            }
            Self::Metres => {
                c.displacement.iter_mut().for_each(|f| *f *= 1e-3);
                comment = Some("specimen: metal mesh, 3 g/cm3");
                spoilt = count;
            }
            Self::VelocityUnit => {
                velocity = Some(c.velocity.iter().map(|v| v * 1e-3).collect());
                spoilt = count;
            }
            Self::VelocityFlipped => velocity = Some(c.velocity.iter().map(|v| -v).collect()),
            Self::NoVelocity => velocity = Some(c.force.clone()),
        }
        let mut recording = c.recording();
        if let Some(comment) = comment {
            recording = recording.with_comment(comment);
        }
        if let Some(velocity) = velocity {
            recording = recording.with_velocity(velocity).unwrap();
        }
        (recording, spoilt)
    }
}
