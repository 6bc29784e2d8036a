//! Frames that are lost, repeated, cut, damaged or late change nothing.

use mesh_damper::fast_law::RunningLaw;
use mesh_damper_link::image::{Board, FIRMWARE};
use mesh_damper_link::lockstep::{Emulator, Image, LinkError, Wire, run_rig_on};
use mesh_damper_rig::{RigRun, run_rig};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::emulated;
use crate::support::{EFFECTS, bits, every_effect, law, motions, pack, setup};

/// Frames that replace `frame` if it is lost (0), repeated (1), cut (2) or damaged (3); `frame` unchanged for any other `kind`.
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

/// Number of the fault that [`disturbed`] does not implement: the frame comes after a later one.
const LATE: usize = 4;
const KINDS: usize = 5;

/// Disturbs frames in both directions.
struct Faulty<W> {
    inner: W,
    random: ChaCha8Rng,
    when: When,
    /// The request that was sent last has not reached the image.
    lost: bool,
    /// Late answers and late requests, each with the number of frames of its direction that go before it.
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
            // As the emulator's watchdog would report in time.
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

/// Any fault costs one more frame: its exchange and the next one take three frames at most. Where faults come as often as in the next
/// test, only about half of the tries succeed, and some exchanges take more.
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
