//! The pages of the families of effects, `docs/effects/NAME.md`, with the picture of each: that every family has both, that the tables
//! have the parameters of the crate, and that the pictures are what the crate computes.
//!
//! `BLESS=1` writes the pictures, the lines below them, and the line of a new page in the book's summary. All else in a page is written by
//! hand.

mod pictures;

use std::path::{Path, PathBuf};

use mesh_damper::effects::description::{Absent, Parameter};
use mesh_damper_model::Family;

/// What the line below a picture begins with.
const BELOW: &str = "In the picture: ";
/// Most bytes of a picture.
const MOST_BYTES: usize = 15_000;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/effects")
}

fn page_of(family: Family) -> String {
    let path = folder().join(format!("{family}.md"));
    std::fs::read_to_string(&path).unwrap_or_else(|_| panic!("no page docs/effects/{family}.md"))
}

/// Name, unit and range of the rows of a page's tables of parameters: those of five cells, the second of which is a name in code.
fn parameter_rows(page: &str) -> Vec<[String; 3]> {
    let rows = page.lines().filter(|line| line.starts_with('|'));
    let cells = rows.map(|row| -> Vec<&str> {
        let row = row.trim_matches('|').split('|');
        row.map(str::trim).collect()
    });
    cells
        .filter(|cells| cells.len() == 5 && cells[1].starts_with('`'))
        .map(|cells| [1, 3, 4].map(|at| cells[at].to_owned()))
        .collect()
}

/// A unit as pages have it.
fn unit(unit: &str) -> String {
    match unit {
        "1" => "–".to_owned(),
        unit => unit
            .replace('*', "·")
            .replace("^2", "²")
            .replace("^3", "³")
            .replace("^5", "⁵")
            .replace("degC", "°C"),
    }
}

/// A number as pages have it: with an exponent where it is very large or small.
fn number(value: f64) -> String {
    let written = match value.abs() {
        size if size >= 1e6 || size > 0.0 && size < 1e-3 => format!("{value:e}"),
        _ => value.to_string(),
    };
    written.replace('-', "−")
}

/// The range of a parameter, and the value that it has where a file leaves it out.
fn range(parameter: &Parameter, all: &[Parameter]) -> String {
    let [low, high] = parameter.range.map(number);
    match parameter.absent {
        Absent::Refused => format!("{low} … {high}"),
        Absent::Is(value) => format!("{low} … {high}; {} if absent", number(value)),
        Absent::As(place) => format!("{low} … {high}; `{}` if absent", all[place].name),
    }
}

/// `values` with their names and units, element by element.
fn named(values: &[f64], parameters: &[Parameter]) -> String {
    let each = values.iter().zip(parameters.iter().cycle()).enumerate();
    let each = each.map(|(place, (value, parameter))| {
        let suffix = match place / parameters.len() + 1 {
            1 => String::new(),
            element => format!("_{element}"),
        };
        let unit = match unit(parameter.unit) {
            none if none == "–" => String::new(),
            unit => format!(" {unit}"),
        };
        format!("`{}{suffix}` {}{unit}", parameter.name, number(*value))
    });
    each.collect::<Vec<_>>().join(", ")
}

#[test]
fn every_family_has_a_page_with_its_parameters() {
    for family in Family::all() {
        let page = page_of(family);
        assert!(page.starts_with("# "), "{family}: no heading");
        let expected: Vec<[String; 3]> = family
            .effects()
            .flat_map(|effect| {
                let of = |one: &Parameter| {
                    let range = range(one, effect.parameters);
                    [format!("`{}`", one.name), unit(one.unit), range]
                };
                effect.parameters.iter().map(of)
            })
            .collect();
        assert_eq!(parameter_rows(&page), expected, "docs/effects/{family}.md");
        // The example of the option names what the tables name.
        let example = page.split_once(&format!("--effect {family}:"));
        let Some((_, example)) = example else {
            continue;
        };
        let example = example.split_whitespace().next().unwrap_or_default();
        for given in example.split(',') {
            let name = format!("`{}`", given.split('=').next().unwrap_or_default());
            assert!(page.contains(&name), "docs/effects/{family}.md: {name}");
        }
    }
}

/// A page that is in no list is read by nobody.
#[test]
fn every_page_is_in_the_books_summary_and_in_the_overview() {
    let docs = folder().join("..");
    let [mut summary, overview] = ["SUMMARY.md", "effects.md"]
        .map(|name| std::fs::read_to_string(docs.join(name)).expect("the page"));
    let blesses = std::env::var_os("BLESS").is_some();
    for family in Family::all() {
        let link = format!("(effects/{family}.md)");
        if blesses && !summary.contains(&link) {
            // After the pages of the other families.
            let last = summary.rfind("](effects/").expect("other families");
            let end = last + summary[last..].find('\n').expect("a line") + 1;
            summary.insert_str(end, &format!("  - [`{family}`]{link}\n"));
            std::fs::write(docs.join("SUMMARY.md"), &summary).expect("written");
        }
        assert!(summary.contains(&link), "docs/SUMMARY.md: {link}");
        assert!(overview.contains(&link), "docs/effects.md: {link}");
    }
    for entry in std::fs::read_dir(folder()).expect("the folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().and_then(|stem| stem.to_str());
        let known = name.is_some_and(|name| Family::named(name).is_some());
        assert!(known, "{}: no family of effects", path.display());
    }
}

#[test]
fn every_picture_is_what_the_crate_computes() {
    for family in Family::all() {
        let drawn = pictures::of(family);
        let svg = drawn.picture.alone() + "\n";
        assert!(
            svg.len() < MOST_BYTES,
            "{family}.svg has {} bytes",
            svg.len()
        );
        let several = drawn.effects.len() > 1;
        let values = drawn.effects.iter().map(|(form, effect)| {
            let values = named(form.parameters, effect.parameters);
            match several {
                true => format!("`{}` with {values}", form.name),
                false => values,
            }
        });
        let below = format!("{BELOW}{}.", values.collect::<Vec<_>>().join("; "));
        let shown = format!("![{}]({family}.svg)", drawn.picture.title);
        let path = folder().join(format!("{family}.svg"));
        let page = page_of(family);
        if std::env::var_os("BLESS").is_some() {
            let lines = page.lines().map(|line| match line {
                _ if line.starts_with(BELOW) => &below[..],
                _ if line.starts_with("![") => &shown[..],
                _ => line,
            });
            let page = lines.collect::<Vec<_>>().join("\n") + "\n";
            std::fs::write(folder().join(format!("{family}.md")), page).expect("written");
            std::fs::write(&path, svg).expect("written");
            continue;
        }
        let said = "is not as the crate computes it: run with BLESS=1";
        let stored = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(stored == svg, "docs/effects/{family}.svg {said}");
        for line in [shown, below] {
            assert!(page.contains(&line), "docs/effects/{family}.md: {line}");
        }
    }
}
