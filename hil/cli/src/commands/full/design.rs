//! `hil design`: the densities that give a stiffness and a loss factor.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use mesh_damper_paper::design::{
    Design, DesignError, Meets, OnRig, Point, Reachable, Source, Wanted, design, on_rig,
};
use mesh_damper_report::text;
use schemars::JsonSchema;
use serde::Serialize;

use super::law::PublishedLaw;
use super::run::in_words;
use crate::commands::document::AddDocument as _;
use crate::commands::progress::Progress;
use crate::commands::{Failure, say};

/// Find the densities that give a stiffness and a loss factor
///
/// A density has both only at certain amplitudes. The command prints every pair of density and amplitude that meets both, with the
/// amplitudes around it that stay within the tolerance. It also prints near misses, which meet both only within the tolerance. With
/// --amplitude it prints the nearest densities within the tolerance at that amplitude.
///
/// For each pair it also prints two checks: the result of the other source (tables or surfaces), and the result of a test on the
/// simulated rig.
///
/// Exit code 1: no density gives both, and the nearest one is printed; or the rig tripped.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  hil design --stiffness 4 --loss-factor 0.3\n  \
    hil design --stiffness 1.7 --loss-factor 0.6 --amplitude 0.1\n  \
    hil design --stiffness 1.7 --loss-factor 0.6 --amplitude-range 0.05..0.15"
)]
pub struct DesignCommand {
    /// Wanted dynamic stiffness in kN/mm, above 0
    #[arg(long, value_name = "KN_PER_MM", allow_negative_numbers = true)]
    stiffness: f64,
    /// Wanted dynamic loss factor, above 0
    #[arg(long, value_name = "ETA", allow_negative_numbers = true)]
    loss_factor: f64,
    /// Amplitude of the cycles in mm, 0.05 to 0.25; the default is any of these
    #[arg(
        long,
        value_name = "MM",
        conflicts_with = "amplitude_range",
        allow_negative_numbers = true
    )]
    amplitude: Option<f64>,
    /// Range of amplitudes in mm, within 0.05..0.25, such as 0.05..0.15
    #[arg(long, value_name = "MM..MM")]
    amplitude_range: Option<String>,
    /// Frequency of the cycles in Hz, 0.1 to 100; the paper tested at 1 Hz
    #[arg(
        long,
        value_name = "HZ",
        default_value_t = 1.0,
        allow_negative_numbers = true
    )]
    frequency: f64,
    /// Largest relative error of stiffness and loss factor, 1e-6 to 0.5; 0.05 is 5 %
    #[arg(
        long,
        value_name = "PART",
        default_value_t = 0.05,
        allow_negative_numbers = true
    )]
    tolerance: f64,
    /// Source of the coefficients
    #[arg(long, value_enum, default_value_t = PublishedLaw::Tables)]
    law: PublishedLaw,
    /// Write the result as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Designs of a damper for a stiffness and a loss factor, each tested on the rig.
#[derive(JsonSchema, Serialize)]
pub(in crate::commands) struct Summary {
    #[serde(flatten)]
    design: Design,
    /// The outcome of a run on the rig for each solution.
    on_rig: Vec<Outcome>,
}

/// The outcome of a run on the rig.
#[derive(JsonSchema, Serialize)]
#[serde(rename_all = "snake_case")]
enum Outcome {
    /// Measured means over the steady cycles.
    Measured(OnRig),
    /// The limit at which the rig tripped.
    Stopped(&'static str),
}

impl Outcome {
    fn of(point: &Point, wanted: &Wanted) -> Result<Self, DesignError> {
        match on_rig(point, wanted.law, wanted.frequency) {
            Ok(measured) => Ok(Self::Measured(measured)),
            Err(DesignError::Stopped { fault, .. }) => Ok(Self::Stopped(in_words(fault))),
            Err(error) => Err(error),
        }
    }
}

impl DesignCommand {
    pub fn run(self) -> Result<(), Failure> {
        let mut outputs = Plan::new().writes(&self.json).begin()?;
        let mut wanted = Wanted::new(self.stiffness, self.loss_factor).map_err(refused)?;
        wanted.frequency = self.frequency;
        wanted.tolerance = self.tolerance;
        wanted.law = self.law.source();
        if let Some(amplitude) = self.amplitude {
            wanted.amplitudes = (amplitude, amplitude);
        }
        if let Some(text) = &self.amplitude_range {
            wanted.amplitudes = range(text)?;
        }
        let design = design(&wanted).map_err(refused)?;
        let progress = Progress::steps();
        progress.step("running the rig");
        let runs = design.solutions.iter();
        let on_rig = runs
            .map(|solution| Outcome::of(&solution.point, &wanted))
            .collect::<Result<Vec<_>, _>>()
            .map_err(refused)?;
        drop(progress);
        let summary = Summary { design, on_rig };
        outputs.add_document_if(&self.json, &summary)?;
        outputs.write()?;
        if self.json.as_deref() != Some(Path::new("-")) {
            print(&summary);
        }
        if summary.design.solutions.is_empty() {
            return Err(Failure::Check(none(&summary.design)));
        }
        let stopped = |outcome: &Outcome| matches!(outcome, Outcome::Stopped(_));
        if summary.on_rig.iter().any(stopped) {
            return Err(Failure::Check(
                "the rig tripped, so not every solution is checked".into(),
            ));
        }
        Ok(())
    }
}

fn refused(error: DesignError) -> InputError {
    let problem = error.to_string();
    match error {
        DesignError::OutOfRange {
            field, low, high, ..
        } => InputError::new(
            format!("--{field}"),
            problem,
            format!("give {low} to {high}"),
        ),
        DesignError::Amplitudes(..) => {
            InputError::new("--amplitude-range", problem, "give the smaller one first")
        }
        DesignError::Rig(_) | DesignError::Stopped { .. } => {
            InputError::new("the rig", problem, "choose another amplitude or frequency")
        }
    }
}

/// Parses `from..to`, in mm.
fn range(text: &str) -> Result<(f64, f64), InputError> {
    let ends = text
        .split_once("..")
        .and_then(|(low, high)| Some((low.trim().parse().ok()?, high.trim().parse().ok()?)));
    ends.ok_or_else(|| {
        InputError::new(
            "--amplitude-range",
            format!("{} is not a range", mesh_damper_output::error::quoted(text)),
            "give two amplitudes in mm, such as 0.05..0.15",
        )
    })
}

fn print(summary: &Summary) {
    let design = &summary.design;
    if !design.solutions.is_empty() {
        let other = match design.wanted.law.other() {
            Source::Tables => "by the tables",
            Source::Surfaces => "by the surfaces",
        };
        say(&format!(
            "{:^18} {:^20} {:^13} {other:^23} {:^23}",
            "specimen", "has", "amplitudes", "on the rig"
        ));
        let figures = "errors of K and η";
        say(&format!(
            "{:>8} {:>9} {:>10} {:>9} {:^13} {figures:^23} {figures:^23}",
            "g/cm³", "mm", "K, kN/mm", "η", "within, mm"
        ));
    }
    for (solution, outcome) in design.solutions.iter().zip(&summary.on_rig) {
        let point = &solution.point;
        let (low, high) = solution.amplitudes;
        // The figures with their difference from the requirement.
        let figures = |stiffness: f64, loss_factor: f64| {
            let off = |value: f64, asked: f64| 100.0 * (value / asked - 1.0);
            let (k, eta) = (
                off(stiffness, design.wanted.stiffness),
                off(loss_factor, design.wanted.loss_factor),
            );
            format!("{:>23}", format!("{k:+.1} %, {eta:+.1} %"))
        };
        let other = &solution.by_other_law;
        let on_rig = match outcome {
            Outcome::Measured(rig) => figures(rig.stiffness, rig.loss_factor),
            Outcome::Stopped(why) => format!(" {why}"),
        };
        let miss = match solution.meets {
            Meets::Both => "",
            Meets::WithinTolerance => "  near miss",
        };
        say(&format!(
            "{:8.4} {:9.5} {:10.4} {:9.4} {low:.4}…{high:.4} {} {on_rig}{miss}",
            point.density,
            point.amplitude,
            point.stiffness,
            point.loss_factor,
            figures(other.stiffness, other.loss_factor),
        ));
    }
    let Reachable {
        stiffness,
        loss_factor,
        loss_factor_at_stiffness,
        stiffness_at_loss_factor,
        nearest,
    } = &design.reachable;
    say(&format!(
        "Reachable {} at {} Hz: K = {} kN/mm, loss factor = {}",
        at_amplitudes(design),
        design.wanted.frequency,
        span(*stiffness),
        span(*loss_factor)
    ));
    let spanned = |range: &Option<(f64, f64)>| range.map_or_else(|| "none".into(), span);
    say(&format!(
        "  loss factors at the wanted K: {}",
        spanned(loss_factor_at_stiffness)
    ));
    say(&format!(
        "  K at the wanted loss factor, kN/mm: {}",
        spanned(stiffness_at_loss_factor)
    ));
    if design.solutions.is_empty() {
        say(&format!("  nearest: {}", described(nearest)));
    }
}

fn span((low, high): (f64, f64)) -> String {
    let (low, high) = (text::number(low), text::number(high));
    if low == high {
        return low;
    }
    format!("{low}…{high}")
}

fn described(point: &Point) -> String {
    format!(
        "K = {} kN/mm and loss factor = {} with {} g/cm³ at {} mm",
        text::number(point.stiffness),
        text::number(point.loss_factor),
        text::number(point.density),
        text::number(point.amplitude)
    )
}

fn at_amplitudes(design: &Design) -> String {
    let (low, high) = design.wanted.amplitudes;
    if low == high {
        format!("at {low} mm")
    } else {
        format!("at any of {low}…{high} mm")
    }
}

fn none(design: &Design) -> String {
    let amplitudes = at_amplitudes(design);
    format!(
        "no density gives K = {} kN/mm and loss factor = {} within {} {amplitudes}; nearest is {}",
        design.wanted.stiffness,
        design.wanted.loss_factor,
        text::percent(design.wanted.tolerance),
        described(&design.reachable.nearest)
    )
}
