//! The RP2040 at 125 MHz, as on a Raspberry Pi Pico. It has no floating-point unit.
//!
//! | pins | what |
//! |---|---|
//! | GP0, GP1 | UART0, 115200 baud: the log, as defmt frames |
//! | GP4, GP5 | UART1, 115200 baud: the link to the teammates |
//! | GP2, GP6 | left motor: speed at 20 kHz, direction |
//! | GP3, GP7 | right motor: speed at 20 kHz, direction |
//! | GP26 | half of the battery's voltage; without a battery, tie it to ground |
//! | GP25 | status LED |

use super::{Board, IoPort, Line, LogPort, MappedFlash, begin, enable, mapped};
use crate::adapters::{Chassis, DifferentialDrive, Samples, VoltageGauge, VoltageRange, Wheel};
use crate::fail_safe;
use crate::page::Slots;
use iibt_core::time::Duration;
use rp2040_hal::adc::{Adc, AdcPin};
use rp2040_hal::clocks::init_clocks_and_plls;
use rp2040_hal::fugit::{ExtU32, HertzU32, RateExtU32};
use rp2040_hal::gpio::bank0::{Gpio0, Gpio1, Gpio4, Gpio5, Gpio6, Gpio7, Gpio25};
use rp2040_hal::gpio::{FunctionSioOutput, FunctionUart, Pin, PinState, Pins, PullDown};
use rp2040_hal::pac::{IO_BANK0, Interrupt, Peripherals, UART0, UART1, interrupt};
use rp2040_hal::pwm::{A, B, Channel, FreeRunning, Pwm1, Slice, Slices};
use rp2040_hal::uart::{DataBits, Reader, StopBits, UartConfig, UartPeripheral, Writer};
use rp2040_hal::{Sio, Watchdog};

pub use super::systick::Milliseconds;

/// The crystal of the board, in Hz.
const CRYSTAL: u32 = 12_000_000;

/// The frequency of the core and of its peripherals, as the HAL sets it up.
///
/// A constant and not what the HAL's clocks say: nothing is divided by what might be zero.
const FREQUENCY: HertzU32 = HertzU32::MHz(125);

const BAUD: u32 = 115_200;

/// The period of the motors' speed outputs in cycles of 125 MHz: 20 kHz.
const PERIOD: u16 = 6250;

/// A lithium cell behind a divider of two equal resistors: 3.3 V and 4.2 V, in steps of 3.3 V /
/// 4096.
const CELL: VoltageRange = VoltageRange { empty: 2048, full: 2606 };

/// The second stage of the boot, which sets the flash up.
#[expect(unsafe_code, reason = "the chip looks for it in a section of its own")]
#[unsafe(link_section = ".boot2")]
#[used]
static BOOT2: [u8; 256] = rp2040_boot2::BOOT_LOADER_GENERIC_03H;

type UartPins<T, R> = (Pin<T, FunctionUart, PullDown>, Pin<R, FunctionUart, PullDown>);
type UartPort<U, T, R> = IoPort<Reader<U, UartPins<T, R>>, Writer<U, UartPins<T, R>>, Interrupt>;
type LinkPort = UartPort<UART1, Gpio4, Gpio5>;
type Motor<C, D> = Wheel<Channel<Slice<Pwm1, FreeRunning>, C>, Pin<D, FunctionSioOutput, PullDown>>;

/// The link to the teammates.
pub type TeamLink = &'static Line<LinkPort>;

/// The drive of the two motors.
pub type Motors = DifferentialDrive<Motor<A, Gpio6>, Motor<B, Gpio7>, Milliseconds>;

/// The flash, which is only read.
pub type Flash = MappedFlash;

/// The battery gauge.
pub type Gauge = VoltageGauge<Converter>;

/// The status LED, on while its pin is high, as it is from the start.
pub type StatusLed = Pin<Gpio25, FunctionSioOutput, PullDown>;

/// The watchdog of the chip.
pub struct ChipWatchdog(Watchdog);

impl fail_safe::Watchdog for ChipWatchdog {
    fn start(&mut self, limit: Duration) {
        self.0.start(limit.0.millis());
    }

    fn feed(&mut self) {
        self.0.feed();
    }
}

/// Keeps both speed outputs low, whatever drives them. A restart of the core resets no peripheral:
/// without this they would go on.
fn cut_motors() {
    // SAFETY: a store to each of two registers that nothing writes once the pins are set up.
    #[expect(unsafe_code, reason = "the drive owns the pins, and may be in the middle of a call")]
    let pins = unsafe { &*IO_BANK0::ptr() };
    pins.gpio_iter().skip(2).take(2).for_each(|pin| pin.gpio_ctrl().modify(|_, w| w.outover().low()));
}

/// The converter of the battery's voltage. It converts all the time.
pub struct Converter(Adc);

impl Samples for Converter {
    fn sample(&mut self) -> u16 {
        self.0.read_single().unwrap_or(0)
    }
}

impl Board {
    /// Starts the clock, the log, the link and the outputs; `None` the second time.
    #[must_use]
    pub fn take(chassis: Chassis) -> Option<Self> {
        let core = cortex_m::Peripherals::take()?;
        let mut chip = Peripherals::take()?;
        let by_watchdog = chip.WATCHDOG.reason().read().timer().bit_is_set();
        let mut watchdog = Watchdog::new(chip.WATCHDOG);
        let resets = &mut chip.RESETS;
        let (plls, clocks) = ((chip.PLL_SYS, chip.PLL_USB), chip.CLOCKS);
        init_clocks_and_plls(CRYSTAL, chip.XOSC, clocks, plls.0, plls.1, resets, &mut watchdog).ok()?;
        let sio = Sio::new(chip.SIO);
        let pins = Pins::new(chip.IO_BANK0, chip.PADS_BANK0, sio.gpio_bank0, resets);
        let clock = Milliseconds::start(core.SYST, FREQUENCY.to_kHz());

        let config = || UartConfig::new(BAUD.Hz(), DataBits::Eight, None, StopBits::One);
        let log = (pins.gpio0.into_function(), pins.gpio1.into_function());
        let log = UartPeripheral::new(chip.UART0, log, resets).enable(config(), FREQUENCY).ok()?;
        let (rx, tx) = log.split();
        LOG.start(IoPort::new(rx, tx, Interrupt::UART0_IRQ, ask));
        enable(Interrupt::UART0_IRQ);
        begin(cut_motors, by_watchdog);
        let link = (pins.gpio4.into_function(), pins.gpio5.into_function());
        let link = UartPeripheral::new(chip.UART1, link, resets).enable(config(), FREQUENCY).ok()?;
        let (mut rx, tx) = link.split();
        rx.enable_rx_interrupt();
        let link = LINK.start(IoPort::new(rx, tx, Interrupt::UART1_IRQ, ask));
        enable(Interrupt::UART1_IRQ);

        let mut pwm = Slices::new(chip.PWM, resets).pwm1;
        pwm.set_top(PERIOD - 1);
        pwm.enable();
        let (mut left, mut right) = (pwm.channel_a, pwm.channel_b);
        left.output_to(pins.gpio2);
        right.output_to(pins.gpio3);
        let left = Wheel::new(left, pins.gpio6.into_push_pull_output());
        let right = Wheel::new(right, pins.gpio7.into_push_pull_output());
        let drive = DifferentialDrive::new(left, right, clock, chassis);

        let mut adc = Adc::new(chip.ADC, resets);
        adc.free_running(&AdcPin::new(pins.gpio26.into_floating_input()).ok()?);
        let battery = VoltageGauge::new(Converter(adc), CELL);
        let led = pins.gpio25.into_push_pull_output_in_state(PinState::High);
        // SAFETY: the flash lies there, by the chip's reference manual, and nothing writes it.
        #[expect(unsafe_code, reason = "the flash is read where it lies")]
        let storage = unsafe { mapped(0x1000_0000, 0x20_0000, Slots::RP2040) };
        watchdog.pause_on_debug(true);
        let watchdog = ChipWatchdog(watchdog);
        Some(Self { link, drive, clock, battery, storage, led, watchdog })
    }
}

fn ask<U: rp2040_hal::uart::UartDevice, P: rp2040_hal::uart::ValidUartPinout<U>>(
    sender: &mut Writer<U, P>,
    asks: bool,
) {
    if asks { sender.enable_tx_interrupt() } else { sender.disable_tx_interrupt() }
}

static LOG: LogPort<UartPort<UART0, Gpio0, Gpio1>> = LogPort::new();
static LINK: Line<LinkPort> = Line::new();

#[interrupt]
fn UART0_IRQ() {
    LOG.serve();
}

#[interrupt]
fn UART1_IRQ() {
    LINK.serve();
}
