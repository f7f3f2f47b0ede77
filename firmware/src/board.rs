//! The STM32F405 on its 16 MHz internal oscillator, in QEMU's `netduinoplus2` and on hardware
//! alike.
//!
//! | pins | what |
//! |---|---|
//! | PA9, PA10 | USART1, 115200 baud: the log, as defmt frames |
//! | PA2, PA3 | USART2, 115200 baud: the link to the teammates |
//! | PA6, PB0 | left motor: speed at 20 kHz (TIM3), direction |
//! | PA7, PB1 | right motor: speed at 20 kHz (TIM3), direction |
//! | PA5 | status LED |
//!
//! A panic or a fault is logged and restarts the robot. The stack is guarded by its place; see
//! `memory.x`.

mod clock;
mod fault;
mod link;
mod log;
mod serial;
mod shared;

pub use clock::Milliseconds;
pub use fault::restart;
pub use link::TeamLink;
pub use log::dropped as dropped_log_frames;

use crate::adapters::{Chassis, DifferentialDrive, Wheel};
use stm32f4xx_hal::gpio::{Output, PA5, PB0, PB1};
use stm32f4xx_hal::pac::{Peripherals, TIM3};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::timer::PwmChannel;

/// The status LED, on while its pin is high.
pub type StatusLed = PA5<Output>;

/// The drive of the two motors.
pub type Motors = DifferentialDrive<
    Wheel<PwmChannel<TIM3, 0>, PB0<Output>>,
    Wheel<PwmChannel<TIM3, 1>, PB1<Output>>,
    Milliseconds,
>;

/// The parts of the board that a controller uses.
pub struct Board {
    /// The link to the teammates.
    pub link: TeamLink,
    /// The motors.
    pub drive: Motors,
    /// Time since the start.
    pub clock: Milliseconds,
    /// The status LED.
    pub led: StatusLed,
}

impl Board {
    /// Starts the clock, the log, the link and the outputs; `None` the second time.
    #[must_use]
    pub fn take(chassis: Chassis) -> Option<Self> {
        let core = cortex_m::Peripherals::take()?;
        let chip = Peripherals::take()?;
        let mut rcc = chip.RCC.constrain();
        let a = chip.GPIOA.split(&mut rcc);
        let b = chip.GPIOB.split(&mut rcc);

        let clock = Milliseconds::start(core.SYST, rcc.clocks.hclk());
        log::start(chip.USART1.tx(a.pa9, BAUD.bps(), &mut rcc).ok()?);
        let link = TeamLink::start(chip.USART2.serial((a.pa2, a.pa3), BAUD.bps(), &mut rcc).ok()?);

        let (_, (left, right, ..)) = chip.TIM3.pwm_hz(20.kHz(), &mut rcc);
        let (mut left, mut right) = (left.with(a.pa6), right.with(a.pa7));
        left.enable();
        right.enable();
        let left = Wheel::new(left, b.pb0.into_push_pull_output());
        let right = Wheel::new(right, b.pb1.into_push_pull_output());
        let drive = DifferentialDrive::new(left, right, clock, chassis);
        Some(Self { link, drive, clock, led: a.pa5.into_push_pull_output() })
    }
}

/// Sleeps until the next interrupt: a byte on the link, or the next millisecond.
pub fn sleep() {
    cortex_m::asm::wfi();
}

const BAUD: u32 = 115_200;
