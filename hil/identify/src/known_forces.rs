//! A cache of the forces of effects over the rows of a fit: many fits start from the same shapes.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use super::families::Form;

/// The forces in kN with each size 1 at every row; empty if the crate refuses the shapes.
pub(super) type UnitForces = Option<Vec<Arc<Vec<f64>>>>;

/// Keyed by form and by the bits of its shapes.
#[derive(Default)]
pub(super) struct KnownForces(Mutex<HashMap<(Form, Vec<u64>), UnitForces>>);

impl KnownForces {
    /// The cached forces, or else the result of `work`, which is then cached.
    pub fn of(&self, form: Form, shapes: &[f64], work: impl FnOnce() -> UnitForces) -> UnitForces {
        let key = (form, shapes.iter().map(|shape| shape.to_bits()).collect());
        let held = || self.0.lock().expect("nothing that holds it panics");
        if let Some(known) = held().get(&key) {
            return known.clone();
        }
        // The lock is free meanwhile: others search for other forms.
        let forces = work();
        held().insert(key, forces.clone());
        forces
    }
}
