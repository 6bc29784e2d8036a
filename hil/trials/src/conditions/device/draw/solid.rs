//! Devices of metal and of dry contacts.

use rand::seq::IndexedRandom;
use rand::{Rng, RngExt};

use super::super::Family;
use super::super::elastic::{Mass, Rocking, Stops};
use super::super::friction::LuGre;
use super::super::hysteresis::{Slider, Sliders, Structural, Superelastic};
use super::Drawn;

impl<R: Rng> Drawn<'_, R> {
    /// Metal and dry contacts.
    pub(super) fn solid(&mut self, family: Family) {
        self.frame();
        match family {
            Family::BoucWen => {
                let part = self.bouc_wen();
                self.add(part);
            }
            Family::Pinching => {
                let mut part = self.bouc_wen();
                part.pinch = [
                    self.even(0.3, 0.9),
                    self.even(0.0, 0.2),
                    self.even(0.1, 0.5),
                ];
                part.loss = if self.chance(0.5) {
                    self.log(0.002, 0.02)
                } else {
                    0.0
                };
                self.add(part);
            }
            Family::WireRope => {
                let mut part = self.bouc_wen();
                part.envelope = [self.even(-0.6, 0.6), self.even(0.0, 0.8)];
                self.add(part);
            }
            Family::Masing => {
                let part = self.sliders([1.0; 2]);
                self.add(part);
            }
            Family::AsymmetricSliders => {
                let back = self.even(0.3, 0.8);
                let part = self.sliders([back, 2.0 - back]);
                self.add(part);
            }
            Family::Stribeck => {
                let sliding = self.log(0.1, 1.0);
                let resting = sliding * self.even(1.1, 1.8);
                let (speed, give) = (self.log(0.03, 0.4), self.log(0.005, 0.1));
                self.add(LuGre {
                    sliding,
                    resting,
                    speed,
                    bristles: sliding / give,
                    force: 0.0,
                });
            }
            Family::Clamped => {
                let part = self.contact();
                self.set(part);
            }
            Family::Superelastic => {
                let loading = self.log(0.1, 0.6);
                let unloading = loading * self.even(0.2, 0.8);
                let (stiffness, slope) = (self.log(2.0, 10.0), self.log(0.02, 0.5));
                self.add(Superelastic {
                    stiffness,
                    plateaus: [loading, unloading],
                    slope,
                    transformed: 0.0,
                });
            }
            Family::Gap => {
                let near = self.even(0.2, 0.8);
                let far = *[near, near, f64::INFINITY]
                    .choose(self.rng)
                    .unwrap_or(&near);
                let (stiffness, damping) = (self.log(0.5, 10.0), self.even(0.0, 0.5));
                self.add(Stops {
                    stiffness,
                    gaps: [far, near],
                    damping,
                });
            }
            Family::Rocking => {
                let force = self.log(0.2, 1.0);
                let (give, lean) = (self.log(0.02, 0.3), force * self.even(0.0, 0.4));
                self.add(Rocking { force, give, lean });
                let bars = self.log(0.1, 0.8) * force;
                let slip = self.log(0.02, 0.2);
                self.add(Sliders {
                    sliders: vec![Slider {
                        stiffness: bars / slip,
                        limits: [bars; 2],
                        force: 0.0,
                    }],
                    y: 0.0,
                });
            }
            Family::Structural => {
                let stiffness = self.log(0.05, 0.6);
                self.add(Structural { stiffness });
            }
            Family::Inerter => {
                let mass = self.log(0.02, 0.3);
                self.add(Mass { mass });
            }
            Family::LoadedFriction => {
                let mut part = self.contact();
                part.load = match self.rng.random_range(0..3) {
                    0 => [self.log(0.3, 4.0), 0.0],
                    1 => [0.0, self.even(-0.9, 0.9)],
                    _ => [self.log(0.3, 2.0), self.even(-0.5, 0.5)],
                };
                self.add(part);
            }
            _ => {
                let mut part = self.contact();
                part.wave = [self.even(0.1, 0.7), self.even(1.0, 8.0)];
                self.add(part);
            }
        }
    }
}
