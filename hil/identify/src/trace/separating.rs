//! The test that distinguishes rivals: laws that predict one recording equally well may differ under another motion.
//!
//! It simulates each rival's force under blocks that a rig can run, and fits every other rival to it with all coefficients free. It
//! adds the blocks for which the nearest two differ most (Atkinson and Fedorov 1975).

use std::sync::Arc;

use mesh_damper_model::{Control, Family, ModelError};
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_reference::protocol::{TestBlock, motion};
use mesh_damper_tables::control::ControlChannel;

use super::select::Selection;
use super::verdict::rivals;
use crate::base_law::BaseLaw;
use crate::problem::Problem;
use crate::rows::Rows;
use crate::shape::Extent;
use crate::solution::Solution;
use crate::tolerance::{goal, noise_of};

mesh_damper_recording::numbers! {
    /// The separating test, which would tell effects apart.
    SeparatingPolicy {
        /// Frequencies below the recorded ones that the separating test may use, as fractions of the lowest recorded.
        below: [f64; 3] = [0.125, 0.25, 0.5], Convention("octaves");
        /// Frequencies above the recorded ones that the separating test may use, as multiples of the highest recorded.
        above: [f64; 3] = [2.0, 4.0, 8.0], Convention("octaves");
        /// Amplitudes that the separating test may use in addition to the largest recorded, as multiples of it.
        amplitudes: [f64; 2] = [0.5, 1.5], Convention("half less and half more");
        /// The lowest and the highest frequency of the separating test, Hz.
        frequencies: [f64; 2] = [0.1, 10.0], Convention("the range of the rig");
        /// The largest amplitude of the separating test, mm, unless a larger one was recorded.
        largest_amplitude: f64 = 0.3, Convention("the range of the rig");
        /// The separating test gets no further block if the effects already differ by this many times the noise.
        plenty: f64 = 10.0, Convention("they are told apart at a glance");
        /// There is no separating test if the effects differ by less than this many times the noise.
        enough: f64 = 1.0, Derived("the noise");
        /// A block of the separating test lasts at least this long, s.
        duration: f64 = 3.0, Convention("an operator can see a block of that length");
        /// A block of the separating test has at least this many cycles.
        fewest_cycles: f64 = 5.0, Convention("a ramp, and four cycles to fit and to validate");
    }
}

/// A simulation of the separating test has this many cycles of each block. Convention: the first starts the motion, the others repeat
/// it.
const SIMULATED_CYCLES: u32 = 3;

/// A simulation of the separating test has this many samples in a cycle. Convention: as many as at 5 Hz and 1 kHz.
const SAMPLES_PER_CYCLE: f64 = 200.0;

/// The separating test has at most this many blocks. Convention: the test then takes a minute.
const MOST_BLOCKS: usize = 4;

/// A fit to simulated forces, by which effects are told apart, uses at most about this many samples. Convention: there are hundreds
/// of these fits.
const SEPARATING_ROWS: usize = 1_500;

/// Laws that predict recordings equally well.
pub(super) struct Rivals {
    /// Each with the family by which it differs from the others: the preferred one first.
    pub laws: Vec<(Family, Solution)>,
    /// Their common part without these families.
    pub beside: Solution,
}

impl Rivals {
    /// The rivals at the end of a search.
    pub fn of(selection: &Selection) -> Self {
        let rivals = rivals(selection);
        let step = rivals.first().map_or(0, |rival| rival.step);
        let mut before = selection.candidates.iter();
        let before = before.rfind(|candidate| candidate.added && candidate.step < step);
        let beside = before.map_or(&selection.baseline, |candidate| &candidate.fitted);
        let laws = rivals.iter();
        Self {
            laws: laws
                .map(|rival| (rival.family, rival.fitted.solution.clone()))
                .collect(),
            beside: beside.solution.clone(),
        }
    }

    /// The effects of a `family` in a law, and `others` that do equally well in their place, each with the law that has it there.
    pub fn in_place_of(
        family: Family,
        law: &Solution,
        others: impl IntoIterator<Item = (Family, Solution)>,
    ) -> Self {
        Self {
            laws: std::iter::once((family, law.clone()))
                .chain(others)
                .collect(),
            beside: law.without_family(family),
        }
    }
}

/// The test that would distinguish rivals, as text with a programme of blocks, and these blocks; empty if no test on the rig would.
///
/// # Errors
/// A fitted law that the crate refuses.
pub(super) fn separating_test(
    rivals: &Rivals,
    trajectories: &[Trajectory],
    law: BaseLaw,
) -> Result<(String, Vec<TestBlock>), ModelError> {
    let names: Vec<&str> = rivals
        .laws
        .iter()
        .map(|(family, _)| family.name())
        .collect();
    let alike = collinearity(rivals, trajectories)?;
    let text = format!(
        "{} predict these recordings equally well (collinearity {alike:.3})",
        names.join(" and ")
    );
    let depends = |(family, _): &(Family, Solution)| family.depends_on_control();
    let controlled = rivals.laws.iter().filter(|law| depends(law));
    let mut controlled = controlled.filter_map(|(_, law)| control_of(law, trajectories));
    if let Some(control) = controlled.next() {
        return Ok((format!("{text}: {}", at_two_inputs(&control)), Vec::new()));
    }
    let solutions: Vec<&Solution> = rivals.laws.iter().map(|(_, law)| law).collect();
    let (blocks, apart) = Simulation::new(trajectories, &solutions, law)?.programme()?;
    Ok(if apart < SeparatingPolicy::in_use().enough {
        let text = format!(
            "{text}, and no test that the rig can run tells them apart: the two closest differ by at most {apart:.1} times the \
             noise"
        );
        (text, Vec::new())
    } else {
        let programme: Vec<String> = blocks.iter().map(written).collect();
        let text = format!(
            "{text}: record --blocks {} and trace it; there the two closest differ by {apart:.1} times the noise",
            programme.join(",")
        );
        (text, blocks)
    })
}

/// The control input that a law depends on, with its range in `trajectories`.
fn control_of(law: &Solution, trajectories: &[Trajectory]) -> Option<Control> {
    let place = law
        .terms
        .iter()
        .find_map(|value| value.term.form.input)?
        .place;
    let channels = trajectories.iter().filter_map(|t| t.controls.get(place));
    let channels: Vec<&ControlChannel> = channels.collect();
    let name = channels.first()?.name.clone();
    let values = channels.iter().flat_map(|channel| &channel.values);
    let range = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &value| {
        [low.min(value), high.max(value)]
    });
    Some(Control { name, range })
}

/// The test that distinguishes a force set by an input from a force of the motion: one motion under two inputs.
fn at_two_inputs(control: &Control) -> String {
    let Control {
        name,
        range: [low, high],
    } = control;
    format!(
        "record one motion twice, at a steady {name} of {low} and of {high}, and trace both together"
    )
}

/// The test that would bound effects of these families if `trajectories` do not.
pub(super) fn bounding_test(unbounded: &[Family], trajectories: &[Trajectory]) -> String {
    let names: Vec<&str> = unbounded.iter().map(|family| family.name()).collect();
    let blocks = trajectories
        .iter()
        .flat_map(|trajectory| &trajectory.blocks);
    let (low, high) = blocks.fold((f64::INFINITY, 0.0_f64), |(low, high), block| {
        (low.min(block.frequency), high.max(block.frequency))
    });
    let least = SeparatingPolicy::in_use().below[0];
    let most = SeparatingPolicy::in_use().above[SeparatingPolicy::in_use().above.len() - 1];
    let motion = match low.is_finite() {
        true => format!("motion from {:.2} to {:.1} Hz", least * low, most * high),
        false => "sines of several frequencies".to_owned(),
    };
    format!(
        "these recordings do not bound a parameter of {}: record {motion} at half and at full amplitude, and trace all \
         recordings together",
        names.join(" and of ")
    )
}

/// The smallest cosine between the forces that two rivals add to their common part.
fn collinearity(rivals: &Rivals, trajectories: &[Trajectory]) -> Result<f64, ModelError> {
    let before = rivals.beside.predicted(trajectories)?;
    let added = |law: &Solution| -> Result<Vec<f64>, ModelError> {
        let with = law.predicted(trajectories)?;
        let mut added = Vec::new();
        for (which, trajectory) in trajectories.iter().enumerate() {
            let (with, without) = (&with[which], &before[which]);
            let telling = (0..trajectory.len()).filter(|&i| trajectory.is_telling(i));
            added.extend(telling.map(|i| with[i] - without[i]));
        }
        Ok(added)
    };
    let added: Vec<Vec<f64>> = rivals
        .laws
        .iter()
        .map(|(_, law)| added(law))
        .collect::<Result<_, _>>()?;
    let inner = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut least = 1.0_f64;
    for (number, one) in added.iter().enumerate() {
        for other in &added[..number] {
            least = least.min(inner(one, other) / (inner(one, one) * inner(other, other)).sqrt());
        }
    }
    Ok(least)
}

/// `0.1:2:8`
fn written(block: &TestBlock) -> String {
    format!("{}:{}:{}", block.amplitude, block.frequency, block.cycles)
}

/// The rivals' forces under every block that is tried.
struct Simulation<'s> {
    rivals: &'s [&'s Solution],
    /// The base law of all rivals.
    law: BaseLaw,
    blocks: Vec<TestBlock>,
    /// Of each rival, its force under each block. Every block begins at rest, with as many samples in a cycle as any other: at one rate the
    /// slowest block would have a hundred times as many.
    tests: Vec<Vec<Trajectory>>,
    /// kN
    noise: f64,
}

impl<'s> Simulation<'s> {
    fn new(
        trajectories: &[Trajectory],
        rivals: &'s [&'s Solution],
        law: BaseLaw,
    ) -> Result<Self, ModelError> {
        let blocks = tried(trajectories);
        // Inputs that the rivals have in common are held at their average in the first recording.
        let held = || trajectories.iter().take(1).flat_map(|t| t.controls.iter());
        let still = |block: &TestBlock| {
            let rate = SAMPLES_PER_CYCLE * block.frequency;
            let motion = motion(std::slice::from_ref(block), rate);
            let displacement: Vec<f64> = motion.iter().map(|m| m.displacement).collect();
            let count = displacement.len();
            let none = vec![0.0; count];
            let mut still = Trajectory::new("test", 1.0 / rate, &displacement, none, None, None);
            let held = held().map(|control| ControlChannel {
                name: control.name.clone(),
                values: vec![control.mean(); count],
            });
            still.controls = Arc::new(held.collect());
            still
        };
        let still: Vec<Trajectory> = blocks.iter().map(still).collect();
        let under = |rival: &&Solution| -> Result<Vec<Trajectory>, ModelError> {
            let forces = rival.predicted(&still)?.into_iter().zip(&still);
            let forces = forces.map(|(force, still)| Trajectory {
                force,
                ..still.clone()
            });
            Ok(forces.collect())
        };
        let tests = rivals.iter().map(under).collect::<Result<_, _>>()?;
        let noise = trajectories.iter().map(|t| goal(noise_of(t)) * t.force_rms);
        Ok(Self {
            rivals,
            law,
            blocks,
            tests,
            noise: noise.fold(f64::MIN_POSITIVE, f64::max),
        })
    }

    /// The blocks that distinguish the rivals, and the difference of the nearest two under them as a multiple of the noise. The
    /// first block is close to a recorded one.
    fn programme(&self) -> Result<(Vec<TestBlock>, f64), ModelError> {
        let mut chosen = vec![0];
        let mut apart = 0.0;
        while chosen.len() < MOST_BLOCKS && apart < SeparatingPolicy::in_use().plenty {
            let mut best: Option<(f64, usize)> = None;
            for next in (0..self.blocks.len()).filter(|next| !chosen.contains(next)) {
                let more: Vec<usize> = chosen.iter().copied().chain([next]).collect();
                let nearest = self.nearest(&more)?;
                if best.is_none_or(|(most, _)| nearest > most) {
                    best = Some((nearest, next));
                }
            }
            let Some((nearest, next)) = best.filter(|(nearest, _)| *nearest > apart) else {
                break;
            };
            chosen.push(next);
            apart = nearest;
        }
        let blocks = chosen.into_iter().map(|index| {
            let block = self.blocks[index];
            let cycles = (SeparatingPolicy::in_use().duration * block.frequency)
                .ceil()
                .max(SeparatingPolicy::in_use().fewest_cycles);
            TestBlock {
                cycles: cycles as u32,
                ..block
            }
        });
        Ok((blocks.collect(), apart))
    }

    /// The difference of the nearest two rivals under some of the blocks, as a multiple of the noise. For each pair the larger
    /// difference of the two directions of fitting counts: one may be the limit of the other.
    fn nearest(&self, blocks: &[usize]) -> Result<f64, ModelError> {
        let mut nearest = f64::INFINITY;
        for one in 0..self.rivals.len() {
            for other in 0..one {
                let apart = self.misfit(one, other, blocks)?;
                nearest = nearest.min(apart.max(self.misfit(other, one, blocks)?));
            }
        }
        Ok(nearest)
    }

    /// RMS of the residual when the second rival is fitted to the first one's force, over the noise.
    fn misfit(&self, of: usize, by: usize, blocks: &[usize]) -> Result<f64, ModelError> {
        let tests: Vec<Trajectory> = blocks.iter().map(|&b| self.tests[of][b].clone()).collect();
        let mut nodes: Vec<f64> = blocks.iter().map(|&b| self.blocks[b].amplitude).collect();
        nodes.sort_by(f64::total_cmp);
        nodes.dedup();
        let rows = Rows::gather(&tests, self.law, nodes, SEPARATING_ROWS, |_, _| true);
        let extent = Extent::of(&tests);
        let problem = Problem::new(&rows, &extent, &self.rivals[by].terms());
        let fitted = problem.solve_near(self.rivals[by]);
        let (mut squares, mut count) = (0.0, 0.0);
        for (test, predicted) in tests.iter().zip(fitted.predicted(&tests)?) {
            for sample in (0..test.len()).filter(|&i| test.is_telling(i)) {
                squares += (predicted[sample] - test.force[sample]).powi(2);
                count += 1.0;
            }
        }
        Ok((squares / f64::max(count, 1.0)).sqrt() / self.noise)
    }
}

/// A block near the middle of the recorded ones, then others of its amplitude at lower and higher frequencies, and of its frequency
/// at smaller and larger amplitudes. All are within the limits of the rig, or of the recorded tests.
fn tried(trajectories: &[Trajectory]) -> Vec<TestBlock> {
    let recorded = || trajectories.iter().flat_map(|t| &t.blocks);
    let (slowest, fastest) = recorded().fold((f64::INFINITY, 0.0_f64), |(low, high), block| {
        (low.min(block.frequency), high.max(block.frequency))
    });
    let largest = recorded().fold(0.0_f64, |most, b| most.max(b.amplitude));
    // Rounded as a person would write them.
    let round = |value: f64, step: f64| (value / step).round() * step;
    let frequency = |value: f64| {
        let [low, high] = SeparatingPolicy::in_use().frequencies;
        (round(value.clamp(low, high), 0.05) * 1e3).round() / 1e3
    };
    // To two digits.
    let amplitude = |value: f64| {
        let value = value.min(SeparatingPolicy::in_use().largest_amplitude.max(largest));
        let step = 10f64.powf(value.log10().floor() - 1.0);
        format!("{:.9}", round(value, step))
            .parse()
            .unwrap_or(value)
    };
    let frequencies = SeparatingPolicy::in_use()
        .below
        .map(|part| part * slowest)
        .into_iter()
        .chain(
            SeparatingPolicy::in_use()
                .above
                .map(|times| times * fastest),
        );
    let middle = (slowest * fastest).sqrt();
    let first = (largest, middle);
    let of_frequency = frequencies.map(|f| (largest, f));
    let of_amplitude = SeparatingPolicy::in_use()
        .amplitudes
        .map(|times| (times * largest, middle));
    let mut blocks: Vec<TestBlock> = Vec::new();
    for (a, f) in std::iter::once(first)
        .chain(of_frequency)
        .chain(of_amplitude)
    {
        let block = TestBlock::new(amplitude(a), frequency(f), SIMULATED_CYCLES);
        let is_new = |known: &TestBlock| {
            known.amplitude != block.amplitude || known.frequency != block.frequency
        };
        if block.amplitude > 0.0 && blocks.iter().all(is_new) {
            blocks.push(block);
        }
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families::Form;
    use crate::term::{Term, TermValue};

    /// Two laws that explain one recording equally well, one of them through its second input.
    #[test]
    fn an_input_is_told_from_a_motion_by_one_motion_under_two_of_it() {
        let path: Vec<f64> = (0..200).map(|n| 0.1 * (0.1 * f64::from(n)).sin()).collect();
        let mut trajectory = Trajectory::new("test", 0.01, &path, path.clone(), None, None);
        let channel = |name: &str, from: f64| ControlChannel {
            name: name.to_owned(),
            values: (0..200).map(|n| from + 0.005 * f64::from(n)).collect(),
        };
        trajectory.controls = Arc::new(vec![
            channel("pressure_bar", 2.0),
            channel("current_A", 0.5),
        ]);
        let law = |name: &str| {
            let form = Form::named(name).unwrap();
            let term = Term::sought(form, 0.0);
            let value = TermValue {
                term,
                sizes: vec![1.0; 2],
                shapes: vec![0.1, 1.0],
            };
            let solution = Solution {
                law: Vec::new(),
                terms: vec![value],
                search: Vec::new(),
                squares: 0.0,
            };
            (form.family(), solution)
        };
        let by_second = law("control_input_2");
        let found = control_of(&by_second.1, std::slice::from_ref(&trajectory)).unwrap();
        let text = at_two_inputs(&found);
        assert!(
            text.contains("a steady current_A of 0.5 and of 1.495"),
            "{text}"
        );
        assert!(control_of(&law("yielding").1, &[trajectory]).is_none());
    }
}
