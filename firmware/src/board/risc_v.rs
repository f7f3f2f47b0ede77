//! What boards with a RISC-V have in common: sleep, reset, and faults.

use super::fail_safe::fail;
use crate::fail_safe::Failure;
use riscv::register::mepc;

pub use riscv_rt::entry;

#[cfg(feature = "riscv-virt")]
pub(super) use super::riscv_virt::reset;

/// Sleeps until the next interrupt: a byte on the link, or the next millisecond.
pub fn sleep() {
    riscv::asm::wfi();
}

/// Reports an exception that nothing else handles. It runs on the stack of the program: one that
/// has overflowed is not told from other faults.
// SAFETY: the name is the one that riscv-rt calls.
#[allow(unsafe_code, reason = "the runtime looks for this name")]
#[unsafe(export_name = "ExceptionHandler")]
extern "C" fn exception(_: &riscv_rt::TrapFrame) -> ! {
    fail(Failure::Fault { at: mepc::read() as u32 }, || {})
}
