//! A damper on an STM32F405 with RTIC: the ADS8688 reads the motion, the AD5761R outputs the law's force, 10 000 times a second.
//!
//! The tick is a hardware task of the timer's interrupt. A queue passes each cycle's results to a task of lower priority, which may
//! take longer to send them.
#![no_std]
#![no_main]

use panic_halt as _;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true, dispatchers = [UART4])]
mod app {
    use core::fmt::Write as _;

    use embedded_hal_bus::spi::{ExclusiveDevice, NoDelay};
    use mesh_damper::adc::{self, Ads8688};
    use mesh_damper::amplitude_independent::{self, Effects};
    use mesh_damper::converter::Scale;
    use mesh_damper::dac::{self, Ad5761};
    use mesh_damper::rig::{
        CycleReport, DamperEmulation, DamperEmulationSettings, SpiDamperEmulation, State, TripCause,
    };
    use mesh_damper::static_law::StaticLaw;
    use rtic_sync::channel::{Receiver, Sender};
    use rtic_sync::make_channel;
    use stm32f4xx_hal::gpio::{Output, PA4, PB1, PB12, PinState};
    use stm32f4xx_hal::pac::{SPI1, SPI2, TIM2, TIM5, USART2};
    use stm32f4xx_hal::prelude::*;
    use stm32f4xx_hal::rcc::Config;
    use stm32f4xx_hal::serial::Tx;
    use stm32f4xx_hal::spi::Spi;
    use stm32f4xx_hal::timer::{CounterHz, CounterUs, Event, Flag};

    /// Ticks per second.
    const TICK_RATE: u32 = 10_000;
    /// Rate at which the clock counts, Hz.
    const CLOCK_RATE: u32 = 1_000_000;
    /// Density of the mesh, g/cm³.
    const DENSITY: f32 = 3.0;
    /// Displacement at 10.24 V, mm.
    const TRAVEL: f64 = 0.5;
    /// Force at 10.24 V of the ADC and at 10 V of the DAC, kN.
    const FORCE: f64 = 5.0;

    /// 4 KiB, most of it the table of |v|^α.
    type DamperLaw = StaticLaw<Effects>;
    type Adc = ExclusiveDevice<Spi<SPI1>, PA4<Output>, NoDelay>;
    type Dac = ExclusiveDevice<Spi<SPI2>, PB12<Output>, NoDelay>;
    type Damper = SpiDamperEmulation<Adc, Dac, PB1<Output>, &'static mut DamperLaw>;

    /// What the tick reports to the sending task.
    pub enum Said {
        Cycle(CycleReport),
        Stopped(TripCause),
    }

    /// Cycles are rare. If the sending task does not receive them in time, a result is lost, but no tick.
    const QUEUE: usize = 8;

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        timer: CounterHz<TIM2>,
        /// Counts all the time, independent of the timer that triggers the ticks. The processor's cycle counter is not suitable: it
        /// stops while the processor is idle.
        clock: CounterUs<TIM5>,
        damper: Damper,
        said: Sender<'static, Said, QUEUE>,
        serial: Tx<USART2>,
    }

    #[init(local = [law: DamperLaw = DamperLaw::empty()])]
    fn init(context: init::Context) -> (Shared, Local) {
        let device = context.device;
        // Every board has the internal oscillator, which is accurate to 1 %. For a crystal of 8 MHz use `Config::hse(8.MHz())`.
        let mut rcc = device.RCC.freeze(Config::hsi().sysclk(168.MHz()));
        let a = device.GPIOA.split(&mut rcc);
        let b = device.GPIOB.split(&mut rcc);
        // This comes first: the actuator stays off during the checks below, also if one of them panics.
        let enable = b.pb1.into_push_pull_output_in_state(PinState::Low);
        let serial = device
            .USART2
            .tx(a.pa2, 115_200.bps(), &mut rcc)
            .expect("the clock divides to this baud rate");

        let scale = |full_scale| Scale::new(full_scale, 0.0).expect("the full scale is in range");
        let pins = (Some(a.pa5), Some(a.pa6), Some(a.pa7));
        // The part accepts at most 17 MHz. The clock's nearest divided rate below that is 10.5 MHz.
        let bus = device.SPI1.spi(pins, adc::SPI_MODE, 10.MHz(), &mut rcc);
        let Ok(bus) = ExclusiveDevice::new_no_delay(bus, a.pa4.into_push_pull_output());
        let adc = Ads8688::new(bus, scale(TRAVEL), scale(FORCE))
            .expect("an ADS8688 is connected to SPI1");
        let pins = (Some(b.pb13), Some(b.pb14), Some(b.pb15));
        let bus = device.SPI2.spi(pins, dac::SPI_MODE, 21.MHz(), &mut rcc);
        let Ok(bus) = ExclusiveDevice::new_no_delay(bus, b.pb12.into_push_pull_output());
        let dac = Ad5761::new(bus, scale(FORCE)).expect("an AD5761R is connected to SPI2");

        // ANCHOR: law
        let law = context.local.law;
        let (eq13, effects) =
            amplitude_independent::parts(DENSITY).expect("the density is in range");
        law.set(eq13, effects);
        let settings = DamperEmulationSettings {
            tick_rate: TICK_RATE.into(),
            clock_rate: CLOCK_RATE.into(),
            ..DamperEmulationSettings::default()
        };
        let mut damper = DamperEmulation::new(adc, dac, enable, &settings, law)
            .expect("the settings are in range");
        // ANCHOR_END: law

        let (said, to_report) = make_channel!(Said, QUEUE);
        report::spawn(to_report).expect("it is spawned once");
        let mut clock = device.TIM5.counter_us(&mut rcc);
        clock
            .start(u32::MAX.micros())
            .expect("the clock has 32 bits");
        let mut timer = device.TIM2.counter_hz(&mut rcc);
        timer.listen(Event::Update);
        timer
            .start(TICK_RATE.Hz())
            .expect("the timer divides its clock to this rate");
        // This comes last, so that nothing panics while the actuator is enabled.
        damper.start().expect("the enable line rises");
        (
            Shared {},
            Local {
                timer,
                clock,
                damper,
                said,
                serial,
            },
        )
    }

    // ANCHOR: tick
    /// One tick. It must end within 100 µs, when the next one is due. A tick that does not end in time, comes late, or does not come at
    /// all stops the damper.
    #[task(binds = TIM2, priority = 2, local = [timer, clock, damper, said, stopped: bool = false])]
    fn tick(context: tick::Context) {
        let tick::LocalResources {
            timer,
            clock,
            damper,
            said,
            stopped,
            ..
        } = context.local;
        timer.clear_flags(Flag::Update);
        let seen = damper.tick(clock.now().ticks());
        if let Some(report) = seen.report {
            let _ = said.try_send(Said::Cycle(report));
        }
        if let State::Faulted(cause) = seen.state
            && !*stopped
        {
            *stopped = said.try_send(Said::Stopped(cause)).is_ok();
        }
        if timer.flags().contains(Flag::Update) {
            damper.overrun();
        }
    }
    // ANCHOR_END: tick

    /// Sends the reports. The tick interrupts this task.
    #[task(priority = 1, local = [serial])]
    async fn report(context: report::Context, mut said: Receiver<'static, Said, QUEUE>) {
        let serial = context.local.serial;
        // The tick holds the other end as long as there is power.
        while let Ok(said) = said.recv().await {
            // A transmitter has no errors to report.
            let _ = match said {
                Said::Cycle(report) => writeln!(
                    serial,
                    "cycle {}: {:.4} kN/mm, loss factor {:.4}, {:.4} mm\r",
                    report.cycle,
                    report.model.stiffness,
                    report.model.loss_factor,
                    report.model.amplitude
                ),
                Said::Stopped(cause) => writeln!(serial, "stopped: {cause:?}\r"),
            };
        }
    }
}
