//! A link whose port is served by tasks, over the byte streams of `embedded-io-async`.

use super::{FrameInbox, FrameQueue};
use crate::hardware::Link;
use core::cell::RefCell;
use core::future::poll_fn;
use core::task::{Context, Poll, Waker};
use critical_section::Mutex;
use embedded_io_async::{Read, Write};

/// The bytes that a task hands over at once.
const CHUNK: usize = 64;

/// A link for a `static`: a reference to it is the [`Link`] of a robot, and two tasks serve its
/// port, one that [receives](Self::receive_from) and one that [sends](Self::send_to).
///
/// The robot never waits. Received bytes become frames in the task, so noise takes no room and the
/// newest `IN` bytes of frames are kept. A frame that does not fit the `OUT` bytes that wait to be
/// sent is refused as a whole, and the controller counts it.
///
/// It works with any executor. The queues are guarded by a critical section of some hundred
/// instructions.
///
/// ```
/// use firmware::adapters::AsyncLink;
/// use firmware::hardware::Link;
///
/// static LINK: AsyncLink = AsyncLink::new();
///
/// // Each in a task of its own, with the halves of an asynchronous serial port:
/// async fn listen(port: impl embedded_io_async::Read) {
///     LINK.receive_from(port).await
/// }
/// async fn speak(port: impl embedded_io_async::Write) {
///     LINK.send_to(port).await
/// }
///
/// let mut link = &LINK; // the link of the robot
/// assert!(link.send(&[0, 1, 2, 0]));
/// assert_eq!(link.receive_packet(&mut [0; 127]), None);
/// ```
#[derive(Debug)]
pub struct AsyncLink<const IN: usize = 2048, const OUT: usize = 512>(Mutex<RefCell<Queues<IN, OUT>>>);

#[derive(Debug)]
struct Queues<const IN: usize, const OUT: usize> {
    inbox: FrameInbox<IN>,
    outbox: FrameQueue<OUT>,
    /// The task that waits for a frame to send.
    waiting: Option<Waker>,
    errors: u32,
}

impl<const IN: usize, const OUT: usize> AsyncLink<IN, OUT> {
    /// A link without a port.
    #[must_use]
    pub const fn new() -> Self {
        let queues = Queues { inbox: FrameInbox::new(), outbox: FrameQueue::new(), waiting: None, errors: 0 };
        Self(Mutex::new(RefCell::new(queues)))
    }

    /// Takes what a port receives, for ever. A failed read is counted, and others run before the
    /// next.
    pub async fn receive_from(&self, mut port: impl Read) -> ! {
        let mut bytes = [0; CHUNK];
        loop {
            let read = port.read(&mut bytes).await;
            match self.count(read).and_then(|count| bytes.get(..count)) {
                Some(received @ [_, ..]) => self.with(|queues| queues.inbox.feed(received)),
                _ => give_way().await,
            }
        }
    }

    /// Writes what is to be sent to a port, for ever. A failed write is counted, and costs the
    /// frames that it is a part of.
    pub async fn send_to(&self, mut port: impl Write) -> ! {
        let mut bytes = [0; CHUNK];
        loop {
            let count = poll_fn(|task| self.poll_outbox(task, &mut bytes)).await;
            let written = port.write_all(bytes.get(..count).unwrap_or(&bytes)).await;
            if self.count(written).is_none() {
                give_way().await;
            }
            if self.with(|queues| queues.outbox.front().is_empty()) {
                let flushed = port.flush().await;
                self.count(flushed);
            }
        }
    }

    /// Returns the number of failed reads and writes.
    #[must_use]
    pub fn errors(&self) -> u32 {
        self.with(|queues| queues.errors)
    }

    /// Returns the number of frames that did not fit the queue of what is to be sent.
    #[must_use]
    pub fn refused(&self) -> u32 {
        self.with(|queues| queues.outbox.refused())
    }

    /// Calls a function with what came in: its counts, for example.
    pub fn inbox<T>(&self, look: impl FnOnce(&FrameInbox<IN>) -> T) -> T {
        self.with(|queues| look(&queues.inbox))
    }

    fn with<T>(&self, act: impl FnOnce(&mut Queues<IN, OUT>) -> T) -> T {
        critical_section::with(|section| act(&mut self.0.borrow_ref_mut(section)))
    }

    fn count<T, E>(&self, result: Result<T, E>) -> Option<T> {
        if result.is_err() {
            self.with(|queues| queues.errors = queues.errors.saturating_add(1));
        }
        result.ok()
    }

    /// Moves bytes that are to be sent to `bytes`; returns how many, once there are any.
    fn poll_outbox(&self, task: &mut Context<'_>, bytes: &mut [u8; CHUNK]) -> Poll<usize> {
        self.with(|queues| {
            let front = queues.outbox.front();
            let count = front.len().min(CHUNK);
            if count == 0 {
                queues.waiting = Some(task.waker().clone());
                return Poll::Pending;
            }
            bytes.iter_mut().zip(front).for_each(|(to, &byte)| *to = byte);
            queues.outbox.consume(count);
            Poll::Ready(count)
        })
    }
}

impl<const IN: usize, const OUT: usize> Default for AsyncLink<IN, OUT> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const IN: usize, const OUT: usize> Link for &AsyncLink<IN, OUT> {
    fn receive(&mut self) -> Option<u8> {
        None
    }

    fn receive_packet(&mut self, packet: &mut [u8]) -> Option<usize> {
        self.with(|queues| queues.inbox.packets.pop(packet))
    }

    fn send(&mut self, frame: &[u8]) -> bool {
        let (is_queued, waiting) = self.with(|queues| (queues.outbox.push(frame), queues.waiting.take()));
        if let Some(task) = waiting {
            task.wake();
        }
        is_queued
    }
}

/// Lets other tasks run once.
async fn give_way() {
    let mut has_waited = false;
    poll_fn(|task| {
        if core::mem::replace(&mut has_waited, true) {
            return Poll::Ready(());
        }
        task.waker().wake_by_ref();
        Poll::Pending
    })
    .await;
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::future::Future;
    use core::pin::pin;
    use embedded_io::{ErrorKind, ErrorType};
    use std::collections::VecDeque;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU32, Ordering};
    use std::task::Wake;
    use std::vec::Vec;

    /// Both directions of a port, by a script for the receiver and room for the sender.
    #[derive(Default)]
    struct Wire {
        received: RefCell<VecDeque<Result<Vec<u8>, ErrorKind>>>,
        sent: RefCell<Vec<u8>>,
        room: RefCell<usize>,
        failures: RefCell<u32>,
    }

    impl ErrorType for &Wire {
        type Error = ErrorKind;
    }

    impl Read for &Wire {
        async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, ErrorKind> {
            let next = poll_fn(|_| self.received.borrow_mut().pop_front().map_or(Poll::Pending, Poll::Ready));
            let next = next.await?;
            bytes[..next.len()].copy_from_slice(&next);
            Ok(next.len())
        }
    }

    impl Write for &Wire {
        async fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
            poll_fn(|_| {
                if *self.failures.borrow() > 0 {
                    *self.failures.borrow_mut() -= 1;
                    return Poll::Ready(Err(ErrorKind::Other));
                }
                let count = bytes.len().min(*self.room.borrow()).min(3);
                self.sent.borrow_mut().extend(&bytes[..count]);
                *self.room.borrow_mut() -= count;
                if count > 0 { Poll::Ready(Ok(count)) } else { Poll::Pending }
            })
            .await
        }

        async fn flush(&mut self) -> Result<(), ErrorKind> {
            Ok(())
        }
    }

    #[derive(Default)]
    struct Wakes(AtomicU32);

    impl Wake for Wakes {
        fn wake(self: Arc<Self>) {
            self.0.fetch_add(1, Ordering::Relaxed);
        }
    }

    fn frame(byte: u8) -> [u8; 13] {
        [0, 11, 2, byte, 1, 1, 9, 9, 9, 9, 9, 9, 0]
    }

    fn poll(task: core::pin::Pin<&mut impl Future>, wakes: &Arc<Wakes>) {
        assert!(task.poll(&mut Context::from_waker(&wakes.clone().into())).is_pending());
    }

    #[test]
    fn a_task_cuts_what_the_port_receives_into_frames_and_outlives_errors_and_noise() {
        let (link, wire, wakes) = (AsyncLink::<256, 64>::new(), Wire::default(), Arc::default());
        let mut task = pin!(link.receive_from(&wire));
        poll(task.as_mut(), &wakes);
        let stream = [&[7; 300][..], &frame(1), &frame(2)[..5]].concat();
        let mut script = wire.received.borrow_mut();
        script.extend(stream.chunks(50).map(|part| Ok(part.to_vec())));
        script.push_front(Err(ErrorKind::Other));
        script.push_back(Ok(Vec::new()));
        script.push_back(Ok(frame(2)[5..].to_vec()));
        drop(script);
        for _ in 0..3 {
            poll(task.as_mut(), &wakes);
        }
        let (mut robot, mut packet) = (&link, [0; 127]);
        for byte in [1, 2] {
            assert_eq!(robot.receive_packet(&mut packet), Some(11));
            assert_eq!(packet[..11], frame(byte)[1..12]);
        }
        assert_eq!((robot.receive_packet(&mut packet), link.errors()), (None, 1));
        assert_eq!(link.inbox(FrameInbox::dropped), 1);
        assert_eq!(wakes.0.load(Ordering::Relaxed), 2, "it gives way after an error and after nothing");
    }

    #[test]
    fn a_task_sends_whole_frames_in_pieces_and_wakes_for_the_next() {
        let (link, wire, wakes) = (AsyncLink::<256, 32>::new(), Wire::default(), Arc::default());
        let mut robot = &link;
        let mut task = pin!(link.send_to(&wire));
        poll(task.as_mut(), &wakes);
        assert!(robot.send(&frame(1)) && wakes.0.load(Ordering::Relaxed) == 1);
        *wire.room.borrow_mut() = 5;
        poll(task.as_mut(), &wakes);
        assert_eq!(*wire.sent.borrow(), frame(1)[..5]);
        assert!(robot.send(&frame(2)) && robot.send(&frame(3)));
        assert!(!robot.send(&frame(4)), "three would take 39 bytes: it is refused as a whole");
        *wire.room.borrow_mut() = 500;
        poll(task.as_mut(), &wakes);
        assert_eq!(*wire.sent.borrow(), [frame(1), frame(2), frame(3)].concat());
        assert_eq!(link.refused(), 1);
        assert!(robot.send(&frame(5)) && wakes.0.load(Ordering::Relaxed) == 2);
    }

    #[test]
    fn a_port_that_is_never_ready_costs_frames_and_no_time() {
        let (link, wire, wakes) = (AsyncLink::<256, 64>::new(), Wire::default(), Arc::default());
        let (mut robot, mut task) = (&link, pin!(link.send_to(&wire)));
        let taken = (0..100).filter(|_| {
            poll(task.as_mut(), &wakes);
            robot.send(&frame(1))
        });
        assert_eq!(taken.count(), 1 + 64 / 13, "the one that the task holds, and a full queue");
        assert_eq!((wire.sent.borrow().len(), link.refused()), (0, 95));
    }

    #[test]
    fn failed_writes_cost_their_frames_and_nothing_after() {
        let (link, wire, wakes) = (AsyncLink::<256, 64>::new(), Wire::default(), Arc::default());
        let (mut robot, mut task) = (&link, pin!(link.send_to(&wire)));
        (*wire.failures.borrow_mut(), *wire.room.borrow_mut()) = (2, 100);
        for byte in 1..=3 {
            assert!(robot.send(&frame(byte)));
            for _ in 0..2 {
                poll(task.as_mut(), &wakes);
            }
        }
        assert_eq!(*wire.sent.borrow(), frame(3));
        assert_eq!(link.errors(), 2);
    }
}
