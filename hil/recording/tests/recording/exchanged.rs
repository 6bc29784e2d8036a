//! Displacement and force in each other's columns, and recordings that only look so. Specimen, motion and noise are drawn by a seed.

use std::f64::consts::TAU;
use std::path::Path;

use mesh_damper_recording::Recording;
use rand::rngs::StdRng;
use rand::{RngExt as _, SeedableRng as _};
use rand_distr::{Distribution as _, Normal};

/// s
const TICK: f64 = 2e-3;

/// F = k·y + c·v + a slider, kN, mm, s.
#[derive(Clone, Copy)]
struct Specimen {
    stiffness: f64,
    damping: f64,
    /// Stiffness in kN/mm and slip limit in mm.
    slider: (f64, f64),
}

impl Specimen {
    fn drawn(random: &mut StdRng, has_friction: bool) -> Self {
        let stiffness = random.random_range(0.3..3.0);
        Self {
            stiffness,
            damping: stiffness * random.random_range(5e-3..2e-2),
            slider: (
                if has_friction {
                    stiffness * random.random_range(0.8..2.0)
                } else {
                    0.0
                },
                random.random_range(0.02..0.06),
            ),
        }
    }

    /// The force at `y` and `v` beside the slider's anchor, which follows.
    fn force(&self, y: f64, v: f64, anchor: &mut f64) -> f64 {
        let (stiffness, limit) = self.slider;
        *anchor = anchor.clamp(y - limit, y + limit);
        self.stiffness * y + self.damping * v + stiffness * (y - *anchor)
    }
}

/// Displacements, velocities and forces of a test, as measured.
struct Test {
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    force: Vec<f64>,
}

/// The sines of a test: amplitude and angular frequency 1/s, and the time since the sine began, s.
fn sines(random: &mut StdRng) -> Vec<(f64, f64, f64)> {
    let mut samples = Vec::new();
    for _ in 0..random.random_range(2..5) {
        let (size, frequency) = (random.random_range(0.1..0.8), random.random_range(0.8..6.0));
        let count = (random.random_range(5..9) as f64 / frequency / TICK).round() as usize;
        samples.extend((0..count).map(|n| (size, TAU * frequency, n as f64 * TICK)));
    }
    samples
}

impl Test {
    /// A test that moves `specimen`.
    fn moving(specimen: Specimen, random: &mut StdRng) -> Self {
        let mut anchor = 0.0;
        let all = sines(random).into_iter().map(|(size, omega, now)| {
            let (sin, cos) = (omega * now).sin_cos();
            let (y, v) = (size * sin, size * omega * cos);
            (y, v, specimen.force(y, v, &mut anchor))
        });
        Self::measured(all.collect(), [1e-4, 1e-3, 1e-2], random)
    }

    /// A test that pushes `specimen` by sines, which then moves as it likes.
    fn pushing(specimen: Specimen, random: &mut StdRng) -> Self {
        let (mut y, mut anchor) = (0.0, 0.0);
        let all = sines(random).into_iter().map(|(size, omega, now)| {
            let force = size * specimen.stiffness * (omega * now).sin();
            let before = y;
            let rate = |y: f64| (y - before) / TICK;
            let (mut low, mut high) = (before - 1.0, before + 1.0);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                match specimen.force(middle, rate(middle), &mut anchor.clone()) < force {
                    true => low = middle,
                    false => high = middle,
                }
            }
            y = low;
            (y, rate(y), specimen.force(y, rate(y), &mut anchor))
        });
        Self::measured(all.collect(), [1e-4, 1e-3, 1e-2], random)
    }

    /// With noise of these deviations, mm, mm/s, kN relative to 1 kN/mm.
    fn measured(all: Vec<(f64, f64, f64)>, noise: [f64; 3], random: &mut StdRng) -> Self {
        let mut noisy = |value: f64, deviation: f64| {
            value + Normal::new(0.0, deviation).unwrap().sample(random)
        };
        Self {
            displacement: all.iter().map(|one| noisy(one.0, noise[0])).collect(),
            velocity: all.iter().map(|one| noisy(one.1, noise[2])).collect(),
            force: all.iter().map(|one| noisy(one.2, noise[1])).collect(),
        }
    }

    /// With these columns of displacement, force in a unit given in kN, and velocity, in CSV and in MAT.
    fn read(
        &self,
        [displacement, force]: [&[f64]; 2],
        unit: &str,
        has_velocity: bool,
    ) -> Vec<Recording> {
        let time: Vec<f64> = (0..displacement.len()).map(|n| n as f64 * TICK).collect();
        let force_name = format!("force_{unit}");
        let mut columns = vec![
            ("time_s", time),
            ("displacement_mm", displacement.to_vec()),
            (force_name.as_str(), force.to_vec()),
        ];
        if has_velocity {
            columns.push(("velocity_mm_s", self.velocity.clone()));
        }
        let names: Vec<&str> = columns.iter().map(|column| column.0).collect();
        let mut text = names.join(",") + "\n";
        for n in 0..displacement.len() {
            let cells: Vec<String> = columns
                .iter()
                .map(|column| format!("{:.7}", column.1[n]))
                .collect();
            text += &(cells.join(",") + "\n");
        }
        let mut read = vec![Recording::from_bytes(Path::new("a.csv"), text.into_bytes()).unwrap()];
        if cfg!(feature = "formats") {
            let name = Path::new("a.mat");
            let bytes = mesh_damper_tables::write::table(name, &[], &columns).unwrap();
            read.push(Recording::from_bytes(name, bytes).unwrap());
        }
        read
    }

    fn as_it_is(&self, has_velocity: bool) -> Vec<Recording> {
        self.read([&self.displacement, &self.force], "kN", has_velocity)
    }

    /// Displacement in the column of the force, which is in N or kN, and the other way round.
    fn exchanged(&self, unit: &str, has_velocity: bool) -> Vec<Recording> {
        let factor = if unit == "N" { 1e3 } else { 1.0 };
        let force: Vec<f64> = self.force.iter().map(|force| force * factor).collect();
        self.read([&force, &self.displacement], unit, has_velocity)
    }
}

fn said(recording: &Recording) -> String {
    let repaired = recording.repaired();
    let each = repaired.faults().iter().map(ToString::to_string);
    each.collect::<Vec<_>>().join("; ")
}

#[test]
fn exchanged_channels_are_exchanged_back() {
    for seed in 0..16 {
        let mut random = StdRng::seed_from_u64(seed);
        let has_friction = seed % 2 == 0;
        let specimen = Specimen::drawn(&mut random, has_friction);
        let test = Test::moving(specimen, &mut random);
        let unit = if seed % 4 < 2 { "kN" } else { "N" };
        // Without friction only a velocity shows it.
        for recording in test.exchanged(unit, !has_friction) {
            let what = format!("seed {seed}, {}: {}", recording.name, said(&recording));
            assert!(what.contains("they were exchanged back"), "{what}");
            let repaired = recording.repaired();
            assert_eq!(repaired.faults().len(), 1, "{what}");
            for (found, truth) in [
                (&repaired.displacement, &test.displacement),
                (&repaired.force, &test.force),
            ] {
                let mut pairs = found.iter().zip(truth);
                assert!(
                    pairs.all(|(found, truth)| (found - truth).abs() < 1e-6),
                    "{what}"
                );
            }
        }
    }
}

/// A linear specimen with a late force looks the same, so that nothing is changed.
#[test]
fn channels_that_may_be_exchanged_are_said() {
    for seed in 0..8 {
        let mut random = StdRng::seed_from_u64(seed);
        let specimen = Specimen::drawn(&mut random, false);
        let test = Test::moving(specimen, &mut random);
        for recording in test.exchanged("kN", false) {
            let what = format!("seed {seed}, {}: {}", recording.name, said(&recording));
            assert!(
                what.contains("may be exchanged, or the force is late"),
                "{what}"
            );
            assert_eq!(
                recording.repaired().displacement,
                recording.displacement,
                "{what}"
            );
        }
    }
}

#[test]
fn channels_in_their_places_stay_there() {
    for seed in 0..40 {
        let mut random = StdRng::seed_from_u64(100 + seed);
        let specimen = Specimen::drawn(&mut random, seed % 2 == 0);
        let mut test = match seed % 4 {
            0 | 1 => Test::moving(specimen, &mut random),
            _ => Test::pushing(specimen, &mut random),
        };
        // A displacement whose steps hide its rate, beside a velocity.
        let is_coarse = seed % 3 == 0;
        if is_coarse {
            test.displacement
                .iter_mut()
                .for_each(|y| *y = (*y / 5e-3).round() * 5e-3);
        }
        for recording in test.as_it_is(is_coarse) {
            assert_eq!(said(&recording), "", "seed {seed}, {}", recording.name);
        }
    }
}

/// A force with the corners of friction is no motion, however late.
#[test]
fn a_late_force_is_no_displacement() {
    for seed in 0..8 {
        let mut random = StdRng::seed_from_u64(200 + seed);
        let specimen = Specimen::drawn(&mut random, true);
        let mut test = Test::moving(specimen, &mut random);
        test.force.rotate_right(random.random_range(20..60));
        for recording in test.as_it_is(false) {
            assert!(
                !said(&recording).contains("exchanged"),
                "seed {seed}: {}",
                said(&recording)
            );
        }
    }
}
