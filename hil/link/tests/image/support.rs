//! Shared by the tests of this program: images, laws, motions and setups.

use std::sync::{Arc, Mutex};

use mesh_damper::effects::description::Description;
use mesh_damper::effects::{AugmentedLaw, CONTROLS, DESCRIPTIONS, Effect, Motion};
use mesh_damper::fast_law::FastLaw;
use mesh_damper::law::Law;
use mesh_damper::pack::{LARGEST, PackInfo, encode};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_link::image::{Board, FIRMWARE};
use mesh_damper_link::lockstep::{Emulator, Image, ImageBench, LogLine};
use mesh_damper_rig::specimen::{HiddenEffect, SlipShape, Specimen};
use mesh_damper_rig::{Bench, Controlled as _, RigSetup};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use crate::emulated;

pub const EFFECTS: usize = 8;
pub const TICK: f32 = 1e-4;

/// The firmware on `board`; none, with a message, where this machine cannot run it.
pub fn image_on(board: Board) -> Option<Image<Emulator>> {
    emulated::image(&FIRMWARE, board)?;
    Some(Image::start(board, Box::new(|_| {})).unwrap())
}

/// The lines of an image's log. They are complete once the emulator has ended.
pub type Lines = Arc<Mutex<Vec<LogLine>>>;

/// As [`image_on`] on the default board, with its log.
pub fn logged_image() -> Option<(Image<Emulator>, Lines)> {
    emulated::image(&FIRMWARE, Board::Mps2An386)?;
    let lines = Lines::default();
    let sink = lines.clone();
    let sink = Box::new(move |line| sink.lock().unwrap().push(line));
    let image = Image::start(Board::Mps2An386, sink).unwrap();
    Some((image, lines))
}

/// The micro:bit only counts instructions.
pub fn boards_with_rig() -> impl Iterator<Item = Board> {
    let all = Board::ALL.into_iter();
    all.filter(|board| *board != Board::Microbit)
}

/// Every effect of the crate, typical.
pub fn every_effect() -> Vec<Effect<f32>> {
    let typical = |each: &Description| {
        Effect::from_parameters(each.number, each.typical, f64::from(TICK)).unwrap()
    };
    DESCRIPTIONS.iter().map(typical).collect()
}

pub fn law(effects: &[Effect<f32>]) -> FastLaw<EFFECTS> {
    let eq13 = Law::new(1.0539, 10.5, 0.1114, 0.3969).unwrap();
    let with = |law: AugmentedLaw<f32, EFFECTS>, effect: &Effect<f32>| law.with(*effect).unwrap();
    FastLaw::new(effects.iter().fold(AugmentedLaw::new(eq13), with))
}

pub fn pack(law: &FastLaw<EFFECTS>) -> Vec<u8> {
    let mut buffer = [0; LARGEST];
    encode(law, &PackInfo::at(1.0 / TICK), &mut buffer)
        .unwrap()
        .to_vec()
}

/// A motion that sweeps in amplitude and frequency, with extremes and NaN among them.
pub fn motions(count: usize, random: &mut ChaCha8Rng) -> Vec<Motion<f32>> {
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

/// The payload of a NaN differs between processors; no force is NaN.
pub fn bits(forces: &[f32]) -> Vec<u32> {
    forces.iter().map(|force| force.to_bits()).collect()
}

/// The rig on the host and on `image`, both started.
pub fn started(
    setup: RigSetup<Specimen, 4, EFFECTS>,
    image: &mut Image<Emulator>,
) -> (
    Bench<Specimen, 4, EFFECTS>,
    ImageBench<'_, Specimen, Emulator, EFFECTS>,
) {
    let mut host = Bench::new(setup.clone()).unwrap();
    let mut bench = ImageBench::new(setup, image).unwrap();
    host.start().unwrap();
    bench.start().unwrap();
    (host, bench)
}

pub fn setup() -> RigSetup<Specimen, 4, EFFECTS> {
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
