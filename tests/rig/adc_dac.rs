//! The converters' drivers, compared byte for byte with the datasheets.

use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use embedded_hal_mock::eh1::spi::{Mock, Transaction};
use mesh_damper::adc::{AdcError, Ads8688};
use mesh_damper::converter::Scale;
use mesh_damper::dac::{Ad5761, CONTROL, DacError};

use crate::support::{kilonewtons, unit};

fn transfer(sent: &[u8], received: &[u8]) -> [Transaction<u8>; 3] {
    [
        Transaction::transaction_start(),
        Transaction::transfer_in_place(sent.to_vec(), received.to_vec()),
        Transaction::transaction_end(),
    ]
}

fn write(sent: &[u8]) -> [Transaction<u8>; 3] {
    [
        Transaction::transaction_start(),
        Transaction::write_vec(sent.to_vec()),
        Transaction::transaction_end(),
    ]
}

fn adc_start() -> Vec<Transaction<u8>> {
    [
        write(&[0x85, 0, 0, 0]),
        write(&[0x0B, 0x05, 0]),
        transfer(&[0x0A, 0, 0], &[0, 0, 0x05]),
        write(&[0x0D, 0x02, 0]),
        transfer(&[0x0C, 0, 0], &[0, 0, 0x02]),
        write(&[0x0B, 0, 0]),
        transfer(&[0x0A, 0, 0], &[0, 0, 0]),
        write(&[0x0D, 0, 0]),
        transfer(&[0x0C, 0, 0], &[0, 0, 0]),
    ]
    .concat()
}

fn dac_start() -> Vec<Transaction<u8>> {
    [
        write(&[0x0F, 0, 0]),
        write(&[0x04, 0x02, 0x68]),
        write(&[0x0C, 0, 0]),
        // Bits 12 and 11 are status.
        transfer(&[0, 0, 0], &[0x0C, 0x1A, 0x68]),
        write(&[0x03, 0x80, 0x00]),
    ]
    .concat()
}

#[test]
fn adc_reads_displacement_then_force() {
    let expected = [
        adc_start(),
        // The first frame only selects a channel: its result belongs to an unknown channel.
        transfer(&[0xC0, 0, 0, 0], &[0, 0, 0x12, 0x34]).to_vec(),
        transfer(&[0xC4, 0, 0, 0], &[0, 0, 0xC0, 0x00]).to_vec(),
        transfer(&[0xC0, 0, 0, 0], &[0, 0, 0x40, 0x00]).to_vec(),
        transfer(&[0xC4, 0, 0, 0], &[0, 0, 0xFF, 0xFF]).to_vec(),
        transfer(&[0xC0, 0, 0, 0], &[0, 0, 0x00, 0x00]).to_vec(),
    ]
    .concat();
    let mut adc = Ads8688::new(Mock::new(&expected), unit(), kilonewtons()).unwrap();
    let reading = adc.read().unwrap();
    // 0xC000 is half of full scale, 0x4000 minus half; force is inverted and reads 0.25 kN at rest.
    assert_eq!(reading.displacement.value, 0.5);
    assert_eq!(reading.force.value, 2.5 - 0.25);
    assert!(!reading.displacement.clipped() && !reading.force.clipped());
    let reading = adc.read().unwrap();
    assert_eq!(reading.displacement.value, 32767.0 / 32768.0);
    assert!(reading.displacement.clipped() && reading.force.clipped());
    adc.release().done();
}

#[test]
fn adc_that_does_not_hold_its_register_is_refused() {
    let expected = [
        write(&[0x85, 0, 0, 0]),
        write(&[0x0B, 0x05, 0]),
        transfer(&[0x0A, 0, 0], &[0xFF, 0xFF, 0xFF]),
    ]
    .concat();
    let mut spi = Mock::new(&expected);
    let refused = Ads8688::new(spi.clone(), unit(), kilonewtons()).unwrap_err();
    let register = AdcError::Register {
        address: 5,
        expected: 5,
        found: 0xFF,
    };
    assert_eq!(refused, register);
    assert_eq!(
        refused.to_string(),
        "register 0x05 of the ADC reads 0xff after 0x05 was written: is it an ADS8688, powered, on this chip select, and its \
         data line connected?"
    );
    spi.done();
}

/// A bus without a part: the function computes the received bytes from the sent ones.
struct NoPart<F>(F);

impl<F> ErrorType for NoPart<F> {
    type Error = ErrorKind;
}

impl<F: FnMut(&mut [u8])> SpiDevice for NoPart<F> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        for operation in operations {
            match operation {
                Operation::TransferInPlace(words) => (self.0)(words),
                Operation::Write(words) => (self.0)(&mut words.to_vec()),
                _ => unreachable!("no driver asks for this"),
            }
        }
        Ok(())
    }
}

/// Neither part is detected on a data line that is held low or high, is connected to the sent data, or repeats the data of the
/// previous frame.
#[test]
fn a_line_that_is_held_or_echoes_is_no_part() {
    fn check<F: FnMut(&mut [u8])>(line: impl Fn() -> F, found: u8, read: u16) {
        let refused = Ads8688::new(NoPart(line()), unit(), kilonewtons());
        let register = AdcError::Register {
            address: 5,
            expected: 5,
            found,
        };
        assert_eq!(refused.err(), Some(register));
        let refused = Ad5761::new(NoPart(line()), unit()).err();
        assert_eq!(refused, Some(DacError::Control { read }));
    }
    check(|| |words: &mut [u8]| words.fill(0), 0, 0);
    check(|| |words: &mut [u8]| words.fill(0xFF), 0xFF, 0x07FF);
    check(|| |_: &mut [u8]| {}, 0, 0);
    check(
        || {
            let mut before = [0; 4];
            move |words: &mut [u8]| {
                let now = words.to_vec();
                words.copy_from_slice(&before[..words.len()]);
                before[..now.len()].copy_from_slice(&now);
            }
        },
        0,
        0,
    );
}

/// A single wrong bit is detected: the three bits of a range at either level, the others if they are not 0 as required.
#[test]
fn each_bit_of_a_range_is_checked() {
    for bit in 0..8 {
        for stuck in [false, true] {
            let mut registers = [0u8; 64];
            let part = |words: &mut [u8]| {
                if let [address, value, out] = words {
                    let register = &mut registers[usize::from(*address >> 1)];
                    if *address & 1 != 0 {
                        *register = *value;
                    }
                    let mask = 1 << bit;
                    *out = *register & !mask | if stuck { mask } else { 0 };
                }
            };
            let refused = Ads8688::new(NoPart(part), unit(), kilonewtons()).is_err();
            assert_eq!(refused, stuck || bit < 3, "bit {bit} stuck at {stuck}");
        }
    }
}

#[test]
fn dac_writes_offset_binary() {
    let expected = [
        dac_start(),
        write(&[0x03, 0x80, 0x00]).to_vec(),
        write(&[0x03, 0xC0, 0x00]).to_vec(),
        write(&[0x03, 0x00, 0x00]).to_vec(),
        write(&[0x03, 0xFF, 0xFF]).to_vec(),
        write(&[0x03, 0x80, 0x00]).to_vec(),
    ]
    .concat();
    let mut dac = Ad5761::new(Mock::new(&expected), unit()).unwrap();
    assert!(!dac.write(0.0).unwrap().clipped);
    assert!(!dac.write(0.5).unwrap().clipped);
    assert!(!dac.write(-1.0).unwrap().clipped);
    assert!(dac.write(1.0).unwrap().clipped);
    assert!(dac.write(f32::NAN).unwrap().clipped);
    dac.release().done();
}

#[test]
fn dac_with_another_control_register_is_refused() {
    let expected = [
        write(&[0x0F, 0, 0]),
        write(&[0x04, 0x02, 0x68]),
        write(&[0x0C, 0, 0]),
        transfer(&[0, 0, 0], &[0, 0, 0]),
    ]
    .concat();
    let mut spi = Mock::new(&expected);
    let refused = Ad5761::new(spi.clone(), unit()).unwrap_err();
    assert_eq!(refused, DacError::Control { read: 0 });
    spi.done();
}

/// The DAC's frames of a read-back of its control register and its output.
fn dac_verified(control: u16, output: u16) -> Vec<Transaction<u8>> {
    let [c, o] = [control, output].map(u16::to_be_bytes);
    [
        write(&[0x0C, 0, 0]),
        transfer(&[0x0B, 0, 0], &[0x0C, c[0], c[1]]),
        transfer(&[0, 0, 0], &[0x0B, o[0], o[1]]),
    ]
    .concat()
}

#[test]
fn dac_starts_at_the_commands_zero() {
    // 0 mm is 0.25 of the full scale above midscale.
    let zero = Scale::new(1.0, 0.25).unwrap();
    let mut expected = dac_start();
    let last = expected.len() - 3;
    expected.splice(last.., write(&[0x03, 0xA0, 0x00]));
    expected.extend(dac_verified(CONTROL, 0xA000));
    let mut dac = Ad5761::new(Mock::new(&expected), zero).unwrap();
    assert_eq!(dac.verify(), Ok(()));
    dac.release().done();
}

#[test]
fn dac_is_read_back() {
    let driven = 0xC000;
    let status = |read| Err(DacError::Status { read });
    for (control, output, said) in [
        (CONTROL, driven, Ok(())),
        // Bits without a meaning.
        (CONTROL | 0xE000, driven, Ok(())),
        (CONTROL | 0x1000, driven, status(0x1000)),
        (CONTROL | 0x0800, driven, status(0x0800)),
        // After a loss of its supply; with another range; with another output.
        (0, 0, Err(DacError::Control { read: 0 })),
        (
            CONTROL | 1,
            driven,
            Err(DacError::Control { read: CONTROL | 1 }),
        ),
        (
            CONTROL,
            0x8000,
            Err(DacError::Output {
                expected: driven,
                read: 0x8000,
            }),
        ),
    ] {
        let mut expected = [dac_start(), write(&[0x03, 0xC0, 0x00]).to_vec()].concat();
        expected.extend(dac_verified(control, output));
        let mut dac = Ad5761::new(Mock::new(&expected), unit()).unwrap();
        dac.write(0.5).unwrap();
        assert_eq!(dac.verify(), said);
        dac.release().done();
    }
}

/// A part with the correct registers stays unchanged. Any other is set up, and then outputs 0.
#[test]
fn dac_is_restored_where_it_has_to_be() {
    let healthy = dac_verified(CONTROL, 0x8000);
    let lost = [dac_verified(0, 0), dac_start(), healthy.clone()].concat();
    let browned = [
        dac_verified(CONTROL | 0x0800, 0x8000),
        dac_start(),
        healthy.clone(),
    ]
    .concat();
    for expected in [[healthy.clone(), healthy].concat(), lost, browned] {
        let mut dac = Ad5761::new(Mock::new(&[dac_start(), expected].concat()), unit()).unwrap();
        dac.restore().unwrap();
        assert_eq!(dac.verify(), Ok(()));
        dac.release().done();
    }
    let dead = [
        dac_start(),
        dac_verified(0, 0),
        write(&[0x0F, 0, 0]).to_vec(),
        write(&[0x04, 0x02, 0x68]).to_vec(),
        write(&[0x0C, 0, 0]).to_vec(),
        transfer(&[0, 0, 0], &[0, 0, 0]).to_vec(),
    ]
    .concat();
    let mut dac = Ad5761::new(Mock::new(&dead), unit()).unwrap();
    assert_eq!(dac.restore(), Err(DacError::Control { read: 0 }));
    dac.release().done();
}

#[test]
fn adc_is_restored_and_in_step_again() {
    let one = [
        transfer(&[0xC0, 0, 0, 0], &[0, 0, 0x12, 0x34]),
        transfer(&[0xC4, 0, 0, 0], &[0, 0, 0xC0, 0x00]),
        transfer(&[0xC0, 0, 0, 0], &[0, 0, 0x40, 0x00]),
    ]
    .concat();
    let expected = [adc_start(), one.clone(), adc_start(), one].concat();
    let mut adc = Ads8688::new(Mock::new(&expected), unit(), kilonewtons()).unwrap();
    let before = adc.read().unwrap();
    adc.restore().unwrap();
    assert_eq!(adc.read().unwrap(), before);
    adc.release().done();
}

#[test]
fn errors_of_a_dac_say_the_remedy() {
    let said = |error: DacError<ErrorKind>| error.to_string();
    assert_eq!(
        said(DacError::Status { read: 0x0800 }),
        "the DAC reports 0x0800, a short circuit (0x1000) or a brown-out (0x0800): check its output and its supply, then set it up \
         again"
    );
    assert_eq!(
        said(DacError::Output {
            expected: 0xC000,
            read: 0
        }),
        "the output register of the DAC reads 0x0000 after 0xc000 was written: did it lose its supply?"
    );
}

/// Fails for `failures` transactions from `fails_at` on. Answers with zeros except for its registers, and counts the frames to ADC
/// channels.
struct Flaky {
    transactions: usize,
    fails_at: usize,
    failures: usize,
    first_bytes: Vec<u8>,
    registers: [u8; 128],
}

impl ErrorType for Flaky {
    type Error = ErrorKind;
}

impl SpiDevice for Flaky {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        let now = self.transactions;
        self.transactions += 1;
        if (self.fails_at..self.fails_at + self.failures).contains(&now) {
            return Err(ErrorKind::Overrun);
        }
        for operation in operations {
            match operation {
                Operation::TransferInPlace(words) => {
                    self.first_bytes.push(words[0]);
                    let register = self.registers[usize::from(words[0] >> 1)];
                    words.fill(0);
                    if let [_, _, out] = words {
                        *out = register;
                    }
                }
                Operation::Write(words) => {
                    self.first_bytes.push(words[0]);
                    if let [address, value, _] = words {
                        self.registers[usize::from(*address >> 1)] = *value;
                    }
                }
                _ => unreachable!("no driver asks for this"),
            }
        }
        Ok(())
    }
}

fn flaky(fails_at: usize) -> Flaky {
    Flaky {
        transactions: 0,
        fails_at,
        failures: 1,
        first_bytes: Vec::new(),
        registers: [0; 128],
    }
}

#[test]
fn bus_errors_are_values() {
    // Nine transactions to set up the ADC.
    for fails_at in 0..9 {
        let refused = Ads8688::new(flaky(fails_at), unit(), kilonewtons()).err();
        assert_eq!(refused, Some(AdcError::Bus(ErrorKind::Overrun)));
    }
    // Four transactions before the DAC's answer is checked.
    for fails_at in 0..4 {
        let refused = Ad5761::new(flaky(fails_at), unit()).err();
        assert_eq!(refused, Some(DacError::Bus(ErrorKind::Overrun)));
    }
}

#[test]
fn a_failed_read_never_exchanges_the_channels() {
    // Transactions 9–11 are the first reading (with its selection), 12 and 13 the second.
    for fails_at in [12, 13] {
        let mut adc = Ads8688::new(flaky(fails_at), unit(), kilonewtons()).unwrap();
        adc.read().unwrap();
        assert_eq!(adc.read(), Err(ErrorKind::Overrun));
        adc.read().unwrap();
        let sent = adc.release().first_bytes;
        assert_eq!(sent[sent.len() - 3..], [0xC0, 0xC4, 0xC0]);
    }
}
