//! A mission as it is drawn, and its scenario file.

use crate::draws::map_entry;
use crate::scenario::Floor;
use iibt_core::grid::Cell;
use iibt_core::navigation::Effect;
use std::fmt::Write as _;

/// A mission with something unknown.
pub(super) struct Sketch {
    /// What it is about, after its name.
    pub subject: String,
    pub map: Floor,
    pub starts: Vec<Cell>,
    pub goals: Vec<Cell>,
    pub unknowns: Vec<UnknownSketch>,
}

/// Something unknown, seen from beside its cells.
pub(super) struct UnknownSketch {
    effect: Effect,
    groups: Vec<Vec<Cell>>,
    /// In hundredths.
    prior: Vec<u64>,
    /// The cell from where its value is read.
    sign: Option<Cell>,
}

impl UnknownSketch {
    /// One of these groups of goals serves, with these probabilities in hundredths.
    pub(super) fn serves(groups: Vec<Vec<Cell>>, prior: Vec<u64>, sign: Option<Cell>) -> Self {
        Self { effect: Effect::Serves, groups, prior, sign }
    }

    /// A cell is blocked with a probability in hundredths.
    pub(super) fn blocks(cell: Cell, probability: u64) -> Self {
        let prior = vec![100 - probability, probability];
        Self { effect: Effect::Blocks, groups: vec![vec![cell]], prior, sign: None }
    }

    /// The entry of a scenario file; readings are right with a probability.
    fn entry(&self, right: f64) -> String {
        let effect = match self.effect {
            Effect::Blocks => "blocks",
            Effect::Serves => "serves",
            Effect::Takes => "takes",
        };
        let group = |group: &Vec<Cell>| listed(group.iter().map(|cell| cell.0.to_string()));
        let groups = listed(self.groups.iter().map(group));
        let prior = listed(self.prior.iter().map(|p| format!("{}.{:02}", p / 100, p % 100)));
        let mut text = format!("\n[[unknown]]\n{effect} = {groups}\nprior = {prior}\nbeside = {right:?}\n");
        if let Some(sign) = self.sign {
            let _ = write!(text, "\n[[unknown.sight]]\nfrom = {}\nright = {right:?}\n", sign.0);
        }
        text
    }
}

impl Sketch {
    /// A mission in which one of several groups of goals serves.
    pub(super) fn of_one_unknown(
        subject: String,
        map: Floor,
        starts: Vec<Cell>,
        unknown: UnknownSketch,
    ) -> Self {
        Self { subject, map, starts, goals: unknown.groups.concat(), unknowns: vec![unknown] }
    }

    /// The scenario file.
    pub(super) fn text(&self, seed: u64, need: usize, right: f64, limit: u32) -> String {
        let (subject, map) = (&self.subject, map_entry(&self.map, &self.starts, &self.goals));
        let head =
            format!("title = \"Random mission {seed}: {subject}\"\nneed = {need}\nlimit = {limit}\n{map}");
        self.unknowns.iter().fold(head, |text, unknown| text + &unknown.entry(right))
    }
}

/// A map on which only these cells are free; `None` when none of this size is possible.
pub(super) fn map_of(width: u16, height: u16, free: &[Cell]) -> Option<Floor> {
    let map = Floor::new(width, height).ok()?;
    Some(map.avoiding(map.free_cells().iter().filter(|cell| !free.contains(cell))))
}

/// A list in TOML.
fn listed(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(", "))
}
