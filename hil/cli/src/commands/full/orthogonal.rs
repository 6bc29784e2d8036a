//! `hil orthogonal`: an orthogonal test analysed by ranges and by variance.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_output::Plan;
use mesh_damper_paper::orthogonal::{
    AgainstPrint, Analysis, ErrorSource, Experiment, FREE_COLUMNS, SIGNIFICANCE, Variance,
    against_print, analyse,
};
use mesh_damper_reference::orthogonal_test::{LOSS_FACTOR, STIFFNESS};
use mesh_damper_report::text;
use schemars::JsonSchema;
use serde::Serialize;

use crate::commands::document::AddDocument as _;
use crate::commands::reading::Reading;
use crate::commands::{Failure, say};

/// Analyse an orthogonal test on an L9 array by range and by variance
///
/// Without a file it recomputes the paper's Table 3, and compares the paper's orders of significance with those of its numbers.
///
/// A file is CSV with nine rows. Each of two to four factors has a column factor_NAME, whose cells name its three levels. Each result has
/// a column result_NAME, or result_NAME.1, result_NAME.2 for repeats. With four factors and no repeats, the variance of the error is
/// unknown. Other columns are ignored. The first lines of such a file:
///
/// factor_density,factor_angle,factor_wire,result_stiffness.1,result_stiffness.2
///
/// 2.0,15,0.10,0.022,0.025
///
/// 2.0,45,0.15,0.057,0.051
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  hil orthogonal\n  hil orthogonal --json orthogonal.json")]
pub struct OrthogonalCommand {
    /// CSV file of the test; without it, the paper's test
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    /// Write the result as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    reading: Reading,
}

/// An orthogonal test, analysed by ranges and by variance.
#[derive(JsonSchema, Serialize)]
pub(in crate::commands) struct Summary {
    /// The analysis of each result.
    results: Vec<Analysis>,
    /// Comparison with the printed results, for the paper's own test; absent otherwise.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    against_print: Vec<AgainstPrint>,
}

impl OrthogonalCommand {
    pub fn run(self) -> Result<(), Failure> {
        let mut outputs = Plan::new().reads(&self.file).writes(&self.json).begin()?;
        let summary = match &self.file {
            Some(file) => Summary {
                results: analyse(&Experiment::read_within(file, self.reading.limit)?),
                against_print: Vec::new(),
            },
            None => Summary {
                results: analyse(&Experiment::published(&[LOSS_FACTOR, STIFFNESS])),
                against_print: [LOSS_FACTOR, STIFFNESS].iter().map(against_print).collect(),
            },
        };
        outputs.add_document_if(&self.json, &summary)?;
        outputs.write()?;
        if self.json.as_deref() != Some(Path::new("-")) {
            for (index, analysis) in summary.results.iter().enumerate() {
                print(analysis);
                if let Some(printed) = summary.against_print.get(index) {
                    print_against(printed);
                }
                say("");
            }
        }
        Ok(())
    }
}

fn print(analysis: &Analysis) {
    let variance = &analysis.variance;
    say(&analysis.response);
    say(&format!(
        "  {:18} {:>9} {:>9} {:>9} {:>9}   {:>9} {:>7} {:>8} {:>8}",
        "", "ΣK 1", "ΣK 2", "ΣK 3", "R", "S", "of all", "F", "p"
    ));
    let figure = |value: Option<f64>| value.map_or_else(|| "–".into(), text::number);
    for (index, effect) in variance.effects.iter().enumerate() {
        let ranges = match analysis.ranges.get(index) {
            Some(one) => {
                let [a, b, c] = one.sums.map(text::number);
                format!("{a:>9} {b:>9} {c:>9} {:>9}", text::number(one.range))
            }
            None => " ".repeat(39),
        };
        say(&format!(
            "  {:18} {ranges}   {:>9} {:>7} {:>8} {:>8}",
            effect.name,
            text::number(effect.sum_of_squares),
            text::percent(effect.share),
            figure(effect.f),
            figure(effect.p),
        ));
    }
    say(&format!("  order by range: {}", analysis.order.join(" > ")));
    for line in verdict(variance) {
        say(&format!("  {line}"));
    }
}

/// The conclusion of the analysis of variance, and its reference.
fn verdict(variance: &Variance) -> Vec<String> {
    let freedom = variance.error_freedom;
    let mut lines = vec![match variance.error {
        ErrorSource::Repeats => {
            format!("error: the scatter between repeats, {freedom} degrees of freedom")
        }
        ErrorSource::FreeColumns => format!(
            "error: the columns without a factor, {freedom} degrees of freedom, if no interaction falls into them"
        ),
        ErrorSource::SmallestColumn => {
            "error: with four factors, nine runs leave no column for it; the smallest column is used instead, and p accounts for \
             this choice"
                .into()
        }
        ErrorSource::None => "error: none, because the results do not scatter".into(),
    }];
    if let Some(p) = variance.p_largest {
        lines.push(format!(
            "if all scatter is error: probability p = {} of a largest column at least as large",
            text::number(p)
        ));
    }
    let level = text::nominal(SIGNIFICANCE);
    lines.push(if variance.told.is_empty() {
        format!("significant at {level}: none, so the order says nothing")
    } else {
        format!("significant at {level}: {}", variance.told.join(", "))
    });
    if variance.told.iter().any(|name| name == FREE_COLUMNS) {
        lines.push(
            "the free columns are significant: the factors interact, and nine runs cannot separate this from the factors' own effects"
                .into(),
        );
    }
    lines
}

fn print_against(printed: &AgainstPrint) {
    for misprint in &printed.misprints {
        say(&format!(
            "  Table 3 prints {} of {} as {}; its runs give {:.4}",
            misprint.figure, misprint.factor, misprint.printed, misprint.recomputed
        ));
    }
    say(&format!(
        "  by the printed ranges: {}",
        printed.order_of_printed_ranges.join(" > ")
    ));
    say(&format!(
        "  in the text:           {}",
        printed.order_in_text.join(" > ")
    ));
}
