//! Drift over cycles and temperature, which scale the law.

use mesh_damper::effects::{AugmentedLaw, Drift, Effect, Motion, Offset, Temperature};
use mesh_damper::law::Law;

use crate::loops::{alone, close};

#[test]
fn drift_has_done_63_percent_after_its_cycles() {
    let law = alone(Effect::Drift(Drift::new(-0.5, 25.0).unwrap()));
    let mut state = law.at_rest();
    let stiffness = |cycles: f64, state: &mut _| {
        let motion = Motion {
            cycles,
            ..Motion::at(0.1, 0.0)
        };
        law.force(state, &motion) / 0.1
    };
    assert_eq!(stiffness(0.0, &mut state), 0.0);
    close(
        stiffness(25.0, &mut state),
        -0.5 * (1.0 - (-1.0_f64).exp()),
        1e-12,
    );
    close(stiffness(1e9, &mut state), -0.5, 1e-12);
}

#[test]
fn drift_changes_elastic_and_damping_force_each_in_its_own_way() {
    let (k1, k3, c, alpha) = (1.0, 10.0, 0.1, 0.4);
    let drift = Drift::new(0.7, 25.0).unwrap().with_forces(-0.2, 0.5);
    let law: AugmentedLaw<f64, 1> = AugmentedLaw::new(Law::new(k1, k3, c, alpha).unwrap())
        .with(Effect::Drift(drift.unwrap()))
        .unwrap();
    for (y, v, cycles) in [(0.1, 1.3, 3.0), (-0.2, 0.4, 25.0), (0.05, -3.0, 1e6)] {
        let motion = Motion {
            cycles,
            ..Motion::at(y, v)
        };
        let done = 1.0 - (-cycles / 25.0_f64).exp();
        let elastic = (1.0 - 0.2 * done) * (k1 * y + k3 * y.powi(3));
        let damping = (1.0 + 0.5 * done) * c * v.abs().powf(alpha) * v.signum();
        close(
            law.force(&mut law.at_rest(), &motion),
            elastic + damping + 0.7 * done * y,
            1e-12,
        );
    }
}

#[test]
fn temperature_scales_the_law_and_nothing_else() {
    let law = Law::new(1.0, 10.0, 0.1, 0.4).unwrap();
    let warm: AugmentedLaw<f64, 2> = AugmentedLaw::new(law)
        .with(Effect::Offset(Offset::new(0.7).unwrap()))
        .unwrap()
        .with(Effect::Temperature(Temperature::new(0.004, 20.0).unwrap()))
        .unwrap();
    let motion = Motion {
        temperature: 70.0,
        ..Motion::at(0.1, 1.3)
    };
    close(
        warm.force(&mut warm.at_rest(), &motion),
        0.7 + (1.0 - 0.004 * 50.0) * law.force(0.1, 1.3),
        1e-12,
    );
}

#[test]
fn temperature_scales_elastic_and_damping_force_each_in_its_own_way() {
    let (k1, k3, c, alpha) = (1.0, 10.0, 0.1, 0.4);
    let each = Temperature::new(0.004, 20.0).unwrap().with_damping(-0.002);
    let warm: AugmentedLaw<f64, 1> = AugmentedLaw::new(Law::new(k1, k3, c, alpha).unwrap())
        .with(Effect::Temperature(each.unwrap()))
        .unwrap();
    for (y, v, temperature) in [(0.1, 1.3, 70.0), (-0.2, 0.4, -10.0), (0.05, -3.0, 20.0)] {
        let motion = Motion {
            temperature,
            ..Motion::at(y, v)
        };
        let rise = temperature - 20.0;
        let elastic = (1.0 - 0.004 * rise) * (k1 * y + k3 * y.powi(3));
        let damping = (1.0 + 0.002 * rise) * c * v.abs().powf(alpha) * v.signum();
        close(
            warm.force(&mut warm.at_rest(), &motion),
            elastic + damping,
            1e-12,
        );
    }
}
