//! The log: defmt frames, queued by the program and sent by the interrupt of a serial port.
//!
//! Ready-made loggers write to the port with the interrupts off, which at 115200 baud would lose
//! bytes on the link. This one never waits: a frame for which there is no room is dropped as a
//! whole. How many were is logged with the next frame that leaves room for it.

use super::port::{Port, drain, feed};
use super::shared::{Shared, Slot};
use crate::adapters::FrameQueue;
use critical_section::RestoreState;
use defmt::Encoder;

/// Bytes that may wait to be sent: some two hundred log lines.
const BYTES: usize = 2048;

/// Bytes for the frame that tells how many were dropped.
const ROOM_TO_TELL: usize = 32;

// Apart from the rest, so that it is all zeros and takes no flash.
static QUEUE: Shared<FrameQueue<BYTES>> = Shared::new(FrameQueue::new());
static OUTPUT: Shared<Option<&'static dyn Output>> = Shared::new(None);
static FRAME: Shared<Frame> = Shared::new(Frame::NONE);
/// How many of the dropped frames were told.
static TOLD: Shared<u32> = Shared::new(0);

/// The port of the log, whatever it is.
trait Output: Sync {
    fn pend(&self);
    fn drain(&self);
}

/// The serial port that the log leaves by, for a `static`.
#[derive(Debug)]
pub struct LogPort<P>(Shared<Slot<P>>);

impl<P: Port> LogPort<P> {
    /// A log without a port.
    #[must_use]
    pub const fn new() -> Self {
        Self(Shared::new(Slot::Empty))
    }

    /// Begins to send, once the port's interrupt is enabled; frames that were logged before are
    /// sent first.
    pub fn start(&'static self, port: P) {
        self.0.with(|slot| *slot = Slot::Full(port));
        OUTPUT.with(|output| *output = Some(self));
        self.pend();
    }

    /// Serves the port. Its interrupt calls this.
    pub fn serve(&self) {
        self.with_queue(feed);
    }

    fn with_queue(&self, act: impl FnOnce(&mut P, &mut FrameQueue<BYTES>)) {
        self.0.with(|port| port.as_mut().map(|port| QUEUE.with(|queue| act(port, queue))));
    }
}

impl<P: Port> Default for LogPort<P> {
    fn default() -> Self {
        Self::new()
    }
}

impl<P: Port> Output for LogPort<P> {
    fn pend(&self) {
        self.0.with(|port| port.as_mut().map(P::pend));
    }

    fn drain(&self) {
        self.with_queue(drain);
    }
}

/// Abandons the frame that was being logged when the robot failed, so that the failure can be
/// logged.
pub(super) fn abandon() {
    FRAME.with(|frame| frame.depth = 0);
}

/// Sends all that was logged, waiting for the port.
pub(super) fn flush() {
    with_output(|output| output.drain());
}

/// The number of log frames dropped since the start because the queue was full.
#[must_use]
pub fn dropped() -> u32 {
    QUEUE.with(|queue| queue.refused()).unwrap_or(0)
}

/// Logs how many frames were dropped since that was last told, once there is room.
fn tell_dropped() {
    let has_room = QUEUE.with(|queue| queue.room() >= ROOM_TO_TELL).unwrap_or(false);
    let dropped = dropped();
    let untold = TOLD.with(|told| dropped.saturating_sub(*told)).unwrap_or(0);
    if has_room && untold > 0 {
        TOLD.with(|told| *told = dropped);
        defmt::warn!("{=u32} log frames were dropped", untold);
    }
}

fn with_output(act: impl FnOnce(&'static dyn Output)) {
    if let Some(Some(output)) = OUTPUT.with(|output| *output) {
        act(output);
    }
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
struct QueuedLog;

// SAFETY: from `acquire` to `release` the interrupts are off and there is one core, so that nothing
// else can log in between.
#[expect(unsafe_code, reason = "the trait is unsafe to implement")]
unsafe impl defmt::Logger for QueuedLog {
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
            with_output(|output| output.pend());
            // SAFETY: the state is the one that the matching `acquire` got.
            unsafe { critical_section::release(interrupts) };
            tell_dropped();
        }
    }

    unsafe fn write(bytes: &[u8]) {
        FRAME.with(|frame| frame.write(bytes));
    }
}
