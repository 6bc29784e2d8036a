//! The output of `hil bench`.

use std::borrow::Cow;

use mesh_damper_trials::bench::{BLOCK, Core, Results, Verdict, counted_effects};

use crate::commands::say;

/// Counts shown together.
struct Section {
    core: Core,
    title: &'static str,
    rows: Vec<Row>,
}

/// A count as a line of the table.
struct Row {
    name: Cow<'static, str>,
    moment: &'static str,
    label: Cow<'static, str>,
    /// Number of ticks in a call.
    ticks: usize,
}

fn row(
    name: impl Into<Cow<'static, str>>,
    moment: &'static str,
    label: impl Into<Cow<'static, str>>,
) -> Row {
    Row {
        name: name.into(),
        moment,
        label: label.into(),
        ticks: 1,
    }
}

fn sections() -> [Section; 7] {
    [
        Section {
            core: Core::CortexM4f,
            title: "|v|^α, α 0.15…0.56, v 1e-6…20 mm/s",
            rows: vec![
                row("power/general", "call", "any α"),
                row("power/table", "call", "from a table, c·|v|^α·sgn v"),
                row("power/libm", "call", "libm powf"),
                row("power/micromath", "call", "micromath powf"),
                row("power/c", "call", "C, newlib powf"),
            ],
        },
        Section {
            core: Core::CortexM4f,
            title: "a whole tick: generator, law, cycle",
            rows: vec![
                row("tick/whole", "steady", "steady"),
                row("tick/whole", "spread", "  the same tick with other data"),
                row("tick/whole", "cycle-end", "at a cycle's end"),
                row("tick/whole", "swap", "after a swap of coefficients"),
                row("tick/whole", "ramp", "in a ramp"),
                Row {
                    ticks: BLOCK,
                    ..row("tick/block", "steady", "in blocks of 64")
                },
                row(
                    "tick/parts",
                    "steady",
                    "from the parts that serve any motion",
                ),
                row("tick/parts", "cycle-end", "  at a cycle's end"),
                row("tick/naive", "steady", "Rust on libm"),
                row("tick/naive", "cycle-end", "  at a cycle's end"),
                row("tick/c", "steady", "C on newlib"),
                row("tick/c", "cycle-end", "  at a cycle's end"),
            ],
        },
        Section {
            core: Core::CortexM4f,
            title: "the law with effects",
            rows: effects(),
        },
        Section {
            core: Core::CortexM4f,
            title: "the law with stick-slip, 1 element",
            rows: vec![
                row("one_effect/static", "call", "effects named in the type"),
                row("one_effect/pack", "call", "read from a pack"),
            ],
        },
        Section {
            core: Core::CortexM4f,
            title: "the law with a residual table",
            rows: vec![
                row("correction/without_memory", "call", "of the motion alone"),
                row("correction/place", "call", "with a finer line"),
                row("correction/sides", "call", "with two sides"),
                row("correction/temperature", "call", "over temperature"),
                row("correction/frequency", "call", "over the frequency"),
                row("correction/slip", "call", "remembering a slip"),
                row("correction/lag", "call", "a lag"),
                row("correction/travel", "call", "travel"),
                row("correction/largest", "call", "the largest displacement"),
                row("correction/age", "call", "its age"),
            ],
        },
        Section {
            core: Core::CortexM4f,
            title: "the rig",
            rows: vec![
                row("rig/tick", "steady", "one tick, bus replies from memory"),
                row("rig/tick", "cycle-end", "  at a cycle's end"),
                row("rig/unmonitored", "steady", "  without its monitor"),
                row("crossing/update", "steady", "cycle of a measured motion"),
                row("crossing/update", "cycle-end", "  at its end"),
                row("pack/slice", "call", "slice of a pack's check"),
            ],
        },
        Section {
            core: Core::CortexM0,
            title: "a whole tick without floating-point unit",
            rows: vec![
                row("fixed/tick", "steady", "in integers"),
                row("fixed/tick", "cycle-end", "  at a cycle's end"),
                row("fixed/tick", "ramp", "  in a ramp"),
                row("fixed/cycle", "call", "  a cycle's results in their units"),
                row("tick/whole", "steady", "the tick above, floats in software"),
                row("tick/whole", "cycle-end", "  at a cycle's end"),
                row("tick/naive", "steady", "on libm, floats in software"),
            ],
        },
    ]
}

/// The law with each effect of the crate, then with several effects.
fn effects() -> Vec<Row> {
    let mut rows = vec![
        row("effects/none", "call", "none"),
        row("effects/stick_slip_1", "call", "stick-slip, 1 element"),
    ];
    rows.extend(counted_effects().map(|(name, called)| row(name, "call", called)));
    rows.extend([
        row(
            "effects/all_stick_slip_1",
            "call",
            "the ordinary ones, 1 element",
        ),
        row("effects/all", "call", "the ordinary ones, 6 elements"),
        row("effects/all_with_stages", "call", "all, 6 elements"),
    ]);
    rows
}

/// Prints every count with its errors, the sizes, the rates and the limits.
pub fn print(results: &Results) {
    for Section { core, title, rows } in sections() {
        say(&format!(
            "{title:40} {:>9} {:>8} {:>8}",
            "mean", "least", "most"
        ));
        for row in rows {
            let Row {
                name,
                moment,
                label,
                ticks,
            } = row;
            let Some(count) = results.count(core, &name, moment) else {
                continue;
            };
            let ticks = ticks as f64;
            let errors: String = results
                .errors
                .iter()
                .filter(|error| error.name == name && matches!(moment, "call" | "steady"))
                // Errors are shown on the core for which the function is made.
                .filter(|_| core == Core::CortexM4f || name.starts_with("fixed/"))
                .map(|error| format!("  {} {:.1e}", error.of, error.error))
                .collect();
            say(&format!(
                "  {label:38} {:9.1} {:8.1} {:8.1}{errors}",
                count.mean / ticks,
                count.least as f64 / ticks,
                count.most as f64 / ticks
            ));
        }
    }
    say("Instructions, exact, of a Cortex-M4F and a Cortex-M0; the largest errors against f64.");
    for size in &results.sizes {
        say(&format!(
            "  {}, {}: {} bytes",
            size.name, size.of, size.bytes
        ));
    }
    for rate in &results.rates {
        say(&format!(
            "  {}: {:.0} a second, {:.0} times real time",
            rate.name, rate.per_second, rate.times_real_time
        ));
    }
    say(&format!("{:40} {:>10}   required", "limits", "figure"));
    for verdict in &results.limits {
        print_verdict(verdict);
    }
}

fn print_verdict(verdict: &Verdict) {
    let held = match (verdict.figure, verdict.holds()) {
        (None, _) => "not measured",
        (_, true) => "held",
        (_, false) => "NOT HELD",
    };
    say(&format!(
        "  {:38} {:>10}   {} {}: {held}",
        verdict.name,
        verdict.figure(),
        verdict.asked_for(),
        verdict.unit
    ));
}
