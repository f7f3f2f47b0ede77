//! Single values and their ranges.

use super::error::ScenarioFault;
use super::file::{RealNumber, WholeNumber};
use std::fmt::Display;
use std::ops::RangeInclusive;
use toml::Spanned;

/// A whole number in `range`, or `usual` where none is written.
pub(super) fn whole(
    key: &str,
    number: Option<&WholeNumber>,
    range: RangeInclusive<u32>,
    usual: u32,
) -> Result<u32, ScenarioFault> {
    let Some(number) = number else { return Ok(usual) };
    let value = u32::try_from(*number.get_ref()).ok().filter(|value| range.contains(value));
    value.ok_or_else(|| outside(key, number, &range))
}

/// A probability, or `usual` where none is written.
pub(super) fn share(key: &str, number: Option<&RealNumber>, usual: f64) -> Result<f64, ScenarioFault> {
    number.map_or(Ok(usual), |number| real(key, number, 0.0..=1.0))
}

/// A part of a battery in percent, or `usual` where none is written.
pub(super) fn percent(key: &str, number: Option<&RealNumber>, usual: f64) -> Result<f64, ScenarioFault> {
    number.map_or(Ok(usual), |number| real(key, number, 0.0..=100.0))
}

/// A parameter of the robots' inference, where one is written.
pub(super) fn parameter(
    key: &str,
    number: Option<&RealNumber>,
    range: RangeInclusive<f64>,
) -> Result<Option<f32>, ScenarioFault> {
    number.map(|number| real(key, number, range).map(|value| value as f32)).transpose()
}

/// A text without line breaks and other control characters.
pub(super) fn line_of_text(
    key: &str,
    text: &Spanned<String>,
    longest: usize,
) -> Result<String, ScenarioFault> {
    let (value, length) = (text.get_ref(), text.get_ref().chars().count());
    if value.trim().is_empty() || length > longest || value.chars().any(char::is_control) {
        let reason = format!("{key} is not one line of 1 to {longest} characters");
        return Err(ScenarioFault::new(text.span(), reason));
    }
    Ok(value.clone())
}

fn real(key: &str, number: &RealNumber, range: RangeInclusive<f64>) -> Result<f64, ScenarioFault> {
    let value = *number.get_ref();
    if range.contains(&value) { Ok(value) } else { Err(outside(key, number, &range)) }
}

fn outside<V: Display, R: Display>(
    key: &str,
    value: &Spanned<V>,
    range: &RangeInclusive<R>,
) -> ScenarioFault {
    let (found, least, most) = (value.get_ref(), range.start(), range.end());
    ScenarioFault::new(value.span(), format!("{key} = {found} is not between {least} and {most}"))
}
