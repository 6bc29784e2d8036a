//! |v|^α against libm in f64.

use mesh_damper::power::{PowerSeed, PowerTable, ROWS, abs_pow};
use mesh_damper::real::Real;
use proptest::prelude::*;

/// With U = 2⁻²⁴ = 6e-8. The logarithm, at most 0.58 and multiplied by α·ln 2: its fit, 1.5·U, four roundings and one down to Q24.
/// The power: its fit, 1.3·U, the deviation from the mean when the exponent is rounded down, 0.7·U, and two roundings. 7.8·U or
/// 4.7e-7 if all errors added up at α = 1.
const SHORT_FORM: f64 = 4e-7;

/// A coefficient is the rounded product of two rounded numbers, 3·U. The sum of their magnitudes is up to 1.6 times the force, 4.8·U.
/// Two sums and two products 2.5·U, and the cubic's own error, at most (α·(1−α)·(2−α)·(3−α)/24)·(1/17)⁴/8 = 1·U. 8.3·U or 5e-7 if all
/// errors added up.
const TABLE: f64 = 4e-7;

fn table(c: f64, alpha: f64) -> PowerTable {
    PowerTable::new(&PowerSeed::new(c, alpha).unwrap())
}

fn relative_error(is: f32, exact: f64) -> f64 {
    (f64::from(is) / exact - 1.0).abs()
}

#[test]
fn the_short_form_over_a_dense_grid() {
    let alphas =
        (0..=50)
            .map(|i| i as f32 / 50.0)
            .chain([0.1581, 0.4014, 0.5571, 1e-3, 1e-7, 0.999_999_94]);
    let mut worst = 0.0f64;
    for alpha in alphas {
        // Every exponent, with mantissas a prime number of units apart, about 1700 an octave.
        let mut bits = 0x0080_0000u32;
        while bits <= 0x7f00_0000 {
            let v = f32::from_bits(bits);
            let error =
                relative_error(abs_pow(v, alpha), libm::pow(f64::from(v), f64::from(alpha)));
            assert!(error < SHORT_FORM, "{v}^{alpha}: {error:e}");
            worst = worst.max(error);
            bits += 4999;
        }
    }
    println!("largest relative error {worst:e}");
}

#[test]
fn the_short_form_over_every_mantissa() {
    let mut worst = 0.0f64;
    for alpha in [0.1581, 0.3279, 0.5571, 1.0] {
        for bits in 0x3f80_0000u32..0x4000_0000 {
            let v = f32::from_bits(bits);
            worst = worst.max(relative_error(
                abs_pow(v, alpha),
                libm::pow(f64::from(v), f64::from(alpha)),
            ));
        }
    }
    assert!(worst < SHORT_FORM, "{worst:e}");
}

#[test]
fn the_ends_of_the_short_form() {
    for alpha in [0.0f32, 1e-6, 0.15, 0.5, 1.0] {
        for v in [0.0f32, -0.0, 1e-40, -1e-40] {
            assert_eq!(abs_pow(v, alpha), 0.0, "{v}^{alpha}");
        }
        for v in [f32::MAX, f32::INFINITY, f32::NAN] {
            let power = abs_pow(v, alpha);
            assert!(power.is_finite(), "{v}^{alpha}");
            assert!(power >= abs_pow(2f32.powi(127), alpha), "{v}^{alpha}");
            assert_eq!(abs_pow(-v, alpha), power);
        }
        assert_eq!(abs_pow(1.0, alpha), 1.0);
        assert_eq!(abs_pow(-3.0, alpha), abs_pow(3.0, alpha));
    }
    for v in [1e-30f32, 0.3, -7.0, 1e38] {
        assert_eq!(abs_pow(v, 0.0), 1.0, "{v}^0");
    }
}

proptest! {
    #[test]
    fn the_short_form_is_finite(bits: u32, alpha in 0.0f32..=1.0) {
        let power = abs_pow(f32::from_bits(bits), alpha);
        prop_assert!(power.is_finite() && power >= 0.0);
    }

    #[test]
    fn the_short_form_multiplies(a in 1e-6f32..1e4, b in 1e-6f32..1e4, alpha in 0.0f32..=1.0) {
        let product = f64::from(abs_pow(a, alpha)) * f64::from(abs_pow(b, alpha));
        // The product's own rounding, 6e-8, and three powers.
        prop_assert!(relative_error(abs_pow(a * b, alpha), product) < 3.0 * SHORT_FORM + 6e-8);
    }

    #[test]
    fn the_table_is_finite_and_odd(bits: u32, c in 0.0f64..=1e9, alpha in 0.0f64..=1.0) {
        let table = table(c, alpha);
        let v = f32::from_bits(bits).clamped(1e6);
        let force = table.damping_force(v);
        prop_assert!(force.is_finite());
        prop_assert_eq!(force, -table.damping_force(-v));
        prop_assert!(force == 0.0 || force.is_sign_positive() == v.is_sign_positive());
    }
}

#[test]
fn the_table_over_a_dense_grid() {
    let mut worst = 0.0f64;
    for c in [1.0, 0.0235, 0.6592] {
        for alpha in [0.0, 0.01, 0.1581, 0.2569, 0.3279, 0.4429, 0.5571, 0.8, 1.0] {
            let table = table(c, alpha);
            // 1.125·2⁻²¹ to 1920, about 3700 an octave.
            let mut bits = (1.125 * 2f32.powi(-21)).to_bits();
            while bits <= 1920f32.to_bits() {
                let v = f32::from_bits(bits);
                let exact = c * libm::pow(f64::from(v), alpha);
                let error = relative_error(table.damping_force(v), exact);
                assert!(error < TABLE, "{c}·{v}^{alpha}: {error:e}");
                assert_eq!(table.damping_force(-v), -table.damping_force(v));
                worst = worst.max(error);
                bits += 2273;
            }
        }
    }
    println!("largest relative error {worst:e}");
}

/// Proportional to v, except for steps of at most an eighth: the edge's force is multiplied by v without its lower bits.
#[test]
fn outside_the_table_it_is_proportional_in_steps() {
    for (c, alpha) in [(0.5, 0.3), (0.1, 0.0), (2.0, 1.0)] {
        let table = table(c, alpha);
        for (edge, parts) in [
            (
                1.125 * 2f32.powi(-21),
                [0.0f32, 1e-30, 1e-3, 0.25, 0.5, 0.999],
            ),
            (1920.0, [1.0, 1.001, 2.0, 10.0, 100.0, 520.0]),
        ] {
            let at_edge = c * libm::pow(f64::from(edge), alpha);
            for part in parts {
                let v = part * edge;
                let step = f32::from_bits(v.to_bits() & 0xfff0_0000);
                let expected = f64::from(step) / f64::from(edge) * at_edge;
                let error = f64::from(table.damping_force(v)) - expected;
                assert!(error.abs() <= TABLE * expected, "{c}·{v}^{alpha}");
                assert_eq!(table.damping_force(-v), -table.damping_force(v));
            }
        }
    }
}

/// For any content of the other rows: a swap relies on this.
#[test]
fn one_row_serves_its_velocities() {
    let (seed, other) = (
        PowerSeed::new(0.4, 0.25).unwrap(),
        PowerSeed::new(0.1, 0.5).unwrap(),
    );
    let whole = PowerTable::new(&seed);
    for row in 0..ROWS {
        let mut table = PowerTable::new(&other);
        table.fill_row(&seed, row);
        let mut served = 0;
        for bits in (1e-7f32.to_bits()..1e6f32.to_bits()).step_by(1 << 18) {
            let v = f32::from_bits(bits);
            if PowerTable::row_of(v) == row {
                assert_eq!(PowerTable::row_of(-v), row);
                assert_eq!(table.damping_force(v), whole.damping_force(v));
                served += 1;
            }
        }
        assert!(served >= 4, "row {row}");
    }
}

#[test]
fn a_table_that_makes_no_sense_is_refused() {
    for c in [-1e-9, 2e9, f64::NAN, f64::INFINITY] {
        assert!(PowerSeed::new(c, 0.5).is_err());
    }
    for alpha in [-0.1, 1.1, f64::NAN] {
        assert!(PowerSeed::new(1.0, alpha).is_err());
    }
}

/// The table that a host computed equals the one that firmware computes from its law.
#[test]
fn a_seed_comes_back_of_its_parts() {
    for (c, alpha) in [
        (0.1, 0.3),
        (0.0, 0.5),
        (1e9, 0.0),
        (1e-38, 1.0),
        (2.5, 0.56),
    ] {
        let seed = PowerSeed::new(c.into(), alpha.into()).unwrap();
        let parts = PowerSeed::from_parts(c, alpha, *seed.octave(), *seed.scale());
        assert_eq!(parts, Ok(seed));
        assert_eq!((seed.c(), seed.alpha()), (c, alpha));
    }
}

proptest! {
    /// Any c and α give numbers that agree with them, and each number that is changed by a hundred thousandth is refused by the name
    /// of its list, as is each that has another sign or is not finite.
    #[test]
    fn a_seed_agrees_with_its_c_and_alpha_alone(
        exponent in -30.0..9.0f32,
        alpha in 0.0..=1.0f32,
        place in 0..64usize,
        change in prop_oneof![
            Just(-1.0f32), Just(0.0), Just(f32::NAN), Just(f32::INFINITY),
            -2.0..0.99999f32, 1.00001..1e6f32,
        ],
    ) {
        let c = 10f32.powf(exponent);
        let seed = PowerSeed::new(c.into(), alpha.into()).unwrap();
        let (mut octave, mut scale) = (*seed.octave(), *seed.scale());
        prop_assert_eq!(PowerSeed::from_parts(c, alpha, octave, scale), Ok(seed));
        let (number, name) = match place.checked_sub(32) {
            None => (&mut octave.as_flattened_mut()[place], "octave"),
            Some(place) => (&mut scale[place], "scale"),
        };
        // A number that is 0, or adds little, may change by its own size.
        prop_assume!(number.abs() > 0.2 || name == "scale");
        *number *= change;
        let refused = PowerSeed::from_parts(c, alpha, octave, scale).unwrap_err().to_string();
        prop_assert!(refused.starts_with(name), "{}", refused);
    }

    /// An accepted seed is within a hundred thousandth of the power, at every speed of the table: a change that passes at the points
    /// at which the numbers are compared is small between them, too.
    #[test]
    fn an_accepted_seed_is_the_power(
        alpha in 0.0..=1.0f32,
        changes in prop::collection::vec((0..32usize, -3e-6..3e-6f32), 0..6),
        speeds in prop::collection::vec(1e-6..1900.0f32, 20),
    ) {
        let seed = PowerSeed::new(1.0, alpha.into()).unwrap();
        let mut octave = *seed.octave();
        for (place, change) in changes {
            octave.as_flattened_mut()[place] += change;
        }
        if let Ok(seed) = PowerSeed::from_parts(1.0, alpha, octave, *seed.scale()) {
            let table = PowerTable::new(&seed);
            for v in speeds {
                let exact = f64::from(v).powf(alpha.into());
                let off = (f64::from(table.damping_force(v)) - exact).abs() / exact;
                prop_assert!(off < 1e-5, "{} at {}", off, v);
            }
        }
    }
}

#[test]
fn a_seed_of_another_law_is_refused() {
    let seed = PowerSeed::new(0.1, 0.3).unwrap();
    let (octave, scale) = (*seed.octave(), *seed.scale());
    for (c, alpha, field) in [
        (0.1001, 0.3, "scale"),
        (0.1, 0.3001, "octave"),
        (-0.1, 0.3, "c"),
        (f32::NAN, 0.3, "c"),
        (0.1, 1.1, "alpha"),
    ] {
        let refused = PowerSeed::from_parts(c, alpha, octave, scale).unwrap_err();
        assert!(refused.to_string().starts_with(field), "{refused}");
    }
}
