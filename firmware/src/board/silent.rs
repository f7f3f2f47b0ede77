//! An image without a log: what it would say is not compiled with `DEFMT_LOG=off`, and thrown away
//! otherwise.

use super::port::Port;
use core::marker::PhantomData;

/// The serial port that the log leaves by in other images; here it is silent.
#[derive(Debug)]
pub struct LogPort<P>(PhantomData<fn() -> P>);

impl<P: Port> LogPort<P> {
    /// A log without a port.
    #[must_use]
    pub const fn new() -> Self {
        Self(PhantomData)
    }

    /// Leaves the port silent.
    pub fn start(&'static self, _: P) {}

    /// Does nothing: the port has nothing to send.
    pub fn serve(&self) {}
}

impl<P: Port> Default for LogPort<P> {
    fn default() -> Self {
        Self::new()
    }
}

/// Nothing was logged.
#[cfg(not(feature = "rtt"))]
pub(super) const fn abandon() {}

/// Nothing was logged.
#[cfg(not(feature = "rtt"))]
pub(super) const fn flush() {}

#[cfg(not(feature = "rtt"))]
#[defmt::global_logger]
struct NoLog;

// SAFETY: nothing is kept.
#[cfg(not(feature = "rtt"))]
#[expect(unsafe_code, reason = "the trait is unsafe to implement")]
unsafe impl defmt::Logger for NoLog {
    fn acquire() {}
    unsafe fn flush() {}
    unsafe fn release() {}
    unsafe fn write(_: &[u8]) {}
}
