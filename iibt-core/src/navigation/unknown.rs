//! Unknowns: what a team does not know about its mission, and from where robots see it.

use super::mission::{Mission, MissionError};
use crate::grid::{Cell, CellSet};
use crate::inference::{Argument, OutOfRange, Worlds};
use crate::math;
use crate::team::Fnv1a;
use crate::team::rounds::View;

/// The most unknowns of one mission: none without the feature `unknowns`.
pub const MAX_UNKNOWNS: usize = if cfg!(feature = "unknowns") { 8 } else { 0 };

/// The most values of all unknowns of a mission together.
pub const MAX_VALUES: usize = 2 * MAX_UNKNOWNS;

/// The most combinations of the values of all unknowns of a mission: one without the feature
/// `unknowns`.
pub const MAX_WORLDS: usize = if cfg!(feature = "unknowns") { 16 } else { 1 };

/// The evidence, in nats, with which a robot takes what it has read for sure.
const SURE: f32 = 3.9;

/// The most ticks for which a robot is expected to read the same again and again.
const LONGEST_STAY: u8 = 12;

/// A hidden factor of the mission: it has one of several values, the same for the whole mission.
///
/// Each of its cells belongs to a value. What the value means for its cells is the [`Effect`]: the
/// cells are blocked in the worlds in which the unknown has that value, they are the goals that
/// serve, or those that a robot takes which is no member of the team.
///
/// ```
/// use iibt_core::grid::{Cell, Map};
/// use iibt_core::navigation::{Effect, Mission, Place, Sight, Tells, Unknown};
///
/// // Either end of a corridor may be the goal that serves. A sign in the middle tells which, and
/// // from beside a goal a robot sees whether that is the one.
/// let map = Map::<1>::drawn(".....\n##.##")?;
/// let cells = [Place::new(Cell(0), 0), Place::new(Cell(4), 1)];
/// let sights = [
///     Sight { from: Cell(7), tells: Tells::Value, right: 0.9 },
///     Sight { from: Cell(1), tells: Tells::Whether(0), right: 1.0 },
///     Sight { from: Cell(3), tells: Tells::Whether(1), right: 1.0 },
/// ];
/// let goal = Unknown { effect: Effect::Serves, cells: &cells, prior: &[0.7, 0.3], sights: &sights };
/// let (starts, goals) = ([Cell(2)], [Cell(0), Cell(4)]);
/// let mission = Mission { unknowns: &[goal], need: Some(1), ..Mission::new(map, &starts, &goals) };
/// assert_eq!(mission.check::<10>(), Ok(()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "hidden state")]
#[doc(alias = "hypothesis")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Unknown<'m> {
    /// What its value means for its cells.
    pub effect: Effect,
    /// Its cells, and the value to which each belongs.
    pub cells: &'m [Place],
    /// The probability of each value before anything is seen.
    pub prior: &'m [f32],
    /// From where it is seen, and how well.
    pub sights: &'m [Sight],
}

/// What the value of an unknown means for the cells that belong to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Effect {
    /// They are blocked; its other cells are free.
    Blocks,
    /// They are goals that serve; its other cells are goals that do not.
    Serves,
    /// They are goals that are not to be had: a robot that is no member of the team, and says
    /// nothing, goes to the nearest of them and stays; its other cells are goals as all others.
    ///
    /// Such an unknown is inferred from how that robot moves, wherever members
    /// [see it](super::Sighting); it needs no sights. All members that see it see the same, so the
    /// evidence of one of them counts, that which says most.
    Takes,
}

/// A cell of an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Place {
    /// The cell.
    pub cell: Cell,
    /// The value to which it belongs.
    pub value: u8,
}

impl Place {
    /// A cell that belongs to a value.
    #[must_use]
    pub const fn new(cell: Cell, value: u8) -> Self {
        Self { cell, value }
    }
}

/// A cell from which a robot sees something of an unknown, whenever it stands there.
///
/// Readings are independent of each other: a robot that stays reads again in every tick.
#[doc(alias = "landmark")]
#[doc(alias = "observation model")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sight {
    /// The cell.
    pub from: Cell,
    /// What is read there.
    pub tells: Tells,
    /// The probability that a reading is right, more than that of a guess; a wrong one names any
    /// other value alike.
    pub right: f32,
}

/// What a reading tells of an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Tells {
    /// Its value.
    Value,
    /// Whether it has this value.
    Whether(u8),
}

/// What a robot has read of an unknown in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reading {
    /// The unknown, by its place in the mission.
    pub unknown: u8,
    /// What was read.
    pub says: Says,
}

/// The outcome of a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Says {
    /// The unknown has this value.
    Value(u8),
    /// The unknown has this value.
    Is(u8),
    /// The unknown does not have this value.
    IsNot(u8),
}

impl Says {
    /// What the reading tells of its unknown.
    #[must_use]
    pub const fn tells(self) -> Tells {
        match self {
            Self::Value(_) => Tells::Value,
            Self::Is(value) | Self::IsNot(value) => Tells::Whether(value),
        }
    }
}

impl Sight {
    /// What may be read here of an unknown of so many values.
    pub(super) fn outcomes(self, values: u8) -> impl Iterator<Item = Says> + Clone {
        let (all, whether) = match self.tells {
            Tells::Value => (values, None),
            Tells::Whether(value) => (0, Some(value)),
        };
        (0..all)
            .map(Says::Value)
            .chain(whether.into_iter().flat_map(|value| [Says::Is(value), Says::IsNot(value)]))
    }

    /// The probability of each reading that is wrong, of an unknown of so many values.
    pub(super) fn wrong(self, values: u8) -> f32 {
        let others = if self.tells == Tells::Value { values.saturating_sub(1).max(1) } else { 1 };
        (1.0 - self.right) / f32::from(others)
    }

    /// The ticks that a robot stays here for as many readings as make it sure, beside the first
    /// one; `None` where it has something better to do than wait for that.
    pub(super) fn stay(self, values: u8) -> Option<u16> {
        if self.right >= 1.0 {
            return Some(0);
        }
        let wrong = self.wrong(values);
        // What a reading is expected to speak for the true value, against another one.
        let nats = (self.right - wrong) * (math::ln(self.right) - math::ln(wrong));
        let more = SURE / nats;
        // A cast cuts off: the first reading is counted by that.
        (more < f32::from(LONGEST_STAY)).then_some(more as u16)
    }

    /// The probability of a reading where the unknown has a value of so many.
    pub(super) fn likelihood(self, says: Says, value: u8, values: u8) -> f32 {
        let is_right = match says {
            Says::Value(read) | Says::Is(read) => read == value,
            Says::IsNot(read) => read != value,
        };
        if is_right { self.right } else { self.wrong(values) }
    }
}

impl Unknown<'_> {
    /// The number of its values.
    #[must_use]
    pub fn values(&self) -> u8 {
        u8::try_from(self.prior.len()).unwrap_or(u8::MAX)
    }

    /// The cells that belong to a value.
    pub fn cells_of(&self, value: u8) -> impl Iterator<Item = Cell> + Clone + '_ {
        self.cells.iter().filter(move |place| place.value == value).map(|place| place.cell)
    }

    /// Whether a sight, with its place in the list, is the first of its kind from its cell, is of a
    /// value that there is, and right more often than a guess.
    fn is_sound(&self, index: usize, sight: &Sight) -> bool {
        let is_again = |other: &Sight| (other.from, other.tells) == (sight.from, sight.tells);
        let (has_value, answers) = match sight.tells {
            Tells::Value => (true, self.values()),
            Tells::Whether(value) => (value < self.values(), 2),
        };
        let is_better = sight.right <= 1.0 && sight.right * f32::from(answers) > 1.0;
        has_value && is_better && !self.sights.iter().take(index).any(is_again)
    }

    /// How well a reading of this kind is known to be right: that of the sight from a cell, or of
    /// the worst sight that tells as much; `None` where no sight does.
    pub(super) fn sight(&self, from: Cell, tells: Tells) -> Option<Sight> {
        let fitting = || self.sights.iter().filter(move |sight| sight.tells == tells);
        let here = fitting().find(|sight| sight.from == from);
        let worst = || fitting().min_by(|one, other| one.right.total_cmp(&other.right));
        here.or_else(worst).copied()
    }

    /// Absorbs all that robots must agree on.
    pub(super) fn hash(&self, hash: Fnv1a) -> Fnv1a {
        let effect = match self.effect {
            Effect::Blocks => 0,
            Effect::Serves => 1,
            Effect::Takes => 2,
        };
        let counts = [self.cells.len(), self.prior.len(), self.sights.len()];
        let hash =
            counts.iter().fold(hash.write(&[effect]), |hash, &n| hash.write(&(n as u16).to_le_bytes()));
        let hash = self
            .cells
            .iter()
            .fold(hash, |hash, place| hash.write(&place.cell.0.to_le_bytes()).write(&[place.value]));
        let hash = self.prior.iter().fold(hash, |hash, p| hash.write(&p.to_bits().to_le_bytes()));
        self.sights.iter().fold(hash, |hash, sight| {
            let tells = match sight.tells {
                Tells::Value => u8::MAX,
                Tells::Whether(value) => value,
            };
            let hash = hash.write(&sight.from.0.to_le_bytes()).write(&[tells]);
            hash.write(&sight.right.to_bits().to_le_bytes())
        })
    }

    /// Whether it keeps robots from ending on a cell where it has a value.
    fn rules_out(&self, cell: Cell, value: usize) -> bool {
        let serves = self.effect == Effect::Serves;
        let mut here = self.cells.iter().filter(|place| place.cell == cell);
        here.any(|place| (usize::from(place.value) == value) != serves)
    }

    /// Checks the unknown, which has this number in its mission.
    fn check<const W: usize>(&self, number: u8, mission: &Mission<'_, W>) -> Result<(), MissionError> {
        let cells = || self.cells.iter().map(|place| place.cell);
        let is_misplaced = |cell: Cell| match self.effect {
            Effect::Blocks => mission.starts.contains(&cell),
            Effect::Serves | Effect::Takes => !mission.goals.contains(&cell),
        };
        let mut seen = CellSet::<W>::EMPTY;
        let mut named = cells().chain(self.sights.iter().map(|sight| sight.from));
        let wrong = named.find(|&cell| !mission.map.is_free(cell));
        let wrong = wrong.or_else(|| cells().find(|&cell| is_misplaced(cell) || !seen.insert(cell)));
        if let Some(cell) = wrong {
            return Err(MissionError::Unknown(cell));
        }
        if self.cells.iter().any(|place| place.value >= self.values()) {
            return Err(MissionError::Number);
        }
        let without_cells = (0..self.values()).filter(|&value| self.cells_of(value).next().is_none());
        if self.values() < 2 || without_cells.count() > 1 {
            return Err(MissionError::Values(number));
        }
        if let Some((_, sight)) = (0..).zip(self.sights).find(|&(index, sight)| !self.is_sound(index, sight))
        {
            return Err(MissionError::Sight(sight.from));
        }
        let is_unseen = self.effect != Effect::Takes && self.sights.is_empty();
        if is_unseen { Err(MissionError::Unseen(number)) } else { Ok(()) }
    }
}

/// Checks all unknowns of a mission.
///
/// # Errors
/// The first [`MissionError`] found.
pub(super) fn check<const W: usize>(mission: &Mission<'_, W>) -> Result<(), MissionError> {
    let unknowns = mission.unknowns;
    if unknowns.len() > MAX_UNKNOWNS || values(unknowns) > MAX_VALUES {
        return Err(MissionError::UnknownCount);
    }
    if unknowns.is_empty() {
        return Ok(());
    }
    if mission.paths.is_some() {
        return Err(MissionError::PathsGiven);
    }
    for (number, unknown) in (0..).zip(unknowns) {
        unknown.check(number, mission)?;
    }
    let mut blocked = CellSet::<W>::EMPTY;
    let blocks = unknowns.iter().filter(|unknown| unknown.effect == Effect::Blocks);
    if let Some(place) = blocks.flat_map(|unknown| unknown.cells).find(|place| !blocked.insert(place.cell)) {
        return Err(MissionError::Unknown(place.cell));
    }
    let worlds = worlds(unknowns).map_err(|error| match error.what {
        Argument::Prior => MissionError::Prior(error.index as u8),
        _ => MissionError::UnknownCount,
    })?;
    let is_possible = (0..worlds.len()).any(|world| is_possible(mission, &worlds, world));
    if is_possible { Ok(()) } else { Err(MissionError::Impossible) }
}

/// Whether a world has a prior above zero, and in it robots can end on as many goals without an
/// owner as they need.
fn is_possible<const W: usize>(mission: &Mission<'_, W>, worlds: &Worlds<MAX_WORLDS>, world: usize) -> bool {
    let values = || (0..).zip(mission.unknowns).map(|(number, of)| (of, worlds.value(world, number)));
    let may_be = values().all(|(unknown, value)| unknown.prior.get(value).is_some_and(|&p| p > 0.0));
    let open = || mission.open_goals(View::full(mission.team().into()));
    let serving = open().filter(|&goal| !values().any(|(unknown, value)| unknown.rules_out(goal, value)));
    let robots = mission.starts.len() - mission.own_goals.iter().flatten().count().min(mission.starts.len());
    let need = mission.need.map_or(open().count().min(robots), usize::from);
    may_be && serving.count() >= need
}

/// The values of all unknowns together.
pub(super) fn values(unknowns: &[Unknown<'_>]) -> usize {
    unknowns.iter().map(|unknown| unknown.prior.len()).sum()
}

/// The worlds of some unknowns.
///
/// # Errors
/// [`OutOfRange`] when there are too many, or a prior is no distribution.
pub(super) fn worlds(unknowns: &[Unknown<'_>]) -> Result<Worlds<MAX_WORLDS>, OutOfRange> {
    let mut priors: heapless::Vec<&[f32], MAX_UNKNOWNS> = heapless::Vec::new();
    for unknown in unknowns {
        // Those beyond the room are refused when the mission is checked.
        let _ = priors.push(unknown.prior);
    }
    Worlds::new(&priors)
}

#[cfg(all(test, feature = "unknowns"))]
mod tests {
    use super::*;
    use crate::grid::{Map, Path};

    const STARTS: [Cell; 2] = [Cell(5), Cell(6)];
    const GOALS: [Cell; 3] = [Cell(0), Cell(1), Cell(4)];
    const EITHER: [Place; 2] = [Place::new(Cell(0), 0), Place::new(Cell(4), 1)];
    const GATE: [Place; 1] = [Place::new(Cell(2), 1)];
    const SIGN: [Sight; 1] = [sight(7, Tells::Value, 0.9)];
    const SERVES: Unknown<'_> =
        Unknown { effect: Effect::Serves, cells: &EITHER, prior: &[0.5; 2], sights: &SIGN };
    const BLOCKS: Unknown<'_> = Unknown { effect: Effect::Blocks, cells: &GATE, ..SERVES };

    const fn sight(from: u16, tells: Tells, right: f32) -> Sight {
        Sight { from: Cell(from), tells, right }
    }

    /// Checks a mission of two robots that need two of three goals.
    fn checked(unknowns: &[Unknown<'_>]) -> Result<(), MissionError> {
        let map = Map::<1>::drawn(".....\n.....").unwrap();
        Mission { unknowns, need: Some(2), ..Mission::new(map, &STARTS, &GOALS) }.check::<10>()
    }

    #[test]
    fn sound_unknowns_are_not_refused() {
        assert_eq!(checked(&[SERVES, BLOCKS]), Ok(()));
        let takes = Unknown { effect: Effect::Takes, sights: &[], ..SERVES };
        assert_eq!(checked(&[takes]), Ok(()), "it is inferred from moves");
        let around = [sight(1, Tells::Whether(1), 0.51), sight(3, Tells::Whether(1), 1.0)];
        assert_eq!(checked(&[Unknown { sights: &around, ..BLOCKS }]), Ok(()));
    }

    #[test]
    fn cells_are_refused_that_are_blocked_twice_or_where_a_robot_starts() {
        assert_eq!(checked(&[BLOCKS, BLOCKS]), Err(MissionError::Unknown(Cell(2))));
        let start = Unknown { cells: &[Place::new(Cell(6), 1)], ..BLOCKS };
        assert_eq!(checked(&[start]), Err(MissionError::Unknown(Cell(6))));
        let no_goal = Unknown { cells: &[Place::new(Cell(0), 0), Place::new(Cell(2), 1)], ..SERVES };
        assert_eq!(checked(&[no_goal]), Err(MissionError::Unknown(Cell(2))));
    }

    #[test]
    fn values_that_mean_the_same_are_refused() {
        for (cells, prior) in [(&GATE[..0], &[0.5; 2][..]), (&GATE, &[0.5, 0.25, 0.25]), (&[], &[1.0])] {
            let refused = checked(&[SERVES, Unknown { cells, prior, ..BLOCKS }]);
            assert_eq!(refused, Err(MissionError::Values(1)), "{cells:?} {prior:?}");
        }
    }

    #[test]
    fn sights_are_refused_that_tell_nothing_or_the_same_again() {
        for wrong in [
            sight(3, Tells::Value, 0.5),
            sight(3, Tells::Value, 0.0),
            sight(3, Tells::Value, 1.1),
            sight(3, Tells::Whether(0), 0.5),
            sight(3, Tells::Whether(2), 0.9),
            sight(3, Tells::Value, f32::NAN),
        ] {
            let unknown = Unknown { sights: &[SIGN[0], wrong], ..SERVES };
            assert_eq!(checked(&[unknown]), Err(MissionError::Sight(Cell(3))), "{wrong:?}");
        }
        let twice = Unknown { sights: &[SIGN[0], SIGN[0]], ..SERVES };
        assert_eq!(checked(&[twice]), Err(MissionError::Sight(Cell(7))));
        let cells = [EITHER[0], EITHER[1], Place::new(Cell(1), 2)];
        let of_three = |right| {
            let sights = [sight(7, Tells::Value, right)];
            checked(&[Unknown { cells: &cells, prior: &[0.5, 0.3, 0.2], sights: &sights, ..SERVES }])
        };
        assert_eq!(of_three(0.3), Err(MissionError::Sight(Cell(7))));
        assert_eq!(of_three(0.4), Err(MissionError::Impossible), "a reading of three values tells something");
    }

    #[test]
    fn an_unknown_that_is_seen_from_nowhere_is_refused() {
        for unknown in [SERVES, BLOCKS] {
            let refused = checked(&[SERVES, Unknown { sights: &[], ..unknown }]);
            assert_eq!(refused, Err(MissionError::Unseen(1)));
        }
    }

    #[test]
    fn a_mission_is_refused_that_is_impossible_in_every_world() {
        let cells = [EITHER[0], EITHER[1], Place::new(Cell(1), 2)];
        let one_of_three = Unknown { cells: &cells, prior: &[0.5, 0.3, 0.2], ..SERVES };
        assert_eq!(checked(&[one_of_three]), Err(MissionError::Impossible), "two robots need two");
        let takes = Unknown { effect: Effect::Takes, sights: &[], ..SERVES };
        assert_eq!(checked(&[SERVES, takes]), Ok(()), "it may take the one that does not serve");
        let surely = Unknown { prior: &[1.0, 0.0], ..SERVES };
        let takes = Unknown { prior: &[1.0, 0.0], ..takes };
        assert_eq!(checked(&[surely, takes]), Err(MissionError::Impossible));
        let gate = Unknown { cells: &[Place::new(Cell(1), 1)], prior: &[0.0, 1.0], ..BLOCKS };
        assert_eq!(checked(&[SERVES, gate]), Err(MissionError::Impossible));
    }

    #[test]
    fn paths_given_by_hand_are_refused_with_unknowns() {
        let map = Map::<1>::drawn(".....\n.....").unwrap();
        let paths: [&[Path]; 2] = [&[]; 2];
        let mission = Mission { paths: Some(&paths), ..Mission::new(map, &STARTS, &GOALS) };
        assert_eq!(mission.check::<10>(), Ok(()));
        let mission = Mission { unknowns: &[SERVES], need: Some(2), ..mission };
        assert_eq!(mission.check::<10>(), Err(MissionError::PathsGiven));
    }
}
