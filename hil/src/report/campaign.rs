//! How soon the fault campaign's faults were found, as SVG.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::charts::{self, AFTER, BEFORE, FINE, FONT, INK};
use crate::faults::Summary;

/// Cycles from a fault to its name, one row to a kind and size, one point to a trial: blue where the name is right.
pub fn picture(summary: &Summary) -> String {
    let rows = summary.kinds.len() as f64;
    let most = summary
        .outcomes
        .iter()
        .filter_map(|one| one.cycles)
        .fold(1.0, f64::max);
    charts::draw(&charts::TALL, |area| {
        let font = FINE * charts::TALL.font();
        let mut chart = ChartBuilder::on(area)
            .margin(font)
            .x_label_area_size(3 * font)
            .y_label_area_size(17 * font)
            .build_cartesian_2d(-0.1..1.05 * most, -rows..0.0)?;
        let text = || (FONT, font).into_font().color(&INK);
        chart
            .configure_mesh()
            .disable_y_axis()
            .disable_y_mesh()
            .x_desc("cycles from the fault to its name")
            .label_style(text())
            .axis_desc_style(text())
            .draw()?;
        for (row, kind) in summary.kinds.iter().enumerate() {
            let y = -(row as f64) - 0.5;
            let these = summary
                .outcomes
                .iter()
                .filter(|one| one.trial.kind == kind.kind && one.trial.size == kind.size);
            chart.draw_series(these.filter_map(|one| {
                let colour = if one.right { AFTER } else { BEFORE };
                Some(Circle::new(
                    (one.cycles?, y),
                    3 * FINE as i32,
                    colour.mix(0.4).filled(),
                ))
            }))?;
            let (_, place) = chart.plotting_area().map_coordinate(&(0.0, y));
            let named = format!("{:?} {}", kind.kind, kind.size);
            let right = text().pos(Pos::new(HPos::Right, VPos::Center));
            area.draw(&Text::new(named, (17 * font as i32, place), right))?;
        }
        Ok(())
    })
}
