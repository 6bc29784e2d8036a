//! The tables of the report.

use maud::{Markup, html};
use mesh_damper_reference::tables::{AMPLITUDES, DENSITIES};
use mesh_damper_studies::paper::{Paper, SurfaceErrors};

use crate::html::table;
use crate::text;

/// Cells that are told, of those that stand farthest from the others.
const FARTHEST: usize = 12;

/// Error of every set of surfaces in every cell.
pub fn surfaces(paper: &Paper) -> Markup {
    html! {
        p {
            "The crate's surfaces are of the elastic force at the amplitude, the cubic's share in it, the damping force at the largest \
             speed, and α. By their form alone k1, k3 and c are above 0, α is within 0…1, and neither force falls where the amplitude \
             rises. The stiffness is not made to rise with density: that of the tables falls from 2.5 to 3.0 g/cm³ at 0.15 mm \
             and above. A cell's error without it in the fit is what the surfaces are worth between cells; in the first and last row \
             it is of an amplitude beyond all others."
        }
        @for one in &paper.surface_errors { (errors(one)) }
    }
}

fn errors(one: &SurfaceErrors) -> Markup {
    html! {
        h3 {
            (one.name) ": " (text::percent(one.mean)) " on average, " (text::percent(one.largest)) " at most"
        }
        div.scroll { table {
            thead { tr {
                th { "loop, %" }
                @for density in DENSITIES { th { (format!("{density:.1} g/cm³")) } }
            } }
            tbody {
                @for (amplitude, row) in AMPLITUDES.iter().zip(&one.loop_error) {
                    tr {
                        td { (format!("{amplitude:.2} mm")) }
                        @for error in row { td { (format!("{:.1}", 100.0 * error)) } }
                    }
                }
            }
        } }
        @if let Some(all) = &one.coefficient_errors {
            p { "Of k1, k3, c and α over the cell, in %:" }
            div.scroll { table {
                thead { tr {
                    th { "" }
                    @for density in DENSITIES { th { (format!("{density:.1} g/cm³")) } }
                } }
                tbody {
                    @for (amplitude, row) in AMPLITUDES.iter().zip(all) {
                        tr {
                            td { (format!("{amplitude:.2} mm")) }
                            @for errors in row {
                                td { @for (i, error) in errors.iter().enumerate() {
                                    @if i > 0 { ", " }
                                    (format!("{:.0}", 100.0 * error).replace('-', "−"))
                                } }
                            }
                        }
                    }
                }
            } }
        }
    }
}

/// What the surfaces were fitted to, and which cells stand apart.
pub fn misprints(paper: &Paper) -> Markup {
    html! {
        p {
            "Eqs 17–19 are least-squares fits. Of a fit nothing is left in the span of its terms; what is left beyond rounding says \
             that the fitted table was another. One cell is let free in turn: the one that alone explains it is printed with another \
             value than was fitted."
        }
        div.scroll { table {
            thead { tr {
                th { "surface" } th { "R²" } th { "best R² of its terms" } th { "left in the span" } th { "by rounding, RMS (most)" }
                th.text { "cell that leaves least when free" } th { "printed" } th { "as fitted" } th { "left then" }
                th { "with the next cell" }
            } }
            tbody {
                @for fit in &paper.fits {
                    @let cell = &fit.free[0];
                    tr {
                        td { (fit.equation) }
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
            }
        } }
        p {
            "Every cell against what the 24 others of its table predict, by a fit of degree 3 in density and 1 in ln A; the ratio is in \
             standard deviations of the others. By chance one in 42 lies beyond 2.5."
        }
        div.scroll { table {
            thead { tr { th { "table" } th { "density, g/cm³" } th { "amplitude, mm" } th { "printed" } th { "predicted" } th { "ratio" } } }
            tbody {
                @for one in paper.left_out.iter().take(FARTHEST) {
                    tr {
                        td { (one.table) }
                        td { (format!("{:.1}", one.density)) }
                        td { (format!("{:.2}", one.amplitude)) }
                        td { (one.printed) }
                        td { (text::number(one.predicted)) }
                        td { (format!("{:.1}", one.ratio).replace('-', "−")) }
                    }
                }
            }
        } }
    }
}

/// Level sums, ranges and shares of variance.
pub fn orthogonal(paper: &Paper) -> Markup {
    html! {
        @for analysis in &paper.orthogonal_test {
            h3 { (analysis.response) }
            div.scroll { table {
                thead { tr {
                    th { "factor" } th { "ΣK1" } th { "ΣK2" } th { "ΣK3" } th { "R" } th { "share of variance" }
                } }
                tbody {
                    @for (one, effect) in analysis.ranges.iter().zip(&analysis.variance.effects) {
                        tr {
                            td { (one.factor) }
                            @for sum in one.sums { td { (format!("{sum:.4}")) } }
                            td { (format!("{:.4}", one.range)) }
                            td { (text::percent(effect.share)) }
                        }
                    }
                }
            } }
        }
    }
}
