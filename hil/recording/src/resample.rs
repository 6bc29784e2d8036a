//! A recording on a uniform time base.

use mesh_damper_output::error::InputError;
use mesh_damper_tables::control::ControlChannel;
use mesh_damper_tables::units::Unit;

use super::Recording;
use super::clock::{Clock, MOST_TICKS, MOST_TICKS_PER_SAMPLE};
use crate::faults::held::smallest_step;
use crate::faults::kind::ChannelFault;
use crate::words::plain;

crate::numbers! {
    /// How a recording is brought to equal steps.
    ResamplePolicy {
        /// If the samples lie off the ticks, channels are interpolated by cubics across time steps of up to this many periods; longer steps
        /// are gaps.
        longest: f64 = 2.2, Derived("two periods, and a tenth of each for jitter");
        /// If the samples lie on the ticks, channels are interpolated by cubics across time steps of up to this many periods; longer steps
        /// are gaps.
        longest_on_ticks: f64 = 1.5, Derived("between one period and two");
        /// A logger writes rows only where a value changes if it leaves out at least this fraction of the samples, never repeats a row, and
        /// goes on after this fraction of the gaps with the next value of the converter.
        changes_only: [f64; 2] = [0.25, 0.9],
            Convention("otherwise the gaps are few, or values change across them as they do in time");
        /// The next value of a converter is within this many of its steps.
        next_value: f64 = 1.5, Derived("between one step and two");
    }
}

/// The channels of a recording at equal steps of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Uniform {
    /// Time of the first tick, s.
    pub start: f64,
    /// Time between ticks, s.
    pub period: f64,
    /// Displacement, mm, one per tick.
    pub displacement: Vec<f64>,
    /// Force, kN, one per tick.
    pub force: Vec<f64>,
    /// Velocity, mm/s, one per tick, if the recording has it.
    pub velocity: Option<Vec<f64>>,
    /// Temperature, °C, one per tick, if the recording has it.
    pub temperature: Option<Vec<f64>>,
    /// Control inputs, one value per tick.
    pub controls: Vec<ControlChannel>,
    /// Whether there are samples about this tick; false inside a gap, where the channels are straight lines.
    pub measured: Vec<bool>,
    /// Whether the recording's samples were off the ticks, so that the channels are interpolated.
    pub interpolated: bool,
    clock: Clock,
}

impl Uniform {
    /// Number of ticks.
    pub fn len(&self) -> usize {
        self.displacement.len()
    }

    /// Whether there are no ticks; never true for a result of [`Recording::uniform`].
    pub fn is_empty(&self) -> bool {
        self.displacement.is_empty()
    }

    /// Time of a tick, s.
    pub fn time(&self, tick: usize) -> f64 {
        self.start + tick as f64 * self.period
    }

    /// `values`, one per tick, converted back from [`Recording::uniform`] to the recording's own times.
    pub fn at_samples_of(&self, recording: &Recording, values: &[f64]) -> Vec<f64> {
        if self.interpolated {
            let ticks: Vec<f64> = (0..values.len()).map(|tick| self.time(tick)).collect();
            interpolate(
                &ticks,
                values,
                recording.time.iter().copied(),
                f64::INFINITY,
            )
        } else {
            let last = values.len().saturating_sub(1);
            let ticks = self.clock.ticks.iter();
            ticks.map(|&tick| values[tick.min(last)]).collect()
        }
    }

    /// Whether the steps of the recording's times are uneven by design, so that no sample is missing in a long one.
    pub(crate) fn is_uneven(&self) -> bool {
        self.clock.uneven.is_some()
    }

    /// The faults of the recording's times: jitter and missing samples.
    pub fn faults(&self) -> Vec<ChannelFault> {
        self.clock.faults()
    }
}

impl Recording {
    /// Time between samples, s, independent of jitter, gaps and the rounding of printed times.
    pub fn sample_period(&self) -> f64 {
        self.clock().period
    }

    /// Gaps: the index of the sample before each, and the number of samples missing there.
    pub fn gaps(&self) -> Vec<(usize, usize)> {
        self.clock().gaps()
    }

    fn clock(&self) -> Clock {
        let mut clock = Clock::of(&self.time, &self.displacement);
        clock.holds = clock.on_ticks && self.writes_changes_only(&clock);
        clock
    }

    /// Whether a row was written only where a value changed: then the samples between are no gaps.
    fn writes_changes_only(&self, clock: &Clock) -> bool {
        let ResamplePolicy {
            changes_only: [least, most],
            next_value,
            ..
        } = *ResamplePolicy::in_use();
        let gaps = clock.gaps();
        let missing: usize = gaps.iter().map(|(_, missing)| missing).sum();
        if (missing as f64) < least * (self.len() + missing) as f64 {
            return false;
        }
        let changing = [&self.displacement, &self.force];
        let others = self.velocity.iter().chain(&self.temperature);
        let others = others.chain(self.controls.iter().map(|control| &control.values));
        let all: Vec<&Vec<f64>> = changing.into_iter().chain(others).collect();
        let repeats = |index: usize| all.iter().all(|each| each[index] == each[index + 1]);
        if (0..self.len() - 1).any(repeats) {
            return false;
        }
        let steps = changing.map(|values| next_value * smallest_step(values, 0.0));
        let goes_on = |index: usize| {
            let mut each = changing.iter().zip(steps);
            each.all(|(values, step)| (values[index + 1] - values[index]).abs() <= step)
        };
        let going_on = gaps.iter().filter(|(before, _)| goes_on(*before)).count();
        going_on as f64 >= most * gaps.len() as f64
    }

    /// The recording at equal steps of [`Recording::sample_period`].
    ///
    /// Samples on the ticks are used directly, and so are those that according to the displacement were taken on the ticks although
    /// their times jitter. If the samples themselves jitter, the channels are interpolated by a cubic through each tick's
    /// neighbours, and temperature and control inputs linearly. Gaps are bridged by straight lines and marked.
    ///
    /// # Errors
    /// The line of the longest gap, if the recording is mostly gaps.
    pub fn uniform(&self) -> Result<Uniform, InputError> {
        let clock = self.clock();
        let period = clock.period;
        let start = self.time[0];
        let last = self.len() - 1;
        let tick_of = |sample: usize| {
            if clock.on_ticks {
                clock.ticks[sample]
            } else {
                ((self.time[sample] - start) / period).round() as usize
            }
        };
        let most_gaps = MOST_TICKS_PER_SAMPLE * self.len();
        if tick_of(last) > most_gaps.max(MOST_TICKS) {
            return Err(self.mostly_gaps(period));
        }
        let ticks = tick_of(last) + 1;
        let time = (0..ticks).map(|tick| start + tick as f64 * period);
        let nodes: Vec<f64> = if clock.on_ticks {
            let on_tick = |&tick: &usize| start + tick as f64 * period;
            clock.ticks.iter().map(on_tick).collect()
        } else {
            self.time.clone()
        };
        let longest = if clock.uneven.is_some() {
            // The steps are long where the motion is slow.
            f64::INFINITY
        } else if clock.on_ticks {
            ResamplePolicy::in_use().longest_on_ticks
        } else {
            ResamplePolicy::in_use().longest
        } * period;
        let until_next = |values: &[f64]| -> Vec<f64> {
            let ends = clock.ticks.iter().skip(1).chain([&ticks]);
            let each = values.iter().zip(clock.ticks.iter().zip(ends));
            each.flat_map(|(value, (from, to))| std::iter::repeat_n(*value, to - from))
                .collect()
        };
        let across = |values: &[f64], longest: f64| match clock.holds {
            true => until_next(values),
            false => interpolate(&nodes, values, time.clone(), longest),
        };
        let channel = |values: &[f64]| across(values, longest);
        // A cubic overshoots where an input is switched; a line stays between the values.
        let by_lines = |values: &[f64]| across(values, 0.0);
        let mut measured = vec![true; ticks];
        let gaps = if clock.holds {
            Vec::new()
        } else {
            clock.gaps()
        };
        for (before, _) in gaps {
            let (first, end) = (tick_of(before) + 1, tick_of(before + 1));
            measured[first.min(end)..end].fill(false);
        }
        Ok(Uniform {
            start,
            period,
            displacement: channel(&self.displacement),
            force: channel(&self.force),
            velocity: self.velocity.as_deref().map(channel),
            temperature: self.temperature.as_deref().map(by_lines),
            controls: {
                let each = self.controls.iter();
                each.map(|control| ControlChannel {
                    name: control.name.clone(),
                    values: by_lines(&control.values),
                })
                .collect()
            },
            measured,
            interpolated: !clock.on_ticks,
            clock,
        })
    }

    fn mostly_gaps(&self, period: f64) -> InputError {
        let step = |index: usize| self.time[index] - self.time[index - 1];
        let longest = (1..self.len())
            .max_by(|&a, &b| step(a).total_cmp(&step(b)))
            .unwrap_or(1);
        let Unit { symbol, scale, .. } = self.units.time;
        InputError::new(
            &self.name,
            format!(
                "time jumps by {} {symbol} here where samples are {} {symbol} apart",
                plain(step(longest) / scale),
                plain(period / scale)
            ),
            "write what comes before and after into two files, or check the unit of the time column",
        )
        .at(self.lines.place(longest, None))
    }
}

/// `values` at `nodes` (strictly increasing, at least two) interpolated at the times `at` (increasing).
///
/// A cubic Hermite whose slope at a node is that of the parabola through it and its neighbours. Its error is of third order, and it
/// amplifies noise by no more than a quarter. Linear across steps above `longest`.
pub(crate) fn interpolate(
    nodes: &[f64],
    values: &[f64],
    at: impl Iterator<Item = f64>,
    longest: f64,
) -> Vec<f64> {
    let secant = |i: usize| (values[i + 1] - values[i]) / (nodes[i + 1] - nodes[i]);
    let close = |i: usize| nodes[i + 1] - nodes[i] <= longest;
    let last = nodes.len() - 2;
    // Slope at node `i` seen from the step `from`; a step beyond a gap is not used.
    let slope = |i: usize, from: usize| {
        let other = if i == from {
            i.checked_sub(1)
        } else {
            Some(i).filter(|&i| i <= last)
        };
        let Some(other) = other.filter(|&other| close(other)) else {
            return secant(from);
        };
        let (h_from, h_other) = (
            nodes[from + 1] - nodes[from],
            nodes[other + 1] - nodes[other],
        );
        (secant(from) * h_other + secant(other) * h_from) / (h_from + h_other)
    };
    let mut step = 0;
    at.map(|time| {
        while step < last && nodes[step + 1] <= time {
            step += 1;
        }
        let width = nodes[step + 1] - nodes[step];
        let u = ((time - nodes[step]) / width).clamp(0.0, 1.0);
        let (from, to) = (values[step], values[step + 1]);
        if !close(step) {
            return from + u * (to - from);
        }
        let (start, end) = (slope(step, step) * width, slope(step + 1, step) * width);
        let (u2, u3) = (u * u, u * u * u);
        from * (1.0 - 3.0 * u2 + 2.0 * u3)
            + to * (3.0 * u2 - 2.0 * u3)
            + start * (u - 2.0 * u2 + u3)
            + end * (u3 - u2)
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_damper_output::error::Place;
    use std::f64::consts::TAU;

    fn sine(times: &[f64]) -> Recording {
        let wave = |t: &f64| (TAU * t).sin();
        let displacement = times.iter().map(wave).collect();
        let force = times.iter().map(|t| 2.0 * wave(t)).collect();
        Recording::new("sine", times.to_vec(), displacement, force).unwrap()
    }

    #[test]
    fn samples_on_the_ticks_are_taken_as_they_are() {
        // 1/300 s printed with four decimals.
        let times: Vec<f64> = (0..3000)
            .map(|i| (f64::from(i) / 300.0 * 1e4).round() / 1e4)
            .collect();
        let recording = sine(&times);
        // The last printed time has an error of at most 5e-5 s in 10 s.
        assert!((recording.sample_period() * 300.0 - 1.0).abs() < 1e-5);
        let uniform = recording.uniform().unwrap();
        assert!(!uniform.interpolated);
        let worst = uniform
            .displacement
            .iter()
            .zip(&recording.displacement)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        // The last bits of a node's time: u differs from 0 by about 1e-12.
        assert!(worst < 1e-9, "{worst}");
        assert_eq!(uniform.len(), recording.len());
        assert_eq!(
            uniform.at_samples_of(&recording, &uniform.force).len(),
            recording.len()
        );
    }

    #[test]
    fn a_jittering_time_base_is_interpolated_there_and_back() {
        // 500 samples a second, each up to 0.4 of a step late: 0.1, 0.2, 0.3, 0.4, 0 and again.
        let times: Vec<f64> = (0..2000)
            .map(|i| (f64::from(i) + 0.1 * f64::from((i * 3) % 5)) / 500.0)
            .collect();
        let recording = sine(&times);
        let uniform = recording.uniform().unwrap();
        assert!(uniform.interpolated);
        assert!(uniform.measured.iter().all(|&measured| measured));
        let there = |tick: usize| (TAU * uniform.time(tick)).sin();
        let worst = (0..uniform.len())
            .map(|tick| (uniform.displacement[tick] - there(tick)).abs())
            .fold(0.0, f64::max);
        // Slopes are of second order: h²·ω³/6·h/4 at the middle of a step, h up to 1.4/500 s: 2.3e-7 of amplitude 1.
        assert!(worst < 3e-7, "{worst}");
        let back = uniform.at_samples_of(&recording, &uniform.displacement);
        let worst = back
            .iter()
            .zip(&recording.displacement)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(worst < 6e-7, "{worst}");
    }

    #[test]
    fn a_gap_is_counted_bridged_and_marked() {
        let times: Vec<f64> = (0..1000)
            .filter(|i| !(400..410).contains(i))
            .map(|i| f64::from(i) / 100.0)
            .collect();
        let recording = sine(&times);
        assert_eq!(recording.gaps(), vec![(399, 10)]);
        let uniform = recording.uniform().unwrap();
        assert_eq!(uniform.len(), 1000);
        let missing: Vec<usize> = (0..1000).filter(|&i| !uniform.measured[i]).collect();
        assert_eq!(missing, (400..410).collect::<Vec<_>>());
        let middle = 0.5 * (recording.displacement[399] + recording.displacement[400]);
        let bridged = 0.5 * (uniform.displacement[404] + uniform.displacement[405]);
        assert!((bridged - middle).abs() < 1e-9);
        assert!((uniform.displacement[411] - recording.displacement[401]).abs() < 1e-9);
    }

    #[test]
    fn a_jump_of_time_is_refused_at_its_sample() {
        let mut times: Vec<f64> = (0..100).map(|i| f64::from(i) / 100.0).collect();
        times.push(1e9);
        let error = sine(&times).uniform().unwrap_err();
        let place = Place::Sample(Box::new((101, None)));
        assert_eq!(error.place, place);
    }
}
