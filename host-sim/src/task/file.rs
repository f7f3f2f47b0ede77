//! A task file as it is written, before anything is checked but its keys and their types.

use crate::input::{RadioEntry, RealNumber, Text, WholeNumber};
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub title: Text,
    pub limit: Option<WholeNumber>,
    pub precision: Option<RealNumber>,
    pub confidence: Option<RealNumber>,
    pub budget: Option<WholeNumber>,
    #[serde(default)]
    pub radio: RadioEntry,
    #[serde(rename = "robot")]
    pub robots: Vec<Spanned<Robot>>,
    #[serde(rename = "goal")]
    pub goals: Vec<Spanned<GoalTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Robot {
    pub name: Text,
    #[serde(rename = "factor")]
    pub factors: Vec<Spanned<Factor>>,
    pub state: Option<Spanned<Labels>>,
    #[serde(default, rename = "sensor")]
    pub sensors: Vec<Spanned<Sensor>>,
    #[serde(rename = "action")]
    pub actions: Vec<Spanned<Action>>,
    #[serde(default, rename = "fact")]
    pub facts: Vec<Spanned<Fact>>,
    #[serde(default, rename = "remedy")]
    pub remedies: Vec<Spanned<Remedy>>,
    #[serde(rename = "aim")]
    pub aims: Vec<Spanned<Aim>>,
    pub outcome: Option<Spanned<OutcomeTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Factor {
    pub name: Text,
    pub states: Vec<Text>,
    pub prior: Option<Vec<f64>>,
    pub start: Option<Text>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Labels {
    pub names: Vec<Text>,
    pub of: Vec<Text>,
    pub table: Vec<Text>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sensor {
    pub name: Text,
    /// A factor, or `state`; left out for labels of its own.
    pub reads: Option<Text>,
    pub labels: Option<Labels>,
    pub right: Option<RealNumber>,
    pub table: Option<Vec<Vec<f64>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Action {
    pub name: Text,
    #[serde(default)]
    pub needs: Vec<Text>,
    #[serde(default)]
    pub forbids: Vec<Text>,
    pub brings: Option<Text>,
    pub otherwise: Option<Text>,
    pub expected: Option<RealNumber>,
    #[serde(default, rename = "effect")]
    pub effects: Vec<Effect>,
    pub success: Option<RealNumber>,
    pub habit: Option<RealNumber>,
    pub ticks: Option<WholeNumber>,
    pub fails: Option<RealNumber>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Effect {
    pub factor: Text,
    pub to: Text,
    #[serde(default)]
    pub given: BTreeMap<String, Text>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Fact {
    pub name: Text,
    pub robot: Option<Text>,
    pub factor: Option<Text>,
    pub is: Option<Vec<Text>>,
    pub doing: Option<Vec<Text>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Remedy {
    pub missing: Text,
    pub value: Option<bool>,
    pub prefer: Text,
    pub by: Option<RealNumber>,
    pub target: Option<Text>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Aim {
    pub name: Text,
    pub done: Vec<Text>,
    pub prefer: BTreeMap<String, RealNumber>,
    pub wish: Option<BTreeMap<String, BTreeMap<String, RealNumber>>>,
    pub target: Option<Text>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OutcomeTable {
    pub names: Vec<Text>,
    pub prefer: BTreeMap<String, RealNumber>,
    pub table: Vec<Text>,
    pub possible: Option<Text>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GoalTable {
    pub robot: Text,
    pub factor: Text,
    pub is: Vec<Text>,
}
