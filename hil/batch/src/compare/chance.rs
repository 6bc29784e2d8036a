//! How far the force of a model may be off by chance.

use mesh_damper_model::{Model, ModelError};
use nalgebra::{Cholesky, DMatrix};
use statrs::distribution::{ChiSquared, ContinuousCDF as _};

use super::common::CommonMotion;
use super::parameters::{Parameter, of_model};
use super::run::Run;
use super::{ComparePolicy, Moment};

/// A sum of squares of independent normal variables: the sum of their variances, and that of the squares of these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chance {
    pub sum: f64,
    pub squares: f64,
}

impl Chance {
    /// Of one variable, by its variance.
    pub fn of(variance: f64) -> Self {
        Self {
            sum: variance,
            squares: variance * variance,
        }
    }

    pub fn and(self, other: Self) -> Self {
        Self {
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
        }
    }

    /// The chance of a sum as large as `square`: that of a scaled χ² with the same mean and variance (Satterthwaite 1946).
    pub fn exceeds(self, square: f64) -> Option<f64> {
        let freedom = self.sum * self.sum / self.squares;
        Some(
            ChiSquared::new(freedom)
                .ok()?
                .sf(freedom * square / self.sum),
        )
    }
}

pub(super) fn mean_square(values: &[f64]) -> f64 {
    mean_product(values, values)
}

pub(super) fn mean_product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / a.len() as f64
}

pub(super) fn differences(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// A model's force, and how far it may be off.
pub(super) struct Spread {
    pub force: Vec<f64>,
    /// The mean square of what it is off by, kN²; `None` where an interval is not known.
    pub chance: Option<Chance>,
}

impl Spread {
    /// Of a model whose zero lies by `shift` mm above the first model's.
    pub fn of(
        moment: &Moment,
        run: &Run,
        shift: f64,
        numbers: &ComparePolicy,
    ) -> Result<Self, ModelError> {
        let model = moment.model.model();
        let force = run.force(&model, shift)?;
        let chance = chance(moment, &model, (run, shift), &force, numbers)?;
        Ok(Self { force, chance })
    }
}

/// Of the parameters, which were fitted together, and of what the model leaves beyond the noise.
///
/// A trace gives the deviation of each parameter, and not how they err together. A fit to the motion that the model was fitted on would have
/// its parameters err as (HᵀH)⁻¹ says of the columns H, what each changes the force by; from that the correlations are taken.
fn chance(
    moment: &Moment,
    model: &Model,
    (run, shift): (&Run, f64),
    force: &[f64],
    numbers: &ComparePolicy,
) -> Result<Option<Chance>, ModelError> {
    let Some(trace) = &moment.trace else {
        return Ok(None);
    };
    let own = Run::new(&CommonMotion::own(moment), 0.0, &[moment], numbers);
    let own_force = own.force(model, 0.0)?;
    let (mut columns, mut fitted) = (Vec::new(), Vec::new());
    for parameter in of_model(moment) {
        let Some(deviation) = parameter.bounds.deviation(numbers) else {
            // What has no width errs by nothing; what has no bound by anything.
            if is_exact(&parameter) {
                continue;
            }
            return Ok(None);
        };
        let off = (&parameter, deviation);
        let here = changed_by(model, off, force, |model| run.force(model, shift));
        let there = changed_by(model, off, &own_force, |model| own.force(model, 0.0));
        let Some((here, there)) = here.zip(there) else {
            return Ok(None);
        };
        // One that its own motion does not excite was fitted to nothing.
        if mean_square(&there) > 0.0 {
            columns.push(here);
            fitted.push(there);
        }
    }
    // What the trace takes for noise, that of the motion included, is in the intervals already.
    let left = trace.remainder.as_ref().map_or(0.0, |left| left.nrmse);
    let left = Chance::of(left * left * mean_square(force));
    Ok(of_parameters(&columns, &fitted).map(|chance| chance.and(left)))
}

/// What the force changes by where a parameter is off by a deviation, kN. `None` where the crate refuses it both above and below.
fn changed_by(
    model: &Model,
    (parameter, deviation): (&Parameter, f64),
    force: &[f64],
    run: impl Fn(&Model) -> Result<Vec<f64>, ModelError>,
) -> Option<Vec<f64>> {
    [deviation, -deviation].into_iter().find_map(|off| {
        let mut other = model.clone();
        *value_in(&mut other, parameter)? += off;
        let other = run(&other).ok()?;
        let pairs = other.iter().zip(force);
        Some(
            pairs
                .map(|(other, force)| (other - force) * off.signum())
                .collect(),
        )
    })
}

fn products(columns: &[Vec<f64>]) -> DMatrix<f64> {
    let count = columns.len();
    DMatrix::from_fn(count, count, |i, j| mean_product(&columns[i], &columns[j]))
}

/// The mean square of the sum of `columns`, each times a normal variable of deviation 1, which are correlated as in a fit to a motion
/// where the columns are those `fitted`. `None` where these are no independent ones.
fn of_parameters(columns: &[Vec<f64>], fitted: &[Vec<f64>]) -> Option<Chance> {
    let of_fit = products(fitted);
    let count = columns.len();
    let size: Vec<f64> = (0..count).map(|i| of_fit[(i, i)].sqrt()).collect();
    let scaled = DMatrix::from_fn(count, count, |i, j| of_fit[(i, j)] / (size[i] * size[j]));
    let inverse = Cholesky::new(scaled)?.inverse();
    let deviation: Vec<f64> = (0..count).map(|i| inverse[(i, i)].sqrt()).collect();
    let correlated = DMatrix::from_fn(count, count, |i, j| {
        inverse[(i, j)] / (deviation[i] * deviation[j])
    });
    let off = correlated * products(columns);
    let squares = (&off * &off).trace();
    let chance = Chance {
        sum: off.trace(),
        squares,
    };
    (chance.sum.is_finite() && squares.is_finite()).then_some(chance)
}

/// Whether an interval has two ends that are one.
fn is_exact(parameter: &Parameter) -> bool {
    let bounds = &parameter.bounds;
    bounds.low.is_some() && bounds.low == bounds.high
}

/// Where a model has the value of a parameter.
fn value_in<'a>(model: &'a mut Model, parameter: &Parameter) -> Option<&'a mut f64> {
    let Some(amplitude) = parameter.amplitude else {
        let mut effects = model.effects.iter_mut();
        let effect = effects.find(|effect| effect.family.name() == parameter.of)?;
        return effect.parameters.get_mut(&parameter.name);
    };
    let mut nodes = model.law.iter_mut();
    let node = nodes.find(|node| node.amplitude == amplitude)?;
    Some(match parameter.name.as_str() {
        "k1" => &mut node.k1,
        "k3" => &mut node.k3,
        "c" => &mut node.c,
        _ => &mut node.alpha,
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn what_is_fitted_together_errs_together() {
        // Two columns that are alike but for a tenth: fitted, one errs against the other, and their sum by much less than either.
        let time: Vec<f64> = (0..1000).map(|i| TAU * f64::from(i) / 1000.0).collect();
        let one: Vec<f64> = time.iter().map(|t| t.sin()).collect();
        let other: Vec<f64> = time.iter().map(|t| t.sin() + 0.1 * t.cos()).collect();
        let alone = std::slice::from_ref(&one);
        let alone = of_parameters(alone, alone).unwrap();
        assert!((alone.sum - 0.5).abs() < 1e-12 && (alone.squares - 0.25).abs() < 1e-12);
        let columns = [one, other];
        let both = of_parameters(&columns, &columns).unwrap();
        // With K = ½·[1, 1; 1, 1.01] the correlation is −1/√1.01, and the mean square ½·(2.01 − 2/√1.01).
        let expected = 0.5 * (2.01 - 2.0 / 1.01_f64.sqrt());
        assert!((both.sum - expected).abs() < 1e-9, "{both:?}");
        let dependent = [vec![1.0, 2.0], vec![2.0, 4.0]];
        assert!(of_parameters(&dependent, &dependent).is_none());
        // Where they were fitted they are independent: each errs alone, and their squares add.
        let apart = [vec![1.0, 0.0], vec![0.0, 1.0]];
        let alike = [vec![1.0, 1.0], vec![1.0, 1.0]];
        assert!((of_parameters(&alike, &apart).unwrap().sum - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_sum_of_two_equal_variables_is_exceeded_as_a_chi_square_of_two() {
        // e^(−x/2) of χ² = 6, which is a sum of 3.
        let one = Chance::of(0.5);
        let p = one.and(one).exceeds(3.0).unwrap();
        assert!((p - (-3.0_f64).exp()).abs() < 1e-9, "{p}");
    }
}
