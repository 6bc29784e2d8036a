//! The argument of the page, from the given data to the remainder, in numbered steps.

use std::collections::BTreeMap;

use maud::{Markup, html};
use mesh_damper_identify::trace::conclusion::Conclusion;
use mesh_damper_identify::trace::result::{Candidate, TraceResult};
use mesh_damper_identify::trace::rule::Rule;

use super::bars;
use super::evidence;
use super::html::{Section, figure};
use super::page::names;
use super::picture;
use super::residual::{Autocorrelation, Law, Map};
use super::{ReportData, text};

/// The residuals of eq 13 and of the final law, side by side in every map and spectrum.
pub struct Evidence {
    before: Map,
    after: Map,
    /// Scale of both maps, kN.
    scale: f64,
    white_after: Option<Autocorrelation>,
    white_before: Option<Autocorrelation>,
}

impl Evidence {
    /// For all recordings, including the held-out ones.
    pub fn of(data: &ReportData) -> Self {
        let before = Map::of(&data.series, Law::Before);
        Self {
            scale: before.scale().max(f64::MIN_POSITIVE),
            before,
            after: Map::of(&data.series, Law::After),
            white_after: Autocorrelation::of(&data.series, Law::After),
            white_before: Autocorrelation::of(&data.series, Law::Before),
        }
    }

    /// The residual of the law alone.
    pub fn before(&self, data: &ReportData) -> Section {
        let result = &data.result;
        let error = result.baseline.nrmse_held_out;
        let map = evidence::map_chart(&self.before, self.scale, "Mean residual of the law alone");
        let title = "Spectrum of the residual of the law alone";
        let spectrum = evidence::spectrum_chart(&data.series, false, title);
        let body = html! {
            p {
                "The error of the fitted law is " (text::percent(error)) " of the force's RMS on data that was \
                 never fitted; the noise of the recording is " (text::noise(result)) ". "
                @if error <= 2.0 * result.noise_floor_nrmse { "It is hardly more than noise." }
                @else if result.conclusion() == Conclusion::Hidden {
                    "That is " (text::number(error / result.noise_floor_nrmse)) " times the noise, and the uncertainty of the estimated \
                     velocity can explain all of it. "
                }
                @else {
                    "That is " (text::number(error / result.noise_floor_nrmse)) " times the noise: something is missing. "
                    "Where the map has a colour, the measured force is above (red) or below (blue) the law's every time \
                     the motion passes there; noise alone would leave it pale."
                }
                @if let Some(found) = &self.white_before { " " (whiteness(found)) }
            }
            (evidence::map_key(self.scale))
            div.pair {
                (figure(html! { "mean residual over displacement and velocity (cube-root scale)" }, &map))
                (figure(html! { "spectrum of the residual" }, &spectrum))
            }
        };
        Section::new(
            format!("2. Residual of the {}", text::law(&result.baseline)),
            body,
        )
    }

    /// The residual with the effects found.
    pub fn after(&self, data: &ReportData) -> Section {
        let result = &data.result;
        let title = "Mean residual with the effects found";
        let map = evidence::map_chart(&self.after, self.scale, title);
        let title = "Spectrum of the residual, before and after";
        let spectrum = evidence::spectrum_chart(&data.series, true, title);
        let body = html! {
            @if result.augmented.nrmse_held_out == result.baseline.nrmse_held_out {
                p { "Nothing was added, so the residual is that of the law." }
            } @else {
                p {
                    "With the effects found, the error on data that was never fitted is "
                    (text::percent(result.augmented.nrmse_held_out)) ", "
                    (text::number(result.augmented.nrmse_held_out / result.noise_floor_nrmse))
                    " times the noise. The colours are those of step 2, on the same scale."
                }
            }
            (picture::key([&spectrum], &names(result)))
            (evidence::map_key(self.scale))
            div.pair {
                (figure(html! { "mean residual over displacement and velocity (cube-root scale)" }, &map))
                (figure(html! { "spectrum of the residual, before and after" }, &spectrum))
            }
            @if let Some(found) = &self.white_after {
                (figure(
                    html! { "autocorrelation of the residual; white noise stays within the grey band 19 times in 20" },
                    &evidence::autocorrelation_chart(found)
                ))
                p { (whiteness(found)) }
            }
        };
        Section::new("5. Residual that remains", body)
    }
}

/// The test of whiteness in a sentence.
fn whiteness(found: &Autocorrelation) -> Markup {
    html! {
        "Whiteness over " (found.tested) " lags: the Ljung–Box sum is " (text::number(found.ljung_box)) "; for white noise it is "
        (found.tested) " ± " (text::number((2.0 * found.tested as f64).sqrt())) " — "
        @if found.is_white() { "white: the residual holds no further structure." }
        @else { "not white: the residual is autocorrelated. This alone says nothing about the verdict: residuals of the right effects can be so too." }
    }
}

/// Steps of the search with their candidates as bars.
pub fn tried(result: &TraceResult) -> Section {
    let steps = result.candidates.chunk_by(|a, b| a.step == b.step);
    let body = html! {
        @if result.candidates.is_empty() {
            @if result.conclusion() == Conclusion::Hidden {
                p { "Nothing: the residual of the law is no more than the noise and the uncertainty of the estimated velocity." }
            } @else {
                p { "Nothing: the residual of the law is no more than the noise." }
            }
        } @else {
            p {
                "Each step starts from the law with the effects of the earlier steps, and tries every family of effects. The \
                 bars are errors on the validation data, which was not fitted; the dotted line is the noise. Each \
                 family is shown by its best form. A form was fitted only if its predicted gain was among the largest and the law was not \
                 yet near the noise. For a form that was not fitted, the bar is the error at the starting values of the fit; it can be \
                 longer than the bar before the step. Samples count less where the estimated motion is uncertain, so that the errors can be \
                 far smaller than in part 6. Bars longer than twice the median are cut. A step without a clear gain adds nothing \
                 and ends the search."
            }
            ul.key {
                li { i.swatch.stood {} "before the step" }
                li { i.swatch.won {} "added" }
                li { i.swatch.rival {} "rival: not distinguishable from the best" }
                li { i.swatch {} "worse" }
                li { i.swatch.refused {} "refused: not admissible, for the reason below" }
            }
            @for step in steps { (bars(step, result)) }
        }
    };
    Section::new("3. Effects tried", body)
}

/// One step.
fn bars(step: &[Candidate], result: &TraceResult) -> Markup {
    let number = step[0].step;
    // The law before the step, with the error on the same samples; before the first step it is the law alone.
    let before: Vec<&Candidate> = result
        .candidates
        .iter()
        .filter(|c| c.added && c.step < number)
        .collect();
    let reference = match before.last() {
        Some(candidate) => Some(candidate.nrmse_judged),
        None => result.baseline.nrmse_judged,
    };
    let shown = best_of_families(step);
    let largest = longest_bar(&shown, reference);
    let bar = |name: (&str, Option<String>), class: &str, error: f64, state: &str| {
        let noise = bars::dotted(result.noise_floor_nrmse / largest);
        bars::bar(
            name,
            (class, error / largest),
            noise,
            &text::percent(error),
            state,
        )
    };
    html! {
        h3 {
            "Step " (number) ": added to the law"
            @for candidate in &before { " + " (text::name(&candidate.family)) }
        }
        div.bars {
            @if let Some(reference) = reference {
                (bar(("before the step", None), "bar stood", reference, ""))
            }
            @for (place, candidate) in shown.iter().enumerate() {
                @let (class, state) = if candidate.added { ("bar won", "added") } else if !candidate.admissible { ("bar refused", "refused") }
                    else if place == 0 || !candidate.distinguishable { ("bar rival", "rival") } else { ("bar", "") };
                @let title = text::description(&candidate.family);
                (bar((&text::name(&candidate.family), Some(title)), class, candidate.nrmse_judged, state))
            }
        }
        @let rejected = rejected(&shown);
        @if !rejected.is_empty() {
            p { "Not added:" }
            ul {
                @for (rule, names) in rejected {
                    li { strong { (text::listed(&names)) } ": " (rule.says()) "." }
                }
            }
        }
    }
}

/// The rules that rejected candidates of a step, each with the names of these candidates.
fn rejected(shown: &[&Candidate]) -> BTreeMap<Rule, Vec<String>> {
    let mut rejected: BTreeMap<Rule, Vec<String>> = BTreeMap::new();
    for candidate in shown {
        if let Some(rule) = candidate.rejected_by {
            let names = rejected.entry(rule).or_default();
            let name = text::name(&candidate.family);
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    rejected
}

/// Of each family the form that was added, or else the first in the ranking of the search.
fn best_of_families(step: &[Candidate]) -> Vec<&Candidate> {
    let is_shown = |place: usize| {
        let mut family = step
            .iter()
            .filter(|other| other.family == step[place].family);
        let added = family.clone().find(|other| other.added);
        added
            .or_else(|| family.next())
            .is_some_and(|shown| std::ptr::eq(shown, &raw const step[place]))
    };
    (0..step.len())
        .filter(|&place| is_shown(place))
        .map(|place| &step[place])
        .collect()
}

/// The error at the end of the bars: at most twice the median, so that one bad fit does not squeeze all others.
fn longest_bar(shown: &[&Candidate], reference: Option<f64>) -> f64 {
    let mut errors: Vec<f64> = shown
        .iter()
        .map(|candidate| candidate.nrmse_judged)
        .filter(|error| error.is_finite())
        .chain(reference)
        .collect();
    errors.sort_unstable_by(f64::total_cmp);
    let median = errors.get(errors.len() / 2).copied().unwrap_or(0.0);
    let largest = errors.last().copied().unwrap_or(0.0);
    largest
        .min((2.0 * median).max(reference.unwrap_or(0.0)))
        .max(f64::MIN_POSITIVE)
}

/// Effects that a step added and the final law does not have.
fn dropped(result: &TraceResult) -> Vec<String> {
    let kept = |family: &str| {
        let mut effects = result.effects.iter().chain(&result.unconfirmed);
        effects.any(|effect| effect.family == family)
    };
    let mut names: Vec<String> = result
        .candidates
        .iter()
        .filter(|candidate| candidate.added && !kept(&candidate.family))
        .map(|candidate| text::name(&candidate.family))
        .collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// The result in words, and the test that would settle open questions.
pub fn concluded(result: &TraceResult) -> Markup {
    html! {
        @match result.conclusion() {
            Conclusion::Hidden => {
                p {
                    "Nothing that these recordings can show: the uncertainty of the estimated velocity hides an effect, if there is one."
                }
            }
            Conclusion::Contradicted => {
                p { "Nothing that the fitted data shows, but the law does not explain the held-out data." }
            }
            Conclusion::NothingMissing => {
                p {
                    "Nothing: the residual of the law alone on the validation data is hardly more than the noise, or no family \
                     makes it clearly smaller."
                }
            }
            Conclusion::Found => {}
            Conclusion::Ambiguous if result.effects.len() == 1 => {
                p {
                    @if text::is_or_zero(result) { "So does another zero of the displacement." }
                    @else { "It explains the recordings with any value of the parameter that they do not bound." }
                }
            }
            Conclusion::Ambiguous => {
                p {
                    @if result.remainder.is_none() { "Any one of these explains the recordings" }
                    @else { "Any one of these explains the same part of the recordings, and a residual remains" }
                    "; they cannot tell which it is."
                }
            }
            Conclusion::Unlisted => {
                p {
                    "No family of effects explains the whole residual"
                    @if !result.effects.is_empty() { "; the effects that reduce it most are below." }
                    @else if result.correction.is_some() { "; a residual table stands in for it." }
                    @else { "." }
                }
            }
        }
        @if let Some(rule) = result.effects_rejected_by {
            p {
                @if rule == Rule::SaysLess { "The effects found by the search explain the fitted data only: " }
                @else { "The effects found by the search do not explain all of the recordings: " }
                (rule.says()) "."
            }
        }
        @if let Some(rule) = result.table_rejected_by {
            p { "No residual table was added: " (rule.says()) "." }
        }
        @let dropped = dropped(result);
        @if !dropped.is_empty() {
            p { "Added at a step, but not kept in the end: " (text::listed(&dropped)) "." }
        }
        @if !result.depends_on.is_empty() {
            p { "What the law alone leaves of the force depends on " strong { (text::listed(&result.depends_on)) } "." }
        }
        @if let Some(test) = &result.separating_test {
            p.test { strong { "The test that would decide: " } (test) }
        }
    }
}
