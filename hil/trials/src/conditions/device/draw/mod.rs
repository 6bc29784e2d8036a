//! The parameters of devices, by chance.
//!
//! Every range is without dimensions: over the largest amplitude, a middle angular frequency, and the stiffness of the frame, about 1.
//! The ranges are judgements of what devices of that kind have, wide enough that an effect may be anything from small to dominant.

mod soft;
mod solid;

use rand::seq::IndexedRandom;
use rand::{Rng, RngExt};

use super::elastic::Spring;
use super::fluid::{PowerDamper, Set};
use super::friction::Contact;
use super::hysteresis::{BoucWen, Slider, Sliders};
use super::rubber::Branch;
use super::{Family, Part};
use crate::blind::log_uniform;

/// The parts that are drawn, each with its factor.
pub struct Drawn<'a, R> {
    parts: Vec<(f64, Box<dyn Part>)>,
    rng: &'a mut R,
}

impl<'a, R: Rng> Drawn<'a, R> {
    /// Parts of a device of this kind.
    pub fn parts(family: Family, rng: &'a mut R) -> Vec<(f64, Box<dyn Part>)> {
        let mut drawn = Self {
            parts: Vec::new(),
            rng,
        };
        drawn.draw(family);
        drawn.parts
    }

    fn add(&mut self, part: impl Part + 'static) {
        self.parts.push((1.0, Box::new(part)));
    }

    fn log(&mut self, low: f64, high: f64) -> f64 {
        log_uniform(low, high, self.rng)
    }

    fn even(&mut self, low: f64, high: f64) -> f64 {
        self.rng.random_range(low..high)
    }

    fn chance(&mut self, part: f64) -> bool {
        self.rng.random_bool(part)
    }

    /// The spring of most devices, half of them with a cubic part, and half with a small viscous damper.
    fn frame(&mut self) {
        let k1 = self.even(0.3, 1.0);
        let k3 = if self.chance(0.5) {
            self.even(-0.2, 0.6)
        } else {
            0.0
        };
        let k3 = k3.max(-0.3 * k1);
        self.add(Spring { k1, k3 });
        if self.chance(0.5) {
            let c = self.log(0.01, 0.1);
            self.add(PowerDamper { c, alpha: 1.0 });
        }
    }

    fn bouc_wen(&mut self) -> BoucWen {
        BoucWen {
            force: self.log(0.1, 1.0),
            slip: self.log(0.03, 0.5),
            beta: self.even(0.5, 0.9),
            sharpness: self.even(1.0, 3.0),
            pinch: [0.0, 0.0, 1.0],
            loss: 0.0,
            envelope: [0.0; 2],
            z: 0.0,
            dissipated: 0.0,
            y: 0.0,
        }
    }

    fn sliders(&mut self, asymmetry: [f64; 2]) -> Sliders {
        let (first, last) = (self.log(0.01, 0.2), self.log(0.4, 2.0));
        let (force, power) = (self.log(0.2, 1.0), self.even(-1.0, 1.0));
        // Twelve slip distances are a curve, not corners, at the noise of the trials.
        const COUNT: i32 = 12;
        let slips =
            (0..COUNT).map(|i| first * (last / first).powf(f64::from(i) / f64::from(COUNT - 1)));
        let weights: Vec<f64> = slips.clone().map(|slip| slip.powf(power)).collect();
        let whole: f64 = weights.iter().sum();
        let sliders = slips.zip(weights).map(|(slip, weight)| {
            let limit = force * weight / whole;
            Slider {
                stiffness: limit / slip,
                limits: asymmetry.map(|factor| factor * limit),
                force: 0.0,
            }
        });
        Sliders {
            sliders: sliders.collect(),
            y: 0.0,
        }
    }

    fn branches(&mut self, count: usize, stiffness: f64) -> Vec<Branch> {
        let each = (0..count).map(|_| Branch {
            stiffness: stiffness * self.even(0.5, 1.0) / count as f64,
            time: self.log(0.05, 20.0),
            force: 0.0,
        });
        each.collect()
    }

    fn contact(&mut self) -> Contact {
        let friction = self.log(0.1, 1.0);
        Contact {
            friction,
            stiffness: friction / self.log(0.005, 0.1),
            load: [0.0; 2],
            wave: [0.0; 2],
            force: 0.0,
            y: 0.0,
        }
    }

    /// `part` with a force that the control input sets.
    fn set(&mut self, part: impl Part + 'static) {
        let idle = self.even(0.05, 0.4);
        let (gain, saturation) = (self.log(0.6, 3.0), self.log(0.5, 10.0));
        self.add(Set {
            part: Box::new(part),
            idle,
            gain,
            saturation,
        });
    }

    /// Two others; the second with 0.3 to 1 times its force.
    fn pair(&mut self) {
        let kinds: Vec<Family> = Family::beyond().sample(self.rng, 2).copied().collect();
        self.draw(kinds[0]);
        let first = self.parts.len();
        self.draw(kinds[1]);
        let factor = self.even(0.3, 1.0);
        for part in &mut self.parts[first..] {
            part.0 = factor;
        }
    }

    fn draw(&mut self, family: Family) {
        match family {
            Family::Linear => {
                let c = self.log(0.02, 1.0);
                self.add(Spring { k1: 1.0, k3: 0.0 });
                self.add(PowerDamper { c, alpha: 1.0 });
            }
            Family::MixedDamping => {
                let (k3, c, alpha) = (
                    self.even(-0.3, 2.0),
                    self.log(0.05, 1.0),
                    self.even(0.1, 1.0),
                );
                self.add(Spring { k1: 1.0, k3 });
                self.add(PowerDamper { c, alpha });
            }
            Family::Pair => self.pair(),
            Family::Maxwell
            | Family::Fractional
            | Family::FilledRubber
            | Family::Payne
            | Family::HydraulicMount => self.rubber(family),
            Family::ShockAbsorber
            | Family::SeriesOrifice
            | Family::MrBoucWen
            | Family::MrTanh
            | Family::AirSpring
            | Family::Warming => self.fluid(family),
            _ => self.solid(family),
        }
    }
}
