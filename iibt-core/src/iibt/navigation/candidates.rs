//! A robot's candidate policies: ways to each goal that arrive when the team can be there together.

use super::assignment::{Moves, earliest_together};
use super::waypoints::leads_over;
use super::{MAX_GOALS, MAX_WAYPOINTS, Mission};
use crate::actions::HORIZON;
use crate::bounded::up_to;
use crate::grid::{Cell, CellSet, Map, Path, Planner, TimedPlanner, Variety, WaitPlace, first_conflict};
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
    /// The cells to lead over on the way to a goal.
    pub(super) via: Vec<Cell, MAX_WAYPOINTS>,
    /// Where the robots stand that have not chosen, this one among them.
    pub(super) undecided: Vec<Cell, MAX_TEAM>,
    /// The paths of the teammates that have announced theirs.
    pub(super) announced: Vec<Path, MAX_TEAM>,
    /// The numbers of moves after which to arrive, most wanted first.
    pub(super) arrivals: Vec<usize, 2>,
}

/// Whose candidates are built.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<'a> {
    /// The robot, by its index.
    pub(super) robot: usize,
    /// Where it stands.
    pub(super) from: Cell,
    /// The cells to lead over, in their order.
    pub(super) via: &'a [Cell],
}

impl<const W: usize> Situation<W> {
    /// Where others stand that have not chosen, when it matters: at the first move.
    fn standing_around(&self, lead: &Path) -> CellSet<W> {
        let others = self.undecided.iter().copied().filter(|&cell| lead.is_empty() && cell != lead.start);
        others.collect()
    }
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

    /// When the team could arrive together, for robots that stand in these cells, the first of which has to lead over
    /// others: when the announced paths do,
    /// or else at the earliest and a little later. The more rounds were in vain, the later.
    pub(super) fn arrivals(
        &mut self,
        mission: &Mission<'_, W>,
        map: &Map<W>,
        (cells, via): (&[Cell], &[Cell]),
        announced: &[Path],
        vain_rounds: u8,
    ) -> Vec<usize, 2> {
        let fixed = announced.iter().map(Path::len).max().filter(|&moves| moves > 0);
        let earliest = match fixed {
            Some(_) => None,
            None => earliest_together(&self.moves(mission, map, cells, via), cells.len()).map(usize::from),
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
        place: Place<'_>,
        candidates: &mut Vec<Candidate, P>,
    ) {
        candidates.clear();
        let serves = |path: &Path| leads_over(&mission.map, path, 0, place.via.iter().copied());
        for path in mission.listed(place.robot, place.from).filter(serves) {
            add(mission, candidates, path);
        }
        if candidates.is_empty()
            && let Some(lead) = self.lead(situation, place)
        {
            self.plan(mission, situation, &lead, candidates);
        }
    }

    /// A shortest way.
    pub(super) fn way(&mut self, map: &Map<W>, from: Cell, to: Cell) -> Option<Path> {
        self.planner.shortest(map, from, to).ok()
    }

    /// The cell nearest to `from` that is not one of `taken`.
    pub(super) fn nearest(&mut self, map: &Map<W>, from: Cell, taken: &CellSet<W>) -> Option<Cell> {
        let distances = self.planner.distances(map, from).ok()?;
        let free = map.free_cells().without(taken);
        free.iter().filter_map(|cell| Some((distances.to(cell)?, cell))).min().map(|(_, cell)| cell)
    }

    /// The way over the cells that a candidate has to lead over, each reached as soon as the teammates let it; only
    /// the place where there are none.
    fn lead(&mut self, situation: &Situation<W>, place: Place<'_>) -> Option<Path> {
        let map = &situation.map;
        let mut lead = Path::at(place.from);
        for &point in place.via {
            let teammates = rest_of(&situation.announced, map, lead.len());
            let standing = situation.standing_around(&lead);
            let leg = self.timed.sweep_among(map, lead.end(map), &teammates, standing).soonest(point)?;
            lead = lead.then(&leg)?;
        }
        Some(lead)
    }

    /// For each goal, after the lead: one path per arrival that keeps clear of the announced ones, then the earliest
    /// one, then different ways padded with waits.
    fn plan<const P: usize>(
        &mut self,
        mission: &Mission<'_, W>,
        situation: &Situation<W>,
        lead: &Path,
        candidates: &mut Vec<Candidate, P>,
    ) {
        let map = &situation.map;
        let (from, announced) = (lead.end(map), rest_of(&situation.announced, map, lead.len()));
        let sweep = self.timed.sweep_among(map, from, &announced, situation.standing_around(lead));
        let mut join = |path: Option<Path>| {
            if let Some(whole) = path.and_then(|path| lead.then(&path)) {
                add(mission, candidates, whole);
            }
        };
        for arrival in situation.arrivals.iter().filter_map(|arrival| arrival.checked_sub(lead.len())) {
            for &goal in mission.goals {
                join(sweep.path_to(goal, arrival));
            }
        }
        for &goal in mission.goals {
            join(sweep.earliest(goal).and_then(|arrival| sweep.path_to(goal, arrival)));
        }
        self.vary(mission, situation, lead, candidates);
    }

    /// Ways to each goal that differ from the shortest, arriving with the team where they are short enough.
    fn vary<const P: usize>(
        &mut self,
        mission: &Mission<'_, W>,
        situation: &Situation<W>,
        lead: &Path,
        candidates: &mut Vec<Candidate, P>,
    ) {
        let from = lead.end(&situation.map);
        for &goal in mission.goals {
            let ways =
                self.planner.alternatives::<W, 3>(&situation.map, from, goal, VARIETY).unwrap_or_default();
            for way in ways.iter().filter_map(|way| lead.then(way)) {
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

    fn moves(&mut self, mission: &Mission<'_, W>, map: &Map<W>, cells: &[Cell], via: &[Cell]) -> Moves {
        let mut moves = [[None; MAX_GOALS]; MAX_TEAM];
        let detours = core::iter::once(via).chain(core::iter::repeat(&[] as &[Cell]));
        for ((row, &cell), via) in moves.iter_mut().zip(cells).zip(detours) {
            let Some((from, before)) = self.detour(map, cell, via) else { continue };
            let Ok(distances) = self.planner.distances(map, from) else { continue };
            for (entry, &goal) in row.iter_mut().zip(mission.goals) {
                *entry = distances.to(goal).and_then(|moves| moves.checked_add(before));
            }
        }
        moves
    }

    /// The last of the cells to lead over, and the moves it takes to get there.
    fn detour(&mut self, map: &Map<W>, from: Cell, via: &[Cell]) -> Option<(Cell, u16)> {
        let (mut here, mut moves) = (from, 0u16);
        for &point in via {
            moves = moves.checked_add(self.planner.distances(map, here).ok()?.to(point)?)?;
            here = point;
        }
        Some((here, moves))
    }
}

/// What is left of the teammates' paths after so many moves.
fn rest_of<const W: usize>(paths: &[Path], map: &Map<W>, done: usize) -> Vec<Path, MAX_TEAM> {
    up_to(paths.iter().map(|path| path.rest(map, done)))
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
