//! What boards with an Arm Cortex-M have in common: sleep, reset, and its interrupts.

use super::port::{Disturbed, Port};
use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::{NVIC, SCB};
use embedded_io::{Read, ReadReady, Write, WriteReady};

pub use cortex_m_rt::entry;

/// Sleeps until the next interrupt: a byte on the link, or the next millisecond.
pub fn sleep() {
    cortex_m::asm::wfi();
}

/// Resets the chip, or on some chips the core alone.
pub(super) fn reset() -> ! {
    SCB::sys_reset()
}

/// The number of an interrupt, for chips without a crate that names them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Irq(pub u16);

impl Irq {
    /// Makes the interrupt's handler run as soon as it can.
    pub fn pend(self) {
        NVIC::pend(self);
    }
}

// SAFETY: the number does not change.
#[expect(unsafe_code, reason = "the trait is unsafe to implement")]
unsafe impl InterruptNumber for Irq {
    fn number(self) -> u16 {
        self.0
    }
}

/// A [`Port`] of two halves that implement `embedded-io`, and of the interrupt that both raise.
#[derive(Debug)]
pub struct IoPort<R, W, I> {
    receiver: R,
    sender: W,
    interrupt: I,
    ask: fn(&mut W, bool),
}

impl<R, W, I: InterruptNumber> IoPort<R, W, I> {
    /// Creates a port from its halves. `ask` lets the sender interrupt while it has room, or keeps
    /// it from that; the receiver interrupts when it has received.
    pub const fn new(receiver: R, sender: W, interrupt: I, ask: fn(&mut W, bool)) -> Self {
        Self { receiver, sender, interrupt, ask }
    }
}

impl<R, W, I> Port for IoPort<R, W, I>
where
    R: Read + ReadReady + Send,
    W: Write + WriteReady + Send,
    I: InterruptNumber + Send,
{
    fn read(&mut self) -> Option<Result<u8, Disturbed>> {
        if !self.receiver.read_ready().unwrap_or(false) {
            return None;
        }
        let mut byte = [0];
        let [received] = match self.receiver.read(&mut byte) {
            Ok(1) => byte,
            _ => return Some(Err(Disturbed)),
        };
        Some(Ok(received))
    }

    fn has_room(&mut self) -> bool {
        self.sender.write_ready().unwrap_or(false)
    }

    fn write(&mut self, byte: u8) {
        // There is room.
        let _ = self.sender.write(&[byte]);
    }

    fn flush(&mut self) {
        let _ = self.sender.flush();
    }

    fn ask_for_room(&mut self, asks: bool) {
        (self.ask)(&mut self.sender, asks);
    }

    fn pend(&mut self) {
        NVIC::pend(self.interrupt);
    }
}

/// Lets an interrupt through to its handler.
pub fn enable(interrupt: impl InterruptNumber) {
    // SAFETY: unmasking can break critical sections that mask single interrupts; there are none
    // here.
    #[expect(unsafe_code, reason = "the peripheral crate has no safe call for it")]
    unsafe {
        NVIC::unmask(interrupt);
    }
}
