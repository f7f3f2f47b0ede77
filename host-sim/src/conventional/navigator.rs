//! The state of a conventional robot and the conditions and actions of its leaves.

use super::assignment::{Moves, least_sum};
use super::leaves::{Choice, ConventionalLeaf};
use super::position::Position;
use super::route::{RouteRequest, Router, is_in_the_way};
use super::teammate::{Rank, Teammate};
use heapless::Vec;
use iibt_core::grid::{Cell, Map, Move, Path};
use iibt_core::navigation::Stage;
use iibt_core::navigation::{MAX_GOALS, MAX_OBSTACLES, MAX_WAYPOINTS};
use iibt_core::team::MAX_TEAM;
use iibt_core::tree::Status;

/// The orders of a robot before it starts.
#[derive(Clone, Debug)]
pub(super) struct Orders<const W: usize> {
    pub(super) robot: usize,
    pub(super) map: Map<W>,
    pub(super) starts: Vec<Cell, MAX_TEAM>,
    pub(super) goals: Vec<Cell, MAX_GOALS>,
    pub(super) charger: Option<Cell>,
    pub(super) low_battery: u8,
    pub(super) charged: u8,
    /// Whether the goals are the scenario's, in their order, or the first is what the assignment
    /// gives.
    pub(super) has_fixed_goals: bool,
}

/// The state that the leaves share.
#[derive(Clone, Debug)]
pub(super) struct ConventionalNavigator<const S: usize, const W: usize> {
    orders: Orders<W>,
    /// The map with the known obstacles.
    floor: Map<W>,
    pub(super) hazards: Vec<Cell, MAX_OBSTACLES>,
    pub(super) position: Position,
    pub(super) charge: u8,
    pub(super) team: Vec<Teammate, MAX_TEAM>,
    pub(super) waypoints: Vec<Cell, MAX_WAYPOINTS>,
    choices: [Option<Cell>; 2],
    /// Whether the assignment of goals is outdated.
    is_stale: bool,
    pub(super) goal: Option<Cell>,
    pub(super) path: Path,
    pub(super) step: usize,
    /// Whether the path was constructed in this tick.
    is_new: bool,
    proposal: Option<Move>,
    /// Whether the last step of the path was a wait.
    waited: bool,
    recharging: bool,
    pub(super) stage: Stage,
    /// The cells that it has announced to enter next.
    promised: [Option<Cell>; 2],
    router: Router<S, W>,
    pub(super) last: Option<ConventionalLeaf>,
}

impl<const S: usize, const W: usize> ConventionalNavigator<S, W> {
    pub(super) fn new(orders: Orders<W>) -> Self {
        let start = orders.starts.get(orders.robot).copied().unwrap_or_default();
        let fixed = [0, 1].map(|index| orders.goals.get(index).copied());
        Self {
            floor: orders.map,
            hazards: Vec::new(),
            position: Position::at(start),
            charge: 100,
            team: Vec::new(),
            waypoints: Vec::new(),
            choices: if orders.has_fixed_goals { fixed } else { [None; 2] },
            is_stale: true,
            goal: None,
            path: Path::at(start),
            step: 0,
            is_new: false,
            proposal: None,
            waited: false,
            recharging: false,
            stage: Stage::Deciding,
            promised: [None; 2],
            router: Router::new(),
            last: None,
            orders,
        }
    }

    pub(super) const fn orders(&self) -> &Orders<W> {
        &self.orders
    }

    /// Updates the position by a reading of the localiser, and the progress on the path.
    pub(super) fn locate(&mut self, reading: Option<Cell>) {
        let was_under_way = self.position.here().is_none();
        self.position.read(reading);
        self.step += usize::from(std::mem::take(&mut self.waited));
        (self.is_new, self.proposal, self.last) = (false, None, None);
        let Some(here) = self.position.here() else { return };
        let map = &self.orders.map;
        if was_under_way && here == self.path.cell_at(map, self.step + 1) {
            self.step += 1;
        } else if here != self.path.cell_at(map, self.step) {
            (self.path, self.step, self.goal) = (Path::at(here), 0, None);
        }
        if self.waypoints.first() == Some(&here) {
            self.waypoints.remove(0);
        }
    }

    /// Remembers an obstacle, while there is room.
    pub(super) fn notice(&mut self, hazard: Cell) {
        let is_news = self.orders.map.is_free(hazard) && self.floor.is_free(hazard);
        if is_news && hazard != self.position.last() && self.hazards.push(hazard).is_ok() {
            self.floor.block(hazard);
            self.waypoints.retain(|&cell| cell != hazard);
            self.is_stale = true;
        }
    }

    /// Forgets the announced cells, which teammates no longer rely on.
    pub(super) const fn withdraw(&mut self) {
        self.promised = [None; 2];
    }

    /// Whether a condition holds.
    pub(super) fn holds(&mut self, skill: ConventionalLeaf) -> bool {
        match skill {
            ConventionalLeaf::BatteryEnough => self.charge >= self.orders.low_battery,
            ConventionalLeaf::AllArrived => {
                self.has_arrived() && self.team.iter().all(|mate| mate.stage == Stage::Arrived)
            }
            ConventionalLeaf::OneArrived => self.stands_on_a_goal(),
            ConventionalLeaf::ObstacleExists if self.orders.has_fixed_goals => self.is_blocked(&self.rest()),
            ConventionalLeaf::ObstacleExists => self.is_obstructed(),
            ConventionalLeaf::WayPointsExist => !self.waypoints.is_empty(),
            ConventionalLeaf::SmallestSum => {
                self.decide();
                self.choices[0].is_some()
            }
            ConventionalLeaf::FirstGoalNearer => self.is_first_nearer(),
            ConventionalLeaf::JointArrival => self.may_arrive(),
            _ => false,
        }
    }

    /// Performs an action for this tick.
    pub(super) fn perform(&mut self, skill: ConventionalLeaf) -> Status {
        self.last = Some(skill);
        match skill {
            ConventionalLeaf::AroundObstacle | ConventionalLeaf::ByWayPoints => {
                self.decide();
                self.choices[0].is_some_and(|goal| self.is_led_to(goal) || self.construct(goal)).into()
            }
            ConventionalLeaf::MoveTo(Choice::First) => self.go_to(self.choices[0]),
            ConventionalLeaf::MoveTo(Choice::Second) => self.go_to(self.choices[1]),
            ConventionalLeaf::MoveToCharger => self.recharge(),
            _ => Status::Failure,
        }
    }

    /// The move to make now, if the tree has not failed and it is safe; settles what is announced.
    pub(super) fn release(&mut self, status: Status) -> Option<Move> {
        let step = self.proposal.take().filter(|&step| status != Status::Failure && self.is_safe(step));
        if let Some(step) = step {
            self.waited = step == Move::Wait;
            if let (false, Some(here)) = (self.waited, self.position.here()) {
                self.position.leave_for(self.orders.map.neighbour(here, step));
            }
        }
        let goes = step.is_some() || self.position.here().is_none();
        self.stage = self.doing(goes);
        let next = |more| Some(self.path.cell_at(&self.orders.map, self.step + more));
        self.promised = [next(1), if self.stage == Stage::Announced { None } else { next(2) }];
        step
    }

    fn doing(&self, goes: bool) -> Stage {
        if self.recharging {
            Stage::Away
        } else if goes {
            Stage::Agreed
        } else if self.has_arrived() {
            Stage::Arrived
        } else if self.goal.is_some() {
            Stage::Announced
        } else {
            Stage::Deciding
        }
    }

    /// Whether a move leads to a free cell that was announced and that no teammate can be in or has
    /// the right to.
    fn is_safe(&self, step: Move) -> bool {
        let Some(here) = self.position.here() else { return false };
        let target = self.orders.map.neighbour(here, step);
        let is_clear = || self.team.iter().all(|mate| mate.lets(&self.orders.map, self.rank(), target));
        step == Move::Wait
            || (self.floor.is_free(target) && self.promised.contains(&Some(target)) && is_clear())
    }

    /// The rank that it has announced.
    const fn rank(&self) -> Rank {
        Rank::new(self.orders.robot, self.stage)
    }

    fn rest(&self) -> Path {
        self.path.rest(&self.orders.map, self.step)
    }

    fn has_arrived(&self) -> bool {
        let is_there = self.position.here().is_some_and(|here| self.goal == Some(here));
        is_there && self.step >= self.path.len() && self.waypoints.is_empty() && !self.recharging
    }

    fn stands_on_a_goal(&mut self) -> bool {
        let Some(here) = self.position.here() else { return false };
        let is_mine = self.orders.goals.contains(&here) && !self.is_claimed(here);
        if is_mine && self.waypoints.is_empty() {
            (self.path, self.step, self.goal) = (Path::at(here), 0, Some(here));
            return true;
        }
        false
    }

    /// Whether a teammate with the right of way has claimed a goal.
    fn is_claimed(&self, goal: Cell) -> bool {
        self.team.iter().any(|mate| mate.goal == Some(goal) && mate.robot < self.orders.robot)
    }

    fn is_obstructed(&self) -> bool {
        self.goal.is_some() && self.is_hindered()
    }

    /// Whether the rest of the path is blocked by an obstacle, a teammate with the right of way, or
    /// one that stands.
    fn is_hindered(&self) -> bool {
        let rest = self.rest();
        self.is_blocked(&rest) || is_in_the_way(&self.floor, &self.team, self.rank(), &rest)
    }

    fn is_blocked(&self, rest: &Path) -> bool {
        rest.cells(&self.orders.map).skip(1).any(|cell| !self.floor.is_free(cell))
    }

    /// Assigns the goals if the assignment is outdated.
    fn decide(&mut self) {
        let is_taken = self.choices[0].is_none_or(|goal| self.is_claimed(goal));
        if (self.is_stale || is_taken) && !self.orders.has_fixed_goals {
            self.assign();
        }
        self.is_stale = false;
    }

    fn assign(&mut self) {
        let (own, moves) = (self.orders.robot, self.moves());
        let goals = &self.orders.goals;
        let mut settled = [None; MAX_TEAM];
        for mate in self.team.iter().filter(|mate| mate.robot < own) {
            let goal = goals.iter().position(|&goal| mate.goal == Some(goal));
            settled[mate.robot] = goal.filter(|goal| !settled.contains(&Some(*goal)));
        }
        let assigned = least_sum(&moves, &settled, self.orders.starts.len(), goals.len());
        let first = assigned.map(|goals| goals[own]).filter(|&goal| moves[own][goal].is_some());
        let is_free = |&index: &usize| {
            Some(index) != first && self.team.iter().all(|mate| mate.goal != goals.get(index).copied())
        };
        let second =
            (0..goals.len()).filter(is_free).filter_map(|index| Some((moves[own][index]?, index))).min();
        self.choices = [first, second.map(|(_, index)| index)].map(|index| goals.get(index?).copied());
    }

    /// Returns the moves from every robot's cell to every goal, around the known obstacles.
    fn moves(&mut self) -> Moves {
        let mut moves: Moves = [[None; MAX_GOALS]; MAX_TEAM];
        let own = (self.orders.robot, self.position.last());
        let cells = self.team.iter().map(|mate| (mate.robot, mate.cells[0]));
        for (robot, cell) in cells.chain([own]) {
            let Ok(distances) = self.router.planner.distances(&self.floor, cell) else { continue };
            for (entry, &goal) in moves[robot].iter_mut().zip(&self.orders.goals) {
                *entry = distances.to(goal);
            }
        }
        moves
    }

    fn is_first_nearer(&mut self) -> bool {
        let moves = self.moves();
        let [first, second] = [0, 1].map(|goal| moves[self.orders.robot][goal].unwrap_or(u16::MAX));
        first <= second && first < u16::MAX
    }

    /// Whether the policy leads to a goal through the next way-point, around all known obstacles,
    /// and not before the team.
    fn is_led_to(&self, goal: Cell) -> bool {
        let rest = self.rest();
        let is_due = |&via: &Cell| rest.cells(&self.orders.map).any(|cell| cell == via);
        let leads = self.goal == Some(goal)
            && rest.end(&self.orders.map) == goal
            && self.waypoints.first().is_none_or(is_due);
        let is_there = rest.is_empty() && self.waypoints.is_empty();
        leads && (self.is_new || (!self.is_obstructed() && (is_there || rest.len() >= self.pace())))
    }

    fn construct(&mut self, goal: Cell) -> bool {
        let Some(from) = self.position.here() else { return true };
        let (pace, via) = (self.pace(), self.waypoints.first().copied());
        let request = RouteRequest { rank: self.rank(), from, via, goal, pace };
        let Some(path) = self.router.construct(&self.floor, &self.team, request) else { return false };
        (self.path, self.step, self.goal, self.is_new) = (path, 0, Some(goal), true);
        true
    }

    /// The number of moves that the slowest teammate still has to make.
    fn pace(&self) -> usize {
        self.team.iter().filter_map(Teammate::remaining).max().unwrap_or(0)
    }

    fn go_to(&mut self, goal: Option<Cell>) -> Status {
        let Some(goal) = goal else { return Status::Failure };
        if self.orders.has_fixed_goals && self.is_claimed(goal) {
            return Status::Failure;
        }
        if !self.is_led_to(goal) && !self.construct(goal) {
            return Status::Failure;
        }
        self.propose();
        Status::Success
    }

    fn propose(&mut self) {
        let is_here = self.position.here().is_some();
        self.proposal = self.path.actions.get(self.step).and_then(Move::from_code).filter(|_| is_here);
    }

    /// Returns whether the robot may make its next move: it is not the last one, the whole team is
    /// about to make its last one too, or a teammate waits that can only pass through this robot's
    /// cell.
    fn may_arrive(&self) -> bool {
        let is_last =
            self.proposal.is_some_and(|step| step != Move::Wait) && self.step + 1 == self.path.len();
        let ready = |mate: &Teammate| !mate.is_lost && mate.announced().is_some_and(|moves| moves <= 1);
        let Some(here) = self.position.here() else { return true };
        let wants_to_pass =
            |mate: &Teammate| mate.rest.cells(&self.orders.map).skip(1).any(|cell| cell == here);
        !is_last || self.team.iter().all(ready) || self.team.iter().any(wants_to_pass)
    }

    /// Drives to the charger and stays there until charged; without a charger, stays in its cell.
    fn recharge(&mut self) -> Status {
        self.recharging = self.charge < self.orders.charged;
        if !self.recharging {
            self.is_stale = true;
            return Status::Success;
        }
        let Some(here) = self.position.here() else { return Status::Running };
        let charger = self.orders.charger.unwrap_or(here);
        self.goal = None;
        if here == charger || self.rest().end(&self.orders.map) != charger || self.is_hindered() {
            (self.path, self.step) = (Path::at(here), 0);
        }
        if here != charger && self.rest().is_empty() {
            let request = RouteRequest { rank: self.rank(), from: here, via: None, goal: charger, pace: 0 };
            if let Some(path) = self.router.construct(&self.floor, &self.team, request) {
                self.path = path;
            }
        }
        self.propose();
        Status::Running
    }
}
