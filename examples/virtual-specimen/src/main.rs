//! Displacement and force of a damper that is not there, as voltages for a data acquisition that is set up, and as a recording.
//!
//! SysTick gives 10 000 ticks a second. Each tick puts displacement and force on the two outputs of the DAC, PA4 and PA5. `main` prints
//! every tenth tick as a row of CSV, and the results of each cycle on the other stream.
#![no_std]
#![no_main]

mod specimen;

use core::cell::{Cell, RefCell};
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::asm::wfi;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::{entry, exception};
use cortex_m_semihosting::{debug, heprintln, hprintln};
use critical_section::Mutex;
use mesh_damper::converter::Scale;
use mesh_damper::cycle::Cycle;
use panic_semihosting as _;
use stm32f4::stm32f405::{DAC, Peripherals};

use specimen::{Specimen, TICK_RATE};

/// The processor's clock, at which SysTick counts, Hz.
const PROCESSOR_CLOCK: u32 = 168_000_000;
/// Ticks per row of the recording.
const EVERY: u32 = 10;
/// mm and kN at 3.3 V; at 0 V the same with the other sign.
const FULL_SCALES: [f64; 2] = [0.2, 0.5];

/// The data of the interrupt.
struct Tick {
    dac: DAC,
    scales: [Scale; 2],
    specimen: Specimen,
    ticks: u32,
}

/// A row of the recording.
struct Row {
    ticks: u32,
    displacement: f32,
    force: f32,
}

/// Handed from `main` to the interrupt, which takes it at the first tick and owns it from then on.
static HANDED_OVER: Mutex<RefCell<Option<Tick>>> = Mutex::new(RefCell::new(None));
/// The last row and the last cycle, from the interrupt to `main`, which prints one before the next is there.
static ROW: Mutex<Cell<Option<Row>>> = Mutex::new(Cell::new(None));
static CYCLE: Mutex<Cell<Option<Cycle>>> = Mutex::new(Cell::new(None));
static OVER: AtomicBool = AtomicBool::new(false);

#[entry]
fn main() -> ! {
    let chip = Peripherals::take().expect("main runs once");
    chip.RCC
        .ahb1enr()
        .modify(|_, register| register.gpioaen().enabled());
    chip.RCC
        .apb1enr()
        .modify(|_, register| register.dacen().enabled());
    chip.GPIOA
        .moder()
        .modify(|_, register| register.moder4().analog().moder5().analog());
    chip.DAC
        .cr()
        .write(|register| register.en1().set_bit().en2().set_bit());
    let tick = Tick {
        dac: chip.DAC,
        scales: FULL_SCALES.map(|full| Scale::new(full, 0.0).expect("full scales are in range")),
        specimen: Specimen::new().expect("motion and law are in range"),
        ticks: 0,
    };
    critical_section::with(|section| HANDED_OVER.replace(section, Some(tick)));
    let mut core = cortex_m::Peripherals::take().expect("main runs once");
    core.SYST.set_clock_source(SystClkSource::Core);
    core.SYST.set_reload(PROCESSOR_CLOCK / TICK_RATE - 1);
    core.SYST.clear_current();
    core.SYST.enable_interrupt();
    hprintln!("time_s,displacement_mm,force_kN");
    core.SYST.enable_counter();
    loop {
        wfi();
        if let Some(row) = critical_section::with(|section| ROW.borrow(section).take()) {
            let milliseconds = row.ticks / (TICK_RATE / 1000);
            let (seconds, part) = (milliseconds / 1000, milliseconds % 1000);
            hprintln!("{}.{:03},{},{}", seconds, part, row.displacement, row.force);
        }
        if let Some(cycle) = critical_section::with(|section| CYCLE.borrow(section).take()) {
            heprintln!(
                "cycle: {} kN/mm, loss factor {}",
                cycle.stiffness,
                cycle.loss_factor
            );
        }
        if OVER.load(Ordering::Relaxed) {
            debug::exit(debug::EXIT_SUCCESS);
        }
    }
}

/// One tick.
#[exception]
fn SysTick() {
    static mut TICK: Option<Tick> = None;

    if TICK.is_none() {
        *TICK = critical_section::with(|section| HANDED_OVER.take(section));
    }
    let Some(tick) = TICK else { return };
    let Some(sample) = tick.specimen.tick() else {
        OVER.store(true, Ordering::Relaxed);
        return;
    };
    let [displacement, force] = &tick.scales;
    // 12 of the 16 bits.
    let displacement_code = displacement.encode(sample.displacement).code >> 4;
    let force_code = force.encode(sample.force).code >> 4;
    tick.dac.dhr12rd().write(|register| {
        register
            .dacc1dhr()
            .set(displacement_code)
            .dacc2dhr()
            .set(force_code)
    });
    if tick.ticks.is_multiple_of(EVERY) {
        let row = Row {
            ticks: tick.ticks,
            displacement: sample.displacement,
            force: sample.force,
        };
        critical_section::with(|section| ROW.borrow(section).set(Some(row)));
    }
    if sample.cycle.is_some() {
        critical_section::with(|section| CYCLE.borrow(section).set(sample.cycle));
    }
    tick.ticks += 1;
}
