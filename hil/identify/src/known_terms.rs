//! The terms of a fit for the effects of a model: the inverse of [`TermValue::elements`].

use std::collections::{BTreeMap, BTreeSet};

use mesh_damper_model::{AddedEffect, base_name};

use crate::families::Form;
use crate::term::{Term, TermValue};

/// A term that stays in the law, and its known shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownTerm {
    /// The term.
    pub term: Term,
    /// The start of its fit.
    pub shapes: Vec<f64>,
}

/// The terms of `effect`: one, or for several elements one each; the elements of an Iwan model are one term. `None` if no form fits
/// an element.
pub fn known_terms(effect: &AddedEffect) -> Option<Vec<KnownTerm>> {
    let mut elements: BTreeMap<usize, BTreeMap<&str, f64>> = BTreeMap::new();
    for (name, &value) in &effect.parameters {
        let base = base_name(name);
        let number = name[base.len()..].trim_start_matches('_').parse();
        let element = elements.entry(number.unwrap_or(1)).or_default();
        element.insert(base, value);
    }
    let of_family = Form::all().filter(|form| form.family() == effect.family);
    let of_family: Vec<Form> = of_family.collect();
    let several = of_family.iter().find(|form| form.is_several());
    if let (2.., Some(&form)) = (elements.len(), several) {
        // Equal fractions of the largest shape.
        let largest = elements.values().filter_map(|one| shapes_of(form, one));
        let largest = largest.max_by(|a, b| a[0].total_cmp(&b[0]))?;
        return Some(vec![known(form, 0.0, largest)]);
    }
    let term = |element: &BTreeMap<&str, f64>| {
        let mut forms = of_family.iter().filter(|form| !form.is_several());
        forms.find_map(|&form| {
            let shapes = shapes_of(form, element)?;
            let reference = element.get("reference").copied().unwrap_or_default();
            let known = known(form, reference, shapes);
            stands_for(&known, element).then_some(known)
        })
    };
    elements.values().map(term).collect()
}

fn known(form: Form, reference: f64, shapes: Vec<f64>) -> KnownTerm {
    let term = Term {
        form,
        reference,
        is_known: true,
        held: None,
    };
    KnownTerm { term, shapes }
}

/// The shapes of an element.
fn shapes_of(form: Form, element: &BTreeMap<&str, f64>) -> Option<Vec<f64>> {
    let names = form.shape_names.iter();
    names.map(|name| (form.shape_of)(element, name)).collect()
}

/// Whether an element has exactly the parameters of a term, and those that do not depend on its sizes have the term's values.
fn stands_for(known: &KnownTerm, element: &BTreeMap<&str, f64>) -> bool {
    let with_size = |size: f64| {
        let value = TermValue {
            term: known.term,
            sizes: vec![size; known.term.form.sizes()],
            shapes: known.shapes.clone(),
        };
        let (_, parameters) = value.elements().into_iter().next().unwrap_or_default();
        parameters
    };
    let [one, other] = [1.0, -2.0].map(with_size);
    let names: BTreeSet<&str> = one.iter().map(|(name, _)| *name).collect();
    let has_all = element.keys().copied().eq(names);
    let mut pairs = one.iter().zip(&other);
    has_all && pairs.all(|((name, a), (_, b))| a != b || element[name] == *a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::term::added_effects;

    /// Every form that can describe an element, with each size 0.2.
    #[test]
    fn a_model_gives_back_the_terms_that_it_was_made_of() {
        for form in Form::all() {
            let term = Term {
                form,
                reference: 20.0,
                is_known: true,
                held: None,
            };
            let places = 1..=form.shape_names.len();
            let value = TermValue {
                term,
                sizes: vec![0.2; form.sizes()],
                shapes: places.map(|place| 0.3 * place as f64).collect(),
            };
            let added = added_effects(std::slice::from_ref(&value));
            let read = known_terms(&added[0]).unwrap();
            assert_eq!(read.len(), 1, "{form:?}");
            assert_eq!(read[0].term.form, form);
            let pairs = read[0].shapes.iter().zip(&value.shapes);
            for (read, shape) in pairs {
                assert!((read / shape - 1.0).abs() < 1e-12, "{form:?}");
            }
        }
    }

    #[test]
    fn what_is_fitted_in_no_form_is_no_term() {
        let parameters = |pairs: &[(&str, f64)]| {
            let each = pairs.iter();
            each.map(|&(name, value)| (name.to_owned(), value))
                .collect()
        };
        let branches = AddedEffect {
            family: Form::named("relaxation").unwrap().family(),
            parameters: parameters(&[
                ("stiffness", 1.0),
                ("time", 0.1),
                ("stiffness_2", 2.0),
                ("time_2", 0.2),
            ]),
        };
        let times: Vec<f64> = known_terms(&branches)
            .unwrap()
            .iter()
            .map(|known| known.shapes[0])
            .collect();
        assert_eq!(times, [0.1, 0.2]);
        let mut cut = branches;
        cut.parameters.remove("time_2");
        assert_eq!(known_terms(&cut), None);
    }
}
