//! A damper's law at the rate of a timer of this chip, without requests for ticks.
//!
//! TIM2 interrupts 10 000 times a second. Each interrupt is a tick of [`excited::Excited`]. `main` prints the stiffness and loss
//! factor of each cycle, and the number of ticks and the milliseconds of another clock, SysTick.
#![no_std]
#![no_main]

mod excited;
mod motion;
#[rustfmt::skip]
#[allow(dead_code, reason = "this firmware does not ask which model it has, nor for its operating range")]
mod mount;

use core::cell::{Cell, RefCell};
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use cortex_m::asm::wfi;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::{entry, exception};
use cortex_m_semihosting::{debug, hprintln};
use critical_section::Mutex;
use panic_semihosting as _;
use stm32f4::stm32f405::{NVIC, Peripherals, TIM2, interrupt};

use excited::{Ended, Excited, TICK_RATE};
use mount::DamperLaw;

/// Rate at which TIM2 counts, Hz: 1 GHz in the emulator. On a board, the rate to which RCC is set.
const TIMER_CLOCK: u32 = 1_000_000_000;
/// Rate at which SysTick counts, Hz: the processor's clock.
const PROCESSOR_CLOCK: u32 = 168_000_000;
/// The motion ends long before this time; ms.
const TOO_LONG: u32 = 60_000;

/// The data of the interrupt.
struct Tick {
    timer: TIM2,
    excited: Excited,
}

/// Handed from `main` to the interrupt, which takes it at the first tick and owns it from then on.
static HANDED_OVER: Mutex<RefCell<Option<Tick>>> = Mutex::new(RefCell::new(None));
/// The last cycle that ended, with the ticks and milliseconds until then; passed from the interrupt to `main`.
static ENDED: Mutex<Cell<Option<(Ended, u32, u32)>>> = Mutex::new(Cell::new(None));
static OVER: AtomicBool = AtomicBool::new(false);
/// Checksum of all forces, once the motion is over.
static FORCES: AtomicU32 = AtomicU32::new(0);
/// Number of ticks that had not ended when the next one was due.
static OVERRUNS: AtomicU32 = AtomicU32::new(0);
static MILLISECONDS: AtomicU32 = AtomicU32::new(0);

#[entry]
fn main() -> ! {
    static mut LAW: DamperLaw = DamperLaw::empty();

    let excited = Excited::new(LAW).expect("motion and law are in range");
    let timer = Peripherals::take().expect("main runs once").TIM2;
    let mut core = cortex_m::Peripherals::take().expect("main runs once");
    core.SYST.set_clock_source(SystClkSource::Core);
    core.SYST.set_reload(PROCESSOR_CLOCK / 1000 - 1);
    core.SYST.clear_current();
    core.SYST.enable_interrupt();
    core.SYST.enable_counter();
    // The update event is not triggered by hand: the emulator's timer would then add the time since power-on to every period. Without
    // a prescaler, no such event is needed.
    timer.dier().write(|register| register.uie().set_bit());
    timer
        .arr()
        .write(|register| register.arr().set(TIMER_CLOCK / TICK_RATE - 1));
    timer.cr1().write(|register| register.cen().set_bit());
    let tick = Tick { timer, excited };
    critical_section::with(|section| HANDED_OVER.replace(section, Some(tick)));
    // SAFETY: no critical section is open that this would break.
    unsafe { NVIC::unmask(interrupt::TIM2) };
    loop {
        wfi();
        if let Some((ended, ticks, milliseconds)) =
            critical_section::with(|section| ENDED.borrow(section).take())
        {
            hprintln!(
                "sine {}: {} kN/mm, loss factor {}, {} ticks, {} ms, {} overruns",
                ended.sine,
                ended.cycle.stiffness,
                ended.cycle.loss_factor,
                ticks,
                milliseconds,
                OVERRUNS.load(Ordering::Relaxed)
            );
        } else if OVER.load(Ordering::Relaxed) {
            hprintln!("forces {:08x}", FORCES.load(Ordering::Relaxed));
            debug::exit(debug::EXIT_SUCCESS);
        }
    }
}

/// One tick. It must end within 100 µs, when the next one is due.
#[interrupt]
fn TIM2() {
    static mut TICK: Option<Tick> = None;
    static mut TICKS: u32 = 0;

    if TICK.is_none() {
        *TICK = critical_section::with(|section| HANDED_OVER.take(section));
    }
    let Some(tick) = TICK else { return };
    tick.timer
        .sr()
        .modify(|_, register| register.uif().clear_bit());
    *TICKS += 1;
    match tick.excited.tick() {
        Some(Some(ended)) => {
            let milliseconds = MILLISECONDS.load(Ordering::Relaxed);
            let ended = Some((ended, *TICKS, milliseconds));
            critical_section::with(|section| ENDED.borrow(section).set(ended));
        }
        // Only once: the interrupt continues, and `main` prints the values of the motion alone.
        None if !OVER.load(Ordering::Relaxed) => {
            FORCES.store(tick.excited.forces().0, Ordering::Relaxed);
            OVER.store(true, Ordering::Relaxed);
        }
        Some(None) | None => {}
    }
    if tick.timer.sr().read().uif().bit_is_set() {
        OVERRUNS.fetch_add(1, Ordering::Relaxed);
    }
}

/// A clock that is independent of the timer.
#[exception]
fn SysTick() {
    let before = MILLISECONDS.fetch_add(1, Ordering::Relaxed);
    assert!(before < TOO_LONG, "the timer gives no ticks");
}
