//! The numbers as a page.

use std::fmt::Write as _;

use mesh_damper_recording::numbers::Mark;
use serde_json::Value;

use super::cost::{Cost, Costs, Score};
use super::{Number, numbers};

/// The text before the tables. Its links are within `docs/`.
const HEAD: &str = "# The numbers that decide

This page lists the numbers that decide how `hil` reads a recording and what a trace finds, such as thresholds, limits and counts.
Use it to look up why a decision was made, or to find the number that you want to change.
[How tracing decides](deciding.md) explains the decisions in order; the [glossary](glossary.md) explains the words.

## How to read the tables

The heading of a table and the name of a number are its path, such as `identify.select.beam`.
Sections that begin with `recording` are about reading a recording, those with `identify` about fitting and tracing.

| column | content |
|---|---|
| number | the name |
| decides | what the number decides, with its unit if it has one |
| is | the value, or several values separated by commas |
| from | where the value comes from, see below |
| halved, doubled | the change of the blind trial with half and with twice the number; empty if it was not measured |

A value comes from one of three sources:

- `derived`: it follows from something else, which the text states.
- `convention`: another value would do as well; the text gives the reason for this one.
- `tuned`: it was chosen for its results on the data that the text names.
  For most numbers that is the [blind trial](blind-trial.md).
  \"The recordings of others\" are the [recordings from outside the project](errors.md#recordings-from-outside-the-project).

## How to change a number

To try another value without a build, write it into a JSON file, such as `{\"identify\": {\"select\": {\"beam\": 4}}}`.
Give the file to a command of `hil` with `--policy FILE`.
The help does not list this option.

To change the default, edit the `numbers!` block in the source file that uses the number.
`hil study numbers` writes this page from these blocks, so don't edit the page.
\"Adding a number\" in `CONTRIBUTING.md` lists the steps.
";

/// All numbers in Markdown, with the measured scores of the tuned ones.
pub fn table(costs: &Costs) -> String {
    let mut page = String::from(HEAD);
    if let Some(default) = costs.default {
        let _ = writeln!(
            page,
            "\n## Halved and doubled\n\n\
            The columns `halved` and `doubled` compare two blind trials: with half or twice the number, and with this page's numbers.\n\
            Both use the seeds {} to {}.\n\
            The first figure is the change in the number of trials with a correct result, of {}.\n\
            The second figure is the change in the number of unmodelled effects that are predicted well: to 1.5 times the noise, or to \
            a tenth of the law's error.\n\
            A dash means that the number cannot be halved or doubled, or that the trial failed.\n\
            With this page's numbers, {} trials have a correct result, and {} unmodelled effects are predicted well.",
            costs.seeds.start,
            costs.seeds.end.saturating_sub(1),
            default.of,
            default.right,
            default.augmented
        );
    }
    let mut part = String::new();
    for number in numbers() {
        let path = number.path.rsplit_once('.').map_or("", |(path, _)| path);
        if path != part {
            path.clone_into(&mut part);
            let _ = write!(
                page,
                "\n## {part}\n\n| number | decides | is | from | halved | doubled |\n|---|---|---|---|---|---|\n"
            );
        }
        page.push_str(&row(&number, costs));
    }
    page
}

fn row(number: &Number, costs: &Costs) -> String {
    let cost = costs.costs.get(&number.path);
    let field = number.field;
    let from = match field.mark {
        Mark::Derived => "derived",
        Mark::Convention => "convention",
        Mark::Tuned => "tuned",
    };
    let lost = |score: fn(&Cost) -> Option<Score>| match (costs.default, cost) {
        (Some(default), Some(cost)) => {
            score(cost).map_or("–".to_owned(), |score| difference(score, default))
        }
        _ => String::new(),
    };
    format!(
        "| `{}` | {} | {} | {from}: {} | {} | {} |\n",
        field.name,
        // A bar would end the cell.
        field.about.trim().replace('|', "\\|"),
        in_words(&number.default),
        field.reason.replace('|', "\\|"),
        lost(|cost| cost.halved),
        lost(|cost| cost.doubled),
    )
}

/// `-3, +1`
fn difference(score: Score, default: Score) -> String {
    let signed = |now: usize, before: usize| match now as i64 - before as i64 {
        0 => "0".to_owned(),
        difference => format!("{difference:+}"),
    };
    format!(
        "{}, {}",
        signed(score.right, default.right),
        signed(score.augmented, default.augmented)
    )
}

fn in_words(value: &Value) -> String {
    match value {
        Value::Array(values) => {
            let values: Vec<String> = values.iter().map(in_words).collect();
            values.join(", ")
        }
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The measured columns may differ.
    #[test]
    fn the_page_in_the_tree_has_every_number_as_it_is() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/numbers.md");
        let page = std::fs::read_to_string(page).unwrap();
        let unmeasured = Costs {
            seeds: 0..0,
            default: None,
            costs: [].into(),
        };
        let written = table(&unmeasured);
        let rows = |page: &str| page.lines().filter(|line| line.starts_with("| `")).count();
        assert_eq!(
            rows(&page),
            rows(&written),
            "docs/numbers.md has rows of numbers that are gone"
        );
        for row in written.lines() {
            let row = row.strip_suffix(" |  |  |").unwrap_or(row);
            assert!(
                page.contains(row),
                "docs/numbers.md lacks {row}: write it with hil study numbers"
            );
        }
    }

    #[test]
    fn a_row_says_what_is_lost() {
        let score = |right, augmented| Score {
            right,
            of: 40,
            augmented,
        };
        let path = "identify.select.beam".to_owned();
        let cost = Cost {
            halved: Some(score(27, 9)),
            doubled: None,
        };
        let page = table(&Costs {
            seeds: 0..60,
            default: Some(score(30, 8)),
            costs: [(path, cost)].into(),
        });
        let row = page.lines().find(|line| line.starts_with("| `beam` |"));
        let row = row.unwrap();
        assert!(
            row.ends_with("| 3 | tuned: the blind trial | -3, +1 | – |"),
            "{row}"
        );
        assert!(page.contains("seeds 0 to 59"));
    }
}
