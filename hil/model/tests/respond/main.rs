//! The motion of a mass on a damper, against closed forms.

mod effects;
mod energy;
mod friction;
mod linear;
mod refused;

use std::f64::consts::TAU;

use mesh_damper_model::respond::Moment;
use mesh_damper_model::{AddedEffect, Family, LawNode, Model};

/// kN·s²/mm in a kg.
const KG: f64 = 1e-6;

/// Eq 13 with one set of coefficients.
fn law(k1: f64, k3: f64, c: f64, alpha: f64) -> Model {
    let amplitude = 0.0;
    let node = LawNode {
        amplitude,
        k1,
        k3,
        c,
        alpha,
    };
    Model {
        law: vec![node],
        effects: Vec::new(),
        correction: None,
        controls: Vec::new(),
    }
}

fn with(mut model: Model, family: &str, parameters: &[(&str, f64)]) -> Model {
    model.effects.push(AddedEffect {
        family: Family::named(family).unwrap(),
        parameters: parameters
            .iter()
            .map(|&(name, value)| (name.to_owned(), value))
            .collect(),
    });
    model
}

fn sampled(tick: f64, count: usize, signal: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..count)
        .map(|index| signal(tick * index as f64))
        .collect()
}

/// Components of `channel` along sine and cosine of `frequency` Hz over the last `cycles`, with samples of `tick` s.
fn fundamental(
    moments: &[Moment],
    tick: f64,
    frequency: f64,
    cycles: usize,
    channel: impl Fn(&Moment) -> f64,
) -> [f64; 2] {
    let count = (cycles as f64 / (frequency * tick)).round() as usize;
    let first = moments.len() - 1 - count;
    let mut parts = [0.0; 2];
    for (index, moment) in moments.iter().enumerate().skip(first).take(count) {
        let (sin, cos) = (TAU * frequency * tick * index as f64).sin_cos();
        let weight = 2.0 / count as f64;
        parts[0] += weight * sin * channel(moment);
        parts[1] += weight * cos * channel(moment);
    }
    parts
}

/// The largest magnitude of `channel` over the last `count` samples.
fn peak(moments: &[Moment], count: usize, channel: impl Fn(&Moment) -> f64) -> f64 {
    let last = moments.iter().rev().take(count);
    last.fold(0.0, |most, moment| most.max(channel(moment).abs()))
}
