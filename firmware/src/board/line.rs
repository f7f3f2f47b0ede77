//! The link to the teammates: a serial port, emptied and filled by its interrupt.

#[cfg(feature = "async")]
use super::async_line::Waiting;
use super::port::{Disturbed, Port, feed};
use super::shared::{Shared, Slot};
use crate::adapters::base::{Base, BaseAnswer};
use crate::adapters::{ByteQueue, FrameQueue};
use crate::hardware::Link;

/// Bytes that may wait to be read: 177 ms of a busy line at 115200 baud.
const INBOX: usize = 2048;

/// Bytes that may wait to be sent.
const OUTBOX: usize = 512;

/// A serial line to the teammates or to a base, for a `static`: a reference to it is the [`Link`].
///
/// It never waits: a frame for which there is no room is refused. `IN` and `OUT` are the bytes that
/// may wait. With the feature `async`, a reference is a port of `embedded-io-async` as well.
#[derive(Debug)]
pub struct Line<P, const IN: usize = INBOX, const OUT: usize = OUTBOX> {
    port: Shared<Slot<P>>,
    queues: Shared<Queues<IN, OUT>>,
}

#[derive(Debug)]
struct Queues<const IN: usize, const OUT: usize> {
    inbox: ByteQueue<IN>,
    outbox: FrameQueue<OUT>,
    lost: u32,
    #[cfg(feature = "async")]
    waiting: Waiting,
}

impl<P: Port, const IN: usize, const OUT: usize> Line<P, IN, OUT> {
    /// A line without a port.
    #[must_use]
    pub const fn new() -> Self {
        let queues = Queues {
            inbox: ByteQueue::new(),
            outbox: FrameQueue::new(),
            lost: 0,
            #[cfg(feature = "async")]
            waiting: Waiting::NOBODY,
        };
        Self { port: Shared::new(Slot::Empty), queues: Shared::new(queues) }
    }

    /// Begins to listen and to send, once the port's interrupt is enabled.
    pub fn start(&'static self, port: P) -> &'static Self {
        self.port.with(|slot| *slot = Slot::Full(port));
        self
    }

    /// Serves the port. Its interrupt calls this.
    pub fn serve(&self) {
        self.port.with(|port| port.as_mut().map(|port| self.queues.with(|queues| queues.serve(port))));
    }

    /// Moves received bytes to `bytes`; if there are none, notes who waits for them.
    #[cfg(feature = "async")]
    pub(super) fn take(&self, bytes: &mut [u8], note: impl FnOnce(&mut Waiting)) -> usize {
        let taken = self.queues.with(|queues| {
            let count = queues.inbox.read(bytes);
            if count == 0 {
                note(&mut queues.waiting);
            }
            count
        });
        taken.unwrap_or(0)
    }

    /// Queues bytes that are to be sent; if they do not fit, notes who waits for room.
    #[cfg(feature = "async")]
    pub(super) fn queue(&self, bytes: &[u8], note: impl FnOnce(&mut Waiting)) -> bool {
        let queued = self.queues.with(|queues| {
            let fits = queues.outbox.push(bytes);
            if !fits {
                note(&mut queues.waiting);
            }
            fits
        });
        self.port.with(|port| port.as_mut().map(P::pend));
        queued.unwrap_or(false)
    }

    /// The number of received bytes that wait to be read.
    #[must_use]
    pub fn waiting(&self) -> usize {
        self.queues.with(|queues| queues.inbox.len()).unwrap_or(0)
    }

    /// The number of received bytes lost since the start, to a full queue or a disturbed line.
    #[must_use]
    pub fn lost(&self) -> u32 {
        self.queues.with(|queues| queues.lost).unwrap_or(0)
    }
}

impl<P: Port, const IN: usize, const OUT: usize, B: Link> Base<&Line<P, IN, OUT>, B> {
    /// Tells the base how many bytes of teammates wait on the link; returns whether its port could
    /// take that.
    pub fn answer_waiting(&mut self) -> bool {
        self.answer(BaseAnswer::Waiting(self.link.waiting().try_into().unwrap_or(u16::MAX)))
    }
}

impl<P: Port, const IN: usize, const OUT: usize> Default for Line<P, IN, OUT> {
    fn default() -> Self {
        Self::new()
    }
}

impl<P: Port, const IN: usize, const OUT: usize> Link for &Line<P, IN, OUT> {
    fn receive(&mut self) -> Option<u8> {
        let mut byte = [0];
        (self.receive_into(&mut byte) == 1).then_some(byte[0])
    }

    fn receive_into(&mut self, bytes: &mut [u8]) -> usize {
        self.queues.with(|queues| queues.inbox.read(bytes)).unwrap_or(0)
    }

    fn send(&mut self, frame: &[u8]) -> bool {
        let queued = self.queues.with(|queues| queues.outbox.push(frame)).unwrap_or(false);
        self.port.with(|port| port.as_mut().map(P::pend));
        queued
    }
}

impl<const IN: usize, const OUT: usize> Queues<IN, OUT> {
    fn receive(&mut self, byte: Result<u8, Disturbed>) {
        let kept = byte.is_ok_and(|byte| self.inbox.push(byte));
        self.lost = self.lost.saturating_add(u32::from(!kept));
    }

    fn serve(&mut self, port: &mut impl Port) {
        while let Some(byte) = port.read() {
            self.receive(byte);
        }
        feed(port, &mut self.outbox);
        #[cfg(feature = "async")]
        self.waiting.wake();
    }
}
