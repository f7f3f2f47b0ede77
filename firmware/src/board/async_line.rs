//! A line as a port of `embedded-io-async`, for an [`AsyncLink`](crate::adapters::AsyncLink).

use super::line::Line;
use super::port::Port;
use core::convert::Infallible;
use core::future::poll_fn;
use core::task::{Poll, Waker};
use embedded_io_async::{ErrorType, Read, Write};

/// The tasks that wait for the port: one for received bytes, one for room.
#[derive(Debug)]
pub(super) struct Waiting {
    receiver: Option<Waker>,
    sender: Option<Waker>,
}

impl Waiting {
    pub(super) const NOBODY: Self = Self { receiver: None, sender: None };

    /// Wakes both: the port was served.
    pub(super) fn wake(&mut self) {
        let tasks = [self.receiver.take(), self.sender.take()];
        tasks.into_iter().flatten().for_each(Waker::wake);
    }
}

impl<P, const IN: usize, const OUT: usize> ErrorType for &Line<P, IN, OUT> {
    type Error = Infallible;
}

impl<P: Port, const IN: usize, const OUT: usize> Read for &Line<P, IN, OUT> {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        poll_fn(|task| match self.take(bytes, |waiting| waiting.receiver = Some(task.waker().clone())) {
            0 if !bytes.is_empty() => Poll::Pending,
            count => Poll::Ready(Ok(count)),
        })
        .await
    }
}

impl<P: Port, const IN: usize, const OUT: usize> Write for &Line<P, IN, OUT> {
    /// Queues the first bytes, at most a quarter of the queue, as soon as they fit.
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        let part = bytes.get(..OUT / 4).unwrap_or(bytes);
        poll_fn(|task| match self.queue(part, |waiting| waiting.sender = Some(task.waker().clone())) {
            true => Poll::Ready(Ok(part.len())),
            false => Poll::Pending,
        })
        .await
    }

    /// Does not wait: the interrupt sends what is queued.
    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
