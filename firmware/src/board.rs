//! The boards of the images: one file and one memory map each, beside what they have in common.
//!
//! A feature chooses the board, and with it what [`Board`] and the types of its parts are. A board
//! of one's own is [`Board`] written for it over [`Line`], [`LogPort`] and the hardware adapters;
//! docs/flashing.md has one.
//!
//! A panic, a fault or a main loop that is late stops the motors and restarts the robot, which then
//! logs the reason. The stack is guarded by its place; see the memory maps in `firmware/boards`.

#[cfg(target_arch = "arm")]
mod arm;
#[cfg(feature = "async")]
mod async_line;
mod clock;
mod fail_safe;
#[cfg(target_arch = "arm")]
mod fault;
mod line;
#[cfg(not(any(feature = "rtt", feature = "reduced")))]
mod log;
mod mapped_flash;
mod port;
#[cfg(target_arch = "riscv32")]
mod risc_v;
#[cfg(feature = "rtt")]
mod rtt;
mod shared;
#[cfg(any(feature = "rtt", feature = "reduced"))]
mod silent;
#[cfg(target_arch = "arm")]
pub mod systick;

#[cfg(feature = "stm32f405")]
mod stm32f405;
#[cfg(feature = "stm32f405")]
pub use stm32f405::*;

#[cfg(feature = "rp2040")]
mod rp2040;
#[cfg(feature = "rp2040")]
pub use rp2040::*;
#[cfg(feature = "nrf51822")]
mod nrf51822;
#[cfg(feature = "nrf51822")]
pub use nrf51822::*;
#[cfg(feature = "nrf52840")]
mod nrf52840;
#[cfg(feature = "nrf52840-radio")]
mod nrf52840_radio;
#[cfg(all(feature = "nrf52840", not(feature = "nrf52840-radio")))]
mod nrf52840_uart;
#[cfg(feature = "nrf52840")]
pub use nrf52840::*;
#[cfg(feature = "esp32c3")]
mod esp32c3;
#[cfg(feature = "esp32c3")]
pub use esp32c3::*;
#[cfg(feature = "riscv-virt")]
mod riscv_virt;
#[cfg(feature = "riscv-virt")]
pub use riscv_virt::*;

use crate::fail_safe as safe;
use crate::hardware::{Battery, Clock, Drive, Link};
use crate::team_member::{self, Standing, Started};
#[cfg(target_arch = "arm")]
pub use arm::{IoPort, Irq, enable, entry, sleep};
pub use clock::{count_millisecond, next_millisecond, now};
pub use fail_safe::{Guard, LATEST, begin, restart, stop_motors};
pub use line::Line;
#[cfg(not(any(feature = "rtt", feature = "reduced")))]
pub use log::{LogPort, dropped as dropped_log_frames};
pub use mapped_flash::{MappedFlash, mapped};
pub use port::{Disturbed, Port};
#[cfg(target_arch = "riscv32")]
pub use risc_v::{entry, sleep};
#[cfg(feature = "rtt")]
use rtt as log;
#[cfg(all(feature = "reduced", not(feature = "rtt")))]
use silent as log;
#[cfg(any(feature = "rtt", feature = "reduced"))]
pub use silent::LogPort;

#[cfg(any(
    feature = "stm32f405",
    feature = "rp2040",
    feature = "nrf51822",
    feature = "nrf52840",
    feature = "esp32c3",
    feature = "riscv-virt"
))]
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
    /// The watchdog of the chip, which is not started.
    pub watchdog: ChipWatchdog,
}

/// Stands, with the motors off and without a word to the team, until the board is reset: a restart
/// would end here again. A watchdog that outlives a restart is fed.
pub fn stand(reason: &impl defmt::Format, watchdog: impl safe::Watchdog) -> ! {
    defmt::error!("stands: {}", reason);
    fail_safe::stay(watchdog)
}

/// Runs a robot that was started, and restarts it when it needs that; stands where it was not
/// started. A loop that does not come round within [`LATEST`] is late: see [`Guard`]. `cycles`
/// counts those of the core.
pub fn run<L: Link, C: Clock, D: Drive, B: Battery>(
    started: Result<Started<L, C, D, B>, Standing>,
    watchdog: impl safe::Watchdog,
    cycles: impl Fn() -> u32,
) -> ! {
    match started {
        Ok(started) => {
            let mut guard = Guard::start(watchdog, LATEST);
            team_member::run(started, cycles, || {
                guard.feed();
                sleep();
            });
            restart()
        }
        Err(reason) => stand(&reason, watchdog),
    }
}
