//! Bars with a name, a value and a state beside them, as HTML: rows of a `div.bars`.

use maud::{Markup, html};

/// A row with a bar of a `part` of its track, and something drawn over the track.
pub(crate) fn bar(
    (name, title): (&str, Option<String>),
    (class, part): (&str, f64),
    over: Markup,
    value: &str,
    state: &str,
) -> Markup {
    html! {
        div.name title=[title] { (name) }
        div.track { div class=(class) style=(format!("width:{:.2}%", percent(part))) {} (over) }
        div.value { (value) }
        div.state { (state) }
    }
}

/// A dotted line at a part of the track.
pub(crate) fn dotted(part: f64) -> Markup {
    html! { div.noise style=(format!("left:{:.2}%", percent(part))) {} }
}

/// A thin line from one part of the track to another.
pub(crate) fn whisker(from: f64, to: f64) -> Markup {
    let [from, to] = [from, to].map(percent);
    html! { div.whisker style=(format!("left:{from:.2}%;width:{:.2}%", to - from)) {} }
}

fn percent(part: f64) -> f64 {
    100.0 * part.clamp(0.0, 1.0)
}
