//! A flight on a terminal, redrawn in place.

use super::picture::{Palette, picture};
use crate::fly::{Observer, Snapshot};
use std::io::{self, Write};
use std::thread::sleep;
use std::time::Duration;

/// The time for which a tick is shown.
const PAUSE: Duration = Duration::from_millis(90);

/// The number of latest events shown below the picture.
const EVENTS: usize = 4;

/// Draws every tick over the last one, slowly enough to follow.
#[derive(Debug)]
pub struct Screen<W> {
    out: W,
    palette: Palette,
    columns: usize,
    drawn: usize,
    events: Vec<String>,
}

impl<W: Write> Screen<W> {
    /// Creates a screen on `out`, a terminal with this number of columns.
    pub const fn new(out: W, palette: Palette, columns: usize) -> Self {
        Self { out, palette, columns, drawn: 0, events: Vec::new() }
    }

    /// Returns the number of lines that a scenario takes on the screen.
    #[must_use]
    pub fn height(scenario: &crate::Scenario) -> usize {
        usize::from(scenario.map.height()) + scenario.robots.len() + EVENTS + 6
    }

    fn draw(&mut self, snapshot: &Snapshot<'_>) -> io::Result<()> {
        let mut lines = picture(snapshot, self.palette);
        lines.push(String::new());
        let latest = self.events.iter().skip(self.events.len().saturating_sub(EVENTS));
        lines.extend(latest.map(|event| event.chars().take(self.columns.saturating_sub(1)).collect()));
        lines.resize(Self::height(snapshot.scenario), String::new());
        if self.drawn > 0 {
            write!(self.out, "\x1b[{}A", self.drawn)?;
        }
        for line in &lines {
            writeln!(self.out, "{line}\x1b[K")?;
        }
        self.drawn = lines.len();
        self.out.flush()
    }
}

impl<W: Write> Observer for Screen<W> {
    fn observe(&mut self, snapshot: &Snapshot<'_>) {
        self.events
            .extend(snapshot.events.iter().map(|event| format!("  {}", event.line(snapshot.scenario))));
        if self.draw(snapshot).is_ok() {
            sleep(PAUSE);
        }
    }
}
