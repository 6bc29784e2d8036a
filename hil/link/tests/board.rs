//! An emulated board on its own timer: it runs and stops by itself and sends its telemetry, and the harness listens at its serial
//! port.

mod emulated;
#[path = "emulated/orders.rs"]
mod orders;

use std::fs::{File, OpenOptions};
use std::io::Write as _;

use mesh_damper::effects::{AugmentedLaw, Effect, StickSlip};
use mesh_damper::fast_law::FastLaw;
use mesh_damper::health::Event;
use mesh_damper::law::Law;
use mesh_damper::message::TelemetryConfig;
use mesh_damper::pack::{Identity, LARGEST, PackInfo, encode};
use mesh_damper::rig::{CycleReport, State, Telemetry, TripCause};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_link::image::{OWN_TIMER, sections};
use mesh_damper_link::lockstep::{Image, LinkError, Serial, described};
use mesh_damper_link::own_timer::{BoardRun, EmulatedBoard, Lost, RecordError, Times, record};
use mesh_damper_output::error::InputError;
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{Plant, RigSetup, Samples, TICK_RATE, Watch, run_rig};

use orders::Orders;

const EVERY: u32 = 10;
/// Half of real time: a machine that is busy with other tests may stall for a second before rows are lost.
const SPEED: f64 = 0.5;

fn setup() -> RigSetup<Specimen, 1, 1> {
    let specimen = Specimen::of_density(3.0, 0.1);
    let c = specimen.coefficients();
    let law = Law::new(c.k1 as f32, c.k3 as f32, c.c as f32, c.alpha as f32).unwrap();
    let slip = Effect::StickSlip(StickSlip::new(&[(5.0, 2e-3)]).unwrap());
    let law = AugmentedLaw::new(law).with(slip).unwrap();
    let programme = Programme::new(TICK_RATE, 1).unwrap();
    let programme = programme.with(Block::sine(0.1, 20.0, 6).unwrap()).unwrap();
    RigSetup::new(specimen, law, programme, 1)
}

/// The board with the specimen of `setup`; `None`, with a message, without an emulator.
fn board(setup: &RigSetup<Specimen, 1, 1>, arguments: &[&str]) -> Option<EmulatedBoard> {
    emulated::image(&OWN_TIMER, mesh_damper_link::image::Board::Mps2An386)?;
    Some(EmulatedBoard::start(Plant::new(setup).unwrap(), SPEED, arguments).unwrap())
}

fn pack(law: &AugmentedLaw<f32, 1>, tick_rate: f64) -> Vec<u8> {
    pack_with(law, &PackInfo::at(tick_rate as f32))
}

fn pack_with(law: &AugmentedLaw<f32, 1>, info: &PackInfo) -> Vec<u8> {
    let mut buffer = [0; LARGEST];
    encode(&FastLaw::new(law.clone()), info, &mut buffer)
        .unwrap()
        .to_vec()
}

/// The same with an identity and a revision.
fn named(law: &AugmentedLaw<f32, 1>) -> Vec<u8> {
    let mut info = PackInfo::at(TICK_RATE as f32);
    (info.stamp.identity, info.stamp.revision) = (Identity([7; 8]), 3);
    pack_with(law, &info)
}

/// The board restarted and wired up with `setup`.
fn wired(board: &EmulatedBoard, setup: &RigSetup<Specimen, 1, 1>) -> Image<Serial> {
    let (mut image, about) = Image::join(board.port()).unwrap();
    assert!(about.own_timer && about.clock > 0, "{about:?}");
    drop(image);
    image = Image::at(board.port()).unwrap();
    let mut setup = setup.clone();
    setup.settings.clock_rate = about.clock.into();
    image
        .send_pack(&pack(&setup.law, setup.programme.tick_rate()))
        .unwrap();
    let described = described(&setup).unwrap();
    image.set_up(&setup.programme, &described).unwrap();
    image
}

/// The whole test.
fn whole(setup: &RigSetup<Specimen, 1, 1>) -> Times {
    Times {
        expected: setup.programme.duration(),
        most: f64::INFINITY,
    }
}

/// `setup` with this number of cycles.
fn longer(mut setup: RigSetup<Specimen, 1, 1>, cycles: u32) -> RigSetup<Specimen, 1, 1> {
    setup.programme = Programme::new(TICK_RATE, 1)
        .and_then(|programme| programme.with(Block::sine(0.1, 20.0, cycles)?))
        .unwrap();
    setup
}

fn telemetry() -> TelemetryConfig {
    TelemetryConfig {
        every: EVERY,
        within: 500,
        controls: 0,
        session: 1,
    }
}

/// Calls of an observer.
#[derive(Default)]
struct Told {
    rows: Vec<f64>,
    cycles: Vec<CycleReport>,
    events: Vec<(f64, Event)>,
}

impl Watch for Told {
    fn tick(&mut self, _: &Telemetry, time: f64, _: f64) {
        self.rows.push(time);
    }

    fn cycle(&mut self, report: &CycleReport, _: f64) {
        self.cycles.push(*report);
    }

    fn event(&mut self, event: &Event, time: f64) {
        self.events.push((time, *event));
    }

    fn see(&mut self, _: f64, _: &Samples) -> Result<(), InputError> {
        Ok(())
    }
}

/// A whole test; the observer got all of it, and also the rows after its end.
fn recorded(image: &mut Image<Serial>, setup: &RigSetup<Specimen, 1, 1>) -> BoardRun {
    let times = whole(setup);
    let start = |image: &mut Image<Serial>| image.start_rig();
    let mut told = Told::default();
    let there = record(image, telemetry(), TICK_RATE, times, start, &mut told).unwrap();
    assert!(told.rows.starts_with(&there.run.samples.time));
    assert_eq!(told.cycles, there.run.cycles);
    assert_eq!(told.events, there.run.events);
    there
}

#[test]
fn a_test_on_the_boards_own_timer_is_that_in_this_process() {
    let setup = setup();
    let Some(board) = board(&setup, &[]) else {
        return;
    };
    let here = run_rig(setup.clone(), |_| ()).unwrap();
    assert!(here.cycles.len() > 3 && here.faults.is_empty());
    let mut image = wired(&board, &setup);
    let there = recorded(&mut image, &setup);
    assert_eq!(there.lost, Default::default());
    assert_eq!(there.late_ticks, 0);
    let there = there.run;
    assert_eq!(there.cycles, here.cycles);
    assert_eq!(there.faults, here.faults);
    assert_eq!(there.events, here.events);
    assert_eq!(there.samples.time, here.samples.time);
    assert_eq!(there.samples.displacement, here.samples.displacement);
    assert_eq!(there.samples.force, here.samples.force);
    assert_eq!(there.samples.model_force, here.samples.model_force);
    assert_eq!(there.samples.command, here.samples.command);
}

/// Waits until the board has done `ticks` more, without requests.
fn after(board: &EmulatedBoard, ticks: u64) {
    let end = board.ticks() + ticks;
    while board.ticks() < end {
        std::thread::yield_now();
    }
}

#[test]
fn ticks_go_on_while_the_host_is_silent_and_the_test_ends_by_itself() {
    let setup = setup();
    let Some(board) = board(&setup, &[]) else {
        return;
    };
    let mut image = wired(&board, &setup);
    image.start_rig().unwrap();
    after(
        &board,
        (setup.programme.duration() * TICK_RATE) as u64 + 100,
    );
    let about = image.about().unwrap();
    assert_eq!((about.state, about.late_ticks), (State::Done, 0));
    assert!(!board.is_enabled());
}

/// For the board a pulled cable and a harness that has ended look the same.
#[test]
fn a_board_whose_host_falls_silent_comes_to_rest() {
    let mut setup = setup();
    setup.settings.link_ticks = 1000;
    let Some(board) = board(&setup, &[]) else {
        return;
    };
    let mut image = wired(&board, &setup);
    image.start_rig().unwrap();
    after(&board, 1100);
    assert!(!board.is_enabled());
    assert_eq!(
        image.about().unwrap().state,
        State::Faulted(TripCause::LinkLost)
    );
}

/// More rows than its queue and the line hold: the board leaves them out, and does every tick in time.
#[test]
fn a_host_that_does_not_read_loses_rows_and_nothing_else() {
    let setup = setup();
    let Some(board) = board(&setup, &[]) else {
        return;
    };
    let here = run_rig(
        RigSetup {
            record_every: 1,
            ..setup.clone()
        },
        |_| (),
    )
    .unwrap();
    let mut image = wired(&board, &setup);
    let times = whole(&setup);
    let begin = |image: &mut Image<Serial>| {
        image.start_rig()?;
        after(&board, 2000);
        Ok(())
    };
    let config = TelemetryConfig {
        every: 1,
        ..telemetry()
    };
    let there = record(
        &mut image,
        config,
        TICK_RATE,
        times,
        begin,
        &mut |_: f64| (),
    )
    .unwrap();
    assert!(
        there.lost.rows > 500 && there.lost.frames == 0,
        "{:?}",
        there.lost
    );
    assert_eq!(there.late_ticks, 0);
    assert_eq!(there.run.faults, []);
    let samples = &there.run.samples;
    let all = samples.len() as u64 + there.lost.rows;
    assert_eq!(all, here.samples.len() as u64);
    // Each row that arrived is in its place.
    for (index, time) in samples.time.iter().enumerate() {
        let place = (time * TICK_RATE).round() as usize;
        assert_eq!(samples.force[index], here.samples.force[place]);
        assert_eq!(samples.model_force[index], here.samples.model_force[place]);
    }
}

/// Writes noise to the board's line during a recording.
struct Noisy {
    noise: File,
    /// Number of rows received.
    rows: usize,
}

impl Noisy {
    /// Rows from one burst of noise to the next: a tenth of a second of the test.
    const EVERY: usize = 100;
    /// The last one is a beginning whose end never comes.
    const JUNK: [&[u8]; 3] = [b"\x00\xff", b"M", b"MD\x07\x09\0\0\0\0\x01\0\xff\0"];
}

impl Watch for Noisy {
    fn tick(&mut self, _: &Telemetry, _: f64, _: f64) {
        self.rows += 1;
        if self.rows.is_multiple_of(Self::EVERY) {
            for piece in Self::JUNK {
                self.noise.write_all(piece).unwrap();
            }
        }
    }

    fn see(&mut self, _: f64, _: &Samples) -> Result<(), InputError> {
        Ok(())
    }
}

#[test]
fn noise_on_the_line_costs_no_row() {
    let setup = longer(setup(), 20);
    let Some(board) = board(&setup, &[]) else {
        return;
    };
    let here = run_rig(setup.clone(), |_| ()).unwrap();
    let mut image = wired(&board, &setup);
    let noise = OpenOptions::new().write(true).open(board.port()).unwrap();
    let mut noisy = Noisy { noise, rows: 0 };
    let times = whole(&setup);
    let start = |image: &mut Image<Serial>| image.start_rig();
    let there = record(&mut image, telemetry(), TICK_RATE, times, start, &mut noisy).unwrap();
    assert!(noisy.rows > 5 * Noisy::EVERY, "{}", noisy.rows);
    assert_eq!(there.lost, Lost::default());
    assert_eq!(there.run.samples.force, here.samples.force);
    assert_eq!(there.run.cycles, here.cycles);
}

#[test]
fn a_board_that_restarts_in_the_middle_says_so_and_what_came_is_kept() {
    let setup = longer(setup(), 60);
    let orders = Orders::new();
    let arguments = orders.arguments();
    let Some(board) = board(&setup, &arguments.each_ref().map(String::as_str)) else {
        return;
    };
    let mut image = wired(&board, &setup);
    let times = whole(&setup);
    let start = |image: &mut Image<Serial>| image.start_rig();
    let mut kept = Kept::default();
    let mut watch = Watching {
        kept: &mut kept,
        then: || orders.give("system_reset"),
    };
    let error = record(&mut image, telemetry(), TICK_RATE, times, start, &mut watch).unwrap_err();
    assert!(
        matches!(error, RecordError::Link(LinkError::Restarted)),
        "{error}"
    );
    assert!(kept.rows > 100, "{} rows", kept.rows);
    after(&board, 10);
    assert!(!board.is_enabled());
}

/// The board's watchdog waits for 20 ms, and the ticks of this rig are 25 ms apart.
#[test]
fn the_watchdog_restarts_a_board_whose_ticks_stay_away() {
    let mut setup = setup();
    let slow = 40.0;
    setup.programme = Programme::new(slow, 1)
        .and_then(|programme| programme.with(Block::sine(0.1, 0.5, 3)?))
        .unwrap();
    let settings = &mut setup.settings;
    (settings.observer_bandwidth, settings.feedback) = (3.0, 0.3);
    settings.glide = 0.05;
    let Some(board) = board(&self::setup(), &[]) else {
        return;
    };
    let mut image = wired(&board, &setup);
    after(&board, 5);
    assert_eq!(image.about().unwrap().tick_rate, 0.0);
    assert_eq!(
        image.start_rig(),
        Err(LinkError::Refused {
            reason: "the request came in the wrong order".into(),
            remedy: "run it again; if it stays, run it on the host and report this",
        })
    );
}

/// Observations of a recording.
#[derive(Default)]
struct Kept {
    rows: usize,
}

/// Does something once there are some rows.
struct Watching<'k, F> {
    kept: &'k mut Kept,
    then: F,
}

impl<F: FnMut()> Watch for Watching<'_, F> {
    fn see(&mut self, part: f64, samples: &Samples) -> Result<(), InputError> {
        self.kept.rows = samples.len();
        if part < 1.0 && samples.len() > 100 {
            (self.then)();
        }
        Ok(())
    }
}

/// A forged pack changes nothing.
#[test]
fn a_law_is_swapped_at_the_end_of_a_cycle_while_the_rig_runs() {
    let setup = longer(setup(), 60);
    let Some(board) = board(&setup, &[]) else {
        return;
    };
    let mut image = wired(&board, &setup);
    let mut better = setup.law.clone();
    let law = *better.law();
    better.set_law(Law::new(law.k1() * 1.1, law.k3(), law.c(), law.alpha()).unwrap());
    let mut forged = pack(&better, TICK_RATE);
    let last = forged.len() - 1;
    forged[last] ^= 1;
    let begin = |image: &mut Image<Serial>| {
        image.start_rig()?;
        after(&board, 1000);
        let refused = image.send_pack(&forged).unwrap_err().to_string();
        assert!(refused.contains("checksum"), "{refused}");
        assert_eq!(image.about()?.revision, 0);
        image.send_pack(&named(&better))?;
        let about = image.about()?;
        assert_eq!((about.identity, about.revision), (Identity([7; 8]), 3));
        Ok(())
    };
    let times = whole(&setup);
    let there = record(
        &mut image,
        telemetry(),
        TICK_RATE,
        times,
        begin,
        &mut |_: f64| (),
    )
    .unwrap();
    assert_eq!((there.late_ticks, there.run.faults.len()), (0, 0));
    assert_eq!(there.lost.notes, 0);
    // The motion does not depend on the law: from the swap on, every cycle equals that of a rig that has the augmented law from the
    // start.
    let same = |law| {
        let run = run_rig(
            RigSetup {
                law,
                ..setup.clone()
            },
            |_| (),
        )
        .unwrap();
        let pairs = run.cycles.into_iter().zip(&there.run.cycles);
        pairs
            .map(|(here, there)| (here.model.stiffness / there.model.stiffness - 1.0).abs() < 1e-5)
            .collect::<Vec<bool>>()
    };
    let (before, after) = (same(setup.law.clone()), same(better));
    assert!(
        before[..2] == [true; 2] && after[..2] == [false; 2],
        "{before:?} {after:?}"
    );
    let swap = after.iter().position(|same| *same).unwrap();
    // The cycle in which the new law's table fills belongs to neither.
    assert!(before[..swap - 1].iter().all(|same| *same), "{before:?}");
    assert!(after[swap..].iter().all(|same| *same), "{after:?}");
}

/// It would drive its actuator without requests for ticks.
#[test]
fn a_board_on_its_own_timer_is_not_run_in_lockstep() {
    let setup = setup();
    let Some(board) = board(&setup, &[]) else {
        return;
    };
    let refused = Image::in_lockstep(board.port()).unwrap_err().to_string();
    assert!(refused.contains("a timer of its own"), "{refused}");
    assert!(!board.is_enabled());
    // While the port is in use, no other process can open it.
    let _here = Image::join(board.port()).unwrap();
    let refused = Image::join(board.port())
        .map(|_| ())
        .unwrap_err()
        .to_string();
    assert!(refused.contains("another program"), "{refused}");
}

/// A force beyond its limit from the first tick on; the rows until then and the cause arrive all the same.
#[test]
fn a_rig_that_stops_on_a_limit_says_why_and_when() {
    let mut setup = setup();
    setup.settings.force_limit = 0.05;
    let Some(board) = board(&setup, &[]) else {
        return;
    };
    let here = run_rig(setup.clone(), |_| ()).unwrap();
    assert_eq!(here.faults[0].1, TripCause::ForceLimit);
    let mut image = wired(&board, &setup);
    let there = recorded(&mut image, &setup);
    assert_eq!(there.lost, Lost::default());
    assert_eq!(there.run.faults, here.faults);
    assert_eq!(there.run.samples.force, here.samples.force);
    assert!(!board.is_enabled());
}

/// In addition to the rig in lockstep it contains the serial port, its own requests and the queues of telemetry.
#[test]
fn the_image_is_small() {
    let Some(elf) = emulated::image(&OWN_TIMER, mesh_damper_link::image::Board::Mps2An386) else {
        return;
    };
    let sizes = sections(&elf).unwrap();
    assert!(
        sizes.flash > 0 && sizes.flash <= 93 * 1024 + 512,
        "{sizes:?}"
    );
    // 17 KiB of the rig, 12 of the queues, and a request and an answer in progress.
    assert!(sizes.ram <= 31 * 1024, "{sizes:?}");
}
