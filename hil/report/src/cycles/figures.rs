//! Results of the recordings per cycle and per block: measured, and for the law before and after.

use std::ops::Range;

use mesh_damper_recording::cycles::{alike, median};
use mesh_damper_recording::dynamic_stiffness::DynamicStiffness;
use mesh_damper_recording::extremes::least_and_largest;

use crate::{Series, SeriesBlock};

/// The source of a force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// The recording.
    Measured,
    /// The law alone.
    Before,
    /// The law with the effects found.
    After,
}

impl Of {
    pub const ALL: [Self; 3] = [Self::Measured, Self::Before, Self::After];

    pub fn force(self, series: &Series) -> &[f64] {
        match self {
            Self::Measured => &series.force,
            Self::Before => &series.before,
            Self::After => &series.after,
        }
    }
}

/// The figures of a cycle for each of the three forces, in the order of [`Of::ALL`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleFigures {
    /// Storage and loss stiffness.
    pub stiffness: [DynamicStiffness; 3],
    /// Half of the force's range, kN.
    pub peak: [f64; 3],
}

impl CycleFigures {
    /// `None` for a cycle with an unmeasured sample, or a cycle that is too short.
    fn of(series: &Series, cycle: &Range<usize>, length: f64) -> Option<Self> {
        let measured = series.measured.get(cycle.clone())?;
        if !measured.iter().all(|&measured| measured) {
            return None;
        }
        let displacement = series.displacement.get(cycle.clone())?;
        let mut stiffness = Vec::with_capacity(3);
        let mut peak = [0.0; 3];
        for (of, peak) in Of::ALL.into_iter().zip(&mut peak) {
            let force = of.force(series).get(cycle.clone())?;
            stiffness.push(DynamicStiffness::of(displacement, force, length)?);
            let (low, high) = least_and_largest(force);
            *peak = 0.5 * (high - low);
        }
        Some(Self {
            stiffness: stiffness.try_into().ok()?,
            peak,
        })
    }
}

/// A block of at least two similar cycles.
pub struct BlockFigures<'a> {
    pub series: &'a Series,
    pub block: &'a SeriesBlock,
    /// In the order of its cycles; `None` for a cycle without figures.
    pub cycles: Vec<Option<CycleFigures>>,
}

impl<'a> BlockFigures<'a> {
    /// Every block with figures. A single cycle is a transition between blocks, or belongs to a motion that does not repeat.
    pub fn all(series: &'a [Series]) -> Vec<Self> {
        let blocks = series
            .iter()
            .flat_map(|one| one.blocks.iter().map(move |block| (one, block)));
        blocks
            .filter(|(_, block)| block.cycles.len() > 1)
            .filter_map(|(series, block)| {
                let [first, second, ..] = series.time[..] else {
                    return None;
                };
                let length = 1.0 / (block.frequency * (second - first));
                let cycles = block.cycles.iter();
                let cycles: Vec<Option<CycleFigures>> = cycles
                    .map(|cycle| CycleFigures::of(series, cycle, length))
                    .collect();
                let cycles = without_ramps(&cycles);
                cycles.iter().any(Option::is_some).then_some(Self {
                    series,
                    block,
                    cycles,
                })
            })
            .collect()
    }

    /// The median of a figure over its cycles, which a single cycle of a ramp does not move.
    pub fn median(&self, figure: impl Fn(&CycleFigures) -> f64) -> f64 {
        median(self.cycles.iter().flatten().map(figure)).unwrap_or(f64::NAN)
    }
}

/// A cycle whose amplitude resembles neither neighbour's is a transition to or from the block, and has no figures.
fn without_ramps(cycles: &[Option<CycleFigures>]) -> Vec<Option<CycleFigures>> {
    let amplitude = |index: usize| Some(cycles.get(index)?.as_ref()?.stiffness[0].amplitude);
    let is_steady = |index: usize| {
        let beside = [index.checked_sub(1), Some(index + 1)];
        let mut beside = beside.into_iter().flatten().filter_map(amplitude);
        amplitude(index).is_some_and(|own| beside.any(|other| alike(own, other)))
    };
    (0..cycles.len())
        .map(|index| cycles[index].filter(|_| is_steady(index)))
        .collect()
}

/// The mean of the force on the way up and on the way down over displacement, at `count` displacements of one loop: (mm, kN).
///
/// `None` if the loop has too few samples in either direction.
pub fn middle_line(displacement: &[f64], force: &[f64], count: usize) -> Option<Vec<(f64, f64)>> {
    let (low, high) = least_and_largest(displacement);
    let bottom = displacement.iter().position(|&y| y == low)?;
    // From the lowest point up, and down again.
    let rolled: Vec<(f64, f64)> = (0..displacement.len())
        .map(|i| (bottom + i) % displacement.len())
        .map(|i| (displacement[i], force[i]))
        .collect();
    let top = rolled.iter().position(|point| point.0 == high)?;
    let (up, mut down) = (rolled[..=top].to_vec(), rolled[top..].to_vec());
    down.reverse();
    if up.len() < 4 || down.len() < 4 {
        return None;
    }
    // Noise may reverse a branch for a sample or two.
    let sorted = |mut branch: Vec<(f64, f64)>| {
        branch.sort_by(|a, b| a.0.total_cmp(&b.0));
        branch
    };
    let (up, down) = (sorted(up), sorted(down));
    let line = (0..count).map(|i| {
        let y = low + (high - low) * (i as f64 + 0.5) / count as f64;
        (y, 0.5 * (between(&up, y) + between(&down, y)))
    });
    Some(line.collect())
}

/// The value at `x` of points in order of x.
fn between(points: &[(f64, f64)], x: f64) -> f64 {
    let after = points
        .partition_point(|point| point.0 < x)
        .clamp(1, points.len() - 1);
    let (a, b) = (points[after - 1], points[after]);
    if b.0 == a.0 {
        return b.1;
    }
    a.1 + (b.1 - a.1) * ((x - a.0) / (b.0 - a.0)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    /// Six cycles of 100 samples: a spring of 2 kN/mm with a dashpot; `before` lacks, and `after` includes, friction of 0.1 kN.
    fn series() -> Series {
        let phase = |i: usize| (TAU * i as f64 / 100.0).sin_cos();
        let over = |force: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
            (0..600).map(|i| force(phase(i).0, phase(i).1)).collect()
        };
        Series {
            name: "a.csv".into(),
            time: (0..600).map(|i| 0.01 * i as f64).collect(),
            displacement: over(&|y, _| 0.5 * y),
            velocity: over(&|_, v| 0.5 * TAU * v),
            force: over(&|y, v| y + 0.3 * v),
            before: over(&|y, _| y),
            after: over(&|y, v| y + 0.1 * v.signum()),
            measured: vec![true; 600],
            blocks: vec![SeriesBlock {
                cycle: 400..501,
                cycles: (0..6).map(|i| 100 * i..100 * (i + 1)).collect(),
                amplitude: 0.5,
                frequency: 1.0,
                held_out: false,
            }],
        }
    }

    #[test]
    fn a_block_has_the_figures_of_each_force() {
        let series = [series()];
        let all = BlockFigures::all(&series);
        let [block] = &all[..] else {
            panic!("{}", all.len())
        };
        for (index, loss) in [0.6, 0.0, 4.0 * 0.1 / (PI * 0.5)].into_iter().enumerate() {
            let stiffness = |one: &CycleFigures| one.stiffness[index];
            assert!((block.median(|one| stiffness(one).storage) - 2.0).abs() < 0.01);
            assert!(
                (block.median(|one| stiffness(one).loss) - loss).abs() < 0.02,
                "{loss}"
            );
        }
        // A spring and a dashpot: the largest force is √(1² + 0.3²).
        assert!((block.median(|one| one.peak[0]) - 1.09_f64.sqrt()).abs() < 1e-3);
    }

    #[test]
    fn cycles_that_were_not_measured_and_single_ones_have_none() {
        let mut series = [series()];
        series[0].measured[150] = false;
        assert_eq!(BlockFigures::all(&series)[0].cycles[1], None);
        // Half as large as the next.
        for i in 0..100 {
            series[0].displacement[i] *= 0.5;
        }
        assert_eq!(BlockFigures::all(&series)[0].cycles[0], None);
        assert!(BlockFigures::all(&series)[0].cycles[5].is_some());
        series[0].blocks[0].cycles.truncate(1);
        assert!(BlockFigures::all(&series).is_empty());
        assert!(BlockFigures::all(&[Series::default()]).is_empty());
    }

    #[test]
    fn the_middle_line_is_without_what_depends_on_the_direction() {
        let series = series();
        let line = middle_line(&series.displacement[..100], &series.after[..100], 21).unwrap();
        assert_eq!(line.len(), 21);
        for (y, f) in line {
            assert!((f - 2.0 * y).abs() < 0.01 || y.abs() > 0.45, "{y} {f}");
        }
        assert_eq!(middle_line(&[1.0; 5], &[1.0; 5], 3), None);
        assert_eq!(middle_line(&[], &[], 3), None);
    }
}
