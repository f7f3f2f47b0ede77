//! The legend: marks and names, in as many lines as they need.

use super::svg::{Anchor, Svg, width_of};

const LINE: f64 = 18.0;
const BETWEEN: f64 = 16.0;

/// The mark before a name.
#[derive(Clone, Copy)]
pub(super) enum Mark {
    Dot,
    Box,
}

/// Names with the classes of their colours, and where they stand.
pub(super) struct Legend<'a> {
    mark: Mark,
    entries: Vec<(&'a str, String, (f64, f64))>,
}

impl<'a> Legend<'a> {
    /// Names in lines of a certain width.
    pub(super) fn new(mark: Mark, width: f64, names: impl Iterator<Item = (&'a str, String)>) -> Self {
        let (mut x, mut y) = (0.0, 0.0);
        let mut entries = Vec::new();
        for (name, class) in names {
            let wide = 14.0 + width_of(name);
            if x > 0.0 && x + wide > width {
                (x, y) = (0.0, y + LINE);
            }
            entries.push((name, class, (x, y)));
            x += wide + BETWEEN;
        }
        Self { mark, entries }
    }

    /// Its height.
    pub(super) fn height(&self) -> f64 {
        self.entries.last().map_or(0.0, |(_, _, (_, y))| y + LINE)
    }

    /// Draws it, with its upper left corner here.
    pub(super) fn draw(&self, (left, top): (f64, f64), svg: &mut Svg) {
        for (name, class, (x, y)) in &self.entries {
            let (x, y) = (left + x, top + y);
            match self.mark {
                Mark::Dot => svg.circle(&format!("dot {class}"), (x + 5.0, y + 8.0), 4.5),
                Mark::Box => svg.rectangle(&format!("bar {class}"), (x, y + 3.0), (10.0, 10.0), 0.0),
            }
            svg.text("label", (x + 14.0, y + 12.0), Anchor::Start, name);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_does_not_fit_begins_the_next_line() {
        let names = ["first", "second", "a name that is wider than all of the legend", "last"];
        let legend = Legend::new(Mark::Dot, 150.0, names.into_iter().map(|name| (name, "c1".to_owned())));
        let places: Vec<_> = legend.entries.iter().map(|(_, _, place)| *place).collect();
        assert_eq!(places.iter().map(|place| place.1).collect::<Vec<_>>(), [0.0, 0.0, LINE, 2.0 * LINE]);
        assert!(places[1].0 > width_of("first") && places[2].0 == 0.0 && places[3].0 == 0.0);
        assert_eq!(legend.height(), 3.0 * LINE);
        assert_eq!(Legend::new(Mark::Box, 9.0, [].into_iter()).height(), 0.0);
    }
}
