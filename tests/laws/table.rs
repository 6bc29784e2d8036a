//! The coefficient grid: the paper's cells, interpolation, edges, and the inputs that a builder refuses.

use core::f64::consts::{PI, TAU};
use mesh_damper::amplitude_independent;
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::table::{PAPER, Placement, TableBuilder, TableError};
use proptest::prelude::*;

fn coefficients(law: &Law<f32>) -> [f32; 4] {
    [law.k1(), law.k3(), law.c(), law.alpha()]
}

fn nodes() -> ([f32; 5], [f32; 5]) {
    let mut densities = [0.0; 5];
    let mut amplitudes = [0.0; 5];
    densities
        .iter_mut()
        .zip(PAPER.densities())
        .for_each(|(to, from)| *to = from);
    amplitudes
        .iter_mut()
        .zip(PAPER.amplitudes())
        .for_each(|(to, from)| *to = from);
    (densities, amplitudes)
}

#[test]
fn the_nodes_are_the_papers_cells() {
    let (densities, amplitudes) = nodes();
    assert_eq!(densities, [2.0, 2.5, 3.0, 3.5, 4.0]);
    assert_eq!(amplitudes, [0.05, 0.1, 0.15, 0.2, 0.25]);
    let at = |density, amplitude| {
        let lookup = PAPER.lookup(density, amplitude);
        assert!(!lookup.clamped());
        coefficients(&lookup.law)
    };
    // The corners, the cells that deviate from the surface, and Table 7's last row.
    assert_eq!(at(2.0, 0.05), [0.3365, 86.7, 0.0235, 0.4014]);
    assert_eq!(at(4.0, 0.05), [7.5503, 160.9, 0.1107, 0.2569]);
    assert_eq!(at(3.0, 0.10), [1.0539, 10.5, 0.1114, 0.3969]);
    assert_eq!(at(4.0, 0.15), [8.8699, 5.2, 0.4147, 0.2053]);
    assert_eq!(at(3.5, 0.20), [1.7452, 21.5, 0.1320, 0.3143]);
    assert_eq!(at(2.5, 0.25), [0.9585, 34.9, 0.2247, 0.2722]);
    assert_eq!(
        densities.map(|density| at(density, 0.25)[1]),
        [9.4, 34.9, 4.7, 8.1, 18.5]
    );
}

#[test]
fn every_cell_is_a_law() {
    let (densities, amplitudes) = nodes();
    for density in densities {
        for amplitude in amplitudes {
            let law = PAPER.lookup(density, amplitude).law;
            let [k1, k3, c, alpha] = coefficients(&law);
            assert_eq!(Law::new(k1, k3, c, alpha), Ok(law));
            assert!((0.22..9.36).contains(&k1) && (4.7..186.0).contains(&k3));
            assert!((0.023..0.66).contains(&c) && (0.158..0.558).contains(&alpha));
        }
    }
}

#[test]
fn the_cells_give_the_loss_factors_that_were_recomputed_from_the_paper() {
    // At 0.1 mm and 1 Hz, from 2.0 to 4.0 g/cm³, to three digits: this detects a coefficient in the wrong cell.
    let expected = [0.557, 0.481, 0.625, 0.311, 0.257];
    for (density, expected) in nodes().0.into_iter().zip(expected) {
        let law = PAPER.lookup(density, 0.1).law.cast::<f64>();
        let n = 20_000;
        let (mut energy, mut largest) = (0.0, 0.0);
        for i in 0..n {
            let (sin, cos) = (TAU * (f64::from(i) + 0.5) / f64::from(n)).sin_cos();
            let force = law.force(0.1 * sin, 0.1 * TAU * cos);
            energy += force * 0.1 * cos * TAU / f64::from(n);
            largest = f64::max(largest, force);
        }
        let loss_factor = energy / (PI * largest * 0.1);
        assert!(
            (loss_factor - expected).abs() < 6e-4,
            "{density}: {loss_factor} {expected}"
        );
    }
}

#[test]
fn outside_it_is_the_nearest_edge_and_says_where() {
    use Placement::{Above, Below, Inside};
    for (density, amplitude, edge, where_density, where_amplitude) in [
        (1.9, 0.1, (2.0, 0.1), Below, Inside),
        (4.1, 0.1, (4.0, 0.1), Above, Inside),
        (3.0, 0.049, (3.0, 0.05), Inside, Below),
        (3.0, 0.26, (3.0, 0.25), Inside, Above),
        (-1e30, 1e30, (2.0, 0.25), Below, Above),
        (f32::INFINITY, f32::NEG_INFINITY, (4.0, 0.05), Above, Below),
        (f32::NAN, f32::NAN, (2.0, 0.05), Below, Below),
    ] {
        let lookup = PAPER.lookup(density, amplitude);
        assert!(lookup.clamped());
        assert_eq!(
            (lookup.density, lookup.amplitude),
            (where_density, where_amplitude)
        );
        assert_eq!(lookup.law, PAPER.lookup(edge.0, edge.1).law);
    }
    assert!(!PAPER.lookup(2.0, 0.25).clamped());
    assert!(!PAPER.lookup(4.0, 0.05).clamped());
}

/// A grid whose coefficients are bilinear in density and amplitude, so that interpolation must give them back.
fn bilinear(density: f64, amplitude: f64) -> [f64; 4] {
    [
        1.0 + 2.0 * density - 3.0 * amplitude + 4.0 * density * amplitude,
        -5.0 * density * amplitude,
        0.1 * density + amplitude,
        0.2 + 0.1 * density * amplitude,
    ]
}

proptest! {
    #[test]
    fn interpolation_is_bilinear(density in 1.0f64..4.0, amplitude in 0.1f64..1.0) {
        let (densities, amplitudes) = ([1.0, 1.3, 2.9, 4.0], [0.1, 0.4, 1.0]);
        let mut builder = TableBuilder::<6, 4>::new(&densities, &amplitudes).unwrap();
        for (i, &density) in densities.iter().enumerate() {
            for (j, &amplitude) in amplitudes.iter().enumerate() {
                builder = builder.cell(i, j, bilinear(density, amplitude)).unwrap();
            }
        }
        let lookup = builder.build().unwrap().lookup(density as f32, amplitude as f32);
        let largest = [26.0, 20.0, 1.4, 0.6];
        for ((is, exact), largest) in
            coefficients(&lookup.law).into_iter().zip(bilinear(density, amplitude)).zip(largest)
        {
            // Nodes, cells, both fractions and three mixes, each rounded to 6e-8; the spacing of the nodes amplifies the fraction's
            // error.
            prop_assert!((f64::from(is) - exact).abs() < 2e-6 * largest, "{} {}", is, exact);
        }
    }

    #[test]
    fn between_the_cells_a_coefficient_is_between_theirs(density in 1.5f32..4.5, amplitude in 0.01f32..0.3) {
        let [k1, k3, c, alpha] = coefficients(&PAPER.lookup(density, amplitude).law);
        prop_assert!(Law::new(k1, k3, c, alpha).is_ok());
        let (densities, amplitudes) = nodes();
        let around = |nodes: [f32; 5], value: f32, step: f32| nodes.map(|node| (node - value).abs() < step * 1.001);
        let mut low = [f32::INFINITY; 4];
        let mut high = [f32::NEG_INFINITY; 4];
        let clamp = |value: f32, nodes: [f32; 5]| value.clamp(nodes[0], nodes[4]);
        for (near_d, d) in around(densities, clamp(density, densities), 0.5).into_iter().zip(densities) {
            for (near_a, a) in around(amplitudes, clamp(amplitude, amplitudes), 0.05).into_iter().zip(amplitudes) {
                if near_d && near_a {
                    for (i, value) in coefficients(&PAPER.lookup(d, a).law).into_iter().enumerate() {
                        low[i] = low[i].min(value);
                        high[i] = high[i].max(value);
                    }
                }
            }
        }
        for (i, value) in [k1, k3, c, alpha].into_iter().enumerate() {
            prop_assert!(value >= low[i] - 1e-5 * high[i] && value <= high[i] * 1.00001);
        }
    }
}

#[test]
fn one_node_is_enough() {
    let table = TableBuilder::<3, 3>::new(&[2.0], &[0.1])
        .unwrap()
        .cell(0, 0, [1.0, 2.0, 0.5, 0.25])
        .unwrap();
    let table = table.build().unwrap();
    assert_eq!(
        coefficients(&table.lookup(2.0, 0.1).law),
        [1.0, 2.0, 0.5, 0.25]
    );
    assert!(!table.lookup(2.0, 0.1).clamped());
    assert_eq!(table.lookup(3.0, 0.05).density, Placement::Above);
    assert_eq!(
        coefficients(&table.lookup(3.0, 0.05).law),
        [1.0, 2.0, 0.5, 0.25]
    );
}

#[test]
fn nodes_that_make_no_sense_are_refused() {
    let nodes = |densities: &[f64], amplitudes: &[f64]| match TableBuilder::<3, 2>::new(
        densities, amplitudes,
    ) {
        Err(TableError::Nodes(error)) => error,
        other => panic!("{other:?}"),
    };
    let good = &[0.1, 0.2];
    assert_eq!(nodes(&[], good), ConfigError::Empty("densities"));
    assert_eq!(nodes(&[2.0], &[]), ConfigError::Empty("amplitudes"));
    assert_eq!(
        nodes(&[2.0, 2.0], good),
        ConfigError::NotIncreasing("densities")
    );
    assert_eq!(
        nodes(&[2.0, 1.9], good),
        ConfigError::NotIncreasing("densities")
    );
    assert_eq!(
        nodes(&[2.0], &[0.1, 0.1 + 1e-12]),
        ConfigError::NotIncreasing("amplitudes")
    );
    assert_eq!(
        nodes(&[2.0, f64::NAN], good),
        ConfigError::NonFinite("densities")
    );
    assert!(matches!(
        nodes(&[-1.0], good),
        ConfigError::OutOfRange {
            field: "densities",
            ..
        }
    ));
    assert!(matches!(
        nodes(&[2.0], &[0.0]),
        ConfigError::OutOfRange {
            field: "amplitudes",
            ..
        }
    ));
    assert_eq!(
        nodes(&[1.0, 2.0, 3.0, 4.0], good),
        ConfigError::Full {
            field: "densities",
            capacity: 3
        }
    );
    assert_eq!(
        nodes(&[1.0], &[0.1, 0.2, 0.3]),
        ConfigError::Full {
            field: "amplitudes",
            capacity: 2
        }
    );
}

#[test]
fn a_cell_that_makes_no_sense_is_refused_with_its_place() {
    let builder = || TableBuilder::<3, 3>::new(&[2.0, 3.0], &[0.1, 0.2]).unwrap();
    let good = [1.0, 2.0, 0.5, 0.25];
    for (index, field) in ["k1", "k3", "c", "alpha"].into_iter().enumerate() {
        let mut bad = good;
        bad[index] = f64::NAN;
        let error = builder().cell(1, 0, bad).unwrap_err();
        assert_eq!(
            error,
            TableError::Cell {
                density: 1,
                amplitude: 0,
                error: ConfigError::NonFinite(field)
            }
        );
        assert!(error.to_string().contains(field));
    }
    let damping = builder().cell(0, 1, [1.0, 2.0, -0.1, 0.25]).unwrap_err();
    assert!(matches!(
        damping,
        TableError::Cell {
            density: 0,
            amplitude: 1,
            error: ConfigError::OutOfRange { field: "c", .. }
        }
    ));
    // A third density would fit the capacity but is not a node.
    assert_eq!(
        builder().cell(2, 0, good).unwrap_err(),
        TableError::NoSuchCell {
            density: 2,
            amplitude: 0
        }
    );
    assert_eq!(
        builder().cell(0, 9, good).unwrap_err(),
        TableError::NoSuchCell {
            density: 0,
            amplitude: 9
        }
    );
    let twice = builder().cell(0, 0, good).unwrap().cell(0, 0, good);
    assert_eq!(
        twice.unwrap_err(),
        TableError::Twice {
            density: 0,
            amplitude: 0
        }
    );
    let short = builder()
        .cell(0, 0, good)
        .unwrap()
        .cell(1, 0, good)
        .unwrap()
        .cell(0, 1, good)
        .unwrap();
    assert_eq!(
        short.build().unwrap_err(),
        TableError::Missing {
            density: 1,
            amplitude: 1
        }
    );
}

/// The law of the nearest density, with both of its effects.
#[test]
fn the_law_without_amplitude_is_the_nearest_densitys() {
    let law = |density| amplitude_independent::law(density).unwrap();
    for (density, row) in [(2.2, 2.0), (2.3, 2.5), (2.9, 3.0), (3.3, 3.5), (3.8, 4.0)] {
        assert_eq!(law(density), law(row));
        let others = [2.0, 2.5, 3.0, 3.5, 4.0].into_iter();
        assert!(
            others
                .filter(|other| *other != row)
                .all(|other| law(other) != law(row))
        );
        assert_eq!(law(row).augmented().effects().count(), 2);
    }
}
