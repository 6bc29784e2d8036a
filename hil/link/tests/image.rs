//! The firmware's image in the emulator, held against the crate in this process.

mod emulated;

use std::sync::{Arc, Mutex};

use mesh_damper::converter::Scale;
use mesh_damper::effects::description::Description;
use mesh_damper::effects::{AugmentedLaw, CONTROLS, DESCRIPTIONS, Effect, Motion};
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::message::Setup;
use mesh_damper::pack::{LARGEST, PackInfo, encode};
use mesh_damper::rig::{RigSettings, StartRefused, State, StreamSettings, TripCause};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_link::image::{Board, FIRMWARE, sections};
use mesh_damper_link::lockstep::run_rig_on;
use mesh_damper_link::lockstep::{Emulator, Image, ImageBench, LinkError, LogLevel, LogLine, Wire};
use mesh_damper_recording::error::InputError;
use mesh_damper_rig::drive::{Grid, RandomMotion};
use mesh_damper_rig::specimen::{HiddenEffect, SlipShape, Specimen};
use mesh_damper_rig::{Bench, Controlled, Plant, RigRun, RigSetup, run_rig};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

const EFFECTS: usize = 8;
const TICK: f32 = 1e-4;

/// The firmware on `board`; none, and said so, where this machine cannot run it.
fn image_on(board: Board) -> Option<Image<Emulator>> {
    emulated::image(&FIRMWARE, board)?;
    Some(Image::start(board, Box::new(|_| {})).unwrap())
}

fn boards_with_rig() -> impl Iterator<Item = Board> {
    Board::ALL.into_iter().filter(|board| board.runs_rig())
}

/// Every effect of the crate, typical.
fn every_effect() -> Vec<Effect<f32>> {
    let typical = |each: &Description| {
        Effect::from_parameters(each.number, each.typical, f64::from(TICK)).unwrap()
    };
    DESCRIPTIONS.iter().map(typical).collect()
}

fn law(effects: &[Effect<f32>]) -> FastLaw<EFFECTS> {
    let eq13 = Law::new(1.0539, 10.5, 0.1114, 0.3969).unwrap();
    let with = |law: AugmentedLaw<f32, EFFECTS>, effect: &Effect<f32>| law.with(*effect).unwrap();
    FastLaw::new(effects.iter().fold(AugmentedLaw::new(eq13), with))
}

fn pack(law: &FastLaw<EFFECTS>) -> Vec<u8> {
    let mut buffer = [0; LARGEST];
    encode(law, &PackInfo::at(1.0 / TICK), &mut buffer)
        .unwrap()
        .to_vec()
}

/// A motion that sweeps in amplitude and frequency, with extremes and numbers that are none strewn in.
fn motions(count: usize, random: &mut ChaCha8Rng) -> Vec<Motion<f32>> {
    const STRANGE: [f32; 8] = [
        0.0,
        -0.0,
        1e-38,
        -1e-30,
        3e38,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
    ];
    let (mut phase, mut amplitude, mut frequency) = (0.0f64, 0.1f64, 3.0f64);
    let mut motions = Vec::with_capacity(count);
    for index in 0..count {
        amplitude = (amplitude * (1.0 + 0.01 * random.random_range(-1.0..1.0))).clamp(1e-3, 1.0);
        frequency = (frequency * (1.0 + 0.01 * random.random_range(-1.0..1.0))).clamp(0.1, 50.0);
        phase += std::f64::consts::TAU * frequency * f64::from(TICK);
        let speed = std::f64::consts::TAU * frequency;
        let mut motion = Motion {
            displacement: (amplitude * phase.sin()) as f32,
            velocity: (amplitude * speed * phase.cos()) as f32,
            acceleration: (-amplitude * speed * speed * phase.sin()) as f32,
            cycles: (phase / std::f64::consts::TAU) as f32,
            temperature: 20.0 + 1e-4 * index as f32,
            controls: [0.5, 1.0, 2.0, 4.0].map(|most| (most * phase.cos()) as f32),
        };
        if random.random_range(0..50) == 0 {
            let strange = STRANGE[random.random_range(0..STRANGE.len())];
            match random.random_range(0..6) {
                0 => motion.displacement = strange,
                1 => motion.velocity = strange,
                2 => motion.acceleration = strange,
                3 => motion.cycles = strange,
                4 => motion.controls[random.random_range(0..CONTROLS)] = strange,
                _ => motion.temperature = strange,
            }
        }
        motions.push(motion);
    }
    motions
}

/// What NaN carries beside being one differs between processors; no force is one.
fn bits(forces: &[f32]) -> Vec<u32> {
    forces.iter().map(|force| force.to_bits()).collect()
}

#[test]
fn a_million_ticks_of_every_effect_alone_and_together_are_the_hosts_bit_for_bit() {
    let Some(mut image) = image_on(Board::Mps2An386) else {
        return;
    };
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let every = every_effect();
    let alone = every.chunks(1).map(<[_]>::to_vec);
    // In as many laws as it takes.
    let together = every.chunks(EFFECTS).map(<[_]>::to_vec);
    for effects in alone.chain(together) {
        let law = law(&effects);
        image.rest().unwrap();
        image.send_pack(&pack(&law)).unwrap();
        image.rest().unwrap();
        let mut host = RunningLaw::new(law);
        for _ in 0..10 {
            let motions = motions(100_000, &mut random);
            let expected: Vec<f32> = motions.iter().map(|motion| host.force(motion)).collect();
            let mut forces = Vec::new();
            image.forces(&motions, &mut forces).unwrap();
            assert!(bits(&forces) == bits(&expected), "{effects:?}");
            assert!(forces.iter().all(|force| force.is_finite()));
        }
    }
}

fn setup() -> RigSetup<Specimen, 4, EFFECTS> {
    let specimen = Specimen::of_density(3.0, 0.1).with(HiddenEffect::StickSlip {
        stiffness: 1.0,
        slip_limit: 0.02,
        shape: SlipShape::Sharp,
    });
    let programme = Programme::new(10_000.0, 1)
        .and_then(|p| p.with(Block::sine(0.1, 5.0, 3)?))
        .and_then(|p| p.with(Block::sweep(0.05, 5.0, 20.0, 8)?))
        .unwrap();
    let law = law(&every_effect()[..EFFECTS]).augmented().clone();
    let mut setup = RigSetup::new(specimen, law, programme, 5);
    setup.block_laws = [1.0, 1.5]
        .map(|k1| Law::new(k1, 9.0, 0.11, 0.4).unwrap())
        .to_vec();
    setup.record_every = 1;
    setup
}

#[test]
fn a_run_on_every_board_is_the_hosts_to_the_last_bit_of_each_sample_and_cycle() {
    let host = run_rig(setup(), |_| {}).unwrap();
    assert!(host.faults.is_empty() && host.cycles.len() == 14);
    for board in boards_with_rig() {
        let Some(mut image) = image_on(board) else {
            return;
        };
        let run = run_rig_on(&mut image, setup(), |_| {}).unwrap();
        assert!(run == host, "{board:?}");
        let statistics = image.statistics().unwrap();
        assert!(
            // 1 KiB was held before there was a monitor; what follows the specimen passes through it as well, and what a rig's clock,
            // correction and temperature may be. The check of a pack takes 96 bytes more since there are requests of a board on its own timer: the
            // compiler chooses otherwise what it inlines there.
            statistics.stack > 0 && statistics.stack <= 1376,
            "{statistics:?}"
        );
        assert_eq!(statistics.log_lost, 0);
    }
}

/// Each input goes its own way, one of them never, and all of them back to 0.
#[test]
fn control_inputs_that_change_every_tick_come_out_on_every_board_as_on_the_host() {
    const TICKS: u32 = 3000;
    let at = |tick: u32| {
        let time = tick as f32 * TICK;
        let on = if tick < TICKS / 2 { 1.0 } else { 0.0 };
        [on * time, -3.0 * on, 1e30 * (20.0 * time).sin(), 0.0]
    };
    for board in boards_with_rig() {
        let Some(mut image) = image_on(board) else {
            return;
        };
        let mut host = Bench::new(setup()).unwrap();
        let mut bench = ImageBench::new(setup(), &mut image).unwrap();
        Controlled::start(&mut host).unwrap();
        bench.start().unwrap();
        for tick in 0..TICKS {
            host.plant.controls = at(tick);
            bench.plant_mut().controls = at(tick);
            let seen = bench.tick().unwrap();
            assert_eq!(seen, host.tick(), "{board:?}, tick {tick}");
            assert_eq!(seen.controls, at(tick), "{board:?}, tick {tick}");
        }
    }
}

/// The same rig, following a motion of up to 12 Hz.
/// The clock and the emergency stop of the plant go over the link: a plant that moves on by two ticks in one, and one that is stopped.
#[test]
fn a_late_tick_and_an_emergency_stop_are_the_hosts_on_every_board() {
    type Disturb = fn(&mut Plant<Specimen>);
    let disturbances: [(Disturb, TripCause); 2] = [
        (|plant| plant.clock += 1, TripCause::TickOverrun),
        (|plant| plant.tripped = true, TripCause::External),
    ];
    for (board, (disturb, cause)) in
        boards_with_rig().flat_map(|board| disturbances.map(|each| (board, each)))
    {
        let Some(mut image) = image_on(board) else {
            return;
        };
        let mut host = Bench::new(setup()).unwrap();
        let mut bench = ImageBench::new(setup(), &mut image).unwrap();
        Controlled::start(&mut host).unwrap();
        bench.start().unwrap();
        for tick in 0..3000 {
            if tick == 1000 {
                disturb(&mut host.plant);
                disturb(bench.plant_mut());
            }
            let seen = bench.tick().unwrap();
            assert_eq!(seen, host.tick(), "{board:?}, tick {tick}");
            let state = if tick < 1000 {
                State::Running
            } else {
                State::Faulted(cause)
            };
            assert_eq!(seen.state, state, "{board:?}, tick {tick}");
            assert_eq!(bench.is_enabled(), tick < 1000);
        }
        let state = State::Faulted(cause);
        assert_eq!(host.rig.state(), state);
        // As long as it is pressed, neither a start nor a clear does anything.
        if bench.plant().tripped {
            let refused = image.start_rig();
            let told = matches!(refused, Err(LinkError::Start(StartRefused::Faulted(which))) if which == cause);
            assert!(told, "{refused:?}");
        }
    }
}

fn driven() -> RigSetup<Specimen, 4, EFFECTS> {
    let random = RandomMotion {
        rms: 0.06,
        from: 1.0,
        to: 12.0,
        duration: 2.0,
        seed: 4,
    };
    let motion = random.motion(Grid::at(10_000.0)).unwrap();
    let of_sines = setup();
    let mut setup = RigSetup::driven(of_sines.specimen, of_sines.law, motion, 5).unwrap();
    setup.record_every = 1;
    setup
}

#[test]
fn a_streamed_motion_on_every_board_is_the_hosts_to_the_last_bit_of_each_sample() {
    let host = run_rig(driven(), |_| {}).unwrap();
    assert!(host.faults.is_empty() && host.ticks > 40_000 && host.cycles.is_empty());
    // Effects that count cycles have some.
    assert!(host.samples.cycle.iter().any(|cycle| *cycle > 10));
    for board in boards_with_rig() {
        let Some(mut image) = image_on(board) else {
            return;
        };
        let run = run_rig_on(&mut image, driven(), |_| {}).unwrap();
        assert!(run == host, "{board:?}");
        let statistics = image.statistics().unwrap();
        // As that of a programme, above.
        assert!(statistics.stack <= 1376, "{statistics:?}");
    }
}

#[test]
fn a_streamed_motion_that_asks_for_too_much_stops_the_image_as_it_does_the_host() {
    let beyond = || {
        let mut setup = driven();
        setup.stream.velocity_limit = 4.0;
        setup
    };
    let host = run_rig(beyond(), |_| {}).unwrap();
    assert!(matches!(host.faults[..], [(_, TripCause::DemandLimit)]));
    let Some(mut image) = image_on(Board::Mps2An386) else {
        return;
    };
    assert_eq!(run_rig_on(&mut image, beyond(), |_| {}).unwrap(), host);
}

#[test]
fn a_rig_of_sines_takes_no_knots() {
    let Some(mut image) = image_on(Board::Mps2An386) else {
        return;
    };
    let error = image.knots(&[]).unwrap_err();
    assert!(matches!(error, LinkError::Refused { .. }), "{error}");
    run_rig_on(&mut image, setup(), |_| {}).unwrap();
    let error = image.knots(&[]).unwrap_err();
    assert!(matches!(error, LinkError::Refused { .. }), "{error}");
}

#[test]
fn a_stop_is_the_hosts_too_and_the_log_tells_it_with_its_time_and_level() {
    if emulated::image(&FIRMWARE, Board::Mps2An386).is_none() {
        return;
    }
    let stopping = || {
        let mut setup = setup();
        setup.settings.displacement_limit = 0.09;
        setup
    };
    let host = run_rig(stopping(), |_| {}).unwrap();
    let lines = Arc::new(Mutex::new(Vec::<LogLine>::new()));
    let sink = lines.clone();
    let sink = Box::new(move |line| sink.lock().unwrap().push(line));
    let mut image = Image::start(Board::Mps2An386, sink).unwrap();
    let run = run_rig_on(&mut image, stopping(), |_| {}).unwrap();
    assert_eq!(run, host);
    // The log is whole once the emulator has ended.
    drop(image);
    let lines = lines.lock().unwrap();
    let [(time, TripCause::DisplacementLimit)] = run.faults[..] else {
        panic!("{:?}", run.faults)
    };
    let stop = lines
        .iter()
        .find(|line| line.level == LogLevel::Error)
        .unwrap();
    assert_eq!(stop.text, "stopped: DisplacementLimit");
    assert_eq!(f64::from(stop.tick), (time * 1e4).round() + 1.0);
    let logged = |level, text: &str| {
        let of_level = |line: &&LogLine| line.level == level;
        let mut found = lines.iter().filter(of_level);
        found.any(|line| line.text.starts_with(text))
    };
    for text in ["start: true", "block 0", "coefficient pack accepted"] {
        assert!(logged(LogLevel::Info, text), "{text}: {lines:?}");
    }
    for report in &run.cycles {
        let text = format!(
            "cycle {}: stiffness {} kN/mm, loss factor {}, ",
            report.cycle, report.measured.stiffness, report.measured.loss_factor
        );
        assert!(logged(LogLevel::Info, &text), "{text}: {lines:?}");
    }
    assert!(lines.is_sorted_by_key(|line| line.tick));
}

/// `frame` as it goes on when it is lost (0), repeated (1), cut (2) or damaged (3), and as it is for any other `kind`.
fn disturbed(frame: &[u8], kind: usize, random: &mut ChaCha8Rng) -> Vec<Vec<u8>> {
    let mut frame = frame.to_vec();
    match kind {
        0 => return Vec::new(),
        1 => return vec![frame.clone(), frame],
        2 => frame.truncate(random.random_range(1..frame.len())),
        3 => {
            let bit = random.random_range(0..8 * frame.len());
            frame[bit / 8] ^= 1 << (bit % 8);
        }
        _ => {}
    }
    vec![frame]
}

/// Number of the kind of fault that [`disturbed`] does not know: the frame comes after a later one.
const LATE: usize = 4;
const KINDS: usize = 5;

/// Disturbs frames in both directions.
struct Faulty<W> {
    inner: W,
    random: ChaCha8Rng,
    when: When,
    /// Nothing of what was sent last has reached the image.
    lost: bool,
    /// What comes late, of answers and of requests, with how many of its direction go before it.
    late: [Vec<(u32, Vec<u8>)>; 2],
    injected: [u32; KINDS],
    /// Frames sent, lost ones included.
    sent: u32,
}

enum When {
    /// Each kind to a tenth of the frames.
    Always,
    /// This kind to the next request.
    Request(usize),
    /// This kind to the next answer.
    Answer(usize),
    Never,
}

impl<W> Faulty<W> {
    fn new(inner: W, when: When) -> Self {
        Self {
            inner,
            random: ChaCha8Rng::seed_from_u64(7),
            when,
            lost: false,
            late: [Vec::new(), Vec::new()],
            injected: [0; KINDS],
            sent: 0,
        }
    }

    fn disturb(&mut self, frame: &[u8], is_request: bool) -> Vec<Vec<u8>> {
        let kind = match self.when {
            When::Always => self.random.random_range(0..10),
            When::Request(kind) if is_request => kind,
            When::Answer(kind) if !is_request => kind,
            _ => usize::MAX,
        };
        if kind != usize::MAX && !matches!(self.when, When::Always) {
            self.when = When::Never;
        }
        if let Some(count) = self.injected.get_mut(kind) {
            *count += 1;
        }
        let late = &mut self.late[usize::from(is_request)];
        if kind == LATE {
            // An answer comes with the next one; a request after the next one or the one that follows that, which is of
            // another exchange.
            let before = if is_request {
                self.random.random_range(1..3)
            } else {
                1
            };
            late.push((before, frame.to_vec()));
            return Vec::new();
        }
        let mut pieces = disturbed(frame, kind, &mut self.random);
        if !pieces.is_empty() {
            late.iter_mut().for_each(|(before, _)| *before -= 1);
            let due = late.extract_if(.., |(before, _)| *before == 0);
            pieces.extend(due.map(|(_, frame)| frame));
        }
        pieces
    }
}

impl<W: Wire> Wire for Faulty<W> {
    fn send(&mut self, frame: &[u8]) -> Result<(), LinkError> {
        self.sent += 1;
        let pieces = self.disturb(frame, true);
        self.lost = pieces.is_empty();
        pieces.iter().try_for_each(|piece| self.inner.send(piece))
    }

    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, LinkError> {
        if std::mem::take(&mut self.lost) {
            // What the emulator's watchdog would say in time.
            return Ok(0);
        }
        let mut came = vec![0; buffer.len()];
        let length = self.inner.receive(&mut came)?;
        if length == 0 {
            return Ok(0);
        }
        came.truncate(length);
        let came = self.disturb(&came, false).concat();
        let length = came.len().min(buffer.len());
        buffer[..length].copy_from_slice(&came[..length]);
        Ok(length)
    }
}

/// A fault costs one more frame, whichever it is: the exchange that it meets and the one after it take three at most. Where
/// faults come as often as in the next test, a try succeeds in half of the cases only, and some exchanges take more.
#[test]
fn after_one_fault_of_any_kind_the_link_is_well_again_within_three_frames() {
    let Some(elf) = emulated::image(&FIRMWARE, Board::Mps2An386) else {
        return;
    };
    let mut image = Image::on(Faulty::new(
        emulated::start(&elf, Board::Mps2An386),
        When::Never,
    ));
    let law = law(&every_effect()[..EFFECTS]);
    image.send_pack(&pack(&law)).unwrap();
    let mut host = RunningLaw::new(law);
    let motions = motions(2, &mut ChaCha8Rng::seed_from_u64(2));
    for kind in 0..KINDS {
        for request in [true, false] {
            for _ in 0..100 {
                let wire = image.wire();
                wire.when = if request {
                    When::Request(kind)
                } else {
                    When::Answer(kind)
                };
                wire.sent = 0;
                for motion in &motions {
                    let mut forces = Vec::new();
                    image.forces(&[*motion], &mut forces).unwrap();
                    assert_eq!(bits(&forces), bits(&[host.force(motion)]));
                }
                let sent = image.wire().sent;
                assert!(sent <= 3, "kind {kind}, request {request}: {sent} frames");
            }
        }
    }
    assert_eq!(image.wire().injected, [200; KINDS]);
}

#[test]
fn a_link_that_loses_repeats_cuts_damages_and_reorders_changes_nothing() {
    let Some(elf) = emulated::image(&FIRMWARE, Board::Mps2An386) else {
        return;
    };
    let host: RigRun = run_rig(setup(), |_| {}).unwrap();
    let mut image = Image::on(Faulty::new(
        emulated::start(&elf, Board::Mps2An386),
        When::Always,
    ));
    let run = run_rig_on(&mut image, setup(), |_| {}).unwrap();
    assert!(run == host);
    let injected = image.wire().injected;
    let exchanges = 2.0 * run.ticks as f64;
    for count in injected {
        assert!(f64::from(count) > 0.09 * exchanges, "{injected:?}");
    }
    assert!(image.repeated() > run.ticks / 3);
    // 0.6² of the tries go well: that one of 10⁵ requests takes a hundred has a chance of 10⁻¹⁴.
    assert!(image.most_tries() < 100, "{}", image.most_tries());
}

#[test]
fn a_lost_frame_is_asked_for_again_when_nothing_moves() {
    struct LosesOne(Emulator, u32);
    impl Wire for LosesOne {
        fn send(&mut self, frame: &[u8]) -> Result<(), LinkError> {
            self.1 += 1;
            if self.1 == 3 {
                return Ok(());
            }
            self.0.send(frame)
        }
        fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, LinkError> {
            self.0.receive(buffer)
        }
    }
    let Some(elf) = emulated::image(&FIRMWARE, Board::Mps2An386) else {
        return;
    };
    let mut image = Image::on(LosesOne(emulated::start(&elf, Board::Mps2An386), 0));
    for _ in 0..10 {
        image.rest().unwrap();
    }
    assert!(image.repeated() >= 1);
}

#[test]
fn a_damaged_pack_is_refused_and_the_law_in_force_stays() {
    if emulated::image(&FIRMWARE, Board::Mps2An386).is_none() {
        return;
    }
    let lines = Arc::new(Mutex::new(Vec::<LogLine>::new()));
    let sink = lines.clone();
    let sink = Box::new(move |line| sink.lock().unwrap().push(line));
    let mut image = Image::start(Board::Mps2An386, sink).unwrap();
    let law = law(&every_effect()[..2]);
    image.send_pack(&pack(&law)).unwrap();
    let motion = Motion {
        displacement: 0.07,
        velocity: 2.0,
        ..Motion::default()
    };
    let expected = RunningLaw::new(law.clone()).force(&motion);
    let mut other = law;
    other.set_law(Law::new(2.0, 0.0, 0.3, 0.5).unwrap());
    let good = pack(&other);
    let force = |image: &mut Image<Emulator>| {
        let mut forces = Vec::new();
        image.forces(&[motion], &mut forces).unwrap();
        forces[0]
    };
    let mut refused = |bad: &[u8], why: &str, what_to_do: &str| {
        let error = image.send_pack(bad).unwrap_err();
        assert_eq!(error.to_string(), format!("the image refused it: {why}"));
        assert_eq!(InputError::from(error).mend, what_to_do);
        assert_eq!(force(&mut image).to_bits(), expected.to_bits());
    };
    const EXPORT: &str = "send a pack that `hil export` of this version wrote";
    const AGAIN: &str = "send the pack again";
    const LENGTH: &str =
        "the length of the coefficient pack is not the stated one, or is too large";
    const VERSION: &str = "the coefficient pack is of another version";
    const CHECKSUM: &str = "the coefficient pack's checksum does not match";
    let mut logged = Vec::new();
    for bit in 0..8 * good.len() {
        let mut bad = good.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        // "MDCP", the version, the length of the body, the checksum, the body. Version 6 is read, and its checksum is another one.
        let (why, what_to_do, log) = match bit / 8 {
            0..4 => (
                "these bytes are not a coefficient pack",
                EXPORT,
                "PackMagic",
            ),
            4..6 if bad[4..6] != [6, 0] => (VERSION, EXPORT, "PackVersion"),
            6..8 => (LENGTH, AGAIN, "PackLength"),
            _ => (CHECKSUM, AGAIN, "PackChecksum"),
        };
        refused(&bad, why, what_to_do);
        logged.push(log);
    }
    for length in 1..good.len() {
        refused(&good[..length], LENGTH, AGAIN);
        logged.push("PackLength");
    }
    // The next version, which nobody can check: that is said, and not that its checksum is another one.
    let mut newer = good.clone();
    newer[4] += 1;
    refused(&newer, VERSION, EXPORT);
    logged.push("PackVersion");
    image.send_pack(&good).unwrap();
    let mut host = RunningLaw::new(other);
    assert_eq!(force(&mut image).to_bits(), host.force(&motion).to_bits());
    drop(image);
    let lines = lines.lock().unwrap();
    let count = |level, text: &str| {
        let is = |line: &&LogLine| line.level == level && line.text == text;
        lines.iter().filter(is).count()
    };
    assert_eq!(count(LogLevel::Info, "coefficient pack accepted"), 2);
    let warned = lines.iter().filter(|line| line.level == LogLevel::Warn);
    let said: Vec<&str> = warned
        .filter_map(|line| line.text.strip_prefix("coefficient pack refused: "))
        .collect();
    assert!(said == logged, "{said:?}");
}

/// A pack for another rate than the rig's, of either version: at set-up, where it came before the rig's rate was known, and while the
/// rig runs. The law in force stays.
#[test]
fn a_pack_for_another_rate_is_refused() {
    const OLD: &[u8] = include_bytes!("../../../tests/wire/packs/version-6-effects.mdcp");
    let is_of_the_rate = |error: LinkError| {
        const SAID: &str = "the image refused it: tick_rate: ";
        let said = error.to_string();
        assert!(said.starts_with(SAID), "{said}");
        let mend = InputError::from(error).mend;
        assert_eq!(mend, "export the model with the rig's --tick-rate");
    };
    let programme = Programme::<1>::new(10_000.0, 1)
        .and_then(|programme| programme.with(Block::sine(0.1, 5.0, 3)?))
        .unwrap();
    let scale = || Scale::new(1.0, 0.0).unwrap();
    let wiring = Setup {
        displacement: scale(),
        force: scale(),
        command: scale(),
        config: RigSettings::default().at(10_000.0).unwrap(),
    };
    let packed = |rate: f32| {
        let mut buffer = [0; LARGEST];
        let pack = encode(&law(&[]), &PackInfo::at(rate), &mut buffer);
        pack.unwrap().to_vec()
    };
    let (other, right) = (packed(2e3), packed(1e4));
    for streamed in [false, true] {
        let Some(mut image) = image_on(Board::Mps2An386) else {
            return;
        };
        let stream = StreamSettings::default().at(10_000.0).unwrap();
        let set_up = |image: &mut Image<Emulator>| match streamed {
            true => image.set_up_stream(stream, &wiring),
            false => image.set_up(&programme, &wiring),
        };
        // Of a law alone nobody knows a rate.
        for pack in [OLD, &other] {
            image.send_pack(pack).unwrap();
            is_of_the_rate(set_up(&mut image).unwrap_err());
        }
        image.send_pack(&right).unwrap();
        set_up(&mut image).unwrap();
        for pack in [OLD, &other] {
            is_of_the_rate(image.send_pack(pack).unwrap_err());
        }
        image.send_pack(&right).unwrap();
        image.start_rig().unwrap();
    }
}

/// A pack is checked in slices, a tick of the rig after each: every tick is that of a host whose law is swapped with the last slice. A check
/// that is broken off, and a pack that is refused at its end, change nothing.
#[test]
fn a_pack_is_checked_between_ticks() {
    let mut setup = setup();
    setup.block_laws.clear();
    let mut other = FastLaw::<EFFECTS>::new(setup.law.clone());
    other.set_law(Law::new(1.2, 9.0, 0.15, 0.4).unwrap());
    let good = pack(&other);
    let mut bad = good.clone();
    *bad.last_mut().unwrap() ^= 1;
    for board in boards_with_rig() {
        let Some(mut image) = image_on(board) else {
            return;
        };
        let mut host = Bench::new(setup.clone()).unwrap();
        let mut bench = ImageBench::new(setup.clone(), &mut image).unwrap();
        Controlled::start(&mut host).unwrap();
        bench.start().unwrap();
        let mut forces = Vec::new();
        let mut tick = |host: &mut Bench<_, 4, EFFECTS>,
                        bench: &mut ImageBench<'_, _, _, EFFECTS>| {
            let seen = bench.tick().unwrap();
            assert_eq!(seen, host.tick(), "{board:?}");
            forces.push(seen.model_force);
        };
        for _ in 0..100 {
            tick(&mut host, &mut bench);
        }
        bench.image().send_parts(&good).unwrap();
        for _ in 0..20 {
            assert!(!bench.image().check_pack().unwrap());
            tick(&mut host, &mut bench);
        }
        bench.image().send_parts(&bad).unwrap();
        let refused = loop {
            match bench.image().check_pack() {
                Ok(done) => assert!(!done),
                Err(error) => break error.to_string(),
            }
            tick(&mut host, &mut bench);
        };
        assert!(refused.ends_with("checksum does not match"), "{refused}");
        bench.image().send_parts(&good).unwrap();
        let mut slices = 1;
        while !bench.image().check_pack().unwrap() {
            slices += 1;
            tick(&mut host, &mut bench);
        }
        // The checksum alone takes one for every 32 bytes.
        assert!(slices > good.len() / 32, "{slices}");
        host.rig.swap_law(other.clone());
        // Over the end of the ramp's cycle, which the law waits for.
        for _ in 0..4000 {
            tick(&mut host, &mut bench);
        }
        // The host's law is the other one by now, and so was every force of the image's.
        assert_eq!(*host.rig.law(), other);
        assert!(forces.iter().any(|force| *force != 0.0));
    }
}

#[test]
fn an_emulator_that_dies_is_said() {
    let Some(mut image) = image_on(Board::Mps2An386) else {
        return;
    };
    image.rest().unwrap();
    let id = image.wire().id().to_string();
    let killed = std::process::Command::new("kill")
        .args(["-9", &id])
        .status();
    assert!(killed.unwrap().success());
    let error = loop {
        if let Err(error) = image.rest() {
            break error;
        }
    };
    assert!(matches!(error, LinkError::Ended { .. }), "{error}");
    assert!(error.to_string().contains("signal: 9"), "{error}");
    assert!(matches!(image.rest(), Err(LinkError::Ended { .. })));
}

#[cfg(target_os = "linux")]
#[test]
fn the_emulator_ends_with_the_link() {
    let Some(mut dropped) = image_on(Board::Mps2An386) else {
        return;
    };
    let id = dropped.wire().id();
    assert!(emulated::lives(id));
    drop(dropped);
    assert!(!emulated::lives(id));
}

#[test]
fn the_image_is_small() {
    for board in boards_with_rig() {
        let Some(elf) = emulated::image(&FIRMWARE, board) else {
            return;
        };
        let sizes = sections(&elf).unwrap();
        // 24 KiB were asked for before there were six effects more, which take 5, a correction, 4, the monitor, 9,
        // a law that follows, 3.5, further Maxwell branches and tones, 1.5, a streamed motion with its messages, 1, friction
        // that hardens, 1.5, a dashpot that yields with a low-pass, 1.75, the tick rate, model and revision of a pack, 1.25, and the check
        // of the ADC's registers with the reasons of a refused start or clear, 0.25. These two together take 0.75 more: the image is optimized as a whole.
        // What a control input sets, damping that differs between the directions, play and what degrades take 3.5.
        // Ticks that are judged by a clock, an external trip, the DAC's read-back, and converters that are set up again take 2.75.
        // That a law is passive takes 7.5: it is evaluated and made for longer ticks once more. The slices of a pack's check take 2.5, settings
        // that are checked as they are read 2, and what the monitor and the limits find of attacks 7. Frames through shared memory take 0.25,
        // and a harness that falls silent with the requests of a board on its own timer, which are refused here, 0.25.
        assert!(sizes.flash > 0 && sizes.flash <= 82 * 1024, "{sizes:?}");
        // 12 KiB likewise; of the rest the correction's table, in two laws and a pack, is 1.8, the monitor 0.75, and what the
        // law follows by 0.25. A reading's control inputs take 16 bytes and again as much in the telemetry, what a pack says of itself, in
        // the upload alone, 64, and the five effects that came last 72 in each of two laws, and 84 to remember. The clock and what
        // the rig is supervised by take 24. A law and what it remembers, to see whether it is passive, take 1.9 KiB, an event of each cause
        // 0.5, the slices of a check 0.1, and what the monitor sees of the force, of noise and of what stands still 0.45.
        assert!(
            sizes.ram <= 15 * 1024 + 16 + 64 + 16 + 228 + 24 + 3376,
            "{sizes:?}"
        );
    }
}
