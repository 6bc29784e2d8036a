//! The crate runs exactly the law that identification fits: the errors that guide a fit are those of the resulting law.

use mesh_damper_identify::base_law::BaseLaw;
use mesh_damper_identify::families::{Entry, Form};
use mesh_damper_identify::problem::Problem;
use mesh_damper_identify::rows::Rows;
use mesh_damper_identify::screen::Screen;
use mesh_damper_identify::shape::Extent;
use mesh_damper_identify::solution::Solution;
use mesh_damper_identify::term::Term;
use mesh_damper_model::predict::predict;
use mesh_damper_recording::trajectory::Trajectory;

use crate::hidden::{self, block, record_at};

/// Every two forms that may be in one model, with the linear part fitted. A spring in series is left out: its deflection is held
/// fixed while it is fitted.
#[test]
fn the_error_of_a_fit_is_that_of_the_law_that_comes_of_it() {
    let warms = |time: f64| Some(20.0 + 3.0 * time);
    // A little of everything, and nothing alone.
    let hidden = Box::new(|s: &hidden::Sample| {
        let tone = 0.05 * (std::f64::consts::TAU * 41.0 * s.time + 1.0).sin();
        let warm = -0.01 * (s.temperature - 20.0) * s.law;
        let pressed = 0.4 * s.displacement.abs() * s.velocity.signum();
        tone + warm + pressed + 0.02 + 0.3 * s.displacement * s.cycles - 0.004 * s.velocity.powi(2)
    });
    let blocks = [block(0.1, 2.0, 4), block(0.2, 5.0, 6)];
    let trajectories = [record_at(warms, &blocks, hidden, 3)];
    let rows = Rows::gather(
        &trajectories,
        BaseLaw::Mixed,
        vec![0.1, 0.2],
        usize::MAX,
        |_, _| true,
    );
    let extent = Extent::of(&trajectories).with_tones(vec![41.0]);
    let alone = Problem::new(&rows, &extent, &[]).solve();
    let term = |form| Term::sought(form, 20.0);
    // Delayed by whole ticks and a fraction of one.
    let shapes = |form: Form, law: &Solution| match form.name {
        "delay" => vec![6.7e-3],
        // A slow filter carries the amplitude of one block into the next, where a fit uses the amplitude of each row throughout.
        "force_filter" => vec![60.0],
        _ => Screen::at(&rows, &extent, law).starts(term(form))[0]
            .shapes
            .clone(),
    };
    let forms: Vec<Form> = Form::all()
        .filter(|form| form.name != "compliance")
        .collect();
    for &first in &forms {
        let problem = Problem::new(&rows, &extent, &[term(first)]);
        // The sizes of terms that scale eq 13 are searched.
        let with_first = match first.entry {
            Entry::Scales(_) => problem.solve_from(&alone, &shapes(first, &alone)),
            _ => problem.solve_at(&alone, &shapes(first, &alone)),
        };
        let is_there = |size: &f64| size.abs() > 1e-4;
        assert!(
            !matches!(first.entry, Entry::Scales(_))
                || with_first.terms[0].sizes.iter().all(is_there)
        );
        for &second in forms
            .iter()
            .filter(|form| **form != first && !form.excludes(first))
        {
            let both = Problem::new(&rows, &extent, &[term(first), term(second)]);
            let both = both.solve_at(&with_first, &shapes(second, &with_first));
            let force = predict(&both.model(), &trajectories[0]).unwrap();
            let telling = (0..force.len()).filter(|&sample| trajectories[0].is_telling(sample));
            let errors = telling.map(|sample| force[sample] - trajectories[0].force[sample]);
            let squares: f64 = errors.map(|error| error.powi(2)).sum();
            assert!(
                (squares - both.squares).abs() < 1e-3 * squares,
                "{first:?} and {second:?}: {} kN² fitted, {squares} run",
                both.squares
            );
        }
    }
}

/// A force proportional to the cube of a tiny displacement would need more than the crate's range: the fit ends at that range.
#[test]
fn a_coefficient_ends_where_the_crate_does() {
    let time = (0..4000).map(|index| f64::from(index) / 500.0);
    let phases: Vec<f64> = time.map(|time| std::f64::consts::TAU * time).collect();
    let displacement: Vec<f64> = phases.iter().map(|phase| 1e-4 * phase.sin()).collect();
    let force = phases.iter().map(|phase| phase.sin().powi(3)).collect();
    let trajectories = [Trajectory::new(
        "tiny",
        2e-3,
        &displacement,
        force,
        None,
        None,
    )];
    let rows = Rows::gather(
        &trajectories,
        BaseLaw::Mixed,
        vec![1e-4],
        usize::MAX,
        |_, _| true,
    );
    let extent = Extent::of(&trajectories);
    let model = Problem::new(&rows, &extent, &[]).solve().model();
    assert_eq!(model.law[0].k3, 1e9);
    assert!(predict(&model, &trajectories[0]).is_ok());
}
