//! The dependence of the finite elements on their assumptions, in the report.

use maud::{Markup, html};
use mesh_damper_paper::claims::{Compared, Paper};
use mesh_damper_paper::finite_element::Bore;
use mesh_damper_reference::tables::DENSITIES;

use crate::html::table;
use crate::text;

/// Readings of Table 4, bores and meshes.
pub fn section(paper: &Paper) -> Markup {
    html! {
        p {
            "A quarter of the ring, of linear hexahedra at finite strains: Mooney–Rivlin with the constants of Table 4, whose shear \
             relaxes as Table 5 says; a rigid fixture bonded to its outer surface moves it across a rigid, frictionless mandrel. \
             The law above is compared with D1 in 1/MPa, the signs as printed, and a bore that stays on the mandrel."
        }
        (readings(paper))
        (bores(paper))
        (meshes(paper))
    }
}

fn readings(paper: &Paper) -> Markup {
    html! {
        h3 { "Readings of Table 4, 0.1 mm: K in kN/mm, loss factor, error in %" }
        (table("Stiffness, loss factor and error by reading and density", html! { tr {
            th.text scope="col" { "D1 = 0.35" } th.text scope="col" { "C01" }
            @for density in DENSITIES { th scope="col" { (format!("{density:.1} g/cm³")) } }
            th scope="col" { "mean error" }
        } }, html! {
            @for one in &paper.elements.readings {
                tr {
                    th.text scope="row" { (one.reading.volumetric.in_words()) }
                    td.text { (one.reading.sign.in_words()) }
                    @for found in &one.by_density { td { (figures(found)) } }
                    td { (one.mean_error().map_or_else(|| "—".into(), text::percent)) }
                }
            }
            tr {
                th.text scope="row" colspan="2" { "Tables 6–9" }
                @for condition in &paper.comparison.by_density {
                    td { (text::number(condition.measured.stiffness)) ", " (text::number(condition.measured.loss_factor)) }
                }
                td { "–" }
            }
        }))
    }
}

fn figures(found: &Result<Compared, String>) -> String {
    match found {
        Ok(one) => format!(
            "{}, {}, {:.0}",
            text::number(one.dynamics.stiffness),
            text::number(one.dynamics.loss_factor),
            100.0 * one.nrmse
        ),
        Err(why) => why.clone(),
    }
}

fn bores(paper: &Paper) -> Markup {
    html! {
        h3 { "The bore on its mandrel, 2.0 g/cm³, 0.1 mm: K in kN/mm, loss factor, error in %" }
        (table("Stiffness, loss factor and error by bore", html! { tr {
            th.text scope="col" { "bore" } th.text scope="col" { "cycle" } th scope="col" { "K, loss factor, error" }
        } }, html! {
            @for one in &paper.elements.bores {
                tr {
                    th.text scope="row" { (match one.bore {
                        Bore::Separable => "frictionless, free to leave",
                        Bore::Gliding => "frictionless, never off",
                        Bore::Bonded => "bonded",
                    }) }
                    td.text { (match one.cycle {
                        Some(cycle) => format!("cycle {cycle} from rest"),
                        None => "steady".into(),
                    }) }
                    td { (figures(&one.found)) }
                }
            }
        }))
    }
}

fn meshes(paper: &Paper) -> Markup {
    let force = |index: usize| paper.elements.meshes.get(index)?.force.as_ref().ok();
    html! {
        h3 { "The mesh, 2.0 g/cm³, a sudden 0.25 mm" }
        (table("Force by the number of elements", html! { tr {
            th scope="col" { "elements through the wall" } th scope="col" { "force, kN" }
            th scope="col" { "more than the one before by" }
        } }, html! {
            @for (index, one) in paper.elements.meshes.iter().enumerate() {
                tr {
                    th scope="row" { (one.through) }
                    td { @match &one.force {
                        Ok(force) => (format!("{force:.4}")),
                        Err(why) => (why),
                    } }
                    td { @if let (Some(before), Some(here)) = (index.checked_sub(1).and_then(force), force(index)) {
                        (text::percent(here / before - 1.0))
                    } }
                }
            }
        }))
    }
}
