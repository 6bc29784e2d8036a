//! The tables of the report.

use maud::{Markup, html};
use mesh_damper_paper::claims::{Paper, SurfaceErrors};
use mesh_damper_reference::tables::{AMPLITUDES, DENSITIES};

use crate::html::table;
use crate::text;

/// Number of listed cells, those farthest from the others.
const FARTHEST: usize = 12;

/// Error of every set of surfaces in every cell.
pub fn surfaces(paper: &Paper) -> Markup {
    html! {
        p {
            "The crate's surfaces are of the elastic force at the amplitude, the cubic's share in it, the damping force at the largest \
             speed, and α. By their form alone k1, k3 and c are above 0, α is within 0…1, and neither force falls where the amplitude \
             rises. The fit does not force the stiffness to rise with density: that of the tables falls from 2.5 to 3.0 g/cm³ at \
             0.15 mm and above. The error of a cell that was left out of the fit measures the surfaces between cells. In the first and \
             last row it is an extrapolation over amplitude."
        }
        @for one in &paper.surface_errors { (errors(one)) }
    }
}

fn errors(one: &SurfaceErrors) -> Markup {
    html! {
        h3 {
            (one.name) ": " (text::percent(one.mean)) " on average, " (text::percent(one.largest)) " at most"
        }
        (table(&format!("Error of the loop by density and amplitude, %: {}", one.name), head("loop, %"), html! {
            @for (amplitude, row) in AMPLITUDES.iter().zip(&one.loop_error) {
                tr {
                    th scope="row" { (format!("{amplitude:.2} mm")) }
                    @for error in row { td { (format!("{:.1}", 100.0 * error)) } }
                }
            }
        }))
        @if let Some(all) = &one.coefficient_errors {
            (table(&format!("Errors of k1, k3, c and α over the cell, %: {}", one.name), head("amplitude"), html! {
                @for (amplitude, row) in AMPLITUDES.iter().zip(all) {
                    tr {
                        th scope="row" { (format!("{amplitude:.2} mm")) }
                        @for errors in row {
                            td { @for (i, error) in errors.iter().enumerate() {
                                @if i > 0 { ", " }
                                (format!("{:.0}", 100.0 * error).replace('-', "−"))
                            } }
                        }
                    }
                }
            }))
        }
    }
}

/// One column per density, after a column of this name.
fn head(first: &str) -> Markup {
    html! { tr {
        th scope="col" { (first) }
        @for density in DENSITIES { th scope="col" { (format!("{density:.1} g/cm³")) } }
    } }
}

/// The basis of the fit of the surfaces, and the cells that stand apart.
pub fn misprints(paper: &Paper) -> Markup {
    html! {
        p {
            "Eqs 17–19 are least-squares fits. The residual of such a fit has no part in the span of its terms. A part larger than \
             rounding shows that the paper fitted a table other than the printed one. Each cell in turn is made a free parameter. If \
             one free cell removes that part, the printed value of that cell differs from the fitted one."
        }
        (table("The fits of eqs 17–19 to their tables", html! { tr {
            th scope="col" { "surface" } th scope="col" { "R²" } th scope="col" { "best R² of its terms" }
            th scope="col" { "part in the span" } th scope="col" { "part by rounding, RMS (largest)" }
            th.text scope="col" { "best free cell" } th scope="col" { "printed" } th scope="col" { "as fitted" }
            th scope="col" { "part with that cell free" } th scope="col" { "part with the next cell free" }
        } }, html! {
            @for fit in &paper.fits {
                @let cell = &fit.free[0];
                tr {
                    th scope="row" { (fit.equation) }
                    td { (format!("{:.3}", fit.r_squared)) }
                    td { (format!("{:.3}", fit.best_r_squared)) }
                    td { (text::number(fit.left)) }
                    td { (text::number(fit.rounding.0)) " (" (text::number(fit.rounding.1)) ")" }
                    @if fit.is_of_the_table() {
                        td.text colspan="5" { "none: it is the fit of the table as printed" }
                    } @else {
                        td.text { (format!("{:.1} g/cm³, {:.2} mm", cell.density, cell.amplitude)) }
                        td { (cell.printed) }
                        td { (format!("{:.4}", cell.fitted)) }
                        td { (text::number(cell.left)) }
                        td { (text::number(fit.free[1].left)) }
                    }
                }
            }
        }))
        p {
            "Every cell against what the 24 others of its table predict, by a fit of degree 3 in density and 1 in ln A; the ratio is in \
             standard deviations of the others. By chance one in 42 lies beyond 2.5."
        }
        (table("The cells that stand farthest from the others", html! { tr {
            th scope="col" { "table" } th scope="col" { "density, g/cm³" } th scope="col" { "amplitude, mm" }
            th scope="col" { "printed" } th scope="col" { "predicted" } th scope="col" { "ratio" }
        } }, html! {
            @for one in paper.left_out.iter().take(FARTHEST) {
                tr {
                    th scope="row" { (one.table) }
                    td { (format!("{:.1}", one.density)) }
                    td { (format!("{:.2}", one.amplitude)) }
                    td { (one.printed) }
                    td { (text::number(one.predicted)) }
                    td { (format!("{:.1}", one.ratio).replace('-', "−")) }
                }
            }
        }))
    }
}

/// Level sums, ranges and shares of variance.
pub fn orthogonal(paper: &Paper) -> Markup {
    html! {
        @for analysis in &paper.orthogonal_test {
            h3 { (analysis.response) }
            (table(&format!("Level sums, range and share of variance of each factor: {}", analysis.response), html! { tr {
                th scope="col" { "factor" } th scope="col" { "ΣK1" } th scope="col" { "ΣK2" } th scope="col" { "ΣK3" }
                th scope="col" { "R" } th scope="col" { "share of variance" }
            } }, html! {
                @for (one, effect) in analysis.ranges.iter().zip(&analysis.variance.effects) {
                    tr {
                        th scope="row" { (one.factor) }
                        @for sum in one.sums { td { (format!("{sum:.4}")) } }
                        td { (format!("{:.4}", one.range)) }
                        td { (text::percent(effect.share)) }
                    }
                }
            }))
        }
    }
}
