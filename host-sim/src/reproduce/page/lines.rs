//! Curves over a common axis.

use super::svg::{Anchor, Svg, colour, width_of};
use crate::reproduce::figure::Lines;
use crate::reproduce::report::number;

const LEFT: f64 = 56.0;
const WIDTH: f64 = 460.0;
const TOP: f64 = 26.0;
const HEIGHT: f64 = 190.0;
const BELOW: f64 = 38.0;

pub(super) fn draw(lines: &Lines) -> String {
    let mut svg = Svg::new(LEFT + WIDTH + 24.0, TOP + HEIGHT + BELOW);
    let values = lines.series.iter().flat_map(|series| series.values.iter().flatten().copied());
    let (left, right) = range(lines.at.iter().copied());
    let (low, high) = range(values.chain([0.0]));
    let place = |x: f64, y: f64| {
        (LEFT + WIDTH * (x - left) / (right - left), TOP + HEIGHT * (1.0 - (y - low) / (high - low)))
    };
    for step in 0..=4 {
        let part = f64::from(step) / 4.0;
        let (x, y) = (left + part * (right - left), low + part * (high - low));
        svg.line("axis", place(left, y), place(right, y));
        svg.text("value", (LEFT - 6.0, place(left, y).1 + 4.0), Anchor::End, number(y));
        svg.text("value", (place(x, low).0, TOP + HEIGHT + 15.0), Anchor::Middle, number(x));
    }
    svg.text("label", (LEFT + WIDTH / 2.0, TOP + HEIGHT + 32.0), Anchor::Middle, &lines.x);
    svg.text("label", (2.0, 13.0), Anchor::Start, &lines.y);
    let mut x =
        LEFT + WIDTH + 20.0 - lines.series.iter().map(|series| width_of(&series.name) + 28.0).sum::<f64>();
    for (index, series) in lines.series.iter().enumerate() {
        let class = colour(index);
        let points: Vec<_> =
            lines.at.iter().zip(&series.values).filter_map(|(&x, y)| Some(place(x, (*y)?))).collect();
        svg.polyline(&format!("curve {class}"), &points);
        svg.rectangle(&format!("bar {class}"), (x, 4.0), (10.0, 10.0), 0.0);
        svg.text("label", (x + 14.0, 13.0), Anchor::Start, &series.name);
        x += width_of(&series.name) + 28.0;
    }
    svg.finish(&lines.title)
}

/// The least and the largest value, apart from each other.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    if high > low { (low, high) } else { (low.min(0.0), high.max(0.0) + 1.0) }
}
