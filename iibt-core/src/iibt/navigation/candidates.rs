//! A robot's candidate policies: ways to each goal that arrive when the team can be there together.

use super::assignment::{Moves, earliest_together};
use super::{MAX_GOALS, Mission};
use crate::actions::HORIZON;
use crate::bounded::up_to;
use crate::grid::{Cell, Map, Path, Planner, TimedPlanner, Variety, WaitPlace, first_conflict};
use crate::team::MAX_TEAM;
use heapless::Vec;

/// One policy a robot can choose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Candidate {
    /// The way, waits included.
    pub path: Path,
    /// The goal it ends on.
    pub goal: Option<Cell>,
}

/// What a robot whose turn it is finds, and candidates are built for.
#[derive(Clone, Debug)]
pub(super) struct Situation<const W: usize> {
    /// Where the robot stands.
    pub(super) here: Cell,
    /// The map, with what is to be avoided blocked.
    pub(super) map: Map<W>,
    /// The paths of the teammates that have announced theirs.
    pub(super) announced: Vec<Path, MAX_TEAM>,
    /// The numbers of moves after which to arrive, most wanted first.
    pub(super) arrivals: Vec<usize, 2>,
}

/// The planners, and the room they need.
#[derive(Clone, Debug)]
pub(super) struct Generator<const S: usize, const W: usize> {
    planner: Planner<S>,
    timed: TimedPlanner<W>,
}

/// Alternatives differ in at least a third of their cells and cost at most four moves more.
const VARIETY: Variety = Variety { slack: 4, new_percent: 34 };

/// How much later than at the earliest the team may arrive, so that somebody can make way.
const LEEWAY: usize = 2;

impl<const S: usize, const W: usize> Generator<S, W> {
    pub(super) const fn new() -> Self {
        Self { planner: Planner::new(), timed: TimedPlanner::new() }
    }

    /// When the team could arrive together, for robots that stand in these cells: when the announced paths do,
    /// or else at the earliest and a little later. The more rounds were in vain, the later.
    pub(super) fn arrivals(
        &mut self,
        mission: &Mission<'_, W>,
        map: &Map<W>,
        cells: &[Cell],
        announced: &[Path],
        vain_rounds: u8,
    ) -> Vec<usize, 2> {
        let fixed = announced.iter().map(Path::len).max().filter(|&moves| moves > 0);
        let earliest = match fixed {
            Some(_) => None,
            None => earliest_together(&self.moves(mission, map, cells), cells.len()).map(usize::from),
        };
        // The first round of a new situation is not in vain yet.
        let earliest = earliest.map(|moves| moves + usize::from(vain_rounds.saturating_sub(1)));
        let later = earliest.map(|moves| moves + LEEWAY);
        up_to([fixed, earliest, later].into_iter().flatten().filter(|&moves| moves <= HORIZON))
    }

    /// Fills `candidates` for a robot that stands at `from`: those listed for it, or planned ones.
    pub(super) fn fill<const P: usize>(
        &mut self,
        mission: &Mission<'_, W>,
        situation: &Situation<W>,
        (robot, from): (usize, Cell),
        candidates: &mut Vec<Candidate, P>,
    ) {
        candidates.clear();
        for path in mission.listed(robot, from) {
            add(mission, candidates, path);
        }
        if candidates.is_empty() {
            self.plan(mission, situation, from, candidates);
        }
    }

    /// For each goal: one path per arrival that keeps clear of the announced ones, then the earliest one, then
    /// different ways padded with waits.
    fn plan<const P: usize>(
        &mut self,
        mission: &Mission<'_, W>,
        situation: &Situation<W>,
        from: Cell,
        candidates: &mut Vec<Candidate, P>,
    ) {
        let sweep = self.timed.sweep(&situation.map, from, &situation.announced);
        for &arrival in &situation.arrivals {
            for &goal in mission.goals {
                if let Some(path) = sweep.path_to(goal, arrival) {
                    add(mission, candidates, path);
                }
            }
        }
        for &goal in mission.goals {
            if let Some(path) = sweep.earliest(goal).and_then(|arrival| sweep.path_to(goal, arrival)) {
                add(mission, candidates, path);
            }
        }
        self.vary(mission, situation, from, candidates);
    }

    /// Ways to each goal that differ from the shortest, arriving with the team where they are short enough.
    fn vary<const P: usize>(
        &mut self,
        mission: &Mission<'_, W>,
        situation: &Situation<W>,
        from: Cell,
        candidates: &mut Vec<Candidate, P>,
    ) {
        for &goal in mission.goals {
            let ways =
                self.planner.alternatives::<W, 3>(&situation.map, from, goal, VARIETY).unwrap_or_default();
            for &way in &ways {
                let arrival = situation.arrivals.iter().copied().find(|&arrival| arrival >= way.len());
                let path = arrival
                    .and_then(|arrival| way.with_waits(arrival, WaitPlace::BeforeLastMove))
                    .unwrap_or(way);
                let clear = |other: &Path| first_conflict(&situation.map, &path, other).is_none();
                if situation.announced.iter().all(clear) {
                    add(mission, candidates, path);
                }
            }
        }
    }

    fn moves(&mut self, mission: &Mission<'_, W>, map: &Map<W>, cells: &[Cell]) -> Moves {
        let mut moves = [[None; MAX_GOALS]; MAX_TEAM];
        for (row, &cell) in moves.iter_mut().zip(cells) {
            let Ok(distances) = self.planner.distances(map, cell) else { continue };
            for (entry, &goal) in row.iter_mut().zip(mission.goals) {
                *entry = distances.to(goal);
            }
        }
        moves
    }
}

/// Adds a path that is not there yet, while there is room.
fn add<const W: usize, const P: usize>(
    mission: &Mission<'_, W>,
    candidates: &mut Vec<Candidate, P>,
    path: Path,
) {
    if candidates.iter().all(|candidate| candidate.path != path) {
        let end = path.end(&mission.map);
        let goal = mission.goals.contains(&end).then_some(end);
        // A full list keeps the candidates that were wanted first.
        let _ = candidates.push(Candidate { path, goal });
    }
}
