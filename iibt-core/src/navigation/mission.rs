//! The mission of a team: the map, the starts, the goals, and the parameters of the generative
//! model.

use super::Paces;
use crate::grid::{Cell, Map, Path};
use crate::inference::Scoring;
use crate::inference::learning::Rates;
use crate::team::{Fnv1a, MAX_TEAM, RobotId};

/// The most goals of one mission.
pub const MAX_GOALS: usize = 8;

/// The labels of cells in the team's outcome: each goal its own, and one for all other cells.
pub(super) const LABELS: usize = MAX_GOALS + 1;

/// The joint outcomes of two robots: none on a goal, each on a goal of its own, or anything else.
pub(super) const OUTCOMES: usize = 3;
const NOBODY: u8 = 0;
const SUCCESS: u8 = 1;
const FAILURE: u8 = 2;

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
    /// The goals; each robot is to reach another one.
    pub goals: &'m [Cell],
    /// The charging cell of each robot. A robot without one stands still when its battery is low.
    pub chargers: &'m [Option<Cell>],
    /// Candidate paths given by hand for each robot, used while the robot stands where they begin.
    /// They are planned where this is `None` or a list is empty.
    pub candidates: Option<&'m [&'m [Path]]>,
    /// Returns the probability that a robot's own localiser is right.
    pub sensor: f32,
    /// The probability that the cell a teammate announces is right.
    pub peer_sensor: f32,
    /// The probability that each robot's own localiser is right, where it differs from `sensor`.
    /// The reliability of a teammate's announced position scales in the same proportion.
    pub sensors: &'m [f32],
    /// The number of steps of a plan that one move of each robot takes, from 1 to
    /// [`MAX_PACE`](super::MAX_PACE). A robot without an entry makes a move in a step.
    pub paces: &'m [u8],
    /// The parameters of policy scoring.
    pub scoring: Scoring,
    /// The preference, on the log scale of C, for a collision: two robots in one cell or swapping
    /// cells.
    pub collision: f32,
    /// The cost, in a policy's prior, of each step of arrival beyond the team's earliest: ln E =
    /// -lateness_cost * steps.
    pub lateness_cost: f32,
    /// The rates of learning and forgetting failures of the robot's own moves. A path that is
    /// unlikely to be kept in time weighs less in a policy's prior. A learning rate of zero turns
    /// learning off.
    pub learning: Rates,
}

/// Why a mission cannot be flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MissionError {
    /// The map has more cells than the controller was built for.
    MapTooLarge,
    /// No robot, more than [`MAX_TEAM`], or not as many as the robot's team has.
    TeamSize,
    /// The robot's number is not below the size of the team.
    NoSuchRobot,
    /// No goal, or more than [`MAX_GOALS`].
    GoalCount,
    /// A start is outside the map, blocked, or taken by another robot.
    Start(Cell),
    /// A goal is outside the map, blocked, or given twice.
    Goal(Cell),
    /// A charger is outside the map, blocked, or given twice.
    Charger(Cell),
    /// A number of the model is out of its range.
    Number,
}

impl<'m, const W: usize> Mission<'m, W> {
    /// Creates a mission with the default model: localisers right in 99.52 % of all readings,
    /// announced positions in 90.4 %, as in the paper's section 5.1.
    #[must_use]
    pub const fn new(map: Map<W>, starts: &'m [Cell], goals: &'m [Cell]) -> Self {
        Self {
            map,
            starts,
            goals,
            chargers: &[],
            candidates: None,
            sensor: 0.9952,
            peer_sensor: 0.904,
            sensors: &[],
            paces: &[],
            scoring: Scoring::DEFAULT,
            collision: -4.0,
            lateness_cost: 2.0,
            learning: Rates::new(1.0, 0.02),
        }
    }

    /// Returns the size of the team, at most 255.
    #[must_use]
    pub const fn team(&self) -> u8 {
        if self.starts.len() > u8::MAX as usize { u8::MAX } else { self.starts.len() as u8 }
    }

    /// Returns the paces of the robots.
    #[must_use]
    pub const fn paces(&self) -> Paces<'m> {
        Paces::new(self.paces)
    }

    /// The probability that a robot's own localiser is right.
    #[must_use]
    pub fn sensor_of(&self, robot: RobotId) -> f32 {
        self.sensors.get(robot.index()).copied().unwrap_or(self.sensor)
    }

    /// Returns the probability that a robot's announced position is correct.
    #[must_use]
    pub fn peer_sensor_of(&self, robot: RobotId) -> f32 {
        let Some(sensor) = self.sensors.get(robot.index()).filter(|_| self.sensor > 0.0) else {
            return self.peer_sensor;
        };
        (self.peer_sensor * sensor / self.sensor).min(1.0)
    }

    /// Returns a hash of the mission. Robots with another map, other starts, goals, chargers or
    /// paces have another one, and reject each other's frames.
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
        let of = |charger: &Option<Cell>| charger.map_or(u32::MAX, |cell| u32::from(cell.0));
        let hash = self.chargers.iter().fold(hash, |hash, charger| hash.write(&of(charger).to_le_bytes()));
        hash.write(self.paces).finish()
    }

    /// Checks the mission for a controller of `S` cells.
    ///
    /// # Errors
    /// The first [`MissionError`] found.
    pub fn check<const S: usize>(&self) -> Result<(), MissionError> {
        if self.map.len() > S || S < 2 {
            return Err(MissionError::MapTooLarge);
        }
        if self.starts.is_empty() || self.starts.len() > MAX_TEAM {
            return Err(MissionError::TeamSize);
        }
        if self.goals.is_empty() || self.goals.len() > MAX_GOALS {
            return Err(MissionError::GoalCount);
        }
        if let Some(cell) = self.misplaced(self.starts.iter().copied()) {
            return Err(MissionError::Start(cell));
        }
        if let Some(cell) = self.misplaced(self.goals.iter().copied()) {
            return Err(MissionError::Goal(cell));
        }
        if let Some(cell) = self.misplaced(self.chargers.iter().copied().flatten()) {
            return Err(MissionError::Charger(cell));
        }
        let probability = |p: f32| (0.0..=1.0).contains(&p);
        let finite =
            self.lateness_cost.is_finite() && self.lateness_cost >= 0.0 && self.scoring.precision.is_finite();
        let numbers = finite && self.collision.is_finite() && self.collision <= 0.0;
        let sensors = [self.sensor, self.peer_sensor].into_iter().chain(self.sensors.iter().copied());
        if numbers && self.paces().are_sound() && sensors.into_iter().all(probability) {
            Ok(())
        } else {
            Err(MissionError::Number)
        }
    }

    /// C for the team's outcome.
    pub(super) const OUTCOME_PREFERENCE: [f32; OUTCOMES] = [0.0, 1.0, 0.0];

    /// Returns the paths given by hand for a robot that stands at `from`, at its pace; none through
    /// walls.
    pub(super) fn listed(&self, robot: RobotId, from: Cell) -> impl Iterator<Item = Path> + '_ {
        let lists = self.candidates.unwrap_or(&[]);
        let list: &'m [Path] = lists.get(robot.index()).copied().unwrap_or(&[]);
        let pace = self.paces().of(robot).get();
        let open = list.iter().filter(move |path| path.start == from && path.is_open(&self.map));
        open.filter_map(move |path| path.slowed(pace))
    }

    /// Returns the lengths of the paths given by hand for a robot.
    pub(super) fn listed_lengths(&self, robot: RobotId) -> impl Iterator<Item = usize> + 'm {
        let (lists, pace) = (self.candidates.unwrap_or(&[]), self.paces().of(robot).get());
        let list: &'m [Path] = lists.get(robot.index()).copied().unwrap_or(&[]);
        list.iter().filter_map(move |path| path.slowed(pace)).map(|path| path.len())
    }

    /// Returns the first cell that is blocked, outside the map or listed twice.
    fn misplaced(&self, cells: impl Iterator<Item = Cell> + Clone) -> Option<Cell> {
        let twice = |index: usize, cell| cells.clone().take(index).any(|other| other == cell);
        let wrong = |&(index, cell): &(usize, Cell)| !self.map.is_free(cell) || twice(index, cell);
        cells.clone().enumerate().find(wrong).map(|(_, cell)| cell)
    }
}

/// Returns the outcome of two labels, where zero is no goal: success for two different goals,
/// failure for any other pair with a goal.
pub(super) const fn outcome_of(first: usize, second: usize) -> u8 {
    match (first, second) {
        (0, 0) => NOBODY,
        (0, _) | (_, 0) => FAILURE,
        _ if first == second => FAILURE,
        _ => SUCCESS,
    }
}

impl core::fmt::Display for MissionError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::MapTooLarge => f.write_str("the map has more cells than the controller was built for"),
            Self::TeamSize => write!(f, "a team has 1 to {MAX_TEAM} robots"),
            Self::NoSuchRobot => f.write_str("the robot's number is not below the size of the team"),
            Self::GoalCount => write!(f, "a mission has 1 to {MAX_GOALS} goals"),
            Self::Start(cell) => {
                write!(f, "the start p{} is outside the map, blocked or given twice", cell.0)
            }
            Self::Goal(cell) => write!(f, "the goal p{} is outside the map, blocked or given twice", cell.0),
            Self::Charger(cell) => {
                write!(f, "the charger p{} is outside the map, blocked or given twice", cell.0)
            }
            Self::Number => f.write_str(
                "a probability, pace, precision, lateness_cost or collision preference is out of range",
            ),
        }
    }
}

impl core::error::Error for MissionError {}

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
    fn paths_given_by_hand_are_used_where_they_begin_and_only_if_they_are_open() {
        let mut map = Map::<1>::new(5, 1).unwrap();
        let through = |cells: [u16; 3]| Path::through(&map, &cells.map(Cell)).unwrap();
        let (right, left, wall) = (through([1, 2, 2]), through([1, 0, 0]), through([1, 2, 3]));
        map.block(Cell(3));
        let paths: [&[Path]; 1] = [&[right, wall, left]];
        let mission = Mission { candidates: Some(&paths), ..Mission::new(map, &[Cell(1)], &[Cell(0)]) };
        assert!(mission.listed(RobotId(0), Cell(1)).eq([right, left]));
        assert_eq!(mission.listed(RobotId(0), Cell(2)).count(), 0);
        assert_eq!(mission.listed(RobotId(1), Cell(1)).count(), 0);
    }
}
