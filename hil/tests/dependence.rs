//! On what a residual is said to depend, for hidden effects of which a person would know.

mod hidden;

use hidden::{Hidden, RATE, Sample, fitted, record, start};
use hil::trace::dependence::dependence;

fn found(hidden: impl Fn() -> Hidden) -> Vec<&'static str> {
    let recording = record(&fitted(), hidden(), 1);
    let mut found: Vec<&str> = dependence(&[recording], &start(), |_, _| true)
        .unwrap()
        .iter()
        .map(|dependence| {
            println!("{dependence:?}");
            dependence.on
        })
        .collect();
    found.sort_unstable();
    found
}

fn momentary(force: fn(&Sample) -> f64) -> impl Fn() -> Hidden {
    move || Box::new(force)
}

#[test]
fn noise_depends_on_nothing() {
    assert_eq!(found(momentary(|_| 0.0)), [""; 0]);
}

#[test]
fn friction_that_grows_with_load_depends_on_displacement_and_velocity() {
    let friction = momentary(|s| 0.5 * s.displacement.abs() * s.velocity.signum());
    assert_eq!(found(friction), ["displacement", "velocity"]);
}

#[test]
fn a_cross_term_depends_on_displacement_and_velocity() {
    let cross = momentary(|s| 0.3 * s.displacement * s.velocity);
    assert_eq!(found(cross), ["displacement", "velocity"]);
}

#[test]
fn friction_that_weakens_depends_on_velocity() {
    let weakening = momentary(|s| 0.06 * (-s.velocity.abs() / 0.3).exp() * s.velocity.signum());
    assert_eq!(found(weakening), ["velocity"]);
}

#[test]
fn even_stiffness_depends_on_displacement() {
    assert_eq!(
        found(momentary(|s| 2.0 * s.displacement.powi(2))),
        ["displacement"]
    );
}

#[test]
fn creep_depends_on_time() {
    let found = found(momentary(|s| -0.02 * (1.0 + s.time / 2.0).ln()));
    assert_eq!(found, ["time"]);
}

#[test]
fn a_stiffness_that_wears_with_the_cycles_depends_on_them() {
    let found = found(momentary(|s| {
        0.3 * (-s.cycles / 12.0).exp() * s.displacement
    }));
    assert_eq!(found, ["cycle", "displacement"]);
}

#[test]
fn slip_that_grips_harder_further_out_depends_on_history() {
    let found = found(|| {
        let (mut stretch, mut before) = (0.0_f64, 0.0);
        Box::new(move |s: &Sample| {
            stretch = (stretch + s.displacement - before).clamp(-0.04, 0.04);
            before = s.displacement;
            8.0 * stretch * s.displacement.abs()
        })
    });
    assert!(
        found.contains(&"history") && found.contains(&"displacement"),
        "{found:?}"
    );
    assert!(
        !found.contains(&"time") && !found.contains(&"cycle"),
        "{found:?}"
    );
}

#[test]
fn a_relaxation_depends_on_history_and_frequency() {
    let found = found(|| {
        let (mut stretch, mut before) = (0.0_f64, 0.0);
        Box::new(move |s: &Sample| {
            stretch = stretch * (-1.0 / (RATE * 0.05)).exp() + s.displacement - before;
            before = s.displacement;
            1.0 * stretch
        })
    });
    assert!(
        found.contains(&"history") && found.contains(&"frequency"),
        "{found:?}"
    );
    assert!(
        !found.contains(&"time") && !found.contains(&"cycle"),
        "{found:?}"
    );
}
