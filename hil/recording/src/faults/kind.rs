//! The kinds of channel faults, and their words.

use mesh_damper_tables::channel::Channel;

use crate::words::counted;

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
    /// Times whose steps differ by design: short in a ramp, long in a hold.
    Uneven {
        /// The shortest step, s.
        shortest: f64,
        /// The longest, s.
        longest: f64,
        /// The equal steps to which the channels were interpolated, s.
        period: f64,
    },
    /// Rows that were written only where a value changed.
    ChangesOnly {
        /// Samples without a row.
        samples: usize,
    },
    /// A clock that was put back or forward, or a counter of time that began again.
    ClockSet {
        /// The change, s: below 0 if time was put back.
        change: f64,
        /// Number of changes.
        times: usize,
        /// Whether a counter began again, whose range is the change.
        is_counter: bool,
    },
    /// Times that were written with too few digits, so that samples share a time.
    Stamps {
        /// The time between samples, s, spread evenly.
        period: f64,
    },
    /// Rows of zeros behind the last sample.
    Zeros {
        /// Number of rows.
        samples: usize,
    },
    /// A channel without a value in some rows, which needs none in each.
    Blank {
        /// Number of rows.
        samples: usize,
    },
    /// A channel that has a new value in some rows only.
    Slower {
        /// Rows per new value; a slower converter need not give a whole number.
        rows: f64,
        /// What stands in the other rows.
        between: Between,
    },
    /// A displacement whose counter began again at the end of its range.
    Counter {
        /// The range, mm.
        range: f64,
        /// How often it began again.
        times: usize,
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
    /// Displacement and force in each other's columns.
    Exchanged {
        /// Whether they were exchanged back; otherwise the force may be late instead.
        repaired: bool,
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

/// What stands in the rows in which a slower channel has no new value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// Nothing.
    Nothing,
    /// The value before.
    Held,
    /// Values on the line to the next one.
    Interpolated,
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
            ChannelFaultKind::Uneven {
                shortest,
                longest,
                period,
            } => write!(
                f,
                "the steps of time are uneven, {shortest:.3e} to {longest:.3e} s: the channels were interpolated to steps of {period:.3e} s; \
                 between samples farther apart the force was left out"
            ),
            ChannelFaultKind::ChangesOnly { samples } => write!(
                f,
                "rows are written only where a value changed: in {} between them the channels keep their values",
                counted(samples)
            ),
            ChannelFaultKind::ClockSet {
                change,
                times,
                is_counter: true,
            } => write!(
                f,
                "the counter of time began again {}, after {:.6} s; time was continued",
                often(times),
                change.abs()
            ),
            ChannelFaultKind::ClockSet { change, times, .. } => write!(
                f,
                "the clock was put {} by {:.0} s, {}, as to or from summer time; time was continued",
                if change < 0.0 { "back" } else { "forward" },
                change.abs(),
                often(times)
            ),
            ChannelFaultKind::Stamps { period } => write!(
                f,
                "several samples share a time, which has too few digits; they were spread evenly, at {:.6} Hz",
                1.0 / period
            ),
            ChannelFaultKind::Zeros { samples } => write!(
                f,
                "rows of zeros at the end: {}, left out",
                counted(samples)
            ),
            ChannelFaultKind::Blank { samples } => write!(
                f,
                "the {channel} is empty in {}; it was interpolated there",
                rows_of(samples)
            ),
            ChannelFaultKind::Slower { rows, between } => write!(
                f,
                "the {channel} is new in every {}row only, {}; only these rows are used",
                every(rows),
                match between {
                    Between::Nothing => "and empty between",
                    Between::Held => "and held between",
                    Between::Interpolated => "and interpolated between",
                }
            ),
            ChannelFaultKind::Counter { range, times } => write!(
                f,
                "the counter of the {channel} began again {} at the end of its range of {range:.6} {}; the channel was continued",
                often(times),
                self.channel.unit()
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
                "channels shifted in time: the force is {} by {:.2} ms{}, which is impossible for a passive damper; the shift was corrected",
                if late < 0.0 { "early" } else { "late" },
                1e3 * late.abs(),
                if late < 0.0 {
                    ", as beside a displacement that is late or behind a filter"
                } else {
                    ""
                }
            ),
            ChannelFaultKind::Exchanged { repaired: true } => write!(
                f,
                "displacement and force exchanged: as recorded, the specimen would deliver energy in every block, and its motion would \
                 be rougher than its force; they were exchanged back. Correct the columns' names, or give \
                 --channel displacement=… --channel force=…"
            ),
            ChannelFaultKind::Exchanged { repaired: false } => write!(
                f,
                "displacement and force may be exchanged, or the force is late: as recorded, the specimen delivers energy in every \
                 block; check the columns' names"
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
pub(crate) fn listed(faults: &[ChannelFault]) -> String {
    let texts: Vec<String> = faults.iter().map(ChannelFault::to_string).collect();
    texts.join("; ")
}

fn was(samples: usize) -> String {
    let verb = if samples == 1 { "was" } else { "were" };
    format!("{} {verb}", counted(samples))
}

fn often(times: usize) -> String {
    match times {
        1 => "once".into(),
        times => format!("{times} times"),
    }
}

fn rows_of(count: usize) -> String {
    format!("{count} {}", if count == 1 { "row" } else { "rows" })
}

/// `5th `, or `3.33rd ` as a mean.
fn every(rows: f64) -> String {
    let whole = rows.round();
    if (rows - whole).abs() > 0.005 {
        return format!("{rows:.2}th ");
    }
    let end = match whole as usize {
        2 => "2nd",
        3 => "3rd",
        count => return format!("{count}th "),
    };
    format!("{end} ")
}

fn stretches_of(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
