//! A scenario file as it is written, before anything is checked but its keys and their types.

use serde::Deserialize;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub title: Spanned<String>,
    pub map: Spanned<String>,
    pub goals: Option<Spanned<Vec<Number>>>,
    pub limit: Option<Number>,
    pub view: Option<Number>,
    pub slip: Option<Real>,
    #[serde(default)]
    pub radio: Radio,
    #[serde(default)]
    pub inference: Inference,
    #[serde(default, rename = "robot")]
    pub robots: Vec<Spanned<Robot>>,
    #[serde(default, rename = "event")]
    pub events: Vec<Spanned<Event>>,
    #[serde(default)]
    pub wear: Vec<Spanned<Wear>>,
}

/// A whole number and where it is written.
pub(super) type Number = Spanned<i64>;

/// A real number and where it is written.
pub(super) type Real = Spanned<f64>;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Radio {
    pub loss: Option<Real>,
    pub delay: Option<Number>,
    pub duplicate: Option<Real>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Inference {
    pub precision: Option<Real>,
    pub sensor: Option<Real>,
    pub peer_sensor: Option<Real>,
    pub haste: Option<Real>,
    pub collision: Option<Real>,
    pub learning: Option<Real>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Robot {
    pub start: Option<Number>,
    pub name: Option<Spanned<String>>,
    pub battery: Option<Number>,
    pub charger: Option<Number>,
    pub drain: Option<Real>,
    pub charging: Option<Real>,
    pub slip: Option<Real>,
    pub localiser: Option<Real>,
    pub paths: Option<Spanned<Vec<Spanned<Vec<Number>>>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Event {
    pub tick: Option<Number>,
    pub robot: Option<Spanned<String>>,
    pub at: Option<Number>,
    pub plan: Option<Number>,
    pub moves: Option<Number>,
    pub who: Option<Spanned<String>>,
    pub block: Option<Number>,
    pub charge: Option<Number>,
    pub visit: Option<Number>,
    pub stop: Option<Spanned<bool>>,
    #[serde(rename = "for")]
    pub ticks: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Wear {
    pub robot: Spanned<String>,
    #[serde(rename = "move")]
    pub step: Spanned<String>,
    pub from: Option<Number>,
    pub fails: Real,
}
