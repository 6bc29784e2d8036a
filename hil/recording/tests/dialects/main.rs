//! One recording in the dialects of other programs and countries: each is read correctly, asked about or refused, and none is
//! misread.

mod ambiguous;
mod combinations;
mod corpus;
mod encodings;
mod headers;
mod languages;
mod notation;
mod other;
mod page;
mod programs;
mod refused;
mod separators;
mod times;
mod units;
mod words;

use corpus::{Dialect, Outcome};

/// All dialects, grouped by family.
fn all() -> Vec<Dialect> {
    [
        separators::dialects(),
        notation::dialects(),
        encodings::dialects(),
        headers::dialects(),
        units::dialects(),
        languages::dialects(),
        times::dialects(),
        programs::dialects(),
        ambiguous::dialects(),
        words::dialects(),
        refused::dialects(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

#[test]
fn every_dialect_is_read_asked_about_or_refused_as_it_should_be() {
    let dialects = all();
    let mut wrong = Vec::new();
    for dialect in &dialects {
        let result = dialect.check();
        println!(
            "{:10} {:60} {}",
            dialect.family,
            dialect.name,
            dialect.outcome.word()
        );
        wrong.extend(result.err().map(|why| format!("{}: {why}", dialect.name)));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let count = |is_it: &dyn Fn(&Outcome) -> bool| {
        dialects
            .iter()
            .filter(|dialect| is_it(&dialect.outcome))
            .count()
    };
    let read = count(&|outcome| matches!(outcome, Outcome::Read(_)));
    let asked = count(&|outcome| matches!(outcome, Outcome::Asked(_)));
    let refused = count(&|outcome| matches!(outcome, Outcome::Refused(_)));
    let misread: Vec<String> = (dialects.iter())
        .filter_map(|dialect| Some(format!("{}: {}", dialect.name, dialect.misread()?)))
        .collect();
    assert!(misread.is_empty(), "{}", misread.join("\n"));
    println!(
        "{} dialects: {read} read, {asked} asked about, {refused} refused, {} misread",
        dialects.len(),
        misread.len()
    );
    assert!(dialects.len() >= 60);
}

#[test]
fn names_of_dialects_are_distinct() {
    let mut names: Vec<&str> = all().iter().map(|dialect| dialect.name).collect();
    names.sort_unstable();
    let count = names.len();
    names.dedup();
    assert_eq!(names.len(), count);
}
