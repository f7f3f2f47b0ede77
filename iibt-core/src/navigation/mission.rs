//! The mission of a team: the map, the starts, the goals, and the parameters of the generative
//! model.

use super::decider::Decider;
use super::fact::MAX_CELLS;
use super::unknown::{self, MAX_UNKNOWNS, MAX_VALUES, MAX_WORLDS, Unknown};
use crate::grid::{Cell, Map, Path};
use crate::inference::learning::Rates;
use crate::team::rounds::View;
use crate::team::{Fnv1a, MAX_TEAM, RobotId};

/// The most goals of one mission: 8 without the feature `unknowns`.
pub const MAX_GOALS: usize = if cfg!(feature = "unknowns") { 16 } else { 8 };

/// The most ticks that a move of a robot takes, as its mission declares.
pub const MAX_PACE: u8 = 8;

/// A navigation mission of a team, the same on every robot of it. Keep it in a `static`.
///
/// ```
/// use iibt_core::grid::{Cell, Map, words};
/// use iibt_core::navigation::{Mission, MissionError};
///
/// const W: usize = words(7, 7);
/// static STARTS: [Cell; 2] = [Cell(28), Cell(2)];
/// static GOALS: [Cell; 2] = [Cell(24), Cell(26)];
///
/// let mission = Mission::new(Map::<W>::new(7, 7)?, &STARTS, &GOALS);
/// assert_eq!((mission.team(), mission.check::<49>()), (2, Ok(())));
/// assert_eq!(mission.check::<48>(), Err(MissionError::MapTooLarge));
///
/// // A wall on a goal is found before anything flies.
/// let walled = Mission { map: mission.map.avoiding([Cell(26)]), ..mission };
/// assert_eq!(walled.check::<49>(), Err(MissionError::Goal(Cell(26))));
/// assert_ne!(walled.id(), mission.id()); // and its robots reject the others' frames
/// # Ok::<(), iibt_core::grid::MapError>(())
/// ```
#[doc(alias = "multi-agent path finding")]
#[doc(alias = "MAPF")]
#[doc(alias = "target assignment")]
#[derive(Clone, Copy, Debug)]
pub struct Mission<'m, const W: usize> {
    /// The map as it is known before the start.
    pub map: Map<W>,
    /// The start of each robot; its length is the size of the team.
    pub starts: &'m [Cell],
    /// The goals: any robot may reach any of them, but for those that a robot owns.
    pub goals: &'m [Cell],
    /// The goal that each robot owns: no other robot is to reach it as long as its owner decides
    /// with the team. A robot without one reaches any goal that no robot owns.
    pub own_goals: &'m [Option<Cell>],
    /// On how many of the goals without an owner a robot must end; by default on as many as there
    /// are, but no more than robots without a goal of their own.
    pub need: Option<u8>,
    /// The charging cell of each robot. A robot without one stands still when its battery is low.
    pub chargers: &'m [Option<Cell>],
    /// Whether the others stand while a robot charges, as in the paper, in place of going on
    /// without it.
    pub waits_for_charging: bool,
    /// Paths given by hand for each robot, used while all robots stand where theirs begin: the
    /// joint policies are their combinations without conflicts, in order. Not with unknowns.
    pub paths: Option<&'m [&'m [Path]]>,
    /// What the team does not know: at most [`MAX_UNKNOWNS`], with [`MAX_VALUES`] values and
    /// [`MAX_WORLDS`] combinations of them, in one of which at least the mission can be
    /// accomplished. Joint policies by which a robot looks first are made
    /// for them, and up to the robot's `K` are weighed.
    pub unknowns: &'m [Unknown<'m>],
    /// The number of joint policies to weigh, at least 1, by default 4; the robot's `K` is the
    /// most. Of a mission that lists paths, all their combinations are weighed, up to `K`.
    pub policies: u8,
    /// The precision β of the posterior over policies, in nats per tick. It says how sure a choice
    /// is, and by how many ticks another plan must be better for robots to leave the one that runs:
    /// its odds are then e times those of [`habit`](Self::habit).
    pub precision: f32,
    /// The habit of going on with the plan that runs, ln E in nats, 0 or more: how likely it is
    /// beforehand, beside any other.
    pub habit: f32,
    /// The probability that a robot's own localiser is right.
    pub sensor: f32,
    /// The probability that each robot's own localiser is right, where it differs from `sensor`.
    pub sensors: &'m [f32],
    /// The number of ticks that one move of each robot takes, from 1 to [`MAX_PACE`]. A robot
    /// without an entry makes a move in a tick.
    pub paces: &'m [u8],
    /// The rates of learning and forgetting failures of the robot's own moves. A policy with moves
    /// that fail is later for this robot. A learning rate of zero turns learning off.
    pub learning: Rates,
    /// The number of ticks after which evidence about obstacles fades by a sixteenth of a nat; it
    /// never does for zero.
    pub forgets: u16,
    /// What decides where something is unknown: inference, unless it is to be compared with a rule.
    #[cfg(feature = "ablation")]
    pub decider: Decider,
}

/// Why a mission cannot be flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MissionError {
    /// The map has more cells than the controller was built for, or than the frames can name: 2^14.
    #[error("the map has more cells than the controller was built for")]
    MapTooLarge,
    /// No robot, more than [`MAX_TEAM`], or not as many as the robot's team has.
    #[error("a team has 1 to {MAX_TEAM} robots")]
    TeamSize,
    /// The robot's number is not below the size of the team.
    #[error("the robot's number is not below the size of the team")]
    NoSuchRobot,
    /// No goal, or more than [`MAX_GOALS`].
    #[error("a mission has 1 to {MAX_GOALS} goals")]
    GoalCount,
    /// A start is outside the map, blocked, or taken by another robot.
    #[error("the start p{} is outside the map, blocked or given twice", .0.0)]
    Start(Cell),
    /// A goal is outside the map, blocked, or given twice.
    #[error("the goal p{} is outside the map, blocked or given twice", .0.0)]
    Goal(Cell),
    /// A charger is outside the map, blocked, or given twice.
    #[error("the charger p{} is outside the map, blocked or given twice", .0.0)]
    Charger(Cell),
    /// More than [`MAX_UNKNOWNS`] unknowns, values or worlds than there is room for, or readings
    /// that do not fit [small frames](super::SMALL_FRAME_POLICIES).
    #[error(
        "a mission has at most {MAX_UNKNOWNS} unknowns with {MAX_VALUES} values and {MAX_WORLDS} worlds, and \
         fewer where frames are small"
    )]
    UnknownCount,
    /// A cell of an unknown, or one from which it is seen, is outside the map, blocked, given
    /// twice, should be a goal and is none, or may be blocked and is a start.
    #[error("the cell p{} of an unknown is outside the map, blocked, given twice, no goal or a start", .0.0)]
    Unknown(Cell),
    /// An unknown has fewer than two values, or several without cells, which all mean the same.
    #[error("unknown {0} has fewer than two values, or two without cells")]
    Values(u8),
    /// What is seen of an unknown from a cell is given twice, or is about no value of it, or its
    /// readings are right no more often than a guess.
    #[error("the sight from p{} is given twice, of no value, or right no more often than a guess", .0.0)]
    Sight(Cell),
    /// An unknown is seen from nowhere, so that no robot ever comes to know its value.
    #[error("unknown {0} is seen from nowhere")]
    Unseen(u8),
    /// Fewer goals than needed serve, whatever the values of the unknowns are.
    #[error("fewer goals than needed serve, whatever the values of the unknowns are")]
    Impossible,
    /// A mission with unknowns has paths given by hand, by which no robot looks.
    #[error("a mission with unknowns has no paths given by hand")]
    PathsGiven,
    /// The probabilities of the values of an unknown are no distribution.
    #[error("the prior of unknown {0} is no distribution")]
    Prior(u8),
    /// A number of the model is out of its range.
    #[error("a probability, pace, precision, habit or number of policies is out of range")]
    Number,
    /// The robot has [no planner](super::Navigation), and the mission has no paths, or it has
    /// chargers, to which no path leads.
    #[error("a robot without a planner needs a mission with paths and without chargers")]
    NoPlanner,
    /// The robot has been started already.
    #[error("the robot has been started already")]
    Started,
}

impl<'m, const W: usize> Mission<'m, W> {
    /// What a robot has that was given no mission yet: one cell, no robots, no goals.
    pub(super) const NONE: &'m Self = &Self::new(
        match Map::new(1, 1) {
            Ok(map) => map,
            Err(_) => panic!("a map has a word"),
        },
        &[],
        &[],
    );

    /// Creates a mission with the default model: localisers right in 99.52 % of all readings, as in
    /// the paper's section 5.1; four policies, weighed with one nat per tick; obstacles stay.
    #[must_use]
    pub const fn new(map: Map<W>, starts: &'m [Cell], goals: &'m [Cell]) -> Self {
        Self {
            map,
            starts,
            goals,
            own_goals: &[],
            need: None,
            chargers: &[],
            waits_for_charging: false,
            paths: None,
            unknowns: &[],
            policies: 4,
            precision: 1.0,
            habit: 0.0,
            sensor: 0.9952,
            sensors: &[],
            paces: &[],
            learning: Rates::new(1.0, 0.02),
            forgets: 0,
            #[cfg(feature = "ablation")]
            decider: Decider::Inference,
        }
    }

    /// What decides where something is unknown.
    pub(super) const fn decider(&self) -> Decider {
        #[cfg(feature = "ablation")]
        return self.decider;
        #[cfg(not(feature = "ablation"))]
        Decider::Inference
    }

    /// Returns the size of the team, at most 255.
    #[must_use]
    pub const fn team(&self) -> u8 {
        if self.starts.len() > u8::MAX as usize { u8::MAX } else { self.starts.len() as u8 }
    }

    /// Returns the number of ticks that one move of a robot takes, at least one.
    #[must_use]
    pub fn pace_of(&self, robot: RobotId) -> u8 {
        self.paces.get(robot.index()).copied().unwrap_or(1).max(1)
    }

    /// Returns the goal that a robot owns, if it does.
    #[must_use]
    pub fn own_goal(&self, robot: RobotId) -> Option<Cell> {
        self.own_goals.get(robot.index()).copied().flatten()
    }

    /// Returns the charging cell of a robot, if it has one.
    #[must_use]
    pub fn charger(&self, robot: RobotId) -> Option<Cell> {
        self.chargers.get(robot.index()).copied().flatten()
    }

    /// Returns the goals that no member of a view owns, in their order; then those of robots that
    /// are left out, as far as they are not among them.
    pub fn open_goals(&self, view: View) -> impl Iterator<Item = Cell> + Clone + 'm {
        let (goals, owned) = (self.goals, self.own_goals);
        let is_owned = move |&goal: &Cell| {
            (0..).map(RobotId).zip(owned).any(|(robot, own)| *own == Some(goal) && view.contains(robot))
        };
        let others = owned.iter().flatten().filter(|own| !goals.contains(own));
        goals.iter().chain(others).copied().filter(move |goal| !is_owned(goal))
    }

    /// Returns whether a member of a view may end there: on its own goal, or on any that no member
    /// owns.
    #[must_use]
    pub fn is_goal_of(&self, view: View, robot: RobotId, cell: Cell) -> bool {
        match self.own_goal(robot) {
            Some(own) => own == cell,
            None => self.open_goals(view).any(|goal| goal == cell),
        }
    }

    /// Whether paths given by hand are all that its robots may need.
    pub(super) fn needs_no_planner(&self) -> bool {
        self.paths.is_some() && self.chargers.iter().all(Option::is_none)
    }

    /// The probability that a robot's own localiser is right.
    #[must_use]
    pub fn sensor_of(&self, robot: RobotId) -> f32 {
        self.sensors.get(robot.index()).copied().unwrap_or(self.sensor)
    }

    /// Returns a hash of all that robots must agree on to make the same plans: the map, starts,
    /// goals, chargers, paths and rules. Robots with another one reject each other's frames.
    #[must_use]
    pub fn id(&self) -> u64 {
        let cells = |hash: Fnv1a, cells: &[Cell]| {
            let hash = hash.write(&(cells.len() as u16).to_le_bytes());
            cells.iter().fold(hash, |hash, cell| hash.write(&cell.0.to_le_bytes()))
        };
        let map = &self.map;
        let size = Fnv1a::EMPTY.write(&map.width().to_le_bytes()).write(&map.height().to_le_bytes());
        let free = |cell: usize| map.is_free(Cell(cell as u16));
        let hash = (0..map.len()).fold(size, |hash, cell| hash.write(&[u8::from(free(cell))]));
        let hash = cells(cells(hash, self.starts), self.goals);
        let of = |cell: &Option<Cell>| cell.map_or(u32::MAX, |cell| u32::from(cell.0));
        let optional = |hash: Fnv1a, cells: &[Option<Cell>]| {
            let hash = hash.write(&(cells.len() as u16).to_le_bytes());
            cells.iter().fold(hash, |hash, cell| hash.write(&of(cell).to_le_bytes()))
        };
        let hash = optional(optional(hash, self.chargers), self.own_goals);
        let hash = hash.write(&[self.need.unwrap_or(u8::MAX), self.waits_for_charging.into(), self.policies]);
        let paths = self.paths.unwrap_or(&[]).iter().flat_map(|list| list.iter());
        let hash = paths.fold(hash, |hash, path| {
            path.moves()
                .fold(hash.write(&path.start.0.to_le_bytes()), |hash, step| hash.write(&[step.code()]))
        });
        let hash = self.unknowns.iter().fold(hash, |hash, unknown| unknown.hash(hash));
        hash.write(self.paces).finish()
    }

    /// Checks the mission for a controller of `S` cells.
    ///
    /// # Errors
    /// The first [`MissionError`] found.
    pub fn check<const S: usize>(&self) -> Result<(), MissionError> {
        if self.map.len() > S.min(MAX_CELLS) || S < 2 {
            return Err(MissionError::MapTooLarge);
        }
        if self.starts.is_empty() || self.starts.len() > MAX_TEAM {
            return Err(MissionError::TeamSize);
        }
        let has_goal = !self.goals.is_empty() || self.own_goals.iter().any(Option::is_some);
        if !has_goal || self.goals.len() > MAX_GOALS {
            return Err(MissionError::GoalCount);
        }
        if let Some(cell) = self.misplaced(self.starts.iter().copied()) {
            return Err(MissionError::Start(cell));
        }
        if let Some(cell) = self.misplaced(self.goals.iter().copied()) {
            return Err(MissionError::Goal(cell));
        }
        if let Some(cell) = self.misplaced(self.own_goals.iter().copied().flatten()) {
            return Err(MissionError::Goal(cell));
        }
        if let Some(cell) = self.misplaced(self.chargers.iter().copied().flatten()) {
            return Err(MissionError::Charger(cell));
        }
        unknown::check(self)?;
        let probability = |p: f32| (0.0..=1.0).contains(&p);
        let sensors = [self.sensor].into_iter().chain(self.sensors.iter().copied());
        let are_paces = self.paces.iter().all(|pace| (1..=MAX_PACE).contains(pace));
        let are_weights = [self.precision, self.habit].iter().all(|nats| nats.is_finite() && *nats >= 0.0);
        if are_weights && are_paces && self.policies > 0 && sensors.into_iter().all(probability) {
            Ok(())
        } else {
            Err(MissionError::Number)
        }
    }

    /// Returns the first cell that is blocked, outside the map or listed twice.
    fn misplaced(&self, cells: impl Iterator<Item = Cell> + Clone) -> Option<Cell> {
        let twice = |index: usize, cell| cells.clone().take(index).any(|other| other == cell);
        let wrong = |&(index, cell): &(usize, Cell)| !self.map.is_free(cell) || twice(index, cell);
        cells.clone().enumerate().find(wrong).map(|(_, cell)| cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Map;

    #[test]
    fn chargers_are_free_cells_of_the_map_and_nobody_shares_one() {
        let mut map = Map::<1>::new(5, 1).unwrap();
        map.block(Cell(3));
        let (starts, goals) = ([Cell(0), Cell(1)], [Cell(2), Cell(4)]);
        let check = |chargers: &[Option<Cell>]| {
            Mission { chargers, ..Mission::new(map, &starts, &goals) }.check::<5>()
        };
        assert_eq!(check(&[None, Some(Cell(0))]), Ok(()), "a start or a goal may be a charger");
        assert_eq!(check(&[Some(Cell(2))]), Ok(()), "the last robot has none");
        for wrong in [3, 5] {
            assert_eq!(check(&[None, Some(Cell(wrong))]), Err(MissionError::Charger(Cell(wrong))));
        }
        assert_eq!(check(&[Some(Cell(2)), Some(Cell(2))]), Err(MissionError::Charger(Cell(2))));
    }

    #[test]
    fn a_goal_is_open_while_its_owner_is_left_out() {
        let own = [Some(Cell(4)), None, Some(Cell(3))];
        let starts = [0, 1, 2].map(Cell);
        let mission = Mission { own_goals: &own, ..Mission::new(Map::<1>::new(6, 1).unwrap(), &starts, &[]) };
        let mission = Mission { goals: &[Cell(5), Cell(4)], ..mission };
        let all = View::full(3);
        let open = |view| mission.open_goals(view).map(|cell| cell.0).collect::<std::vec::Vec<_>>();
        assert_eq!(open(all), [5]);
        assert_eq!(open(all.without(RobotId(0))), [5, 4]);
        assert_eq!(open(all.without(RobotId(2))), [5, 3]);
        assert!(
            mission.is_goal_of(all, RobotId(2), Cell(3)) && !mission.is_goal_of(all, RobotId(1), Cell(3))
        );
        assert!(mission.is_goal_of(all.without(RobotId(2)), RobotId(1), Cell(3)));
    }
}
