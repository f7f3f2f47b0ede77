//! The state of a teammate from its frames: its possible cells, its next move, and the right of
//! way.
//!
//! A conventional robot announces [`Stage::Agreed`] when it makes the next step of its path in this
//! tick, and [`Stage::Announced`] when it stands and will make it later. It enters only cells that
//! it announced a tick before.

use super::message::Said;
use iibt_core::grid::{Cell, Map, Path};
use iibt_core::navigation::Stage;

/// The right of way between two robots that want the same cell: the lesser rank goes first.
///
/// Robots on their way to a charger go before all others, then the lower number. The rank of a
/// robot is the announced one, so that both robots compare the same values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Rank {
    is_here: bool,
    robot: usize,
}

impl Rank {
    pub(super) const fn new(robot: usize, stage: Stage) -> Self {
        Self { is_here: !matches!(stage, Stage::Away), robot }
    }
}

/// The current state of one teammate, by its last message.
#[derive(Clone, Debug)]
pub(super) struct Teammate {
    /// Its index.
    pub(super) robot: usize,
    /// The cells it can be in when this tick begins, if it was heard in time.
    pub(super) cells: [Cell; 2],
    /// The cells it may enter in this tick.
    pub(super) next: [Cell; 2],
    /// Its path from here on.
    pub(super) rest: Path,
    /// The goal it has announced.
    pub(super) goal: Option<Cell>,
    /// Its announced stage.
    pub(super) stage: Stage,
    /// The age of the message in ticks, at least one; `None` when it is lost or was never heard.
    pub(super) age: Option<u32>,
    /// Whether it is lost: it then counts as standing in its last cell.
    pub(super) is_lost: bool,
    /// The ticks that it has spent in its cell.
    pub(super) still: u32,
}

/// The ticks in one cell after which a robot without the right of way counts as standing.
const STANDING: u32 = 4;

/// The ticks in one cell after which a robot with the right of way counts as standing.
const STUCK: u32 = 8;

/// The ticks for which a robot that is not heard is assumed to continue as announced.
const TRUSTED: u32 = 4;

/// The cells that a lost robot may have moved unheard, because the frames of its last moves may be
/// lost as well.
const UNHEARD_MOVES: usize = 4;

impl Teammate {
    /// Returns the state of a robot that has not been heard yet.
    pub(super) const fn unheard(robot: usize, start: Cell) -> Self {
        Self {
            robot,
            cells: [start; 2],
            next: [start; 2],
            rest: Path::at(start),
            goal: None,
            stage: Stage::Deciding,
            age: None,
            is_lost: false,
            still: 0,
        }
    }

    /// Returns the state of a robot from its message of `age` ticks ago.
    pub(super) fn heard<const W: usize>(map: &Map<W>, from: &Said, age: u32) -> Self {
        let said = &from.message;
        let (step, moves) = (usize::from(said.step), usize::from(said.stage == Stage::Agreed));
        let [at, first, second] = [0, 1, 2].map(|more| said.path.cell_at(map, step + more));
        let is_standing = said.stage == Stage::Announced;
        Self {
            robot: from.sender.index(),
            cells: if is_standing { [at; 2] } else { [at, first] },
            next: if is_standing { [first; 2] } else { [first, second] },
            rest: said.path.rest(map, step + moves),
            goal: said.goal,
            stage: said.stage,
            age: Some(age.max(1)),
            is_lost: false,
            still: 0,
        }
    }

    /// The number of moves that remain if it has continued as announced; `None` when it is not on
    /// its way to a goal, or was not heard for too long to say.
    pub(super) fn remaining(&self) -> Option<usize> {
        let age = self.age.filter(|&age| age <= TRUSTED)?;
        let since = if self.stage == Stage::Agreed { age as usize - 1 } else { 0 };
        self.announced().map(|moves| moves.saturating_sub(since))
    }

    /// The number of moves that remained by its message, without the one under way; `None` when it
    /// is not on its way to a goal.
    pub(super) fn announced(&self) -> Option<usize> {
        match self.stage {
            Stage::Agreed | Stage::Announced if self.goal.is_some() => Some(self.rest.len()),
            Stage::Arrived => Some(0),
            _ => None,
        }
    }

    /// Whether a robot of this rank may enter `target` now, as far as this teammate is concerned.
    ///
    /// The teammate was heard in the last tick: then not where it can be, nor where it goes next if
    /// it has the right of way. It was not: then nowhere that it can have come to.
    pub(super) fn lets<const W: usize>(&self, map: &Map<W>, own: Rank, target: Cell) -> bool {
        match self.age {
            _ if self.is_lost => !self.stands_in(map).any(|cell| cell == target),
            None => false,
            Some(1) => {
                let goes_there = self.rank() < own && self.next.contains(&target);
                !goes_there && !self.cells.contains(&target)
            }
            Some(age) => u32::from(map.manhattan(self.cells[0], target)) > age + 1,
        }
    }

    /// Its rank, by its message.
    pub(super) const fn rank(&self) -> Rank {
        Rank::new(self.robot, self.stage)
    }

    /// The cells in which it may stop. One that was lost may have made some moves unheard.
    pub(super) fn stands_in<'a, const W: usize>(
        &'a self,
        map: &'a Map<W>,
    ) -> impl Iterator<Item = Cell> + 'a {
        let unheard = if self.is_lost { UNHEARD_MOVES } else { 0 };
        self.cells.into_iter().chain(self.rest.cells(map).take(unheard))
    }

    /// Whether it will stay in its cell.
    pub(super) fn is_stuck(&self, own: Rank) -> bool {
        let patience = if self.rank() < own { STUCK } else { STANDING };
        let waits = self.still >= patience && self.stage != Stage::Arrived;
        self.is_lost || waits || (self.stage == Stage::Away && self.rest.is_empty())
    }

    /// Whether it stands, for any reason.
    pub(super) fn is_standing(&self, own: Rank) -> bool {
        self.is_stuck(own) || matches!(self.stage, Stage::Arrived | Stage::Deciding)
    }
}

#[cfg(test)]
mod tests {
    use super::super::message::PathMessage;
    use super::*;
    use iibt_core::team::{RobotId, Stamp};

    fn corridor() -> Map<1> {
        Map::new(8, 1).unwrap()
    }

    fn saying(cells: &[u16], stage: Stage) -> Said {
        let cells: Vec<Cell> = cells.iter().copied().map(Cell).collect();
        let message = PathMessage {
            stage,
            goal: cells.last().copied(),
            path: Path::through(&corridor(), &cells).unwrap(),
            step: 0,
            hazards: Default::default(),
        };
        Said { sender: RobotId(1), stamp: Stamp { epoch: 1, sequence: 1 }, message }
    }

    fn lets(own: usize, age: u32, stage: Stage, target: u16) -> bool {
        let mate = Teammate::heard(&corridor(), &saying(&[2, 3, 4], stage), age);
        mate.lets(&corridor(), Rank::new(own, Stage::Agreed), Cell(target))
    }

    #[test]
    fn nobody_enters_where_a_teammate_can_be() {
        for own in [0, 2] {
            assert!(!lets(own, 1, Stage::Announced, 2) && !lets(own, 1, Stage::Agreed, 2));
            assert!(!lets(own, 1, Stage::Agreed, 3), "it may be there by now");
            assert!(lets(own, 1, Stage::Announced, 4) && lets(own, 1, Stage::Agreed, 5));
        }
    }

    #[test]
    fn the_lower_number_has_the_right_of_way() {
        assert!(lets(0, 1, Stage::Announced, 3) && !lets(2, 1, Stage::Announced, 3));
        assert!(lets(0, 1, Stage::Agreed, 4) && !lets(2, 1, Stage::Agreed, 4));
    }

    #[test]
    fn who_was_not_heard_may_have_come_further() {
        assert!(!lets(0, 2, Stage::Announced, 5) && lets(0, 2, Stage::Announced, 6));
        assert!(!lets(0, 3, Stage::Announced, 6) && lets(0, 3, Stage::Announced, 7));
        let unheard = Teammate::unheard(1, Cell(0));
        assert!(!unheard.lets(&corridor(), Rank::new(0, Stage::Agreed), Cell(7)), "it can be anywhere");
        let lost = Teammate { is_lost: true, ..unheard };
        let lets = |mate: &Teammate, cell| mate.lets(&corridor(), Rank::new(0, Stage::Agreed), Cell(cell));
        assert!(lets(&lost, 1) && !lets(&lost, 0));
        let mut lost = Teammate::heard(&corridor(), &saying(&[0, 1, 2, 3, 4, 5], Stage::Announced), 20);
        lost.is_lost = true;
        assert!(!lets(&lost, 3) && lets(&lost, 4), "it may have made some moves unheard");
    }

    #[test]
    fn who_drives_to_a_charger_goes_first() {
        let away = Teammate::heard(&corridor(), &saying(&[2, 3, 4], Stage::Away), 1);
        let lets = |cell| away.lets(&corridor(), Rank::new(0, Stage::Agreed), Cell(cell));
        assert!(!lets(2) && !lets(3) && !lets(4) && lets(5));
        assert!(Rank::new(3, Stage::Away) < Rank::new(0, Stage::Agreed));
    }

    #[test]
    fn a_teammate_on_its_way_is_taken_to_go_on() {
        let remaining =
            |age, stage| Teammate::heard(&corridor(), &saying(&[2, 3, 4, 5], stage), age).remaining();
        assert_eq!([1, 2, 4, 5].map(|age| remaining(age, Stage::Agreed)), [Some(2), Some(1), Some(0), None]);
        assert_eq!(remaining(4, Stage::Announced), Some(3));
        assert_eq!(remaining(1, Stage::Arrived), Some(0));
        assert_eq!(remaining(1, Stage::Deciding), None);
    }
}
