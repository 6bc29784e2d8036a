//! A damper in a timer interrupt of an STM32F405: motion in, the law's force out, 10 000 times a second.
//!
//! The chip's ADC reads displacement (PA0) and force (PA1). An AD5761R on SPI1 outputs the force of the law, and PB1 enables the
//! actuator. USART2 (PA2, 115 200 baud) reports the stiffness and loss factor of each cycle.
#![no_std]
#![no_main]

mod on_chip;

use core::cell::{Cell, RefCell};
use core::fmt::Write as _;

use cortex_m::asm::wfi;
use cortex_m_rt::entry;
use critical_section::Mutex;
use embedded_hal_bus::spi::{ExclusiveDevice, NoDelay};
use mesh_damper::amplitude_independent::{self, Effects};
use mesh_damper::converter::Scale;
use mesh_damper::dac::{Ad5761, SPI_MODE};
use mesh_damper::rig::{
    CycleReport, DamperEmulation, DamperEmulationSettings, EmulationController, SpiActuator, State,
    TripCause, Wiring,
};
use mesh_damper::static_law::StaticLaw;
use panic_halt as _;
use stm32f4xx_hal::gpio::{Output, PA4, PB1, PinState};
use stm32f4xx_hal::pac::{NVIC, Peripherals, SPI1, TIM2, TIM5, interrupt};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;
use stm32f4xx_hal::spi::Spi;
use stm32f4xx_hal::timer::{CounterHz, CounterUs, Event, Flag};

use on_chip::OnChip;

/// Ticks per second.
const TICK_RATE: u32 = 10_000;
/// Rate at which the clock counts, Hz.
const CLOCK_RATE: u32 = 1_000_000;
/// Density of the mesh, g/cm³.
const DENSITY: f32 = 3.0;
/// Displacement at either end of the ADC's range, mm.
const TRAVEL: f64 = 0.5;
/// Force at either end of the ADC's range and of the DAC's, kN.
const FORCE: f64 = 5.0;
/// Half width of the band in which the displacement is at rest, mm: four steps of the ADC's 12 bits.
const REST_BAND: f64 = 4.0 * 2.0 * TRAVEL / 4096.0;

/// 4 KiB, most of it the table of |v|^α. It stays in a static and is filled there.
type DamperLaw = StaticLaw<Effects>;
type Dac = ExclusiveDevice<Spi<SPI1>, PA4<Output>, NoDelay>;
type Damper = DamperEmulation<OnChip, SpiActuator<Dac, PB1<Output>>, &'static mut DamperLaw>;

/// The data of the interrupt.
struct Tick {
    timer: CounterHz<TIM2>,
    /// Counts all the time, independent of the timer that triggers the ticks. The processor's cycle counter is not suitable: it stops
    /// while `main` sleeps.
    clock: CounterUs<TIM5>,
    damper: Damper,
}

/// Handed from `main` to the interrupt, which takes it at the first tick and owns it from then on.
static HANDED_OVER: Mutex<RefCell<Option<Tick>>> = Mutex::new(RefCell::new(None));
/// The last complete cycle, from the interrupt to `main`.
static COMPLETED: Mutex<Cell<Option<CycleReport>>> = Mutex::new(Cell::new(None));
/// The cause of the damper's trip, from the interrupt to `main`.
static TRIPPED: Mutex<Cell<Option<TripCause>>> = Mutex::new(Cell::new(None));

#[entry]
fn main() -> ! {
    static mut LAW: DamperLaw = DamperLaw::empty();

    let peripherals = Peripherals::take().expect("main runs once");
    // Every board has the internal oscillator, which is accurate to 1 %. For a crystal of 8 MHz use `Config::hse(8.MHz())`.
    let mut rcc = peripherals.RCC.freeze(Config::hsi().sysclk(168.MHz()));
    let a = peripherals.GPIOA.split(&mut rcc);
    let b = peripherals.GPIOB.split(&mut rcc);
    // This comes first: the actuator stays off during the checks below, also if one of them panics.
    let enable = b.pb1.into_push_pull_output_in_state(PinState::Low);
    let mut serial = peripherals
        .USART2
        .tx(a.pa2, 115_200.bps(), &mut rcc)
        .expect("the clock divides to this baud rate");

    let scale = |full_scale| Scale::new(full_scale, 0.0).expect("the full scale is in range");
    let wiring = Wiring {
        displacement: scale(TRAVEL),
        force: scale(FORCE),
        command: scale(FORCE),
    };
    let sensors = OnChip::new(
        peripherals.ADC1,
        (a.pa0.into_analog(), wiring.displacement),
        (a.pa1.into_analog(), wiring.force),
        &mut rcc,
    );
    let pins = (Some(a.pa5), Some(a.pa6), Some(a.pa7));
    let bus = peripherals.SPI1.spi(pins, SPI_MODE, 21.MHz(), &mut rcc);
    let Ok(bus) = ExclusiveDevice::new_no_delay(bus, a.pa4.into_push_pull_output());
    let dac = Ad5761::new(bus, wiring.command).expect("an AD5761R is connected");
    let actuator = SpiActuator::new(dac, enable);

    // ANCHOR: law
    let (law, effects) = amplitude_independent::parts(DENSITY).expect("the density is in range");
    LAW.set(law, effects);
    let settings = DamperEmulationSettings {
        tick_rate: TICK_RATE.into(),
        clock_rate: CLOCK_RATE.into(),
        rest_band: REST_BAND,
        ..DamperEmulationSettings::default()
    };
    let controller = EmulationController::new(&settings, &wiring, LAW);
    let controller = controller.expect("the settings are in range");
    let mut damper = Damper::wire(controller, sensors, actuator);
    // ANCHOR_END: law

    let mut clock = peripherals.TIM5.counter_us(&mut rcc);
    clock
        .start(u32::MAX.micros())
        .expect("the clock has 32 bits");
    let mut timer = peripherals.TIM2.counter_hz(&mut rcc);
    timer.listen(Event::Update);
    timer
        .start(TICK_RATE.Hz())
        .expect("the timer divides its clock to this rate");
    // This comes last, so that nothing panics while the actuator is enabled.
    damper.start().expect("the enable line rises");
    critical_section::with(|section| {
        let tick = Tick {
            timer,
            clock,
            damper,
        };
        HANDED_OVER.replace(section, Some(tick));
    });
    // SAFETY: no critical section is open that this would break.
    unsafe { NVIC::unmask(interrupt::TIM2) };

    let mut stopped = false;
    loop {
        wfi();
        // A transmitter has no errors to report.
        if let Some(report) = critical_section::with(|section| COMPLETED.borrow(section).take()) {
            let _ = writeln!(
                serial,
                "cycle {}: {:.4} kN/mm, loss factor {:.4}, {:.4} mm\r",
                report.cycle,
                report.model.stiffness,
                report.model.loss_factor,
                report.model.amplitude
            );
        }
        let tripped = critical_section::with(|section| TRIPPED.borrow(section).get());
        if let (Some(cause), false) = (tripped, stopped) {
            stopped = true;
            let _ = writeln!(serial, "stopped: {cause:?}\r");
        }
    }
}

/// One tick. It must end within 100 µs, when the next one is due. A tick that takes longer, comes late or is missing stops the
/// damper.
#[interrupt]
fn TIM2() {
    static mut TICK: Option<Tick> = None;

    if TICK.is_none() {
        *TICK = critical_section::with(|section| HANDED_OVER.take(section));
    }
    let Some(Tick {
        timer,
        clock,
        damper,
    }) = TICK
    else {
        return;
    };
    // ANCHOR: tick
    timer.clear_flags(Flag::Update);
    let seen = damper.tick(clock.now().ticks());
    critical_section::with(|section| {
        if seen.report.is_some() {
            COMPLETED.borrow(section).set(seen.report);
        }
        if let State::Faulted(cause) = seen.state {
            TRIPPED.borrow(section).set(Some(cause));
        }
    });
    if timer.flags().contains(Flag::Update) {
        damper.overrun();
    }
    // ANCHOR_END: tick
}
