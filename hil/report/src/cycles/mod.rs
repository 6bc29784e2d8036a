//! Results of blocks of cycles: backbone, storage and loss stiffness, loss factor, and the loops next to each other.

mod figures;
mod pictures;
mod waterfall;

use maud::{Markup, html};

use super::html::{Section, figure, table};
use super::page::{condition, names};
use super::picture::{self, Picture};
use super::{ReportData, text};
use figures::BlockFigures;

/// Most blocks in the table: further blocks are only in the pictures.
const MOST_ROWS: usize = 60;

/// The section. If no cycle resembles the next one, it gives the reason for being empty.
pub fn section(data: &ReportData) -> Section {
    let blocks = BlockFigures::all(&data.series);
    let body = if blocks.is_empty() {
        html! {
            p {
                "Stiffness and loss factor need motion that repeats, and no two consecutive cycles of these recordings are alike. So \
                 there is no backbone, no K′, K″ or η, and no row of loops."
            }
        }
    } else {
        filled(data, &blocks)
    };
    Section::new("Cycles: backbone, stiffness and loss factor", body)
}

fn filled(data: &ReportData, blocks: &[BlockFigures<'_>]) -> Markup {
    let names = names(&data.result);
    let backbones = pictures::backbones(blocks);
    let over_amplitude = pictures::over_amplitude(blocks);
    let over_frequency = pictures::over_frequency(blocks);
    let over_cycles = pictures::over_cycles(blocks);
    let waterfall = waterfall::picture(blocks);
    html! {
        p {
            "K′ (storage stiffness) and K″ (loss stiffness) compare the fundamentals of force and displacement: K′ is the force \
             component in phase with the displacement, divided by the displacement amplitude; K″ is the component a quarter of a cycle \
             ahead, divided by the same amplitude. η = K″/K′. The figures of a block are medians over its cycles."
        }
        h3 { "Backbone" }
        (picture::key(&backbones, &names))
        div.pair { @for (picture, caption) in backbones.iter().zip(pictures::BACKBONES) { (figure(html! { (caption) }, picture)) } }
        h3 { "Stiffness over amplitude" }
        (by_condition(over_amplitude.as_deref(), "amplitude"))
        h3 { "Stiffness over frequency" }
        (by_condition(over_frequency.as_deref(), "frequency"))
        h3 { "Stiffness and loss factor over cycles" }
        (picture::key([&over_cycles], &names))
        (figure(html! { "cycle by cycle, blocks one after another" }, &over_cycles))
        h3 { "Loops, stacked" }
        (picture::key([&waterfall.picture], &names))
        (figure(html! { (waterfall.caption) }, &waterfall.picture))
        (results(blocks))
    }
}

fn by_condition(pictures: Option<&[Picture]>, over: &str) -> Markup {
    html! {
        @match pictures {
            Some(pictures) => {
                p { "Marks: measured. Lines: augmented model." }
                (picture::key(pictures, &[]))
                div.grid { @for picture in pictures { (figure(html! { (picture.panels[0].y.name) }, picture)) } }
            }
            None => p { "All blocks are of one " (over) ": there is no curve to draw." },
        }
    }
}

fn results(blocks: &[BlockFigures<'_>]) -> Markup {
    let head = html! {
        tr {
            th scope="col" { "block" } th scope="col" { "cycles" }
            th scope="col" { "K′, kN/mm" } th scope="col" { "augmented model" }
            th scope="col" { "K″, kN/mm" } th scope="col" { "augmented model" }
            th scope="col" { "η" } th scope="col" { "augmented model" }
        }
    };
    let rows = html! {
        @for block in blocks.iter().take(MOST_ROWS) {
            tr {
                th scope="row" { (condition(block.block)) }
                td { (block.cycles.len()) }
                @for of in [0, 2] { td { (text::number(block.median(|one| one.stiffness[of].storage))) } }
                @for of in [0, 2] { td { (text::number(block.median(|one| one.stiffness[of].loss))) } }
                @for of in [0, 2] { td { (text::number(block.median(|one| one.stiffness[of].loss_factor()))) } }
            }
        }
    };
    html! {
        (table("Per-block results, measured and of the augmented model", head, rows))
        @if blocks.len() > MOST_ROWS {
            p { "The first " (MOST_ROWS) " of " (blocks.len()) " blocks." }
        }
    }
}
