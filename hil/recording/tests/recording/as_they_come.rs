//! Recordings as laboratories bring them: each is a known law under a known motion, spoilt at places and by amounts that a seed draws.
//! Stiffness and damping after the repair are compared with the law's.

use std::f64::consts::TAU;
use std::path::Path;

use mesh_damper_recording::Recording;
use mesh_damper_recording::trajectory::Trajectory;
use rand::rngs::StdRng;
use rand::{RngExt as _, SeedableRng as _};
use rand_distr::{Distribution as _, Normal};

/// F = k·y + c·v, kN, mm, s.
const STIFFNESS: f64 = 2.0;
const DAMPING: f64 = 0.05;
/// Standard deviation of the force's noise, kN.
const NOISE: f64 = 0.002;

/// Times, displacements and forces of a test, as measured.
#[derive(Clone)]
struct Test {
    time: Vec<f64>,
    displacement: Vec<f64>,
    force: Vec<f64>,
}

impl Test {
    /// At these times, s.
    fn at(time: Vec<f64>, seed: u64) -> Self {
        let mut random = StdRng::seed_from_u64(seed);
        let normal = Normal::new(0.0, 1.0).unwrap();
        let phases = [0; 3].map(|_| TAU * random.random::<f64>());
        let tones = [(0.8, 0.35), (0.5, 0.9), (0.2, 1.7)];
        let (mut displacement, mut force) = (Vec::new(), Vec::new());
        for now in &time {
            let (mut y, mut v) = (0.0, 0.0);
            for ((size, frequency), phase) in tones.iter().zip(phases) {
                let turn = TAU * frequency * now + phase;
                y += size * turn.sin();
                v += size * TAU * frequency * turn.cos();
            }
            displacement.push(y + 1e-4 * normal.sample(&mut random));
            force.push(STIFFNESS * y + DAMPING * v + NOISE * normal.sample(&mut random));
        }
        Self {
            time,
            displacement,
            force,
        }
    }

    fn steady(rate: f64, count: usize, seed: u64) -> Self {
        Self::at((0..count).map(|n| n as f64 / rate).collect(), seed)
    }

    fn csv(&self, decimals: usize) -> String {
        let cell = |value: f64| match value.is_nan() {
            true => String::new(),
            false => format!("{value:.6}"),
        };
        let rows = (0..self.time.len()).map(|n| {
            let (y, f) = (cell(self.displacement[n]), cell(self.force[n]));
            format!("{:.decimals$},{y},{f}\n", self.time[n])
        });
        "time_s,displacement_mm,force_kN\n".to_owned() + &rows.collect::<String>()
    }

    /// The recording in a text with this many decimals of time, and with the times so rounded in MAT.
    fn read(&self, decimals: usize) -> Vec<Recording> {
        let text = self.csv(decimals).into_bytes();
        let mut read = vec![Recording::from_bytes(Path::new("a.csv"), text).unwrap()];
        // MAT has no empty cells.
        let mut all = self.displacement.iter().chain(&self.force);
        if cfg!(feature = "formats") && all.all(|value| value.is_finite()) {
            let rounded = |time: &f64| -> f64 { format!("{time:.decimals$}").parse().unwrap() };
            let columns = [
                ("time_s", self.time.iter().map(rounded).collect()),
                ("displacement_mm", self.displacement.clone()),
                ("force_kN", self.force.clone()),
            ];
            let name = Path::new("a.mat");
            let bytes = mesh_damper_tables::write::table(name, &[], &columns).unwrap();
            read.push(Recording::from_bytes(name, bytes).unwrap());
        }
        read
    }
}

/// All faults that are found on the way to the fit, and stiffness and damping by least squares over the samples that are used.
fn law(recording: &Recording) -> (String, [f64; 2]) {
    let trajectory = Trajectory::of(recording).unwrap();
    let mut gram = [0.0; 3];
    let mut right = [0.0; 2];
    for n in (0..trajectory.len()).filter(|&n| trajectory.measured[n]) {
        let (y, v) = (
            trajectory.motion.displacement[n],
            trajectory.motion.velocity[n],
        );
        let f = trajectory.force[n];
        gram = [gram[0] + y * y, gram[1] + y * v, gram[2] + v * v];
        right = [right[0] + y * f, right[1] + v * f];
    }
    let determinant = gram[0] * gram[2] - gram[1] * gram[1];
    let k = (right[0] * gram[2] - right[1] * gram[1]) / determinant;
    let c = (right[1] * gram[0] - right[0] * gram[1]) / determinant;
    let each = trajectory.faults.iter().map(ToString::to_string);
    (each.collect::<Vec<_>>().join("; "), [k, c])
}

/// `recording` has the law, to within `off` relative to the stiffness and to the damping, and `said` of it is said, or nothing.
fn is_right(what: &str, recording: &Recording, said: &[&str], off: [f64; 2]) {
    let (faults, [k, c]) = law(recording);
    let what = format!("{what}, {}: k {k}, c {c}, {faults:?}", recording.name);
    assert!((k / STIFFNESS - 1.0).abs() < off[0], "{what}");
    assert!((c / DAMPING - 1.0).abs() < off[1], "{what}");
    for said in said {
        assert!(faults.contains(said), "{what}");
    }
    if said.is_empty() {
        assert_eq!(faults, "", "{what}");
    }
}

const NEAR: [f64; 2] = [0.005, 0.05];

#[test]
fn a_rate_that_its_rounded_times_hide_is_found() {
    let mut random = StdRng::seed_from_u64(11);
    // Rate, Hz, and decimals of the times.
    let mut cases = vec![
        (75.0, 2),
        (80.0, 2),
        (128.0, 2),
        (800.0, 3),
        (960.0, 3),
        (64.0, 2),
        (1024.0, 3),
    ];
    cases.extend((0..12).map(|_| (random.random_range(35.0..300.0_f64), 2)));
    for (case, (rate, decimals)) in cases.into_iter().enumerate() {
        let test = Test::steady(rate, 6000, case as u64);
        for recording in test.read(decimals) {
            let found = 1.0 / recording.sample_period();
            assert!((found / rate - 1.0).abs() < 1e-4, "{found} for {rate} Hz");
            assert_eq!(recording.gaps(), [], "{rate} Hz");
            let said: &[&str] = if rate > 105.0 && decimals == 2 || rate > 1000.0 {
                &["share a time"]
            } else {
                &[]
            };
            is_right(&format!("{rate} Hz"), &recording, said, NEAR);
        }
    }
}

/// With samples missing here and there, and a pause that is no whole number of steps.
#[test]
fn missing_samples_of_a_rounded_clock_are_counted() {
    let mut random = StdRng::seed_from_u64(12);
    for (rate, decimals) in [(100.0, 2), (80.0, 2), (75.0, 2), (80.0, 3), (250.0, 3)] {
        let whole = Test::steady(rate, 8000, 5);
        let lost: Vec<usize> = (0..9).map(|_| random.random_range(100..7900)).collect();
        let kept = |n: &usize| !lost.contains(n) && !(4000..4400).contains(n);
        let rows: Vec<usize> = (0..8000).filter(kept).collect();
        let of = |values: &[f64]| rows.iter().map(|&n| values[n]).collect();
        let test = Test {
            time: of(&whole.time),
            displacement: of(&whole.displacement),
            force: of(&whole.force),
        };
        for recording in test.read(decimals) {
            let missing: usize = recording.gaps().iter().map(|gap| gap.1).sum();
            assert_eq!(missing, 8000 - rows.len(), "{rate} Hz");
            is_right(
                &format!("{rate} Hz"),
                &recording,
                &["missing samples"],
                NEAR,
            );
        }
    }
}

fn date(seconds: f64, decimals: usize) -> String {
    let whole = seconds.floor();
    let part = format!("{:.decimals$}", seconds - whole);
    let whole = whole as u64;
    let (h, m, s) = (whole / 3600, whole / 60 % 60, whole % 60);
    format!("2026-10-25 {h:02}:{m:02}:{s:02}{}", &part[1..])
}

#[test]
fn dates_pass_into_summer_time_and_out_of_it() {
    for (seed, set) in [(1, 3600.0), (2, -3600.0)] {
        let test = Test::steady(20.0, 4000, seed);
        let change = StdRng::seed_from_u64(seed).random_range(500..3500);
        let rows: String = (0..4000)
            .map(|n| {
                let shown = 9000.0 + test.time[n] + if n < change { 0.0 } else { set };
                format!(
                    "{};{:.6};{:.6}\n",
                    date(shown, 3),
                    test.displacement[n],
                    test.force[n]
                )
            })
            .collect();
        let text = format!("Timestamp;Disp [mm];Force [kN]\n{rows}");
        let recording = Recording::from_bytes(Path::new("a.csv"), text.into()).unwrap();
        is_right("summer time", &recording, &["the clock was put"], NEAR);
    }
}

#[test]
fn stamps_of_whole_seconds_are_spread() {
    for (seed, rate) in [(1, 20.0), (2, 37.0), (3, 50.0)] {
        let mut test = Test::steady(rate, 4000, seed);
        let rows: String = (0..4000)
            .map(|n| {
                format!(
                    "{};{:.6};{:.6}\n",
                    date((test.time[n] + 36_000.4).floor(), 0),
                    test.displacement[n],
                    test.force[n]
                )
            })
            .collect();
        let text = format!("Timestamp;Disp [mm];Force [kN]\n{rows}");
        let dates = Recording::from_bytes(Path::new("a.csv"), text.into()).unwrap();
        test.time
            .iter_mut()
            .for_each(|time| *time = (*time + 0.7).floor());
        for recording in test.read(0).iter().chain([&dates]) {
            is_right(
                &format!("{rate} Hz"),
                recording,
                &["share a time"],
                [0.01, 0.08],
            );
        }
    }
}

#[test]
fn a_counter_of_time_goes_on() {
    for (seed, range) in [(1, 65.536), (2, 4_294.967_296)] {
        let mut test = Test::steady(50.0, 6000, seed);
        let begin = range
            - StdRng::seed_from_u64(seed)
                .random_range(10.0..60.0_f64)
                .round();
        test.time
            .iter_mut()
            .for_each(|time| *time = (*time + begin) % range);
        for recording in test.read(6) {
            is_right(
                "a counter",
                &recording,
                &["the counter of time began again once"],
                NEAR,
            );
        }
    }
}

/// Fast in a ramp and slow in a hold, with steps that grow, or in another step.
#[test]
fn uneven_steps_are_a_fact() {
    for (seed, growth) in [(1, 1.0), (2, 1.03), (3, 1.1)] {
        let (mut time, mut step) = (vec![0.0], 0.002_f64);
        for n in 1..6000 {
            // Fast for 2000 rows, then slower and slower up to 0.012 s, and again.
            let part = n % 3000;
            step = match part {
                0..2000 => 0.002,
                2000 if growth == 1.0 => 0.012,
                _ => (step * growth).min(0.012),
            };
            time.push(time[n - 1] + step);
        }
        let test = Test::at(time, seed);
        for recording in test.read(6) {
            is_right(
                &format!("growth {growth}"),
                &recording,
                &["the steps of time are uneven"],
                [0.01, 0.05],
            );
        }
    }
}

/// In the last rows, in the first ones, about a gap, on either channel.
#[test]
fn a_wrong_value_at_an_end_is_left_out() {
    let mut random = StdRng::seed_from_u64(17);
    for case in 0..24 {
        let mut test = Test::steady(100.0, 3000, case);
        let length = random.random_range(1..4);
        let gap = 1500..1560;
        let last = test.time.len();
        let run = match case % 4 {
            0 => last - length..last,
            1 => 0..length,
            2 => gap.start - length..gap.start,
            _ => gap.end..gap.end + length,
        };
        let size = random.random_range(2.0..9.0) * if random.random() { 1.0 } else { -1.0 };
        let is_force = case % 3 > 0;
        let values = if is_force {
            &mut test.force
        } else {
            &mut test.displacement
        };
        for n in run {
            values[n] = size * 2.0;
        }
        for values in [&mut test.time, &mut test.displacement, &mut test.force] {
            values.drain(gap.clone());
        }
        let channel = if is_force { "force" } else { "displacement" };
        let samples = if length == 1 {
            "1 sample".into()
        } else {
            format!("{length} samples")
        };
        let said = format!("spikes in the {channel}: {samples}");
        for recording in test.read(2) {
            is_right(&format!("case {case}"), &recording, &[&said], NEAR);
        }
    }
}

#[test]
fn closing_rows_of_zeros_are_left_out() {
    for zeros in [1, 3] {
        let mut test = Test::steady(100.0, 2000, zeros);
        for values in [&mut test.time, &mut test.displacement, &mut test.force] {
            values.extend(std::iter::repeat_n(0.0, zeros as usize));
        }
        for recording in test.read(2) {
            is_right("zeros", &recording, &["rows of zeros at the end"], NEAR);
            assert_eq!(recording.len(), 2000);
        }
    }
}

/// Held, interpolated, or empty between the values of a slower converter, at any phase.
#[test]
fn a_slower_force_is_read_where_it_is_new() {
    let mut random = StdRng::seed_from_u64(19);
    for case in 0..18 {
        let whole = Test::steady(400.0, 16_000, case);
        let rows = random.random_range(2..9);
        let phase = random.random_range(0..rows);
        let mut test = whole.clone();
        let how = ["held between", "interpolated between", "empty between"][case as usize % 3];
        let new: Vec<usize> = (phase..16_000).step_by(rows).collect();
        let value = |n: usize| {
            let at = new.partition_point(|row| *row <= n).max(1) - 1;
            let (from, to) = (new[at], *new.get(at + 1).unwrap_or(&new[at]));
            let part = if to > from {
                (n as f64 - from as f64) / (to - from) as f64
            } else {
                0.0
            };
            match case % 3 {
                0 => whole.force[from],
                1 => whole.force[from] + part.max(0.0) * (whole.force[to] - whole.force[from]),
                _ if n == from => whole.force[n],
                _ => f64::NAN,
            }
        };
        test.force = (0..16_000).map(value).collect();
        let what = format!("every {rows} rows from {phase}, {how}");
        for recording in test.read(4) {
            // Two of three rows are needed to say it of empty cells.
            let said: &[&str] = &[how];
            is_right(&what, &recording, said, NEAR);
            let used = Trajectory::of(&recording).unwrap().len() as f64;
            assert!(
                (used / new.len() as f64 - 1.0).abs() < 0.02,
                "{what}: {used}"
            );
        }
    }
}

/// Two loggers in one file: no row has both channels.
#[test]
fn channels_of_two_rates_share_no_row() {
    let [fast, slow] = [(500.0, 10_000), (130.0, 2600)].map(|(rate, count)| {
        let time = (0..count).map(|n| (n as f64 + 0.31) / rate);
        Test::at(time.collect(), 3)
    });
    let mut rows: Vec<(f64, f64, f64)> = Vec::new();
    rows.extend((0..10_000).map(|n| (fast.time[n], fast.displacement[n], f64::NAN)));
    rows.extend((0..2600).map(|n| (slow.time[n], f64::NAN, slow.force[n])));
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let test = Test {
        time: rows.iter().map(|row| row.0).collect(),
        displacement: rows.iter().map(|row| row.1).collect(),
        force: rows.iter().map(|row| row.2).collect(),
    };
    for recording in test.read(7) {
        is_right("two rates", &recording, &["empty between"], NEAR);
        let rate = 1.0 / recording.sample_period();
        assert!((rate / 130.0 - 1.0).abs() < 1e-3, "{rate} Hz");
    }
}

/// A row only where a value changed, in the digits of its converters.
#[test]
fn rows_of_changes_alone_are_filled() {
    for seed in 0..3 {
        let mut test = Test::steady(500.0, 20_000, seed);
        for (values, digit) in [(&mut test.displacement, 0.02), (&mut test.force, 0.05)] {
            values
                .iter_mut()
                .for_each(|value| *value = (*value / digit).round() * digit);
        }
        let changes = |n: &usize| {
            *n == 0
                || test.displacement[*n] != test.displacement[n - 1]
                || test.force[*n] != test.force[n - 1]
        };
        let rows: Vec<usize> = (0..20_000).filter(changes).collect();
        assert!(rows.len() < 15_000, "{}", rows.len());
        let of = |values: &[f64]| rows.iter().map(|&n| values[n]).collect();
        let test = Test {
            time: of(&test.time),
            displacement: of(&test.displacement),
            force: of(&test.force),
        };
        for recording in test.read(3) {
            is_right(
                "changes only",
                &recording,
                &["only where a value changed"],
                [0.01, 0.1],
            );
        }
    }
}

/// Both signs of the force: a counter that begins again looks like a wrong one.
#[test]
fn a_counter_of_displacement_goes_on() {
    for (seed, bits) in [(1, 10), (2, 11), (3, 12)] {
        let mut test = Test::steady(100.0, 4000, seed);
        let resolution = 0.001;
        let range = resolution * f64::from(1 << bits);
        let zero = StdRng::seed_from_u64(seed).random_range(-0.4..0.4) * range;
        for y in &mut test.displacement {
            let counted = ((*y + zero) / resolution).round() * resolution;
            *y = (counted + 0.5 * range).rem_euclid(range) - 0.5 * range;
        }
        for recording in test.read(2) {
            let jumps = recording
                .displacement
                .windows(2)
                .any(|pair| (pair[1] - pair[0]).abs() > 0.5 * range);
            let said: &[&str] = if jumps {
                &["the counter of the displacement"]
            } else {
                &[]
            };
            let (faults, _) = law(&recording);
            assert!(!faults.contains("sign"), "{faults}");
            for said in said {
                assert!(faults.contains(said), "{bits} bits: {faults}");
            }
            let repaired = recording.repaired();
            let off = repaired.displacement[0] - Test::steady(100.0, 4000, seed).displacement[0];
            let truth = Test::steady(100.0, 4000, seed).displacement;
            let far = repaired
                .displacement
                .iter()
                .zip(&truth)
                .map(|(y, truth)| (y - truth - off).abs());
            assert!(far.fold(0.0, f64::max) < 2.0 * resolution, "{bits} bits");
        }
    }
}

#[test]
fn an_empty_cell_of_a_channel_that_is_not_needed_refuses_nothing() {
    let test = Test::steady(100.0, 2000, 4);
    for blank in ["", "NaN", "#N/A"] {
        let rows: String = (0..2000)
            .map(|n| {
                let [velocity, temperature] = [700, 900].map(|empty| match n == empty {
                    true => blank.to_owned(),
                    false => "21.5".to_owned(),
                });
                let force = if n == 300 {
                    blank.to_owned()
                } else {
                    format!("{:.6}", test.force[n])
                };
                format!(
                    "{:.2},{:.6},{force},{velocity},{temperature}\n",
                    test.time[n], test.displacement[n]
                )
            })
            .collect();
        let names = "time_s,displacement_mm,force_kN,velocity_mm_s,temperature_degC";
        let recording =
            Recording::from_bytes(Path::new("a.csv"), format!("{names}\n{rows}").into()).unwrap();
        assert_eq!(recording.len(), 1999);
        assert_eq!(recording.temperature.as_ref().unwrap()[899], 21.5);
        let said = [
            "the velocity is empty in 1 row",
            "the temperature is empty in 1 row",
        ];
        is_right(&format!("{blank:?}"), &recording, &said, NEAR);
    }
}

/// Nothing is found where nothing is.
#[test]
fn a_clean_recording_is_not_changed() {
    let mut random = StdRng::seed_from_u64(23);
    for seed in 0..60 {
        let rate = random.random_range(30.0..1000.0);
        let test = Test::steady(rate, 3000, seed);
        let text = test.csv(6).into_bytes();
        let recording = Recording::from_bytes(Path::new("a.csv"), text).unwrap();
        is_right(&format!("{rate} Hz"), &recording, &[], [0.02, 0.2]);
    }
}

/// A segment of TDMS with both channels, and their step as a property.
#[cfg(feature = "formats")]
fn segment(step: f64, channels: [&[f64]; 2]) -> Vec<u8> {
    let text = |to: &mut Vec<u8>, text: &str| {
        to.extend((text.len() as u32).to_le_bytes());
        to.extend(text.as_bytes());
    };
    let mut objects = 2_u32.to_le_bytes().to_vec();
    let mut raw = Vec::new();
    let names = [("Displacement", "mm"), ("Force", "kN")];
    for ((name, unit), values) in names.into_iter().zip(channels) {
        text(&mut objects, &format!("/'Rig'/'{name}'"));
        // Doubles in one dimension.
        for word in [20_u32, 10, 1] {
            objects.extend(word.to_le_bytes());
        }
        objects.extend((values.len() as u64).to_le_bytes());
        objects.extend(2_u32.to_le_bytes());
        text(&mut objects, "wf_increment");
        objects.extend(10_u32.to_le_bytes());
        objects.extend(step.to_le_bytes());
        text(&mut objects, "unit_string");
        objects.extend(0x20_u32.to_le_bytes());
        text(&mut objects, unit);
        values
            .iter()
            .for_each(|value| raw.extend(value.to_le_bytes()));
    }
    let mut bytes = b"TDSm".to_vec();
    for word in [14_u32, 4713] {
        bytes.extend(word.to_le_bytes());
    }
    for length in [objects.len() + raw.len(), objects.len()] {
        bytes.extend((length as u64).to_le_bytes());
    }
    [bytes, objects, raw].concat()
}

/// The property of a later segment of TDMS counts from there on.
#[cfg(feature = "formats")]
#[test]
fn a_step_that_changes_within_the_file_is_followed() {
    let mut random = StdRng::seed_from_u64(29);
    for case in 0..6 {
        // Segments of any length, each with one of two steps.
        let (mut time, mut ends, mut now) = (Vec::new(), Vec::new(), 0.0);
        for _ in 0..5 {
            let step = [0.002, 0.004, 0.005][random.random_range(0..3)];
            for _ in 0..random.random_range(300..2000) {
                time.push(now);
                now += step;
            }
            ends.push((time.len(), step));
        }
        let test = Test::at(time, case);
        let mut from = 0;
        let segments = ends.into_iter().flat_map(|(end, step)| {
            let samples = from..end;
            from = end;
            segment(
                step,
                [&test.displacement[samples.clone()], &test.force[samples]],
            )
        });
        let recording = Recording::from_bytes(Path::new("a.tdms"), segments.collect()).unwrap();
        for (read, truth) in recording.time.iter().zip(&test.time) {
            assert!((read - truth).abs() < 1e-9, "{read} s for {truth} s");
        }
        let (faults, [k, c]) = law(&recording);
        assert!(
            (k / STIFFNESS - 1.0).abs() < 0.01 && (c / DAMPING - 1.0).abs() < 0.05,
            "k {k}, c {c}, {faults}"
        );
    }
}
