//! Values with their intervals, a line for each.

use super::axis::Axis;
use super::legend::{Legend, Mark};
use super::svg::{Anchor, Svg, colour, width_of};
use crate::reproduce::figure::{Estimate, Intervals};
use crate::reproduce::report::{number, with_interval};
use maud::Markup;

const WIDTH: f64 = 320.0;
const LINE: f64 = 15.0;
const GAP: f64 = 9.0;
const BELOW: f64 = 34.0;
const BESIDE: f64 = 10.0;

/// The size of figures over that of labels.
const FIGURES: f64 = 0.82;

pub(super) fn draw(intervals: &Intervals) -> Markup {
    let left = intervals.rows.iter().map(|row| width_of(&row.label)).fold(40.0, f64::max) + 12.0;
    let widths = estimates(intervals).map(|estimate| width_of(&figures(estimate)));
    let right = BESIDE + FIGURES * widths.fold(0.0, f64::max);
    let names = intervals.rows.first().into_iter().flat_map(|row| &row.values).enumerate();
    let legend = Legend::new(
        Mark::Dot,
        WIDTH + right,
        names.map(|(index, (name, _))| (name.as_str(), colour(index + 1))),
    );
    let top = legend.height() + 8.0;
    let row_height = |values: usize| LINE * values as f64 + GAP;
    let bottom = top + intervals.rows.iter().map(|row| row_height(row.values.len())).sum::<f64>();
    let mut svg = Svg::new(left + WIDTH + right, bottom + BELOW);
    let axis = axis(intervals);
    let place = |value: f64| left + WIDTH * axis.part(value);
    for mark in axis.marks() {
        svg.line("axis", (place(mark), top), (place(mark), bottom));
        svg.text("value", (place(mark), bottom + 13.0), Anchor::Middle, number(mark));
    }
    svg.text("label", (left + WIDTH / 2.0, bottom + 29.0), Anchor::Middle, &intervals.unit);
    legend.draw((left, 0.0), &mut svg);
    let mut y = top + GAP / 2.0;
    for row in &intervals.rows {
        let middle = y + LINE * row.values.len() as f64 / 2.0;
        svg.text("label", (left - 8.0, middle + 4.0), Anchor::End, &row.label);
        for (index, (_, estimate)) in row.values.iter().enumerate() {
            let line = y + LINE * (index as f64 + 0.5);
            if let Some(estimate) = estimate {
                mark(estimate, line, &colour(index + 1), &place, &mut svg);
            }
            svg.text("value", (left + WIDTH + BESIDE, line + 4.0), Anchor::Start, figures(*estimate));
        }
        y += row_height(row.values.len());
    }
    svg.finish(&intervals.title)
}

fn estimates(intervals: &Intervals) -> impl Iterator<Item = Option<Estimate>> + '_ {
    intervals.rows.iter().flat_map(|row| &row.values).map(|(_, estimate)| *estimate)
}

fn axis(intervals: &Intervals) -> Axis {
    let highest = estimates(intervals).flatten().map(|estimate| estimate.high);
    match intervals.most {
        Some(most) => Axis::over([0.0, most]),
        None => Axis::over(highest.chain([0.0])).rounded(),
    }
}

/// An interval and the value in it.
fn mark(estimate: &Estimate, y: f64, class: &str, place: &impl Fn(f64) -> f64, svg: &mut Svg) {
    svg.line(&format!("whisker {class}"), (place(estimate.low), y), (place(estimate.high), y));
    svg.circle(&format!("dot {class}"), (place(estimate.value), y), 4.0);
}

fn figures(estimate: Option<Estimate>) -> String {
    match estimate {
        Some(Estimate { value, low, high }) => with_interval(value, [low, high]),
        None => "none".to_owned(),
    }
}
