//! Memory and processor time of a trace over the number of rows, as one SVG with logarithmic axes.

use mesh_damper_trials::size::{Measured, Motion, mebibytes, memory_limit};

use super::palette::Colour;
use super::picture::{Axis, Dash, Layer, Look, Mark, Panel, Picture};

/// The look of each motion.
const LOOKS: [(Colour, Mark); 2] = [(Colour::After, Mark::Disc), (Colour::Before, Mark::Square)];
/// Points of the line of the limit.
const POINTS: usize = 60;

/// The picture of the measurements, and of the memory limit.
pub fn picture(all: &[Measured]) -> String {
    let rows = Axis::new("rows", "").logarithmic();
    let ends = rows.ends(all.iter().map(|one| one.rows as f64));
    let steps = (0..=POINTS).map(|step| step as f64 / POINTS as f64);
    let limit = steps.map(|part| {
        let rows = 10_f64.powf(ends.start + part * (ends.end - ends.start));
        (rows, mebibytes(memory_limit(rows as usize)))
    });
    let limit = Layer::new(
        "limit: 400 bytes a row and 64 MiB",
        Colour::Measured,
        Look::Line(Dash::Long),
        limit.collect(),
    );
    let curves = |value: fn(&Measured) -> f64| {
        let motions = Motion::ALL.into_iter().zip(LOOKS);
        motions.map(move |(motion, (colour, mark))| {
            let of_motion = all.iter().filter(|one| one.motion == motion);
            let points = of_motion.map(|one| (one.rows as f64, value(one))).collect();
            Layer::new(
                motion.in_words(),
                colour,
                Look::Both(mark, Dash::Solid),
                points,
            )
        })
    };
    let panel = |y: Axis, layers| Panel {
        title: String::new(),
        x: rows.clone(),
        y: y.logarithmic(),
        layers,
    };
    let memory = [limit]
        .into_iter()
        .chain(curves(|one| mebibytes(one.memory)));
    let panels = vec![
        panel(Axis::new("memory", "MiB"), memory.collect()),
        panel(
            Axis::new("processor", "s"),
            curves(|one| one.processor).collect(),
        ),
    ];
    let title = "Memory and processor time of a trace over the number of rows";
    Picture::of_panels(title, ((430, 380), 15), 2, panels).alone()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_measurement_is_a_point_of_both_panels_beside_the_limit() {
        let measured = |motion, rows| Measured {
            motion,
            rows,
            duration: 10.0,
            processor: rows as f64 / 1e5,
            elapsed: 1.0,
            memory: 200 * rows as u64 + (20 << 20),
        };
        let all: Vec<Measured> = Motion::ALL
            .into_iter()
            .flat_map(|motion| [10_000, 100_000, 1_000_000].map(|rows| measured(motion, rows)))
            .collect();
        let svg = picture(&all);
        // One circle for each point of one motion in both panels and the legend, one square for each of the other's.
        assert_eq!(svg.matches("<circle").count(), all.len() + 1);
        for said in ["limit", "blocks of sines", "random", "memory, MiB"] {
            assert!(svg.contains(said), "{said}");
        }
    }
}
