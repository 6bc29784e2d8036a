//! The numbers as a page.

use std::fmt::Write as _;

use mesh_damper_recording::policy::Mark;
use serde_json::Value;

use super::cost::{Cost, Costs, Score};
use super::{Number, numbers};

/// All numbers in Markdown, with the costs of the tuned ones.
pub fn table(costs: &Costs) -> String {
    let mut page = String::from(
        "# The numbers that decide\n\n\
        Written by `hil study numbers`; the numbers stand beside the code that they are for, see CONTRIBUTING.md.\n\n",
    );
    if let Some(default) = costs.default {
        let _ = writeln!(
            page,
            "Halved and doubled: what the blind trial of seeds {} to {} gains or loses, in trials that are called what they are, of {}, \
             and after the comma in unlisted effects that are mended. As the numbers are, it has {} and {}.\n",
            costs.seeds.start,
            costs.seeds.end.saturating_sub(1),
            default.of,
            default.right,
            default.mended
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
        signed(score.mended, default.mended)
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

    /// The measured values come from the page itself.
    #[test]
    fn the_page_in_the_tree_has_every_number_as_it_is() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/numbers.md");
        let page = std::fs::read_to_string(page).unwrap();
        let unmeasured = Costs {
            seeds: 0..0,
            default: None,
            costs: [].into(),
        };
        for row in table(&unmeasured).lines() {
            let row = row.strip_suffix(" |  |  |").unwrap_or(row);
            assert!(
                page.contains(row),
                "docs/numbers.md lacks {row}: write it with hil study numbers"
            );
        }
    }

    #[test]
    fn a_row_says_what_is_lost() {
        let score = |right, mended| Score {
            right,
            of: 40,
            mended,
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
