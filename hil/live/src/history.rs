//! History for pages that open late or are slow: rings of bounded length, with a position in each of them for every viewer.

use std::collections::VecDeque;

use crate::values::{CycleResult, Event, Sample, State};

/// The length of the history for pages that open late or are slow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Samples, after decimation.
    pub samples: usize,
    /// Cycles.
    pub cycles: usize,
    /// Events.
    pub events: usize,
    /// Samples that a page may lag behind before it skips ahead, after it has received the history from before its opening.
    pub behind: usize,
}

impl Default for Limits {
    /// 12 MiB of samples, which is 5 minutes of a sine at 10 kHz or more, and 4 MiB of cycles. A page may lag half a minute.
    fn default() -> Self {
        Self {
            samples: 1 << 19,
            cycles: 1 << 16,
            events: 1 << 10,
            behind: 1 << 16,
        }
    }
}

/// The last items of a sequence, up to a number.
#[derive(Debug)]
struct Ring<T> {
    items: VecDeque<T>,
    most: usize,
    /// Number of the first available item.
    first: u64,
}

impl<T: Clone> Ring<T> {
    fn new(most: usize) -> Self {
        Self {
            items: VecDeque::new(),
            most: most.max(1),
            first: 0,
        }
    }

    fn push(&mut self, item: T) {
        if self.items.len() == self.most {
            self.items.pop_front();
            self.first += 1;
        }
        self.items.push_back(item);
    }

    /// Number of the next item.
    fn end(&self) -> u64 {
        self.first + self.items.len() as u64
    }

    /// At most `most` items from number `next` on, or from the first available one; and the number of skipped items.
    fn take(&self, next: &mut u64, most: usize) -> (Vec<T>, u64) {
        let missed = self.first.saturating_sub(*next);
        *next = (*next).max(self.first);
        let from = (*next - self.first) as usize;
        let items: Vec<T> = self.items.iter().skip(from).take(most).cloned().collect();
        *next += items.len() as u64;
        (items, missed)
    }
}

/// The history of one test.
#[derive(Debug)]
pub(crate) struct History {
    limits: Limits,
    samples: Ring<Sample>,
    cycles: Ring<CycleResult>,
    events: Ring<Event>,
    state: State,
    /// Rises with every change of the state.
    states: u64,
}

/// The position of a viewer.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Place {
    sample: u64,
    cycle: u64,
    event: u64,
    state: u64,
    /// Up to this sample the viewer receives the history from before its opening, and may lag by its length.
    joined: u64,
}

/// Samples that a viewer received and missed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Delivered {
    /// Samples, after decimation, that were sent.
    pub samples: u64,
    /// Samples, after decimation, that were dropped because the viewer was too slow.
    pub missed: u64,
}

/// The next part for a viewer.
#[derive(Debug, Default)]
pub(crate) struct Part {
    pub(crate) samples: Vec<Sample>,
    /// Samples that were skipped immediately before these.
    pub(crate) missed: u64,
    pub(crate) cycles: Vec<CycleResult>,
    pub(crate) events: Vec<Event>,
    /// The state, if it has changed.
    pub(crate) state: Option<State>,
}

impl Part {
    pub(crate) fn is_empty(&self) -> bool {
        self.samples.is_empty()
            && self.missed == 0
            && self.cycles.is_empty()
            && self.events.is_empty()
            && self.state.is_none()
    }
}

/// Samples and cycles of one part.
pub(crate) const MOST_OF_A_PART: usize = 1 << 13;

impl History {
    pub(crate) fn new(limits: Limits) -> Self {
        Self {
            limits,
            samples: Ring::new(limits.samples),
            cycles: Ring::new(limits.cycles),
            events: Ring::new(limits.events),
            state: State::default(),
            states: 1,
        }
    }

    pub(crate) fn samples(&mut self, samples: &[Sample]) {
        samples.iter().for_each(|sample| self.samples.push(*sample));
    }

    pub(crate) fn cycle(&mut self, cycle: CycleResult) {
        self.cycles.push(cycle);
    }

    pub(crate) fn event(&mut self, event: Event) {
        self.events.push(event);
    }

    pub(crate) fn state(&mut self, state: State) {
        self.state = state;
        self.states += 1;
    }

    /// For a viewer that starts now. Items that the rings lost before do not count as missed.
    pub(crate) fn join(&self) -> Place {
        Place {
            sample: self.samples.first,
            cycle: self.cycles.first,
            event: self.events.first,
            state: 0,
            joined: self.samples.end(),
        }
    }

    /// The part after `place`, which moves on. Events and the state come last, so that the state "finished" follows everything
    /// else.
    pub(crate) fn next(&self, place: &mut Place) -> Part {
        let mut missed = 0;
        let behind = self.samples.end().saturating_sub(place.sample);
        if place.sample >= place.joined && behind > self.limits.behind as u64 {
            missed = behind;
            place.sample = self.samples.end();
        }
        let (samples, more) = self.samples.take(&mut place.sample, MOST_OF_A_PART);
        let (cycles, _) = self.cycles.take(&mut place.cycle, MOST_OF_A_PART);
        let (events, _) = self.events.take(&mut place.event, MOST_OF_A_PART);
        let is_whole = place.sample == self.samples.end() && place.cycle == self.cycles.end();
        let state = (is_whole && place.state != self.states).then(|| {
            place.state = self.states;
            self.state.clone()
        });
        Part {
            samples,
            missed: missed + more,
            cycles,
            events,
            state,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn at(tick: u64) -> Sample {
        Sample {
            time: tick as f64,
            ..Sample::default()
        }
    }

    proptest! {
        /// Whenever a viewer starts and however slow it is, it receives every sample since its start once, in order, or the sample
        /// counts as missed.
        #[test]
        fn every_sample_is_given_once_or_counted(
            samples in 1_usize..50,
            behind in 1_usize..60,
            join_after in 0_u64..40,
            pushes in prop::collection::vec(0_u64..30, 1..40),
        ) {
            let limits = Limits { samples, behind, ..Limits::default() };
            let mut history = History::new(limits);
            let mut tick = 0;
            for _ in 0..join_after {
                history.samples(&[at(tick)]);
                tick += 1;
            }
            let mut place = history.join();
            let first = place.sample;
            prop_assert_eq!(first, join_after.saturating_sub(samples as u64));
            let mut next = first;
            for count in pushes {
                for _ in 0..count {
                    history.samples(&[at(tick)]);
                    tick += 1;
                }
                let part = history.next(&mut place);
                next += part.missed;
                for sample in part.samples {
                    prop_assert_eq!(sample.time, next as f64);
                    next += 1;
                }
                prop_assert_eq!(next, place.sample);
            }
            prop_assert_eq!(next, tick);
            prop_assert!(history.next(&mut place).is_empty());
        }

        /// The rings never exceed their limits.
        #[test]
        fn memory_is_bounded(most in 0_usize..50, count in 0_u64..200) {
            let mut history = History::new(Limits { samples: most, ..Limits::default() });
            for tick in 0..count {
                history.samples(&[at(tick)]);
            }
            prop_assert!(history.samples.items.len() <= most.max(1));
            prop_assert_eq!(history.samples.end(), count);
        }
    }

    #[test]
    fn the_end_is_said_after_the_last_sample() {
        let mut history = History::new(Limits::default());
        let mut place = history.join();
        let ticks = 2 * MOST_OF_A_PART as u64 + 1;
        (0..ticks).for_each(|tick| history.samples(&[at(tick)]));
        history.state(State::Finished { time: 1.0 });
        let parts: Vec<Part> = (0..3).map(|_| history.next(&mut place)).collect();
        let states: Vec<bool> = parts.iter().map(|part| part.state.is_some()).collect();
        assert_eq!(states, [false, false, true]);
        assert!(history.next(&mut place).is_empty());
    }
}
