//! The force of a metal mesh from a timer interrupt of an STM32F405, 10 000 times a second.
//!
//! A sine of 0.1 mm at 1 Hz moves a mesh of 3 g/cm³. Its force leaves on the DAC (PA4), stiffness and loss factor of each
//! cycle on USART2 (PA2, 115 200 baud).
#![no_std]
#![no_main]

mod simulation;

use core::cell::{Cell, RefCell};
use core::fmt::Write as _;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::asm::wfi;
use cortex_m_rt::entry;
use critical_section::Mutex;
use mesh_damper::cycle::Cycle;
use panic_halt as _;
use stm32f4xx_hal::dac::{C1, DacOut, DacPin};
use stm32f4xx_hal::pac::{NVIC, Peripherals, TIM2, interrupt};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;
use stm32f4xx_hal::timer::{CounterHz, Event, Flag};

use simulation::{Simulation, TICK_RATE};

/// Force at which the DAC's 12 bits end, kN. 0 kN is at their middle.
const FULL_SCALE: f32 = 0.25;

/// What the interrupt works with.
struct Tick {
    timer: CounterHz<TIM2>,
    dac: C1,
    simulation: Simulation,
}

/// From `main` to the interrupt, which takes it at the first tick and owns it from then on.
static HANDED_OVER: Mutex<RefCell<Option<Tick>>> = Mutex::new(RefCell::new(None));

/// The last complete cycle, from the interrupt to `main`.
static COMPLETED: Mutex<Cell<Option<Cycle>>> = Mutex::new(Cell::new(None));

/// Ticks that were not over when the next one was due.
static OVERRUNS: AtomicU32 = AtomicU32::new(0);

#[entry]
fn main() -> ! {
    let peripherals = Peripherals::take().expect("main runs once");
    // The internal oscillator is on every board, and within 1 %. A crystal of 8 MHz: `Config::hse(8.MHz())`.
    let mut rcc = peripherals.RCC.freeze(Config::hsi().sysclk(168.MHz()));
    let pins = peripherals.GPIOA.split(&mut rcc);
    let mut serial = peripherals
        .USART2
        .tx(pins.pa2, 115_200.bps(), &mut rcc)
        .expect("the clock divides to this baud rate");
    let mut dac = peripherals.DAC.constrain(pins.pa4.into_analog(), &mut rcc);
    dac.enable();
    let mut timer = peripherals.TIM2.counter_hz(&mut rcc);
    timer.listen(Event::Update);
    timer
        .start(TICK_RATE.Hz())
        .expect("the timer divides its clock to this rate");
    let tick = Tick {
        timer,
        dac,
        simulation: Simulation::new().expect("the constants are in range"),
    };
    critical_section::with(|section| HANDED_OVER.replace(section, Some(tick)));
    // SAFETY: no critical section is open that this would break.
    unsafe { NVIC::unmask(interrupt::TIM2) };
    loop {
        wfi();
        let completed = critical_section::with(|section| COMPLETED.borrow(section).take());
        if let Some(cycle) = completed {
            let overruns = OVERRUNS.load(Ordering::Relaxed);
            // A transmitter has no errors to report.
            let _ = writeln!(
                serial,
                "{:.4} kN/mm, loss factor {:.4}, {overruns} overruns\r",
                cycle.stiffness, cycle.loss_factor
            );
        }
    }
}

/// One tick. Must be over within 100 µs, when the next one is due.
#[interrupt]
fn TIM2() {
    static mut TICK: Option<Tick> = None;

    if TICK.is_none() {
        *TICK = critical_section::with(|section| HANDED_OVER.take(section));
    }
    let Some(tick) = TICK else { return };
    tick.timer.clear_flags(Flag::Update);
    let (force, completed) = tick.simulation.tick();
    tick.dac.set_value(code(force));
    if let Some(cycle) = completed {
        critical_section::with(|section| COMPLETED.borrow(section).set(Some(cycle)));
    }
    if tick.timer.flags().contains(Flag::Update) {
        OVERRUNS.fetch_add(1, Ordering::Relaxed);
    }
}

/// The DAC's code for a force in kN, at most at either end of its scale.
fn code(force: f32) -> u16 {
    // The conversion saturates below at 0.
    ((2048.0 + force / FULL_SCALE * 2047.0) as u16).min(4095)
}
