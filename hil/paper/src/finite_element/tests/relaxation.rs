use std::f64::consts::{PI, TAU};

use mesh_damper_reference::dynamic_test::loop_area;
use nalgebra::Vector6;
use proptest::prelude::*;

use super::{FOAM, sheared_cube, unknowns};
use crate::finite_element::body::Body;
use crate::finite_element::drive::{Drive, DrivenSine, ForceLoop};
use crate::finite_element::material::MooneyRivlin;
use crate::finite_element::mesh::Mesh;
use crate::finite_element::published::TABLE_5;
use crate::finite_element::relaxation::{History, Prony, Step};

/// mm, on a cube of 1 mm.
const AMPLITUDE: f64 = 1e-4;

/// Components of the force in phase with the displacement and with the velocity, over the displacement's amplitude.
fn components(steady: &ForceLoop) -> (f64, f64) {
    let count = steady.force.len() as f64;
    let samples = steady.force.iter().enumerate();
    samples.fold((0.0, 0.0), |(storage, loss), (n, force)| {
        let (sin, cos) = (TAU * (n + 1) as f64 / count).sin_cos();
        let scale = 2.0 / (count * AMPLITUDE);
        (storage + scale * force * sin, loss + scale * force * cos)
    })
}

fn steady(drive: &Drive, prony: Prony, frequency: f64, steps: usize) -> ForceLoop {
    drive
        .cycles(
            prony,
            DrivenSine {
                amplitude: AMPLITUDE,
                frequency,
                steps,
            },
        )
        .steady()
        .unwrap()
}

/// A unit cube of one element in simple shear: its force over its displacement is the shear modulus.
#[test]
fn one_element_has_the_storage_and_loss_modulus_of_the_series() {
    let drive = sheared_cube(FOAM, [1, 1, 1]);
    for frequency in [0.1, 0.5, 1.0, 3.0] {
        // Slower motions have less storage, so the same error is a larger fraction of it: steps are at most 1/64 s.
        let steps = f64::max(64.0, 64.0 / frequency) as usize;
        let steady = steady(&drive, TABLE_5, frequency, steps);
        let ours = components(&steady);
        let (storage, loss) = TABLE_5.moduli(frequency);
        let errors = (
            ours.0 / (FOAM.shear_modulus() * storage) - 1.0,
            ours.1 / (FOAM.shear_modulus() * loss) - 1.0,
        );
        println!(
            "{frequency} Hz: storage {:+.3} %, loss {:+.3} %, {} cycles",
            100.0 * errors.0,
            100.0 * errors.1,
            steady.cycle
        );
        assert!(
            errors.0.abs() < 0.005 && errors.1.abs() < 0.005,
            "{frequency} Hz: {errors:?}"
        );
    }
}

/// The error is proportional to the square of the time step.
#[test]
fn moduli_converge_with_the_square_of_the_step() {
    let drive = sheared_cube(FOAM, [1, 1, 1]);
    let storage = FOAM.shear_modulus() * TABLE_5.moduli(1.0).0;
    let errors = [16, 32, 64]
        .map(|steps| components(&steady(&drive, TABLE_5, 1.0, steps)).0 / storage - 1.0);
    for pair in errors.windows(2) {
        assert!(
            (1.8..2.2).contains(&(pair[0] / pair[1]).log2()),
            "{errors:?}"
        );
    }
}

/// A unit cube of one element whose faces at x, y and z = 1 are moved outwards: those of `axes`, while the others stay.
fn swollen_cube(axes: &[usize]) -> Drive {
    let mesh = Mesh::of_cube([1; 3], |at| at);
    let moved = axes
        .iter()
        .flat_map(|&axis| unknowns(&mesh, &[axis], |at| at[axis] == 1.0))
        .collect();
    let all = unknowns(&mesh, &[0, 1, 2], |_| true);
    Drive {
        body: Body::new(mesh, FOAM, None, all).unwrap(),
        moved,
        force_scale: 1.0,
    }
}

/// The bulk modulus does not relax: a pure change of volume gives no loop, and takes 2D·(J − 1) on each face. The same stretch
/// along one axis also changes the shape, and gives one.
#[test]
fn a_change_of_volume_leaves_no_loop_and_one_of_shape_does() {
    const SWELLING: f64 = 0.1;
    let cycle = |axes: &[usize]| {
        let motion = DrivenSine {
            amplitude: SWELLING,
            frequency: 1.0,
            steps: 64,
        };
        let drive = swollen_cube(axes);
        let mut cycles = drive.cycles(TABLE_5, motion);
        cycles.next().unwrap();
        cycles.next().unwrap()
    };
    let volumetric = cycle(&[0, 1, 2]);
    for (u, force) in volumetric.displacement.iter().zip(&volumetric.force) {
        let side = 1.0 + u;
        let expected = 3.0 * side * side * FOAM.bulk_modulus() * (side.powi(3) - 1.0);
        assert!(
            (force - expected).abs() < 1e-9,
            "{u} mm: {force} {expected}"
        );
    }
    let area = |cycle: &ForceLoop| loop_area(&cycle.displacement, &cycle.force);
    assert!(area(&volumetric).abs() < 1e-9);
    let along_one = cycle(&[0]);
    // The ellipse for the loss modulus of that shear: 4/3 of it, at small strain.
    let small = PI * 4.0 / 3.0 * FOAM.shear_modulus() * TABLE_5.moduli(1.0).1 * SWELLING.powi(2);
    let ratio = area(&along_one) / small;
    println!("stretched along one axis: {ratio:.3} of the loop at small strain");
    assert!((0.9..1.1).contains(&ratio), "{ratio}");
}

#[test]
fn a_share_of_nothing_leaves_no_loop() {
    let elastic = Prony {
        shares: [0.0; 2],
        times: TABLE_5.times,
    };
    let drive = sheared_cube(MooneyRivlin { c11: 0.0, ..FOAM }, [1, 1, 1]);
    let (storage, loss) = components(&steady(&drive, elastic, 1.0, 16));
    assert!((storage / FOAM.shear_modulus() - 1.0).abs() < 1e-6);
    assert!((loss / storage).abs() < 1e-9);
}

proptest! {
    /// A stress that rises evenly and is then held decays according to the series, whatever the steps.
    #[test]
    fn a_ramp_and_a_hold_are_exact(rise in 0.01..1.0, hold in 0.01..3.0) {
        let stress = Vector6::new(1.0, -2.0, 0.5, 0.1, 0.0, 3.0);
        let mut history = History::default();
        let ramp = Step::new(&TABLE_5, rise);
        history.advance(&ramp, stress);
        let hold_step = Step::new(&TABLE_5, hold);
        let relaxed = stress * hold_step.factor() + history.memory(&hold_step);
        let terms = TABLE_5.shares.iter().zip(&TABLE_5.times);
        let share = terms.fold(TABLE_5.lasting(), |sum, (share, time)| {
            sum + share * (time / rise) * (1.0 - (-rise / time).exp()) * (-hold / time).exp()
        });
        prop_assert!((relaxed - stress * share).amax() < 1e-12);
    }

    /// A single period gives the histories after many periods.
    #[test]
    fn one_period_tells_where_many_lead(amplitude in 0.1..10.0, period in 0.2..2.0) {
        let step = Step::new(&TABLE_5, period / 20.0);
        let run = |history: &mut History| for n in 1..=20 {
            history.advance(&step, Vector6::repeat(amplitude * (TAU * f64::from(n) / 20.0).sin()));
        };
        let mut long = History::default();
        (0..60).for_each(|_| run(&mut long));
        let mut short = History::default();
        run(&mut short);
        short.repeat(&History::default(), &TABLE_5, period);
        let difference = long.memory(&step) - short.memory(&step);
        prop_assert!(difference.amax() < 1e-9 * amplitude);
    }
}
