//! The ESP32-C3 at 160 MHz with 4 MiB of flash, as on Espressif's ESP32-C3-DevKitM-1. It has no
//! floating-point unit.
//!
//! | pins | what |
//! |---|---|
//! | GPIO21, GPIO20 | UART0, 115200 baud: the log, as defmt frames; the kit wires it to its USB |
//! | GPIO6, GPIO7 | UART1, 115200 baud, out and in: the link to the teammates |
//! | GPIO4, GPIO5 | left motor: speed at 20 kHz, direction |
//! | GPIO3, GPIO1 | right motor: speed at 20 kHz, direction |
//! | GPIO0 | half of the battery's voltage; without a battery, tie it to ground |
//! | GPIO10 | status LED |
//!
//! The pins that choose how the chip boots (2, 8, 9) and those of the built-in debug probe (18, 19)
//! are free. The memory map is that of the HAL: code runs from the flash through a cache, and the
//! stack has what the statics leave of the RAM, above them. A watchpoint guards its end.

use super::clock::{count_millisecond, now};
use super::shared::{Shared, Slot};
use super::{Board, Disturbed, Line, LogPort, Port, begin};
use crate::adapters::{Chassis, DifferentialDrive, Samples, VoltageGauge, VoltageRange, Wheel};
use crate::fail_safe::{self, FailureRecord};
use crate::hardware;
use crate::page::Slots;
use crate::{BootCounter, Storage};
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use esp_bootloader_esp_idf::{ESP_IDF_COMPATIBLE_VERSION, MMU_PAGE_SIZE, SECURE_VERSION, esp_app_desc};
use esp_hal::analog::adc::{Adc, AdcCalCurve, AdcConfig, AdcPin, Attenuation};
use esp_hal::clock::CpuClock;
use esp_hal::gpio::{DriveMode, Level, Output, OutputConfig};
use esp_hal::interrupt::bind_handler;
use esp_hal::ledc::{LSGlobalClkSource, Ledc, LowSpeed, channel, timer};
use esp_hal::ledc::{channel::ChannelIFace, timer::TimerIFace};
use esp_hal::peripherals::{ADC1, GPIO, GPIO0, Interrupt, SYSTEM, UART0, UART1};
use esp_hal::rtc_cntl::{Rtc, Rwdt, RwdtStage, SocResetReason, reset_reason};
use esp_hal::system::Cpu;
use esp_hal::time::{self, Rate};
use esp_hal::timer::PeriodicTimer;
use esp_hal::timer::systimer::{SystemTimer, Unit};
use esp_hal::uart::{Config, Uart, UartInterrupt};
use esp_hal::{Blocking, handler};
use esp_storage::FlashStorage;
use iibt_core::time::{Duration, Instant};
use riscv::register::{mcause, mtval};
use static_cell::StaticCell;

const BAUD: u32 = 115_200;

/// The pins of the two speed outputs, and the number by which one is driven low by its register.
const SPEED_PINS: [usize; 2] = [4, 3];
const BY_REGISTER: u8 = 128;

/// A lithium cell behind a divider of two equal resistors: 3.3 V and 4.2 V, in millivolts at the
/// pin.
const CELL: VoltageRange = VoltageRange { empty: 1650, full: 2100 };

/// Polls of the converter before its first sample is given up: some milliseconds.
const FIRST_SAMPLE: u32 = 10_000;

// What the second stage of the boot looks for at the start of the image. It names no time, so that
// the same source gives the same image.
esp_app_desc!(
    env!("CARGO_PKG_VERSION"),
    "iibt",
    "-",
    "-",
    ESP_IDF_COMPATIBLE_VERSION,
    MMU_PAGE_SIZE,
    0,
    u16::MAX,
    SECURE_VERSION
);

/// Why the last run ended: in memory that only switching on clears.
// SAFETY: the name is the one that `fail_safe` refers to, with this type.
#[expect(unsafe_code, reason = "the memory that a reset leaves is a section of the HAL's map")]
#[unsafe(export_name = "_failure_record")]
#[unsafe(link_section = ".rtc_fast.persistent")]
static RECORD: FailureRecord = FailureRecord::new();

/// The port of the link; its software interrupt is the second of the chip.
type LinkPort = Serial<1>;

type Motor = Wheel<channel::Channel<'static, LowSpeed>, Output<'static>>;

/// The link to the teammates.
pub type TeamLink = &'static Line<LinkPort>;

/// The drive of the two motors.
pub type Motors = DifferentialDrive<Motor, Motor, Milliseconds>;

/// The flash of the chip, read and written by the functions of its ROM.
pub type Flash = FlashStorage<'static>;

/// The battery gauge.
pub type Gauge = VoltageGauge<Converter>;

/// The status LED, on while its pin is high, as it is from the start.
pub type StatusLed = Output<'static>;

/// The watchdog of the chip's always-on part, which has an oscillator of its own.
pub struct ChipWatchdog(Rwdt);

impl fail_safe::Watchdog for ChipWatchdog {
    fn start(&mut self, limit: Duration) {
        self.0.set_timeout(RwdtStage::Stage0, time::Duration::from_millis(limit.0.into()));
        self.0.enable();
    }

    fn feed(&mut self) {
        self.0.feed();
    }
}

/// Takes both speed outputs from their generator and drives them low, whatever the drive does.
fn cut_motors() {
    let gpio = GPIO::regs();
    for pin in SPEED_PINS {
        // SAFETY: a store to each of registers that nothing writes once the pins are set up.
        #[expect(unsafe_code, reason = "the peripheral crate has no safe call for it")]
        unsafe {
            gpio.out_w1tc().write(|w| w.bits(1 << pin));
            gpio.enable_w1ts().write(|w| w.bits(1 << pin));
            gpio.func_out_sel_cfg(pin).write(|w| w.out_sel().bits(BY_REGISTER).oen_sel().set_bit());
        }
    }
}

type BatteryPin = AdcPin<GPIO0<'static>, ADC1<'static>, AdcCalCurve<ADC1<'static>>>;

/// The converter of the battery's voltage, in millivolts by the calibration of the chip's maker.
pub struct Converter {
    adc: Adc<'static, ADC1<'static>, Blocking>,
    pin: BatteryPin,
    latest: u16,
}

impl Converter {
    fn new(adc: ADC1<'static>, pin: GPIO0<'static>) -> Self {
        let mut config = AdcConfig::new();
        let pin = config.enable_pin_with_cal(pin, Attenuation::_11dB);
        let mut converter = Self { adc: Adc::new(adc, config), pin, latest: 0 };
        let first = (0..FIRST_SAMPLE).find_map(|_| converter.adc.read_oneshot(&mut converter.pin).ok());
        converter.latest = first.unwrap_or(0);
        converter
    }
}

impl Samples for Converter {
    /// The sample that was begun by the last call, and begins the next.
    fn sample(&mut self) -> u16 {
        self.latest = self.adc.read_oneshot(&mut self.pin).unwrap_or(self.latest);
        self.latest
    }
}

impl Board {
    /// Starts the clock, the log, the link and the outputs; `None` the second time.
    #[must_use]
    pub fn take(chassis: Chassis) -> Option<Self> {
        static IS_TAKEN: AtomicBool = AtomicBool::new(false);
        if IS_TAKEN.load(Ordering::Relaxed) {
            return None;
        }
        IS_TAKEN.store(true, Ordering::Relaxed);
        let chip = esp_hal::init(esp_hal::Config::default().with_cpu_clock(CpuClock::max()));
        let mut timer = PeriodicTimer::new(SystemTimer::new(chip.SYSTIMER).alarm0);
        timer.set_interrupt_handler(millisecond);
        timer.listen();
        timer.start(time::Duration::from_millis(1)).ok()?;
        TIMER.with(|slot| *slot = Slot::Full(timer));

        let config = Config::default().with_baudrate(BAUD);
        let log = Uart::new(chip.UART0, config).ok()?.with_tx(chip.GPIO21).with_rx(chip.GPIO20);
        bind_handler(Interrupt::FROM_CPU_INTR0, serve_log);
        bind_handler(Interrupt::UART0, serve_log);
        LOG.start(Serial(log));
        let reason = reset_reason(Cpu::ProCpu);
        begin(cut_motors, matches!(reason, Some(SocResetReason::CoreRtcWdt | SocResetReason::SysRtcWdt)));
        let mut link = Uart::new(chip.UART1, config).ok()?.with_tx(chip.GPIO6).with_rx(chip.GPIO7);
        link.listen(UartInterrupt::RxFifoFull | UartInterrupt::RxTimeout);
        let link = LINK.start(Serial(link));
        bind_handler(Interrupt::FROM_CPU_INTR1, serve_link);
        bind_handler(Interrupt::UART1, serve_link);

        let mut ledc = Ledc::new(chip.LEDC);
        ledc.set_global_slow_clock(LSGlobalClkSource::APBClk);
        static PERIOD: StaticCell<timer::Timer<'static, LowSpeed>> = StaticCell::new();
        let period = PERIOD.try_init(ledc.timer(timer::Number::Timer0))?;
        period
            .configure(timer::config::Config {
                duty: timer::config::Duty::Duty11Bit,
                clock_source: timer::LSClockSource::APBClk,
                frequency: Rate::from_khz(20),
            })
            .ok()?;
        let output = channel::config::Config { timer: period, duty_pct: 0, drive_mode: DriveMode::PushPull };
        let mut left = ledc.channel(channel::Number::Channel0, chip.GPIO4);
        let mut right = ledc.channel(channel::Number::Channel1, chip.GPIO3);
        left.configure(output).ok()?;
        right.configure(output).ok()?;
        let left = Wheel::new(left, Output::new(chip.GPIO5, Level::Low, OutputConfig::default()));
        let right = Wheel::new(right, Output::new(chip.GPIO1, Level::Low, OutputConfig::default()));
        let drive = DifferentialDrive::new(left, right, Milliseconds, chassis);

        let battery = VoltageGauge::new(Converter::new(chip.ADC1, chip.GPIO0), CELL);
        let flash = FlashStorage::new(chip.FLASH);
        let storage = Storage { flash, page: Slots::ESP32C3, counter: Some(BootCounter::ESP32C3) };
        let led = Output::new(chip.GPIO10, Level::High, OutputConfig::default());
        let watchdog = ChipWatchdog(Rtc::new(chip.RTC_TIMER).rwdt);
        // SAFETY: every handler is bound, and there is no critical section to break.
        #[expect(unsafe_code, reason = "interrupts are enabled for the first time")]
        unsafe {
            riscv::interrupt::enable();
        }
        Some(Self { link, drive, clock: Milliseconds, battery, storage, led, watchdog })
    }
}

/// Waits for an interrupt, unless a debugger is connected, which could not read the memory then.
pub(super) fn wait() {
    esp_hal::interrupt::wait_for_interrupt();
}

#[expect(unsafe_code, reason = "a place that only the linker knows")]
// SAFETY: the HAL's memory map puts the word at the end of the stack, and writes it at the start.
unsafe extern "C" {
    safe static __stack_chk_guard: AtomicU32;
}

/// Whether the exception that is handled is a stack pointer below the RAM, which the runtime turns
/// into the cause 14, or a write to the guard of the stack, which is watched.
pub(super) fn has_overflowed_stack() -> bool {
    match mcause::read().code() {
        14 => true,
        3 => mtval::read() == __stack_chk_guard.as_ptr() as usize,
        _ => false,
    }
}

/// Resets the chip, but for its always-on part.
pub(super) fn reset() -> ! {
    esp_hal::system::software_reset()
}

static LOG: LogPort<Serial<0>> = LogPort::new();
static LINK: Line<LinkPort> = Line::new();
static TIMER: Shared<Slot<PeriodicTimer<'static, Blocking>>> = Shared::new(Slot::Empty);

#[handler]
fn serve_log() {
    Serial::<0>::acknowledge();
    LOG.serve();
}

#[handler]
fn serve_link() {
    LinkPort::acknowledge();
    LINK.serve();
}

#[handler]
fn millisecond() {
    TIMER.with(|timer| timer.as_mut().map(PeriodicTimer::clear_interrupt));
    count_millisecond();
}

/// A clock of one tick per millisecond.
#[derive(Clone, Copy, Debug)]
pub struct Milliseconds;

impl Milliseconds {
    /// Cycles of the chip's timer, of a sixteenth of a microsecond, modulo 2^32. For differences
    /// only.
    #[must_use]
    pub fn cycles(self) -> u32 {
        SystemTimer::unit_value(Unit::Unit0) as u32
    }
}

impl hardware::Clock for Milliseconds {
    fn now(&mut self) -> Instant {
        now()
    }
}

/// A UART of the chip. The software interrupt of the same number makes its handler run.
pub struct Serial<const NUMBER: usize>(Uart<'static, Blocking>);

impl<const NUMBER: usize> Serial<NUMBER> {
    /// Tells the chip that its interrupts are served. What comes after this is another one.
    fn acknowledge() {
        Self::ask_to_run(false);
        let uart = if NUMBER == 0 { UART0::regs() } else { UART1::regs() };
        uart.int_clr().write(|w| {
            w.tx_done().clear_bit_by_one().rxfifo_full().clear_bit_by_one().rxfifo_tout().clear_bit_by_one()
        });
    }

    fn ask_to_run(asks: bool) {
        SYSTEM::regs().cpu_intr_from_cpu(NUMBER).write(|w| w.cpu_intr().bit(asks));
    }
}

impl<const NUMBER: usize> Port for Serial<NUMBER> {
    fn read(&mut self) -> Option<Result<u8, Disturbed>> {
        let mut byte = [0];
        match self.0.read_buffered(&mut byte) {
            Ok(0) => None,
            Ok(_) => Some(Ok(byte[0])),
            Err(_) => Some(Err(Disturbed)),
        }
    }

    fn has_room(&mut self) -> bool {
        self.0.write_ready()
    }

    fn write(&mut self, byte: u8) {
        // There is room.
        let _ = self.0.write(&[byte]);
    }

    fn flush(&mut self) {
        let _ = self.0.flush();
    }

    /// There is room for all of the queue of the chip, once it has sent what is in it.
    fn ask_for_room(&mut self, asks: bool) {
        if asks {
            self.0.listen(UartInterrupt::TxDone);
        } else {
            self.0.unlisten(UartInterrupt::TxDone);
        }
    }

    fn pend(&mut self) {
        Self::ask_to_run(true);
    }
}
