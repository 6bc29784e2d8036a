//! A specimen that can be damaged during a test, settles after its start and changes with the temperature.

use std::cell::Cell;
use std::rc::Rc;

use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables;

use crate::specimen::{DamperForce, REFERENCE_TEMPERATURE};

/// Condition of a specimen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// Remaining part of the elastic force.
    pub stiffness: f64,
    /// Remaining part of the friction.
    pub friction: f64,
    /// Half width of the gap that has opened, mm. Inside a gap wider than a fiftieth of the amplitude there is no friction either.
    pub gap: f64,
    /// Preload, kN.
    pub preload: f64,
    /// Stiffness of seized parts, in addition, kN/mm.
    pub added_stiffness: f64,
    /// Additional damping, kN·s/mm; a negative value drives the motion.
    pub added_damping: f64,
    /// Temperature, °C.
    pub temperature: f64,
    /// Relative loss of force per degree above 20 °C, 1/°C.
    pub warm_loss: f64,
}

impl Condition {
    /// Undamaged, at the reference temperature.
    pub const NEW: Self = Self {
        stiffness: 1.0,
        friction: 1.0,
        gap: 0.0,
        preload: 0.0,
        added_stiffness: 0.0,
        added_damping: 0.0,
        temperature: REFERENCE_TEMPERATURE,
        warm_loss: 0.0,
    };

    /// Leaves these parts of elastic force and friction.
    pub(super) fn scale(&mut self, stiffness: f64, friction: f64) {
        self.stiffness *= stiffness;
        self.friction *= friction;
    }
}

/// Eq 13 in a condition that the owner of the other end of `condition` sets.
#[derive(Clone, Debug)]
pub struct Damaged {
    coefficients: Coefficients,
    /// Half width up to which a gap does not affect friction, mm.
    narrow: f64,
    condition: Rc<Cell<Condition>>,
}

/// Part of the amplitude up to which a gap is narrow: its wires do not all separate at one position, so that friction remains.
const NARROW: f64 = 0.02;

impl Damaged {
    /// A specimen with the paper's coefficients at `density` g/cm³ and `amplitude` mm, and its condition.
    pub fn new(density: f64, amplitude: f64) -> (Self, Rc<Cell<Condition>>) {
        let condition = Rc::new(Cell::new(Condition::NEW));
        let specimen = Self {
            coefficients: tables::interpolate(density, amplitude),
            narrow: NARROW * amplitude,
            condition: condition.clone(),
        };
        (specimen, condition)
    }

    /// Coefficients of its eq 13 while undamaged.
    pub fn coefficients(&self) -> Coefficients {
        self.coefficients
    }
}

impl DamperForce for Damaged {
    fn force(&mut self, _: f64, y: f64, v: f64, _: f64, _: f64) -> f64 {
        let now = self.condition.get();
        let felt = y - y.clamp(-now.gap, now.gap);
        let moving = if now.gap > self.narrow && felt == 0.0 {
            0.0
        } else {
            v
        };
        let elastic = self.coefficients.force(felt, 0.0);
        let friction = self.coefficients.force(felt, moving) - elastic;
        let warm = 1.0 - now.warm_loss * (now.temperature - REFERENCE_TEMPERATURE);
        let beside = now.preload + now.added_stiffness * y + now.added_damping * v;
        warm * (now.stiffness * elastic + now.friction * friction) + beside
    }

    fn temperature(&self) -> f64 {
        self.condition.get().temperature
    }
}
