//! Values with their intervals, a line for each.

use super::svg::{Anchor, Svg, colour, width_of};
use crate::reproduce::figure::{Estimate, Intervals};
use crate::reproduce::report::number;

const WIDTH: f64 = 340.0;
const VALUES: f64 = 130.0;
const TOP: f64 = 26.0;
const LINE: f64 = 15.0;
const GAP: f64 = 9.0;
const BELOW: f64 = 34.0;

pub(super) fn draw(intervals: &Intervals) -> String {
    let labels = intervals.rows.iter().map(|row| width_of(&row.label)).fold(40.0, f64::max) + 12.0;
    let row_height = |values: usize| LINE * values as f64 + GAP;
    let rows: f64 = intervals.rows.iter().map(|row| row_height(row.values.len())).sum();
    let mut svg = Svg::new(labels + WIDTH + VALUES, TOP + rows + BELOW);
    let (low, high) = range(intervals);
    let place = |value: f64| labels + WIDTH * (value - low) / (high - low);
    for step in 0..=4 {
        let value = low + f64::from(step) / 4.0 * (high - low);
        svg.line("axis", (place(value), TOP), (place(value), TOP + rows));
        svg.text("value", (place(value), TOP + rows + 13.0), Anchor::Middle, number(value));
    }
    svg.text("label", (labels + WIDTH / 2.0, TOP + rows + 29.0), Anchor::Middle, &intervals.unit);
    legend(intervals, labels, &mut svg);
    let mut y = TOP + GAP / 2.0;
    for row in &intervals.rows {
        let middle = y + LINE * row.values.len() as f64 / 2.0;
        svg.text("label", (labels - 8.0, middle + 4.0), Anchor::End, &row.label);
        for (index, (_, estimate)) in row.values.iter().enumerate() {
            let line = y + LINE * (index as f64 + 0.5);
            mark(*estimate, line, &colour(index), labels + WIDTH + 8.0, &place, &mut svg);
        }
        y += row_height(row.values.len());
    }
    svg.finish(&intervals.title)
}

/// An interval, the value in it, and both in figures at `right`.
fn mark(
    estimate: Option<Estimate>,
    y: f64,
    class: &str,
    right: f64,
    place: &impl Fn(f64) -> f64,
    svg: &mut Svg,
) {
    let Some(Estimate { value, low, high }) = estimate else {
        svg.text("value", (right, y + 4.0), Anchor::Start, "none");
        return;
    };
    svg.line(&format!("whisker {class}"), (place(low), y), (place(high), y));
    svg.circle(&format!("dot {class}"), (place(value), y), 4.0);
    let text = format!("{} ({} to {})", number(value), number(low), number(high));
    svg.text("value", (right, y + 4.0), Anchor::Start, text);
}

fn legend(intervals: &Intervals, mut x: f64, svg: &mut Svg) {
    let Some(row) = intervals.rows.first() else { return };
    for (index, (name, _)) in row.values.iter().enumerate() {
        svg.circle(&format!("dot {}", colour(index)), (x + 5.0, 9.0), 4.0);
        svg.text("label", (x + 14.0, 13.0), Anchor::Start, name);
        x += width_of(name) + 30.0;
    }
}

fn range(intervals: &Intervals) -> (f64, f64) {
    let estimates =
        intervals.rows.iter().flat_map(|row| row.values.iter().filter_map(|(_, estimate)| *estimate));
    let high = estimates.map(|estimate| estimate.high).fold(0.0, f64::max);
    (0.0, if high > 0.0 { high } else { 1.0 })
}
