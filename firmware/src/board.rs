//! The boards of the images: one file and one memory map each, beside what they have in common.
//!
//! A feature chooses the board, and with it what [`Board`] and the types of its parts are. A board
//! of one's own is [`Board`] written for it over [`Line`], [`LogPort`] and the hardware adapters;
//! docs/flashing.md has one.
//!
//! A panic or a fault is logged and restarts the robot. The stack is guarded by its place; see the
//! memory maps in `firmware/boards`.

mod clock;
mod fault;
mod line;
mod log;
mod mapped_flash;
mod port;
mod shared;
pub mod systick;

#[cfg(feature = "stm32f405")]
mod stm32f405;
#[cfg(feature = "stm32f405")]
pub use stm32f405::*;

#[cfg(feature = "rp2040")]
mod rp2040;
#[cfg(feature = "rp2040")]
pub use rp2040::*;
#[cfg(feature = "nrf52840")]
mod nrf52840;
#[cfg(feature = "nrf52840")]
pub use nrf52840::*;

use crate::hardware::{Battery, Clock, Drive, Link};
use crate::team_member::{self, Standing, Started};
pub use clock::{count_millisecond, next_millisecond, now};
pub use cortex_m_rt::entry;
pub use fault::restart;
pub use line::Line;
pub use log::{LogPort, dropped as dropped_log_frames};
pub use mapped_flash::{MappedFlash, mapped};
pub use port::{Disturbed, IoPort, Irq, Port, enable};

#[cfg(any(feature = "stm32f405", feature = "rp2040", feature = "nrf52840"))]
/// The parts of the board that a controller uses.
pub struct Board {
    /// The link to the teammates.
    pub link: TeamLink,
    /// The port to a base.
    #[cfg(feature = "stm32f405")]
    pub base: BasePort,
    /// The motors.
    pub drive: Motors,
    /// Time since the start.
    pub clock: Milliseconds,
    /// The battery gauge.
    pub battery: Gauge,
    /// The flash, and what lies in it.
    pub storage: crate::Storage<Flash>,
    /// The status LED.
    pub led: StatusLed,
}

/// Sleeps until the next interrupt: a byte on the link, or the next millisecond.
pub fn sleep() {
    cortex_m::asm::wfi();
}

/// Stands, with the motors off and without a word to the team, until the board is reset: a restart
/// would end here again.
pub fn stand(reason: &Standing) -> ! {
    defmt::error!("stands: {}", reason);
    loop {
        sleep();
    }
}

/// Runs a robot that was started, and restarts it when it needs that; stands where it was not
/// started. `cycles` counts those of the core.
pub fn run<L: Link, C: Clock, D: Drive, B: Battery>(
    started: Result<Started<L, C, D, B>, Standing>,
    cycles: impl Fn() -> u32,
) -> ! {
    let started = started.unwrap_or_else(|reason| stand(&reason));
    team_member::run(started, cycles, sleep);
    restart()
}
