//! Constructors report the field that they refuse. `tests/laws/ranges.rs` tests the range of each number.

use mesh_damper::effects::{
    Drift, ForceFilter, MAX_TONES, Periodic, Relaxation, StickSlip, Stop, Temperature,
};
use mesh_damper::error::ConfigError;

#[test]
fn constructors_name_the_field_they_refuse() {
    let field = |error: ConfigError| match error {
        ConfigError::NonFinite(field) | ConfigError::Empty(field) => field,
        ConfigError::OutOfRange { field, .. } | ConfigError::Full { field, .. } => field,
        other => panic!("{other} contains no field"),
    };
    let elements = |elements: &[_]| field(StickSlip::<f32>::new(elements).unwrap_err());
    assert_eq!(elements(&[]), "elements");
    assert_eq!(elements(&[(1.0, 0.1); 7]), "elements");
    assert_eq!(elements(&[(1.0, 0.1), (1.0, 0.0)]), "slip_limit");
    let branches = |branches: &[_]| field(Relaxation::<f32>::new(branches, 1e-4).unwrap_err());
    assert_eq!(branches(&[]), "branches");
    assert_eq!(branches(&[(1.0, 0.1); 4]), "branches");
    assert_eq!(branches(&[(1.0, 0.1), (1.0, 0.0)]), "time");
    let contacts = |contacts: &[_]| field(Stop::<f32>::new(contacts).unwrap_err());
    assert_eq!(contacts(&[]), "contacts");
    assert_eq!(contacts(&[(1.0, 0.1); 3]), "contacts");
    assert_eq!(contacts(&[(1.0, 0.1), (-1.0, -0.1)]), "stiffness");
    assert_eq!(contacts(&[(1.0, 0.0)]), "gap");
    let tones = |tones: &[_]| field(Periodic::<f32>::new(tones, 1e-4).unwrap_err());
    assert_eq!(tones(&[]), "tones");
    assert_eq!(tones(&[(1.0, 50.0, 0.0); MAX_TONES + 1]), "tones");
    let drift = Drift::new(0.0, 25.0).unwrap();
    assert_eq!(
        field(drift.with_forces(0.0, f64::NAN).unwrap_err()),
        "damping_change"
    );
    let both = Temperature::new(0.1, 20.0).unwrap();
    assert_eq!(
        field(both.with_damping(f64::NAN).unwrap_err()),
        "beta_damping"
    );
    assert_eq!(field(ForceFilter::new(200.0, 2e3).unwrap_err()), "tick");
}
