//! What to do after a trace.

use maud::html;
use mesh_damper_identify::trace::conclusion::Conclusion;
use mesh_damper_identify::trace::result::TraceResult;

use super::html::Section;
use super::text;

/// The steps that follow from the result, the first ones about its reliability and the last ones about the use of the model.
pub fn steps(result: &TraceResult) -> Section {
    let conclusion = result.conclusion();
    let is_worse = text::is_worse(result);
    let varied = match &result.remainder {
        Some(left) => &left.depends_on,
        None => &result.depends_on,
    };
    // A separating test for the rest says what to record.
    let lacks_more = result.separating_test.is_none()
        && (result.remainder.is_some() || conclusion == Conclusion::Unlisted);
    let body = html! {
        ul {
            @if !result.warnings.is_empty() {
                li { "Read the list “About the data” in part 1. A fault of a sensor or a wrong unit can look like an effect." }
            }
            @if let Some(test) = &result.separating_test {
                li {
                    @if text::is_or_zero(result) { "What would decide: " (test) "." }
                    @else {
                        "Run the test that would decide: " (test) " Then trace its recording together with these: "
                        code { "hil trace RECORDING… NEW" } "."
                    }
                }
            }
            @match conclusion {
                Conclusion::Contradicted => {
                    li {
                        "Check that the held-out data is of the same specimen. If it is, fit recordings with more amplitudes and frequencies \
                         near those held out. Do not use the law there before."
                    }
                }
                Conclusion::Hidden => {
                    li { "Record again at a higher rate, or with less noise of the displacement, and trace the new recording." }
                }
                Conclusion::Found | Conclusion::NothingMissing => {
                    li {
                        "Check the result on a recording that is not in part 1: "
                        code { "hil trace RECORDING… --held-out OTHER" } "."
                    }
                }
                Conclusion::Ambiguous | Conclusion::Unlisted => {}
            }
            @if lacks_more {
                li {
                    "Find what the residual depends on"
                    @if !varied.is_empty() { " (here: " (text::listed(varied)) ")" }
                    ": record tests in which only one quantity changes, such as the frequency, the preload or the temperature, and trace them \
                     together. Until then, the error of the model is "
                    (text::percent(result.augmented.nrmse_held_out)) " on held-out data, and the noise "
                    (text::noise(result)) ": decide whether that suffices for your use."
                }
            }
            @if result.rejected.is_some() || is_worse {
                li { "Fit recordings under conditions like those that were held out, with more amplitudes and frequencies near them." }
            }
            @if !is_worse {
                li {
                    "Predict the force for another motion: "
                    code { "hil predict --model model.json --out predicted.csv MOTION.csv" }
                    ". Give the same --channel and --unit options as for the trace."
                }
                li {
                    "Put the law into firmware: "
                    // A Rust module cannot hold a residual table.
                    @if result.correction.is_some() {
                        code { "hil export --model model.json --format c --tick-rate HZ --out law.c" }
                    } @else {
                        code { "hil export --model model.json --format rust --tick-rate HZ --out law.rs" }
                    }
                    ", with the firmware's own rate for HZ, such as 10000. It holds within the range of the motion that was fitted; outside it the force is extrapolated."
                }
            }
        }
    };
    Section::new("What to do next", body)
}
