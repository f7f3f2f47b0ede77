//! The output of a record of a flight: what stops at its first error.

use std::io::{self, Write};

/// A writer whose first error ends all writing, and is returned at the end: an observer of a
/// flight cannot report it earlier.
#[derive(Debug)]
pub(crate) struct KeptOutput<W> {
    out: W,
    written: io::Result<()>,
}

impl<W: Write> KeptOutput<W> {
    /// Creates an output to which nothing was written.
    pub(crate) const fn new(out: W) -> Self {
        Self { out, written: Ok(()) }
    }

    /// Writes, unless that failed before.
    pub(crate) fn write(&mut self, write: impl FnOnce(&mut W) -> io::Result<()>) {
        if self.written.is_ok() {
            self.written = write(&mut self.out);
        }
    }

    /// Returns the writer.
    ///
    /// # Errors
    /// The first error that occurred while writing; nothing was written after it.
    pub(crate) fn finish(mut self) -> io::Result<W> {
        self.written?;
        self.out.flush()?;
        Ok(self.out)
    }
}
