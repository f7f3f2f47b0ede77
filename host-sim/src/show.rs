//! The display of a flight: a moving picture, lines of events, and a summary.

mod narrator;
mod picture;
mod screen;
mod series;
mod shortfall;
mod summary;

pub use narrator::Narrator;
pub use picture::{Palette, picture};
pub use screen::Screen;
pub use series::series_lines;
pub use summary::{outcome_line, summary};
