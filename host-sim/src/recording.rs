//! A recording of all frames that a team sends.

use crate::fly::{Observer, Snapshot};
use crate::kept_output::KeptOutput;
use std::io::{self, Write};

/// Writes the frames of a flight one after the other, as the robots send them.
#[derive(Debug)]
pub struct FrameRecording<W> {
    out: KeptOutput<W>,
}

impl<W: Write> FrameRecording<W> {
    /// Creates an empty recording.
    pub const fn new(out: W) -> Self {
        Self { out: KeptOutput::new(out) }
    }

    /// Returns the writer.
    ///
    /// # Errors
    /// The first error that occurred while writing; nothing was written after it.
    pub fn finish(self) -> io::Result<W> {
        self.out.finish()
    }
}

impl<W: Write> Observer for FrameRecording<W> {
    fn observe(&mut self, snapshot: &Snapshot<'_>) {
        self.out.write(|out| out.write_all(snapshot.frames));
    }
}
