//! The crate's surfaces: the guarantees of their form, their errors, and their copy in the crate.

use std::sync::OnceLock;

use mesh_damper::law::Law;
use mesh_damper::table::SMOOTHED;
use mesh_damper_paper::amplitude_independent::Sine;
use mesh_damper_paper::surfaces::{
    DEGREE, Surfaces, fit, left_out_errors, loop_errors, mean_and_largest,
};
use mesh_damper_reference::comparison::nrmse;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::surfaces::{self as published, Equation18};
use mesh_damper_reference::tables::{AMPLITUDES, DENSITIES, cells};
use proptest::prelude::*;

fn fitted() -> &'static Surfaces {
    static FITTED: OnceLock<Surfaces> = OnceLock::new();
    FITTED.get_or_init(|| fit(DEGREE, None))
}

/// Densities and amplitudes, closely spaced over the tables' range.
fn dense(steps: usize) -> impl Iterator<Item = (f64, f64)> {
    let along =
        move |range: [f64; 5], i: usize| range[0] + (range[4] - range[0]) * i as f64 / steps as f64;
    (0..=steps)
        .flat_map(move |i| (0..=steps).map(move |j| (along(DENSITIES, i), along(AMPLITUDES, j))))
}

/// Elastic force at the amplitude and damping force at the largest speed of 1 Hz, kN.
fn forces(law: &Coefficients, amplitude: f64) -> (f64, f64) {
    let elastic = law.elastic_force(amplitude);
    (
        elastic,
        law.damping_force(std::f64::consts::TAU * amplitude),
    )
}

#[test]
fn the_fitted_surfaces_are_a_damper_everywhere() {
    let mut before = (0.0, 0.0);
    for (density, amplitude) in dense(400) {
        let law = fitted().coefficients(density, amplitude);
        assert!(
            law.k1 > 0.0 && law.k3 > 0.0 && law.c > 0.0,
            "{density} {amplitude}: {law:?}"
        );
        assert!(
            law.alpha > 0.0 && law.alpha < 1.0,
            "{density} {amplitude}: {law:?}"
        );
        let now = forces(&law, amplitude);
        if amplitude > AMPLITUDES[0] {
            let falls = now.0 < before.0 * (1.0 - 1e-12) || now.1 < before.1 * (1.0 - 1e-12);
            assert!(!falls, "{density} {amplitude}: {now:?} after {before:?}");
        }
        before = now;
    }
}

proptest! {
    /// By construction, for any coefficients, as long as those of ln P and ln D do not fall with the polynomial.
    #[test]
    fn any_surfaces_of_the_form_are_a_damper(
        first in prop::array::uniform2(prop::array::uniform5(-4.0..2.0f64)),
        steps in prop::array::uniform2(prop::array::uniform5(prop::array::uniform3(0.0..2.0f64))),
        logits in prop::array::uniform2(prop::array::uniform5(prop::array::uniform4(-8.0..8.0f64))),
        density in 2.0..4.0f64,
        lower in 0.05..0.25f64,
        part in 0.0..1.0f64,
    ) {
        let rising = |which: usize| -> Vec<Vec<f64>> {
            let row = |i: usize| {
                let mut sum = first[which][i];
                let mut row = vec![sum];
                row.extend(steps[which][i].iter().map(|step| {
                    sum += step;
                    sum
                }));
                row
            };
            (0..5).map(row).collect()
        };
        let any = |which: usize| logits[which].iter().map(|row| row.to_vec()).collect();
        let surfaces = Surfaces {
            degree: 3,
            elastic: rising(0),
            cubic_share: any(0),
            damping: rising(1),
            exponent: any(1),
        };
        let upper = lower + part * (0.25 - lower);
        let laws = [lower, upper].map(|amplitude| surfaces.coefficients(density, amplitude));
        for law in &laws {
            prop_assert!(law.k1 > 0.0 && law.k3 > 0.0 && law.c > 0.0, "{law:?}");
            prop_assert!(law.alpha > 0.0 && law.alpha < 1.0, "{law:?}");
        }
        let (low, high) = (forces(&laws[0], lower), forces(&laws[1], upper));
        prop_assert!(high.0 >= low.0 * (1.0 - 1e-12) && high.1 >= low.1 * (1.0 - 1e-12));
    }

    /// Between two densities of the tables the forces and α are between theirs.
    #[test]
    fn nothing_overshoots_between_densities(density in 2.0..4.0f64, amplitude in 0.05..0.25f64) {
        let column = (0..4).rfind(|&i| density >= DENSITIES[i]).unwrap();
        let of = |density: f64| {
            let law = fitted().coefficients(density, amplitude);
            let (elastic, damping) = forces(&law, amplitude);
            [elastic, damping, law.alpha]
        };
        let (low, high, here) = (of(DENSITIES[column]), of(DENSITIES[column + 1]), of(density));
        for i in 0..3 {
            let (least, most) = (low[i].min(high[i]), low[i].max(high[i]));
            prop_assert!(here[i] >= least * (1.0 - 1e-12) && here[i] <= most * (1.0 + 1e-12));
        }
    }
}

/// The requirement is a third of the printed (corrected) surfaces' mean error and no cell above 0.15. The result is a sixth.
#[test]
fn every_loop_is_met() {
    let (mean, largest) = mean_and_largest(&loop_errors(|r, a| fitted().coefficients(r, a)));
    let (of_paper, _) = mean_and_largest(&loop_errors(|r, a| {
        published::coefficients(r, a, Equation18::Corrected)
    }));
    assert!((of_paper - 0.3812).abs() < 1e-4, "{of_paper}");
    assert!(mean < of_paper / 6.0, "{mean}");
    assert!(largest < 0.145, "{largest}");
    // One degree less leaves a cell above 0.15: this is the smallest that meets everything.
    let less = fit(DEGREE - 1, None);
    let (_, largest) = mean_and_largest(&loop_errors(|r, a| less.coefficients(r, a)));
    assert!(largest > 0.15, "{largest}");
}

/// Every coefficient is within a factor of its cell: 2 for k1, c and α. k3 matters little at 4.0 g/cm³, where Table 7 jumps from
/// 180 to 5.
#[test]
fn every_coefficient_is_near_its_cell() {
    for (density, amplitude, cell) in cells() {
        let law = fitted().coefficients(density, amplitude);
        for (found, cell) in [(law.k1, cell.k1), (law.c, cell.c), (law.alpha, cell.alpha)] {
            assert!(
                (0.5..2.0).contains(&(found / cell)),
                "{density} {amplitude}: {found} {cell}"
            );
        }
        if density < 4.0 {
            assert!(
                (0.5..2.0).contains(&(law.k3 / cell.k3)),
                "{density} {amplitude}: {law:?}"
            );
        }
    }
}

/// Without the cell in the fit. The error is reported, not hidden. Within the range of amplitudes these surfaces are still closer
/// than the published ones, which were fitted to the cell.
#[test]
fn a_cell_that_was_left_out_is_predicted_from_the_others() {
    let left_out = left_out_errors(DEGREE);
    let (mean, _) = mean_and_largest(&left_out);
    assert!((0.15..0.30).contains(&mean), "{mean}");
    let of_paper = loop_errors(|r, a| published::coefficients(r, a, Equation18::Corrected));
    let inner = |errors: &[[f64; 5]; 5]| errors[1..4].iter().flatten().sum::<f64>() / 15.0;
    assert!(inner(&left_out) < 0.5 * inner(&of_paper), "{left_out:?}");
}

/// The crate's table has the surfaces at its nodes, to six digits, and keeps their guarantees in between.
#[test]
fn the_crate_carries_the_fitted_surfaces() {
    let parts = |law: &Law<f32>| [law.k1(), law.k3(), law.c(), law.alpha()].map(f64::from);
    for density in SMOOTHED.densities() {
        for amplitude in SMOOTHED.amplitudes() {
            let found = SMOOTHED.lookup(density, amplitude);
            assert!(!found.clamped());
            let law = fitted().coefficients(f64::from(density), f64::from(amplitude));
            let expected = [law.k1, law.k3, law.c, law.alpha];
            for (found, expected) in parts(&found.law).into_iter().zip(expected) {
                assert!(
                    (found / expected - 1.0).abs() < 1e-5,
                    "{density} {amplitude}: {found} {expected}"
                );
            }
        }
    }
    let mut sum = 0.0;
    let mut count = 0.0;
    for (density, amplitude) in dense(60) {
        let [k1, k3, c, alpha] = parts(&SMOOTHED.lookup(density as f32, amplitude as f32).law);
        let law = Coefficients { k1, k3, c, alpha };
        assert!(k1 > 0.0 && k3 > 0.0 && c > 0.0 && alpha > 0.0 && alpha < 1.0);
        let sine = Sine::new(amplitude, 1.0, 100);
        let surface = sine.force(&fitted().coefficients(density, amplitude));
        let error = nrmse(&sine.force(&law), &surface).unwrap();
        // Straight lines instead of exponentials between nodes that are up to 2.5 times apart.
        assert!(error < 0.1, "{density} {amplitude}: {error}");
        sum += error;
        count += 1.0;
    }
    assert!(sum / count < 0.03, "{}", sum / count);
}
