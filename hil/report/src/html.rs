//! The common parts of all pages: head, contents, sections, figures and tables, in one file that loads nothing.
//!
//! A page is complete without a script. With a script, a reader can zoom into its pictures and read values.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::palette;
use super::picture::Picture;

/// Zooming, reading and hiding of curves.
const SCRIPT: &str = concat!(
    "(()=>{\"use strict\";\n",
    include_str!("script/axis.js"),
    include_str!("script/points.js"),
    include_str!("script/panel.js"),
    include_str!("script/read.js"),
    include_str!("script/view.js"),
    include_str!("script/key.js"),
    "})();"
);

/// A part of a page with its heading.
pub struct Section {
    heading: String,
    body: Markup,
}

impl Section {
    /// A part of a page.
    pub fn new(heading: impl Into<String>, body: Markup) -> Self {
        Self {
            heading: heading.into(),
            body,
        }
    }

    /// Its address within the page.
    fn id(&self) -> String {
        let mut id = String::from("s");
        for character in self.heading.to_lowercase().chars() {
            match character {
                'a'..='z' | '0'..='9' => id.push(character),
                _ if !id.ends_with('-') => id.push('-'),
                _ => {}
            }
        }
        id.trim_end_matches('-').to_owned()
    }
}

/// A page: its title, its beginning, its sections with a list of them, and its end. `scripts` belong to this page only.
pub fn page(
    title: &str,
    first: Markup,
    sections: &[Section],
    last: Markup,
    scripts: &[&str],
) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style {
                    (PreEscaped(palette::variables()))
                    (PreEscaped(palette::rules()))
                    (PreEscaped(include_str!("style.css")))
                }
            }
            body {
                a.skip href="#report" { "Skip to the report" }
                header {
                    h1 { (title) }
                    nav aria-label="Contents" {
                        ul { @for section in sections { li { a href={ "#" (section.id()) } { (section.heading) } } } }
                    }
                }
                main id="report" tabindex="-1" {
                    (first)
                    @for section in sections {
                        section aria-labelledby=(section.id()) {
                            h2 id=(section.id()) { (section.heading) }
                            (section.body)
                        }
                    }
                }
                footer { (last) }
                script { (PreEscaped(SCRIPT)) }
                @for script in scripts { script { (PreEscaped(script)) } }
            }
        }
    };
    page.into_string()
}

/// A picture with its caption.
pub fn figure(caption: Markup, picture: &Picture) -> Markup {
    html! {
        figure style=(format!("--least:{}px;--most:{}px", picture.least_width(), picture.size.0)) {
            figcaption { (caption) }
            (PreEscaped(picture.within_page()))
        }
    }
}

/// A table of rows of `tr`, which scrolls by itself if it is too wide. The caption describes it, also for readers who do not see
/// the heading above it.
pub fn table(caption: &str, head: Markup, body: Markup) -> Markup {
    html! {
        div.scroll tabindex="0" role="region" aria-label=(caption) {
            table {
                caption { (caption) }
                thead { (head) }
                tbody { (body) }
            }
        }
    }
}
