//! The page.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use mesh_damper_identify::trace::result::TraceResult;
use mesh_damper_model::extrapolation::{Beyond, Extrapolation, percent};
use mesh_damper_model::file::FittedRange;
use plotters::style::RGBColor;

use super::charts;
use super::conditions;
use super::reasoning::{self, Evidence};
use super::worst;
use super::{ReportData, Series, SeriesBlock, text};

/// Most loops that are drawn.
const MOST_LOOPS: usize = 12;

/// The report as one HTML file that needs no other.
pub fn render(data: &ReportData) -> String {
    let (heading, sentence) = text::verdict(&data.result);
    let evidence = Evidence::of(data);
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (data.title) }
                style { (PreEscaped(include_str!("style.css"))) }
            }
            body {
                h1 { (data.title) }
                section.verdict {
                    h2 { (heading) }
                    p { (sentence) }
                }
                (given(data))
                (evidence.before(data))
                (reasoning::tried(&data.result))
                (found(&data.result))
                (conditions::gains(&data.result))
                (worst::loops(data))
                (evidence.after(data))
                (errors(&data.result))
                (loops(&data.result, &data.series))
                (over_time(&data.result, &data.series))
                (candidates(&data.result))
                (law(data))
                footer {
                    "Errors are the RMS of the force's error over the RMS of the measured force. Held out means never \
                     fitted. Intervals are of 90 %."
                }
            }
        }
    };
    page.into_string()
}

/// The recordings, what is declared of them, and what is wrong with them.
fn given(data: &ReportData) -> Markup {
    html! {
        h2 { "1. What was given" }
        @if !data.facts.is_empty() {
            table { @for (name, text) in &data.facts { tr { td { (name) } td.text { (text) } } } }
        }
        (recordings(data))
        @if data.result.warnings.is_empty() {
            p { "No fault was found in the channels." }
        } @else {
            section.warnings {
                strong { "About the data" }
                ul { @for warning in &data.result.warnings { li { (warning) } } }
            }
        }
    }
}

fn errors(result: &TraceResult) -> Markup {
    let noise = result.noise_floor_nrmse;
    let times = |error: f64| format!("{}×", text::number(error / noise));
    html! {
        h2 { "6. Error of the force, before and after" }
        div.scroll { table {
            thead { tr { th { "" } th { "fitted" } th { "held out" } th { "held out, in noise floors" } } }
            tbody {
                tr {
                    td { "Before: " (text::law_alone(&result.baseline)) }
                    td { (text::percent(result.baseline.nrmse_fitted)) }
                    td { (text::percent(result.baseline.nrmse_held_out)) }
                    td { (times(result.baseline.nrmse_held_out)) }
                }
                @if let Some(staged) = &result.baseline.staged {
                    tr {
                        td { "Before: the same, fitted in two stages as the paper does" }
                        td { (text::percent(staged.nrmse_fitted)) }
                        td { (text::percent(staged.nrmse_held_out)) }
                        td { (times(staged.nrmse_held_out)) }
                    }
                }
                tr.best {
                    td { "After: with what was found (f64)" }
                    td { (text::percent(result.augmented.nrmse_fitted)) }
                    td { (text::percent(result.augmented.nrmse_held_out)) }
                    td { (times(result.augmented.nrmse_held_out)) }
                }
                tr.best {
                    td { "After: the embedded law (f32)" }
                    td { "" }
                    td { (text::percent(result.on_target.nrmse_held_out)) }
                    td { (times(result.on_target.nrmse_held_out)) }
                }
                tr { td { "Noise of the recording" } td { "" } td { (text::percent(noise)) } td { "1×" } }
            }
        } }
    }
}

/// Colours and what they stand for.
fn key(result: &TraceResult, measured: bool) -> Markup {
    let before = format!("before: {}", text::law_alone(&result.baseline));
    let swatch = |RGBColor(r, g, b): RGBColor, width: u32, name: &str| {
        let colour = format!("rgb({r},{g},{b})");
        html! {
            span {
                svg width="30" height="10" viewBox="0 0 30 10" aria-hidden="true" {
                    line x1="0" y1="5" x2="30" y2="5" stroke=(colour) stroke-width=(width) {}
                }
                (name)
            }
        }
    };
    html! {
        div.key {
            @if measured { (swatch(RGBColor(175, 175, 175), 5, "measured")) }
            (swatch(charts::BEFORE, 3, &before))
            (swatch(charts::AFTER, 3, "after: with what was found"))
        }
    }
}

fn loops(result: &TraceResult, series: &[Series]) -> Markup {
    let chosen = chosen_blocks(series);
    let several = series.len() > 1;
    html! {
        h2 { "Force–displacement loops" }
        @if chosen.is_empty() {
            p { "No whole cycle was found in the recordings." }
        } @else {
            (key(result, true))
            div.grid {
                @for (one, block) in &chosen {
                    figure {
                        figcaption {
                            (text::nominal(block.amplitude)) " mm, " (text::nominal(block.frequency)) " Hz "
                            @if block.held_out { span.tag { "held out" } }
                            @if several { " " span style="font-weight:400" { (text::file_name(&one.name)) } }
                        }
                        (PreEscaped(charts::loop_chart(one, &block.cycle, &charts::SMALL)))
                    }
                }
            }
        }
    }
}

/// At most [`MOST_LOOPS`] blocks in order, those held out before others.
fn chosen_blocks(series: &[Series]) -> Vec<(&Series, &SeriesBlock)> {
    let all: Vec<(&Series, &SeriesBlock)> = series
        .iter()
        .flat_map(|one| one.blocks.iter().map(move |block| (one, block)))
        .collect();
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

fn over_time(result: &TraceResult, series: &[Series]) -> Markup {
    html! {
        h2 { "The force left over time" }
        (key(result, false))
        figure { (PreEscaped(charts::residual_chart(series, &charts::WIDE))) }
    }
}

fn found(result: &TraceResult) -> Markup {
    html! {
        h2 { "4. What was found" }
        (reasoning::concluded(result))
        @if !result.effects.is_empty() {
            div.scroll { table {
                thead { tr {
                    th { "effect" } th.text { "parameter" } th { "value" } th { "90 % interval" } th.text { "unit" }
                    th { "held-out error without" } th { "with" }
                } }
                tbody {
                    @for effect in &result.effects {
                        @for (row, (name, estimate)) in effect.parameters.iter().enumerate() {
                            @let [low, value, high] = text::interval(estimate.low, estimate.value, estimate.high);
                            tr {
                                td { @if row == 0 { (text::name(&effect.family)) } }
                                td.text { (name.replace('_', " ")) }
                                td { (value) }
                                td { (low) " … " (high) }
                                td.text { (text::unit(&estimate.unit)) }
                                td { @if row == 0 { (text::percent(effect.nrmse_without)) } }
                                td { @if row == 0 { (text::percent(effect.nrmse_with)) } }
                            }
                        }
                    }
                }
            } }
        }
    }
}

fn candidates(result: &TraceResult) -> Markup {
    html! {
        @if !result.candidates.is_empty() {
            h2 { "All candidates" }
            div.scroll { table {
                thead { tr {
                    th { "step" } th.text { "candidate" } th { "judging error" } th { "held-out error" }
                    th.text { "told apart from the best of its step" } th.text { "what it is" }
                } }
                tbody {
                    @for (index, candidate) in result.candidates.iter().enumerate() {
                        @let best = index == 0 || result.candidates[index - 1].step != candidate.step;
                        tr.best[candidate.added] {
                            td { (candidate.step) }
                            td.text { (text::name(&candidate.family)) }
                            td { (text::percent(candidate.nrmse_judged)) }
                            td { (text::percent(candidate.nrmse_held_out)) }
                            td.text {
                                @if candidate.added { "added" }
                                @else if !candidate.admissible { "cannot be: a source of energy, or a drift that stands still within blocks" }
                                @else if best { "the best, without a clear gain" }
                                @else if candidate.distinguishable { "yes" } @else { "no" }
                            }
                            td.text style="font-weight:400" { (text::description(&candidate.family)) }
                        }
                    }
                }
            } }
        }
    }
}

fn law(data: &ReportData) -> Markup {
    html! {
        h2 { "The law" }
        p {
            "F = k₁·y + k₃·y³ + c·|v|" sup { "α" } "·sgn v"
            @if !data.result.effects.is_empty() { " + what was added" }
            @if data.result.correction.is_some() { " + the table" }
        }
        p { "With half widths of the 90 % intervals." }
        div.scroll { table {
            thead { tr {
                th { "amplitude, mm" } th { "k₁, kN/mm" } th { "k₃, kN/mm³" } th { "c, kN·(s/mm)" sup { "α" } }
                th { "α" }
            } }
            tbody {
                @for node in &data.result.law {
                    tr {
                        td { @if data.result.law.len() == 1 { "all" } @else { (text::number(node.amplitude)) } }
                        @for estimate in [&node.k1, &node.k3, &node.c, &node.alpha] {
                            @let half = 0.5 * (estimate.high - estimate.low);
                            td { (text::number(estimate.value)) " ± " (text::number(half)) }
                        }
                    }
                }
            }
        } }
    }
}

fn recordings(data: &ReportData) -> Markup {
    let is_held = |one: &&Series| data.result.held_out.contains(&one.name);
    let (held, fitted): (Vec<&Series>, Vec<&Series>) = data.series.iter().partition(is_held);
    let range = FittedRange::of(
        fitted.iter().flat_map(|one| &one.displacement),
        fitted.iter().flat_map(|one| &one.velocity),
    );
    let outside = range.filter(|_| !held.is_empty());
    html! {
        div.scroll { table {
            thead { tr {
                th { "recording" } th.text { "use" } th { "samples" } th { "length, s" }
                th { "largest displacement, mm" }
                th { "largest force, kN" }
                @if outside.is_some() { th.text { "outside the fitted motion" } }
            } }
            tbody {
                @for one in &data.series {
                    tr {
                        td.path { (one.name) }
                        td.text { @if data.result.held_out.contains(&one.name) { "held out" } @else { "fitted" } }
                        td { (one.time.len()) }
                        td { (text::number(length(one))) }
                        td { (text::number(largest(&one.displacement))) }
                        td { (text::number(largest(&one.force))) }
                        @if let Some(range) = &outside { td.text { (outside_of(range, one)) } }
                    }
                }
            }
        } }
    }
}

/// How much of a recording lies outside the motion that was fitted, and how far: what is held out there is extrapolated.
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
