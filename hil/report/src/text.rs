//! Numbers and verdicts in plain words.

use mesh_damper_identify::trace::conclusion::Conclusion;
use mesh_damper_identify::trace::result::{Baseline, Remainder, TraceResult};
use mesh_damper_identify::trace::rule::Rule;
use mesh_damper_model::Family;

/// `value` to three significant digits, with an exponent only if it is very large or very small.
pub fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !value.is_finite() {
        return "—".into();
    }
    let magnitude = value.abs().log10().floor();
    if !(-4.0..6.0).contains(&magnitude) {
        return format!("{value:.2e}").replace('-', "−");
    }
    let decimals = (2.0 - magnitude).max(0.0) as usize;
    format!("{value:.decimals$}").replace('-', "−")
}

/// A value that was set rather than measured: without trailing zeros, and rounded to two digits if that changes it by less than
/// half a per cent.
pub fn nominal(value: f64) -> String {
    let two_digits: f64 = format!("{value:.1e}").parse().unwrap_or(value);
    let close = (two_digits - value).abs() < 5e-3 * value.abs();
    let text = number(if close { two_digits } else { value });
    if text.contains('e') || !text.contains('.') {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The ends of an interval and its value, with as many decimals as distinguish them.
pub fn interval(low: f64, value: f64, high: f64) -> [String; 3] {
    let width = high - low;
    let decimals = 1.0 - width.log10().floor();
    let largest = low.abs().max(high.abs());
    if !(0.0..=9.0).contains(&decimals) || !(1e-4..1e6).contains(&largest) {
        return [low, value, high].map(number);
    }
    let decimals = decimals as usize;
    [low, value, high].map(|value| format!("{value:.decimals$}").replace('-', "−"))
}

/// An NRMSE as a percentage.
pub fn percent(fraction: f64) -> String {
    if fraction.abs() < ROUNDING {
        "0 %".into()
    } else if fraction.is_finite() {
        format!("{} %", number(100.0 * fraction))
    } else {
        "—".into()
    }
}

/// The noise of the recordings over the RMS of the force.
pub fn noise(result: &TraceResult) -> String {
    let level = percent(result.noise_floor_nrmse);
    match result.noise_known {
        true => level,
        false => format!("at most {level}"),
    }
}

/// A smaller fraction is the rounding of a computation. Convention: the rounding of f64 is 1e-16.
const ROUNDING: f64 = 1e-12;

/// A unit in the notation for readers: kN·s/mm, kN/mm².
pub fn unit(unit: &str) -> String {
    // The name of a pure number is enough.
    if unit == "1" {
        return String::new();
    }
    let mut written = String::new();
    let mut is_raised = false;
    let unit = unit.replace('*', "·").replace("degC", "°C");
    let unit = unit.replace("alpha", "α");
    let mut characters = unit.chars().peekable();
    while let Some(character) = characters.next() {
        // There is no superscript α.
        let is_number = |next: &char| next.is_ascii_digit() || *next == '-';
        match (character, character.to_digit(10)) {
            ('^', _) if characters.peek().is_some_and(is_number) => is_raised = true,
            ('-', _) if is_raised => written.push('⁻'),
            (_, Some(digit)) if is_raised => written.push(RAISED[digit as usize]),
            _ => {
                is_raised = false;
                written.push(character);
            }
        }
    }
    written
}

/// The digits of a power.
const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

/// `stick_slip` as `stick-slip`; several joined by `+` or `, ` stay so.
pub fn name(family: &str) -> String {
    family.replace('_', "-")
}

/// The description of a family within a sentence.
pub fn description(family: &str) -> String {
    let Some(family) = Family::named(family) else {
        return "an unknown family of effects".into();
    };
    let mut characters = family.first().sentence.trim_end_matches('.').chars();
    characters.next().map_or_else(String::new, |first| {
        first.to_lowercase().chain(characters).collect()
    })
}

/// Whether the only effect is one that another zero of the displacement would explain as well.
pub fn is_or_zero(result: &TraceResult) -> bool {
    matches!(&result.effects[..], [one] if one.rivals.iter().any(|rival| rival == "zero"))
}

/// The verdict as a heading and a sentence, with the facts that a reader needs before using the model.
pub fn verdict(result: &TraceResult) -> (String, String) {
    let (heading, sentence) = concluded(result);
    if let Some(rejected) = &result.rejected {
        return (
            format!("{heading}; the law alone is kept"),
            format!(
                "The law lacks something. The effects found are not shown to be better on conditions held out in turn, so they were not \
                 adopted: their error on data that was never fitted is {}, that of the law alone is {}.",
                percent(rejected.augmented.nrmse_held_out),
                percent(result.baseline.nrmse_held_out)
            ),
        );
    }
    if is_worse(result) {
        return (
            format!("{heading}; worse than the law alone on the held-out data"),
            format!(
                "{sentence} Do not use the model under such conditions: it was not fitted to them."
            ),
        );
    }
    (heading, sentence)
}

/// Whether the effects that were adopted make the error on the held-out data larger.
pub fn is_worse(result: &TraceResult) -> bool {
    result.adopted && result.augmented.nrmse_held_out > WORSE * result.baseline.nrmse_held_out
}

/// A model whose error is larger by this factor is worse. Convention: two per cent are no difference.
const WORSE: f64 = 1.02;

/// The law before anything is added: `mixed damping law`, and the known effects.
pub fn law(baseline: &Baseline) -> String {
    let known: Vec<String> = baseline.known.iter().map(|family| name(family)).collect();
    let law = match &baseline.law[..] {
        "linear" => "linear law",
        "none" if known.is_empty() => "no law",
        "none" => return listed(&known),
        _ => "mixed damping law",
    };
    match &known[..] {
        [] => law.to_owned(),
        known => format!("{law} with {}", listed(known)),
    }
}

/// The same, if no effect that was found is added to it.
pub fn law_alone(baseline: &Baseline) -> String {
    match (&baseline.law[..], baseline.known.is_empty()) {
        ("none", _) | (_, false) => law(baseline),
        _ => format!("{} alone", law(baseline)),
    }
}

/// The verdict as a heading and a sentence.
fn concluded(result: &TraceResult) -> (String, String) {
    let named: Vec<String> = result.effects.iter().map(|e| name(&e.family)).collect();
    let change = format!(
        "The error of the force on data that was never fitted goes from {} to {} of the force's RMS \
         ({} with the embedded f32 law); the noise of the recording is {}.",
        percent(result.baseline.nrmse_held_out),
        percent(result.augmented.nrmse_held_out),
        percent(result.on_target.nrmse_held_out),
        noise(result),
    );
    match result.conclusion() {
        Conclusion::Contradicted => (
            "Not decided: the held-out data contradict the law".into(),
            format!(
                "The {} explains the fitted data, but its error on data that was never fitted is {} of the force's RMS; the noise of the \
                 recording is {}. An effect may be missing that the fitted data does not show, or the held-out data is of another specimen.",
                law(&result.baseline),
                percent(result.baseline.nrmse_held_out),
                noise(result)
            ),
        ),
        Conclusion::Hidden => (
            "Not decided: the recording can hide an effect".into(),
            format!(
                "The error of the {} on data that was never fitted is {} of the force's RMS, and the noise of the recording is {}. The \
                 uncertainty of the estimated velocity can explain all of the difference. Record at a higher rate, or with less noise \
                 of the displacement.",
                law(&result.baseline),
                percent(result.baseline.nrmse_held_out),
                noise(result)
            ),
        ),
        Conclusion::NothingMissing => (
            "Nothing is missing".into(),
            format!(
                "The {} needs no further effect: its error on data that was never fitted is {} of the force's RMS; the noise of \
                 the recording is {}.",
                law(&result.baseline),
                percent(result.baseline.nrmse_held_out),
                noise(result)
            ),
        ),
        Conclusion::Found => {
            let what: Vec<String> = result
                .effects
                .iter()
                .map(|e| format!("{} is {}", name(&e.family), description(&e.family)))
                .collect();
            let what = capitalised(&what.join("; "));
            match residual(result) {
                None => (
                    format!("Found: {}", named.join(" and ")),
                    format!("{what}. {change}"),
                ),
                Some(residual) => (
                    format!("Found: {}; a residual remains", named.join(" and ")),
                    format!("{what}. Confirmed on every condition held out in turn. {residual}. {change}"),
                ),
            }
        }
        Conclusion::Ambiguous if is_or_zero(result) => (
            format!("Ambiguous: {} or another zero of the displacement", named[0]),
            format!("The recordings cannot tell these apart. {change}"),
        ),
        Conclusion::Ambiguous if named.len() == 1 => (
            format!("Ambiguous: {}", named[0]),
            format!("The recordings do not bound one of its parameters. {change}"),
        ),
        Conclusion::Ambiguous => (
            format!("Ambiguous: {}", named.join(" or ")),
            match residual(result) {
                None => format!("The recordings cannot tell these apart. {change}"),
                Some(residual) => format!(
                    "The first helps on every condition held out in turn, and each of the others does as well in its place: the recordings \
                     cannot tell which it is. {residual}. {change}"
                ),
            },
        ),
        Conclusion::Unlisted if result.correction.is_some() => (
            "Unmodelled: no family of effects explains the residual".into(),
            format!(
                "The law lacks something that no family of effects explains. {} {change}",
                correction(&named, &result.depends_on)
            ),
        ),
        Conclusion::Unlisted if result.effects.is_empty() => (
            "Unmodelled: no family of effects explains the residual".into(),
            "The law lacks something, and no family of effects explains any of it. Nothing was added.".into(),
        ),
        Conclusion::Unlisted if result.effects_rejected_by == Some(Rule::SaysLess) => (
            "Unmodelled: no family of effects explains the residual".into(),
            format!(
                "The nearest effects, {}, explain the fitted data but not the held-out data. They are in the model. {change}",
                named.join(" and ")
            ),
        ),
        Conclusion::Unlisted => (
            "Unmodelled: no family of effects explains the residual".into(),
            format!(
                "No family of effects explains most of the residual. The nearest, {}, was added. {change}",
                named.join(" and ")
            ),
        ),
    }
}

/// The description of a table fitted where named effects do not explain everything.
fn correction(named: &[String], depends_on: &[String]) -> String {
    let beside = match named {
        [] => String::new(),
        _ => format!(" in addition to {}", listed(named)),
    };
    let over = over(depends_on);
    format!("A residual table was fitted to it{beside}{over}.")
}

/// The size of a remainder, and the variables that it depends on.
fn remainder(left: &Remainder) -> String {
    format!(
        "{} of the force's RMS{}, {} times the noise of force and motion{}",
        percent(left.nrmse),
        if left.held_out {
            " on the held-out data"
        } else {
            ""
        },
        number(left.times_noise),
        over(&left.depends_on)
    )
}

/// What a residual is of: the augmented model, or its law and effects without the residual table.
pub fn residual(result: &TraceResult) -> Option<String> {
    let left = result.remainder.as_ref()?;
    let is_of_table = !left.held_out && result.correction.is_some();
    let of = if is_of_table {
        "Without the residual table, the residual"
    } else {
        "The residual"
    };
    Some(format!("{of} is {}", remainder(left)))
}

fn over(depends_on: &[String]) -> String {
    match depends_on {
        [] => String::new(),
        _ => format!("; it depends on {}", listed(depends_on)),
    }
}

/// `a, b and c`.
pub fn listed(words: &[String]) -> String {
    match words {
        [] => "nothing that was recorded".into(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(characters).collect()
    })
}

/// A path without its folders.
pub fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        assert_eq!(number(0.0), "0");
        assert_eq!(number(0.012345), "0.0123");
        assert_eq!(number(-12.345), "−12.3");
        assert_eq!(number(1234.5), "1234");
        assert_eq!(number(1.5e-7), "1.50e−7");
        assert_eq!(number(f64::NAN), "—");
        assert_eq!(nominal(0.05), "0.05");
        assert_eq!(nominal(0.049_93), "0.05");
        assert_eq!(nominal(0.125), "0.125");
        assert_eq!(nominal(200.0), "200");
        assert_eq!(
            interval(0.029_971, 0.029_987, 0.030_003),
            ["0.029971", "0.029987", "0.030003"]
        );
        assert_eq!(interval(-3.0, 20.0, 43.0), ["−3", "20", "43"]);
        assert_eq!(percent(0.00412), "0.412 %");
        assert_eq!(unit("1"), "");
        assert_eq!(unit("1/degC"), "1/°C");
        assert_eq!(unit("kN*s/mm^2"), "kN·s/mm²");
        assert_eq!(unit("kN/mm^5*s"), "kN/mm⁵·s");
        assert_eq!(unit("mm^-10"), "mm⁻¹⁰");
        assert_eq!(unit("kN*(s/mm)^alpha"), "kN·(s/mm)^α");
    }

    #[test]
    fn a_correction_is_told_with_the_effects_that_stay_beside_it() {
        let words = |words: &[&str]| {
            words
                .iter()
                .map(|&word| word.to_owned())
                .collect::<Vec<_>>()
        };
        assert_eq!(
            correction(
                &words(&["stick-slip", "offset"]),
                &words(&["displacement", "velocity"])
            ),
            "A residual table was fitted to it in addition to stick-slip and offset; it depends on displacement and velocity."
        );
        assert_eq!(correction(&[], &[]), "A residual table was fitted to it.");
    }
}
