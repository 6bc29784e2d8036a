//! The report of a made-up trace.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use mesh_damper_identify::trace::result::{
    Baseline, Candidate, Errors, Estimate, Explainable, FoundEffect, HeldCondition, LawEstimate,
    OnTarget, Rejected, Remainder, Verdict,
};
use mesh_damper_identify::trace::rule::Rule;
use mesh_damper_recording::rig::RigFacts;

use super::*;

/// Blocks of amplitude (mm) and frequency (Hz), six cycles each, with a slider that the law lacks.
fn series(name: &str, blocks: &[(f64, f64)], held_out: bool) -> Series {
    let mut made = Series {
        name: name.into(),
        ..Series::default()
    };
    let (mut time, mut stretch, mut previous) = (0.0, 0.0_f64, 0.0);
    for &(amplitude, frequency) in blocks {
        let start = made.time.len();
        let count = (6.0 / frequency / 0.002) as usize;
        for i in 0..count {
            let phase = TAU * frequency * i as f64 * 0.002;
            let (y, v) = (
                amplitude * phase.sin(),
                amplitude * TAU * frequency * phase.cos(),
            );
            stretch = (stretch + y - previous).clamp(-0.03, 0.03);
            previous = y;
            let law = 0.9 * y + 20.0 * y.powi(3) + 0.06 * v.abs().powf(0.3) * v.signum();
            // Noise that is the same on every run.
            let noise = 6e-4 * ((i * 7919 % 1000) as f64 / 500.0 - 1.0);
            made.time.push(time);
            made.displacement.push(y);
            made.velocity.push(v);
            made.force.push(law + 1.2 * stretch + noise);
            made.before.push(1.15 * law);
            made.after.push(law + 1.2 * stretch);
            made.measured.push(true);
            time += 0.002;
        }
        made.blocks.push(SeriesBlock {
            cycle: start + count * 4 / 6..start + count * 5 / 6,
            cycles: (0..6)
                .map(|i| start + count * i / 6..start + count * (i + 1) / 6)
                .collect(),
            amplitude,
            frequency,
            held_out,
        });
    }
    made
}

fn data() -> ReportData {
    let estimate = |value: f64, unit: &str| Estimate {
        value,
        low: 0.97 * value,
        high: 1.04 * value,
        unit: unit.into(),
    };
    let parameters: BTreeMap<String, Estimate> = [
        ("stiffness".to_owned(), estimate(1.2, "kN/mm")),
        ("slip_limit".to_owned(), estimate(0.03, "mm")),
    ]
    .into();
    let candidate = |family: &str, nrmse_held_out, distinguishable| Candidate {
        family: family.into(),
        nrmse_held_out,
        distinguishable,
        step: 1,
        added: nrmse_held_out < 0.01,
        admissible: true,
        rejected_by: (nrmse_held_out >= 0.01).then_some(Rule::Worse),
        nrmse_judged: 1.02 * nrmse_held_out,
    };
    ReportData {
        title: "Trace of ring-3.csv".into(),
        facts: vec![("Specimen".into(), "ring <3>, 3.0 g/cm³".into())],
        result: TraceResult {
            recordings: vec!["ring-3.csv".into()],
            held_out: vec!["tests/ring-3-held.csv".into()],
            noise_floor_nrmse: 0.004,
            noise_known: true,
            baseline: Baseline {
                law: "mixed_damping".into(),
                known: Vec::new(),
                nrmse_fitted: 0.0712,
                nrmse_held_out: 0.0834,
                nrmse_judged: Some(0.0812),
                staged: Some(Errors {
                    nrmse_fitted: 0.1112,
                    nrmse_held_out: 0.1234,
                }),
            },
            law: vec![LawEstimate {
                amplitude: 0.0,
                k1: estimate(0.9, "kN/mm"),
                k3: estimate(20.0, "kN/mm^3"),
                c: estimate(0.06, "kN*(s/mm)^alpha"),
                alpha: estimate(0.3, "1"),
            }],
            verdict: Verdict::Found,
            effects: vec![FoundEffect {
                family: "stick_slip".into(),
                parameters,
                nrmse_without: 0.0834,
                nrmse_with: 0.00432,
                unconfirmed_by: None,
                rivals: Vec::new(),
            }],
            unconfirmed: Vec::new(),
            conditions: Vec::new(),
            remainder: None,
            elsewhere: None,
            explainable: None,
            candidates: vec![
                candidate("stick_slip", 0.00432, true),
                candidate("relaxation", 0.0312, true),
                candidate("viscous", 0.0733, true),
            ],
            effects_rejected_by: None,
            table_rejected_by: None,
            separating_test: None,
            separating_blocks: Vec::new(),
            held_out_differs: false,
            depends_on: vec!["displacement".into(), "history".into()],
            correction: None,
            warnings: vec!["3 samples are missing after 4.2 s".into()],
            guesses: vec![r#"a.csv: force is read from column "Load" in N"#.into()],
            rig: RigFacts::default(),
            augmented: Errors {
                nrmse_fitted: 0.0041,
                nrmse_held_out: 0.00432,
            },
            on_target: OnTarget {
                nrmse_held_out: 0.00433,
            },
            adopted: true,
            rejected: None,
            operating_conditions: None,
        },
        series: vec![
            series(
                "ring-3.csv",
                &[
                    (0.05, 1.0),
                    (0.05, 5.0),
                    (0.1, 1.0),
                    (0.1, 5.0),
                    (0.2, 1.0),
                    (0.2, 5.0),
                    (0.15, 2.0),
                ],
                false,
            ),
            series("tests/ring-3-held.csv", &[(0.12, 3.0), (0.18, 1.5)], true),
        ],
    }
}

/// The start of the heading whose address begins with this.
fn heading(page: &str, id: &str) -> usize {
    page.find(&format!("<h2 id=\"s{id}")).unwrap()
}

#[test]
fn is_one_small_file_with_everything_in_it() {
    let page = render(&data());
    if let Ok(directory) = std::env::var("REPORT_PREVIEW") {
        std::fs::write(std::path::Path::new(&directory).join("report.html"), &page).unwrap();
        let series = &data().series[0];
        let picture = loop_picture(series, &series.blocks[4]);
        std::fs::write(std::path::Path::new(&directory).join("loop.svg"), picture).unwrap();
    }
    structure::check(&page);
    assert!(page.len() < 2_000_000, "{}", page.len());
    for part in [
        "Found: stick-slip",
        "8.34 %",
        "0.432 %",
        "0.433 %",
        "slip limit",
        "0.0291 … 0.0312",
        "3 samples are missing",
        "ring &lt;3&gt;",
        "displacement, mm",
        "velocity, mm/s",
        "0.12",
        "relaxation",
    ] {
        assert!(page.contains(part), "{part}");
    }
    // Neither the page nor its script fetches anything.
    for foreign in [
        "http://",
        "https://",
        " src=",
        "<link",
        "@import",
        "url(",
        "fetch(",
        "import(",
        "XMLHttpRequest",
        "WebSocket",
    ] {
        let own = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!own.contains(foreign), "{foreign}");
    }
    // Nine loops; two maps, two spectra, an autocorrelation, the force over time; two backbones, three figures over amplitude and
    // over frequency, those over cycles, and loops one above another.
    assert_eq!(page.matches("role=\"img\"").count(), 9 + 6 + 2 + 3 + 3 + 2);
    // In the order of an argument.
    let steps = [
        "1-the-recordings",
        "2-residual-of-the",
        "3-effects-tried",
        "4-effects-found",
        "5-residual-that-remains",
        "6-error",
    ];
    let places = steps.map(|step| heading(&page, step));
    assert!(places.is_sorted());
    assert!(page.contains("not white"));
    let tried = &page[heading(&page, "3-")..];
    assert_eq!(tried.matches("bar won").count(), 1);
    // The first step too begins with what was there before it.
    assert_eq!(
        tried.matches("bar stood").count(),
        page.matches("<h3>Step ").count()
    );
}

#[test]
fn a_step_shows_each_family_at_its_best_and_cuts_the_bar_of_a_bad_fit() {
    let mut data = data();
    let mut again = data.result.candidates[1].clone();
    again.nrmse_judged = 0.0444;
    data.result.candidates.push(again);
    data.result.candidates[2].nrmse_judged = 10.0;
    // An older result, without data before the first step.
    data.result.baseline.nrmse_judged = None;
    let page = render(&data);
    let steps = heading(&page, "3-effects-tried")..heading(&page, "4-effects-found");
    assert_eq!(page[steps.clone()].matches(">relaxation</div>").count(), 1);
    // Of the three shown, relaxation has the median, and twice that is the end of the track.
    assert!(page[steps.clone()].contains("class=\"bar\" style=\"width:50.00%\""));
    assert!(page[steps].contains("class=\"bar\" style=\"width:100.00%\""));
}

#[test]
fn a_long_test_is_thinned() {
    let mut data = data();
    let block = [(0.2, 0.05); 10];
    data.series = vec![
        series("long.csv", &block, false),
        series("held.csv", &block, true),
    ];
    assert!(data.series[0].time.len() > 300_000);
    assert!(render(&data).len() < 2_000_000);
}

#[test]
fn nothing_found_and_nothing_recorded_still_make_a_page() {
    let mut data = data();
    data.series = vec![Series::default()];
    data.result.effects.clear();
    data.result.verdict = Verdict::None;
    assert!(render(&data).contains("Nothing is missing"));
    // An error of 3.1 times the noise without an effect: the velocity is too uncertain.
    let found = std::mem::replace(
        &mut data.result.augmented.nrmse_fitted,
        3.1 * data.result.noise_floor_nrmse,
    );
    let page = render(&data);
    assert!(page.contains("Not decided: the recording can hide an effect"));
    assert!(!page.contains("Nothing is missing") && !page.contains("something is missing"));
    data.result.augmented.nrmse_fitted = found;
    data.result.held_out_differs = true;
    let page = render(&data);
    assert!(page.contains("Not decided: the held-out data contradict the law"));
    assert!(page.contains("Do not use the law there") && !page.contains("Nothing is missing"));
    data.result.held_out_differs = false;
    data.result.verdict = Verdict::Unlisted;
    assert!(render(&data).contains("Nothing was added"));
    assert!(render(&data).contains("not kept in the end: stick-slip."));
    data.result.verdict = Verdict::Ambiguous;
    data.result.separating_test = Some("a ramp and hold".into());
    assert!(render(&data).contains("a ramp and hold"));
}

/// The first line contains everything that a reader must know before using the model.
#[test]
fn a_model_that_is_not_adopted_or_worse_elsewhere_says_so_first() {
    let mut result = data().result;
    assert_eq!(text::verdict(&result).0, "Found: stick-slip");
    result.augmented.nrmse_held_out = 1.5 * result.baseline.nrmse_held_out;
    let (heading, _) = text::verdict(&result);
    assert!(
        heading.ends_with("; worse than the law alone on the held-out data"),
        "{heading}"
    );
    result.verdict = Verdict::Unlisted;
    result.adopted = false;
    result.effects.clear();
    result.rejected = Some(Rejected {
        augmented: result.augmented,
        on_target: result.on_target,
    });
    let (heading, sentence) = text::verdict(&result);
    assert!(heading.ends_with("; the law alone is kept"), "{heading}");
    assert!(sentence.contains("12.5 %"), "{sentence}");
}

#[test]
fn a_step_says_by_which_rule_each_family_was_rejected() {
    let mut data = data();
    data.result.candidates[2].rejected_by = Some(Rule::NotPassive);
    let page = render(&data);
    for (names, rule) in [("relaxation", Rule::Worse), ("viscous", Rule::NotPassive)] {
        let line = format!("<li><strong>{names}</strong>: {}.</li>", rule.says());
        assert!(page.contains(&line), "{line}");
    }
    data.result.verdict = Verdict::Unlisted;
    data.result.effects_rejected_by = Some(Rule::UnknownElsewhere);
    data.result.table_rejected_by = Some(Rule::TableWorthLittle);
    let page = render(&data);
    assert!(page.contains(Rule::UnknownElsewhere.says()));
    assert!(page.contains(Rule::TableWorthLittle.says()));
}

/// Effects that were confirmed although the law is incomplete, with their gain on each condition held out.
#[test]
fn what_each_effect_gains_on_which_condition_is_a_table() {
    let mut data = data();
    assert!(!render(&data).contains("What each effect gains"));
    let condition = |amplitude, nrmse_with, without| HeldCondition {
        recording: "ring-3.csv".into(),
        repeats: 0,
        span: [0.0, 4.0],
        amplitude,
        frequency: amplitude.map(|_| 5.0),
        nrmse_with,
        nrmse_without: [("stick_slip".to_owned(), without)].into(),
    };
    let result = &mut data.result;
    result.conditions = vec![
        condition(Some(0.2), 0.02, 0.04),
        condition(None, 0.01, 0.0097),
    ];
    result.remainder = Some(Remainder {
        nrmse: 0.0152,
        times_noise: 3.2,
        held_out: false,
        depends_on: vec!["frequency".into()],
    });
    let (heading, sentence) = text::verdict(result);
    assert_eq!(heading, "Found: stick-slip; a residual remains");
    assert!(sentence.contains("1.52 %") && sentence.contains("it depends on frequency"));
    let mut delay = result.effects[0].clone();
    delay.family = "delay".into();
    delay.unconfirmed_by = Some(Rule::Rivalled);
    delay.rivals = vec!["compliance".into()];
    result.unconfirmed = vec![delay];
    let page = render(&data);
    for said in [
        "ring-3.csv, 0.200 mm at 5.00 Hz",
        "ring-3.csv, 0 s … 4.00 s",
        "without stick-slip",
        "rgba(33,102,172,0.50)",
        "rgba(178,24,43,0.02)",
        "▲",
        "stick-slip is confirmed",
        "Effects in the model that are not confirmed, with their parameters",
        "delay is not confirmed: another effect in its place predicts as well (compliance)",
        "The worst conditions",
        "ring-3.csv, 0.200 mm at 5.00 Hz, error 2.00 % where it was held out",
    ] {
        assert!(page.contains(said), "{said}");
    }
}

/// The gain is 1 − √((0.02/0.04)·(0.01/0.0097)).
#[test]
fn why_a_verdict_was_given_is_one_picture() {
    let mut data = data();
    assert!(render(&data).contains(
        "No effect was tested on conditions held out in turn: with it the error is only noise."
    ));
    let result = &mut data.result;
    let condition = |nrmse_with, without| HeldCondition {
        recording: "ring-3.csv".into(),
        repeats: 0,
        span: [0.0, 4.0],
        amplitude: None,
        frequency: None,
        nrmse_with,
        nrmse_without: [("stick_slip".to_owned(), without)].into(),
    };
    result.conditions = vec![condition(0.02, 0.04), condition(0.01, 0.0097)];
    result.effects[0].unconfirmed_by = Some(Rule::Rivalled);
    result.effects[0].rivals = vec!["backlash".into()];
    result.explainable = Some(Explainable {
        share: 0.23,
        low: 0.11,
        conditions: 5,
    });
    let page = render(&data);
    let start = heading(&page, "why-this-verdict");
    let why = &page[start..start + page[start..].find("</section>").unwrap()];
    for said in [
        "width:28.20%",
        ">28 %<",
        ">1 of 2<",
        "backlash): the recordings do not decide",
        "width:23.00%",
        ">counts<",
        "on 5 conditions",
    ] {
        assert!(why.contains(said), "{said} in {why}");
    }
}

/// With and without an additional remainder, at any position.
#[test]
fn what_is_left_beside_rivals_is_said() {
    let mut data = data();
    let result = &mut data.result;
    result.verdict = Verdict::Ambiguous;
    let (heading, one) = text::verdict(result);
    assert_eq!(heading, "Ambiguous: stick-slip");
    assert!(one.contains("do not bound one of its parameters"), "{one}");
    let mut rival = result.effects[0].clone();
    rival.family = "compliance".into();
    result.effects.push(rival);
    let (heading, alone) = text::verdict(result);
    assert_eq!(heading, "Ambiguous: stick-slip or compliance");
    assert!(alone.contains("cannot tell these apart"), "{alone}");
    result.remainder = Some(Remainder {
        nrmse: 0.0152,
        times_noise: 3.2,
        held_out: true,
        depends_on: vec!["history".into()],
    });
    let (heading, beside) = text::verdict(result);
    assert_eq!(heading, "Ambiguous: stick-slip or compliance");
    assert!(
        beside.contains("each of the others does as well in its place"),
        "{beside}"
    );
    let left = "1.52 % of the force's RMS on the held-out data, 3.20 times the noise of force and motion; it depends on history";
    assert!(beside.contains(left), "{beside}");
    let page = render(&data);
    assert!(page.contains("and a residual remains"));
    let result = &mut data.result;
    result.verdict = Verdict::Unlisted;
    result.effects_rejected_by = Some(Rule::SaysLess);
    let (_, elsewhere) = text::verdict(result);
    assert!(
        elsewhere.contains("explain the fitted data but not the held-out data"),
        "{elsewhere}"
    );
    assert!(render(&data).contains("explain the fitted data only"));
}

#[test]
fn the_law_is_called_what_it_is() {
    let mut result = data().result;
    let said = |result: &TraceResult| text::law_alone(&result.baseline);
    assert_eq!(said(&result), "mixed damping law alone");
    result.baseline.law = "none".into();
    assert_eq!(said(&result), "no law");
    result.baseline.known = vec!["stick_slip".into(), "offset".into()];
    assert_eq!(said(&result), "stick-slip and offset");
    result.baseline.law = "linear".into();
    result.verdict = Verdict::None;
    let (_, sentence) = text::verdict(&result);
    assert!(
        sentence.starts_with("The linear law with stick-slip and offset needs no further effect"),
        "{sentence}"
    );
}

#[test]
fn what_is_held_out_beyond_the_fitted_motion_is_said() {
    let mut data = data();
    let inside = render(&data);
    assert!(inside.contains("outside the fitted motion"));
    assert!(!inside.contains("beyond"));
    // Half as far again as the fitted 0.2 mm, at less than the fitted speed.
    data.series[1] = series("tests/ring-3-held.csv", &[(0.3, 1.0)], true);
    let page = render(&data);
    assert!(page.contains("of the samples by displacement, up to 50.0 % beyond"));
    assert!(!page.contains("by velocity"));
    data.result.held_out.clear();
    assert!(!render(&data).contains("outside the fitted motion"));
}

/// The pictures of cycles depend on the motion, and the page reports which are missing.
#[test]
fn pictures_of_cycles_are_drawn_where_the_motion_has_them() {
    let mut data = data();
    let section = |data: &ReportData| {
        let page = render(data);
        let start = heading(&page, "cycles-backbone");
        page[start..heading(&page, "residual-over-time")].to_owned()
    };
    let all = section(&data);
    assert_eq!(all.matches("<figure").count(), 2 + 3 + 3 + 2);
    for said in [
        "Backbone",
        "storage stiffness K′ over amplitude, by frequency",
        "loss stiffness K″ over frequency, by amplitude",
        "by frequency and amplitude",
        "0.15 mm, 2 Hz</th>",
    ] {
        assert!(all.contains(said), "{said}");
    }
    // One block: its cycles are one above another, and there is no curve over a condition.
    data.series = vec![series("one.csv", &[(0.1, 2.0)], false)];
    let one = section(&data);
    assert_eq!(one.matches("<figure").count(), 2 + 2);
    for said in [
        "of one amplitude",
        "of one frequency",
        "by cycle, the first below",
        ">cycle 6</text>",
    ] {
        assert!(one.contains(said), "{said}");
    }
    // No cycle resembles the one before.
    for block in &mut data.series[0].blocks {
        block.cycles.truncate(1);
    }
    let none = section(&data);
    assert_eq!(none.matches("<figure").count(), 0);
    assert!(none.contains("no two consecutive cycles of these recordings are alike"));
}
