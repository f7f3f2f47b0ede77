//! Logs of the robots' trees: which nodes each tick has changed, a line a robot and tick.
//!
//! ```text
//! robot R1: tick 1: tree 1 at 0 ms: 2:S 1:S 4:R 0:R
//! robot R1: tick 2: tree 2 at 1 ms: 2:S 1:S
//! ```
//! A tick that changes the same nodes as the one before has no line. Images with the feature
//! `explain` log the same.

use crate::fly::{Observer, Snapshot};
use crate::kept_output::KeptOutput;
use std::io::{self, Write};

/// Writes the log of the trees in a flight, for `tree replay`.
#[derive(Debug)]
pub struct TreeLog<W> {
    out: KeptOutput<W>,
}

impl<W: Write> TreeLog<W> {
    /// Creates an empty log.
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

fn write(out: &mut impl Write, snapshot: &Snapshot<'_>) -> io::Result<()> {
    let robots = snapshot.scenario.robots.iter().zip(snapshot.tree_entries);
    for ((robot, entry), stopped) in robots.zip(snapshot.stopped) {
        if let Some(entry) = entry.filter(|_| !stopped) {
            writeln!(out, "robot {}: tick {}: {entry}", robot.name, snapshot.tick)?;
        }
    }
    Ok(())
}

impl<W: Write> Observer for TreeLog<W> {
    fn observe(&mut self, snapshot: &Snapshot<'_>) {
        self.out.write(|out| write(out, snapshot));
    }
}
