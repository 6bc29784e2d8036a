//! A sensor with its amplifier: lag, gain, offset, noise; the converter after it quantizes.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{InvalidField, not_negative, positive};

/// Properties of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorConfig {
    /// The quantity (mm, kN) that gives 10.24 V.
    pub full_scale: f64,
    /// Standard deviation of white noise at the tick rate, in the quantity's unit.
    pub noise: f64,
    /// Offset added to the quantity, in its unit.
    pub offset: f64,
    /// Time constant of its first-order lag, s; 0 for none.
    pub lag: f64,
}

/// Fault of a sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SensorFault {
    /// No fault.
    #[default]
    None,
    /// It keeps its value.
    Stuck,
    /// A broken wire: the amplifier's input is pulled beyond its range, to 12 V.
    Open,
    /// A broken wire to an amplifier whose input is held at ground: 0 V.
    DroppedOut,
    /// The amplifier limits its output to that of this quantity, in either direction.
    Clipped(f64),
    /// One sample in `every` has this quantity added to it.
    Spiking {
        /// In the quantity's unit.
        size: f64,
        /// Distance from one spike to the next, samples.
        every: u64,
    },
    /// Its offset grows by this much per sample, in the quantity's unit.
    Drifting(f64),
}

/// A running sensor.
#[derive(Clone, Debug)]
pub struct Sensor {
    config: SensorConfig,
    /// Part that the lag passes in one step, 1 − e^(−step/lag).
    share: f64,
    lagged: f64,
    volts: f64,
    random: ChaCha8Rng,
    /// Number of samples with a fault.
    faulty: u64,
    /// May be set while running.
    pub fault: SensorFault,
}

/// V at full scale.
const OUTPUT: f64 = 10.24;
const OPEN: f64 = 12.0;

impl Sensor {
    /// * `step`: s between two samples
    /// * `seed`, `stream`: of the noise
    ///
    /// # Errors
    /// A full scale that is not positive, a negative noise or lag, or a value that is not finite.
    pub fn new(
        config: SensorConfig,
        step: f64,
        seed: u64,
        stream: u64,
    ) -> Result<Self, InvalidField> {
        positive("step", step)?;
        positive("full_scale", config.full_scale)?;
        not_negative("noise", config.noise)?;
        not_negative("lag", config.lag)?;
        super::check("offset", config.offset, "finite", true)?;
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(stream);
        Ok(Self {
            config,
            share: if config.lag > 0.0 {
                -(-step / config.lag).exp_m1()
            } else {
                1.0
            },
            lagged: 0.0,
            volts: 0.0,
            random,
            faulty: 0,
            fault: SensorFault::None,
        })
    }

    /// Output voltage for the quantity `value`.
    pub fn sample(&mut self, value: f64) -> f64 {
        self.lagged += self.share * (value - self.lagged);
        let noise: f64 = StandardNormal.sample(&mut self.random);
        let shown = self.lagged + self.config.offset + self.config.noise * noise;
        if self.fault != SensorFault::None {
            self.faulty += 1;
        }
        let shown = match self.fault {
            SensorFault::None => shown,
            SensorFault::Stuck => return self.volts,
            SensorFault::Open => OPEN / OUTPUT * self.config.full_scale,
            SensorFault::DroppedOut => 0.0,
            SensorFault::Clipped(most) => shown.clamp(-most, most),
            SensorFault::Spiking { size, every } if self.faulty.is_multiple_of(every) => {
                shown + size
            }
            SensorFault::Spiking { .. } => shown,
            SensorFault::Drifting(step) => shown + step * self.faulty as f64,
        };
        self.volts = shown * (OUTPUT / self.config.full_scale);
        self.volts
    }
}
