//! The report of a trace.

use maud::{Markup, html};
use mesh_damper_identify::trace::result::{FoundEffect, TraceResult};
use mesh_damper_model::extrapolation::{Beyond, Extrapolation, percent};
use mesh_damper_model::file::FittedRange;

use super::charts::{self, AFTER, BEFORE};
use super::conditions;
use super::cycles;
use super::html::{Section, figure, page, table};
use super::next;
use super::picture::{self, SMALL, WIDE};
use super::reasoning::{self, Evidence};
use super::why;
use super::worst;
use super::{ReportData, Series, SeriesBlock, text};

/// Most loops in the pictures.
const MOST_LOOPS: usize = 12;

/// The report as one HTML file that needs no other.
pub fn render(data: &ReportData) -> String {
    let (heading, sentence) = text::verdict(&data.result);
    let evidence = Evidence::of(data);
    let first = html! {
        div.verdict {
            p.heading { strong { (heading) } }
            p { (sentence) }
        }
    };
    let sections = [
        why::section(&data.result),
        Some(given(data)),
        Some(evidence.before(data)),
        Some(reasoning::tried(&data.result)),
        Some(found(&data.result)),
        conditions::gains(&data.result),
        worst::loops(data),
        Some(evidence.after(data)),
        Some(errors(&data.result)),
        Some(next::steps(&data.result)),
        Some(loops(&data.result, &data.series)),
        Some(cycles::section(data)),
        Some(over_time(&data.result, &data.series)),
        candidates(&data.result),
        Some(law(data)),
    ];
    let sections: Vec<Section> = sections.into_iter().flatten().collect();
    let last = html! {
        p {
            "Errors are the RMS of the force error divided by the RMS of the measured force. Held-out data was never fitted. Intervals \
             are computed as 90 % intervals; on simulated specimens 73 to 80 % of them contained the true value."
        }
    };
    page(&data.title, first, &sections, last, &[])
}

/// The recordings, their declared data, and their faults.
fn given(data: &ReportData) -> Section {
    let body = html! {
        @if !data.facts.is_empty() {
            dl { @for (name, text) in &data.facts { div { dt { (name) } dd { (text) } } } }
        }
        (recordings(data))
        @if !data.result.rig.is_empty() {
            p { strong { "What was stated about the rig" } }
            ul { @for fact in data.result.rig.in_words() { li { (fact) } } }
        }
        @if !data.result.guesses.is_empty() {
            p { strong { "How the files were read" } }
            ul { @for guess in &data.result.guesses { li { (guess) } } }
        }
        @if data.result.warnings.is_empty() {
            p { "No fault was found in the channels." }
        } @else {
            div.warnings {
                p { strong { "About the data" } }
                ul { @for warning in &data.result.warnings { li { (warning) } } }
            }
        }
    };
    Section::new("1. The recordings", body)
}

fn errors(result: &TraceResult) -> Section {
    let noise = result.noise_floor_nrmse;
    let times = |error: f64| format!("{}×", text::number(error / noise));
    let row = |name: String, fitted: Option<f64>, held_out: f64, best: bool| {
        html! {
            tr.best[best] {
                th scope="row" { (name) }
                td { @if let Some(error) = fitted { (text::percent(error)) } @else { "–" } }
                td { (text::percent(held_out)) }
                td { (times(held_out)) }
            }
        }
    };
    let alone = text::law_alone(&result.baseline);
    let rows = html! {
        (row(format!("Before: {alone}"), Some(result.baseline.nrmse_fitted), result.baseline.nrmse_held_out, false))
        @if let Some(staged) = &result.baseline.staged {
            (row(
                "Before: the same, fitted in two stages as in the paper".into(),
                Some(staged.nrmse_fitted),
                staged.nrmse_held_out,
                false
            ))
        }
        (row(
            "After: the augmented model (f64)".into(),
            Some(result.augmented.nrmse_fitted),
            result.augmented.nrmse_held_out,
            true
        ))
        (row("After: the embedded law (f32)".into(), None, result.on_target.nrmse_held_out, true))
        (row("Noise of the recording".into(), None, noise, false))
    };
    let head = html! { tr {
        th scope="col" { "law" } th scope="col" { "fitted" } th scope="col" { "held out" }
        th scope="col" { "held out, in noise floors" }
    } };
    Section::new(
        "6. Error of the force, before and after",
        table("NRMSE of each law on data fitted and held out", head, rows),
    )
}

/// The meaning of the curves' names.
pub fn names(result: &TraceResult) -> [(&'static str, String); 2] {
    [
        (
            BEFORE,
            format!("before: {}", text::law_alone(&result.baseline)),
        ),
        (AFTER, "after: the augmented model".into()),
    ]
}

/// `0.1 mm, 5 Hz`
pub fn condition(block: &SeriesBlock) -> String {
    let (amplitude, frequency) = (
        text::nominal(block.amplitude),
        text::nominal(block.frequency),
    );
    format!("{amplitude} mm, {frequency} Hz")
}

fn loops(result: &TraceResult, series: &[Series]) -> Section {
    let several = series.len() > 1;
    let drawn = chosen_blocks(series).into_iter().map(|(one, block)| {
        let title = format!("Force–displacement loop at {}", condition(block));
        (
            one,
            block,
            charts::loop_chart(one, &block.cycle, &title, SMALL),
        )
    });
    let drawn: Vec<_> = drawn.collect();
    let body = html! {
        @if drawn.is_empty() {
            p { "The recordings hold no complete cycle." }
        } @else {
            (picture::key(drawn.iter().map(|(_, _, picture)| picture), &names(result)))
            div.grid {
                @for (one, block, picture) in &drawn {
                    (figure(html! {
                        (condition(block)) " "
                        @if block.held_out { span.tag { "held out" } }
                        @if several { " " span.plain { (text::file_name(&one.name)) } }
                    }, picture))
                }
            }
        }
    };
    Section::new("Force–displacement loops", body)
}

/// At most [`MOST_LOOPS`] blocks in order, held-out blocks first. A single cycle is a transition between blocks. It is drawn only
/// if there is nothing else, for a motion that does not repeat.
fn chosen_blocks(series: &[Series]) -> Vec<(&Series, &SeriesBlock)> {
    let blocks = || {
        let each = series.iter();
        each.flat_map(|one| one.blocks.iter().map(move |block| (one, block)))
    };
    let mut all: Vec<(&Series, &SeriesBlock)> = blocks()
        .filter(|(_, block)| block.cycles.len() > 1)
        .collect();
    if all.is_empty() {
        all = blocks().collect();
    }
    let (held, fitted): (Vec<usize>, Vec<usize>) = (0..all.len()).partition(|&i| all[i].1.held_out);
    let held = spread(&held, MOST_LOOPS);
    let fitted = spread(&fitted, MOST_LOOPS - held.len());
    let mut chosen: Vec<usize> = held.into_iter().chain(fitted).collect();
    chosen.sort_unstable();
    chosen.into_iter().map(|i| all[i]).collect()
}

/// At most `most` of the indices, evenly spread.
fn spread(indices: &[usize], most: usize) -> Vec<usize> {
    let count = indices.len().min(most);
    (0..count)
        .map(|i| indices[i * indices.len() / count])
        .collect()
}

fn over_time(result: &TraceResult, series: &[Series]) -> Section {
    let chart = charts::residual_chart(series, WIDE);
    let body = html! {
        (picture::key([&chart], &names(result)))
        (figure(html! { "residual: measured force minus the law's" }, &chart))
    };
    Section::new("Residual over time", body)
}

fn found(result: &TraceResult) -> Section {
    let body = html! {
        (reasoning::concluded(result))
        @if !result.effects.is_empty() { (effects("Effects found, with their parameters", &result.effects)) }
        @if !result.unconfirmed.is_empty() {
            (effects("Effects in the model that are not confirmed, with their parameters", &result.unconfirmed))
        }
    };
    Section::new("4. Effects found", body)
}

fn effects(caption: &str, effects: &[FoundEffect]) -> Markup {
    let head = html! { tr {
        th scope="col" { "effect" } th.text scope="col" { "parameter" } th scope="col" { "value" }
        th scope="col" { "90 % interval" } th.text scope="col" { "unit" } th scope="col" { "held-out error without" }
        th scope="col" { "with" }
    } };
    let rows = html! {
        @for effect in effects {
            @for (row, (name, estimate)) in effect.parameters.iter().enumerate() {
                @let [low, value, high] = text::interval(estimate.low, estimate.value, estimate.high);
                tr {
                    th scope="row" { @if row == 0 { (text::name(&effect.family)) } @else { span.unseen { (text::name(&effect.family)) } } }
                    td.text { (name.replace('_', " ")) }
                    td { (value) }
                    td { (low) " … " (high) }
                    td.text { (text::unit(&estimate.unit)) }
                    td { @if row == 0 { (text::percent(effect.nrmse_without)) } }
                    td { @if row == 0 { (text::percent(effect.nrmse_with)) } }
                }
            }
        }
    };
    table(caption, head, rows)
}

fn candidates(result: &TraceResult) -> Option<Section> {
    if result.candidates.is_empty() {
        return None;
    }
    let head = html! { tr {
        th scope="col" { "step" } th.text scope="col" { "candidate" } th scope="col" { "validation error" }
        th scope="col" { "held-out error" } th.text scope="col" { "distinguishable from the best of its step" }
        th.text scope="col" { "description" }
    } };
    let rows = html! {
        @for (index, candidate) in result.candidates.iter().enumerate() {
            @let best = index == 0 || result.candidates[index - 1].step != candidate.step;
            tr.best[candidate.added] {
                td { (candidate.step) }
                th.text scope="row" { (text::name(&candidate.family)) }
                td { (text::percent(candidate.nrmse_judged)) }
                td { (text::percent(candidate.nrmse_held_out)) }
                td.text {
                    @if candidate.added { "added" }
                    @else if !candidate.admissible {
                        "not admissible"
                        @if let Some(rule) = candidate.rejected_by { ": " (rule.says()) }
                    }
                    @else if best { "the best, but without a clear gain" }
                    @else if candidate.distinguishable { "yes" } @else { "no" }
                }
                td.text.plain { (text::description(&candidate.family)) }
            }
        }
    };
    let body = table("Every candidate of every step, the best first", head, rows);
    Some(Section::new("All candidates", body))
}

fn law(data: &ReportData) -> Section {
    let head = html! { tr {
        th scope="col" { "amplitude, mm" } th scope="col" { "k₁, kN/mm" } th scope="col" { "k₃, kN/mm³" }
        th scope="col" { "c, kN·(s/mm)" sup { "α" } } th scope="col" { "α" }
    } };
    let rows = html! {
        @for node in &data.result.law {
            tr {
                th scope="row" { @if data.result.law.len() == 1 { "all" } @else { (text::number(node.amplitude)) } }
                @for estimate in [&node.k1, &node.k3, &node.c, &node.alpha] {
                    @let half = 0.5 * (estimate.high - estimate.low);
                    td { (text::number(estimate.value)) " ± " (text::number(half)) }
                }
            }
        }
    };
    let body = html! {
        p {
            "F = k₁·y + k₃·y³ + c·|v|" sup { "α" } "·sgn v"
            @if !data.result.effects.is_empty() { " + effects" }
            @if data.result.correction.is_some() { " + the table" }
        }
        (table("Coefficients with half widths of their 90 % intervals", head, rows))
    };
    Section::new("The law", body)
}

fn recordings(data: &ReportData) -> Markup {
    let is_held = |one: &&Series| data.result.held_out.contains(&one.name);
    let (held, fitted): (Vec<&Series>, Vec<&Series>) = data.series.iter().partition(is_held);
    let range = FittedRange::of(
        fitted.iter().flat_map(|one| &one.displacement),
        fitted.iter().flat_map(|one| &one.velocity),
    );
    let outside = range.filter(|_| !held.is_empty());
    let head = html! { tr {
        th scope="col" { "recording" } th.text scope="col" { "use" } th scope="col" { "samples" }
        th scope="col" { "length, s" } th scope="col" { "largest displacement, mm" } th scope="col" { "largest force, kN" }
        @if outside.is_some() { th.text scope="col" { "outside the fitted motion" } }
    } };
    let rows = html! {
        @for one in &data.series {
            tr {
                th.path scope="row" { (one.name) }
                td.text { @if data.result.held_out.contains(&one.name) { "held out" } @else if held.is_empty() { "fitted, a part held out" } @else { "fitted" } }
                td { (one.time.len()) }
                td { (text::number(length(one))) }
                td { (text::number(largest(&one.displacement))) }
                td { (text::number(largest(&one.force))) }
                @if let Some(range) = &outside { td.text { (outside_of(range, one)) } }
            }
        }
    };
    table("The recordings", head, rows)
}

/// How much of a recording lies outside the fitted motion, and how far: held-out samples there are extrapolated.
fn outside_of(range: &FittedRange, series: &Series) -> String {
    let found = Extrapolation::of(range, &series.displacement, &series.velocity);
    let channels = [
        ("displacement", found.displacement),
        ("velocity", found.velocity),
    ];
    let outside = channels.iter().filter(|(_, beyond)| beyond.part > 0.0);
    let said = outside.map(|(name, Beyond { part, most })| {
        let most = text::number(100.0 * most);
        format!(
            "{} of the samples by {name}, up to {most} % beyond",
            percent(*part)
        )
    });
    let said: Vec<String> = said.collect();
    match said.as_slice() {
        [] => "nothing".into(),
        some => some.join("; "),
    }
}

fn length(series: &Series) -> f64 {
    match (series.time.first(), series.time.last()) {
        (Some(first), Some(last)) => last - first,
        _ => 0.0,
    }
}

fn largest(values: &[f64]) -> f64 {
    values
        .iter()
        .fold(0.0, |largest, value| largest.max(value.abs()))
}
