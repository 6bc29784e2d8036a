//! Detects recordings that cannot all be of one specimen.

use mesh_damper_output::error::InputError;

use super::Recording;
use crate::faults::FaultsPolicy;
use crate::faults::scale::ScalePolicy;
use crate::faults::sign::work;

crate::numbers! {
    /// Which recordings contradict each other.
    ConsistencyPolicy {
        /// Two recordings have the same motion only if the RMS difference of their displacements is at most this fraction of the larger RMS
        /// displacement.
        same_motion: f64 = 0.02, Convention("a controller repeats a motion to within one per cent");
        /// Two recordings have the same motion only if their displacements also agree about their means: the RMS difference is at most this
        /// fraction of the larger RMS about the mean.
        same_moves: f64 = 0.2, Convention("a fifth: the noise of a displacement that moves is far below that");
        /// Two recordings with the same motion contradict each other if the RMS difference of their forces exceeds this fraction of the
        /// larger RMS force. Noise makes about 0.004, and wear, temperature or run-in a few per cent.
        contradiction: f64 = 0.25, Tuned("the recordings of others");
        /// The limit of `contradiction` for two recordings at different temperatures: only a wrong sign or unit can be recognized there.
        contradiction_between_temperatures: f64 = 0.9, Convention("beyond it the two forces have little in common");
        /// Two recordings are at different temperatures if their mean temperatures differ by more than this, °C.
        same_temperature: f64 = 2.0, Convention("a laboratory keeps its temperature within that");
        /// A control input is the same in two recordings if its mean absolute difference is at most this fraction of the mean of the larger
        /// value. If it is not the same, the forces are not compared.
        same_control: f64 = 0.05, Convention("a source keeps its current within that");
        /// Two recordings are compared only if they have at least this many samples in common, counted from their starts.
        shortest: usize = 50, Convention("fewer are a quarter of a cycle");
        /// A recording dissipates or supplies energy if the work of its force exceeds this fraction of the most that such a force could do
        /// on that path. Two recordings that differ in this contradict each other.
        dissipates: f64 = 0.1, Tuned("the recordings of others");
        /// The work is computed from steps of the displacement over this many samples, so that the noise is small compared with a step.
        stride: usize = 8, Convention("1/25 of a cycle of 5 Hz at 1 kHz");
        /// Two forces have opposite signs if the factor between them is −1 to within this.
        opposite: f64 = 0.1, Convention("a tenth");
        /// Two forces differ by a factor if 1 − r² is below this, with their correlation r. It is the part of the squared force that a
        /// factor does not explain.
        is_factor: f64 = 0.01, Derived("a tenth of the RMS force, squared");
    }
}

/// Comments that declare what was tested.
const DECLARATIONS: [&str; 2] = ["specimen", "device"];

/// Notes about held-out recordings that declare another specimen than the `fitted` ones: whether a law predicts a twin is a fair question.
/// The others must agree with the fitted ones, and among each other, as in [`check_consistency`].
///
/// # Errors
/// As [`check_consistency`].
pub fn check_held_out(
    fitted: &[&Recording],
    held_out: &[&Recording],
) -> Result<Vec<String>, InputError> {
    let mut notes = Vec::new();
    for (index, held) in held_out.iter().enumerate() {
        let others = || fitted.iter().chain(&held_out[..index]);
        match fitted
            .iter()
            .find_map(|other| another_declared(other, held))
        {
            Some(how) => notes.push(format!("{}: {how}; the law is of the latter", held.name)),
            None => {
                let of_one = |other: &&&Recording| another_declared(other, held).is_none();
                for other in others().filter(of_one) {
                    check_forces(other, held)?;
                    check_character(other, held)?;
                }
            }
        }
    }
    Ok(notes)
}

/// Rejects recordings of which two contradict each other. Either they declare different specimens, or under the same motion their
/// forces differ, or under any motion one supplies energy where the other dissipates it, or their units differ.
///
/// Motions are compared from each recording's start over the time that both cover.
///
/// # Errors
/// The later recording of the first such pair, the earlier one, and the difference of the forces.
pub fn check_consistency(recordings: &[&Recording]) -> Result<(), InputError> {
    for (index, later) in recordings.iter().enumerate() {
        for earlier in &recordings[..index] {
            check_declarations(earlier, later)?;
            check_forces(earlier, later)?;
            check_character(earlier, later)?;
        }
    }
    Ok(())
}

/// Rejects a pair of which one dissipates energy and the other supplies it, or whose ratios of force to displacement differ by a
/// unit, whatever their motions.
fn check_character(earlier: &Recording, later: &Recording) -> Result<(), InputError> {
    let (a, b) = (Character::of(earlier), Character::of(later));
    if a.dissipation.min(b.dissipation) < -ConsistencyPolicy::in_use().dissipates
        && a.dissipation.max(b.dissipation) > ConsistencyPolicy::in_use().dissipates
    {
        let giving = if a.dissipation < 0.0 { earlier } else { later };
        return Err(InputError::new(
            &later.name,
            format!(
                "compared with {}: {} delivers energy and the other dissipates it",
                earlier.name, giving.name
            ),
            "reverse the sign of its force channel",
        ));
    }
    let factor = b.stiffness / a.stiffness;
    if !(1.0 / ScalePolicy::in_use().unit_apart..=ScalePolicy::in_use().unit_apart)
        .contains(&factor)
    {
        return Err(InputError::new(
            &later.name,
            format!(
                "its force per displacement is {factor:.3e} times that of {}",
                earlier.name
            ),
            "check the units of displacement and force, or drop one of the two if they are of different specimens",
        ));
    }
    Ok(())
}

/// Rough properties of a specimen that stay from one motion to another.
struct Character {
    /// Work done on the specimen divided by the most that such a force could do on such a path, −1…1.
    dissipation: f64,
    /// RMS of the force divided by RMS of the displacement, about their means; kN/mm.
    stiffness: f64,
}

impl Character {
    fn of(recording: &Recording) -> Self {
        let about_mean = |values: &[f64]| -> Vec<f64> {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            values.iter().map(|value| value - mean).collect()
        };
        let (y, f) = (
            about_mean(&recording.displacement),
            about_mean(&recording.force),
        );
        let stride = ConsistencyPolicy::in_use().stride;
        let [work, most] = work(&y, &f, 0..y.len(), stride);
        let rms = |values: &[f64]| {
            (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
        };
        Self {
            dissipation: if most > 0.0 { work / most } else { 0.0 },
            stiffness: rms(&f) / rms(&y),
        }
    }
}

fn check_declarations(earlier: &Recording, later: &Recording) -> Result<(), InputError> {
    match another_declared(earlier, later) {
        Some(how) => Err(InputError::new(
            &later.name,
            how,
            "give recordings of one specimen at a time, hold those of another out, or correct the comment",
        )),
        None => Ok(()),
    }
}

/// How the later recording's comments declare another specimen than those of the earlier one, if they do.
fn another_declared(earlier: &Recording, later: &Recording) -> Option<String> {
    DECLARATIONS.iter().find_map(|key| {
        let (a, b) = (earlier.declared(key)?, later.declared(key)?);
        (a != b).then(|| {
            format!(
                "its comments declare the {key} \"{b}\" where {} declares \"{a}\"",
                earlier.name
            )
        })
    })
}

fn check_forces(earlier: &Recording, later: &Recording) -> Result<(), InputError> {
    // A control input may change a force by any factor.
    if are_controlled_otherwise(earlier, later) {
        return Ok(());
    }
    let Some(pairs) = common_stretch(earlier, later) else {
        return Ok(());
    };
    // About the means: on a plateau with which both begin, only noise moves, and the earlier motion is unknown.
    let mean_of = |of: fn(&(f64, f64)) -> f64| -> f64 {
        pairs.iter().map(|pair| of(&pair.displacement)).sum::<f64>() / pairs.len() as f64
    };
    let (a, b) = (mean_of(|pair| pair.0), mean_of(|pair| pair.1));
    let about = pairs
        .iter()
        .map(|pair| (pair.displacement.0 - a, pair.displacement.1 - b));
    let moved = sum_of_squares(about.clone().map(|(a, _)| a)) / pairs.len() as f64;
    let stands = moved.sqrt() <= FaultsPolicy::in_use().same_value * a.abs();
    if difference(pairs.iter().map(|pair| pair.displacement))
        > ConsistencyPolicy::in_use().same_motion
        || stands
        || difference(about) > ConsistencyPolicy::in_use().same_moves
    {
        return Ok(());
    }
    let allowed = match (mean(&earlier.temperature), mean(&later.temperature)) {
        (Some(a), Some(b)) if (a - b).abs() > ConsistencyPolicy::in_use().same_temperature => {
            ConsistencyPolicy::in_use().contradiction_between_temperatures
        }
        _ => ConsistencyPolicy::in_use().contradiction,
    };
    let apart = difference(pairs.iter().map(|pair| pair.force));
    if apart <= allowed {
        return Ok(());
    }
    let factor = scale_between(pairs.iter().map(|pair| pair.force));
    let (how, remedy) = match factor {
        Some(factor) if (factor + 1.0).abs() < ConsistencyPolicy::in_use().opposite => (
            "its force has the opposite sign".to_owned(),
            "reverse the sign of one force channel, or drop one of the two",
        ),
        Some(factor) => (
            format!("its force is {factor:.4} times as large"),
            "check the unit of the force, add a column for what was set differently, such as current_A or slider_mm, or drop one of the \
             two if they are of different specimens",
        ),
        None => (
            format!("its force differs by {:.0} % RMS", 100.0 * apart),
            "drop the recording of another specimen",
        ),
    };
    Err(InputError::new(
        &later.name,
        format!("contradicts {}: under the same motion {how}", earlier.name),
        remedy,
    ))
}

/// Whether a control input in both differs.
fn are_controlled_otherwise(earlier: &Recording, later: &Recording) -> bool {
    earlier.controls.iter().any(|before| {
        let mut controls = later.controls.iter();
        let after = controls.find(|each| each.name == before.name);
        after.is_some_and(|after| {
            let pairs = || before.values.iter().zip(&after.values);
            let apart: f64 = pairs().map(|(a, b)| (a - b).abs()).sum();
            let size: f64 = pairs().map(|(a, b)| a.abs().max(b.abs())).sum();
            apart > ConsistencyPolicy::in_use().same_control * size
        })
    })
}

/// The two recordings at one time.
struct Pair {
    displacement: (f64, f64),
    force: (f64, f64),
}

/// The earlier recording's samples with the later one's values at the same time from its start.
fn common_stretch(earlier: &Recording, later: &Recording) -> Option<Vec<Pair>> {
    let mut after = 1;
    let mut pairs = Vec::new();
    for index in 0..earlier.len() {
        let time = earlier.time[index] - earlier.time[0] + later.time[0];
        while after < later.len() && later.time[after] < time {
            after += 1;
        }
        if after == later.len() {
            break;
        }
        let before = after - 1;
        let width = later.time[after] - later.time[before];
        let u = ((time - later.time[before]) / width).clamp(0.0, 1.0);
        let at = |values: &[f64]| values[before] + u * (values[after] - values[before]);
        pairs.push(Pair {
            displacement: (earlier.displacement[index], at(&later.displacement)),
            force: (earlier.force[index], at(&later.force)),
        });
    }
    (pairs.len() >= ConsistencyPolicy::in_use().shortest).then_some(pairs)
}

fn sum_of_squares(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|value| value * value).sum()
}

/// RMS of the difference divided by the RMS of the larger of the two, 0…2.
fn difference(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let apart = sum_of_squares(pairs.clone().map(|(a, b)| a - b));
    let first = sum_of_squares(pairs.clone().map(|(a, _)| a));
    let second = sum_of_squares(pairs.map(|(_, b)| b));
    let larger = first.max(second);
    if larger > 0.0 {
        (apart / larger).sqrt()
    } else {
        0.0
    }
}

/// The factor from the second values to the first, if it describes them to within a tenth.
fn scale_between(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> Option<f64> {
    let product: f64 = pairs.clone().map(|(a, b)| a * b).sum();
    let first = sum_of_squares(pairs.clone().map(|(a, _)| a));
    let second = sum_of_squares(pairs.map(|(_, b)| b));
    let correlation = product / (first * second).sqrt();
    // sin of the angle between them is the part that a factor cannot explain.
    (1.0 - correlation * correlation < ConsistencyPolicy::in_use().is_factor)
        .then_some(product / first)
}

fn mean(values: &Option<Vec<f64>>) -> Option<f64> {
    let values = values.as_deref()?;
    Some(values.iter().sum::<f64>() / values.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn recording(name: &str, amplitude: f64, force: impl Fn(f64) -> f64) -> Recording {
        let time: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.002).collect();
        let displacement: Vec<f64> = time.iter().map(|t| amplitude * (TAU * t).sin()).collect();
        let force = displacement.iter().map(|&y| force(y)).collect();
        Recording::new(name, time, displacement, force).unwrap()
    }

    #[test]
    fn the_same_motion_with_another_force_is_refused() {
        let original = recording("a", 0.1, |y| 2.0 * y);
        for (force, said) in [
            (-2.0, "opposite sign"),
            (2000.0, "1000.0000 times"),
            (3.0, "1.5000 times"),
        ] {
            let other = recording("b", 0.1, |y| force * y);
            let error = check_consistency(&[&original, &other]).unwrap_err();
            assert!(error.to_string().contains(said), "{error}");
        }
        let cubic = recording("b", 0.1, |y| if y > 0.05 { 4.0 * y } else { 2.0 * y });
        let error = check_consistency(&[&original, &cubic]).unwrap_err();
        assert!(error.to_string().contains("% RMS"), "{error}");
    }

    #[test]
    fn another_motion_a_change_of_a_few_per_cent_or_another_temperature_is_not() {
        let original = recording("a", 0.1, |y| 2.0 * y);
        let worn = recording("b", 0.1, |y| 1.9 * y);
        let larger = recording("c", 0.2, |y| -2.0 * y);
        check_consistency(&[&original, &worn, &larger]).unwrap();
        let at = |recording: Recording, temperature| {
            recording.with_temperature(vec![temperature; 1000]).unwrap()
        };
        let cold = at(original, 20.0);
        let warm = at(recording("d", 0.1, |y| 1.2 * y), 80.0);
        check_consistency(&[&cold, &warm]).unwrap();
        let turned = at(recording("e", 0.1, |y| -1.2 * y), 80.0);
        check_consistency(&[&cold, &turned]).unwrap_err();
    }

    /// A plateau does not show how it was reached: a relaxing force differs each time.
    #[test]
    fn a_common_plateau_is_no_common_motion() {
        let on_plateau = |name: &str, force: f64, noise: f64, seed: usize| {
            let time: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.002).collect();
            let rough = |i: usize| f64::from((i * 7_919 % 1_000) as u32) / 1_000.0 - 0.5;
            let y = (0..1000).map(|i| 5.0 + noise * rough(i + seed)).collect();
            Recording::new(name, time, y, vec![force; 1000]).unwrap()
        };
        for noise in [1e-9, 1e-3] {
            let loaded = on_plateau("loaded", 1.0, noise, 5);
            let relaxed = on_plateau("relaxed", 0.6, noise, 8);
            assert!(check_forces(&loaded, &relaxed).is_ok(), "{noise}");
        }
    }

    #[test]
    fn another_declared_specimen_is_named() {
        let a = recording("a", 0.1, |y| y).with_comment("specimen: ring 3");
        let b = recording("b", 0.2, |y| y).with_comment("Specimen:  ring 4");
        let error = check_consistency(&[&a, &b]).unwrap_err().to_string();
        assert!(
            error.contains("ring 3") && error.contains("ring 4"),
            "{error}"
        );
    }

    /// A twin may be held out, even one whose force differs; a recording that declares nothing must agree.
    #[test]
    fn another_specimen_that_is_held_out_is_said() {
        let a = recording("a", 0.1, |y| y).with_comment("specimen: ring 3");
        let twin = recording("b", 0.1, |y| 1.5 * y).with_comment("specimen: ring 4");
        let notes = check_held_out(&[&a], &[&twin]).unwrap();
        assert_eq!(notes.len(), 1, "{notes:?}");
        assert!(notes[0].starts_with("b: ") && notes[0].contains("ring 4"));
        let same = recording("c", 0.1, |y| 1.01 * y).with_comment("specimen: ring 3");
        assert_eq!(check_held_out(&[&a], &[&same]).unwrap(), [""; 0]);
        let unknown = recording("d", 0.1, |y| 1.5 * y);
        assert!(check_held_out(&[&a], &[&unknown]).is_err());
    }
}
