//! Shared parts of the two serial ports.

use crate::adapters::FrameQueue;
use cortex_m::peripheral::NVIC;
use embedded_hal_nb::serial::Write;
use stm32f4xx_hal::pac::Interrupt;
use stm32f4xx_hal::serial::{Instance, Tx, TxISR, TxListen};

/// Moves bytes from the queue to the port while it takes them, and asks for an interrupt when it
/// takes more.
///
/// Whoever queues a frame pends the port's interrupt, whose handler calls this: the first bytes
/// leave even where, as in QEMU 7.2, an empty transmitter raises no interrupt.
pub(super) fn feed<U: Instance, const N: usize>(tx: &mut Tx<U>, queue: &mut FrameQueue<N>) {
    while tx.is_tx_empty() {
        let Some(byte) = queue.pop() else { return tx.unlisten() };
        let _ = tx.write(byte);
    }
    tx.listen();
}

/// Sends all that is queued, waiting for the port.
pub(super) fn drain<U: Instance, const N: usize>(tx: &mut Tx<U>, queue: &mut FrameQueue<N>) {
    while let Some(byte) = queue.pop() {
        while tx.write(byte).is_err() {}
    }
    while tx.flush().is_err() {}
}

/// Lets an interrupt through to its handler.
pub(super) fn enable(interrupt: Interrupt) {
    // SAFETY: unmasking can break critical sections that mask single interrupts; there are none
    // here.
    #[expect(unsafe_code, reason = "the peripheral crate has no safe call for it")]
    unsafe {
        NVIC::unmask(interrupt);
    }
}
