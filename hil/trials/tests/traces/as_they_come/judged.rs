//! What a trace says about a drawn recording, compared with the truth.

use std::path::Path;

use mesh_damper_identify::trace::result::{Estimate, FoundEffect, TraceResult, Verdict};
use mesh_damper_identify::trace::{TraceError, trace};
use mesh_damper_recording::Recording;
use mesh_damper_recording::faults::{Between, ChannelFault, ChannelFaultKind};
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_tables::channel::Channel;

use super::drawn::{Drawn, Filled, Kind, Wrong};

/// A parameter is wrong beyond this many half-widths of its 90 % interval and [`OFF`] of its value. Five standard deviations.
const HALF_WIDTHS: f64 = 3.0;
const OFF: f64 = 0.02;
/// The damping is wrong if the loss factor at the highest frequency is off by more than this. It is 0.2 to 0.5.
const OFF_LOSS: f64 = 0.02;

/// More elements than a stick-slip has.
const MOST_ELEMENTS: usize = 16;

/// The judgement of one recording.
#[derive(Default)]
pub struct Judged {
    /// A channel fault, an effect beside the stick-slip, or a refusal.
    pub found: bool,
    /// What was drawn, by its type, and with its size.
    pub named: bool,
    /// Nothing else.
    pub nothing_else: bool,
    /// No parameter is wrong.
    pub right: bool,
    /// Whether the recording begins at rest.
    pub begins_at_rest: bool,
    /// Parameters within their 90 % intervals, and their number.
    pub inside: [usize; 2],
    /// Everything that was found, for a reader.
    pub said: String,
}

/// What a trace found.
struct Found<'t> {
    faults: &'t [ChannelFault],
    effects: &'t [FoundEffect],
    is_ambiguous: bool,
    /// Samples per second.
    rate: f64,
}

impl Found<'_> {
    fn effect(&self, family: &str) -> Option<&FoundEffect> {
        self.effects.iter().find(|effect| effect.family == family)
    }
}

fn recording(drawn: &Drawn) -> Result<Recording, TraceError> {
    let text = drawn.text.clone().into_bytes();
    Ok(Recording::from_bytes(Path::new("drawn.csv"), text)?)
}

/// `value` is `truth` to within a part of it.
fn near(value: f64, truth: f64, part: f64) -> bool {
    (value - truth).abs() <= part * truth.abs()
}

impl Judged {
    /// As `hil trace` reads and traces it.
    pub fn of(drawn: &Drawn) -> Self {
        let traced = recording(drawn).and_then(|recording| trace(&[recording], &[], &|_| ()));
        let trace = match traced {
            Ok(trace) => trace,
            Err(error) => return Self::refused(drawn, &error.to_string()),
        };
        let trajectory = &trace.recordings[0].trajectory;
        let result = &trace.result;
        let found = Found {
            faults: &trajectory.faults,
            effects: &result.effects,
            is_ambiguous: result.verdict == Verdict::Ambiguous,
            rate: 1.0 / trajectory.tick,
        };
        let parameters = Parameters::of(drawn, result);
        // Where the channels may be exchanged, and a note says so, no parameters are expected.
        let doubt = ChannelFaultKind::Exchanged { repaired: false };
        let is_doubted = found.faults.iter().any(|fault| fault.kind == doubt);
        let names = found.effects.iter().map(|effect| effect.family.as_str());
        let names = names.collect::<Vec<_>>().join(", ");
        let said = format!("{:?}: {names}; {}", result.verdict, parameters.said);
        let judged = Self::by(drawn, &found, &said);
        // This verdict says that something else is missing.
        let is_unlisted = result.verdict == Verdict::Unlisted;
        Self {
            found: judged.found || is_unlisted,
            nothing_else: is_doubted || judged.nothing_else && !is_unlisted,
            right: is_doubted || parameters.said.is_empty(),
            inside: if is_doubted {
                [0, 0]
            } else {
                parameters.inside
            },
            ..judged
        }
    }

    /// As far as the reading of its channels shows.
    pub fn read(drawn: &Drawn) -> Self {
        let trajectory =
            match recording(drawn).and_then(|recording| Ok(Trajectory::of(&recording)?)) {
                Ok(trajectory) => trajectory,
                Err(error) => return Self::refused(drawn, &error.to_string()),
            };
        let found = Found {
            faults: &trajectory.faults,
            effects: &[],
            is_ambiguous: false,
            rate: 1.0 / trajectory.tick,
        };
        Self {
            right: true,
            ..Self::by(drawn, &found, "")
        }
    }

    /// Whether nothing is wrong.
    pub fn is_right(&self) -> bool {
        self.named && self.nothing_else && self.right
    }

    fn by(drawn: &Drawn, found: &Found, said: &str) -> Self {
        let is_other = |effect: &FoundEffect| effect.family != "stick_slip";
        let (named, nothing_else) = match drawn.kind {
            None => (true, found.faults.is_empty() && found.has_only(&[])),
            Some(kind) => (
                found.names(kind, drawn),
                found.faults.iter().all(|fault| belongs(fault.kind, kind))
                    && found.has_only(families_of(kind)),
            ),
        };
        // Rounded times that do not repeat are read without a word.
        let is_silent = matches!(drawn.kind, Some(Kind::RoundedTimes { .. })) && named;
        let Drawn {
            kind,
            specimen,
            rate,
            highest,
            noise,
            ..
        } = drawn;
        let faults = found.faults.iter().map(ToString::to_string);
        let faults = faults.collect::<Vec<_>>().join("; ");
        Self {
            found: !found.faults.is_empty() || found.effects.iter().any(is_other) || is_silent,
            named,
            nothing_else,
            begins_at_rest: drawn.begins_at_rest,
            said: format!(
                "{kind:?}, {specimen:?}, {rate:.1} Hz, up to {highest:.2} Hz, noise {noise:.4}: read at {:.1} Hz; {faults}; {said}",
                found.rate
            ),
            ..Self::default()
        }
    }

    /// A refusal is right where the recording has too little for a trace, and says so.
    fn refused(drawn: &Drawn, said: &str) -> Self {
        let words = match drawn.kind {
            Some(Kind::WholeSeconds { .. }) => "--rate",
            Some(Kind::ChangesOnly { .. }) => "changed",
            _ => "\0",
        };
        let named = said.contains(words);
        Self {
            found: true,
            named,
            nothing_else: named,
            right: named,
            begins_at_rest: drawn.begins_at_rest,
            inside: [0, 0],
            said: format!("{:?}: {said}", drawn.kind),
        }
    }
}

/// Families of effects in which a kind may show.
fn families_of(kind: Kind) -> &'static [&'static str] {
    match kind {
        Kind::Mass { .. } => &["inertia"],
        Kind::LowPass {
            wrong: Wrong::Force,
            ..
        } => &["delay"],
        _ => &[],
    }
}

/// Whether a fault belongs to a recording of this kind, even if it is not its name.
fn belongs(fault: ChannelFaultKind, kind: Kind) -> bool {
    use ChannelFaultKind as F;
    match kind {
        Kind::WrongValue { .. } => {
            matches!(
                fault,
                F::Spikes { .. } | F::Held { .. } | F::Zeros { .. } | F::Missing { .. }
            )
        }
        Kind::RoundedTimes { .. } | Kind::WholeSeconds { .. } => matches!(fault, F::Stamps { .. }),
        Kind::UnevenSteps { .. } => matches!(fault, F::Uneven { .. }),
        Kind::Joined { .. } | Kind::BlankCell { .. } => matches!(fault, F::Missing { .. }),
        Kind::ClockSet { .. } | Kind::TimeCounter { .. } => matches!(fault, F::ClockSet { .. }),
        Kind::DisplacementCounter { .. } => matches!(fault, F::Counter { .. }),
        Kind::SlowForce { .. } => matches!(fault, F::Slower { .. }),
        Kind::ChangesOnly { .. } => matches!(fault, F::ChangesOnly { .. }),
        Kind::Exchanged => matches!(fault, F::Exchanged { .. }),
        Kind::LateDisplacement { .. } | Kind::LowPass { .. } => matches!(fault, F::Shifted { .. }),
        Kind::Mass { .. } => false,
    }
}

impl Found<'_> {
    /// Stick-slip, and perhaps effects of these families. Several that the data cannot tell apart must have the stick-slip among them.
    fn has_only(&self, families: &[&str]) -> bool {
        let may_be = |effect: &FoundEffect| {
            effect.family == "stick_slip" || families.contains(&effect.family.as_str())
        };
        self.effects.iter().all(may_be) || self.is_ambiguous && self.effects.iter().any(may_be)
    }

    /// Whether the kind is named, with its size.
    fn names(&self, kind: Kind, drawn: &Drawn) -> bool {
        use ChannelFaultKind as F;
        let any = |is: &dyn Fn(&ChannelFault) -> bool| self.faults.iter().any(is);
        match kind {
            Kind::WrongValue { wrong, rows, .. } => any(&|fault| match (fault.kind, wrong) {
                (F::Zeros { samples }, Wrong::Row) => samples == rows,
                (F::Spikes { samples, .. } | F::Held { samples, .. }, of) => {
                    let channel = match of {
                        Wrong::Displacement => Channel::Displacement,
                        _ => Channel::Force,
                    };
                    fault.channel == channel && samples == rows
                }
                _ => false,
            }),
            // Without times that repeat there is nothing to say.
            Kind::RoundedTimes { decimals } => {
                let repeats = drawn.rate > 1.05 * 10.0_f64.powi(decimals as i32);
                let said = any(&|fault| matches!(fault.kind, F::Stamps { .. }));
                near(self.rate, drawn.rate, 2e-4) && (said || !repeats)
            }
            Kind::WholeSeconds { .. } => {
                near(self.rate, drawn.rate, 5e-3)
                    && any(&|fault| matches!(fault.kind, F::Stamps { .. }))
            }
            Kind::UnevenSteps { times } => any(&|fault| match fault.kind {
                F::Uneven {
                    shortest, longest, ..
                } => near(longest / shortest, times as f64, 0.01),
                _ => false,
            }),
            Kind::Joined { pause } => any(&|fault| match fault.kind {
                F::Missing { samples, gaps: 1 } => samples as f64 >= pause * drawn.rate - 2.0,
                _ => false,
            }),
            Kind::ClockSet { by } => any(&|fault| match fault.kind {
                F::ClockSet {
                    change,
                    times: 1,
                    is_counter: false,
                } => near(change, by, 1e-3),
                _ => false,
            }),
            Kind::TimeCounter { range, .. } => any(&|fault| match fault.kind {
                F::ClockSet {
                    change,
                    is_counter: true,
                    ..
                } => near(change.abs(), range, 1e-3),
                _ => false,
            }),
            Kind::DisplacementCounter { range } => any(&|fault| match fault.kind {
                F::Counter { range: found, .. } => near(found, range, 1e-2),
                _ => false,
            }),
            Kind::SlowForce { rows, filled } => any(&|fault| match fault.kind {
                F::Slower {
                    rows: found,
                    between,
                } => {
                    let of = match filled {
                        Filled::Held => Between::Held,
                        Filled::Interpolated => Between::Interpolated,
                        Filled::Blank => Between::Nothing,
                    };
                    fault.channel == Channel::Force
                        && between == of
                        && near(found, rows as f64, 0.02)
                }
                _ => false,
            }),
            Kind::ChangesOnly { .. } => any(&|fault| matches!(fault.kind, F::ChangesOnly { .. })),
            Kind::Exchanged => any(&|fault| matches!(fault.kind, F::Exchanged { .. })),
            Kind::LateDisplacement { by } => any(&|fault| match fault.kind {
                // To a tenth of a period of the samples, or of the delay.
                F::Shifted { late } => (late + by).abs() < f64::max(0.1 * by, 0.1 / drawn.rate),
                _ => false,
            }),
            Kind::LowPass {
                wrong: Wrong::Displacement,
                corner,
            } => any(&|fault| match fault.kind {
                F::Shifted { late } => {
                    let delay = std::f64::consts::SQRT_2 / (std::f64::consts::TAU * corner);
                    near(late, -delay, 0.25)
                }
                _ => false,
            }),
            Kind::LowPass { corner, .. } => self.effect("delay").is_some_and(|effect| {
                // A filter may be taken for a delay of a fixed time.
                let delay = std::f64::consts::SQRT_2 / (std::f64::consts::TAU * corner);
                let value = |name: &str| effect.parameters.get(name).map(|one| one.value);
                value("corner").is_some_and(|found| near(found, corner, 0.25))
                    || value("time").is_some_and(|found| near(found, delay, 0.25))
            }),
            Kind::Mass { kg } => {
                self.effect("inertia").is_some_and(|effect| {
                    effect
                        .parameters
                        .get("mass")
                        .is_some_and(|mass| !is_wrong(mass, kg, 0.05))
                }) || self.is_ambiguous && self.effect("inertia").is_some()
            }
            Kind::BlankCell { .. } => any(&|fault| {
                matches!(
                    fault.kind,
                    F::Missing {
                        samples: 1,
                        gaps: 1
                    }
                )
            }),
        }
    }
}

/// Whether the truth is far outside of the interval.
fn is_wrong(estimate: &Estimate, truth: f64, off: f64) -> bool {
    let half = 0.5 * (estimate.high - estimate.low);
    (estimate.value - truth).abs() > f64::max(HALF_WIDTHS * half, off * truth.abs())
}

/// The parameters of the law and of its stick-slip.
struct Parameters {
    inside: [usize; 2],
    /// Those that are wrong; empty if none is.
    said: String,
}

impl Parameters {
    fn of(drawn: &Drawn, result: &TraceResult) -> Self {
        let specimen = drawn.specimen;
        let slips = || {
            let effects = result.effects.iter().chain(&result.unconfirmed);
            effects.filter(|effect| effect.family == "stick_slip")
        };
        let mut estimates = Vec::new();
        let turn = std::f64::consts::TAU * drawn.highest;
        let off_damping = OFF_LOSS * specimen.stiffness / turn / specimen.damping;
        for law in &result.law {
            estimates.push(("k1", &law.k1, specimen.stiffness, OFF));
            estimates.push(("c", &law.c, specimen.damping, off_damping));
        }
        // Elements beside the largest may be there in name: with nothing in their intervals.
        let mut sliders = 0;
        for slip in slips() {
            let named = |name: &str, element: usize| match element {
                1 => slip.parameters.get(name),
                _ => slip.parameters.get(&format!("{name}_{element}")),
            };
            let mut elements: Vec<[&Estimate; 2]> = (1..=MOST_ELEMENTS)
                .filter_map(|element| {
                    let [stiffness, limit] =
                        ["stiffness", "slip_limit"].map(|name| named(name, element));
                    Some([stiffness?, limit?])
                })
                .collect();
            elements.sort_by(|a, b| b[0].value.total_cmp(&a[0].value));
            let are_more =
                |others: &[[&Estimate; 2]]| others.iter().any(|other| other[0].low > 0.0);
            if let [[stiffness, limit], others @ ..] = &elements[..] {
                sliders += 1 + usize::from(are_more(others));
                estimates.push(("stiffness", stiffness, specimen.slip_stiffness, OFF));
                estimates.push(("slip_limit", limit, specimen.slip_limit, OFF));
            }
        }
        let inside = estimates
            .iter()
            .filter(|(_, estimate, truth, _)| (estimate.low..=estimate.high).contains(truth));
        let wrong = estimates
            .iter()
            .filter(|(_, estimate, truth, off)| is_wrong(estimate, *truth, *off));
        let mut said: Vec<String> = wrong
            .map(|(name, estimate, truth, _)| {
                let Estimate {
                    value, low, high, ..
                } = estimate;
                format!("{name} {value:.4} [{low:.4}, {high:.4}] is {truth:.4}")
            })
            .collect();
        if sliders != 1 {
            said.push(format!("{sliders} sliders"));
        }
        Self {
            inside: [inside.count(), estimates.len()],
            said: said.join(", "),
        }
    }
}
