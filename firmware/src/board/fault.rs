//! Faults of a Cortex-M: stop the motors, log the place, restart the robot.

use super::fail_safe::fail;
use crate::fail_safe::Failure;

/// The address reported for a stack overflow; odd, unlike every program counter.
const NO_STACK: u32 = 1;

/// Reports a fault; runs on a fresh stack.
extern "C" fn report(place: u32) -> ! {
    match place {
        NO_STACK => fail(Failure::StackOverflow, || {}),
        at => fail(Failure::Fault { at }, || {}),
    }
}

/// The hard fault, which every other fault escalates to.
///
/// After a stack overflow there is no stack to run on and no frame to read, so this starts over at
/// the top of the stack. The seventh word of the exception frame is the program counter; a frame
/// below `_stack_end` was never written.
// SAFETY: the name is the one that the vector table of cortex-m-rt refers to.
#[allow(unsafe_code, reason = "the stack pointer must change before any Rust runs")]
#[unsafe(naked)]
#[unsafe(export_name = "HardFault")]
extern "C" fn hard_fault() -> ! {
    // For every Cortex-M: the smallest have no conditional execution and no 16-bit immediates.
    core::arch::naked_asm!(
        "mrs r0, MSP",
        "ldr r1, =_stack_end",
        "cmp r0, r1",
        "blo 1f",
        "ldr r0, [r0, #24]",
        "b 2f",
        "1: movs r0, #{no_stack}",
        "2: ldr r1, =_stack_start",
        "msr MSP, r1",
        "ldr r1, ={report}",
        "bx r1",
        ".ltorg",
        no_stack = const NO_STACK,
        report = sym report,
    )
}
