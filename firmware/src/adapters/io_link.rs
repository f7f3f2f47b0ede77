//! A link over two byte streams of `embedded-io`.

use crate::hardware::Link;
use embedded_io::{Read, ReadReady, Write};

/// A [`Link`] that reads from `RX` what is ready and writes whole frames to `TX`.
///
/// Sending waits as long as `TX` does: give it a buffered writer where the robot must not wait.
#[derive(Debug)]
pub struct IoLink<RX, TX> {
    receiver: RX,
    sender: TX,
    errors: u32,
}

impl<RX, TX> IoLink<RX, TX> {
    /// Creates a link from both directions.
    pub const fn new(receiver: RX, sender: TX) -> Self {
        Self { receiver, sender, errors: 0 }
    }

    /// Returns the number of failed reads and writes.
    #[must_use]
    pub const fn errors(&self) -> u32 {
        self.errors
    }

    fn count<T, E>(&mut self, result: Result<T, E>) -> Option<T> {
        self.errors = self.errors.saturating_add(u32::from(result.is_err()));
        result.ok()
    }
}

impl<RX: Read + ReadReady, TX: Write> Link for IoLink<RX, TX> {
    fn receive(&mut self) -> Option<u8> {
        let ready = self.receiver.read_ready();
        if !self.count(ready)? {
            return None;
        }
        let mut byte = [0];
        let read = self.receiver.read(&mut byte);
        (self.count(read)? == 1).then_some(byte[0])
    }

    fn send(&mut self, frame: &[u8]) -> bool {
        let sent = self.sender.write_all(frame).and_then(|()| self.sender.flush());
        self.count(sent).is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_io::{ErrorKind, ErrorType};

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

    #[test]
    fn receives_only_what_is_ready() {
        let script = [Ok(Some(7)), Ok(None), Ok(Some(8))];
        let mut link = IoLink::new(Script(&script), [0; 0].as_mut_slice());
        assert_eq!(
            [link.receive(), link.receive(), link.receive(), link.receive()],
            [Some(7), None, Some(8), None]
        );
        assert_eq!(link.errors(), 0);
    }

    #[test]
    fn goes_on_after_a_failed_read() {
        let script = [Err(ErrorKind::Other), Ok(Some(9))];
        let mut link = IoLink::new(Script(&script), [0; 0].as_mut_slice());
        assert_eq!([link.receive(), link.receive()], [None, Some(9)]);
        assert_eq!(link.errors(), 1);
    }

    #[test]
    fn sends_whole_frames_and_counts_those_that_do_not_fit() {
        let mut wire = [0; 5];
        let mut link = IoLink::new(Script(&[]), wire.as_mut_slice());
        assert!(link.send(&[1, 2, 3]));
        assert!(!link.send(&[4, 5, 6]));
        assert_eq!(link.errors(), 1);
        assert_eq!(wire[..3], [1, 2, 3]);
    }
}
