//! Clocks and pins.

use core::cell::RefCell;

use cortex_m::peripheral::SCB;
use cortex_m::peripheral::scb::SystemHandler;
use critical_section::Mutex;
use embedded_hal_bus::spi::ExclusiveDevice;
use mesh_damper::{adc, dac};
use mesh_damper_firmware::{Board, OwnTimer, PortLink};
use stm32f4xx_hal::gpio::PinState;
use stm32f4xx_hal::pac::{Peripherals, TIM5};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;
use stm32f4xx_hal::timer::CounterUs;

use crate::converters::{OwnConverters, PARTS, Parts};
use crate::log::Rtt;
use crate::port::{self, Uart};

/// Clock of the processor, MHz: the most that this chip takes without further settings.
{%- if mcu == "stm32f411" %}
const PROCESSOR: u32 = 100;
{%- else %}
const PROCESSOR: u32 = 168;
{%- endif %}
/// Crystal, MHz. The internal oscillator is within 1 % only, and so would be each frequency that a recording says.
const CRYSTAL: u32 = {{crystal}};

/// Counts all the time, and knows nothing of SysTick, which gives the ticks.
static CLOCK: Mutex<RefCell<Option<CounterUs<TIM5>>>> = Mutex::new(RefCell::new(None));

/// This board.
pub struct OwnBoard;

impl Board for OwnBoard {
    const SYSTICK: u32 = PROCESSOR;
    type Link = PortLink<Uart>;
    type Log = Rtt;
    type Converters = OwnConverters;

    fn prepare() {
        let chip = Peripherals::take().expect("an image prepares once");
        // A clock from outside, such as that of a Nucleo's debug probe: `.bypass_hse_oscillator()` behind `hse`.
        let config = Config::hse(CRYSTAL.MHz()).sysclk(PROCESSOR.MHz());
        let mut rcc = chip.RCC.freeze(config);
        let a = chip.GPIOA.split(&mut rcc);
        let b = chip.GPIOB.split(&mut rcc);
        // First: the actuator stays off while the rest is set up. Until here the resistor outside holds the line.
        let enable = b.pb1.into_push_pull_output_in_state(PinState::Low);

        // Of at most 17 MHz that the ADS8688 takes. The bus divides its clock by a power of two to about this.
        let pins = (Some(a.pa5), Some(a.pa6), Some(a.pa7));
        let bus = chip.SPI1.spi(pins, adc::SPI_MODE, 10.MHz(), &mut rcc);
        let select = a.pa4.into_push_pull_output_in_state(PinState::High);
        let Ok(adc) = ExclusiveDevice::new_no_delay(bus, select);
        let pins = (Some(b.pb13), Some(b.pb14), Some(b.pb15));
        let bus = chip.SPI2.spi(pins, dac::SPI_MODE, 10.MHz(), &mut rcc);
        let select = b.pb12.into_push_pull_output_in_state(PinState::High);
        let Ok(dac) = ExclusiveDevice::new_no_delay(bus, select);
        PARTS.put(Parts {
            adc,
            dac,
            enable,
            // Both pulled down, so that a broken wire is a stop, and no read-back.
            read_back: b.pb0.into_pull_down_input(),
            trip: b.pb5.into_pull_down_input(),
            alive: b.pb6.into_push_pull_output(),
        });

        let serial = chip
            .USART2
            .serial((a.pa2, a.pa3), 115_200.bps(), &mut rcc)
            .expect("the clock divides to this baud rate");
        port::prepare(serial);

        let clock = chip.TIM5.counter_us(&mut rcc);
        critical_section::with(|section| CLOCK.replace(section, Some(clock)));

        let mut core = cortex_m::Peripherals::take().expect("an image prepares once");
        // A tick takes longer than a byte: the serial port may interrupt it, for less than 1 µs.
        // SAFETY: no critical section is by priority.
        unsafe { core.SCB.set_priority(SystemHandler::SysTick, 0x10) };
    }

    /// A restart: the enable line is an input then, and the resistor outside holds it low.
    fn exit(_success: bool) -> ! {
        SCB::sys_reset()
    }
}

impl OwnTimer for OwnBoard {
    type Port = Uart;
    /// Of [`CounterUs`].
    const CLOCK: u32 = 1_000_000;

    fn start_clock() {
        critical_section::with(|section| {
            if let Some(clock) = &mut *CLOCK.borrow_ref_mut(section) {
                // It wraps after one count less than 2³², which makes one tick in 71 minutes 1 µs shorter.
                clock
                    .start(u32::MAX.micros())
                    .expect("the timer has 32 bits");
            }
        });
    }

    fn clock() -> u32 {
        critical_section::with(|section| {
            let clock = CLOCK.borrow_ref(section);
            clock.as_ref().map_or(0, |clock| clock.now().ticks())
        })
    }
}
