//! Names of curves with a sample of each: in a page, or in a separate picture.

use maud::{Markup, PreEscaped, html};

use super::draw::{LETTER, Sheet};
use super::shapes::piece;
use super::{Layer, Picture};

/// Width of a sample of a curve, px.
const SAMPLE: f64 = 30.0;

/// The names of the curves of `pictures`, each with a sample of it; `said` may give other words for a name. With a script, an entry
/// shows and hides the curves of its name in its section.
pub fn key<'a>(pictures: impl IntoIterator<Item = &'a Picture>, said: &[(&str, String)]) -> Markup {
    let mut entries: Vec<Vec<&Layer>> = Vec::new();
    for named in pictures.into_iter().flat_map(Picture::named) {
        if entries.iter().all(|other| other[0].name != named[0].name) {
            entries.push(named);
        }
    }
    let words = |name: &str| {
        let other = said.iter().find(|(of, _)| *of == name);
        other.map_or_else(|| name.to_owned(), |(_, words)| words.clone())
    };
    html! {
        ul.key {
            @for layers in entries {
                @let name = &layers[0].name;
                li data-curve=(name) {
                    svg.picture width="30" height="14" viewBox="0 0 30 14" aria-hidden="true" focusable="false" {
                        (PreEscaped(sample(&layers)))
                    }
                    (words(name))
                }
            }
        }
    }
}

/// A sample of the layers of a name.
fn sample(layers: &[&Layer]) -> String {
    let mut sheet = Sheet::default();
    for layer in layers {
        piece(&mut sheet, layer, (0.0, 7.0), SAMPLE);
    }
    sheet.into_text()
}

/// Entries in lines above the panels of a picture: their SVG and the height that they take, px.
pub fn above(picture: &Picture) -> (String, f64) {
    let named = picture.named();
    if named.len() < 2 {
        return (String::new(), 0.0);
    }
    let font = f64::from(picture.font);
    let (left, line) = (font, 1.6 * font);
    let (mut x, mut y) = (left, line);
    let mut sheet = Sheet::default();
    for layers in named {
        let name = &layers[0].name;
        let width = SAMPLE + font * (0.5 + LETTER * name.chars().count() as f64 + 1.5);
        if x > left && x + width > f64::from(picture.size.0) {
            (x, y) = (left, y + line);
        }
        for layer in layers {
            piece(&mut sheet, layer, (x, y), SAMPLE);
        }
        sheet.text((x + SAMPLE + 0.5 * font, y), "start", name);
        x += width;
    }
    (sheet.into_text(), y + 0.5 * font)
}
