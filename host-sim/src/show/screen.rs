//! A flight on a terminal, redrawn in place.

use super::picture::{Palette, picture};
use crate::fly::{Audience, Scene};
use std::io::{self, Write};
use std::thread::sleep;
use std::time::Duration;

/// How long a tick is shown.
const PAUSE: Duration = Duration::from_millis(90);

/// The latest news shown below the picture.
const NEWS: usize = 4;

/// Draws every tick over the one before, at a pace people can follow.
#[derive(Debug)]
pub struct Screen<W> {
    out: W,
    palette: Palette,
    columns: usize,
    drawn: usize,
    news: Vec<String>,
}

impl<W: Write> Screen<W> {
    /// A screen on `out`, a terminal of so many columns.
    pub const fn new(out: W, palette: Palette, columns: usize) -> Self {
        Self { out, palette, columns, drawn: 0, news: Vec::new() }
    }

    /// The lines a scenario takes on the screen.
    #[must_use]
    pub fn height(scenario: &crate::Scenario) -> usize {
        usize::from(scenario.map.height()) + scenario.robots.len() + NEWS + 6
    }

    fn draw(&mut self, scene: &Scene<'_>) -> io::Result<()> {
        let mut lines = picture(scene, self.palette);
        lines.push(String::new());
        let latest = self.news.iter().skip(self.news.len().saturating_sub(NEWS));
        lines.extend(latest.map(|news| news.chars().take(self.columns.saturating_sub(1)).collect()));
        lines.resize(Self::height(scene.scenario), String::new());
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

impl<W: Write> Audience for Screen<W> {
    fn see(&mut self, scene: &Scene<'_>) {
        self.news.extend(scene.news.iter().map(|news| format!("  {}", news.line(scene.scenario))));
        if self.draw(scene).is_ok() {
            sleep(PAUSE);
        }
    }
}
