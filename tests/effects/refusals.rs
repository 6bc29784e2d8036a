//! Constructors report the field that they refuse.

use mesh_damper::effects::{
    Asymmetry, Backlash, BoucWen, Compliance, Degradation, Delay, Directional, Drift, ForceFilter,
    Gap, Hardening, HardeningFriction, Inertia, LoadFriction, MAX_TONES, Offset, Periodic,
    Relaxation, StickSlip, Stop, Temperature, Viscous, Weakening, Yielding,
};
use mesh_damper::error::ConfigError;

#[test]
fn constructors_name_the_field_they_refuse() {
    let field = |error: ConfigError| match error {
        ConfigError::NonFinite(field) | ConfigError::Empty(field) => field,
        ConfigError::OutOfRange { field, .. } | ConfigError::Full { field, .. } => field,
        other => panic!("{other} contains no field"),
    };
    assert_eq!(field(Offset::new(f32::NAN).unwrap_err()), "force");
    assert_eq!(field(Asymmetry::new(1e10).unwrap_err()), "k2");
    assert_eq!(field(Hardening::new(f64::INFINITY).unwrap_err()), "k5");
    assert_eq!(field(Viscous::new(-2e9).unwrap_err()), "c1");
    assert_eq!(field(Inertia::new(2e6).unwrap_err()), "mass");
    assert_eq!(field(LoadFriction::new(-1e-3).unwrap_err()), "load");
    assert_eq!(field(LoadFriction::new(f32::INFINITY).unwrap_err()), "load");
    for difference in [-1.001, 1.001, f64::NAN] {
        assert_eq!(
            field(Directional::new(difference).unwrap_err()),
            "difference"
        );
    }
    assert_eq!(field(StickSlip::<f32>::new(&[]).unwrap_err()), "elements");
    assert_eq!(
        field(StickSlip::new(&[(1.0, 0.1); 7]).unwrap_err()),
        "elements"
    );
    assert_eq!(
        field(StickSlip::new(&[(1.0, 0.1), (1.0, 0.0)]).unwrap_err()),
        "slip_limit"
    );
    assert_eq!(
        field(StickSlip::new(&[(f32::NAN, 0.1)]).unwrap_err()),
        "stiffness"
    );
    assert_eq!(
        field(Relaxation::<f32>::new(&[], 1e-4).unwrap_err()),
        "branches"
    );
    assert_eq!(
        field(Relaxation::new(&[(1.0, 0.1); 4], 1e-4).unwrap_err()),
        "branches"
    );
    assert_eq!(
        field(Relaxation::new(&[(1.0, 0.1), (1.0, 0.0)], 1e-4).unwrap_err()),
        "time"
    );
    assert_eq!(
        field(Relaxation::new(&[(1.0, 0.1)], 0.0).unwrap_err()),
        "tick"
    );
    assert_eq!(field(Drift::new(1.0, 0.0).unwrap_err()), "cycles");
    let drift = Drift::new(0.0, 25.0).unwrap();
    assert_eq!(
        field(drift.with_forces(0.0, f64::NAN).unwrap_err()),
        "damping_change"
    );
    assert_eq!(field(Temperature::new(2.0, 20.0).unwrap_err()), "beta");
    assert_eq!(
        field(Temperature::new(0.1, -300.0).unwrap_err()),
        "reference"
    );
    let both = Temperature::new(0.1, 20.0).unwrap();
    assert_eq!(
        field(both.with_damping(f64::NAN).unwrap_err()),
        "beta_damping"
    );
    assert_eq!(field(Stop::<f32>::new(&[]).unwrap_err()), "contacts");
    assert_eq!(field(Stop::new(&[(1.0, 0.1); 3]).unwrap_err()), "contacts");
    assert_eq!(
        field(Stop::new(&[(1.0, 0.1), (-1.0, -0.1)]).unwrap_err()),
        "stiffness"
    );
    assert_eq!(field(Stop::new(&[(1.0, 0.0)]).unwrap_err()), "gap");
    assert_eq!(field(Gap::new(-0.1, true).unwrap_err()), "half_width");
    assert_eq!(field(Gap::new(f32::NAN, false).unwrap_err()), "half_width");
    assert_eq!(
        field(BoucWen::new(f64::INFINITY, 0.1, 1.0).unwrap_err()),
        "stiffness"
    );
    assert_eq!(
        field(BoucWen::new(1.0, 0.0, 1.0).unwrap_err()),
        "slip_limit"
    );
    assert_eq!(field(BoucWen::new(1.0, 0.1, 0.4).unwrap_err()), "sharpness");
    assert_eq!(field(BoucWen::new(1.0, 0.1, 8.1).unwrap_err()), "sharpness");
    let hardening = |sharpness, hardening, loss| {
        field(HardeningFriction::new(1.0, 0.1, sharpness, hardening, loss).unwrap_err())
    };
    assert_eq!(hardening(8.1, 1.0, 1.0), "sharpness");
    assert_eq!(hardening(1.0, -1.1, 1.0), "hardening");
    assert_eq!(hardening(1.0, 1.0, f64::NAN), "loss");
    let yielding = |stretch, rate, time, tick| {
        field(Yielding::new(1.0, stretch, rate, time, tick).unwrap_err())
    };
    assert_eq!(
        field(Yielding::new(f32::NAN, 0.1, 1.0, 0.0, 1e-3).unwrap_err()),
        "stiffness"
    );
    assert_eq!(yielding(-0.1, 1.0, 0.0, 1e-3), "yield_stretch");
    assert_eq!(yielding(0.1, 0.0, 0.0, 1e-3), "rate");
    assert_eq!(yielding(0.1, 1.0, -1e-3, 1e-3), "time");
    assert_eq!(yielding(0.1, 1.0, 0.0, 0.0), "tick");
    assert_eq!(
        field(Backlash::new(2e9, 0.1, 0.1).unwrap_err()),
        "stiffness"
    );
    assert_eq!(
        field(Backlash::new(1.0, 0.0, 0.1).unwrap_err()),
        "slip_limit"
    );
    assert_eq!(field(Backlash::new(1.0, 0.1, -1e-3).unwrap_err()), "slack");
    assert_eq!(
        field(Backlash::new(1.0, 0.1, f32::NAN).unwrap_err()),
        "slack"
    );
    assert_eq!(
        field(Degradation::new(f32::NAN, 0.1, 0.0).unwrap_err()),
        "stiffness"
    );
    assert_eq!(
        field(Degradation::new(1.0, 0.0, 0.0).unwrap_err()),
        "softening"
    );
    for pinching in [-1e-3, 1.001, f64::INFINITY] {
        let refused = Degradation::new(1.0, 0.1, pinching).unwrap_err();
        assert_eq!(field(refused), "pinching");
    }
    let weakening = |stiffness, slip_limit, loss, energy| {
        field(Weakening::new(stiffness, slip_limit, loss, energy).unwrap_err())
    };
    assert_eq!(weakening(f64::INFINITY, 0.1, 0.5, 1.0), "stiffness");
    assert_eq!(weakening(1.0, 0.0, 0.5, 1.0), "slip_limit");
    assert_eq!(weakening(1.0, 0.1, 1.001, 1.0), "loss");
    assert_eq!(weakening(1.0, 0.1, -1e-3, 1.0), "loss");
    assert_eq!(weakening(1.0, 0.1, 0.5, 0.0), "energy");
    assert_eq!(weakening(1.0, 0.1, 0.5, f64::NAN), "energy");
    let periodic = |amplitude, frequency, phase, tick| {
        field(Periodic::new(&[(amplitude, frequency, phase)], tick).unwrap_err())
    };
    assert_eq!(periodic(f32::NAN, 50.0, 0.0, 1e-4), "amplitude");
    assert_eq!(field(Periodic::<f32>::new(&[], 1e-4).unwrap_err()), "tones");
    assert_eq!(
        field(Periodic::new(&[(1.0, 50.0, 0.0); MAX_TONES + 1], 1e-4).unwrap_err()),
        "tones"
    );
    assert_eq!(periodic(1.0, 5000.0, 0.0, 1e-4), "frequency");
    assert_eq!(periodic(1.0, 0.0, 0.0, 1e-4), "frequency");
    assert_eq!(periodic(1.0, 50.0, f64::NAN, 1e-4), "phase");
    assert_eq!(periodic(1.0, 50.0, 0.0, 0.0), "tick");
    assert_eq!(field(Compliance::new(0.0, 1e-4).unwrap_err()), "stiffness");
    assert_eq!(field(Compliance::new(-5.0, 1e-4).unwrap_err()), "stiffness");
    assert_eq!(
        field(Compliance::new(5.0, f32::INFINITY).unwrap_err()),
        "tick"
    );
    assert_eq!(field(Delay::new(-1e-3, 1e-4).unwrap_err()), "time");
    assert_eq!(field(Delay::new(0.02551, 1e-4).unwrap_err()), "time");
    assert_eq!(field(Delay::new(1e-3, 0.0).unwrap_err()), "tick");
    for corner in [0.9, 1.1e7, f32::NAN] {
        assert_eq!(field(ForceFilter::new(corner, 1e-4).unwrap_err()), "corner");
    }
    assert_eq!(field(ForceFilter::new(200.0, 2e3).unwrap_err()), "tick");
}
