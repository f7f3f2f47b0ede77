//! Bars in groups, the paper's beside ours.

use super::legend::{Legend, Mark};
use super::svg::{Anchor, Svg, colour, width_of};
use crate::reproduce::figure::{Bars, Scale};
use crate::reproduce::report::number;
use maud::Markup;

const BAR: f64 = 11.0;
const GAP: f64 = 8.0;
const LENGTH: f64 = 330.0;
const VALUE: f64 = 80.0;
const BELOW: f64 = 18.0;

/// The least probability that a logarithmic bar shows.
const LEAST: f64 = 1e-30;

pub(super) fn draw(bars: &Bars) -> Markup {
    let names = bars.labels.iter().map(|label| width_of(label)).fold(30.0, f64::max) + 10.0;
    let group = BAR * bars.series.len() as f64 + GAP;
    let series = bars.series.iter().enumerate();
    let legend = Legend::new(
        Mark::Box,
        LENGTH + VALUE,
        series.map(|(index, series)| (series.name.as_str(), colour(index))),
    );
    let first = legend.height() + 6.0;
    let bottom = first + group * bars.labels.len() as f64;
    let mut svg = Svg::new(names + LENGTH + VALUE, bottom + BELOW);
    let length = lengths(bars);
    legend.draw((names, 0.0), &mut svg);
    ticks(bars, names, [first - 4.0, bottom], &mut svg);
    for (place, label) in bars.labels.iter().enumerate() {
        let top = first + group * place as f64;
        svg.text("label", (names - 6.0, top + (group - GAP) / 2.0 + 4.0), Anchor::End, label);
        for (index, series) in bars.series.iter().enumerate() {
            let y = top + BAR * index as f64;
            let Some(value) = series.values.get(place).copied().flatten() else {
                svg.text("value", (names + 3.0, y + BAR - 2.0), Anchor::Start, "unknown");
                continue;
            };
            let long = length(value) * LENGTH;
            svg.rectangle(&format!("bar {}", colour(index)), (names, y), (long, BAR - 1.0), 0.0);
            svg.text("value", (names + long + 4.0, y + BAR - 2.0), Anchor::Start, number(value));
        }
    }
    svg.finish(&bars.title)
}

/// The part of the full length that a value gets.
fn lengths(bars: &Bars) -> impl Fn(f64) -> f64 {
    let values = bars.series.iter().flat_map(|series| series.values.iter().flatten());
    let most = values.clone().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let least = least(bars);
    let scale = bars.scale;
    move |value| match scale {
        Scale::Linear => (value / most).clamp(0.0, 1.0),
        Scale::Logarithmic => 1.0 - (value.max(least).log10() / least.log10()).clamp(0.0, 1.0),
    }
}

/// The power of ten where a logarithmic axis begins.
fn least(bars: &Bars) -> f64 {
    let values = bars.series.iter().flat_map(|series| series.values.iter().flatten());
    let least = values.copied().filter(|&value| value > 0.0).fold(0.1, f64::min).max(LEAST);
    10f64.powf(least.log10().floor() - 1.0)
}

fn ticks(bars: &Bars, left: f64, [top, bottom]: [f64; 2], svg: &mut Svg) {
    if bars.scale == Scale::Linear {
        return;
    }
    let powers = least(bars).log10().round() as i32;
    let step = (-powers / 6).max(1);
    for power in (powers..=0).step_by(step as usize) {
        let x = left + LENGTH * (1.0 - f64::from(power) / f64::from(powers));
        svg.line("axis", (x, top), (x, bottom));
        let label = if power == 0 { "1".to_owned() } else { format!("1e{power}") };
        svg.text("value", (x, bottom + 13.0), Anchor::Middle, label);
    }
}
