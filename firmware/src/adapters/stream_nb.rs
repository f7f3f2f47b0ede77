//! Serial ports of HALs that implement `embedded-hal-nb`.

use embedded_hal_nb::nb;
use embedded_hal_nb::serial::{
    Error as PortError, ErrorKind as PortErrorKind, Read as NbRead, Write as NbWrite,
};
use embedded_io::{ErrorKind, ErrorType, Read, ReadReady, Write, WriteReady};

/// One direction of a serial port with the traits of `embedded-hal-nb`, as a stream of
/// `embedded-io`: `IoLink::new(StreamNb::new(rx), StreamNb::new(tx))`.
///
/// It keeps one byte: the one that it has read to see whether there is one, or the one that the
/// port has not taken yet.
#[derive(Clone, Debug)]
pub struct StreamNb<T> {
    port: T,
    kept: Option<Result<u8, ErrorKind>>,
}

impl<T> StreamNb<T> {
    /// Creates a stream of one direction of a port.
    #[must_use]
    pub const fn new(port: T) -> Self {
        Self { port, kept: None }
    }
}

impl<T> ErrorType for StreamNb<T> {
    type Error = ErrorKind;
}

impl<T: NbRead> StreamNb<T> {
    /// The next byte or error; `None` while there is none.
    fn take(&mut self) -> Option<Result<u8, ErrorKind>> {
        self.kept.take().or_else(|| match self.port.read() {
            Ok(byte) => Some(Ok(byte)),
            Err(nb::Error::WouldBlock) => None,
            Err(nb::Error::Other(error)) => Some(Err(kind(&error))),
        })
    }
}

impl<T: NbRead> ReadReady for StreamNb<T> {
    fn read_ready(&mut self) -> Result<bool, ErrorKind> {
        self.kept = self.take();
        Ok(self.kept.is_some())
    }
}

impl<T: NbRead> Read for StreamNb<T> {
    /// Waits for the first byte only.
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, ErrorKind> {
        if bytes.is_empty() {
            return Ok(0);
        }
        while !self.read_ready()? {}
        let mut count = 0;
        for place in bytes {
            match self.take() {
                Some(Ok(byte)) => *place = byte,
                Some(Err(error)) if count == 0 => return Err(error),
                other => {
                    self.kept = other;
                    break;
                }
            }
            count += 1;
        }
        Ok(count)
    }
}

impl<T: NbWrite> StreamNb<T> {
    /// Hands the kept byte to the port; returns whether none is kept any more.
    fn hand_over(&mut self) -> Result<bool, ErrorKind> {
        let Some(Ok(byte)) = self.kept else { return Ok(true) };
        match self.port.write(byte) {
            Ok(()) => self.kept = None,
            Err(nb::Error::WouldBlock) => return Ok(false),
            Err(nb::Error::Other(error)) => {
                self.kept = None;
                return Err(kind(&error));
            }
        }
        Ok(true)
    }
}

impl<T: NbWrite> WriteReady for StreamNb<T> {
    fn write_ready(&mut self) -> Result<bool, ErrorKind> {
        self.hand_over()
    }
}

impl<T: NbWrite> Write for StreamNb<T> {
    /// Waits for the first byte only.
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        if bytes.is_empty() {
            return Ok(0);
        }
        while !self.hand_over()? {}
        let mut count = 0;
        for &byte in bytes {
            self.kept = Some(Ok(byte));
            count += 1;
            if !self.hand_over()? {
                break;
            }
        }
        Ok(count)
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        while !self.hand_over()? {}
        nb::block!(self.port.flush()).map_err(|error| kind(&error))
    }
}

/// What has happened to a byte, in the words of `embedded-io`.
fn kind(error: &impl PortError) -> ErrorKind {
    match error.kind() {
        PortErrorKind::Parity | PortErrorKind::Noise | PortErrorKind::FrameFormat => ErrorKind::InvalidData,
        _ => ErrorKind::Other,
    }
}

#[cfg(test)]
mod tests {
    use super::super::IoLink;
    use super::*;
    use crate::hardware::Link;
    use embedded_hal_nb::serial::ErrorType as NbErrorType;
    use std::collections::VecDeque;
    use std::vec::Vec;

    /// A port that receives what its script says, and whose transmitter has room for some bytes.
    #[derive(Default)]
    struct Port {
        script: VecDeque<nb::Result<u8, PortErrorKind>>,
        sent: Vec<u8>,
        room: usize,
    }

    impl NbErrorType for Port {
        type Error = PortErrorKind;
    }

    impl NbRead for Port {
        fn read(&mut self) -> nb::Result<u8, PortErrorKind> {
            self.script.pop_front().unwrap_or(Err(nb::Error::WouldBlock))
        }
    }

    impl NbWrite for Port {
        fn write(&mut self, byte: u8) -> nb::Result<(), PortErrorKind> {
            if self.room == 0 {
                return Err(nb::Error::WouldBlock);
            }
            self.room -= 1;
            self.sent.push(byte);
            Ok(())
        }

        fn flush(&mut self) -> nb::Result<(), PortErrorKind> {
            panic!("it would wait")
        }
    }

    #[test]
    fn a_link_over_a_port_that_would_block_loses_nothing_and_never_waits() {
        let noise = Err(nb::Error::Other(PortErrorKind::Noise));
        let silence = || Err(nb::Error::WouldBlock);
        let script = [Ok(1), Ok(2), noise, Ok(3), silence(), silence(), Ok(4)];
        let receiver = Port { script: script.into_iter().collect(), ..Port::default() };
        let mut link = IoLink::<_, _, 8>::with_queue(StreamNb::new(receiver), StreamNb::new(Port::default()));
        let mut bytes = [0; 9];
        assert_eq!((link.receive_into(&mut bytes), &bytes[..3], link.errors()), (3, &[1, 2, 3][..], 1));
        assert_eq!((link.receive_into(&mut bytes), bytes[0], link.receive()), (1, 4, None));

        assert!(link.send(&[1, 2, 3]) && link.send(&[4, 5, 6]));
        assert!(
            link.send(&[7, 8]) && !link.send(&[9, 9]),
            "one byte waits in the stream, seven in the queue"
        );
        for _ in 0..9 {
            link.sender_mut().port.room = 1;
            link.receive();
        }
        assert_eq!(link.sender().port.sent, [1, 2, 3, 4, 5, 6, 7, 8]);
    }
}
