//! The log: defmt frames, queued by the program and sent by the interrupt of USART1.
//!
//! Ready-made loggers write to the port with the interrupts off, which at 115200 baud would lose
//! bytes on the link. This one never waits: a frame for which there is no room is dropped as a
//! whole.

use super::serial::{drain, enable, feed};
use super::shared::Shared;
use crate::adapters::FrameQueue;
use cortex_m::peripheral::NVIC;
use critical_section::RestoreState;
use defmt::Encoder;
use stm32f4xx_hal::interrupt;
use stm32f4xx_hal::pac::{Interrupt, USART1};
use stm32f4xx_hal::serial::Tx;

/// Bytes that may wait to be sent: a few hundred log lines.
const BYTES: usize = 4096;

// Apart from the port, so that it is all zeros and takes no flash.
static QUEUE: Shared<FrameQueue<BYTES>> = Shared::new(FrameQueue::new());
static PORT: Shared<Option<Tx<USART1>>> = Shared::new(None);
static FRAME: Shared<Frame> = Shared::new(Frame::NONE);

/// Begins to send; frames that were logged before are sent first.
pub(super) fn start(port: Tx<USART1>) {
    PORT.with(|slot| *slot = Some(port));
    enable(Interrupt::USART1);
}

/// Abandons the frame that was being logged when the robot failed, so that the failure can be
/// logged.
pub(super) fn abandon() {
    FRAME.with(|frame| frame.depth = 0);
}

/// Sends all that was logged, waiting for the port.
pub(super) fn flush() {
    with_port(drain);
}

/// The number of log frames dropped since the start because the queue was full.
#[must_use]
pub fn dropped() -> u32 {
    QUEUE.with(|queue| queue.refused()).unwrap_or(0)
}

fn with_port(act: impl FnOnce(&mut Tx<USART1>, &mut FrameQueue<BYTES>)) {
    PORT.with(|port| port.as_mut().map(|port| QUEUE.with(|queue| act(port, queue))));
}

/// The frame that is being logged.
struct Frame {
    encoder: Encoder,
    /// More than one when a value logs while it is being logged.
    depth: u8,
    interrupts: RestoreState,
}

impl Frame {
    const NONE: Self = Self { encoder: Encoder::new(), depth: 0, interrupts: RestoreState::invalid() };

    fn open(&mut self, interrupts: RestoreState) {
        if self.depth == 0 {
            self.interrupts = interrupts;
            self.encoder.start_frame(queue);
        }
        self.depth = self.depth.saturating_add(1);
    }

    /// Bytes of an inner frame are dropped, so that the outer one stays whole.
    fn write(&mut self, bytes: &[u8]) {
        if self.depth == 1 {
            self.encoder.write(bytes, queue);
        }
    }

    /// Returns the state of the interrupts to restore when this was the outermost frame.
    fn close(&mut self) -> Option<RestoreState> {
        self.depth = self.depth.saturating_sub(1);
        (self.depth == 0).then(|| {
            self.encoder.end_frame(queue);
            QUEUE.with(FrameQueue::finish);
            self.interrupts
        })
    }
}

fn queue(bytes: &[u8]) {
    QUEUE.with(|queue| queue.extend(bytes));
}

#[defmt::global_logger]
struct Usart1Log;

// SAFETY: from `acquire` to `release` the interrupts are off and there is one core, so that nothing
// else can log in between.
#[expect(unsafe_code, reason = "the trait is unsafe to implement")]
unsafe impl defmt::Logger for Usart1Log {
    fn acquire() {
        // SAFETY: `release` gives the outermost section back; the state of an inner one says that
        // the interrupts were off already, so nothing is lost with it.
        let interrupts = unsafe { critical_section::acquire() };
        FRAME.with(|frame| frame.open(interrupts));
    }

    unsafe fn flush() {
        flush();
    }

    unsafe fn release() {
        if let Some(Some(interrupts)) = FRAME.with(Frame::close) {
            NVIC::pend(Interrupt::USART1);
            // SAFETY: the state is the one that the matching `acquire` got.
            unsafe { critical_section::release(interrupts) };
        }
    }

    unsafe fn write(bytes: &[u8]) {
        FRAME.with(|frame| frame.write(bytes));
    }
}

#[interrupt]
fn USART1() {
    with_port(feed);
}
