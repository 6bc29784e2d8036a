//! An emulated board on its own timer: it runs, records and stops by itself, and the harness listens at its serial port.

mod emulated;

use mesh_damper::effects::{AugmentedLaw, Effect, StickSlip};
use mesh_damper::fast_law::FastLaw;
use mesh_damper::law::Law;
use mesh_damper::message::TelemetryConfig;
use mesh_damper::pack::{LARGEST, PackInfo, encode};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_link::image::OWN_TIMER;
use mesh_damper_link::lockstep::{Image, Serial, described};
use mesh_damper_link::own_timer::{BoardRun, EmulatedBoard, record};
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{Plant, RigSetup, TICK_RATE, run_rig};

const EVERY: u32 = 10;

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

/// The board with the specimen of `setup` beside it; none where there is no emulator, which a line says.
fn board(setup: &RigSetup<Specimen, 1, 1>, arguments: &[&str]) -> Option<EmulatedBoard> {
    emulated::image(&OWN_TIMER, mesh_damper_link::image::Board::Mps2An386)?;
    Some(EmulatedBoard::start(Plant::new(setup).unwrap(), 1.0, arguments).unwrap())
}

fn pack(law: &AugmentedLaw<f32, 1>) -> Vec<u8> {
    let mut buffer = [0; LARGEST];
    let info = PackInfo::at(TICK_RATE as f32);
    encode(&FastLaw::new(law.clone()), &info, &mut buffer)
        .unwrap()
        .to_vec()
}

/// The board restarted and wired up with `setup`.
fn wired(board: &EmulatedBoard, setup: &RigSetup<Specimen, 1, 1>) -> Image<Serial> {
    let (mut image, about) = Image::join(board.port()).unwrap();
    assert!(about.own_timer && about.clock > 0, "{about:?}");
    drop(image);
    image = Image::at(board.port()).unwrap();
    let mut setup = setup.clone();
    setup.settings.clock_rate = about.clock.into();
    image.send_pack(&pack(&setup.law)).unwrap();
    let described = described(&setup).unwrap();
    image.set_up(&setup.programme, &described).unwrap();
    image
}

fn telemetry() -> TelemetryConfig {
    TelemetryConfig {
        every: EVERY,
        within: 500,
        controls: 0,
        session: 1,
    }
}

fn recorded(image: &mut Image<Serial>, setup: &RigSetup<Specimen, 1, 1>) -> BoardRun {
    let times = [setup.programme.duration(), f64::INFINITY];
    let start = |image: &mut Image<Serial>| image.start_rig();
    record(
        image,
        telemetry(),
        TICK_RATE,
        times,
        start,
        &mut |_: f64| (),
    )
    .unwrap()
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

#[test]
fn zz() {
    let setup = setup();
    let Some(board) = board(&setup, &[]) else {
        return;
    };
    let mut image = wired(&board, &setup);
    for _ in 0..5 {
        eprintln!("{:?}", image.about().unwrap());
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    image.start_rig().unwrap();
    for _ in 0..5 {
        eprintln!("{:?}", image.about().unwrap());
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
}
