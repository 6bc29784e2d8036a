//! Faults of the channels: found, counted, said, and kept from becoming physics; and never found where there are none.

use std::f64::consts::TAU;

use crate::shared_recordings::recordings;
use mesh_damper_identify::trace::result::Verdict;
use mesh_damper_identify::trace::trace;
use mesh_damper_recording::Recording;
use mesh_damper_recording::faults::{Channel, ChannelFault, ChannelFaultKind};
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_reference::protocol::{PROTOCOL, TestBlock, motion};
use mesh_damper_rig::specimen::{DamperForce as _, HiddenEffect, SlipShape, Specimen};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

/// One sample of a motion: time s, displacement mm, velocity mm/s, acceleration mm/s².
type Sample = [f64; 4];

/// A clean channel set.
#[derive(Clone)]
struct Clean {
    time: Vec<f64>,
    displacement: Vec<f64>,
    force: Vec<f64>,
    velocity: Vec<f64>,
}

impl Clean {
    fn recording(&self) -> Recording {
        let (time, displacement) = (self.time.clone(), self.displacement.clone());
        Recording::new("test", time, displacement, self.force.clone()).unwrap()
    }
}

/// What a specimen of 3 g/cm³ hides, beyond what [`HiddenEffect`] has.
#[derive(Clone, Copy, Debug)]
enum Hides {
    Nothing,
    Listed(HiddenEffect),
    /// One-sided contact.
    Stop,
    /// A tone that has nothing to do with the motion.
    Tone,
    /// Friction that stands against the motion at once.
    Coulomb,
}

const HIDES: [Hides; 13] = [
    Hides::Nothing,
    Hides::Listed(HiddenEffect::Offset { force: 0.05 }),
    Hides::Listed(HiddenEffect::Asymmetry { k2: 3.0 }),
    Hides::Listed(HiddenEffect::Hardening { k5: 1500.0 }),
    Hides::Listed(HiddenEffect::StickSlip {
        stiffness: 1.2,
        slip_limit: 0.03,
        shape: SlipShape::Sharp,
    }),
    Hides::Listed(HiddenEffect::Viscous { c: 0.01 }),
    Hides::Listed(HiddenEffect::Relaxation {
        stiffness: 1.5,
        time: 0.05,
    }),
    Hides::Listed(HiddenEffect::Inertia { mass: 120.0 }),
    Hides::Listed(HiddenEffect::Drift {
        stiffness: 0.5,
        cycles: 15.0,
    }),
    Hides::Listed(HiddenEffect::Temperature {
        beta: 0.004,
        rise: 30.0,
        time: 6.0,
    }),
    Hides::Stop,
    Hides::Tone,
    Hides::Coulomb,
];

fn sines(rate: f64) -> Vec<Sample> {
    samples_of(&PROTOCOL, rate)
}

fn samples_of(blocks: &[TestBlock], rate: f64) -> Vec<Sample> {
    motion(blocks, rate)
        .iter()
        .map(|m| [m.time, m.displacement, m.velocity, m.acceleration])
        .collect()
}

/// Up, dwell, down, dwell, at 1 Hz; ±0.15 mm.
fn trapezoids(rate: f64) -> Vec<Sample> {
    (0..(12.0 * rate) as usize)
        .map(|index| {
            let time = index as f64 / rate;
            let phase = (time + 0.125).fract();
            let (y, v) = match phase {
                p if p < 0.25 => (-0.15 + 1.2 * p, 1.2),
                p if p < 0.5 => (0.15, 0.0),
                p if p < 0.75 => (0.15 - 1.2 * (p - 0.5), -1.2),
                _ => (-0.15, 0.0),
            };
            [time, y, v, 0.0]
        })
        .collect()
}

/// One amplitude, 1 Hz.
fn one_sine(rate: f64) -> Vec<Sample> {
    let block = TestBlock {
        amplitude: 0.1,
        frequency: 1.0,
        cycles: 15,
    };
    samples_of(&[block], rate)
}

/// The channels of a specimen that is moved so, with `noise` as a part of the RMS force, and a thousandth of the
/// displacement's RMS; rounded as a 16-bit converter does where `rounded`.
fn test(motion: &[Sample], hides: Hides, noise: f64, rounded: bool, seed: u64) -> Clean {
    let mut specimen = Specimen::of_density(3.0, 0.1);
    if let Hides::Listed(effect) = hides {
        specimen = specimen.with(effect);
    }
    let dt = motion[1][0] - motion[0][0];
    let mut force: Vec<f64> = motion
        .iter()
        .map(|&[t, y, v, a]| {
            let extra = match hides {
                Hides::Stop => 6.0 * (y - 0.12).max(0.0),
                Hides::Tone => 0.06 * (TAU * 50.0 * t + 0.4).sin(),
                Hides::Coulomb => 0.05 * v.signum(),
                _ => 0.0,
            };
            specimen.force(t, y, v, a, dt) + extra
        })
        .collect();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let rms =
        |values: &[f64]| (values.iter().map(|f| f * f).sum::<f64>() / values.len() as f64).sqrt();
    let mut spoil = |values: &mut [f64], noise: f64| {
        let full = 1.5 * values.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
        for value in values {
            let normal: f64 = StandardNormal.sample(&mut random);
            *value += noise * normal;
            if rounded {
                *value = (*value / full * 32768.0).round() * full / 32768.0;
            }
        }
    };
    let deviation = noise * rms(&force);
    spoil(&mut force, deviation);
    let mut displacement: Vec<f64> = motion.iter().map(|s| s[1]).collect();
    let deviation = 1e-3 * rms(&displacement);
    spoil(&mut displacement, deviation);
    Clean {
        time: motion.iter().map(|s| s[0]).collect(),
        displacement,
        force,
        velocity: motion.iter().map(|s| s[2]).collect(),
    }
}

fn faults_of(recording: &Recording) -> Vec<ChannelFault> {
    Trajectory::of(recording).unwrap().faults
}

/// Every kind of motion, rate, noise and physics: no fault is found where there is none.
#[test]
fn clean_recordings_have_no_faults() {
    let (mut tried, mut wrong) = (0, Vec::new());
    for (which, &hides) in HIDES.iter().enumerate() {
        for (name, motion) in [
            ("sines at 200 Hz", sines(200.0)),
            ("sines at 500 Hz", sines(500.0)),
            ("sines at 1 kHz", sines(1000.0)),
            ("trapezoids at 500 Hz", trapezoids(500.0)),
            ("one sine at 500 Hz", one_sine(500.0)),
            ("one sine at 20 Hz", one_sine(20.0)),
        ] {
            for noise in [0.002, 0.01, 0.03] {
                let rounded = tried % 2 == 0;
                let clean = test(&motion, hides, noise, rounded, 100 * tried + which as u64);
                tried += 1;
                for fault in faults_of(&clean.recording()) {
                    wrong.push(format!(
                        "{hides:?}, {name}, noise {noise}, rounded {rounded}: {fault}"
                    ));
                }
            }
        }
    }
    assert_eq!(tried, 234);
    assert!(
        wrong.is_empty(),
        "{} of {tried}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

/// Likewise on the recordings kept beside the repository, which none of its code made. Two of the measured ones do have
/// faults: a logger that left out a row 179 times, and four lone samples of a load cell that stand 0.06 … 0.2 kN off.
#[test]
fn recordings_of_others_have_the_faults_that_are_in_them() {
    let Some(folder) = recordings() else {
        return;
    };
    let (mut found, mut averaged) = (Vec::new(), Vec::new());
    // Those whose makers say what is in them.
    let known = [
        "labelled",
        "undeclared",
        "measured/press",
        "measured/shaking-table",
        "measured/tribometer",
    ];
    for known in known {
        for entry in std::fs::read_dir(folder.join(known)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "gz") {
                let name = path.file_name().unwrap().to_string_lossy().into_owned();
                for fault in faults_of(&Recording::read(&path).unwrap()) {
                    // Those of the press, as its authors say: over a tenth of a period.
                    if let ChannelFaultKind::Averaged { time } = fault.kind {
                        averaged.push((name.clone(), time));
                    } else {
                        found.push(format!("{name}: {fault}"));
                    }
                }
            }
        }
    }
    found.sort();
    assert_eq!(
        found,
        [
            "A9.csv.gz: spikes in the force: 4 samples, the largest 0.2 times the channel's spread; left out",
            "friction.csv.gz: missing samples: 179 in 179 gaps; the force there was left out, the motion interpolated",
        ]
    );
    let conditions = [
        ("25mm0x1Hz", 1.0),
        ("25mm0x25Hz", 0.4),
        ("25mm0x5Hz", 0.2),
        ("10mm1Hz", 0.1),
        ("5mm3Hz", 1.0 / 30.0),
        ("2mm5Hz", 0.02),
    ];
    assert_eq!(averaged.len(), 3 * conditions.len());
    for (name, time) in averaged {
        let of = conditions.iter().find(|(start, _)| name.starts_with(start));
        let (_, expected) = of.unwrap_or_else(|| panic!("{name}"));
        assert!((time / expected - 1.0).abs() < 0.02, "{name}: {time} s");
    }
}

/// What is done to a clean recording.
#[derive(Clone, Copy, Debug)]
enum Spoilt {
    /// So many spikes of 1 to 3 samples in the force, of this size over its RMS.
    ForceSpikes(usize, f64),
    /// Likewise in the displacement, over its RMS.
    DisplacementSpikes(usize, f64),
    /// The force ends at this part of its largest value, on both sides.
    ForceClipped(f64),
    /// Likewise above only.
    ForceClippedAbove(f64),
    /// The displacement ends at this part of its largest value.
    DisplacementClipped(f64),
    /// So many rows are gone, so many in a row each time.
    Missing(usize, usize),
    /// The force stands still so many times for so many samples.
    ForceHeld(usize, usize),
    /// Likewise the displacement.
    DisplacementHeld(usize, usize),
    /// Times are off by up to this part of a period; the samples are not.
    Stamps(f64),
    /// The force is early by so many samples.
    Early(usize),
    /// The force has the wrong sign.
    Flipped,
    /// The force is in another unit from this part of the recording on.
    ForceUnit(f64),
    /// The displacement is in a unit a thousand times larger up to this part of the recording.
    DisplacementUnit(f64),
    /// The whole force is in newtons, of a specimen that is declared.
    Newtons,
    /// The whole displacement is in metres, of a specimen that is declared.
    Metres,
    /// A velocity column is in m/s.
    VelocityUnit,
    /// A velocity column has the wrong sign.
    VelocityFlipped,
    /// A velocity column holds something else.
    NoVelocity,
}

const SPOILT: [Spoilt; 31] = [
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
    fn is(self, samples: usize, found: &[ChannelFault]) -> bool {
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
                    mended: true,
                } if factors.contains(&factor) => Some(samples),
                _ => None,
            }
        };
        match self {
            // What is no larger than what the specimen does at its turns may pass.
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

/// How many samples have the fault.
fn spoilt_samples(kind: ChannelFaultKind) -> usize {
    match kind {
        ChannelFaultKind::Spikes { samples, .. }
        | ChannelFaultKind::Clipping { samples, .. }
        | ChannelFaultKind::Held { samples, .. }
        | ChannelFaultKind::Missing { samples, .. } => samples,
        _ => 0,
    }
}

/// Starts of `count` stretches of `length` samples, none near another or an end.
fn places(count: usize, length: usize, samples: usize, random: &mut ChaCha8Rng) -> Vec<usize> {
    let room = samples / (count + 1);
    assert!(room > 2 * length + 8);
    (0..count)
        .map(|place| room / 2 + place * room + random.random_range(0..room - length - 8))
        .collect()
}

impl Spoilt {
    /// The spoilt recording, and how many samples are spoilt.
    fn of(self, clean: &Clean, seed: u64) -> (Recording, usize) {
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

/// Every fault, in recordings of every physics: found in the channel that it is in, with about as many samples, and
/// nothing else said. The gate tries every third of them, one after the other.
#[test]
fn faults_are_found_counted_and_nothing_else_is() {
    every_fault_in_every_physics(3);
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn all_faults_are_found_counted_and_nothing_else_is() {
    every_fault_in_every_physics(1);
}

fn every_fault_in_every_physics(step: usize) {
    let mut wrong = Vec::new();
    let mut tried = 0;
    for (which, &hides) in HIDES.iter().enumerate() {
        let noise = [0.004, 0.03][which % 2];
        let clean = test(&sines(500.0), hides, noise, which % 4 < 2, which as u64);
        for (number, spoilt) in SPOILT.into_iter().enumerate() {
            if (which + number) % step > 0 {
                continue;
            }
            // A force that is early by less than its memory lasts looks like more damping; so does it under a tone.
            let remembers = matches!(
                hides,
                Hides::Tone
                    | Hides::Stop
                    | Hides::Listed(
                        HiddenEffect::StickSlip { .. }
                            | HiddenEffect::Relaxation { .. }
                            | HiddenEffect::Drift { .. },
                    )
            );
            // Spikes of the tone's size are lost in it.
            let lost = matches!((hides, spoilt), (Hides::Tone, Spoilt::ForceSpikes(_, 1.0)));
            if lost || remembers && matches!(spoilt, Spoilt::Early(_)) {
                continue;
            }
            let (recording, samples) = spoilt.of(&clean, number as u64);
            let found = faults_of(&recording);
            tried += 1;
            if !spoilt.is(samples, &found) {
                let said: Vec<String> = found.iter().map(ChannelFault::to_string).collect();
                wrong.push(format!(
                    "{hides:?}, noise {noise}, {spoilt:?} of {samples}: {}",
                    said.join("; ")
                ));
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "{} of {tried}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

/// Samples that were taken at uneven times, and say so: the channels are interpolated.
#[test]
fn samples_at_uneven_times_are_interpolated() {
    for part in [0.1, 0.4] {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let fine = test(&sines(20_000.0), Hides::Nothing, 0.004, false, 1);
        let picked: Vec<usize> = (1..fine.time.len() / 40 - 1)
            .map(|index| (40.0 * (index as f64 + random.random_range(-part..part))) as usize)
            .collect();
        let pick = |values: &[f64]| {
            picked
                .iter()
                .map(|&index| values[index])
                .collect::<Vec<f64>>()
        };
        let recording = Recording::new(
            "test",
            pick(&fine.time),
            pick(&fine.displacement),
            pick(&fine.force),
        )
        .unwrap();
        let trajectory = Trajectory::of(&recording).unwrap();
        assert!(
            matches!(
                trajectory.faults[..],
                [ChannelFault {
                    kind: ChannelFaultKind::Jitter {
                        stamps_only: false,
                        ..
                    },
                    ..
                }]
            ),
            "{part}: {:?}",
            trajectory.faults
        );
        assert!(trajectory.measured.iter().all(|&measured| measured));
    }
}

/// What is concluded of a recording: verdict and families.
fn concluded(recording: &Recording) -> (Verdict, Vec<String>, Vec<String>) {
    let result = trace(std::slice::from_ref(recording), &[], &|_| ())
        .unwrap()
        .result;
    let families = result
        .effects
        .into_iter()
        .map(|effect| effect.family)
        .collect();
    let faults = result
        .warnings
        .into_iter()
        .filter(|warning| warning.starts_with("test: "));
    (result.verdict, families, faults.collect())
}

/// Physics is not invented from faults: what is found in a spoilt recording is what is found in the clean one.
#[test]
fn faults_do_not_become_physics() {
    let blocks: Vec<TestBlock> = [
        (0.1, 1.0, 4),
        (0.2, 5.0, 8),
        (0.1, 5.0, 8),
        (0.05, 5.0, 8),
        (0.2, 1.0, 4),
    ]
    .map(|(amplitude, frequency, cycles)| TestBlock {
        amplitude,
        frequency,
        cycles,
    })
    .to_vec();
    let mut wrong = Vec::new();
    let mut tried = 0;
    for (hides, faults) in [
        (
            Hides::Nothing,
            &[
                Spoilt::ForceSpikes(60, 5.0),
                Spoilt::DisplacementSpikes(60, 5.0),
                Spoilt::ForceClipped(0.8),
                Spoilt::DisplacementClipped(0.8),
                Spoilt::Missing(20, 10),
                Spoilt::ForceHeld(5, 60),
                Spoilt::DisplacementHeld(5, 60),
                Spoilt::Stamps(0.4),
                Spoilt::Early(5),
                Spoilt::Flipped,
                Spoilt::ForceUnit(0.4),
                Spoilt::DisplacementUnit(0.3),
                Spoilt::VelocityUnit,
            ][..],
        ),
        (
            Hides::Listed(HiddenEffect::Asymmetry { k2: 3.0 }),
            &[
                Spoilt::ForceSpikes(60, 5.0),
                Spoilt::ForceClippedAbove(0.8),
                Spoilt::Missing(5, 60),
                Spoilt::Flipped,
                Spoilt::Newtons,
            ],
        ),
        (
            Hides::Listed(HiddenEffect::StickSlip {
                stiffness: 1.2,
                slip_limit: 0.03,
                shape: SlipShape::Sharp,
            }),
            &[Spoilt::ForceClipped(0.8), Spoilt::Stamps(0.4)],
        ),
    ] {
        let clean = test(&samples_of(&blocks, 500.0), hides, 0.004, false, 11);
        let (verdict, families, said) = concluded(&clean.recording());
        assert!(said.is_empty(), "{said:?}");
        for (number, &spoilt) in faults.iter().enumerate() {
            tried += 1;
            let (recording, _) = spoilt.of(&clean, 50 + number as u64);
            let found = concluded(&recording);
            if (found.0, &found.1) != (verdict, &families) || found.2.is_empty() {
                wrong.push(format!(
                    "{hides:?}, {spoilt:?}: {:?} {:?} instead of {verdict:?} {families:?}",
                    found.0, found.1
                ));
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "{} of {tried}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}
