//! The report of `hil paper`: its claims, and its figures drawn again.

mod elements;
mod figures;
mod tables;

use maud::{Markup, html};
use mesh_damper_paper::claims::{Claim, Paper, Verdict};

use super::html::{Section, figure, page, table};
use super::picture;
use figures::Figure;

/// The report as one HTML file that needs no other.
pub fn render(paper: &Paper) -> String {
    let count = |verdict: Verdict| {
        let of = |claim: &&Claim| claim.verdict == verdict;
        paper.claims.iter().filter(of).count()
    };
    let first = html! {
        div.verdict {
            p.heading { strong {
                (paper.claims.len()) " claims: " (count(Verdict::Holds)) " hold, " (count(Verdict::Fails)) " fail, "
                (count(Verdict::CannotTell)) " cannot be decided"
            } }
            p {
                "Of " em { "Simulation of the Dynamic Response to Sinusoidal Excitation of the Elastic Porous Metal Mesh \
                 Damper" } ". The recordings of its tests are not published: the loops of Tables 6–9 at 1 Hz stand for \
                 them."
            }
        }
    };
    let figures = html! { @for figure in figures::all(paper) { section { (drawn(&figure)) } } };
    let sections = [
        Section::new("1. Claims", claims(&paper.claims)),
        Section::new("2. Figures", figures),
        Section::new("3. Surfaces", tables::surfaces(paper)),
        Section::new("4. Cells that look misprinted", tables::misprints(paper)),
        Section::new(
            "5. Finite elements: what they depend on",
            elements::section(paper),
        ),
        Section::new("6. The orthogonal test, Table 3", tables::orthogonal(paper)),
    ];
    let last = html! {
        p {
            "Errors of a loop are the RMS of the force's error over the RMS of the force, in %, unless eq 21 is named. K \
             and η are by eqs 3–7."
        }
    };
    page("The paper, recomputed", first, &sections, last, &[])
}

fn claims(claims: &[Claim]) -> Markup {
    let head = html! { tr {
        th scope="col" { "where" } th.text scope="col" { "what is said" } th.text scope="col" { "verdict" }
        th.text scope="col" { "why" }
    } };
    let rows = html! {
        @for claim in claims {
            tr {
                th scope="row" { (claim.place) }
                td.text { (claim.says) }
                td.text.verdict-cell.(class(claim.verdict)) { (claim.verdict.in_words()) }
                td.text { (claim.reason) }
            }
        }
    };
    table("Claims of the paper", head, rows)
}

fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "holds",
        Verdict::Fails => "fails",
        Verdict::CannotTell => "open",
    }
}

fn drawn(one: &Figure) -> Markup {
    html! {
        h3 { (one.title) }
        p { (one.said) }
        (picture::key(one.pictures.iter().map(|(_, picture)| picture), &[]))
        div.grid { @for (caption, picture) in &one.pictures { (figure(html! { (caption) }, picture)) } }
        p { (one.seen) }
    }
}
