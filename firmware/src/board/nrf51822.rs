//! The nRF51822 at 16 MHz, in QEMU's `microbit` and on hardware alike: the smallest board, for the
//! reduced configuration.
//!
//! | pins | what |
//! |---|---|
//! | P0.02, P0.01 | UART, 115200 baud, out and in: the link to the teammates |
//! | P0.23, P0.22 | left motor: speed at 1 kHz, direction |
//! | P0.21, P0.16 | right motor: speed at 1 kHz, direction |
//! | P0.03 | half of the battery's voltage; without a battery, tie it to ground |
//! | P0.13, P0.04 | status LED from the first to the second, on from the start |
//!
//! There is one serial port, and it is the link: the board has no log.

use super::clock::{count_millisecond, now};
use super::shared::{Shared, Slot};
use super::{Board, Disturbed, Line, MappedFlash, Port, begin, enable, mapped};
use crate::adapters::{Absent, Chassis, DifferentialDrive, Motor, Samples, VoltageGauge, VoltageRange};
use crate::fail_safe::Watchdog;
use crate::hardware;
use crate::page::Slots;
use core::sync::atomic::{AtomicU8, Ordering};
use cortex_m::peripheral::NVIC;
use iibt_core::time::{Duration, Instant};
use nrf51_pac::{ADC, GPIO, Interrupt, Peripherals, TIMER0, UART0, WDT, interrupt};

/// The pins of the chip.
const LINK_OUT: usize = 2;
const LINK_IN: usize = 1;
const SPEEDS: [usize; 2] = [23, 21];
const DIRECTIONS: [usize; 2] = [22, 16];
const LED: [usize; 2] = [13, 4];

/// A lithium cell behind a divider of two equal resistors: 3.3 V and 4.2 V, in steps of 3.6 V /
/// 1024.
const CELL: VoltageRange = VoltageRange { empty: 469, full: 597 };

/// The microseconds of a period of the motors' speed, which is also that of the clock.
const PERIOD: u16 = 1000;

/// A time that the timer does not come to within a period.
const NEVER: u16 = 2 * PERIOD;

/// The link to the teammates: three frames of the longest may wait to be read, and two to be sent.
pub type TeamLink = &'static Line<LinkPort, 384, 256>;

/// The drive of the two motors.
pub type Motors = DifferentialDrive<Side<0>, Side<1>, Milliseconds>;

/// The flash, which is only read.
pub type Flash = MappedFlash;

/// The battery gauge.
pub type Gauge = VoltageGauge<Converter>;

/// The status LED, which stays on.
pub type StatusLed = Absent;

/// The watchdog of the chip. A restart of the core does not stop it.
pub struct ChipWatchdog(WDT);

impl Watchdog for ChipWatchdog {
    fn start(&mut self, limit: Duration) {
        // SAFETY: the registers take any number, and are fixed once the watchdog runs.
        #[expect(unsafe_code, reason = "the peripheral crate has no safe call for it")]
        unsafe {
            self.0.crv.write(|w| w.bits(limit.0.saturating_mul(32_768) / 1000));
            self.0.tasks_start.write(|w| w.bits(1));
        }
        self.feed();
    }

    fn feed(&mut self) {
        self.0.rr[0].write(|w| w.rr().reload());
    }
}

/// Pins of the chip, by their numbers.
fn pins() -> &'static nrf51_pac::gpio::RegisterBlock {
    // SAFETY: a pin has one owner in this file, and stores to the registers used change one pin.
    #[expect(unsafe_code, reason = "interrupts set pins that the drive has chosen")]
    unsafe {
        &*GPIO::ptr()
    }
}

fn set(pin: usize, is_high: bool) {
    // SAFETY: the bits that are not set change nothing.
    #[expect(unsafe_code, reason = "the peripheral crate has a call for each pin only")]
    unsafe {
        if is_high {
            pins().outset.write(|w| w.bits(1 << pin));
        } else {
            pins().outclr.write(|w| w.bits(1 << pin));
        }
    }
}

/// Makes a pin an output, which is low if it was not set before.
fn drive(pin: usize) {
    if let Some(pin) = pins().pin_cnf.get(pin) {
        pin.write(|w| w.dir().output().input().disconnect());
    }
}

/// Takes the speed pins from the drive: they are inputs then, pulled to the ground.
fn cut_motors() {
    for pin in SPEEDS.into_iter().filter_map(|pin| pins().pin_cnf.get(pin)) {
        pin.write(|w| w.dir().input().pull().pulldown());
    }
}

/// The duty cycles of the two motors, in percent.
static DUTIES: [AtomicU8; 2] = [AtomicU8::new(0), AtomicU8::new(0)];

/// The motor on the left, 0, or on the right, 1. The timer's interrupt makes its duty cycle.
pub struct Side<const N: usize>;

impl<const N: usize> Motor for Side<N> {
    fn run(&mut self, duty: u8, forwards: bool) -> bool {
        set(DIRECTIONS[N], forwards);
        DUTIES[N].store(duty, Ordering::Relaxed);
        if duty == 0 {
            set(SPEEDS[N], false);
        }
        true
    }
}

/// The converter of the battery's voltage. A sample takes some 70 microseconds.
pub struct Converter(ADC);

impl Converter {
    fn start(converter: ADC) -> Self {
        let new = Self(converter);
        new.0.config.write(|w| {
            let w = w.res()._10bit().inpsel().analog_input_one_third_prescaling();
            w.refsel().vbg().psel().analog_input4()
        });
        new.0.enable.write(|w| w.enable().enabled());
        new.begin();
        new
    }

    fn begin(&self) {
        // SAFETY: a task is started by a one.
        #[expect(unsafe_code, reason = "the peripheral crate has no safe call for it")]
        self.0.tasks_start.write(|w| unsafe { w.bits(1) });
    }
}

impl Samples for Converter {
    fn sample(&mut self) -> u16 {
        let sample = self.0.result.read().result().bits();
        self.begin();
        sample
    }
}

impl Board {
    /// Starts the clock, the link and the outputs; `None` the second time.
    #[must_use]
    pub fn take(chassis: Chassis) -> Option<Self> {
        let chip = Peripherals::take()?;
        // The oscillator of the chip alone is not exact enough for the link.
        // SAFETY: a task is started by a one.
        #[expect(unsafe_code, reason = "the peripheral crate has no safe call for it")]
        chip.CLOCK.tasks_hfclkstart.write(|w| unsafe { w.bits(1) });
        while chip.CLOCK.events_hfclkstarted.read().bits() == 0 {}

        SPEEDS.into_iter().chain(DIRECTIONS).chain(LED).for_each(drive);
        set(LED[0], true);
        let by_watchdog = chip.POWER.resetreas.read().dog().is_detected();
        chip.POWER.resetreas.write(|w| w.dog().detected()); // which clears it
        begin(cut_motors, by_watchdog);

        start(&chip.TIMER0);
        TIMER.with(|slot| *slot = Slot::Full(chip.TIMER0));
        enable(Interrupt::TIMER0);
        let link = LINK.start(LinkPort::start(chip.UART0));
        enable(Interrupt::UART0);

        let drive = DifferentialDrive::new(Side, Side, Milliseconds, chassis);
        let battery = VoltageGauge::new(Converter::start(chip.ADC), CELL);
        // SAFETY: the flash lies there, by the chip's reference manual, and nothing writes it.
        #[expect(unsafe_code, reason = "the flash is read where it lies")]
        let storage = unsafe { mapped(0, 0x1_0000, Slots::NRF51822) };
        let (clock, watchdog) = (Milliseconds, ChipWatchdog(chip.WDT));
        Some(Self { link, drive, clock, battery, storage, led: Absent, watchdog })
    }
}

static LINK: Line<LinkPort, 384, 256> = Line::new();
static TIMER: Shared<Slot<TIMER0>> = Shared::new(Slot::Empty);

#[interrupt]
fn UART0() {
    LINK.serve();
}

#[interrupt]
fn TIMER0() {
    let is_new = TIMER.with(|timer| timer.as_mut().is_some_and(|timer| serve(timer)));
    if is_new == Some(true) {
        count_millisecond();
    }
}

/// Starts the timer: microseconds, from zero again after each period.
fn start(timer: &TIMER0) {
    timer.bitmode.write(|w| w.bitmode()._16bit());
    timer.shorts.write(|w| w.compare3_clear().enabled());
    timer.intenset.write(|w| w.compare0().set().compare1().set().compare3().set());
    // SAFETY: the registers take these numbers.
    #[expect(unsafe_code, reason = "the peripheral crate has no safe call for it")]
    unsafe {
        timer.prescaler.write(|w| w.prescaler().bits(4));
        timer.cc.iter().for_each(|cc| cc.write(|w| w.bits(NEVER.into())));
        timer.cc[3].write(|w| w.bits(PERIOD.into()));
        timer.tasks_start.write(|w| w.bits(1));
    }
}

/// Ends the pulses whose time has come, and begins those of a new period; returns whether there is
/// one.
fn serve(timer: &TIMER0) -> bool {
    let is_new = timer.events_compare[3].read().bits() != 0;
    for ((event, cc), (pin, duty)) in
        timer.events_compare.iter().zip(&timer.cc).zip(SPEEDS.into_iter().zip(&DUTIES))
    {
        if event.read().bits() != 0 {
            event.reset();
            set(pin, false);
        }
        let duty = duty.load(Ordering::Relaxed);
        if is_new && duty > 0 {
            let end = if duty < 100 { u16::from(duty) * (PERIOD / 100) } else { NEVER };
            // SAFETY: the register takes any number.
            #[expect(unsafe_code, reason = "the peripheral crate has no safe call for it")]
            cc.write(|w| unsafe { w.bits(end.into()) });
            set(pin, true);
        }
    }
    timer.events_compare[3].reset();
    is_new
}

/// A clock of one tick per millisecond, of a timer that goes on while the core sleeps.
#[derive(Clone, Copy, Debug)]
pub struct Milliseconds;

impl Milliseconds {
    /// Cycles of the core since the start in whole milliseconds, modulo 2^32: the core has no
    /// counter. For differences only.
    #[must_use]
    pub fn cycles(self) -> u32 {
        now().0.wrapping_mul(16_000)
    }
}

impl hardware::Clock for Milliseconds {
    fn now(&mut self) -> Instant {
        now()
    }
}

/// The port of the link, which receives and sends byte by byte.
pub struct LinkPort {
    uart: UART0,
    is_sending: bool,
}

impl LinkPort {
    fn start(uart: UART0) -> Self {
        set(LINK_OUT, true);
        drive(LINK_OUT);
        // SAFETY: the numbers are those of pins, and tasks are started by a one.
        #[expect(unsafe_code, reason = "the peripheral crate has no safe call for it")]
        unsafe {
            uart.pseltxd.write(|w| w.bits(LINK_OUT as u32));
            uart.pselrxd.write(|w| w.bits(LINK_IN as u32));
            uart.baudrate.write(|w| w.baudrate().baud115200());
            uart.intenset.write(|w| w.rxdrdy().set());
            uart.enable.write(|w| w.enable().enabled());
            uart.tasks_starttx.write(|w| w.bits(1));
            uart.tasks_startrx.write(|w| w.bits(1));
        }
        Self { uart, is_sending: false }
    }
}

impl Port for LinkPort {
    fn read(&mut self) -> Option<Result<u8, Disturbed>> {
        let uart = &self.uart;
        if uart.events_rxdrdy.read().bits() == 0 {
            return None;
        }
        uart.events_rxdrdy.reset();
        let byte = uart.rxd.read().rxd().bits();
        let is_disturbed = uart.errorsrc.read().bits() != 0;
        uart.errorsrc.write(|w| w.overrun().clear().framing().clear().break_().clear());
        Some(if is_disturbed { Err(Disturbed) } else { Ok(byte) })
    }

    fn has_room(&mut self) -> bool {
        self.is_sending &= self.uart.events_txdrdy.read().bits() == 0;
        !self.is_sending
    }

    fn write(&mut self, byte: u8) {
        self.uart.events_txdrdy.reset();
        // SAFETY: the register takes any byte.
        #[expect(unsafe_code, reason = "the register has no safe way to write a byte")]
        self.uart.txd.write(|w| unsafe { w.txd().bits(byte) });
        self.is_sending = true;
    }

    fn ask_for_room(&mut self, asks: bool) {
        if asks {
            self.uart.intenset.write(|w| w.txdrdy().set());
        } else {
            self.uart.intenclr.write(|w| w.txdrdy().clear());
        }
    }

    fn pend(&mut self) {
        NVIC::pend(Interrupt::UART0);
    }
}
