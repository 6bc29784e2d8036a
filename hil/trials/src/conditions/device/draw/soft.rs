//! Devices of rubber, oil and air.

use rand::{Rng, RngExt};

use super::super::Family;
use super::super::elastic::GasSpring;
use super::super::fluid::{
    AirChamber, BlowOff, InertiaTrack, PowerDamper, SeriesOrifice, TanhYield, Warming,
};
use super::super::rubber::{Berg, Branch, Maxwell, Payne};
use super::Drawn;

impl<R: Rng> Drawn<'_, R> {
    /// Rubber, and the hydraulic mount in rubber.
    pub(super) fn rubber(&mut self, family: Family) {
        self.frame();
        match family {
            Family::Maxwell => {
                let (count, stiffness) = (self.rng.random_range(1..=3), self.log(0.2, 2.0));
                let branches = self.branches(count, stiffness);
                self.add(Maxwell { branches });
            }
            Family::Fractional => {
                let (stiffness, alpha) = (self.log(0.05, 0.5), self.even(0.1, 0.7));
                // Two branches a decade over six decades about the trial's time: a ripple of a few per cent.
                let times = (-6..=6).map(|i| 10.0_f64.powf(0.5 * f64::from(i)));
                let branches = times.map(|time| Branch {
                    stiffness: stiffness * time.powf(-alpha),
                    time,
                    force: 0.0,
                });
                let branches = branches.collect();
                self.add(Maxwell { branches });
            }
            Family::FilledRubber => {
                let (most, half) = (self.log(0.05, 0.6), self.log(0.02, 0.4));
                self.add(Berg {
                    most,
                    half,
                    turned: [0.0; 2],
                    direction: 0.0,
                    y: 0.0,
                    force: 0.0,
                });
                let branches = self.branches(1, 0.5);
                self.add(Maxwell { branches });
            }
            Family::Payne => {
                let stiffness = self.log(0.5, 3.0);
                let branches = self.branches(3, stiffness);
                let (softening, recovery) = (self.log(0.5, 20.0), self.log(5.0, 60.0));
                self.add(Payne {
                    branches,
                    softening,
                    recovery,
                    intensity: 0.0,
                });
            }
            _ => {
                let stiffness = self.log(0.3, 2.0);
                let mass = stiffness / self.log(0.5, 3.0).powi(2);
                let critical = 2.0 * (stiffness * mass).sqrt();
                let (linear, quadratic) = (
                    critical * self.log(0.05, 0.3),
                    critical * self.log(0.03, 0.3),
                );
                self.add(InertiaTrack {
                    stiffness,
                    mass,
                    linear,
                    quadratic,
                    place: 0.0,
                    speed: 0.0,
                });
            }
        }
    }

    /// Oil and air.
    pub(super) fn fluid(&mut self, family: Family) {
        match family {
            Family::ShockAbsorber => {
                let closed = [self.log(0.2, 1.5), self.log(0.1, 1.0)];
                let open = closed.map(|rate| rate * self.log(0.05, 0.6));
                let knee = [self.log(0.1, 1.0), self.log(0.1, 1.0)];
                self.add(BlowOff { closed, open, knee });
                let (force, share) = (self.log(0.1, 1.0), self.even(0.1, 0.45));
                let exponent = self.even(1.0, 1.4);
                self.add(GasSpring {
                    force,
                    share,
                    exponent,
                });
            }
            Family::SeriesOrifice => {
                self.frame();
                let (stiffness, linear, quadratic) =
                    (self.log(1.0, 10.0), self.log(0.1, 0.5), self.log(0.1, 2.0));
                self.add(SeriesOrifice {
                    stiffness,
                    linear,
                    quadratic,
                    force: 0.0,
                });
            }
            Family::MrBoucWen => {
                self.frame();
                let mut part = self.bouc_wen();
                part.slip = self.log(0.02, 0.15);
                self.set(part);
                let c = self.log(0.05, 0.3);
                self.set(PowerDamper { c, alpha: 1.0 });
            }
            Family::MrTanh => {
                self.frame();
                let (force, speed, lead) =
                    (self.log(0.1, 1.0), self.log(0.02, 0.3), self.even(0.0, 0.3));
                self.set(TanhYield { force, speed, lead });
                let c = self.log(0.05, 0.3);
                self.set(PowerDamper { c, alpha: 1.0 });
            }
            Family::AirSpring => {
                let (force, share) = (self.log(0.5, 2.0), self.even(0.15, 0.5));
                let (exponent, time) = (self.even(1.1, 1.4), self.log(0.2, 20.0));
                let idle = self.even(0.1, 0.4);
                self.add(AirChamber {
                    force,
                    share,
                    exponent,
                    time,
                    idle,
                    pressure: 1.0,
                    volume: 1.0,
                });
                self.frame();
            }
            _ => {
                self.frame();
                let (c, alpha, time) = (
                    self.log(0.2, 1.0),
                    self.even(0.4, 1.2),
                    self.log(5.0, 100.0),
                );
                // A sine of amplitude 1 dissipates about c/2 per radian, and ends at c/2 times the time constant.
                let thinning = self.even(0.1, 0.8) / (0.5 * c * time);
                self.add(Warming {
                    c,
                    alpha,
                    thinning,
                    time,
                    temperature: 0.0,
                });
            }
        }
    }
}
