//! What boards with a RISC-V have in common: sleep, reset, and faults.

#[cfg(feature = "esp32c3")]
use super::esp32c3 as chip;
use super::fail_safe::fail;
#[cfg(feature = "riscv-virt")]
use super::riscv_virt as chip;
use crate::fail_safe::Failure;
use riscv::register::mepc;

pub(super) use chip::reset;
pub use riscv_rt::entry;

/// Sleeps until the next interrupt: a byte on the link, or the next millisecond.
pub fn sleep() {
    chip::wait();
}

/// Reports an exception that nothing else handles. It runs on the stack of the program.
// SAFETY: the name is the one that riscv-rt calls.
#[allow(unsafe_code, reason = "the runtime looks for this name")]
#[unsafe(export_name = "ExceptionHandler")]
extern "C" fn exception() -> ! {
    let failure = if chip::has_overflowed_stack() {
        Failure::StackOverflow
    } else {
        Failure::Fault { at: mepc::read() as u32 }
    };
    fail(failure, || {})
}
