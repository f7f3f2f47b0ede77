//! What the log and the link ask of a serial port.

use crate::adapters::FrameQueue;

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
#[cfg(not(any(feature = "rtt", feature = "reduced")))]
pub(super) fn drain<const N: usize>(port: &mut impl Port, queue: &mut FrameQueue<N>) {
    while let Some(byte) = queue.pop() {
        while !port.has_room() {}
        port.write(byte);
    }
    port.flush();
}
