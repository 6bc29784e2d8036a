//! One added effect in a fit, and its parameters after the fit.

use std::collections::BTreeMap;

use mesh_damper::effects::Inertia;
use mesh_damper_model::{AddedEffect, Family};

use crate::families::{Element, Entry, Form, inertia};
use crate::shape::Extent;

/// One added effect in a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// The form of the effect.
    pub form: Form,
    /// The temperature at which the law holds, °C; used by temperature only.
    pub reference: f64,
    /// Whether it was known before, so that it stays.
    pub is_known: bool,
    /// Its size if it is known exactly, so that it is not fitted: that of a term with one size and no shapes.
    pub held: Option<f64>,
}

impl Term {
    /// An effect that is sought: it is not known before, and its size is fitted. `reference` is the temperature at which the law holds, °C.
    pub fn sought(form: Form, reference: f64) -> Self {
        Self {
            form,
            reference,
            is_known: false,
            held: None,
        }
    }

    /// The number of its sizes that a fit determines among the linear unknowns.
    pub(crate) fn fitted_sizes(&self) -> usize {
        match self.form.entry {
            Entry::Adds(count) if self.held.is_none() => count,
            _ => 0,
        }
    }
}

/// A term's parameters after a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct TermValue {
    /// The term.
    pub term: Term,
    /// The factors of its forces. For temperature they are β, and β_damping if it differs; for a drift of each force they are the
    /// changes.
    pub sizes: Vec<f64>,
    /// Its shapes.
    pub shapes: Vec<f64>,
}

impl TermValue {
    /// Its size at `index`; 0 if it has none there.
    pub fn size(&self, index: usize) -> f64 {
        self.sizes.get(index).copied().unwrap_or_default()
    }

    /// Its shape at `index`; 0 if it has none there.
    pub fn shape(&self, index: usize) -> f64 {
        self.shapes.get(index).copied().unwrap_or_default()
    }

    /// Whether no size would be a source of energy or a wall that pulls, or a mass that the crate refuses: in a slow test, or one of a
    /// single frequency, a fit does not determine it. Some of several elements may be missing.
    pub fn is_admissible(&self) -> bool {
        if self.term.form == inertia::FORMS[0] && Inertia::new(self.size(0)).is_err() {
            return false;
        }
        let mut sizes = self.sizes.iter();
        let positive = |size: &f64| *size > 0.0;
        !self.term.form.size_is_positive
            || if self.term.form.elements_may_miss {
                sizes.any(positive)
            } else {
                sizes.all(positive)
            }
    }

    /// Whether a shape has a value at which the effect can no longer be distinguished from a simpler one.
    pub fn is_degenerate(&self, extent: &Extent) -> bool {
        let shapes = (self.term.form.shapes)(extent);
        let mut pairs = self.shapes.iter().zip(shapes);
        pairs.any(|(&value, shape)| shape.is_limit(value))
    }

    /// Its elements: one, or for an Iwan model those that are present. Each comes with the index of its size.
    pub fn elements(&self) -> Vec<Element> {
        (self.term.form.elements)(self)
    }
}

/// The effects of fitted terms.
pub fn added_effects(values: &[TermValue]) -> Vec<AddedEffect> {
    // A term that a fit held at 0, because it would have been a source of energy, is absent.
    let there = values.iter().filter(|value| value.is_admissible());
    let parts = there.flat_map(|value| {
        let elements = value.elements().into_iter();
        elements.map(|(_, parameters)| (value.term.form, parameters))
    });
    effects_of(parts.collect())
        .into_iter()
        .map(|(family, parameters)| AddedEffect { family, parameters })
        .collect()
}

/// Effects of elements with parameters of any type. Jenkins elements become the elements of one effect, and so do Maxwell branches,
/// tones and the two contacts.
pub(crate) fn effects_of<T>(
    terms: Vec<(Form, Vec<(&'static str, T)>)>,
) -> Vec<(Family, BTreeMap<String, T>)> {
    let mut effects: Vec<(Form, BTreeMap<String, T>)> = Vec::new();
    for (form, parameters) in terms {
        let is_of = |known: &Form| {
            *known == form || (known.family == form.family && known.effect == form.effect)
        };
        let place = match effects.iter().position(|(known, _)| is_of(known)) {
            Some(place) => place,
            None => {
                effects.push((form, BTreeMap::new()));
                effects.len() - 1
            }
        };
        let effect = &mut effects[place].1;
        let number = effect.len() / parameters.len() + 1;
        for (name, parameter) in parameters {
            let name = match number {
                1 => name.to_owned(),
                _ => format!("{name}_{number}"),
            };
            effect.insert(name, parameter);
        }
    }
    effects
        .into_iter()
        .map(|(form, parameters)| (form.family(), parameters))
        .collect()
}
