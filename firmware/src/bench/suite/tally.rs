//! Regions, their callers, and the results of many calls.

use core::fmt;

use mesh_damper::cycle::Cycle;

/// A region to count: a call with a context, which holds its state, and up to two numbers.
pub type Region<C> = extern "C" fn(&mut C, f32, f32) -> f32;

/// Calls regions. On the target it counts their instructions; on the host it stores their results.
pub trait Meter {
    /// One call: its instructions without those of the call itself, and its result.
    fn call<C>(&mut self, region: Region<C>, context: &mut C, a: f32, b: f32) -> (u32, f32);

    /// Reports the results of the calls under `name`.
    fn report(&mut self, name: impl fmt::Display, when: &str, tally: &Tally);
}

/// The results of many calls.
#[derive(Clone, Copy, Debug)]
pub struct Tally {
    /// Calls.
    pub calls: u32,
    /// Instructions of all.
    pub sum: u64,
    /// Instructions of the shortest call.
    pub least: u32,
    /// Instructions of the longest call.
    pub most: u32,
    /// Checksum over the bits of all results.
    pub checksum: u32,
}

impl Default for Tally {
    /// No calls yet.
    fn default() -> Self {
        Self {
            calls: 0,
            sum: 0,
            least: u32::MAX,
            most: 0,
            checksum: 0x811c_9dc5,
        }
    }
}

impl Tally {
    /// Adds one call.
    pub fn add(&mut self, (instructions, result): (u32, f32)) {
        self.calls += 1;
        self.sum += u64::from(instructions);
        self.least = self.least.min(instructions);
        self.most = self.most.max(instructions);
        self.include(result);
    }

    /// Adds one result (FNV-1a over words).
    pub fn include(&mut self, result: f32) {
        self.checksum = (self.checksum ^ result.to_bits()).wrapping_mul(0x0100_0193);
    }

    /// The results of a cycle.
    pub fn include_cycle(&mut self, cycle: &Cycle) {
        for result in [cycle.stiffness, cycle.energy, cycle.loss_factor] {
            self.include(result);
        }
    }
}

/// The moment of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum When {
    /// The amplitude is changing.
    Ramp,
    /// At full amplitude.
    Steady,
    /// Steady, the first tick of a cycle, which computes the results of the previous one.
    CycleEnd,
    /// Steady, in the ticks after new coefficients came into force.
    Swap,
    /// The programme is over.
    Done,
}

impl When {
    /// From the generator's data about a tick.
    pub fn of(done: bool, ramp: bool, cycle_end: bool) -> Self {
        match (done, ramp, cycle_end) {
            (true, ..) => Self::Done,
            (_, true, _) => Self::Ramp,
            (.., true) => Self::CycleEnd,
            _ => Self::Steady,
        }
    }
}

/// A tally for each moment of a tick.
#[derive(Default)]
pub struct Moments {
    ramp: Tally,
    steady: Tally,
    cycle_end: Tally,
    swap: Tally,
}

impl Moments {
    /// Adds one tick, and the cycle that ended with it.
    pub fn add(&mut self, when: When, result: (u32, f32), cycle: Option<&Cycle>) {
        let tally = match when {
            When::Ramp => &mut self.ramp,
            When::Steady => &mut self.steady,
            When::CycleEnd => &mut self.cycle_end,
            When::Swap => &mut self.swap,
            When::Done => return,
        };
        tally.add(result);
        if let Some(cycle) = cycle {
            tally.include_cycle(cycle);
        }
    }

    /// Reports under `name`, with one line for each moment.
    pub fn report(&self, meter: &mut impl Meter, name: &str) {
        if self.ramp.calls > 0 {
            meter.report(name, "ramp", &self.ramp);
        }
        meter.report(name, "steady", &self.steady);
        meter.report(name, "cycle-end", &self.cycle_end);
        if self.swap.calls > 0 {
            meter.report(name, "swap", &self.swap);
        }
    }
}
