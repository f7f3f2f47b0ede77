//! The news, line by line.

use crate::flight::{Audience, Scene};
use std::io::Write;

/// Writes one line for everything that happens.
#[derive(Debug)]
pub struct Narrator<W> {
    out: W,
}

impl<W: Write> Narrator<W> {
    /// A narrator who writes to `out`. An error of `out` ends the narration, not the flight.
    pub const fn new(out: W) -> Self {
        Self { out }
    }
}

impl<W: Write> Audience for Narrator<W> {
    fn see(&mut self, scene: &Scene<'_>) {
        for news in scene.news {
            if writeln!(self.out, "{}", news.line(scene.scenario)).is_err() {
                return;
            }
        }
    }
}
