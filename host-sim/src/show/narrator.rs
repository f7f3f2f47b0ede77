//! The news, line by line.

use crate::fly::{Audience, Scene};
use std::io::Write;

/// Writes one line for everything that happens, and one when another leaf of a robot's tree is running.
#[derive(Debug)]
pub struct Narrator<W> {
    out: W,
    running: Vec<Option<&'static str>>,
}

impl<W: Write> Narrator<W> {
    /// A narrator who writes to `out`. An error of `out` ends the narration, not the flight.
    pub const fn new(out: W) -> Self {
        Self { out, running: Vec::new() }
    }
}

impl<W: Write> Audience for Narrator<W> {
    fn see(&mut self, scene: &Scene<'_>) {
        for news in scene.news {
            if writeln!(self.out, "{}", news.line(scene.scenario)).is_err() {
                return;
            }
        }
        self.running.resize(scene.activities.len(), None);
        for ((robot, now), last) in scene.scenario.robots.iter().zip(scene.activities).zip(&mut self.running)
        {
            let changed = std::mem::replace(last, *now) != *now;
            if changed && writeln!(self.out, "{} runs {}", robot.name, now.unwrap_or("nothing")).is_err() {
                return;
            }
        }
    }
}
