//! A scenario file as it is written, before anything is checked but its keys and their types.

use crate::input::{RadioEntry, RealNumber, WholeNumber};
use serde::Deserialize;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ScenarioFile {
    pub title: Spanned<String>,
    pub map: Spanned<String>,
    pub goals: Option<Spanned<Vec<WholeNumber>>>,
    pub limit: Option<WholeNumber>,
    pub missions: Option<WholeNumber>,
    pub need: Option<WholeNumber>,
    pub wait_for_charging: Option<bool>,
    pub forget: Option<WholeNumber>,
    pub view: Option<WholeNumber>,
    pub slip: Option<RealNumber>,
    #[serde(default)]
    pub radio: RadioEntry,
    #[serde(default)]
    pub inference: InferenceEntry,
    #[serde(default, rename = "robot")]
    pub robots: Vec<Spanned<RobotEntry>>,
    #[serde(default, rename = "goal")]
    pub services: Vec<Spanned<GoalEntry>>,
    #[serde(default, rename = "unknown")]
    pub unknowns: Vec<Spanned<UnknownEntry>>,
    #[serde(default, rename = "event")]
    pub events: Vec<Spanned<EventEntry>>,
    #[serde(default, rename = "wear")]
    pub drive_faults: Vec<Spanned<DriveFaultEntry>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct InferenceEntry {
    pub precision: Option<RealNumber>,
    pub habit: Option<RealNumber>,
    pub sensor: Option<RealNumber>,
    pub policies: Option<WholeNumber>,
    pub budget: Option<WholeNumber>,
    pub learning: Option<RealNumber>,
    pub alike: Option<bool>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RobotEntry {
    pub start: Option<WholeNumber>,
    pub name: Option<Spanned<String>>,
    pub battery: Option<WholeNumber>,
    pub charger: Option<WholeNumber>,
    pub goal: Option<WholeNumber>,
    pub drain: Option<RealNumber>,
    pub charging: Option<RealNumber>,
    pub slip: Option<RealNumber>,
    pub localiser: Option<RealNumber>,
    pub sensor: Option<RealNumber>,
    pub view: Option<WholeNumber>,
    pub pace: Option<WholeNumber>,
    pub paths: Option<Spanned<Vec<Spanned<Vec<WholeNumber>>>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EventEntry {
    pub tick: Option<WholeNumber>,
    pub robot: Option<Spanned<String>>,
    pub at: Option<WholeNumber>,
    pub plan: Option<WholeNumber>,
    pub moves: Option<WholeNumber>,
    pub who: Option<Spanned<String>>,
    pub block: Option<WholeNumber>,
    pub block_path_of: Option<Spanned<String>>,
    pub clear: Option<WholeNumber>,
    pub charge: Option<WholeNumber>,
    pub visit: Option<WholeNumber>,
    pub stop: Option<Spanned<bool>>,
    pub freeze: Option<Spanned<String>>,
    #[serde(rename = "for")]
    pub ticks: Option<WholeNumber>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GoalEntry {
    pub cell: WholeNumber,
    pub serves: RealNumber,
}

/// Lists of cells, one for each value.
pub(super) type Groups = Spanned<Vec<Vec<WholeNumber>>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct UnknownEntry {
    pub blocks: Option<Groups>,
    pub serves: Option<Groups>,
    pub takes: Option<Groups>,
    pub start: Option<WholeNumber>,
    pub range: Option<WholeNumber>,
    pub prior: Spanned<Vec<RealNumber>>,
    pub beside: Option<RealNumber>,
    #[serde(default, rename = "sight")]
    pub sights: Vec<Spanned<SightEntry>>,
    pub real: Option<WholeNumber>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SightEntry {
    pub from: WholeNumber,
    pub tells: Option<WholeNumber>,
    pub right: Option<RealNumber>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DriveFaultEntry {
    pub robot: Spanned<String>,
    #[serde(rename = "move")]
    pub step: Spanned<String>,
    pub from: Option<WholeNumber>,
    pub fails: RealNumber,
}
