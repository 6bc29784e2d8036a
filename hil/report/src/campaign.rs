//! Results of the fault campaign, as SVG: how soon faults and attacks were found, and how well slow changes were followed.

use mesh_damper_rig::campaign::{
    AttackSummary, Changing, KindSummary, Naming, Outcome, SlowOutcome, Summary,
};

use super::palette::Colour;
use super::picture::{Axis, Layer, Look, Mark, Panel, Picture};

/// The first, second and third entry of a legend, and the marks that must not be overlooked.
const LOOKS: [(Colour, Mark); 4] = [
    (Colour::After, Mark::Disc),
    (Colour::Before, Mark::Cross),
    (Colour::Measured, Mark::Ring),
    (Colour::Ink, Mark::Triangle),
];

/// A name with its marks: the entry in the legend, and the position.
type Row = (String, Vec<(usize, f64)>);

/// Position of marks for trials found later, or not at all.
const LATE: f64 = 10.0;

/// A row with one mark for each of `outcomes`. A trial that led to a hazardous state has its mark where the rig found it, or at the
/// end of the row.
fn row<'o>(name: String, outcomes: impl Iterator<Item = &'o Outcome>) -> Row {
    let mark = |one: &Outcome| {
        let at = one.cycles.map_or(LATE, |cycles| cycles.min(LATE));
        match one.naming {
            _ if one.is_hazardous() => Some((3, at)),
            Naming::Nothing => None,
            Naming::Right | Naming::Both => Some((0, at)),
            Naming::Wrong => Some((1, at)),
        }
    };
    let mut marks: Vec<_> = outcomes.filter_map(mark).collect();
    // Trials with another name are few and must not be hidden.
    marks.sort_by_key(|(of, _)| *of);
    (name, marks)
}

fn row_of(kind: &KindSummary, outcomes: &[Outcome]) -> Row {
    let name = format!("{:?} {}", kind.kind, kind.size);
    row(name, kind.among(outcomes))
}

/// Cycles from a fault that the monitor knows until it is named, one row for each kind and size, one mark for each trial.
pub fn found(summary: &Summary) -> String {
    let kinds = summary.kinds.iter();
    let rows = kinds.map(|kind| row_of(kind, &summary.outcomes));
    picture(
        "How soon each fault was named",
        &rows.collect::<Vec<Row>>(),
        &[
            (0, "named correctly"),
            (1, "named incorrectly"),
            (3, "a hazardous state"),
        ],
        ("cycles from the fault to its name", ""),
    )
}

/// Cycles from an attack until it is named, one row for each kind and size, one mark for each trial.
pub fn attacked(attacks: &AttackSummary) -> String {
    let outcomes = &attacks.outcomes;
    let seen = attacks.kinds.iter().filter(|kind| kind.hidden.is_none());
    let mut rows: Vec<Row> = seen.map(|kind| row_of(kind, &outcomes.singles)).collect();
    for (name, outcomes) in [
        ("pairs", &outcomes.pairs),
        ("the adversary's", &outcomes.adversary),
    ] {
        let row = row(name.into(), outcomes.iter());
        if !row.1.is_empty() {
            rows.push(row);
        }
    }
    picture(
        "How soon each attack was named",
        &rows,
        &[
            (0, "named correctly, or among two causes"),
            (1, "named incorrectly"),
            (3, "a hazardous state"),
        ],
        (
            "cycles from the attack to its name; 10 if later or never",
            "",
        ),
    )
}

/// The law's error before and after a slow change, one row for each change.
pub fn followed(slow: &[SlowOutcome]) -> String {
    let rows = slow.iter().map(|one| {
        let what = match one.change.changing {
            Changing::Force => "force",
            Changing::Friction => "friction",
        };
        let change = &one.change;
        let name = format!(
            "{what} {:+.0} %, {} g/cm³, {} mm",
            100.0 * change.size,
            change.density,
            change.amplitude
        );
        let errors = [one.followed.error, one.stayed.error, one.before];
        (
            name,
            errors
                .map(|error| 100.0 * error)
                .into_iter()
                .enumerate()
                .collect(),
        )
    });
    picture(
        "The law's error before and after each slow change",
        &rows.collect::<Vec<Row>>(),
        &[
            (0, "after the change, with adaptation"),
            (1, "after the change, without adaptation"),
            (2, "before the change"),
        ],
        (
            "RMS error of the law, in % of the RMS of the measured force",
            "",
        ),
    )
}

/// Rows from the top down, marks over the horizontal axis.
fn picture(
    title: &str,
    rows: &[Row],
    legend: &[(usize, &str)],
    (what, unit): (&str, &str),
) -> String {
    let most = rows
        .iter()
        .flat_map(|(_, marks)| marks)
        .fold(1.0, |most, (_, x)| f64::max(most, *x));
    let height = |row: usize| -(row as f64) - 0.5;
    let names = rows.iter().enumerate();
    let names = names.map(|(row, (name, _))| (height(row), name.clone()));
    let layers = legend.iter().map(|&(of, name)| {
        let points = rows.iter().enumerate().flat_map(|(row, (_, marks))| {
            let these = marks.iter().filter(move |mark| mark.0 == of);
            these.map(move |&(_, x)| (x, height(row)))
        });
        let (colour, mark) = LOOKS[of.min(LOOKS.len() - 1)];
        Layer::new(name, colour, Look::Marks(mark), points.collect())
    });
    let panel = Panel {
        title: String::new(),
        x: Axis::new(what, unit).over(-0.1..1.05 * most),
        y: Axis {
            labels: Some(names.collect()),
            ..Axis::new("", "").over(-(rows.len() as f64)..0.0)
        },
        layers: layers.collect(),
    };
    // Height in addition to the rows, and height of each row, px.
    let height = (126 + 23 * rows.len() as u32).max(1000);
    Picture::of(title, ((900, height), 14), panel).alone()
}
