//! The STM32F405 on its 16 MHz internal oscillator, in QEMU's `netduinoplus2` and on hardware
//! alike.
//!
//! | pins | what |
//! |---|---|
//! | PA9, PA10 | USART1, 115200 baud: the log, as defmt frames |
//! | PA2, PA3 | USART2, 115200 baud: the link to the teammates |
//! | PB10, PB11 | USART3, 115200 baud: the port to a base |
//! | PA6, PB0 | left motor: speed at 20 kHz (TIM3), direction |
//! | PA7, PB1 | right motor: speed at 20 kHz (TIM3), direction |
//! | PA0 | half of the battery's voltage; without a battery, tie it to ground |
//! | PA5 | status LED |

mod flash;

pub use flash::Flash;

use super::{Board, Disturbed, Line, LogPort, Port, begin, enable};
use crate::adapters::{Chassis, DifferentialDrive, Samples, VoltageGauge, VoltageRange, Wheel};
use crate::fail_safe::Watchdog;
use cortex_m::peripheral::NVIC;
use embedded_hal_nb::nb;
use embedded_hal_nb::serial::{Read, Write};
use iibt_core::time::Duration;
use stm32f4xx_hal::gpio::{Output, PA5, PB0, PB1, PinState};
use stm32f4xx_hal::interrupt;
use stm32f4xx_hal::pac::{ADC1, Interrupt, Peripherals, TIM3, USART1, USART2, USART3};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Enable;
use stm32f4xx_hal::serial::{Rx, RxListen, Tx, TxISR, TxListen};
use stm32f4xx_hal::timer::PwmChannel;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

pub use super::systick::Milliseconds;

const BAUD: u32 = 115_200;

/// The link to the teammates.
pub type TeamLink = &'static Line<Usart<USART2>>;

/// The port to a base: one request and two answers may wait.
pub type BasePort = &'static Line<Usart<USART3>, 128, 256>;

/// The drive of the two motors.
pub type Motors = DifferentialDrive<
    Wheel<PwmChannel<TIM3, 0>, PB0<Output>>,
    Wheel<PwmChannel<TIM3, 1>, PB1<Output>>,
    Milliseconds,
>;

/// The battery gauge.
pub type Gauge = VoltageGauge<Converter>;

/// The converter of the battery's voltage. It converts all the time.
pub struct Converter(ADC1);

impl Samples for Converter {
    fn sample(&mut self) -> u16 {
        self.0.dr().read().data().bits()
    }
}

/// A lithium cell behind a divider of two equal resistors: 3.3 V and 4.2 V, in steps of 3.3 V /
/// 4096.
const CELL: VoltageRange = VoltageRange { empty: 2048, full: 2606 };

/// The status LED, on while its pin is high, as it is from the start.
pub type StatusLed = PA5<Output>;

/// The independent watchdog, which has an oscillator of its own.
pub struct ChipWatchdog(IndependentWatchdog);

impl Watchdog for ChipWatchdog {
    fn start(&mut self, limit: Duration) {
        self.0.start(limit.0.millis());
    }

    fn feed(&mut self) {
        self.0.feed();
    }
}

/// Forces both speed outputs low, whatever their duty cycles.
fn cut_motors() {
    // SAFETY: one store, to a register that nothing writes once the outputs are set up.
    #[expect(unsafe_code, reason = "the drive owns the timer, and may be in the middle of a call")]
    let timer = unsafe { &*TIM3::ptr() };
    timer.ccmr1_output().write(|w| w.oc1m().force_inactive().oc2m().force_inactive());
}

impl Board {
    /// Starts the clock, the log, the link and the outputs; `None` the second time.
    #[must_use]
    pub fn take(chassis: Chassis) -> Option<Self> {
        Self::new(cortex_m::Peripherals::take()?, Peripherals::take()?, chassis)
    }

    /// As [`take`](Self::take), with peripherals that were taken already, as RTIC does.
    #[must_use]
    pub fn new(core: cortex_m::Peripherals, chip: Peripherals, chassis: Chassis) -> Option<Self> {
        let by_watchdog = chip.RCC.csr().read().wdgrstf().is_reset();
        chip.RCC.csr().modify(|_, w| w.rmvf().clear());
        let mut rcc = chip.RCC.constrain();
        let a = chip.GPIOA.split(&mut rcc);
        let b = chip.GPIOB.split(&mut rcc);

        let clock = Milliseconds::start(core.SYST, rcc.clocks.hclk().to_kHz());
        let tx = chip.USART1.tx(a.pa9, BAUD.bps(), &mut rcc).ok()?;
        LOG.start(Usart { rx: None, tx });
        enable(Interrupt::USART1);
        begin(cut_motors, by_watchdog);
        let (tx, mut rx) = chip.USART2.serial((a.pa2, a.pa3), BAUD.bps(), &mut rcc).ok()?.split();
        rx.listen();
        let link = LINK.start(Usart { rx: Some(rx), tx });
        enable(Interrupt::USART2);
        let (tx, mut rx) = chip.USART3.serial((b.pb10, b.pb11), BAUD.bps(), &mut rcc).ok()?.split();
        rx.listen();
        let base = BASE.start(Usart { rx: Some(rx), tx });
        enable(Interrupt::USART3);

        let (_, (left, right, ..)) = chip.TIM3.pwm_hz(20.kHz(), &mut rcc);
        let (mut left, mut right) = (left.with(a.pa6), right.with(a.pa7));
        left.enable();
        right.enable();
        let left = Wheel::new(left, b.pb0.into_push_pull_output());
        let right = Wheel::new(right, b.pb1.into_push_pull_output());
        let drive = DifferentialDrive::new(left, right, clock, chassis);
        ADC1::enable(&mut rcc);
        a.pa0.into_analog();
        // Channel 0, PA0, is the one that is converted after a reset.
        chip.ADC1.smpr2().write(|w| w.smp0().cycles480());
        chip.ADC1.cr2().write(|w| w.adon().enabled().cont().continuous());
        cortex_m::asm::delay(3 * rcc.clocks.hclk().to_MHz()); // it settles in three microseconds
        chip.ADC1.cr2().modify(|_, w| w.swstart().start());
        let battery = VoltageGauge::new(Converter(chip.ADC1), CELL);
        let storage = Flash::storage(chip.FLASH);
        let led = a.pa5.into_push_pull_output_in_state(PinState::High);
        let watchdog = IndependentWatchdog::new(chip.IWDG);
        watchdog.stop_on_debug(&chip.DBGMCU, true);
        let watchdog = ChipWatchdog(watchdog);
        Some(Self { link, base, drive, clock, battery, storage, led, watchdog })
    }
}

static LOG: LogPort<Usart<USART1>> = LogPort::new();
static LINK: Line<Usart<USART2>> = Line::new();
static BASE: Line<Usart<USART3>, 128, 256> = Line::new();

#[interrupt]
fn USART1() {
    LOG.serve();
}

#[interrupt]
fn USART2() {
    LINK.serve();
}

#[interrupt]
fn USART3() {
    BASE.serve();
}

/// A USART of the chip; without a receiver it only sends.
pub struct Usart<U: Numbered> {
    rx: Option<Rx<U>>,
    tx: Tx<U>,
}

/// A USART and its interrupt.
pub trait Numbered: stm32f4xx_hal::serial::Instance {
    /// Its interrupt.
    const INTERRUPT: Interrupt;
}

impl Numbered for USART1 {
    const INTERRUPT: Interrupt = Interrupt::USART1;
}

impl Numbered for USART2 {
    const INTERRUPT: Interrupt = Interrupt::USART2;
}

impl Numbered for USART3 {
    const INTERRUPT: Interrupt = Interrupt::USART3;
}

impl<U: Numbered> Port for Usart<U>
where
    Rx<U>: Send,
    Tx<U>: Send,
{
    fn read(&mut self) -> Option<Result<u8, Disturbed>> {
        match self.rx.as_mut()?.read() {
            Ok(byte) => Some(Ok(byte)),
            Err(nb::Error::WouldBlock) => None,
            Err(nb::Error::Other(_)) => Some(Err(Disturbed)),
        }
    }

    fn has_room(&mut self) -> bool {
        self.tx.is_tx_empty()
    }

    fn write(&mut self, byte: u8) {
        // There is room.
        let _ = self.tx.write(byte);
    }

    fn flush(&mut self) {
        while self.tx.flush().is_err() {}
    }

    fn ask_for_room(&mut self, asks: bool) {
        if asks { self.tx.listen() } else { self.tx.unlisten() }
    }

    fn pend(&mut self) {
        NVIC::pend(U::INTERRUPT);
    }
}
