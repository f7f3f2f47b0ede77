//! A recording of all frames that a team sends.

use crate::fly::{Observer, Snapshot};
use std::io::{self, Write};

/// Writes the frames of a flight one after the other, as the robots send them.
#[derive(Debug)]
pub struct FrameRecording<W> {
    out: W,
    written: io::Result<()>,
}

impl<W: Write> FrameRecording<W> {
    /// Creates an empty recording.
    pub const fn new(out: W) -> Self {
        Self { out, written: Ok(()) }
    }

    /// Returns the writer.
    ///
    /// # Errors
    /// The first error that occurred while writing; nothing was written after it.
    pub fn finish(mut self) -> io::Result<W> {
        self.written?;
        self.out.flush()?;
        Ok(self.out)
    }
}

impl<W: Write> Observer for FrameRecording<W> {
    fn observe(&mut self, snapshot: &Snapshot<'_>) {
        if self.written.is_ok() {
            self.written = self.out.write_all(snapshot.frames);
        }
    }
}
