//! What the log and the link ask of a serial port.

use crate::adapters::FrameQueue;
use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use embedded_io::{Read, ReadReady, Write, WriteReady};

/// A serial port as its interrupt serves it.
pub trait Port: Send {
    /// Takes the next received byte; `None` when there is none.
    ///
    /// # Errors
    /// [`Disturbed`] when a byte was lost.
    fn read(&mut self) -> Option<Result<u8, Disturbed>>;

    /// Returns whether the transmitter takes a byte.
    fn has_room(&mut self) -> bool;

    /// Gives the transmitter a byte.
    fn write(&mut self, byte: u8);

    /// Waits until all bytes have left; only before a restart.
    fn flush(&mut self) {
        while !self.has_room() {}
    }

    /// Asks for an interrupt once there is room, or for no more.
    fn ask_for_room(&mut self, asks: bool);

    /// Makes the port's interrupt run as soon as it can.
    fn pend(&mut self);
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

/// A received byte that was lost: overrun, noise, or a break in the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Disturbed;

/// Moves bytes from the queue to the port while it takes them, and asks for an interrupt when it
/// takes more.
///
/// Code that queues a frame pends the port's interrupt, whose handler calls this: the first bytes
/// leave even where, as in QEMU 7.2, an empty transmitter raises no interrupt.
pub(super) fn feed<const N: usize>(port: &mut impl Port, queue: &mut FrameQueue<N>) {
    while port.has_room() {
        let Some(byte) = queue.pop() else { return port.ask_for_room(false) };
        port.write(byte);
    }
    port.ask_for_room(true);
}

/// Sends all that is queued, waiting for the port.
pub(super) fn drain<const N: usize>(port: &mut impl Port, queue: &mut FrameQueue<N>) {
    while let Some(byte) = queue.pop() {
        while !port.has_room() {}
        port.write(byte);
    }
    port.flush();
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
