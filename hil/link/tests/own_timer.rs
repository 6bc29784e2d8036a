//! The firmware of `examples/own-timer` in the emulator: it runs at its timer's rate, without requests for ticks.

mod emulated;
#[allow(dead_code, reason = "what ended is read from the firmware here")]
#[path = "../../../examples/own-timer/src/excited.rs"]
mod excited;
#[path = "../../../examples/own-timer/src/motion.rs"]
mod motion;
#[rustfmt::skip]
#[allow(dead_code, reason = "nobody asks here which model it is, nor for its operating range")]
#[path = "../../../examples/own-timer/src/mount.rs"]
mod mount;

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::process::Stdio;
use std::sync::OnceLock;

use excited::{Checksum, Excited};
use libm::tgamma;
use mesh_damper::effects::Motion;
use mesh_damper::fast_law::RunningLaw;
use mesh_damper::pack::{Expectation, decode};
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper_link::image::Board;
use mesh_damper_model::MAX_EFFECTS;
use mesh_damper_model::export::{Export, ExportSettings};
use mesh_damper_model::file::ModelFile;
use motion::{CYCLES, RAMP_CYCLES, SINES, Sine};

const TICK_RATE: f64 = 10_000.0;

/// One line of the firmware, about a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ended {
    sine: usize,
    /// Stiffness, kN/mm
    stiffness: f64,
    loss_factor: f64,
    ticks: f64,
    /// Measured by SysTick, which is independent of the timer that gives the ticks.
    milliseconds: f64,
    overruns: f64,
}

impl Ended {
    fn of(line: &str) -> Self {
        let is_number = |word: &&str| word.starts_with(|first: char| first.is_ascii_digit());
        let words = line.split([' ', ',', ':']).filter(is_number);
        let numbers: Vec<f64> = words.map(|word| word.parse().unwrap()).collect();
        let [sine, stiffness, loss_factor, ticks, milliseconds, overruns] = numbers[..] else {
            panic!("the firmware said: {line}");
        };
        Self {
            sine: sine as usize,
            stiffness,
            loss_factor,
            ticks,
            milliseconds,
            overruns,
        }
    }
}

/// The firmware's output if an instruction takes 2^`shift` ns; `None`, with a message, if this machine cannot run it. It gets no
/// input: its standard input is empty, and it has no serial line. While it waits for the next tick the emulator's time skips to
/// that tick, independent of the host's clock.
fn printed(shift: u32) -> Option<String> {
    let elf = emulated::example("own-timer", Board::NetduinoPlus2)?;
    let output = Board::NetduinoPlus2
        .emulator(&elf)
        .unwrap()
        .args(["-icount", &format!("shift={shift},sleep=off")])
        .args(["-semihosting-config", "enable=on,target=native"])
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{}: {said}", output.status);
    Some(String::from_utf8(output.stdout).unwrap())
}

/// The cycles of one run that all tests share.
fn cycles() -> Option<Vec<Ended>> {
    static PRINTED: OnceLock<Option<String>> = OnceLock::new();
    let printed = PRINTED.get_or_init(|| printed(2)).as_ref()?;
    let cycles = printed.lines().filter(|line| line.starts_with("sine"));
    Some(cycles.map(Ended::of).collect())
}

/// Stiffness in kN/mm and loss factor of a steady cycle, from the law's equations.
///
/// With y = X·sin φ and v = X·ω·cos φ the mixed damping law dissipates
///
/// ΔW = c·X·(X·ω)^α·∮|cos φ|^(1+α) dφ, where the integral is 2·√π·Γ(1 + α/2)/Γ(3/2 + α/2),
///
/// and stick-slip of stiffness k and slip limit s dissipates 4·k·s·(X − s). Its force is k·s while it slips, as it does where the
/// force is largest. Stiffness is half of the force's range divided by X, and the loss factor is ΔW/(π·K·X²).
fn closed_form(sine: &Sine) -> (f64, f64) {
    let [k1, k3, c, alpha] = mount::LAW.map(f64::from);
    let [stiffness, slip_limit] = mount::STICK_SLIP;
    let amplitude = sine.amplitude;
    let damping = c * (amplitude * TAU * sine.frequency).powf(alpha);
    let integral = 2.0 * PI.sqrt() * tgamma(1.0 + alpha / 2.0) / tgamma(1.5 + alpha / 2.0);
    let energy =
        damping * amplitude * integral + 4.0 * stiffness * slip_limit * (amplitude - slip_limit);
    let force = |phase: f64| {
        let y = amplitude * phase.sin();
        k1 * y + k3 * y.powi(3) + damping * phase.cos().powf(alpha) + stiffness * slip_limit
    };
    // The force rises from 0 to one maximum in this quarter of the cycle.
    let phases = (0..100_000).map(|step| FRAC_PI_2 * f64::from(step) / 1e5);
    let largest = phases.map(force).fold(0.0, f64::max);
    let dynamic_stiffness = largest / amplitude;
    (
        dynamic_stiffness,
        energy / (PI * dynamic_stiffness * amplitude.powi(2)),
    )
}

/// With 1000 ticks in the shortest cycle, trapezoids are within (2π/1000)²/6 = 6.6e-6 of the motion's, and extremes within
/// (π/1000)²/2 = 4.9e-6. f32 adds some 2e-6.
const TOLERANCE: f64 = 1.5e-5;

#[test]
fn stiffness_and_loss_factor_of_each_cycle_are_the_laws_closed_form() {
    let Some(cycles) = cycles() else { return };
    let of_each = CYCLES as usize;
    assert_eq!(cycles.len(), of_each * SINES.len());
    for (index, ended) in cycles.iter().enumerate() {
        assert_eq!(ended.sine, index / of_each);
        let (stiffness, loss_factor) = closed_form(&SINES[ended.sine]);
        let error = |found: f64, expected: f64| (found / expected - 1.0).abs();
        assert!(
            error(ended.stiffness, stiffness) < TOLERANCE
                && error(ended.loss_factor, loss_factor) < TOLERANCE,
            "{ended:?}, expected {stiffness} kN/mm and {loss_factor}"
        );
    }
    // The sines differ by far more than the tolerance, so that no cycle passes for that of another sine.
    let [(_, a), (_, b), (_, c)] = [0, 1, 2].map(|sine| closed_form(&SINES[sine]));
    assert!((a - b).abs() > 0.1 && (b - c).abs() > 0.1 && (c - a).abs() > 0.05);
}

/// Export of the model next to the firmware, at its rate.
fn export() -> Export {
    let model = include_bytes!("../../../examples/own-timer/src/mount.json");
    let model = ModelFile::from_bytes("mount.json", model).unwrap();
    Export::new(&model, &ExportSettings::at(TICK_RATE, "mount")).unwrap()
}

/// The module's law in the emulator, the same on this machine, and the law of the same model from a pack: every force has the same
/// bits.
#[test]
fn every_force_is_that_of_the_same_model_from_a_pack() {
    let Some(printed) = printed(2) else { return };
    let last = printed.lines().last().unwrap();
    let emulated = last.strip_prefix("forces ").unwrap();
    let emulated = Checksum(u32::from_str_radix(emulated, 16).unwrap());

    let law = Box::leak(Box::new(mount::DamperLaw::empty()));
    let mut excited = Excited::new(law).unwrap();
    while excited.tick().is_some() {}
    assert_eq!(emulated, excited.forces());

    let (pack, expected) = (export().pack().unwrap(), Expectation::at(TICK_RATE as f32));
    let mut from_pack = RunningLaw::<MAX_EFFECTS>::empty();
    let read = from_pack.swap_with(|slot| decode(&pack, slot, &expected).map(|_| ()));
    read.unwrap();
    from_pack.boundary();
    let mut programme = Programme::<{ SINES.len() }>::new(TICK_RATE, RAMP_CYCLES).unwrap();
    for sine in SINES {
        let block = Block::sine(sine.amplitude, sine.frequency, CYCLES).unwrap();
        programme = programme.with(block).unwrap();
    }
    let mut generator = SineGenerator::new(programme).unwrap();
    let mut forces = Checksum::default();
    // The first tick after the last sine's ramp is the last of the firmware.
    loop {
        let now = generator.tick();
        forces.add(from_pack.force(&Motion {
            acceleration: now.acceleration,
            ..Motion::at(now.displacement, now.velocity)
        }));
        if now.done {
            break;
        }
    }
    assert_eq!(emulated, forces);
}

/// The module in the tree equals the export of its model.
#[test]
fn the_module_in_the_tree_is_what_its_model_exports() {
    let there = include_str!("../../../examples/own-timer/src/mount.rs");
    assert_eq!(there, export().rust().unwrap());
}

#[test]
fn ticks_go_on_at_the_timers_rate_while_the_host_is_silent() {
    let Some(cycles) = cycles() else { return };
    for ended in &cycles {
        // SysTick gives the elapsed whole milliseconds, and both were started within one.
        let expected = ended.milliseconds * TICK_RATE / 1e3;
        let ahead = ended.ticks - expected;
        assert!((-10.0..20.0).contains(&ahead), "{ended:?}: {ahead} ticks");
        assert_eq!(ended.overruns, 0.0);
    }
    // A cycle has the number of ticks that its frequency requires.
    for of_sine in cycles.chunks(CYCLES as usize) {
        let per_cycle = TICK_RATE / SINES[of_sine[0].sine].frequency;
        for two in of_sine.windows(2) {
            assert_eq!(two[1].ticks - two[0].ticks, per_cycle);
        }
    }
    assert!(cycles.last().is_some_and(|last| last.milliseconds > 2000.0));
}

#[test]
fn a_run_repeats_to_the_last_digit_and_a_slower_processor_changes_nothing() {
    let Some(first) = printed(2) else { return };
    assert_eq!(printed(2), Some(first.clone()));
    // 32 ns per instruction, eight times as long: a tick still ends before the next.
    assert_eq!(printed(5), Some(first));
}
