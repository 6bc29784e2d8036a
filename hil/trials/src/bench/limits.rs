//! The requirements on the image.

use std::borrow::Cow;

use mesh_damper::effects::DESCRIPTIONS;
use mesh_damper::effects::description::{Cost, Description};
use mesh_damper_firmware::bench::suite::tick::BLOCK;
use serde::Serialize;

use super::count::Core;
use super::firmware;
use super::results::Results;
use super::uses;

/// The side of a limit on which a figure has to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// At most the limit.
    AtMost,
    /// At least the limit.
    AtLeast,
}

/// A limit and the measured value.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Verdict {
    /// The name of the limit.
    pub name: Cow<'static, str>,
    /// The figure's unit.
    pub unit: &'static str,
    /// The side of the limit on which the figure has to be.
    pub side: Side,
    /// The limit, in the unit.
    pub limit: f64,
    /// The measured figure, in the unit; null if it was not measured.
    pub figure: Option<f64>,
}

impl Verdict {
    /// Whether the figure meets the limit; an unmeasured figure counts as meeting it.
    pub fn holds(&self) -> bool {
        self.figure.is_none_or(|figure| match self.side {
            Side::AtMost => figure <= self.limit,
            Side::AtLeast => figure >= self.limit,
        })
    }

    /// The line about a missed limit.
    pub fn failure(&self) -> Option<String> {
        let figure = self.figure.filter(|_| !self.holds())?;
        Some(format!(
            "{}: {} {}, required: {}",
            self.name,
            number(figure),
            self.unit,
            self.asked_for()
        ))
    }

    /// The limit with its side.
    pub fn asked_for(&self) -> String {
        let side = match self.side {
            Side::AtMost => "at most",
            Side::AtLeast => "at least",
        };
        format!("{side} {}", number(self.limit))
    }

    /// The figure, `-` where there is none.
    pub fn figure(&self) -> String {
        self.figure.map_or_else(|| "-".to_owned(), number)
    }
}

/// With a suitable number of digits.
fn number(value: f64) -> String {
    if value != 0.0 && value.abs() < 0.01 {
        format!("{value:.1e}")
    } else if value.abs() < 10.0 {
        format!("{value:.2}")
    } else {
        format!("{value:.1}")
    }
}

const INSTRUCTIONS: &str = "instructions";
const RELATIVE: &str = "relative";
const RATIO: &str = "ratio";

/// Every limit with its figure in `results`.
pub fn verdicts(results: &Results) -> Vec<Verdict> {
    let mut all = power(results);
    all.extend(whole_tick(results));
    all.extend(rig(results));
    all.extend(effects(results));
    all.extend(fixed_point(results));
    all.extend(image(results));
    all
}

fn at_most(
    name: impl Into<Cow<'static, str>>,
    unit: &'static str,
    limit: f64,
    figure: Option<f64>,
) -> Verdict {
    Verdict {
        name: name.into(),
        unit,
        side: Side::AtMost,
        limit,
        figure,
    }
}

fn at_least(
    name: impl Into<Cow<'static, str>>,
    unit: &'static str,
    limit: f64,
    figure: Option<f64>,
) -> Verdict {
    Verdict {
        side: Side::AtLeast,
        ..at_most(name, unit, limit, figure)
    }
}

fn power(results: &Results) -> Vec<Verdict> {
    let most = |name| Some(results.count(Core::CortexM4f, name, "call")?.most as f64);
    let error = |name| results.error(name, "|v|^α over itself");
    vec![
        at_most("|v|^α, any α", INSTRUCTIONS, 48.0, most("power/general")),
        at_most(
            "|v|^α, any α: error",
            RELATIVE,
            6e-7,
            error("power/general"),
        ),
        at_most(
            "|v|^α from a table",
            INSTRUCTIONS,
            16.0,
            most("power/table"),
        ),
        at_most(
            "|v|^α from a table: error",
            RELATIVE,
            5e-7,
            error("power/table"),
        ),
        at_most(
            "|v|^α from a table: the table",
            "bytes",
            4096.0,
            results
                .size("power/table", "table")
                .map(|bytes| bytes as f64),
        ),
    ]
}

fn whole_tick(results: &Results) -> Vec<Verdict> {
    let steady = results.count(Core::CortexM4f, "tick/whole", "steady");
    let mean = steady.map(|count| count.mean);
    let most = |moment| Some(results.count(Core::CortexM4f, "tick/whole", moment)?.most as f64);
    let over_mean = |moment| Some(most(moment)? / mean?);
    let block = results.count(Core::CortexM4f, "tick/block", "steady");
    let c = results.count(Core::CortexM4f, "tick/c", "steady");
    let error = |of| results.error("tick/whole", of);
    vec![
        at_most("whole tick", INSTRUCTIONS, 64.0, mean),
        at_most(
            "whole tick: tables",
            "bytes",
            8192.0,
            results
                .size("tick/whole", "tables")
                .map(|bytes| bytes as f64),
        ),
        at_most(
            "whole tick in blocks",
            INSTRUCTIONS,
            50.0,
            block.map(|count| count.mean / BLOCK as f64),
        ),
        at_least(
            "whole tick: C over ours",
            RATIO,
            7.0,
            c.zip(mean).map(|(c, mean)| c.mean / mean),
        ),
        at_most(
            "whole tick: same tick, other data",
            INSTRUCTIONS,
            0.0,
            most("spread"),
        ),
        at_most(
            "cycle end over the mean",
            RATIO,
            1.7,
            over_mean("cycle-end"),
        ),
        at_most("force", RELATIVE, 6e-7, error("force over its peak")),
        at_most("K", RELATIVE, 6e-7, error("K over itself")),
        at_most("ΔW", RELATIVE, 6e-7, error("ΔW over itself")),
        at_most("η", RELATIVE, 6e-7, error("η over itself")),
    ]
}

/// No tick of the rig, with its monitor, may take twice the mean, including those of a ramp and of a cycle's end.
fn rig(results: &Results) -> Vec<Verdict> {
    let count = |moment| results.count(Core::CortexM4f, "rig/tick", moment);
    let mean = count("steady").map(|count| count.mean);
    let over_mean = |moment| Some(count(moment)?.most as f64 / mean?);
    vec![
        at_most(
            "the rig: cycle end over the mean",
            RATIO,
            2.0,
            over_mean("cycle-end"),
        ),
        at_most(
            "the rig: longest steady tick over the mean",
            RATIO,
            2.0,
            over_mean("steady"),
        ),
        at_most(
            "the rig: longest tick of a ramp over the mean",
            RATIO,
            2.0,
            over_mean("ramp"),
        ),
    ]
}

/// The title of an effect's count.
fn title(effect: &Description) -> String {
    let called = effect.name.replace('_', "-");
    match effect.typical.len() / effect.parameters.len() {
        1 => called,
        elements => format!("{called}, {elements} elements"),
    }
}

/// The crate's effects, each with the name of its count and its title.
pub fn counted_effects() -> impl Iterator<Item = (String, String)> {
    DESCRIPTIONS
        .iter()
        .map(|effect| (format!("effects/{}", effect.name), title(effect)))
}

/// Residual tables over the motion alone, and the title of their limit. What one remembers in addition has no limit but the baseline.
const CORRECTIONS: [(&str, &str); 3] = [
    ("correction/without_memory", "correction without memory"),
    ("correction/place", "correction with a finer line"),
    ("correction/sides", "correction with two sides"),
];

/// A light effect is computed in every law that has one of them, so it has a limit. The others have none but the baseline.
fn effects(results: &Results) -> Vec<Verdict> {
    let none = results.count(Core::CortexM4f, "effects/none", "call");
    let more_than_none = |name: &str, called: String, limit: f64| {
        let with = results.count(Core::CortexM4f, name, "call");
        let more = with
            .zip(none)
            .map(|(with, none)| with.most as f64 - none.least as f64);
        at_most(called, INSTRUCTIONS, limit, more)
    };
    let light = DESCRIPTIONS.iter().filter(|each| each.cost == Cost::Light);
    let light =
        light.map(|each| more_than_none(&format!("effects/{}", each.name), title(each), 25.0));
    let corrections =
        CORRECTIONS.map(|(name, called)| more_than_none(name, called.to_owned(), 60.0));
    let all = results.count(Core::CortexM4f, "effects/all_stick_slip_1", "call");
    let all = at_most(
        "every ordinary effect, 1 element",
        INSTRUCTIONS,
        219.0,
        all.map(|count| count.most as f64),
    );
    light.chain(corrections).chain([all]).collect()
}

/// Integers on a core without a floating-point unit.
fn fixed_point(results: &Results) -> Vec<Verdict> {
    let mean = |name| Some(results.count(Core::CortexM0, name, "steady")?.mean);
    let error = |of| results.error("fixed/tick", of);
    vec![
        at_least(
            "Cortex-M0: floats over integers",
            RATIO,
            9.0,
            mean("tick/whole")
                .zip(mean("fixed/tick"))
                .map(|(floats, integers)| floats / integers),
        ),
        at_most("Cortex-M0: K", RELATIVE, 1e-4, error("K over itself")),
        at_most("Cortex-M0: ΔW", RELATIVE, 1e-4, error("ΔW over itself")),
        at_most("Cortex-M0: η", RELATIVE, 1e-4, error("η over itself")),
    ]
}

/// The firmware's images.
fn image(results: &Results) -> Vec<Verdict> {
    let bytes = |name, of, limit, image| {
        let bytes = results.size(image, of).map(|bytes| bytes as f64);
        at_most(name, "bytes", limit, bytes)
    };
    vec![
        bytes(
            "the damper of docs/firmware.md: stack",
            "stack",
            2.0 * 1024.0,
            uses::DAMPER,
        ),
        bytes(
            "firmware: panicking code",
            "panicking code",
            0.0,
            firmware::NAME,
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missed_limit_fails_and_one_that_was_not_measured_does_not() {
        let missed = at_most("this", INSTRUCTIONS, 16.0, Some(16.5));
        let said = missed.failure().unwrap();
        assert_eq!(said, "this: 16.5 instructions, required: at most 16.0");
        assert!(at_least("this", RATIO, 7.0, Some(6.9)).failure().is_some());
        for held in [
            at_most("this", INSTRUCTIONS, 16.0, Some(16.0)),
            at_least("this", RATIO, 7.0, Some(7.0)),
            at_least("this", RATIO, 7.0, None),
        ] {
            assert_eq!(held.failure(), None);
        }
        // NaN meets no limit.
        assert!(
            at_most("this", RATIO, 1.0, Some(f64::NAN))
                .failure()
                .is_some()
        );
    }

    /// A run in which nothing was counted: no limit fails, nothing panics.
    #[test]
    fn without_counts_nothing_is_measured() {
        let verdicts = verdicts(&Results::default());
        assert!(verdicts.len() > 25);
        assert!(verdicts.iter().all(|verdict| verdict.figure.is_none()));
    }
}
