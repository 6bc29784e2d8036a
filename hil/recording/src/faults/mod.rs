//! Channel faults: found between reading and identification, reported, and kept from looking like physics.
//!
//! A feature that repeats with the motion is physics, however sharp. A feature is a fault if it comes once, stands still while the
//! rest moves, or is impossible for a passive damper. A recording without faults is unchanged.
//!
//! Whole channels come first (`sign`, `scale`), on the recording as read. Then single samples follow, on the uniform time base:
//! `clipping`, `held`, `spikes`. Hum comes last, when nothing hides it. Invalid forces are left out. Invalid displacements are
//! bridged, because the motion of the samples around them, and the memory of the specimen, depend on them.

use std::borrow::Cow;

pub(crate) mod bridge;
pub(crate) mod clipping;
pub(crate) mod held;
pub(crate) mod hum;
pub(crate) mod scale;
pub(crate) mod shift;
pub(crate) mod sign;
pub(crate) mod spikes;
pub(crate) mod velocity;

use super::resample::Uniform;
use super::{Recording, counted};
use mesh_damper_tables::channel::Channel;

crate::numbers! {
    /// What all searches for channel faults share.
    FaultsPolicy {
        /// Two values of a channel are equal if they differ by at most this fraction of its spread.
        same_value: f64 = 1e-7, Convention("below the last digit in files, above the rounding when a value is read");
        /// The spread of a channel is the distance from its median within which this fraction of its samples lie. The usual deviation
        /// around a spike is such a distance too.
        usually: f64 = 0.9, Convention("nine in ten, so that a spike does not decide");
    }
}

pub use scale::ScalePolicy;
pub(super) use shift::Shift;
pub use shift::ShiftPolicy;

/// Kind and size of a channel fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChannelFaultKind {
    /// Samples that are outliers from both of their neighbours.
    Spikes {
        /// Number of samples.
        samples: usize,
        /// The largest, relative to the spread of the channel.
        largest: f64,
    },
    /// A channel clipped at the limit of its range.
    Clipping {
        /// Samples at the limit.
        samples: usize,
        /// The limit, in the code's unit of the channel.
        limit: f64,
    },
    /// A value repeated while the motion went on.
    Held {
        /// Samples that repeat.
        samples: usize,
        /// Number of stretches.
        stretches: usize,
    },
    /// Rows that repeat the row before.
    Repeated {
        /// Number of rows.
        samples: usize,
    },
    /// A last row without a line end, whose last number may have been cut.
    Cut,
    /// Missing samples.
    Missing {
        /// Number of samples.
        samples: usize,
        /// Number of gaps.
        gaps: usize,
    },
    /// Times that are not equal steps.
    Jitter {
        /// RMS deviation from equal steps, periods.
        rms: f64,
        /// Whether the samples were taken in equal steps all the same, and only the times are wrong.
        stamps_only: bool,
    },
    /// A time shift between force and displacement.
    Shifted {
        /// Delay of the force, s; negative if it is early.
        late: f64,
    },
    /// A reversed sign.
    Flipped,
    /// A unit that differs from the one in the column's name.
    Unit {
        /// Factor by which the channel was multiplied, or would have to be.
        factor: f64,
        /// Number of samples concerned.
        samples: usize,
        /// Whether it was repaired.
        repaired: bool,
    },
    /// A velocity that is not the derivative of the displacement.
    NotDerivative,
    /// The force per displacement is below that of any mesh damper.
    Soft {
        /// Force per displacement, kN/mm.
        stiffness: f64,
    },
    /// A tone of the mains.
    Hum {
        /// Hz
        frequency: f64,
        /// In the code's unit of the channel.
        amplitude: f64,
    },
    /// Displacement and force that were smoothed by a moving average.
    Averaged {
        /// Time that it is over, s.
        time: f64,
    },
    /// A zero of the channel that steps once and stays there.
    ZeroStep {
        /// Time, s.
        time: f64,
        /// Change, in the code's unit of the channel.
        change: f64,
    },
    /// A zero of the channel that differs from the other recordings of the specimen.
    Zero {
        /// Difference, in the code's unit of the channel.
        change: f64,
        /// Whether it was moved back.
        repaired: bool,
    },
    /// Noise that grows towards low frequencies as 1/f.
    Pink {
        /// Its standard deviation divided by that of the noise in quick changes.
        times: f64,
    },
}

/// A fault found in a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelFault {
    /// The channel.
    pub channel: Channel,
    /// The kind.
    pub kind: ChannelFaultKind,
}

impl ChannelFault {
    /// Whether the unit of a channel is probably wrong and was left as it is: the results are then wrong too.
    pub fn is_doubtful_unit(&self) -> bool {
        matches!(
            self.kind,
            ChannelFaultKind::Soft { .. }
                | ChannelFaultKind::Unit {
                    repaired: false,
                    ..
                }
        )
    }
}

impl std::fmt::Display for ChannelFault {
    /// The fault, its size, and the repair.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let channel = self.channel.name();
        let left = match self.channel {
            Channel::Force => "left out",
            _ => "replaced by values interpolated from the samples around them",
        };
        match self.kind {
            ChannelFaultKind::Spikes { samples, largest } => write!(
                f,
                "spikes in the {channel}: {}, the largest {largest:.1} times the channel's spread; {left}",
                counted(samples)
            ),
            ChannelFaultKind::Clipping { samples, limit } => write!(
                f,
                "clipping of the {channel} at {limit:.4} {}: {}; {left}",
                self.channel.unit(),
                counted(samples)
            ),
            ChannelFaultKind::Held { samples, stretches } => write!(
                f,
                "the {channel} stands still while the motion goes on: {} in {}; {left}",
                counted(samples),
                stretches_of(stretches, "stretch", "stretches")
            ),
            ChannelFaultKind::Repeated { samples } => write!(
                f,
                "rows written twice: {}; the second was left out",
                counted(samples)
            ),
            ChannelFaultKind::Cut => write!(
                f,
                "the last row has no line end, so its last number may be cut; the row was left out"
            ),
            ChannelFaultKind::Missing { samples, gaps } => write!(
                f,
                "missing samples: {samples} in {}; the force there was left out, the motion interpolated",
                stretches_of(gaps, "gap", "gaps")
            ),
            ChannelFaultKind::Jitter {
                rms,
                stamps_only: true,
            } => write!(
                f,
                "jitter of the times, {rms:.2} of a period RMS: the displacement is smoother over equal steps, so the \
                 samples are treated as equally spaced"
            ),
            ChannelFaultKind::Jitter {
                rms,
                stamps_only: false,
            } => write!(
                f,
                "jitter of the times, {rms:.2} of a period RMS: the channels were interpolated to equal steps"
            ),
            ChannelFaultKind::Shifted { late } => write!(
                f,
                "channels shifted in time: the force is {} by {:.2} ms, which is impossible for a passive damper; the shift was corrected",
                if late < 0.0 { "early" } else { "late" },
                1e3 * late.abs()
            ),
            ChannelFaultKind::Flipped if self.channel == Channel::Velocity => write!(
                f,
                "sign of the velocity flipped: it is opposite to the displacement's rate of change; the sign was reversed"
            ),
            ChannelFaultKind::Flipped => write!(
                f,
                "sign of the force flipped: as recorded, the specimen would deliver energy and push in the \
                 direction of the motion; the sign was reversed"
            ),
            ChannelFaultKind::Unit {
                factor,
                samples,
                repaired,
            } => {
                let factor_above_one = factor.max(1.0 / factor);
                if repaired {
                    return write!(
                        f,
                        "unit of the {channel} wrong by a factor of {factor_above_one:.0}: {} multiplied by {factor:e}",
                        was(samples)
                    );
                }
                // Only the force over the displacement is implausible.
                let either = if self.channel == Channel::Force {
                    " or of the displacement"
                } else {
                    ""
                };
                write!(
                    f,
                    "unit of the {channel}{either} wrong by a factor of {factor_above_one:.0}: nothing was changed; check the units in \
                     the columns' names or the --unit options; every value found is wrong by this factor"
                )
            }
            ChannelFaultKind::Soft { stiffness } => write!(
                f,
                "the force is only {stiffness:.1e} kN per mm, less than a tenth of the softest metal mesh damper's: check the units in the columns' \
                 names or the --unit options, and that displacement and force are not swapped; nothing was changed"
            ),
            ChannelFaultKind::Hum {
                frequency,
                amplitude,
            } => write!(
                f,
                "hum on the {channel}: {amplitude:.1e} {} at {frequency:.2} Hz; it was subtracted",
                self.channel.unit()
            ),
            ChannelFaultKind::Zero { change, repaired } => write!(
                f,
                "the zero of the {channel} lies {change:+.4} {} from that of the other recordings; {}",
                self.channel.unit(),
                match repaired {
                    true => "the shift was corrected",
                    false =>
                        "the fit does not account for it: tare the channel, or subtract the shift from the column",
                }
            ),
            ChannelFaultKind::ZeroStep { time, change } => write!(
                f,
                "the zero of the {channel} steps by {change:.2e} {} at {time:.3} s; the samples after it were corrected",
                self.channel.unit()
            ),
            ChannelFaultKind::Pink { times } => write!(
                f,
                "the noise of the {channel} grows towards low frequencies as 1/f, to {times:.1} times its noise at high frequencies; \
                 the trace takes this into account"
            ),
            ChannelFaultKind::Averaged { time } => write!(
                f,
                "displacement and force are moving averages over {time:.3} s: neither has noise at {:.1} Hz and its multiples; \
                 the law's force is averaged in the same way before the comparison",
                1.0 / time
            ),
            ChannelFaultKind::NotDerivative => write!(
                f,
                "the velocity is not the derivative of the displacement; it was left out, and the derivative is used"
            ),
        }
    }
}

/// The faults in one line.
pub(super) fn listed(faults: &[ChannelFault]) -> String {
    let texts: Vec<String> = faults.iter().map(ChannelFault::to_string).collect();
    texts.join("; ")
}

fn was(samples: usize) -> String {
    let verb = if samples == 1 { "was" } else { "were" };
    format!("{} {verb}", counted(samples))
}

fn stretches_of(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

impl Recording {
    /// The recording with channels repaired that are wrong as a whole or from some time on: a sign, a unit. [`Recording::faults`]
    /// lists the repairs; repairing twice changes nothing more. Without a repair the copy is dropped at once.
    #[must_use]
    pub fn repaired(&self) -> Cow<'_, Self> {
        let mut recording = self.clone();
        scale::repair(&mut recording);
        sign::repair(&mut recording);
        // Every repair is reported.
        if recording.faults.len() == self.faults.len() {
            Cow::Borrowed(self)
        } else {
            Cow::Owned(recording)
        }
    }

    /// The repairs of [`Recording::repaired`], and rows that were written twice.
    pub fn faults(&self) -> &[ChannelFault] {
        &self.faults
    }
}

/// Finds faults of single samples, excludes them from the measured samples, and bridges the displacement.
pub(super) fn examine(uniform: &mut Uniform) -> Vec<ChannelFault> {
    let mut faults = Vec::new();
    let count = uniform.len();
    let mut absent = [vec![false; count], vec![false; count]];
    let present: Vec<bool> = uniform.measured.clone();
    held::find(uniform, &present, &mut absent, &mut faults);
    clipping::find(uniform, &present, &mut absent, &mut faults);
    spikes::find(uniform, &present, &mut absent, &mut faults);
    let [no_displacement, no_force] = absent;
    let unknown: Vec<bool> = (0..count)
        .map(|index| no_displacement[index] || !present[index])
        .collect();
    bridge::bridge(&mut uniform.displacement, &unknown, uniform.period);
    for index in 0..count {
        if no_force[index] || no_displacement[index] {
            uniform.measured[index] = false;
        }
    }
    bridge::bridge(&mut uniform.force, &no_force, uniform.period);
    hum::find(uniform, &mut faults);
    velocity::examine(uniform, &unknown, &mut faults);
    faults
}

/// The channels whose single samples may be faulty, with the `absent` samples of each.
fn sampled<'a>(
    uniform: &'a Uniform,
    absent: &'a mut [Vec<bool>; 2],
) -> [(Channel, &'a [f64], &'a mut Vec<bool>); 2] {
    let [displacement, force] = absent;
    [
        (Channel::Displacement, &uniform.displacement, displacement),
        (Channel::Force, &uniform.force, force),
    ]
}

/// Marks the samples of `more` too.
fn mark(marked: &mut [bool], more: &[bool]) {
    for (marked, more) in marked.iter_mut().zip(more) {
        *marked |= more;
    }
}

/// Runs of `true`.
fn runs(marked: &[bool]) -> Vec<std::ops::Range<usize>> {
    let mut runs = Vec::new();
    let mut index = 0;
    while index < marked.len() {
        if !marked[index] {
            index += 1;
            continue;
        }
        let start = index;
        while index < marked.len() && marked[index] {
            index += 1;
        }
        runs.push(start..index);
    }
    runs
}

/// The value below which `part` (0…1) of `values` lie; 0 for no values.
fn quantile(values: &mut [f64], part: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let place = ((values.len() - 1) as f64 * part).round() as usize;
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}

/// Median of the `2·half + 1` values around each; those nearer to an end than `half` stay.
fn median_filtered(values: &[f64], half: usize) -> Vec<f64> {
    let mut filtered = values.to_vec();
    let mut window = vec![0.0; 2 * half + 1];
    for (index, around) in values.windows(2 * half + 1).enumerate() {
        window.copy_from_slice(around);
        filtered[index + half] = *window.select_nth_unstable_by(half, f64::total_cmp).1;
    }
    filtered
}

/// Spread of a channel: the range about the median that contains nine tenths of its samples.
fn spread(values: &[f64]) -> f64 {
    let median = quantile(&mut values.to_vec(), 0.5);
    let mut apart: Vec<f64> = values.iter().map(|value| (value - median).abs()).collect();
    quantile(&mut apart, FaultsPolicy::in_use().usually)
}
