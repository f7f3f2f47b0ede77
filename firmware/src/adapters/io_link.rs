//! A link over two byte streams of `embedded-io`.

use super::FrameQueue;
use crate::hardware::Link;
use embedded_io::{Read, ReadReady, Write, WriteReady};

/// Failed reads after which one call gives up: a line full of noise fails often.
const ATTEMPTS: usize = 16;

/// A [`Link`] that reads from `RX` what is ready, and writes to `TX` what it takes without waiting.
///
/// Frames wait in a queue of `N` bytes, 512 unless named. One that does not fit is refused as a
/// whole, and the controller counts it; `TX` never sees half of a frame unless it fails. Each call
/// of the controller hands on what `TX` has room for, and so does [`poll`](Self::poll). Nothing is
/// flushed: `TX` has to send by itself, as the serial ports of HALs do.
///
/// A HAL of `embedded-io` 0.6 fits by `Stream06` (feature `embedded-io-06`), one of
/// `embedded-hal-nb` by `StreamNb` (feature of that name), an asynchronous one by `AsyncLink`
/// (feature `async`).
///
/// ```
/// use embedded_io::{ErrorType, Read, ReadReady, Write, WriteReady};
/// use firmware::adapters::IoLink;
/// use firmware::hardware::Link;
/// use std::convert::Infallible;
///
/// /// A serial port that has room for two bytes at a time.
/// struct Port(Vec<u8>);
/// # impl ErrorType for Port { type Error = Infallible; }
/// # impl ReadReady for Port {
/// #     fn read_ready(&mut self) -> Result<bool, Infallible> { Ok(false) }
/// # }
/// # impl Read for Port {
/// #     fn read(&mut self, _: &mut [u8]) -> Result<usize, Infallible> { Ok(0) }
/// # }
/// impl WriteReady for Port {
///     fn write_ready(&mut self) -> Result<bool, Infallible> {
///         Ok(self.0.len() < 2)
///     }
/// }
/// impl Write for Port {
///     fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
///         let count = bytes.len().min(2 - self.0.len());
///         self.0.extend(&bytes[..count]);
///         Ok(count)
///     }
///     fn flush(&mut self) -> Result<(), Infallible> {
///         unreachable!("it could wait")
///     }
/// }
///
/// let mut link = IoLink::new(Port(vec![]), Port(vec![]));
/// assert!(link.send(&[0, 1, 2, 0])); // the tick goes on at once
/// assert_eq!(link.sender().0, [0, 1]);
/// link.sender_mut().0.clear(); // two bytes have left
/// link.poll();
/// assert_eq!(link.sender().0, [2, 0]);
/// ```
#[derive(Debug)]
pub struct IoLink<RX, TX, const N: usize = 512> {
    receiver: RX,
    sender: TX,
    outbox: FrameQueue<N>,
    errors: u32,
}

impl<RX, TX> IoLink<RX, TX> {
    /// Creates a link from both directions.
    #[must_use]
    pub const fn new(receiver: RX, sender: TX) -> Self {
        Self::with_queue(receiver, sender)
    }
}

impl<RX, TX, const N: usize> IoLink<RX, TX, N> {
    /// Creates a link with a queue of `N` bytes.
    #[must_use]
    pub const fn with_queue(receiver: RX, sender: TX) -> Self {
        Self { receiver, sender, outbox: FrameQueue::new(), errors: 0 }
    }

    /// Returns the number of failed reads and writes.
    #[must_use]
    pub const fn errors(&self) -> u32 {
        self.errors
    }

    /// Returns the number of frames that did not fit the queue.
    #[must_use]
    pub const fn refused(&self) -> u32 {
        self.outbox.refused()
    }

    /// Returns the stream to which frames go.
    #[must_use]
    pub const fn sender(&self) -> &TX {
        &self.sender
    }

    /// Returns the stream to which frames go, to serve it.
    pub const fn sender_mut(&mut self) -> &mut TX {
        &mut self.sender
    }

    fn count<T, E>(&mut self, result: Result<T, E>) -> Option<T> {
        self.errors = self.errors.saturating_add(u32::from(result.is_err()));
        result.ok()
    }
}

impl<RX, TX: Write + WriteReady, const N: usize> IoLink<RX, TX, N> {
    /// Writes what is queued as long as `TX` has room. A port with little room wants this between
    /// two ticks, in the loop or in its interrupt.
    pub fn poll(&mut self) {
        loop {
            // Asked even when nothing is queued: a port may hold a byte back until then.
            let ready = self.sender.write_ready();
            if self.count(ready) != Some(true) || self.outbox.front().is_empty() {
                return;
            }
            let written = self.sender.write(self.outbox.front());
            match self.count(written) {
                Some(0) | None => return,
                Some(count) => self.outbox.consume(count),
            }
        }
    }
}

impl<RX: Read + ReadReady, TX: Write + WriteReady, const N: usize> Link for IoLink<RX, TX, N> {
    fn receive(&mut self) -> Option<u8> {
        let mut byte = [0];
        (self.receive_into(&mut byte) == 1).then_some(byte[0])
    }

    fn receive_into(&mut self, bytes: &mut [u8]) -> usize {
        self.poll();
        let (mut received, mut failures) = (0, 0);
        while let Some(rest) = bytes.get_mut(received..).filter(|rest| !rest.is_empty()) {
            let ready = self.receiver.read_ready();
            if self.count(ready) != Some(true) {
                break;
            }
            let read = self.receiver.read(rest);
            match self.count(read) {
                Some(0) => break,
                Some(count) => received += count,
                None if failures == ATTEMPTS => break,
                None => failures += 1,
            }
        }
        received.min(bytes.len())
    }

    fn send(&mut self, frame: &[u8]) -> bool {
        let is_queued = self.outbox.push(frame);
        self.poll();
        is_queued
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_io::{ErrorKind, ErrorType};
    use std::vec::Vec;

    /// A receiver that gives what its script says: bytes, silence (`None`), or an error.
    struct Script<'a>(&'a [Result<Option<u8>, ErrorKind>]);

    impl ErrorType for Script<'_> {
        type Error = ErrorKind;
    }

    impl ReadReady for Script<'_> {
        fn read_ready(&mut self) -> Result<bool, ErrorKind> {
            match self.0 {
                [Ok(None), rest @ ..] => {
                    self.0 = rest;
                    Ok(false)
                }
                _ => Ok(!self.0.is_empty()),
            }
        }
    }

    impl Read for Script<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> Result<usize, ErrorKind> {
            let (first, rest) = self.0.split_first().expect("reads only when ready");
            self.0 = rest;
            buffer[0] = (*first)?.expect("reads only when ready");
            Ok(1)
        }
    }

    /// A sender with room for so many bytes before it would wait, which takes some of them at a
    /// time. It fails the test where it is written to or flushed and would wait.
    #[derive(Debug, Default)]
    struct Port {
        sent: Vec<u8>,
        room: usize,
        at_a_time: usize,
        failures: u32,
    }

    impl Port {
        fn with_room(room: usize, at_a_time: usize) -> Self {
            Self { room, at_a_time, ..Self::default() }
        }
    }

    impl ErrorType for Port {
        type Error = ErrorKind;
    }

    impl WriteReady for Port {
        fn write_ready(&mut self) -> Result<bool, ErrorKind> {
            Ok(self.room > 0 || self.failures > 0)
        }
    }

    impl Write for Port {
        fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
            if self.failures > 0 {
                self.failures -= 1;
                return Err(ErrorKind::Other);
            }
            assert!(self.room > 0 && !bytes.is_empty(), "it would wait");
            let count = bytes.len().min(self.room).min(self.at_a_time);
            self.sent.extend(&bytes[..count]);
            self.room -= count;
            Ok(count)
        }

        fn flush(&mut self) -> Result<(), ErrorKind> {
            panic!("it would wait");
        }
    }

    fn receiving<'a>(script: &'a [Result<Option<u8>, ErrorKind>]) -> IoLink<Script<'a>, Port> {
        IoLink::new(Script(script), Port::default())
    }

    fn sending<const N: usize>(port: Port) -> IoLink<Script<'static>, Port, N> {
        IoLink::with_queue(Script(&[]), port)
    }

    #[test]
    fn receives_only_what_is_ready() {
        let script = [Ok(Some(7)), Ok(None), Ok(Some(8))];
        let mut link = receiving(&script);
        assert_eq!([link.receive(), link.receive(), link.receive()], [Some(7), None, Some(8)]);
        assert_eq!((link.receive(), link.errors()), (None, 0));
    }

    #[test]
    fn gathers_what_a_port_gives_byte_by_byte() {
        let script = [Ok(Some(1)), Ok(Some(2)), Ok(Some(3)), Ok(None), Ok(Some(4))];
        let (mut link, mut bytes) = (receiving(&script), [0; 8]);
        assert_eq!((link.receive_into(&mut bytes), &bytes[..3]), (3, &[1, 2, 3][..]));
        assert_eq!((link.receive_into(&mut bytes), bytes[0]), (1, 4));
    }

    #[test]
    fn goes_on_after_failed_reads_but_not_for_ever() {
        let noise = Err(ErrorKind::InvalidData);
        let script = [noise, noise, Ok(Some(9)), noise, Ok(Some(10))];
        let (mut link, mut bytes) = (receiving(&script), [0; 4]);
        assert_eq!((link.receive_into(&mut bytes), &bytes[..2]), (2, &[9, 10][..]));
        assert_eq!(link.errors(), 3);
        let script = [noise; 1000];
        let mut link = receiving(&script);
        assert_eq!(link.receive_into(&mut bytes), 0);
        assert!(link.errors() <= 1 + ATTEMPTS as u32);
    }

    #[test]
    fn a_slow_port_gets_whole_frames_in_order_in_whatever_pieces_it_takes_them() {
        for at_a_time in 1..6 {
            let mut link = sending::<16>(Port::with_room(0, at_a_time));
            let mut taken = Vec::new();
            for frame in 0..200_u8 {
                if link.send(&[frame; 5]) {
                    taken.extend([frame; 5]);
                }
                link.sender.room += 4;
                link.receive();
            }
            link.sender.room = 100;
            link.poll();
            assert_eq!(link.sender.sent, taken, "{at_a_time} at a time");
            assert!(link.refused() > 0 && taken.len() > 700, "{} refused", link.refused());
        }
    }

    #[test]
    fn a_port_that_is_never_ready_costs_frames_and_no_time() {
        let mut link = sending::<16>(Port::with_room(0, 1));
        let taken = (0..100).filter(|_| link.send(&[1, 2, 3, 4, 5])).count();
        assert_eq!((taken, link.refused(), link.errors()), (3, 97, 0));
        assert_eq!(link.sender.sent, []);
    }

    #[test]
    fn a_port_that_fails_or_takes_nothing_is_tried_again_at_the_next_call() {
        let mut link = sending::<16>(Port { failures: 1, ..Port::with_room(10, 10) });
        assert!(link.send(&[1, 2, 3]));
        assert_eq!((link.errors(), link.sender.sent.len()), (1, 0));
        link.receive();
        assert_eq!(link.sender.sent, [1, 2, 3]);
        let mut link = sending::<16>(Port::with_room(10, 0));
        assert!(link.send(&[1, 2, 3]), "it waits in the queue");
        link.sender.at_a_time = 9;
        link.poll();
        assert_eq!(link.sender.sent, [1, 2, 3]);
    }
}
