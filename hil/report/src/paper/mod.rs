//! The report of `hil paper`: its claims, and its figures drawn again.

mod elements;
mod figures;
mod tables;

use maud::{DOCTYPE, Markup, PreEscaped, html};
use mesh_damper_studies::paper::{Claim, Paper, Verdict};
use plotters::style::RGBColor;

use figures::Figure;

/// The report as one HTML file that needs no other.
pub fn render(paper: &Paper) -> String {
    let title = "The paper, recomputed";
    let count = |verdict: Verdict| {
        let of = |claim: &&Claim| claim.verdict == verdict;
        paper.claims.iter().filter(of).count()
    };
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(include_str!("../style.css"))) }
            }
            body {
                h1 { (title) }
                section.verdict {
                    h2 {
                        (paper.claims.len()) " claims: " (count(Verdict::Holds)) " hold, " (count(Verdict::Fails)) " fail, "
                        (count(Verdict::CannotTell)) " can't be told"
                    }
                    p {
                        "Of " em { "Simulation of the Dynamic Response to Sinusoidal Excitation of the Elastic Porous Metal Mesh \
                         Damper" } ". The recordings of its tests are not published: the loops of Tables 6–9 at 1 Hz stand for \
                         them."
                    }
                }
                h2 { "1. Claims" }
                (claims(&paper.claims))
                h2 { "2. Figures" }
                @for figure in figures::all(paper) { (drawn(&figure)) }
                h2 { "3. Surfaces" }
                (tables::surfaces(paper))
                h2 { "4. Cells that look misprinted" }
                (tables::misprints(paper))
                h2 { "5. Finite elements: what they depend on" }
                (elements::section(paper))
                h2 { "6. The orthogonal test, Table 3" }
                (tables::orthogonal(paper))
                footer {
                    "Errors of a loop are the RMS of the force's error over the RMS of the force, in %, unless eq 21 is named. K \
                     and η are by eqs 3–7."
                }
            }
        }
    };
    page.into_string()
}

fn claims(claims: &[Claim]) -> Markup {
    html! {
        div.scroll { table {
            thead { tr { th { "where" } th.text { "what is said" } th.text { "verdict" } th.text { "why" } } }
            tbody {
                @for claim in claims {
                    tr {
                        td { (claim.place) }
                        td.text { (claim.says) }
                        td.text.verdict-cell.(class(claim.verdict)) { (claim.verdict.in_words()) }
                        td.text { (claim.reason) }
                    }
                }
            }
        } }
    }
}

fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "holds",
        Verdict::Fails => "fails",
        Verdict::CannotTell => "open",
    }
}

fn drawn(figure: &Figure) -> Markup {
    html! {
        h3 { (figure.title) }
        p { (figure.said) }
        @if let Some(svg) = &figure.svg {
            (key(&figure.key))
            figure { (PreEscaped(svg)) }
        }
        p { (figure.seen) }
    }
}

/// Colours and what they stand for.
fn key(entries: &[(RGBColor, String)]) -> Markup {
    html! {
        div.key {
            @for (RGBColor(r, g, b), name) in entries {
                span {
                    svg width="30" height="10" viewBox="0 0 30 10" aria-hidden="true" {
                        line x1="0" y1="5" x2="30" y2="5" stroke=(format!("rgb({r},{g},{b})")) stroke-width="3" {}
                    }
                    (name)
                }
            }
        }
    }
}
