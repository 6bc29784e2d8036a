//! A rig on an STM32F405 with Embassy: sines move a specimen, the law runs beside it, and both converters are awaited.
//!
//! The tick runs in a separate executor, in an interrupt of higher priority than `main`. While DMA moves a frame, `main` continues.
//! Nothing that `main` does delays the next tick.
#![no_std]
#![no_main]

mod board;

use core::fmt::Write as _;

use embassy_executor::{InterruptExecutor, Spawner};
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt as _, Priority};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::channel::Channel;
use embassy_time::{Duration, Instant, TICK_HZ, Ticker};
use mesh_damper::amplitude_independent;
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::RunningLaw;
use mesh_damper::rig::{
    Asynchronous, CycleReport, RigController, RigSettings, State, TripCause, Wiring,
};
use mesh_damper::sine::{Block, Programme, SineGenerator};
use panic_halt as _;
use static_cell::StaticCell;

use board::{Actuator, Board, Sensors};

/// Ticks per second.
const TICK_RATE: u64 = 10_000;
/// Density of the mesh, g/cm³.
const DENSITY: f32 = 3.0;
/// Amplitude of the motion, mm.
const AMPLITUDE: f64 = 0.1;
/// Frequencies of the motion in order, Hz, each with the same number of cycles.
const FREQUENCIES: [f64; 3] = [1.0, 5.0, 10.0];
const CYCLES: u32 = 10;

/// A law with up to two effects. It is stored in a static, and can be swapped while the rig runs.
type Law = RunningLaw<2>;
type Excitation = SineGenerator<{ FREQUENCIES.len() }>;
type Controller = RigController<2, Excitation, &'static mut Law>;
type Rig = Asynchronous<Controller, Sensors, Actuator>;

/// What the tick reports to `main`.
enum Said {
    Cycle(CycleReport),
    Stopped(TripCause),
}

/// Cycles are rare. If `main` does not receive them in time, a result is lost, but no tick.
static SAID: Channel<CriticalSectionRawMutex, Said, 8> = Channel::new();
/// The executor of the tick.
static EXECUTOR: InterruptExecutor = InterruptExecutor::new();

/// An interrupt that nothing else on this board uses.
#[interrupt]
unsafe fn UART4() {
    // SAFETY: only this handler calls it, and `start` enables the interrupt.
    unsafe { EXECUTOR.on_interrupt() }
}

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    static LAW: StaticCell<Law> = StaticCell::new();

    let mut board = Board::new().await;
    // ANCHOR: law
    let law = amplitude_independent::law(DENSITY).expect("the density is in range");
    let law = LAW.init_with(|| RunningLaw::new(law));
    let controller = controller(&board.wiring, law).expect("motion and settings are in range");
    let rig = Rig::wire(controller, board.sensors, board.actuator).await;
    // ANCHOR_END: law

    // A lower priority than the interrupts of the DMA and of the clock, which have the highest priority.
    interrupt::UART4.set_priority(Priority::P6);
    EXECUTOR
        .start(interrupt::UART4)
        .spawn(tick(rig).expect("it is spawned once"));

    loop {
        let mut line = heapless::String::<96>::new();
        // A longer line is truncated.
        let _ = match SAID.receive().await {
            Said::Cycle(report) => writeln!(
                line,
                "block {}: {:.4} kN/mm, loss factor {:.4}, law off by {:.1} %\r",
                report.block,
                report.measured.stiffness,
                report.measured.loss_factor,
                100.0 * report.nrmse
            ),
            Said::Stopped(cause) => writeln!(line, "stopped: {cause:?}\r"),
        };
        // A transmitter has no errors to report.
        let _ = board.serial.write(line.as_bytes()).await;
    }
}

fn controller(wiring: &Wiring, law: &'static mut Law) -> Result<Controller, ConfigError> {
    let mut programme = Programme::new(TICK_RATE as f64, 1)?;
    for frequency in FREQUENCIES {
        programme = programme.with(Block::sine(AMPLITUDE, frequency, CYCLES)?)?;
    }
    // Embassy's clock, TIM2, keeps running while the executors sleep; the processor's cycle counter stops.
    let settings = RigSettings {
        clock_rate: TICK_HZ as f64,
        ..RigSettings::default()
    };
    RigController::new(&settings, wiring, programme, law)
}

/// The rig, tick by tick. A tick must end within 100 µs, when the next one is due. A tick that takes longer, comes late or is missing
/// stops the rig.
#[embassy_executor::task]
async fn tick(mut rig: Rig) {
    const PERIOD: Duration = Duration::from_hz(TICK_RATE);

    let mut stopped = false;
    let mut due = Instant::now();
    let mut ticker = Ticker::every(PERIOD);
    // A tick before the start, which then knows where the piston is. A start that is refused trips the rig, and the next tick reports
    // the cause.
    ticker.next().await;
    due += PERIOD;
    rig.tick(Instant::now().as_ticks() as u32).await;
    let _ = rig.start().await;
    loop {
        // ANCHOR: tick
        ticker.next().await;
        due += PERIOD;
        // It wraps, as the rig takes it.
        let seen = rig.tick(Instant::now().as_ticks() as u32).await;
        // In a ramp the amplitude changes within the cycle: its stiffness is not that of the block.
        if let Some(report) = seen.report
            && !report.ramp
        {
            let _ = SAID.try_send(Said::Cycle(report));
        }
        if let State::Faulted(cause) = seen.state
            && !stopped
        {
            stopped = SAID.try_send(Said::Stopped(cause)).is_ok();
        }
        if Instant::now() >= due + PERIOD {
            rig.overrun().await;
        }
        // ANCHOR_END: tick
    }
}
