//! The board: clocks, pins, and the two converters behind DMA.

use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::mode::Async;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Pll, PllMul, PllPDiv, PllPreDiv, PllSource, Sysclk,
};
use embassy_stm32::spi::mode::Master;
use embassy_stm32::spi::{self, Spi};
use embassy_stm32::time::mhz;
use embassy_stm32::usart::{self, UartTx};
use embassy_stm32::{bind_interrupts, dma, peripherals};
use embedded_hal_bus::spi::{ExclusiveDevice, NoDelay};
use mesh_damper::adc::Ads8688;
use mesh_damper::converter::Scale;
use mesh_damper::dac::Ad5761;
use mesh_damper::rig::{SpiActuator, Wiring};

/// Displacement at either end of the ADC's range and of the command's, mm.
const TRAVEL: f64 = 0.5;
/// Force at either end of the ADC's range, kN.
const FORCE: f64 = 5.0;

bind_interrupts!(struct Interrupts {
    DMA2_STREAM0 => dma::InterruptHandler<peripherals::DMA2_CH0>;
    DMA2_STREAM3 => dma::InterruptHandler<peripherals::DMA2_CH3>;
    DMA1_STREAM3 => dma::InterruptHandler<peripherals::DMA1_CH3>;
    DMA1_STREAM4 => dma::InterruptHandler<peripherals::DMA1_CH4>;
    DMA1_STREAM6 => dma::InterruptHandler<peripherals::DMA1_CH6>;
});

type Bus = ExclusiveDevice<Spi<'static, Async, Master>, Output<'static>, NoDelay>;
/// An ADS8688 on SPI1.
pub type Sensors = Ads8688<Bus>;
/// An AD5761R on SPI2 and the enable line.
pub type Actuator = SpiActuator<Bus, Output<'static>>;

/// Everything on the board that the firmware uses.
pub struct Board {
    pub sensors: Sensors,
    pub actuator: Actuator,
    pub wiring: Wiring,
    pub serial: UartTx<'static, Async>,
}

impl Board {
    /// The board at 168 MHz from the internal oscillator, with both converters checked and set up.
    pub async fn new() -> Self {
        let mut config = embassy_stm32::Config::default();
        // 16 MHz / 8 · 168 / 2.
        config.rcc.pll_src = PllSource::HSI;
        config.rcc.pll = Some(Pll {
            prediv: PllPreDiv::DIV8,
            mul: PllMul::MUL168,
            divp: Some(PllPDiv::DIV2),
            divq: None,
            divr: None,
        });
        config.rcc.sys = Sysclk::PLL1_P;
        config.rcc.ahb_pre = AHBPrescaler::DIV1;
        config.rcc.apb1_pre = APBPrescaler::DIV4;
        config.rcc.apb2_pre = APBPrescaler::DIV2;
        let p = embassy_stm32::init(config);
        // This comes first: the actuator stays off during the checks below, also if one of them panics.
        let enable = Output::new(p.PB1, Level::Low, Speed::Low);

        let scale = |full_scale| Scale::new(full_scale, 0.0).expect("the full scale is in range");
        let wiring = Wiring {
            displacement: scale(TRAVEL),
            force: scale(FORCE),
            command: scale(TRAVEL),
        };

        let mut bus = spi::Config::default();
        // `SPI_MODE` of both parts, in the type of this HAL.
        bus.mode = spi::MODE_1;
        // The part accepts at most 17 MHz. The clock's nearest divided rate below that is 10.5 MHz.
        bus.frequency = mhz(17);
        let bus = Spi::new(
            p.SPI1, p.PA5, p.PA7, p.PA6, p.DMA2_CH3, p.DMA2_CH0, Interrupts, bus,
        );
        let adc = Ads8688::new_async(selected(bus, p.PA4), wiring.displacement, wiring.force)
            .await
            .expect("an ADS8688 is connected to SPI1");

        let mut bus = spi::Config::default();
        bus.mode = spi::MODE_1;
        bus.frequency = mhz(21);
        let bus = Spi::new(
            p.SPI2, p.PB13, p.PB15, p.PB14, p.DMA1_CH4, p.DMA1_CH3, Interrupts, bus,
        );
        let dac = Ad5761::new_async(selected(bus, p.PB12), wiring.command)
            .await
            .expect("an AD5761R is connected to SPI2");

        let serial = UartTx::new(
            p.USART2,
            p.PA2,
            p.DMA1_CH6,
            Interrupts,
            usart::Config::default(),
        );
        Self {
            sensors: adc,
            actuator: SpiActuator::new(dac, enable),
            wiring,
            serial: serial.expect("the clock divides to 115 200 baud"),
        }
    }
}

/// A bus with one part on it.
fn selected(
    bus: Spi<'static, Async, Master>,
    select: embassy_stm32::Peri<'static, impl embassy_stm32::gpio::Pin>,
) -> Bus {
    let select = Output::new(select, Level::High, Speed::VeryHigh);
    let Ok(device) = ExclusiveDevice::new_no_delay(bus, select);
    device
}
