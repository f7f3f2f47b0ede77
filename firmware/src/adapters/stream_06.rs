//! Streams of HALs that implement `embedded-io` 0.6.

use core::fmt::{self, Debug, Display, Formatter};
use embedded_io::{Error, ErrorKind, ErrorType, Read, ReadReady, Write, WriteReady};
use embedded_io_06 as io_06;

/// A stream of `embedded-io` 0.6 as one of 0.7: `IoLink::new(Stream06(rx), Stream06(tx))`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stream06<T>(pub T);

/// An error of a [`Stream06`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Error06<E>(pub E);

impl<E: Debug> Display for Error06<E> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        Debug::fmt(&self.0, f)
    }
}

impl<E: Debug> core::error::Error for Error06<E> {}

impl<E: io_06::Error> Error for Error06<E> {
    fn kind(&self) -> ErrorKind {
        use io_06::ErrorKind as Old;
        match self.0.kind() {
            Old::NotFound => ErrorKind::NotFound,
            Old::PermissionDenied => ErrorKind::PermissionDenied,
            Old::ConnectionRefused => ErrorKind::ConnectionRefused,
            Old::ConnectionReset => ErrorKind::ConnectionReset,
            Old::ConnectionAborted => ErrorKind::ConnectionAborted,
            Old::NotConnected => ErrorKind::NotConnected,
            Old::AddrInUse => ErrorKind::AddrInUse,
            Old::AddrNotAvailable => ErrorKind::AddrNotAvailable,
            Old::BrokenPipe => ErrorKind::BrokenPipe,
            Old::AlreadyExists => ErrorKind::AlreadyExists,
            Old::InvalidInput => ErrorKind::InvalidInput,
            Old::InvalidData => ErrorKind::InvalidData,
            Old::TimedOut => ErrorKind::TimedOut,
            Old::Interrupted => ErrorKind::Interrupted,
            Old::Unsupported => ErrorKind::Unsupported,
            Old::OutOfMemory => ErrorKind::OutOfMemory,
            Old::WriteZero => ErrorKind::WriteZero,
            _ => ErrorKind::Other,
        }
    }
}

impl<T: io_06::ErrorType> ErrorType for Stream06<T> {
    type Error = Error06<T::Error>;
}

impl<T: io_06::Read> Read for Stream06<T> {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Self::Error> {
        self.0.read(bytes).map_err(Error06)
    }
}

impl<T: io_06::ReadReady> ReadReady for Stream06<T> {
    fn read_ready(&mut self) -> Result<bool, Self::Error> {
        self.0.read_ready().map_err(Error06)
    }
}

impl<T: io_06::Write> Write for Stream06<T> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        self.0.write(bytes).map_err(Error06)
    }

    fn flush(&mut self) -> Result<(), Self::Error> {
        self.0.flush().map_err(Error06)
    }
}

impl<T: io_06::WriteReady> WriteReady for Stream06<T> {
    fn write_ready(&mut self) -> Result<bool, Self::Error> {
        self.0.write_ready().map_err(Error06)
    }
}

#[cfg(test)]
mod tests {
    use super::super::IoLink;
    use super::*;
    use crate::hardware::Link;
    use std::vec::Vec;

    /// A port of a HAL of 0.6 that has bytes to read, and room for some a time.
    struct Port {
        received: Vec<u8>,
        sent: Vec<u8>,
        room: usize,
    }

    impl io_06::ErrorType for Port {
        type Error = io_06::ErrorKind;
    }

    impl io_06::Read for Port {
        fn read(&mut self, bytes: &mut [u8]) -> Result<usize, io_06::ErrorKind> {
            if self.received.first() == Some(&0xee) {
                self.received.remove(0);
                return Err(io_06::ErrorKind::InvalidData);
            }
            bytes[0] = self.received.remove(0);
            Ok(1)
        }
    }

    impl io_06::ReadReady for Port {
        fn read_ready(&mut self) -> Result<bool, io_06::ErrorKind> {
            Ok(!self.received.is_empty())
        }
    }

    impl io_06::Write for Port {
        fn write(&mut self, bytes: &[u8]) -> Result<usize, io_06::ErrorKind> {
            let count = bytes.len().min(self.room);
            self.sent.extend(&bytes[..count]);
            self.room -= count;
            Ok(count)
        }

        fn flush(&mut self) -> Result<(), io_06::ErrorKind> {
            Ok(())
        }
    }

    impl io_06::WriteReady for Port {
        fn write_ready(&mut self) -> Result<bool, io_06::ErrorKind> {
            Ok(self.room > 0)
        }
    }

    #[test]
    fn a_link_over_streams_of_0_6_reads_writes_and_counts_errors() {
        let port =
            |received: &[u8]| Stream06(Port { received: received.to_vec(), sent: Vec::new(), room: 2 });
        let mut link = IoLink::<_, _, 16>::with_queue(port(&[1, 0xee, 2]), port(&[]));
        assert_eq!([link.receive(), link.receive(), link.receive()], [Some(1), Some(2), None]);
        assert_eq!(link.errors(), 1);
        assert!(link.send(&[1, 2, 3]));
        assert_eq!(link.sender().0.sent, [1, 2]);
        assert_eq!(Error06(io_06::ErrorKind::TimedOut).kind(), ErrorKind::TimedOut);
    }
}
