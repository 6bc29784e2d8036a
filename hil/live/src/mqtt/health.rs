//! A summary of the test since the last health message.

use serde_json::{Value, json};

use crate::values::{CycleResult, Event, Sample, State};

/// Collects the contents of a health message.
#[derive(Clone, Debug)]
pub(super) struct Health {
    state: State,
    time: f64,
    samples: u64,
    displacement: [f32; 2],
    force: [f32; 2],
    cycle: Option<CycleResult>,
    faults: Vec<String>,
    notices: Vec<String>,
}

/// Smallest and largest of an empty set.
const NONE: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

impl Default for Health {
    fn default() -> Self {
        Self {
            state: State::default(),
            time: 0.0,
            samples: 0,
            displacement: NONE,
            force: NONE,
            cycle: None,
            faults: Vec::new(),
            notices: Vec::new(),
        }
    }
}

impl Health {
    /// Samples so far.
    pub(super) fn samples(&self) -> u64 {
        self.samples
    }

    pub(super) fn sample(&mut self, sample: &Sample) {
        self.time = sample.time;
        self.samples += 1;
        let widen = |[least, most]: [f32; 2], value: f32| [least.min(value), most.max(value)];
        self.displacement = widen(self.displacement, sample.displacement);
        self.force = widen(self.force, sample.force);
    }

    pub(super) fn cycle(&mut self, cycle: &CycleResult) {
        self.cycle = Some(*cycle);
    }

    /// Each cause is listed once: a monitor has a limited number of them.
    pub(super) fn event(&mut self, event: &Event) {
        let named = if event.fault {
            &mut self.faults
        } else {
            &mut self.notices
        };
        if !named.contains(&event.cause) {
            named.push(event.cause.clone());
        }
    }

    pub(super) fn state(&mut self, state: &State) {
        self.state = state.clone();
    }

    /// As JSON; extremes start again.
    pub(super) fn take(&mut self, dropped: u64) -> Value {
        let state = self.state.to_json();
        let of_cycle = |value: fn(&CycleResult) -> f32| self.cycle.as_ref().map(value);
        let health = json!({
            "state": state["state"],
            "time_s": self.time,
            "samples": self.samples,
            "cycle": self.cycle.map(|cycle| cycle.cycle),
            "displacement_min_mm": self.displacement[0],
            "displacement_max_mm": self.displacement[1],
            "force_min_kN": self.force[0],
            "force_max_kN": self.force[1],
            "temperature_degC": of_cycle(|cycle| cycle.temperature),
            "law_error": of_cycle(|cycle| cycle.error),
            "faults": self.faults,
            "notices": self.notices,
            "messages_dropped": dropped,
        });
        self.displacement = NONE;
        self.force = NONE;
        health
    }
}
