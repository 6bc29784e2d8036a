//! An image refuses damaged packs and packs for another rate, and checks a pack between ticks.

use mesh_damper::converter::Scale;
use mesh_damper::effects::Motion;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::message::Setup;
use mesh_damper::pack::{LARGEST, PackInfo, encode};
use mesh_damper::rig::{RigSettings, StreamSettings};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_link::image::Board;
use mesh_damper_link::lockstep::{Emulator, Image, ImageBench, LinkError, LogLevel, LogLine};
use mesh_damper_output::error::InputError;
use mesh_damper_rig::{Bench, Controlled as _};

use crate::support::{
    EFFECTS, boards_with_rig, every_effect, image_on, law, logged_image, pack, setup, started,
};

#[test]
fn a_damaged_pack_is_refused_and_the_law_in_force_stays() {
    let Some((mut image, lines)) = logged_image() else {
        return;
    };
    let law = law(&every_effect()[..2]);
    image.send_pack(&pack(&law)).unwrap();
    let motion = Motion::at(0.07, 2.0);
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
        assert_eq!(InputError::from(error).remedy, what_to_do);
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
    // The next version, whose checksum cannot be checked: the refusal reports the version, not the checksum.
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
/// rig runs. The running law stays.
#[test]
fn a_pack_for_another_rate_is_refused() {
    const OLD: &[u8] = include_bytes!("../../../../tests/wire/packs/version-6-effects.mdcp");
    let is_of_the_rate = |error: LinkError| {
        const SAID: &str = "the image refused it: tick_rate: ";
        let said = error.to_string();
        assert!(said.starts_with(SAID), "{said}");
        let remedy = InputError::from(error).remedy;
        assert_eq!(remedy, "export the model with the rig's --tick-rate");
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
        // A law alone has no rate.
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
        let (mut host, mut bench) = started(setup.clone(), &mut image);
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
