//! The page of the health causes, which is made from their list.

use std::path::Path;

use mesh_damper::health::{Channel, HealthCause};

/// The tables of the page, made from the list.
fn tables() -> String {
    let of_channels = |is_wanted: bool| {
        let mut rows = String::new();
        for cause in HealthCause::ALL {
            let description = cause.description();
            let name = description.name;
            if cause.channel().is_some() != is_wanted {
                continue;
            }
            let (of, numbers) = match cause.channel() {
                // In the row of the other channel.
                Some(Channel::Force) => continue,
                Some(Channel::Displacement) => (
                    "(channel)",
                    format!("{}, {}", cause.number(), cause.number() + 1),
                ),
                None => ("", cause.number().to_string()),
            };
            let notice = if cause.is_fault() { "" } else { " (a notice)" };
            let meaning = description.meaning.trim_end_matches('.');
            rows += &format!("| `{name}{of}` | {numbers} | {meaning}{notice} |\n");
        }
        rows
    };
    let head = |of: &str| format!("| {of} | number | meaning |\n|---|---|---|\n");
    [
        head("of a channel"),
        of_channels(true),
        "\n".into(),
        head("of specimen, actuator or temperature"),
        of_channels(false),
    ]
    .concat()
}

/// `BLESS=1` writes the tables.
#[test]
fn the_page_lists_every_cause() {
    let (begin, end) = ("<!-- causes, written by BLESS=1 -->\n", "<!-- end -->\n");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/monitor.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once(begin).unwrap();
    let (_, after) = rest.split_once(end).unwrap();
    let expected = [before, begin, &tables(), end, after].concat();
    if std::env::var("BLESS").is_ok_and(|bless| bless == "1") {
        std::fs::write(&path, &expected).unwrap();
        return;
    }
    assert!(
        page == expected,
        "docs/monitor.md: BLESS=1 cargo test -p mesh-damper --test rig causes writes the causes again"
    );
}
