//! What the fault campaign came to, as SVG: how soon faults and attacks were found, and how well slow changes were followed.

use mesh_damper_rig::faults::{
    AttackOutcome, AttackSummary, Changing, Naming, Outcome, SlowOutcome, Summary,
};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::charts::{self, AFTER, Area, BEFORE, Drawn, FINE, FONT, INK, MEASURED};

/// A name, and the marks beside it: what each is of, by its place in the legend, and where it stands.
type Row = (String, Vec<(usize, f64)>);

/// Cycles from a fault to its name, one row to a kind and size, one mark to a trial.
pub fn found(summary: &Summary) -> String {
    let mark = |one: &Outcome| Some((usize::from(!(one.right || one.both)), one.cycles?));
    let rows = summary.kinds.iter().map(|kind| {
        let these = summary
            .outcomes
            .iter()
            .filter(|one| one.trial.kind == kind.kind && one.trial.size == kind.size);
        let mut marks: Vec<_> = these.filter_map(mark).collect();
        // What is named otherwise is few and must not be hidden.
        marks.sort_by_key(|(of, _)| *of);
        (format!("{:?} {}", kind.kind, kind.size), marks)
    });
    picture(
        &rows.collect::<Vec<Row>>(),
        &[(0, "named for what it is"), (1, "named otherwise")],
        "cycles from the fault to its name",
    )
}

/// Cycles from an attack to its name, one row to a kind and size, one mark to a trial. A trial that led to a hazardous state has its
/// mark where the rig found it, or at the end of the row.
pub fn attacked(attacks: &AttackSummary) -> String {
    /// Where what was found later, or not at all, is marked.
    const LATE: f64 = 10.0;
    let mark = |one: &AttackOutcome| {
        let at = one.cycles.map_or(LATE, |cycles| cycles.min(LATE));
        match one.naming {
            _ if one.is_hazardous() => Some((3, at)),
            Naming::Nothing => None,
            Naming::Right | Naming::Both => Some((0, at)),
            Naming::Wrong => Some((1, at)),
        }
    };
    let of_kind = |(kind, size): (_, f64)| {
        let these = attacks.outcomes.singles.iter().filter(move |one| {
            let attack = &one.trial.attacks[0];
            attack.kind == kind && attack.size == size
        });
        let mut marks: Vec<_> = these.filter_map(mark).collect();
        marks.sort_by_key(|(of, _)| *of);
        (format!("{kind:?} {size}"), marks)
    };
    let seen = attacks.kinds.iter().filter(|kind| kind.hidden.is_none());
    let mut rows: Vec<Row> = seen.map(|kind| of_kind((kind.kind, kind.size))).collect();
    for (name, outcomes) in [
        ("pairs", &attacks.outcomes.pairs),
        ("the adversary's", &attacks.outcomes.adversary),
    ] {
        let mut marks: Vec<_> = outcomes.iter().filter_map(mark).collect();
        marks.sort_by_key(|(of, _)| *of);
        if !marks.is_empty() {
            rows.push((name.into(), marks));
        }
    }
    picture(
        &rows,
        &[
            (0, "named for what it is or may be"),
            (1, "named otherwise"),
            (3, "a hazardous state"),
        ],
        "cycles from the attack to its name, 10 where it is later or none",
    )
}

/// The law's error before a slow change and after it, one row to a change.
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
        &rows.collect::<Vec<Row>>(),
        &[
            (0, "after it, a law that follows"),
            (1, "a law that stays"),
            (2, "before the change"),
        ],
        "RMS of the law's error, % of that of the measured force",
    )
}

fn picture(rows: &[Row], legend: &[(usize, &str)], x_desc: &str) -> String {
    let most = rows
        .iter()
        .flat_map(|(_, marks)| marks)
        .fold(1.0, |most, (_, x)| f64::max(most, *x));
    let style = charts::tall(rows.len());
    // A letter is about three fifths as wide as the font is high.
    let longest = rows.iter().map(|(name, _)| name.chars().count()).max();
    let names = longest
        .map_or(0, |letters| 3 * letters as u32 / 5 + 1)
        .max(17);
    charts::draw(&style, |area| {
        let font = FINE * style.font();
        let text = || (FONT, font).into_font().color(&INK);
        let mut chart = ChartBuilder::on(area)
            .margin(font)
            .margin_top(3 * font)
            .x_label_area_size(3 * font)
            .y_label_area_size(names * font)
            .build_cartesian_2d(-0.1..1.05 * most, -(rows.len() as f64)..0.0)?;
        chart
            .configure_mesh()
            .disable_y_axis()
            .disable_y_mesh()
            .x_desc(x_desc)
            .label_style(text())
            .axis_desc_style(text())
            .draw()?;
        let (left, top) = chart.plotting_area().map_coordinate(&(0.0, 0.0));
        let line = top - font as i32;
        let mut at = left;
        for &(of, what) in legend {
            mark(area, of, (at, line))?;
            let beside = text().pos(Pos::new(HPos::Left, VPos::Center));
            area.draw(&Text::new(what, (at + font as i32, line), beside))?;
            at += (3 * what.chars().count() / 5 + 3) as i32 * font as i32;
        }
        for (row, (name, marks)) in rows.iter().enumerate() {
            let place = |x: f64| {
                let middle = -(row as f64) - 0.5;
                chart.plotting_area().map_coordinate(&(x, middle))
            };
            for &(of, x) in marks {
                mark(area, of, place(x))?;
            }
            let right = text().pos(Pos::new(HPos::Right, VPos::Center));
            let name = Text::new(name.as_str(), ((names * font) as i32, place(0.0).1), right);
            area.draw(&name)?;
        }
        Ok(())
    })
}

/// The first of a legend, the second, the third, and what must not be overlooked.
fn mark(area: &Area<'_>, of: usize, at: (i32, i32)) -> Drawn {
    let size = 3 * FINE as i32;
    match of {
        0 => area.draw(&Circle::new(at, size, AFTER.mix(0.4).filled())),
        1 => area.draw(&Cross::new(at, size, BEFORE.stroke_width(2 * FINE))),
        2 => area.draw(&Circle::new(at, size, MEASURED.stroke_width(FINE))),
        _ => area.draw(&TriangleMarker::new(at, 2 * size, INK.filled())),
    }?;
    Ok(())
}
