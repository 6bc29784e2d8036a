//! The statements of the README and of `docs/errors.md` are true.

use std::path::Path;

use mesh_damper_demo::{demo, loop_error};

const README: &str = include_str!("../../../../../README.md");
const ERRORS: &str = include_str!("../../../../../docs/errors.md");

/// Tolerance of the figures in %, which have at most three digits: a better fit or another libm may change them by this much.
const PART: f64 = 0.1;

fn cells(row: &str) -> Vec<&str> {
    row.trim_matches('|').split('|').map(str::trim).collect()
}

#[test]
fn the_minimum_rust_version_is_the_packages() {
    let said = format!("Rust {} or later", env!("CARGO_PKG_RUST_VERSION"));
    assert!(README.contains(&said), "{said}");
}

/// The numbers of `text`, without the sentence's own dots and commas. A number within a name or a path does not count.
fn numbers(text: &str) -> Vec<&str> {
    text.split(|c: char| c.is_whitespace() || "|()[]`".contains(c))
        .map(|word| word.trim_end_matches(['.', ',', ';', ':']))
        .filter(|word| word.starts_with(|c: char| c.is_ascii_digit()))
        .collect()
}

/// Each figure is in a page of `docs/`, where a test or a command checks it, and the README repeats it. Each row of its table of
/// figures links to pages, which must contain every number of the row.
#[test]
fn every_figure_stands_in_a_page_that_it_names() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut rows = 0;
    for row in README
        .lines()
        .filter(|line| line.starts_with('|') && line.contains("](docs/"))
    {
        let mut pages = String::new();
        for link in row.split("](").skip(1) {
            let (path, _) = link.split_once(')').unwrap();
            pages += &std::fs::read_to_string(root.join(path)).unwrap();
        }
        let (given, said) = (numbers(&pages), numbers(row));
        assert!(!said.is_empty(), "{row}");
        for number in said {
            assert!(given.contains(&number), "{number} of {row}");
        }
        rows += 1;
    }
    assert_eq!(rows, 4);
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn every_seed_of_the_table_hides_what_is_said_and_ends_in_the_errors_given() {
    let mut families = Vec::new();
    for row in ERRORS.lines().filter(|line| line.starts_with('|')) {
        let cells = cells(row);
        let Ok(seed) = cells[0].parse::<u64>() else {
            continue;
        };
        let family = cells[1].trim_matches('`');
        let done = demo(seed, &|_| ()).unwrap();
        let result = &done.trace.result;
        let found: Vec<&str> = result.effects.iter().map(|e| &e.family[..]).collect();
        assert_eq!(found, [family], "seed {seed}");
        assert!(done.is_named() && done.is_nearer(), "seed {seed}");
        let errors = [
            result.baseline.nrmse_held_out,
            result.on_target.nrmse_held_out,
            result.noise_floor_nrmse,
            loop_error(&done.before),
            loop_error(&done.after),
        ];
        assert_eq!(cells.len(), 2 + errors.len(), "{row}");
        for (said, error) in cells[2..].iter().zip(errors) {
            let said: f64 = said.parse().unwrap();
            let error = 100.0 * error;
            assert!(
                (said - error).abs() <= PART * error,
                "seed {seed}: {said} % is said, {error:.3} % it is"
            );
        }
        families.push(family);
    }
    families.sort_unstable();
    families.dedup();
    assert_eq!(families.len(), 9, "{families:?}");
}
