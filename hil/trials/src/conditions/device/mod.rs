//! Devices of the trial of conditions: their physics, from the literature and separate from the crate's effects.
//!
//! A part has no dimensions: its length is the largest amplitude of the trial, and its angular frequency 1 is a middle one of the
//! trial. So each parameter has a sensible range whatever the device's size. A [`Device`] gives the parts their units.

mod draw;
mod elastic;
mod family;
mod fluid;
mod friction;
mod hysteresis;
mod rubber;

use std::fmt::Debug;

pub use family::Family;

/// The motion at the end of a step, without dimensions.
#[derive(Clone, Copy, Debug)]
struct Now {
    /// Length of the step.
    dt: f64,
    /// Displacement; compression is positive where the directions differ.
    y: f64,
    /// Velocity.
    v: f64,
    /// Acceleration.
    a: f64,
    /// Control input over its largest value in training.
    control: f64,
}

/// A mechanism that starts at displacement 0, unloaded.
trait Part: Debug + Send + Sync + Copied {
    /// The force against the motion, at the end of the step.
    fn force(&mut self, now: &Now) -> f64;
}

/// A copy behind a pointer.
trait Copied {
    fn copied(&self) -> Box<dyn Part>;
}

impl<P: Part + Clone + 'static> Copied for P {
    fn copied(&self) -> Box<dyn Part> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn Part> {
    fn clone(&self) -> Self {
        (**self).copied()
    }
}

/// The units of a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The largest amplitude of the trial, mm.
    pub length: f64,
    /// A middle angular frequency of the trial, rad/s.
    pub angular_frequency: f64,
    /// Stiffness 1 of the parts, kN/mm.
    pub stiffness: f64,
    /// The control input 1 of the parts, in the unit of its name.
    pub control: f64,
}

/// A device: parallel parts.
#[derive(Clone, Debug)]
pub struct Device {
    scale: Scale,
    /// Each with its factor.
    parts: Vec<(f64, Box<dyn Part>)>,
}

impl Device {
    /// The force against the motion at the end of a step of `dt` s, kN. Displacement `y` in mm, velocity `v` in mm/s, acceleration
    /// `a` in mm/s², and the control input in the unit of its name.
    ///
    /// The first step begins at displacement 0. The steps must be fine: several hundred in a cycle.
    pub fn force(&mut self, dt: f64, y: f64, v: f64, a: f64, control: f64) -> f64 {
        let scale = &self.scale;
        let now = Now {
            dt: dt * scale.angular_frequency,
            y: y / scale.length,
            v: v / (scale.length * scale.angular_frequency),
            a: a / (scale.length * scale.angular_frequency.powi(2)),
            control: control / scale.control,
        };
        let unit = scale.stiffness * scale.length;
        let parts = self.parts.iter_mut();
        unit * parts
            .map(|(factor, part)| *factor * part.force(&now))
            .sum::<f64>()
    }

    /// The parts with their parameters, without dimensions.
    pub fn in_words(&self) -> String {
        let parts = self.parts.iter();
        let parts = parts.map(|(factor, part)| format!("{factor:.3} x {part:.4?}"));
        parts.collect::<Vec<_>>().join(" + ")
    }
}

/// Number of parts of a step of which each is at most `most` of it.
fn substeps(whole: f64, most: f64) -> u32 {
    (whole.abs() / most).ceil().max(1.0) as u32
}
