//! A robot's candidate policies: ways to each goal that arrive when the whole team can.

use super::assignment::{Moves, earliest_together};
use super::waypoints::leads_over;
use super::{MAX_GOALS, MAX_WAYPOINTS, Mission};
use crate::actions::HORIZON;
use crate::bounded::up_to;
use crate::grid::{Cell, CellSet, Map, Path, Planner, TimedPlanner, Variety, WaitPlace, first_conflict};
use crate::team::{MAX_TEAM, RobotId};
use core::num::NonZero;
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

/// The situation for which candidates are built, at the robot's turn.
#[derive(Clone, Debug)]
pub struct Situation<const W: usize> {
    /// Where the robot stands.
    pub(super) here: Cell,
    /// The map, with cells of negative preference blocked.
    pub(super) map: Map<W>,
    /// The way-points to visit before a goal.
    pub(super) via: Vec<Cell, MAX_WAYPOINTS>,
    /// The positions of the robots that have not chosen, including this one.
    pub(super) undecided: Vec<Cell, MAX_TEAM>,
    /// The paths of the teammates that have announced theirs.
    pub(super) announced: Vec<TimedPath, MAX_TEAM>,
    /// The arrival steps to aim for, the most preferred first.
    pub(super) arrivals: Vec<usize, 3>,
}

/// A timed path: a path and the pace of the robot that follows it.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimedPath {
    pub(super) path: Path,
    /// The steps that one of its moves takes.
    pub(super) pace: NonZero<usize>,
}

/// The robot for which candidates are built.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<'a> {
    /// The robot.
    pub(super) robot: RobotId,
    /// Where it stands.
    pub(super) from: Cell,
    /// The way-points, in their order.
    pub(super) via: &'a [Cell],
}

impl<const W: usize> Situation<W> {
    /// Returns where other robots stand that have not chosen, which matters at the first move.
    fn standing_around(&self, lead: &Path) -> CellSet<W> {
        let others = self.undecided.iter().copied().filter(|&cell| lead.is_empty() && cell != lead.start);
        others.collect()
    }
}

/// The planners and their arenas.
#[derive(Clone, Debug)]
pub(super) struct Generator<const S: usize, const W: usize> {
    planner: Planner<S>,
    timed: TimedPlanner<W>,
}

/// Alternatives differ in at least a third of their cells and cost at most four moves more.
const VARIETY: Variety = Variety { slack: 4, new_percent: 34 };

/// The number of steps beyond the earliest joint arrival that a candidate may take, to make way.
const LEEWAY: usize = 2;

impl<const S: usize, const W: usize> Generator<S, W> {
    pub(super) const fn new() -> Self {
        Self { planner: Planner::new(), timed: TimedPlanner::new() }
    }

    /// Returns the arrival steps for a team whose robots stand where their paths start; the first
    /// robot visits `via` on the way.
    ///
    /// It is the arrival of the announced paths if there are any, or else the earliest joint
    /// arrival at the most preferred goals, and a little later. Every failed round adds time.
    pub(super) fn arrivals(
        &mut self,
        mission: &Mission<'_, W>,
        map: &Map<W>,
        (team, via): (&[TimedPath], &[Cell]),
        announced: &[TimedPath],
        best: &[Cell],
        failed_rounds: u8,
    ) -> Vec<usize, 3> {
        let fixed = announced.iter().map(|other| other.path.len()).max().filter(|&moves| moves > 0);
        if fixed.is_some() {
            return up_to(fixed);
        }
        let moves = self.moves(mission, map, team, via);
        // The first round of a new situation has not failed yet.
        let vain = usize::from(failed_rounds.saturating_sub(1));
        let at = |moves: &Moves| Some(usize::from(earliest_together(moves, team.len())?) + vain);
        let earliest = at(&moves);
        let at_best =
            if best.len() < mission.goals.len() { at(&only(&moves, mission.goals, best)) } else { None };
        let at_best = at_best.filter(|&steps| Some(steps) != earliest);
        let later = earliest.map(|moves| moves + LEEWAY);
        up_to([earliest, at_best, later].into_iter().flatten().filter(|&moves| moves <= HORIZON))
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
        let pace = mission.paces().of(place.robot);
        if candidates.is_empty()
            && let Some(lead) = self.lead(situation, place, pace)
        {
            self.plan(mission, situation, &TimedPath { path: lead, pace }, candidates);
        }
    }

    /// Returns a shortest way.
    pub(super) fn way(&mut self, map: &Map<W>, from: Cell, to: Cell) -> Option<Path> {
        self.planner.shortest(map, from, to).ok()
    }

    /// Returns the cell nearest to `from` that is not in `taken`.
    pub(super) fn nearest(&mut self, map: &Map<W>, from: Cell, taken: &CellSet<W>) -> Option<Cell> {
        let distances = self.planner.distances(map, from).ok()?;
        let free = map.free_cells().without(taken);
        free.iter().filter_map(|cell| Some((distances.to(cell)?, cell))).min().map(|(_, cell)| cell)
    }

    /// Returns the way over the way-points, each reached as early as the teammates allow; only the
    /// current cell when there are none.
    fn lead(&mut self, situation: &Situation<W>, place: Place<'_>, pace: NonZero<usize>) -> Option<Path> {
        let map = &situation.map;
        let mut lead = Path::at(place.from);
        for &point in place.via {
            let teammates = rest_of(&situation.announced, map, lead.len());
            let standing = situation.standing_around(&lead);
            let sweep = self.timed.sweep_among(pace, map, lead.end(map), &teammates, standing);
            let leg = sweep.soonest(point)?;
            lead = lead.then(&leg)?;
        }
        Some(lead)
    }

    /// Adds, for each goal and after the prefix `lead`: a path per arrival step that is clear of
    /// the announced ones, then the earliest one, then alternatives padded with waits.
    fn plan<const P: usize>(
        &mut self,
        mission: &Mission<'_, W>,
        situation: &Situation<W>,
        lead: &TimedPath,
        candidates: &mut Vec<Candidate, P>,
    ) {
        let map = &situation.map;
        // Last comes the earliest arrival. Equal prefixes share a sweep: a robot with a move in
        // every step needs one.
        let arrivals = situation.arrivals.iter().copied().map(Some).chain([None]);
        let mut wanted = arrivals.filter_map(|arrival| Some((arrival, lead.delayed(arrival)?))).peekable();
        while let Some(&(_, lead)) = wanted.peek() {
            let done = lead.path.len();
            let announced = rest_of(&situation.announced, map, done);
            let standing = situation.standing_around(&lead.path);
            let sweep = self.timed.sweep_among(lead.pace, map, lead.path.end(map), &announced, standing);
            while let Some((arrival, _)) = wanted.next_if(|(_, other)| other.path.len() == done) {
                for &goal in mission.goals {
                    let moves = arrival.map_or_else(|| sweep.earliest(goal), |arrival| Some(arrival - done));
                    let path = moves.and_then(|moves| sweep.path_to(goal, moves));
                    if let Some(whole) = path.and_then(|path| lead.path.then(&path)) {
                        add(mission, candidates, whole);
                    }
                }
            }
        }
        self.vary(mission, situation, lead, candidates);
    }

    /// Adds ways to each goal that differ from the shortest, padded to the team's arrival where
    /// they are short enough.
    fn vary<const P: usize>(
        &mut self,
        mission: &Mission<'_, W>,
        situation: &Situation<W>,
        lead: &TimedPath,
        candidates: &mut Vec<Candidate, P>,
    ) {
        let from = lead.path.end(&situation.map);
        for &goal in mission.goals {
            let ways =
                self.planner.alternatives::<W, 3>(&situation.map, from, goal, VARIETY).unwrap_or_default();
            let slowed = ways.iter().filter_map(|way| way.slowed(lead.pace.get()));
            for way in slowed.filter_map(|way| lead.path.then(&way)) {
                let arrival = situation.arrivals.iter().copied().find(|&arrival| arrival >= way.len());
                let path = arrival
                    .and_then(|arrival| way.with_waits(arrival, WaitPlace::BeforeLastMove))
                    .unwrap_or(way);
                let own = TimedPath { path, pace: lead.pace };
                if situation.announced.iter().all(|other| are_clear(&situation.map, &own, other)) {
                    add(mission, candidates, path);
                }
            }
        }
    }

    /// Returns the steps from each robot to each goal.
    fn moves(&mut self, mission: &Mission<'_, W>, map: &Map<W>, team: &[TimedPath], via: &[Cell]) -> Moves {
        let mut moves = [[None; MAX_GOALS]; MAX_TEAM];
        let detours = core::iter::once(via).chain(core::iter::repeat(&[] as &[Cell]));
        for ((row, robot), via) in moves.iter_mut().zip(team).zip(detours) {
            let pace = robot.pace.get() as u16;
            let Some((from, before)) = self.detour(map, robot.path.start, via) else { continue };
            let Ok(distances) = self.planner.distances(map, from) else { continue };
            for (entry, &goal) in row.iter_mut().zip(mission.goals) {
                let moves = distances.to(goal).and_then(|moves| moves.checked_add(before));
                *entry = moves.and_then(|moves| moves.checked_mul(pace));
            }
        }
        moves
    }

    /// Returns the last way-point and the moves it takes to get there.
    fn detour(&mut self, map: &Map<W>, from: Cell, via: &[Cell]) -> Option<(Cell, u16)> {
        let (mut here, mut moves) = (from, 0u16);
        for &point in via {
            moves = moves.checked_add(self.planner.distances(map, here).ok()?.to(point)?)?;
            here = point;
        }
        Some((here, moves))
    }
}

/// Returns the moves to the goals in `best` only.
fn only(moves: &Moves, goals: &[Cell], best: &[Cell]) -> Moves {
    let mut left = *moves;
    for row in &mut left {
        for (entry, goal) in row.iter_mut().zip(goals) {
            *entry = entry.filter(|_| best.contains(goal));
        }
    }
    left
}

impl TimedPath {
    /// Returns the path with waits appended so that whole moves are left until `arrival`, if one is
    /// given; `None` when the path is longer.
    fn delayed(&self, arrival: Option<usize>) -> Option<Self> {
        let left = arrival.map_or(Some(0), |arrival| arrival.checked_sub(self.path.len()))?;
        let total = self.path.len() + left % self.pace;
        Some(Self { path: self.path.with_waits(total, WaitPlace::BeforeMove(u8::MAX))?, ..*self })
    }

    /// Returns the path of a robot that sets out for every cell as early as it can.
    fn hurried<const W: usize>(&self, map: &Map<W>) -> Option<Path> {
        let early = self.pace.get() - 1;
        (early > 0).then(|| self.path.rest(map, early))
    }
}

/// Returns whether two robots have no conflict, wherever each is between two cells.
pub(super) fn are_clear<const W: usize>(map: &Map<W>, one: &TimedPath, other: &TimedPath) -> bool {
    let clear = |one: &Path, other: &Path| first_conflict(map, one, other).is_none();
    clear(&one.path, &other.path)
        && one.hurried(map).is_none_or(|early| clear(&early, &other.path))
        && other.hurried(map).is_none_or(|early| clear(&one.path, &early))
}

/// Returns the rest of the teammates' paths after `done` steps, those of slow robots also in their
/// earliest form.
fn rest_of<const W: usize>(team: &[TimedPath], map: &Map<W>, done: usize) -> Vec<Path, { 2 * MAX_TEAM }> {
    let paths = team.iter().flat_map(|robot| [Some(robot.path), robot.hurried(map)]).flatten();
    up_to(paths.map(|path| path.rest(map, done)))
}

/// Adds a path that is not in the list, while there is room.
fn add<const W: usize, const P: usize>(
    mission: &Mission<'_, W>,
    candidates: &mut Vec<Candidate, P>,
    path: Path,
) {
    if candidates.iter().all(|candidate| candidate.path != path) {
        let end = path.end(&mission.map);
        let goal = mission.goals.contains(&end).then_some(end);
        // A full list keeps the candidates of the preferred arrivals, which were added first.
        let _ = candidates.push(Candidate { path, goal });
    }
}
