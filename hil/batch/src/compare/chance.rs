//! How far the force of a model may be off by chance.

use mesh_damper_model::{Model, ModelError};
use nalgebra::{Cholesky, DMatrix};
use statrs::distribution::{ChiSquared, ContinuousCDF as _};

use super::common::CommonMotion;
use super::parameters::{Parameter, of_model};
use super::run::Run;
use super::{ComparePolicy, Moment};

/// A sum of squares of independent normal variables: the sum of their variances, and the sum of the squares of these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chance {
    pub sum: f64,
    pub squares: f64,
}

impl Chance {
    /// One variable with this variance.
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

    /// The chance of a sum as large as `square`, from a scaled χ² distribution with the same mean and variance (Satterthwaite
    /// 1946).
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

/// A model's force, and its possible error.
pub(super) struct Spread {
    pub force: Vec<f64>,
    /// The mean square of its error, kN²; `None` if an interval is not known.
    pub chance: Option<Chance>,
}

impl Spread {
    /// For a model whose zero lies `shift` mm above the first model's.
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

/// From the parameters, which were fitted together, and from the remainder of the model beyond the noise.
///
/// A trace gives the deviation of each parameter, but not their correlations. In a fit to the motion on which the model was fitted,
/// the covariance of the parameters would be (HᵀH)⁻¹; each column of H is the change of the force by one parameter. The
/// correlations are taken from that.
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
            // A parameter without width has no error; one without a bound may have any error.
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
        // A parameter that its own motion does not excite has no basis.
        if mean_square(&there) > 0.0 {
            columns.push(here);
            fitted.push(there);
        }
    }
    // The intervals already include the noise as the trace estimates it, with that of the motion.
    let left = trace.remainder.as_ref().map_or(0.0, |left| left.nrmse);
    let left = Chance::of(left * left * mean_square(force));
    Ok(of_parameters(&columns, &fitted).map(|chance| chance.and(left)))
}

/// The change of the force when a parameter is off by one deviation, kN. `None` if the crate refuses it both above and below.
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

/// The mean square of the sum of `columns`, each times a normal variable of deviation 1. The variables are correlated as in a fit
/// to a motion with the columns `fitted`. `None` if these are linearly dependent.
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

/// Whether both ends of an interval are equal.
fn is_exact(parameter: &Parameter) -> bool {
    let bounds = &parameter.bounds;
    bounds.low.is_some() && bounds.low == bounds.high
}

/// Where a model stores the value of a parameter.
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
        // Two columns that differ by a tenth: in a fit their errors oppose each other, and the error of their sum is much smaller
        // than either.
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
        // In the fit the columns are independent, so the errors are too, and their squares add.
        let apart = [vec![1.0, 0.0], vec![0.0, 1.0]];
        let alike = [vec![1.0, 1.0], vec![1.0, 1.0]];
        assert!((of_parameters(&alike, &apart).unwrap().sum - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_sum_of_two_equal_variables_is_exceeded_as_a_chi_square_of_two() {
        // e^(−x/2) for χ² = 6, which is a sum of 3.
        let one = Chance::of(0.5);
        let p = one.and(one).exceeds(3.0).unwrap();
        assert!((p - (-3.0_f64).exp()).abs() < 1e-9, "{p}");
    }
}
