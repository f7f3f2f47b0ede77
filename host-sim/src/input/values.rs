//! Single values of a file, and their ranges.

use super::{Fault, Read, refuse};
use crate::scenario::Radio;
use serde::Deserialize;
use std::fmt::Display;
use std::ops::RangeInclusive;
use toml::Spanned;

/// A text and where it is written.
pub(crate) type Text = Spanned<String>;

/// A whole number and where it is written.
pub(crate) type WholeNumber = Spanned<i64>;

/// A real number and where it is written.
pub(crate) type RealNumber = Spanned<f64>;

/// The radio as it is written.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct RadioEntry {
    loss: Option<RealNumber>,
    burst: Option<WholeNumber>,
    delay: Option<WholeNumber>,
    duplicate: Option<RealNumber>,
}

impl RadioEntry {
    /// The radio, or the first value that is out of range.
    pub(crate) fn check(&self) -> Read<Radio> {
        let usual = Radio::default();
        Ok(Radio {
            loss: share("loss", self.loss.as_ref(), usual.loss)?,
            burst: whole("burst", self.burst.as_ref(), 1..=1000, usual.burst)?,
            delay: whole("delay", self.delay.as_ref(), 1..=1000, usual.delay)?,
            duplicate: share("duplicate", self.duplicate.as_ref(), usual.duplicate)?,
            ..usual
        })
    }
}

/// A whole number in `range`, or `usual` where none is written.
pub(crate) fn whole(
    key: &str,
    number: Option<&WholeNumber>,
    range: RangeInclusive<u32>,
    usual: u32,
) -> Read<u32> {
    let Some(number) = number else { return Ok(usual) };
    let value = u32::try_from(*number.get_ref()).ok().filter(|value| range.contains(value));
    value.ok_or_else(|| outside(key, number, &range))
}

/// A whole number in `range`, where one is written.
pub(crate) fn optional(
    key: &str,
    number: Option<&WholeNumber>,
    range: RangeInclusive<u32>,
) -> Read<Option<u32>> {
    number.map(|_| whole(key, number, range, 0)).transpose()
}

/// A probability, or `usual` where none is written.
pub(crate) fn share(key: &str, number: Option<&RealNumber>, usual: f64) -> Read<f64> {
    real(key, number, 0.0..=1.0, usual)
}

/// A part of a battery in percent, or `usual` where none is written.
pub(crate) fn percent(key: &str, number: Option<&RealNumber>, usual: f64) -> Read<f64> {
    real(key, number, 0.0..=100.0, usual)
}

/// A number in `range`, or `usual` where none is written.
pub(crate) fn real(
    key: &str,
    number: Option<&RealNumber>,
    range: RangeInclusive<f64>,
    usual: f64,
) -> Read<f64> {
    let Some(number) = number else { return Ok(usual) };
    let value = *number.get_ref();
    if range.contains(&value) { Ok(value) } else { Err(outside(key, number, &range)) }
}

/// A parameter of the robots' inference, where one is written.
pub(crate) fn parameter(
    key: &str,
    number: Option<&RealNumber>,
    range: RangeInclusive<f64>,
) -> Read<Option<f32>> {
    number.map(|_| real(key, number, range, 0.0).map(|value| value as f32)).transpose()
}

/// A text without line breaks and other control characters.
pub(crate) fn line_of_text(key: &str, text: &Text, longest: usize) -> Read<String> {
    let (value, length) = (text.get_ref(), text.get_ref().chars().count());
    if value.trim().is_empty() || length > longest || value.chars().any(char::is_control) {
        return refuse(text.span(), format!("{key} is not one line of 1 to {longest} characters"));
    }
    Ok(value.clone())
}

fn outside<V: Display, R: Display>(key: &str, value: &Spanned<V>, range: &RangeInclusive<R>) -> Fault {
    let (found, least, most) = (value.get_ref(), range.start(), range.end());
    Fault::new(value.span(), format!("{key} = {found} is not between {least} and {most}"))
}
