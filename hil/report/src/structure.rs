//! Checks that a page is built so that a screen reader, a keyboard and a parser find their way. Properties that only a browser
//! knows, such as visible contrast, are checked by `.ci/report-page`.

use std::collections::BTreeMap;

/// Elements without an end tag.
const VOID: [&str; 4] = ["meta", "input", "br", "link"];

/// A tag with its attributes; the name of an end tag begins with `/`.
struct Tag<'a> {
    name: &'a str,
    attributes: BTreeMap<&'a str, &'a str>,
    /// The text after it, up to the next tag.
    text: &'a str,
}

impl Tag<'_> {
    fn has(&self, attribute: &str, value: &str) -> bool {
        self.attributes.get(attribute) == Some(&value)
    }
}

/// The tags of a page in order, without scripts and style sheets.
fn tags(page: &str) -> Vec<Tag<'_>> {
    let mut tags: Vec<Tag<'_>> = Vec::new();
    let mut rest = page;
    while let Some(start) = rest.find('<') {
        let raw = tags
            .last()
            .filter(|tag| ["script", "style"].contains(&tag.name));
        let start = match raw {
            Some(tag) => rest.find(&format!("</{}", tag.name)).unwrap(),
            None => start,
        };
        let end = start + rest[start..].find('>').unwrap();
        let inside = rest[start + 1..end].trim_end_matches('/');
        let (name, written) = inside.split_once(' ').unwrap_or((inside, ""));
        rest = &rest[end + 1..];
        let text = &rest[..rest.find('<').unwrap_or(rest.len())];
        let mut attributes = BTreeMap::new();
        let mut written = written.trim();
        while !written.is_empty() {
            let Some((name, value)) = written.split_once("=\"") else {
                attributes.extend(written.split(' ').map(|name| (name, "")));
                break;
            };
            // Attributes without a value may precede one with a value.
            let (bare, name) = name.rsplit_once(' ').unwrap_or(("", name));
            attributes.extend(
                bare.split(' ')
                    .filter(|one| !one.is_empty())
                    .map(|one| (one, "")),
            );
            let (value, after) = value.split_once('"').unwrap();
            attributes.insert(name, value);
            written = after.trim();
        }
        if !name.starts_with('!') {
            tags.push(Tag {
                name,
                attributes,
                text: text.trim(),
            });
        }
    }
    tags
}

/// Panics if a part is missing, or is in the wrong place.
pub fn check(page: &str) {
    let tags = tags(page);
    let of = |name: &'static str| tags.iter().filter(move |tag| tag.name == name);
    nested(&tags);
    for landmark in ["main", "nav", "header", "footer", "h1"] {
        assert_eq!(of(landmark).count(), 1, "{landmark}");
    }
    assert!(of("html").all(|tag| tag.has("lang", "en")));
    // The first element in tab order skips the contents.
    let first = of("a").next().unwrap();
    assert!(first.has("class", "skip") && first.has("href", "#report"));

    let levels = tags
        .iter()
        .filter_map(|tag| tag.name.strip_prefix('h')?.parse::<u32>().ok());
    let levels: Vec<u32> = levels.collect();
    assert!(
        levels.windows(2).all(|pair| pair[1] <= pair[0] + 1),
        "{levels:?}"
    );

    let mut ids: Vec<&str> = tags
        .iter()
        .filter_map(|tag| tag.attributes.get("id").copied())
        .collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count, "an id is there twice");
    for tag in &tags {
        let named = tag.attributes.get("aria-labelledby").copied();
        let linked = tag
            .attributes
            .get("href")
            .and_then(|address| address.strip_prefix('#'));
        for id in named.into_iter().chain(linked) {
            assert!(ids.contains(&id), "{id} is nowhere");
        }
    }

    let regions = tags.iter().filter(|tag| tag.has("role", "region"));
    let mut regions: Vec<&str> = regions.map(|tag| tag.attributes["aria-label"]).collect();
    let count = regions.len();
    regions.sort_unstable();
    regions.dedup();
    assert_eq!(regions.len(), count, "two regions have one name");

    for (index, tag) in tags.iter().enumerate() {
        let next = |place: usize| &tags[index + place];
        match tag.name {
            "svg" if tag.has("role", "img") => {
                // Its name and its description, with figures.
                assert_eq!((next(1).name, next(3).name), ("title", "desc"));
                assert!(!next(1).text.is_empty());
                assert!(
                    next(3).text.contains(|c: char| c.is_ascii_digit()),
                    "{}",
                    next(3).text
                );
            }
            "svg" => {
                let is_part = tag.has("class", "curves");
                assert!(
                    is_part || tag.has("aria-hidden", "true"),
                    "a picture without a name"
                );
            }
            "figure" => assert_eq!(next(1).name, "figcaption"),
            "table" => assert!(next(1).name == "caption" && !next(1).text.is_empty()),
            "th" => {
                let scope = tag.attributes.get("scope").copied().unwrap_or_default();
                assert!(["col", "row"].contains(&scope), "a head without a scope");
            }
            _ => {}
        }
    }
    // A curve is distinguished by more than its colour: by a dash, a width or a mark.
    for panel in page.split("<g class=\"panel\"").skip(1) {
        let panel = panel.split("</svg>").next().unwrap();
        let strokes = panel.split("<g data-curve=\"").skip(1).filter_map(|layer| {
            let name = layer.split('"').next()?;
            let path = layer.split("<path").nth(1)?.split("/>").next()?;
            let after = path.split(" stroke=\"#").nth(1)?.get(7..)?;
            Some((name, after))
        });
        let by_name: BTreeMap<&str, &str> = strokes.collect();
        let mut looks: Vec<&str> = by_name.values().copied().collect();
        looks.sort_unstable();
        looks.dedup();
        // Two thin lines over a long time overlap: there the legend separates them.
        let is_over_time = panel.contains("data-x=\"time");
        assert!(looks.len() == by_name.len() || is_over_time, "{by_name:?}");
    }
}

/// Every element ends, and in the order in which it began.
fn nested(tags: &[Tag<'_>]) {
    let mut open: Vec<&str> = Vec::new();
    let is_svg = |name: &str| ["path", "rect", "circle", "polygon", "line"].contains(&name);
    for tag in tags {
        if let Some(name) = tag.name.strip_prefix('/') {
            let last = open.iter().rposition(|other| !is_svg(other)).unwrap();
            let place = if is_svg(name) { open.len() - 1 } else { last };
            assert_eq!(open[place], name, "{open:?}");
            open.truncate(place);
        } else if !VOID.contains(&tag.name) {
            open.push(tag.name);
        }
    }
    assert!(open.is_empty(), "{open:?}");
}
