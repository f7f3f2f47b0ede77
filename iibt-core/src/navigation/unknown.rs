//! Cells that may be blocked, and from where a robot sees whether they are.

use super::mission::Mission;
use super::policies::Members;
use crate::grid::{Cell, CellSet, Path};
use crate::team::RobotId;

/// The most unknown cells of one mission: as many as robots announce evidence about.
pub const MAX_UNKNOWNS: usize = super::obstacles::MAX_EVIDENCE;

/// A cell of which a team does not know whether it is blocked, and what it is worth to look.
///
/// As long as no member has evidence about the cell, one of the joint policies leads the nearest
/// robot by the look-out first. Policies by which no robot comes to the look-out cost `worth` more.
/// With that the team looks where the way by the look-out is not longer than that.
///
/// What is seen where a teammate's path leads may be that teammate, and is no evidence as long as
/// it may be there.
#[doc(alias = "landmark")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Unknown {
    /// The cell that may be blocked.
    pub cell: Cell,
    /// Where a robot stands to see it.
    pub look_out: Cell,
    /// What it is worth to have looked, in ticks.
    pub worth: u8,
}

/// Of the unknown cells of a mission those about which no member of a round has evidence, a bit for
/// each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Open(u8);

impl Open {
    pub(super) const NONE: Self = Self(0);

    pub(super) fn of<const W: usize>(mission: &Mission<'_, W>, members: &Members<'_, W>) -> Self {
        let is_known = |unknown: &Unknown| {
            members.iter().any(|(_, fact)| fact.evidence.iter().any(|known| known.cell == unknown.cell))
        };
        let bits = (0..).zip(mission.unknowns.iter().take(MAX_UNKNOWNS));
        Self(bits.filter(|(_, unknown)| !is_known(unknown)).fold(0, |all, (bit, _)| all | 1 << bit))
    }

    pub(super) fn iter<'m, const W: usize>(
        self,
        mission: &Mission<'m, W>,
    ) -> impl Iterator<Item = &'m Unknown> + use<'m, W> {
        let all = (0..).zip(mission.unknowns.iter().take(MAX_UNKNOWNS));
        all.filter(move |(bit, _)| self.0 >> bit & 1 == 1).map(|(_, unknown)| unknown)
    }

    /// What it costs, in eighths of a tick, that none of the paths leads by some look-outs.
    pub(super) fn cost<const W: usize>(self, mission: &Mission<'_, W>, paths: &[Path]) -> usize {
        let is_by = |path: &Path, at: Cell| path.cells(&mission.map).any(|cell| cell == at);
        let missed =
            self.iter(mission).filter(|unknown| !paths.iter().any(|path| is_by(path, unknown.look_out)));
        missed.map(|unknown| 8 * usize::from(unknown.worth)).sum()
    }
}

/// The robot that is nearest to a cell by open ways, the first of equals, among those at `starts`.
pub(super) fn nearest<const W: usize>(
    mission: &Mission<'_, W>,
    closed: &CellSet<W>,
    to: Cell,
    starts: impl Iterator<Item = (RobotId, Cell)> + Clone,
) -> Option<RobotId> {
    let map = mission.map.avoiding(closed.iter());
    let mut edge: CellSet<W> = [to].into_iter().filter(|&cell| map.is_free(cell)).collect();
    let mut seen = edge;
    while !edge.is_empty() {
        if let Some((robot, _)) = starts.clone().find(|&(_, cell)| edge.contains(cell)) {
            return Some(robot);
        }
        let neighbours = edge.iter().flat_map(|cell| map.free_neighbours(cell)).map(|(_, cell)| cell);
        edge = neighbours.collect::<CellSet<W>>().without(&seen);
        seen = seen.union(&edge);
    }
    None
}
