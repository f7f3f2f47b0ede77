//! Curves over a common axis.

use super::axis::Axis;
use super::legend::{Legend, Mark};
use super::svg::{Anchor, Svg, colour};
use crate::reproduce::figure::Lines;
use crate::reproduce::report::number;
use maud::Markup;

const LEFT: f64 = 56.0;
const WIDTH: f64 = 460.0;
const HEIGHT: f64 = 190.0;
const NAME: f64 = 24.0;
const BELOW: f64 = 38.0;

pub(super) fn draw(lines: &Lines) -> Markup {
    let series = || lines.series.iter().enumerate().map(|(index, series)| (series, colour(index + 1)));
    let legend = Legend::new(Mark::Box, WIDTH, series().map(|(series, class)| (series.name.as_str(), class)));
    let top = legend.height() + NAME;
    let mut svg = Svg::new(LEFT + WIDTH + 24.0, top + HEIGHT + BELOW);
    let across = Axis::over(lines.at.iter().copied());
    let values = lines.series.iter().flat_map(|series| series.values.iter().flatten().copied());
    let up = Axis::over(values.chain([0.0])).rounded();
    let place = |x: f64, y: f64| (LEFT + WIDTH * across.part(x), top + HEIGHT * (1.0 - up.part(y)));
    for y in up.marks() {
        svg.line("axis", place(across.low, y), place(across.high, y));
        svg.text("value", (LEFT - 6.0, place(across.low, y).1 + 4.0), Anchor::End, number(y));
    }
    for x in across.marks() {
        svg.text("value", (place(x, up.low).0, top + HEIGHT + 15.0), Anchor::Middle, number(x));
    }
    svg.text("label", (LEFT + WIDTH / 2.0, top + HEIGHT + 32.0), Anchor::Middle, &lines.x);
    svg.text("label", (2.0, top - 12.0), Anchor::Start, &lines.y);
    legend.draw((LEFT, 0.0), &mut svg);
    for (series, class) in series() {
        let points: Vec<_> =
            lines.at.iter().zip(&series.values).filter_map(|(&x, y)| Some(place(x, (*y)?))).collect();
        svg.polyline(&format!("curve {class}"), &points);
    }
    svg.finish(&lines.title)
}
