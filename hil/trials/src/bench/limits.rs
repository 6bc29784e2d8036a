//! The requirements on the image.

use std::borrow::Cow;

use mesh_damper::effects::DESCRIPTIONS;
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
    /// The reason why a figure beyond the limit does not fail the run; null if there is none.
    pub excuse: Option<&'static str>,
}

impl Verdict {
    /// Whether the figure meets the limit; an unmeasured figure counts as meeting it.
    pub fn holds(&self) -> bool {
        self.figure.is_none_or(|figure| match self.side {
            Side::AtMost => figure <= self.limit,
            Side::AtLeast => figure >= self.limit,
        })
    }

    /// The line about a missed limit, if it counts against the run.
    pub fn failure(&self) -> Option<String> {
        let figure = self.figure.filter(|_| !self.holds())?;
        if self.excuse.is_some() {
            return None;
        }
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

/// Limits that are missed, with the reason. A limit that is met has to leave this list.
const NOT_REACHED: &[(&str, &str)] = &[
    (
        "longest steady tick over the mean",
        "a tick in 64 ends a sector of the cycle and does a step of its results in 95 to 131; the first of a block takes 179",
    ),
    (
        "tick after a swap over the mean",
        "256 ticks fill the row of the table that they need and one more, 89 more than other ticks",
    ),
    (
        "stick-slip, 1 element",
        "16 for the element, a call, the step since the tick before, and whether there is one",
    ),
    (
        "stick-slip, 6 elements",
        "16 to the element: three loads, a store, an addition, a multiply-add, eight for the slip limit and two for the loop",
    ),
    (
        "drift",
        "an exponential: 14 to split its exponent off, 10 for the polynomial; four for the law's forces",
    ),
    (
        "every effect, 6 elements",
        "115 of it are the six elements of stick-slip",
    ),
    (
        "stop, 2 elements",
        "nine to the contact, eleven to tell which of the rare effects there are",
    ),
    (
        "bouc-wen",
        "two powers of 60 with a quotient each, and two more quotients for the parts that a step takes",
    ),
    (
        "hardening-friction",
        "up to five powers of 60 with a quotient each, and up to three exponentials, on a tick that passes 0",
    ),
    (
        "yielding",
        "two stages of a step, each a saturating force solved by two steps of Halley, with an exponential and three quotients a step",
    ),
    (
        "force-filter",
        "about 40 for the longer way of a tick through stages, and a rotation of two numbers by four coefficients",
    ),
    (
        "control-input",
        "a yielding branch, and two quotients for how strong the input makes it",
    ),
    (
        "directional",
        "eleven to tell which of the rare effects there are; among the light ones it would be a part of every law that has one of them",
    ),
    (
        "backlash",
        "eleven to tell which of the rare effects there are, a call, two limits of either sign and the step since the tick before",
    ),
    (
        "degradation",
        "eleven to tell which of the rare effects there are, a call and two quotients of 14",
    ),
    (
        "weakening",
        "on a tick that slides three quotients of 14 and a compensated sum; else that of a slider",
    ),
    (
        "periodic",
        "a sine of 20 from a phase of 64 bits, eleven to tell which of the rare effects there are",
    ),
    (
        "gap",
        "about 40 for the longer way of a tick through stages",
    ),
    (
        "compliance",
        "the law and its slope at six velocities, 100 each",
    ),
    (
        "delay",
        "about 40 for the longer way of a tick through stages, the motion a part of a tick before, and the ring of forces",
    ),
    (
        "correction that remembers a slip",
        "seven for the slip, 29 for the four cells and what lies between, the rest to come to it with what it remembers",
    ),
    (
        "correction that remembers a lag",
        "nine for the average and its place, 29 for the four cells and what lies between, the rest to come to it with what it remembers",
    ),
    (
        "correction that remembers travel",
        "15 for the average and its place, 29 for the four cells and what lies between, the rest to come to it with what it remembers",
    ),
    (
        "correction that remembers the largest displacement",
        "12 for the largest and its place, 29 for the four cells and what lies between, the rest to come to it with what it remembers",
    ),
    (
        "correction that remembers its age",
        "15 for the octave and its place, 29 for the four cells and what lies between, the rest to come to it with what it remembers",
    ),
    (
        "correction over temperature",
        "nine for the reading and its place, 29 for the four cells and what lies between, the rest to come to it with what it remembers",
    ),
    (
        "correction over the frequency",
        "29 for the part of a cycle since the tick before, its average, the octave and its place, 29 for the four cells and what lies between, the rest to come to it with what it remembers",
    ),
    (
        "static law, stick-slip and cycles: flash",
        "5.0 KiB are code; the sine's table, by which a cycle's harmonics are summed, takes 2.6 KiB",
    ),
    (
        "firmware: flash",
        "nine effects more take 8.5 KiB: 2 KiB the way through stages, 1.5 KiB to read and check them, the rest their own code; \
         the residual table 4 KiB; the monitor of specimen, sensors and actuator 9 KiB; what follows the specimen 3.5 KiB; \
         a streamed motion with its messages 1 KiB; that a law is passive 7.5 KiB; the clock, read-back and an external trip 2.75 KiB; \
         settings and packs checked in slices 4.5 KiB; what the monitor finds of attacks 7 KiB",
    ),
    (
        "firmware: RAM, tables included",
        "a delay's ring takes 1 KiB, the correction's table 0.6 KiB in each of two laws and in the upload, the monitor 2 KiB, and a law to see whether it is passive 1.9 KiB",
    ),
    (
        "firmware: stack",
        "the monitor's settings, events and looks pass through it: 164 bytes",
    ),
    (
        "the rig's monitor and adaptation, of a steady tick",
        "the difference of two images that are compiled each as a whole: without it a tick of the controller without I/O takes 6 \
         less than the one before it did, with it 8 more, of which control inputs take 6; to tell these takes 17 without it and 25 \
         with it",
    ),
];

/// Every limit with its figure in `results`.
pub fn verdicts(results: &Results) -> Vec<Verdict> {
    let mut all = power(results);
    all.extend(whole_tick(results));
    all.extend(rig(results));
    all.extend(effects(results));
    all.extend(fixed_point(results));
    all.extend(image(results));
    all.extend(rates(results));
    for verdict in &mut all {
        let mut not_reached = NOT_REACHED.iter();
        if let Some((_, reason)) = not_reached.find(|(name, _)| *name == verdict.name) {
            verdict.excuse = Some(reason);
        }
    }
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
        excuse: None,
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
        // The work that a cycle's end leaves to later ticks is no better there.
        at_most(
            "longest steady tick over the mean",
            RATIO,
            1.7,
            over_mean("steady"),
        ),
        at_most(
            "tick after a swap over the mean",
            RATIO,
            2.0,
            over_mean("swap"),
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
    let without = results.count(Core::CortexM4f, "rig/unmonitored", "steady");
    vec![
        at_most(
            "the rig's monitor and adaptation, of a steady tick",
            INSTRUCTIONS,
            40.0,
            mean.zip(without).map(|(mean, without)| mean - without.mean),
        ),
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

/// The crate's effects, each with the name of its count and its title.
pub fn counted_effects() -> impl Iterator<Item = (String, String)> {
    DESCRIPTIONS.iter().map(|effect| {
        let called = effect.name.replace('_', "-");
        let called = match effect.typical.len() / effect.parameters.len() {
            1 => called,
            elements => format!("{called}, {elements} elements"),
        };
        (format!("effects/{}", effect.name), called)
    })
}

/// Corrections, by their variable, and the title of their limit.
const CORRECTIONS: [(&str, &str); 10] = [
    ("correction/without_memory", "correction without memory"),
    ("correction/slip", "correction that remembers a slip"),
    ("correction/lag", "correction that remembers a lag"),
    ("correction/travel", "correction that remembers travel"),
    (
        "correction/largest",
        "correction that remembers the largest displacement",
    ),
    ("correction/age", "correction that remembers its age"),
    ("correction/temperature", "correction over temperature"),
    ("correction/place", "correction with a finer line"),
    ("correction/sides", "correction with two sides"),
    ("correction/frequency", "correction over the frequency"),
];

fn effects(results: &Results) -> Vec<Verdict> {
    let none = results.count(Core::CortexM4f, "effects/none", "call");
    let more_than_none = |limit: f64| {
        move |(name, called): (String, String)| {
            let with = results.count(Core::CortexM4f, &name, "call");
            let more = with
                .zip(none)
                .map(|(with, none)| with.most as f64 - none.least as f64);
            at_most(called, INSTRUCTIONS, limit, more)
        }
    };
    let one = (
        "effects/stick_slip_1".to_owned(),
        "stick-slip, 1 element".to_owned(),
    );
    let each = counted_effects();
    let each = [one].into_iter().chain(each).map(more_than_none(25.0));
    let corrections = CORRECTIONS.map(|(name, called)| (name.to_owned(), called.to_owned()));
    let corrections = corrections.map(more_than_none(60.0));
    let all = [
        ("effects/all_stick_slip_1", "every effect, 1 element"),
        ("effects/all", "every effect, 6 elements"),
    ]
    .map(|(name, effects)| {
        let count = results.count(Core::CortexM4f, name, "call");
        at_most(
            effects,
            INSTRUCTIONS,
            219.0,
            count.map(|count| count.most as f64),
        )
    });
    each.chain(corrections).chain(all).collect()
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

/// The firmware's image.
fn image(results: &Results) -> Vec<Verdict> {
    let bytes = |of| Some(results.size(firmware::NAME, of)? as f64);
    let limit = |name, of, limit| at_most(name, "bytes", limit, bytes(of));
    let of_use = |of_what, of, limit, name: &'static str| {
        let bytes = results.size(of_what, of).map(|bytes| bytes as f64);
        at_most(name, "bytes", limit, bytes)
    };
    vec![
        of_use(
            uses::STATIC_LAW,
            "flash",
            6.0 * 1024.0,
            "static law, stick-slip and cycles: flash",
        ),
        of_use(
            uses::DAMPER,
            "stack",
            2.0 * 1024.0,
            "the damper of docs/firmware.md: stack",
        ),
        limit("firmware: flash", "flash", 24.0 * 1024.0),
        limit("firmware: RAM, tables included", "RAM", 12.0 * 1024.0),
        limit("firmware: stack", "stack", 1024.0),
        limit("firmware: panicking code", "panicking code", 0.0),
    ]
}

/// Figures that depend on the machine are shown and do not count against a run.
const MACHINE: Option<&str> = Some("this machine, at this moment");

/// How fast the rig is driven.
fn rates(results: &Results) -> Vec<Verdict> {
    let limits = [("ticks in process", 5e6), (firmware::ROUND_TRIPS, 2e5)];
    let verdict = |(name, limit)| {
        let mut rates = results.rates.iter();
        let figure = rates.find(|rate| rate.name == name);
        Verdict {
            excuse: MACHINE,
            ..at_least(name, "a second", limit, figure.map(|rate| rate.per_second))
        }
    };
    limits.map(verdict).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missed_limit_fails_unless_it_is_excused_or_was_not_measured() {
        let missed = at_most("this", INSTRUCTIONS, 16.0, Some(16.5));
        let said = missed.failure().unwrap();
        assert_eq!(said, "this: 16.5 instructions, required: at most 16.0");
        assert!(at_least("this", RATIO, 7.0, Some(6.9)).failure().is_some());
        for held in [
            at_most("this", INSTRUCTIONS, 16.0, Some(16.0)),
            at_least("this", RATIO, 7.0, Some(7.0)),
            at_least("this", RATIO, 7.0, None),
            Verdict {
                excuse: MACHINE,
                ..missed
            },
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
        assert!(verdicts.len() > 30);
        assert!(verdicts.iter().all(|verdict| verdict.figure.is_none()));
    }
}
