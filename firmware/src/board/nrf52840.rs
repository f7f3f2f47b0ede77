//! The nRF52840 at 64 MHz, as on Nordic's development kit.
//!
//! | pins | what |
//! |---|---|
//! | P0.06 | UARTE1, 115200 baud: the log, as defmt frames |
//! | P1.02, P1.01 | UART0, 115200 baud, out and in: the link to the teammates, unless that is the radio |
//! | P1.03, P1.04 | left motor: speed at 20 kHz, direction |
//! | P1.05, P1.06 | right motor: speed at 20 kHz, direction |
//! | P0.02 | half of the battery's voltage; without a battery, tie it to ground |
//! | P0.13 | status LED, which the kit wires to the supply |

use super::clock::{count_millisecond, now};
#[cfg(feature = "nrf52840-radio")]
use super::nrf52840_radio as link;
#[cfg(not(feature = "nrf52840-radio"))]
use super::nrf52840_uart as link;
use super::shared::{Shared, Slot};
use super::{Board, Disturbed, LogPort, MappedFlash, Port, begin, enable, mapped};
use crate::adapters::{Chassis, DifferentialDrive, Samples, VoltageGauge, VoltageRange, Wheel};
use crate::fail_safe;
use crate::hardware;
use crate::page::Slots;
use core::sync::atomic::{AtomicU8, Ordering, compiler_fence};
use cortex_m::peripheral::{DWT, NVIC};
use iibt_core::time::{Duration, Instant};
use nrf52840_hal::clocks::Clocks;
use nrf52840_hal::gpio::{Floating, Input, Level, Output, Pin, PushPull, p0, p1};
use nrf52840_hal::pac::{Interrupt, PWM0, Peripherals, TIMER0, UARTE1, WDT, interrupt, uarte0};
use nrf52840_hal::pwm::{Channel, Pwm, PwmChannel};
use nrf52840_hal::saadc::{Saadc, SaadcConfig};
use nrf52840_hal::time::U32Ext;
use nrf52840_hal::timer::{Periodic, Timer};
use nrf52840_hal::uarte;
use nrf52840_hal::wdt::{Inactive, Watchdog, WatchdogHandle, count, handles::Hdl0};
use static_cell::StaticCell;

/// A lithium cell behind a divider of two equal resistors: 3.3 V and 4.2 V, in steps of 3.3 V /
/// 16384 with a supply of 3.3 V.
const CELL: VoltageRange = VoltageRange { empty: 8192, full: 10_426 };

type Motor = Wheel<PwmChannel<'static, PWM0>, Pin<Output<PushPull>>>;

pub use link::TeamLink;

/// The drive of the two motors.
pub type Motors = DifferentialDrive<Motor, Motor, Milliseconds>;

/// The flash, which is only read.
pub type Flash = MappedFlash;

/// The battery gauge.
pub type Gauge = VoltageGauge<Converter>;

/// The status LED, on while its pin is low, as it is from the start.
pub type StatusLed = Pin<Output<PushPull>>;

/// The watchdog of the chip. A restart of the core does not stop it.
pub enum ChipWatchdog {
    /// It was not started since the power came on.
    Stopped(Option<Watchdog<Inactive>>),
    /// It is to be fed.
    Running(WatchdogHandle<Hdl0>),
}

impl ChipWatchdog {
    fn new(chip: WDT) -> Option<Self> {
        Some(match Watchdog::try_new(chip) {
            Ok(stopped) => Self::Stopped(Some(stopped)),
            Err(running) => Self::Running(Watchdog::try_recover::<count::One>(running).ok()?.handles.0),
        })
    }
}

impl fail_safe::Watchdog for ChipWatchdog {
    fn start(&mut self, limit: Duration) {
        let Self::Stopped(stopped) = self else { return self.feed() };
        let Some(mut stopped) = stopped.take() else { return };
        stopped.set_lfosc_ticks(limit.0 * 32_768 / 1000);
        *self = Self::Running(stopped.activate::<count::One>().handles.0);
    }

    fn feed(&mut self) {
        if let Self::Running(handle) = self {
            handle.pet();
        }
    }
}

/// Takes both speed outputs from their generator; the pins are low then.
fn cut_motors() {
    // SAFETY: one store, to a register that nothing writes once the outputs are set up.
    #[expect(unsafe_code, reason = "the drive owns the generator, and may be in the middle of a call")]
    let pwm = unsafe { &*PWM0::ptr() };
    pwm.enable.write(|w| w.enable().disabled());
}

/// The converter of the battery's voltage. A sample takes some 200 microseconds.
pub struct Converter(Saadc, p0::P0_02<Input<Floating>>);

impl Samples for Converter {
    fn sample(&mut self) -> u16 {
        let sample = self.0.read_channel(&mut self.1).unwrap_or(0);
        // Noise can make it negative.
        u16::try_from(sample).unwrap_or(0)
    }
}

impl Board {
    /// Starts the clock, the log, the link and the outputs; `None` the second time.
    #[must_use]
    pub fn take(chassis: Chassis) -> Option<Self> {
        let mut core = cortex_m::Peripherals::take()?;
        let chip = Peripherals::take()?;
        let _ = Clocks::new(chip.CLOCK).enable_ext_hfosc();
        let (port0, port1) = (p0::Parts::new(chip.P0), p1::Parts::new(chip.P1));

        core.DCB.enable_trace();
        core.DWT.enable_cycle_counter();
        let mut timer = Timer::periodic(chip.TIMER0);
        timer.enable_interrupt();
        timer.start(1000); // microseconds
        TIMER.with(|slot| *slot = Slot::Full(timer));
        enable(Interrupt::TIMER0);

        let txd = port0.p0_06.into_push_pull_output(Level::High).degrade();
        let rxd = port0.p0_08.into_floating_input().degrade();
        let pins = uarte::Pins { rxd, txd, cts: None, rts: None };
        let uarte =
            uarte::Uarte::new(chip.UARTE1, pins, uarte::Parity::EXCLUDED, uarte::Baudrate::BAUD115200);
        LOG.start(LogUart { _uarte: uarte, is_sending: false });
        enable(Interrupt::UARTE1);
        let by_watchdog = chip.POWER.resetreas.read().dog().is_detected();
        chip.POWER.resetreas.write(|w| w.dog().set_bit()); // which clears it
        begin(cut_motors, by_watchdog);

        #[cfg(not(feature = "nrf52840-radio"))]
        let link = {
            let txd = port1.p1_02.into_push_pull_output(Level::High).degrade();
            let rxd = port1.p1_01.into_floating_input().degrade();
            link::start(chip.UART0, &txd, &rxd)
        };
        #[cfg(feature = "nrf52840-radio")]
        let link = link::start(chip.RADIO);

        static PWM: StaticCell<Pwm<PWM0>> = StaticCell::new();
        let pwm = &*PWM.try_init(Pwm::new(chip.PWM0))?;
        pwm.set_period(20_000_u32.hz());
        pwm.set_output_pin(Channel::C0, port1.p1_03.into_push_pull_output(Level::Low).degrade());
        pwm.set_output_pin(Channel::C1, port1.p1_05.into_push_pull_output(Level::Low).degrade());
        pwm.enable();
        let (left, right, ..) = pwm.split_channels();
        let left = Wheel::new(left, port1.p1_04.into_push_pull_output(Level::Low).degrade());
        let right = Wheel::new(right, port1.p1_06.into_push_pull_output(Level::Low).degrade());
        let drive = DifferentialDrive::new(left, right, Milliseconds, chassis);

        let converter =
            Converter(Saadc::new(chip.SAADC, SaadcConfig::default()), port0.p0_02.into_floating_input());
        let battery = VoltageGauge::new(converter, CELL);
        let led = port0.p0_13.into_push_pull_output(Level::Low).degrade();
        // SAFETY: the flash lies there, by the chip's reference manual, and nothing writes it.
        #[expect(unsafe_code, reason = "the flash is read where it lies")]
        let storage = unsafe { mapped(0, 0x10_0000, Slots::NRF52840) };
        let watchdog = ChipWatchdog::new(chip.WDT)?;
        Some(Self { link, drive, clock: Milliseconds, battery, storage, led, watchdog })
    }
}

static LOG: LogPort<LogUart> = LogPort::new();
static TIMER: Shared<Slot<Timer<TIMER0, Periodic>>> = Shared::new(Slot::Empty);

#[interrupt]
fn UARTE1() {
    LOG.serve();
}

#[interrupt]
fn TIMER0() {
    TIMER.with(|timer| timer.as_mut().map(|timer| timer.reset_event()));
    count_millisecond();
    #[cfg(feature = "nrf52840-radio")]
    link::try_again();
}

/// A clock of one tick per millisecond, of a timer that goes on while the core sleeps.
#[derive(Clone, Copy, Debug)]
pub struct Milliseconds;

impl Milliseconds {
    /// Cycles of the core since the start that it did not sleep, modulo 2^32. For differences only.
    #[must_use]
    pub fn cycles(self) -> u32 {
        DWT::cycle_count()
    }
}

impl hardware::Clock for Milliseconds {
    fn now(&mut self) -> Instant {
        now()
    }
}

/// The byte that the log sends: the peripheral reads it from the RAM.
static SENT: AtomicU8 = AtomicU8::new(0);

/// The port of the log, which only sends.
pub struct LogUart {
    _uarte: uarte::Uarte<UARTE1>,
    is_sending: bool,
}

impl LogUart {
    fn registers(&self) -> &uarte0::RegisterBlock {
        // SAFETY: the port owns the peripheral, and nothing else of this program uses it.
        #[expect(unsafe_code, reason = "the HAL hands out no registers of its UARTE")]
        unsafe {
            &*UARTE1::ptr()
        }
    }
}

impl Port for LogUart {
    fn read(&mut self) -> Option<Result<u8, Disturbed>> {
        None
    }

    fn has_room(&mut self) -> bool {
        self.is_sending &= self.registers().events_endtx.read().bits() == 0;
        !self.is_sending
    }

    fn write(&mut self, byte: u8) {
        SENT.store(byte, Ordering::Relaxed);
        let uarte = self.registers();
        uarte.events_endtx.reset();
        // SAFETY: the byte lies in the RAM for ever, and is not changed before it was read.
        #[expect(unsafe_code, reason = "the peripheral takes an address")]
        unsafe {
            uarte.txd.ptr.write(|w| w.ptr().bits(SENT.as_ptr() as u32));
            uarte.txd.maxcnt.write(|w| w.maxcnt().bits(1));
        }
        compiler_fence(Ordering::SeqCst);
        uarte.tasks_starttx.write(|w| w.tasks_starttx().set_bit());
        self.is_sending = true;
    }

    fn ask_for_room(&mut self, asks: bool) {
        if asks {
            self.registers().intenset.write(|w| w.endtx().set());
        } else {
            self.registers().intenclr.write(|w| w.endtx().clear());
        }
    }

    fn pend(&mut self) {
        NVIC::pend(Interrupt::UARTE1);
    }
}
