//! An emulated board whose link is a serial port, on a pseudo-terminal; its converters are simulated next to it.

mod emulated;
#[path = "emulated/orders.rs"]
mod orders;

use std::fs::OpenOptions;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};

use mesh_damper::effects::{AugmentedLaw, Effect, StickSlip};
use mesh_damper::frame::{FrameBuffer, VERSION};
use mesh_damper::law::Law;
use mesh_damper::message::Request;
use mesh_damper::rig::{State, TripCause};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_link::image::{Board, SERIAL};
use mesh_damper_link::lockstep::{Image, ImageBench, LinkError, Serial, Wire, run_rig_on};
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{Controlled as _, RigSetup, TICK_RATE, run_rig};
use orders::Orders;

/// A board that runs until it is dropped.
struct Emulated {
    process: Child,
    port: PathBuf,
    orders: Orders,
}

impl Emulated {
    /// `None`, with a message, without an emulator.
    fn new() -> Option<Self> {
        let board = Board::Mps2An386;
        let elf = emulated::image(&SERIAL, board)?;
        let orders = Orders::new();
        let mut process = board
            .emulator_with("pty", &elf)
            .unwrap()
            .args(["-semihosting-config", "enable=on,target=native"])
            .args(orders.arguments())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // Its output is: char device redirected to /dev/pts/1 (label serial0).
        let mut said = String::new();
        BufReader::new(process.stdout.take().unwrap())
            .read_line(&mut said)
            .unwrap();
        let port = said
            .split_whitespace()
            .find(|word| word.starts_with("/dev"));
        let port = PathBuf::from(port.unwrap_or_else(|| panic!("no port in {said:?}")));
        Some(Self {
            process,
            port,
            orders,
        })
    }
}

impl Drop for Emulated {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn setup() -> RigSetup<Specimen, 1, 1> {
    let specimen = Specimen::of_density(3.0, 0.1);
    let c = specimen.coefficients();
    let law = Law::new(c.k1 as f32, c.k3 as f32, c.c as f32, c.alpha as f32).unwrap();
    let slip = Effect::StickSlip(StickSlip::new(&[(5.0, 2e-3)]).unwrap());
    let law = AugmentedLaw::new(law).with(slip).unwrap();
    let programme = Programme::new(TICK_RATE, 1).unwrap();
    let programme = programme.with(Block::sine(0.1, 20.0, 1).unwrap()).unwrap();
    RigSetup::new(specimen, law, programme, 1)
}

/// The second run finds a board that has had requests before, which restarts.
#[test]
fn a_run_over_a_serial_port_is_that_in_this_process() {
    let Some(board) = Emulated::new() else {
        return;
    };
    let here = run_rig(setup(), |_| ()).unwrap();
    assert!(here.cycles.len() > 1 && here.faults.is_empty());
    for _ in 0..2 {
        let mut image = Image::at(&board.port).unwrap();
        let there = run_rig_on(&mut image, setup(), |_| ()).unwrap();
        assert_eq!(there, here);
    }
}

/// Stray bytes, some of which look like the beginning of a frame.
#[test]
fn noise_on_the_line_is_passed_over() {
    let Some(board) = Emulated::new() else {
        return;
    };
    let mut image = Image::at(&board.port).unwrap();
    let mut noise = OpenOptions::new().write(true).open(&board.port).unwrap();
    let before = image.statistics().unwrap();
    for junk in [
        &b"\x00\xff"[..],
        b"M",
        b"MMD\x06\x09",
        b"MD\x06\x09\0\0\0\0\x01\0\xff\xff",
    ] {
        noise.write_all(junk).unwrap();
        let after = image.statistics().unwrap();
        assert_eq!(after.log_lost, before.log_lost);
    }
}

/// The log shows it, from which the test knows that it has been silent for long enough.
#[test]
fn a_board_whose_host_falls_silent_drops_its_line() {
    let Some(mut board) = Emulated::new() else {
        return;
    };
    let mut image = Image::at(&board.port).unwrap();
    let mut log = board.process.stderr.take().unwrap();
    let mut bench = ImageBench::new(setup(), &mut image).unwrap();
    bench.start().unwrap();
    for _ in 0..3 {
        assert_eq!(bench.tick().unwrap().state, State::Running);
    }
    assert!(bench.is_enabled());
    // Messages of the start and the first block came before.
    let mut said = [0; 256];
    let before = log.read(&mut said).unwrap();
    assert!(before > 0 && log.read(&mut said).unwrap() > 0);
    let seen = bench.tick().unwrap();
    assert_eq!(seen.state, State::Faulted(TripCause::TickOverrun));
    assert!(!bench.is_enabled());
}

#[test]
fn a_board_that_restarts_in_the_middle_says_so() {
    let Some(board) = Emulated::new() else {
        return;
    };
    let mut image = Image::at(&board.port).unwrap();
    image.rest().unwrap();
    board.orders.give("system_reset");
    assert_eq!(image.rest(), Err(LinkError::Restarted));
}

#[test]
fn a_board_that_stands_still_is_silent_and_a_cable_that_is_pulled_is_gone() {
    let Some(mut board) = Emulated::new() else {
        return;
    };
    let mut image = Image::at(&board.port).unwrap();
    board.orders.give("stop");
    let silent = image.rest().unwrap_err();
    let port = board.port.display().to_string();
    assert_eq!(silent, LinkError::SilentBoard(port.clone()));
    board.process.kill().unwrap();
    board.process.wait().unwrap();
    let gone = image.rest().unwrap_err();
    assert!(
        matches!(&gone, LinkError::PortGone { port: named, .. } if *named == port),
        "{gone}"
    );
    let refused = Image::<Serial>::at(&board.port).unwrap_err().to_string();
    assert!(refused.contains("cannot be opened"), "{refused}");
}

#[test]
fn a_file_is_no_serial_port() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let refused = Image::at(file.path()).unwrap_err().to_string();
    assert!(refused.contains("is no serial port"), "{refused}");
    let refused = Image::at(Path::new("/nowhere")).unwrap_err().to_string();
    assert!(refused.contains("cannot be opened"), "{refused}");
}

/// A board of another version, which answers in its own.
struct Other;

impl Wire for Other {
    fn send(&mut self, _: &[u8]) -> Result<(), LinkError> {
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, LinkError> {
        let mut frame = FrameBuffer::new();
        Request::Rest.write(0, &mut frame);
        let bytes = frame.bytes();
        let (covered, _) = bytes.split_at(bytes.len() - 4);
        let mut covered = covered.to_vec();
        covered[2] = VERSION + 1;
        let checksum = crc(&covered);
        covered.extend(checksum.to_le_bytes());
        buffer[..covered.len()].copy_from_slice(&covered);
        Ok(covered.len())
    }
}

/// Ethernet's CRC-32, bit by bit.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 }
        })
    })
}

#[test]
fn a_board_of_another_version_is_told_from_a_silent_one() {
    let mut image = Image::on(Other);
    assert_eq!(image.rest(), Err(LinkError::OtherVersion(VERSION + 1)));
}
