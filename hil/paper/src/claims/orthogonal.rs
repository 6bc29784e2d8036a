//! Section 4.1: the orthogonal test, Table 3.

use mesh_damper_reference::orthogonal_test::{FACTORS, LOSS_FACTOR, STIFFNESS};

use super::claim::{Claim, Verdict};
use crate::orthogonal::{self, AgainstPrint, Analysis, Experiment, against_print, analyse};

/// The results for Table 3.
pub struct OrthogonalTest {
    /// For the loss factor and the stiffness: ranges and variance.
    pub analyses: Vec<Analysis>,
    /// The same two, compared to the printed ones.
    pub against_print: [AgainstPrint; 2],
}

/// Table 3 recomputed.
pub fn recompute() -> OrthogonalTest {
    OrthogonalTest {
        analyses: analyse(&Experiment::published(&[LOSS_FACTOR, STIFFNESS])),
        against_print: [against_print(&LOSS_FACTOR), against_print(&STIFFNESS)],
    }
}

/// The level, 0…2, of factor number `factor` in every run.
pub fn level_of_runs(factor: usize) -> [usize; 9] {
    orthogonal::l9().map(|run| run[factor])
}

/// The claims of section 4.1 and their use in the conclusions.
pub fn claims(test: &OrthogonalTest) -> Vec<Claim> {
    let [loss, stiffness] = &test.against_print;
    let [of_loss, of_stiffness] = [&test.analyses[0], &test.analyses[1]];
    vec![
        array(),
        sums(
            "table_3_sums_of_loss_factor",
            "The sums and ranges of the loss factor are those of the nine runs.",
            loss,
        ),
        sums(
            "table_3_sums_of_stiffness",
            "The sums and ranges of the stiffness are those of the nine runs.",
            stiffness,
        ),
        order(
            "order_for_loss_factor",
            "Test load > mesh density > crisscross angle > wire diameter for the loss factor.",
            loss,
            of_loss,
        ),
        order(
            "order_for_stiffness",
            "Mesh density > test load > crisscross angle > wire diameter for the stiffness.",
            stiffness,
            of_stiffness,
        ),
        conclusion_1(of_loss, of_stiffness),
        density_dominates(of_loss, of_stiffness),
        significance(of_loss, of_stiffness),
        wire_ratio(of_loss, of_stiffness),
    ]
}

/// The levels of the nine runs as Table 3 prints them.
const PRINTED_ARRAY: [[usize; 4]; 9] = [
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

fn array() -> Claim {
    let printed = PRINTED_ARRAY.map(|run| run.map(|level| level - 1));
    let pairs = (0..4).flat_map(|a| (a + 1..4).map(move |b| (a, b)));
    let met: usize = pairs
        .map(|(a, b)| {
            let mut pairs = printed.map(|run| (run[a], run[b]));
            pairs.sort_unstable();
            pairs.windows(2).filter(|two| two[0] != two[1]).count() + 1
        })
        .sum();
    Claim::new(
        "table_3_is_an_l9",
        "§2.2.1, Table 3",
        "The nine runs are an L9(3⁴): every level of a factor meets every level of each other once.",
        Verdict::of(met == 54 && printed == orthogonal::l9()),
        "all 54 pairs of levels occur once",
    )
    .with("pairs of levels that meet", met as f64)
}

fn sums(name: &'static str, says: &'static str, found: &AgainstPrint) -> Claim {
    let misprints: Vec<String> = found
        .misprints
        .iter()
        .map(|one| {
            format!(
                "{} of {}: {:.4}, printed {}",
                one.figure, one.factor, one.recomputed, one.printed
            )
        })
        .collect();
    let reason = if misprints.is_empty() {
        "all sums and ranges agree in every digit printed".to_owned()
    } else {
        misprints.join("; ")
    };
    let mut claim = Claim::new(
        name,
        "Table 3",
        says,
        Verdict::of(misprints.is_empty()),
        reason,
    )
    .with("figures that differ", misprints.len() as f64);
    for one in &found.misprints {
        claim = claim.with(format!("{} of {}", one.figure, one.factor), one.recomputed);
    }
    claim
}

fn order(
    name: &'static str,
    says: &'static str,
    found: &AgainstPrint,
    analysis: &Analysis,
) -> Claim {
    let holds = found.order_of_runs == found.order_in_text;
    with_ranges(
        Claim::new(
            name,
            "§4.1",
            says,
            Verdict::of(holds),
            format!(
                "the ranges give {}, those printed {}",
                found.order_of_runs.join(" > "),
                if found.order_of_printed_ranges == found.order_of_runs {
                    "as well"
                } else {
                    "another order"
                }
            ),
        ),
        "R of",
        analysis,
    )
}

fn with_ranges(mut claim: Claim, prefix: &str, analysis: &Analysis) -> Claim {
    for one in &analysis.ranges {
        claim = claim.with(format!("{prefix} {}", one.factor), one.range);
    }
    claim
}

fn range(analysis: &Analysis, factor: usize) -> f64 {
    analysis.ranges[factor].range
}

const DENSITY: usize = 0;
const ANGLE: usize = 1;
const WIRE: usize = 2;
const LOAD: usize = 3;

fn conclusion_1(loss: &Analysis, stiffness: &Analysis) -> Claim {
    let holds = |analysis| {
        range(analysis, DENSITY) > range(analysis, ANGLE)
            && range(analysis, ANGLE) > range(analysis, WIRE)
    };
    let claim = Claim::new(
        "order_of_fabrication",
        "conclusion 1",
        "Mesh density > crisscross angle > wire diameter.",
        Verdict::of(holds(loss) && holds(stiffness)),
        "by the ranges the wire diameter comes before the crisscross angle for both, density first",
    );
    let claim = with_ranges(claim, "R of the loss factor by", loss);
    with_ranges(claim, "R of the stiffness by", stiffness)
}

fn density_dominates(loss: &Analysis, stiffness: &Analysis) -> Claim {
    let dominates = |analysis| range(analysis, DENSITY) > range(analysis, LOAD);
    Claim::new(
        "density_dominates",
        "abstract",
        "The mesh density plays the dominant role for load capacity and for damping.",
        Verdict::of(dominates(loss) && dominates(stiffness)),
        "for the stiffness by the ranges, yes; for the loss factor the test load has the largest range, as §4.1 says itself",
    )
    .with("R of density over that of load, stiffness", range(stiffness, DENSITY) / range(stiffness, LOAD))
    .with("R of density over that of load, loss factor", range(loss, DENSITY) / range(loss, LOAD))
}

fn significance(loss: &Analysis, stiffness: &Analysis) -> Claim {
    let told = loss.variance.told.len() + stiffness.variance.told.len();
    let mut claim = Claim::new(
        "significance",
        "§4.1",
        "The ranges order the factors by significance.",
        Verdict::CannotTell,
        "four factors in nine runs done once leave no degree of freedom for error; held against the smallest of them, none \
         stands out at 5 %",
    )
    .with("factors told from error", told as f64);
    for (name, analysis) in [("loss factor", loss), ("stiffness", stiffness)] {
        if let Some(p) = analysis.variance.p_largest {
            claim = claim.with(format!("p of the largest effect, {name}"), p);
        }
        for effect in &analysis.variance.effects {
            claim = claim.with(format!("share of {}, {name}", effect.name), effect.share);
        }
    }
    claim
}

fn wire_ratio(loss: &Analysis, stiffness: &Analysis) -> Claim {
    let ratio = |analysis| range(analysis, DENSITY) / range(analysis, WIRE);
    let (of_stiffness, of_loss) = (ratio(stiffness), ratio(loss));
    Claim::new(
        "density_over_wire",
        "conclusion 1",
        "Density varies dynamic stiffness and loss factor 6.9 and 6.2 times more than the wire diameter.",
        Verdict::CannotTell,
        format!(
            "no dynamic test of another wire is tabulated; in the static Table 3 the ranges are {of_stiffness:.1} and \
             {of_loss:.1} times as large"
        ),
    )
    .with(format!("R of {} over {}, stiffness", FACTORS[DENSITY], FACTORS[WIRE]), of_stiffness)
    .with(format!("R of {} over {}, loss factor", FACTORS[DENSITY], FACTORS[WIRE]), of_loss)
}
