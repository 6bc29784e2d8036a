//! Orthogonal tests: the array, the analysis against closed forms, Table 3, and tables of the user's own.

use std::fs;
use std::path::Path;

use mesh_damper_paper::orthogonal::{
    Analysis, Defect, ErrorSource, Experiment, Factor, Response, against_print, analyse, l9,
};
use mesh_damper_reference::orthogonal_test::{LOSS_FACTOR, STIFFNESS};
use proptest::prelude::*;

fn close(value: f64, expected: f64, tolerance: f64) {
    assert!(
        (value - expected).abs() <= tolerance,
        "{value} is not within {tolerance} of {expected}"
    );
}

fn factors(count: usize) -> Vec<Factor> {
    let factor = |index: usize| Factor {
        name: ["A", "B", "C", "D"][index].into(),
        levels: ["1", "2", "3"].map(str::to_owned),
        column: l9().map(|run| run[index]),
    };
    (0..count).map(factor).collect()
}

/// The analysis of one result with `count` factors.
fn analysis(count: usize, runs: [Vec<f64>; 9]) -> Analysis {
    let response = Response {
        name: "result".into(),
        runs,
    };
    let experiment = Experiment::new(factors(count), vec![response]).unwrap();
    analyse(&experiment).remove(0)
}

/// A fifth column orthogonal to all four would split nine runs into more than nine cells, so there is none. Each pair of the four
/// has each pair of levels once, and rows are those of Table 3.
#[test]
fn the_array_is_orthogonal_and_the_papers() {
    assert!(Experiment::new(factors(4), vec![response([0.0; 9])]).is_ok());
    let printed = [
        [1, 1, 1, 1],
        [1, 2, 2, 2],
        [1, 3, 3, 3],
        [2, 1, 2, 3],
        [2, 2, 3, 1],
        [2, 3, 1, 2],
        [3, 1, 3, 2],
        [3, 2, 1, 3],
        [3, 3, 2, 1],
    ];
    assert_eq!(l9().map(|run| run.map(|level| level + 1)), printed);
}

/// Normal, with a deviation of 0.015.
const SCATTER: [f64; 9] = [
    0.001, 0.019, -0.014, 0.015, -0.004, -0.004, 0.028, 0.002, -0.001,
];

fn response(runs: [f64; 9]) -> Response {
    Response {
        name: "result".into(),
        runs: runs.map(|value| vec![value]),
    }
}

#[test]
fn table_3_gives_other_orders_than_the_text() {
    let loss_factor = against_print(&LOSS_FACTOR);
    let numbers = [
        "test load",
        "mesh density",
        "wire diameter",
        "crisscross angle",
    ];
    assert_eq!(loss_factor.order_of_runs, numbers);
    assert_eq!(loss_factor.order_of_printed_ranges, numbers);
    let text = [
        "test load",
        "mesh density",
        "crisscross angle",
        "wire diameter",
    ];
    assert_eq!(loss_factor.order_in_text, text);
    let stiffness = against_print(&STIFFNESS);
    let numbers = [
        "mesh density",
        "test load",
        "wire diameter",
        "crisscross angle",
    ];
    assert_eq!(stiffness.order_of_runs, numbers);
    assert_eq!(stiffness.order_of_printed_ranges, numbers);
    let text = [
        "mesh density",
        "test load",
        "crisscross angle",
        "wire diameter",
    ];
    assert_eq!(stiffness.order_in_text, text);
}

#[test]
fn misprints_of_table_3_are_found_and_nothing_else() {
    assert_eq!(against_print(&STIFFNESS).misprints, []);
    let found: Vec<(String, &str, f64)> = against_print(&LOSS_FACTOR)
        .misprints
        .into_iter()
        .map(|one| (one.figure, one.factor, (one.recomputed * 1e4).round() / 1e4))
        .collect();
    let expected = [
        ("ΣK_3", "crisscross angle", 0.2603),
        ("R", "crisscross angle", 0.1362),
        ("ΣK_1", "wire diameter", 0.0976),
        ("ΣK_3", "wire diameter", 0.2801),
        ("R", "wire diameter", 0.1825),
    ];
    assert_eq!(
        found,
        expected.map(|(figure, factor, value)| (figure.to_owned(), factor, value))
    );
}

/// Calculated independently of this code: S of density on stiffness is 0.123742, of angle 0.011130, of all 0.175047.
#[test]
fn table_3_tells_no_factor_from_error() {
    let results = analyse(&Experiment::published(&[LOSS_FACTOR, STIFFNESS]));
    for analysis in &results {
        let variance = &analysis.variance;
        assert_eq!(variance.error, ErrorSource::SmallestColumn);
        assert_eq!(variance.told, Vec::<String>::new());
    }
    let [loss_factor, stiffness] = &results[..] else {
        panic!("two results");
    };
    let density = &stiffness.variance.effects[0];
    let f = density.f.unwrap();
    close(density.sum_of_squares, 0.123742, 1e-6);
    close(f, 0.123742 / 0.011130, 1e-3);
    // F with 2 and 2 degrees of freedom: p = 1/(1 + F).
    close(density.p_nominal.unwrap(), 1.0 / (1.0 + f), 1e-12);
    close(density.p.unwrap(), 4.0 / (3.0 + f), 1e-12);
    let share: f64 = 0.123742 / 0.175047;
    close(
        stiffness.variance.p_largest.unwrap(),
        4.0 * (1.0 - share).powi(3),
        1e-4,
    );
    assert!(loss_factor.variance.p_largest.unwrap() > 0.9);
}

/// y = 10 + a + 2·(b − 1)² + error on the third column: S = 3·Σ(level's effect)², and the remainder is the error's.
#[test]
fn effects_have_their_closed_form() {
    let error = [0.1, -0.3, 0.2];
    let runs =
        l9().map(|[a, b, c, _]| vec![10.0 + a as f64 + 2.0 * (b as f64 - 1.0).powi(2) + error[c]]);
    let found = analysis(2, runs);
    let variance = &found.variance;
    let of_error = 3.0 * (0.01 + 0.09 + 0.04);
    close(variance.effects[0].sum_of_squares, 3.0 * 2.0, 1e-12);
    close(variance.effects[1].sum_of_squares, 3.0 * 8.0 / 3.0, 1e-12);
    assert_eq!(variance.error, ErrorSource::FreeColumns);
    assert_eq!(variance.error_freedom, 4);
    close(variance.error_mean_square, of_error / 4.0, 1e-12);
    let f = 3.0 / (of_error / 4.0);
    close(variance.effects[0].f.unwrap(), f, 1e-9);
    // F with 2 and m degrees of freedom: p = (1 + 2F/m)^(−m/2).
    close(
        variance.effects[0].p.unwrap(),
        (1.0 + f / 2.0).powi(-2),
        1e-12,
    );
    assert_eq!(variance.told, ["B", "A"]);
    close(found.ranges[0].range, 6.0, 1e-12);
    assert_eq!(found.order, ["A", "B"].map(str::to_owned));
}

/// Three repeats, 5 % of scatter: the analysis identifies the factor that acts, but not those that do not, nor the column without a
/// factor.
#[test]
fn repeats_tell_what_a_saturated_array_cannot() {
    // Repeats differ by −e, 0, e: S within = 9·2·e², with 18 degrees of freedom.
    let e = 0.05;
    let runs = l9().map(|[a, ..]| vec![a as f64 * 0.2 - e, a as f64 * 0.2, a as f64 * 0.2 + e]);
    let found = analysis(3, runs).variance;
    assert_eq!(found.error, ErrorSource::Repeats);
    assert_eq!(found.error_freedom, 18);
    close(found.error_mean_square, e * e, 1e-15);
    assert_eq!(found.told, ["A"]);
    let names: Vec<&str> = found
        .effects
        .iter()
        .map(|effect| &effect.name[..])
        .collect();
    assert_eq!(names, ["A", "B", "C", "free columns"]);
    // The mean of nine repeats of a level is 0.2 from the next: S = 9·2·0.04.
    close(found.effects[0].sum_of_squares, 0.72, 1e-12);
    close(found.effects[1].sum_of_squares, 0.0, 1e-12);
}

/// B of 2 with a scatter of 0.015: the other columns' sums of squares are within a factor of 5 of each other.
#[test]
fn a_factor_far_above_the_rest_is_told_from_a_saturated_array() {
    let mut scatter = SCATTER.into_iter();
    let runs = l9().map(|[_, b, ..]| vec![b as f64 + scatter.next().unwrap()]);
    assert_eq!(analysis(4, runs).variance.told, ["B"]);
}

#[test]
fn results_without_scatter_have_no_error_to_be_told_from() {
    for runs in [[1.0; 9], l9().map(|[a, ..]| 0.1 + a as f64 / 3.0)] {
        let found = analysis(3, runs.map(|value| vec![value])).variance;
        assert_eq!(found.error, ErrorSource::None);
        assert!(found.effects.iter().all(|effect| effect.p.is_none()));
        assert!(found.told.is_empty());
    }
}

#[test]
fn columns_that_are_no_l9_are_refused() {
    let mut swapped = factors(3);
    swapped[2].column.swap(0, 1);
    let refused = |factors| Experiment::new(factors, vec![response([0.0; 9])]).unwrap_err();
    assert!(matches!(
        refused(swapped),
        Defect::NotOrthogonal { factor, .. } if factor == "C"
    ));
    let mut unbalanced = factors(2);
    unbalanced[0].column[0] = 2;
    assert!(matches!(
        refused(unbalanced),
        Defect::Unbalanced { count: 2, .. }
    ));
    assert_eq!(refused(factors(1)), Defect::Factors(1));
    let mut missing = response([0.0; 9]);
    missing.runs[4].clear();
    assert!(matches!(
        Experiment::new(factors(2), vec![missing]).unwrap_err(),
        Defect::Repeats { run: 5, .. }
    ));
}

proptest! {
    /// Squares add up to the total. Nothing depends on the order of runs, on an offset, or on the column of a factor. S scales with
    /// the square of the unit and p does not.
    #[test]
    fn the_analysis_is_of_the_factors_and_not_of_how_they_are_written(
        values in prop::array::uniform9(-5.0..5.0_f64), offset in -3.0..3.0_f64, scale in 0.1..10.0_f64, turn in 0..4_usize,
    ) {
        let plain = analysis(4, values.map(|value| vec![value]));
        let sum: f64 = plain.variance.effects.iter().map(|effect| effect.sum_of_squares).sum();
        prop_assert!((sum / plain.variance.total - 1.0).abs() < 1e-9);

        let mut turned = factors(4);
        turned.rotate_left(turn);
        for factor in &mut turned {
            factor.column.reverse();
        }
        let mut moved = values.map(|value| offset + scale * value);
        moved.reverse();
        let experiment = Experiment::new(turned, vec![response(moved)]).unwrap();
        let moved = analyse(&experiment).remove(0);
        prop_assert_eq!(&moved.order, &plain.order);
        for effect in &plain.variance.effects {
            let same = moved.variance.effects.iter().find(|other| other.name == effect.name).unwrap();
            let expected = scale * scale * effect.sum_of_squares;
            prop_assert!((same.sum_of_squares - expected).abs() < 1e-9 * moved.variance.total);
            prop_assert_eq!(same.p.is_some(), effect.p.is_some());
            if let (Some(a), Some(b)) = (same.p, effect.p) {
                prop_assert!((a - b).abs() < 1e-6);
            }
        }
    }
}

fn table(directory: &Path, text: &str) -> Result<Experiment, String> {
    let path = directory.join("test.csv");
    fs::write(&path, text).unwrap();
    Experiment::read(&path).map_err(|error| error.to_string())
}

/// Runs in any order, levels as words or numbers, with other columns and repeats.
#[test]
fn a_users_own_table_is_read() {
    let root = tempfile::tempdir().unwrap();
    let words = ["soft", "middle", "hard"];
    let mut text =
        "# a test\nrun,factor_load,factor_wool,result_eta.1,result_eta.2,result_K\n".to_owned();
    for (run, [a, b, ..]) in l9().into_iter().enumerate().rev() {
        let load = [10.0, 5.0, 2.5][a];
        text += &format!("{run},{load},{},{a},{},{b}\n", words[b], a + 1);
    }
    let experiment = table(root.path(), &text).unwrap();
    let [load, wool] = experiment.factors() else {
        panic!("two factors");
    };
    assert_eq!(load.levels, ["2.5", "5", "10"]);
    // Words are in the order of their first run.
    assert_eq!(wool.levels, ["hard", "middle", "soft"]);
    let [eta, k] = experiment.responses() else {
        panic!("two results");
    };
    assert_eq!((&eta.name[..], &k.name[..]), ("eta", "K"));
    assert_eq!(eta.runs[0], [2.0, 3.0]);
    let results = analyse(&experiment);
    assert_eq!(results[0].order[0], "load");
    assert_eq!(results[1].order[0], "wool");
    assert_eq!(results[0].variance.error, ErrorSource::Repeats);
    assert_eq!(results[1].variance.error, ErrorSource::None);
}
