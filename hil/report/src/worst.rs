//! The worst errors of the law: the loop around the largest error of the conditions with the largest remainder.

use std::ops::Range;

use maud::html;
use mesh_damper_identify::trace::result::HeldCondition;

use super::charts;
use super::conditions::held_out;
use super::html::{Section, figure};
use super::page::names;
use super::picture::{self, SMALL};
use super::text;
use super::{ReportData, Series};

/// Most loops in the picture.
const MOST: usize = 3;

/// The loops of the conditions with the largest remainder; `None` if no condition was held out in turn.
pub fn loops(data: &ReportData) -> Option<Section> {
    let mut conditions: Vec<&HeldCondition> = data.result.conditions.iter().collect();
    conditions.sort_by(|a, b| b.nrmse_with.total_cmp(&a.nrmse_with));
    let worst = conditions.into_iter().filter_map(|condition| {
        let mut series = data.series.iter();
        let series = series.find(|one| one.name == condition.recording)?;
        let samples = worst_loop(series, condition.span)?;
        let name = text::file_name(&held_out(condition)).to_owned();
        let title = format!("The worst loop of {name}");
        let caption = format!(
            "{name}, error {} where it was held out",
            text::percent(condition.nrmse_with)
        );
        Some((caption, charts::loop_chart(series, &samples, &title, SMALL)))
    });
    let worst: Vec<_> = worst.take(MOST).collect();
    if worst.is_empty() {
        return None;
    }
    let body = html! {
        p { "For each condition: the loop with the largest error of the law, which was fitted to all conditions." }
        (picture::key(worst.iter().map(|(_, picture)| picture), &names(&data.result)))
        div.grid { @for (caption, picture) in &worst { (figure(html! { (caption) }, picture)) } }
    };
    Some(Section::new("The worst conditions", body))
}

/// The samples of a condition from one rise of the displacement through its mean to the next, around the largest error; the first
/// sample of the next loop closes it. The whole condition if it does not oscillate; empty for an empty one.
fn worst_loop(series: &Series, [start, end]: [f64; 2]) -> Option<Range<usize>> {
    let at = |time: f64| series.time.partition_point(|&t| t < time);
    let samples = at(start)..at(end);
    let displacement = series.displacement.get(samples.clone())?;
    let error = |&i: &usize| (series.force[i] - series.after[i]).abs();
    let counts = |&i: &usize| series.measured[i];
    let of_condition = samples.clone().filter(counts);
    let worst = of_condition.max_by(|a, b| error(a).total_cmp(&error(b)))?;
    let mean = displacement.iter().sum::<f64>() / displacement.len() as f64;
    let rises = |&i: &usize| series.displacement[i - 1] < mean && series.displacement[i] >= mean;
    let rises: Vec<usize> = (samples.start + 1..samples.end).filter(rises).collect();
    let before = rises.iter().rev().find(|&&rise| rise <= worst);
    let after = rises.iter().find(|&&rise| rise > worst);
    // In a partial cycle at an end of the condition, the nearest whole cycle is drawn.
    let (from, to) = match (before, after) {
        (Some(&before), Some(&after)) => (before, after),
        (Some(_), None) => match rises[..] {
            [.., from, to] => (from, to),
            _ => return Some(samples),
        },
        (None, _) => match rises[..] {
            [from, to, ..] => (from, to),
            _ => return Some(samples),
        },
    };
    Some(from..to + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cycles of `period` samples; the law's error is largest at sample `wrong`.
    fn cycles(period: usize, count: usize, wrong: usize) -> Series {
        let phase = |i: usize| (i as f64 + 0.5) / period as f64 * std::f64::consts::TAU;
        let displacement: Vec<f64> = (0..count).map(|i| -phase(i).cos()).collect();
        let mut after = displacement.clone();
        after[wrong] += 0.5;
        Series {
            name: "a.csv".into(),
            time: (0..count).map(|i| i as f64 * 0.01).collect(),
            velocity: vec![0.0; count],
            force: displacement.clone(),
            before: displacement.clone(),
            displacement,
            after,
            measured: vec![true; count],
            blocks: Vec::new(),
        }
    }

    #[test]
    fn the_loop_about_the_largest_error_is_whole() {
        // It rises through 0 at samples 25, 125, 225 …
        let series = cycles(100, 500, 260);
        assert_eq!(worst_loop(&series, [0.0, 5.0]), Some(225..326));
        // For a condition that begins later, only its own samples.
        assert_eq!(worst_loop(&series, [1.0, 5.0]), Some(225..326));
        assert_eq!(worst_loop(&series, [3.0, 5.0]), Some(325..426));
    }

    #[test]
    fn at_an_end_the_nearest_whole_loop_stands_for_it() {
        let at_start = cycles(100, 500, 3);
        assert_eq!(worst_loop(&at_start, [0.0, 5.0]), Some(25..126));
        let at_end = cycles(100, 500, 490);
        assert_eq!(worst_loop(&at_end, [0.0, 5.0]), Some(325..426));
    }

    #[test]
    fn what_does_not_oscillate_is_drawn_whole() {
        let series = cycles(1000, 400, 10);
        assert_eq!(worst_loop(&series, [0.0, 4.0]), Some(0..400));
        assert_eq!(worst_loop(&series, [9.0, 9.5]), None);
    }

    #[test]
    fn samples_left_out_are_not_the_worst() {
        let mut series = cycles(100, 500, 260);
        series.measured[260] = false;
        series.after[130] += 0.1;
        assert_eq!(worst_loop(&series, [0.0, 5.0]), Some(125..226));
    }
}
