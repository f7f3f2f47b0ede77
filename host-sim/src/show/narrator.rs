//! The narration: the events line by line.

use crate::fly::{Observer, Snapshot};
use std::io::Write;

/// Writes one line for everything that happens, and one when another leaf of a robot's tree is
/// running.
#[derive(Debug)]
pub struct Narrator<W> {
    out: W,
    running: Vec<Option<&'static str>>,
}

impl<W: Write> Narrator<W> {
    /// Creates a narrator that writes to `out`. An error of `out` ends the narration, not the
    /// flight.
    pub const fn new(out: W) -> Self {
        Self { out, running: Vec::new() }
    }
}

impl<W: Write> Observer for Narrator<W> {
    fn observe(&mut self, snapshot: &Snapshot<'_>) {
        for event in snapshot.events {
            if writeln!(self.out, "{}", event.line(snapshot.scenario)).is_err() {
                return;
            }
        }
        self.running.resize(snapshot.activities.len(), None);
        for ((robot, now), last) in
            snapshot.scenario.robots.iter().zip(snapshot.activities).zip(&mut self.running)
        {
            let changed = std::mem::replace(last, *now) != *now;
            if changed && writeln!(self.out, "{} runs {}", robot.name, now.unwrap_or("nothing")).is_err() {
                return;
            }
        }
    }
}
