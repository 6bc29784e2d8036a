//! Interference with the signals between the plant and its controller, and with the clock that calls the controller.
//!
//! The rig in this process and the image in lockstep both pass every signal through [`Signals`], so that the same interference acts
//! on both.

mod channel;
mod other;

pub use channel::OnChannel;
pub use other::{OnClock, OnOutput, OnTemperature};

use mesh_damper::effects::CONTROLS;
use mesh_damper::health::Channel;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Interference that acts on a signal while it is active.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interference {
    /// With the voltage of a channel.
    Channel(Channel, OnChannel),
    /// The cables of displacement and force are swapped.
    Swapped,
    /// With the temperature for the controller.
    Temperature(OnTemperature),
    /// Sets every control input for the controller to this value.
    Controls(f32),
    /// With the output to the servo amplifier.
    Output(OnOutput),
    /// With the calls of the controller.
    Clock(OnClock),
    /// The other end of the controller's link is no longer heard.
    Silence,
}

/// Identifies an active interference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Begun(u64);

/// An active interference.
#[derive(Clone, Copy, Debug)]
struct Active {
    begun: Begun,
    what: Interference,
    /// Ticks for which it has acted.
    ticks: u64,
    /// Value of a frozen signal, V.
    held: f64,
    /// Remaining samples of a drop-out.
    left: u32,
}

/// The two channels at a sample, V: displacement, then force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensed {
    /// Output of the sensors.
    pub put_out: [f64; 2],
    /// Input of the converter.
    pub arrived: [f64; 2],
}

/// The signals of a plant, and the interferences in the order in which they began.
#[derive(Clone, Debug)]
pub struct Signals {
    active: Vec<Active>,
    count: u64,
    random: ChaCha8Rng,
    sensed: Sensed,
}

/// Stream of the seed's random numbers; those before it belong to the sensors.
const STREAM: u64 = 2;

impl Signals {
    /// Signals without interference.
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(STREAM);
        Self {
            active: Vec::new(),
            count: 0,
            random,
            sensed: Sensed::default(),
        }
    }

    /// From the next tick on `what` acts, after the interferences that are active.
    pub fn begin(&mut self, what: Interference) -> Begun {
        let begun = Begun(self.count);
        self.count += 1;
        self.active.push(Active {
            begun,
            what,
            ticks: 0,
            held: 0.0,
            left: 0,
        });
        begun
    }

    /// Ends it.
    pub fn end(&mut self, begun: Begun) {
        self.active.retain(|active| active.begun != begun);
    }

    /// The last sample.
    pub fn sensed(&self) -> Sensed {
        self.sensed
    }

    /// Whether the other end of the link is still heard.
    pub fn is_heard(&self) -> bool {
        let silent = |active: &Active| active.what == Interference::Silence;
        !self.active.iter().any(silent)
    }

    /// Voltages that arrive for the outputs `put_out` at `time` s.
    pub(crate) fn channels(&mut self, put_out: [f64; 2], time: f64) -> [f64; 2] {
        let mut arrived = put_out;
        for active in &mut self.active {
            match active.what {
                Interference::Channel(channel, on) => {
                    let volts = &mut arrived[usize::from(channel == Channel::Force)];
                    *volts = on.act(*volts, time, active, &mut self.random);
                    active.ticks += 1;
                }
                Interference::Swapped => arrived.swap(0, 1),
                _ => {}
            }
        }
        self.sensed = Sensed { put_out, arrived };
        arrived
    }

    /// Temperature that arrives for the true one, °C.
    pub(crate) fn temperature(&mut self, true_one: f64) -> f32 {
        let random = &mut self.random;
        self.active
            .iter()
            .fold(true_one as f32, |now, active| match active.what {
                Interference::Temperature(on) => on.act(now, random),
                _ => now,
            })
    }

    /// Control inputs that arrive.
    pub(crate) fn controls(&self, true_ones: [f32; CONTROLS]) -> [f32; CONTROLS] {
        self.active
            .iter()
            .fold(true_ones, |now, active| match active.what {
                Interference::Controls(value) => [value; CONTROLS],
                _ => now,
            })
    }

    /// Voltage and level at the servo, for the DAC's voltage and the enable line's level.
    pub(crate) fn output(&mut self, volts: f64, enabled: bool) -> (f64, bool) {
        let mut reaches = (volts, enabled);
        for active in &mut self.active {
            if let Interference::Output(on) = active.what {
                reaches = on.act(reaches, active);
                active.ticks += 1;
            }
        }
        reaches
    }

    /// Number of steps of the plant until the controller is called again.
    pub(crate) fn steps(&mut self) -> u32 {
        let mut steps = 1;
        for active in &mut self.active {
            if let Interference::Clock(on) = active.what {
                steps += on.missed(active.ticks);
                active.ticks += 1;
            }
        }
        steps
    }
}

#[cfg(test)]
mod tests;
