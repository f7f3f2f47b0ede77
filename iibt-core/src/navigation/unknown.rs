//! Unknowns: what a team does not know about its mission, and from where robots see it.

use super::mission::MissionError;
use crate::grid::{Cell, CellSet, Map};
use crate::inference::{Argument, OutOfRange, Worlds};
use crate::team::Fnv1a;

/// The most unknowns of one mission: none without the feature `unknowns`.
pub const MAX_UNKNOWNS: usize = if cfg!(feature = "unknowns") { 8 } else { 0 };

/// The most values of all unknowns of a mission together.
pub const MAX_VALUES: usize = 2 * MAX_UNKNOWNS;

/// The most combinations of the values of all unknowns of a mission: one without the feature
/// `unknowns`.
pub const MAX_WORLDS: usize = if cfg!(feature = "unknowns") { 16 } else { 1 };

/// A hidden factor of the mission: it has one of several values, the same for the whole mission.
///
/// Each of its cells belongs to a value. What the value means for its cells is the
/// [`Effect`]: the cells are blocked in the worlds in which the unknown has that value, they are the
/// goals that serve, or those that a robot takes which is no member of the team.
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
    /// The probability that a reading is right; a wrong one names any other value alike.
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

    /// The probability of a reading where the unknown has a value of so many.
    pub(super) fn likelihood(self, says: Says, value: u8, values: u8) -> f32 {
        let others =
            if self.tells == Tells::Value { f32::from(values.saturating_sub(1).max(1)) } else { 1.0 };
        let is_right = match says {
            Says::Value(read) | Says::Is(read) => read == value,
            Says::IsNot(read) => read != value,
        };
        if is_right { self.right } else { (1.0 - self.right) / others }
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

    /// Checks the unknown on a map, with the goals of its mission.
    pub(super) fn check<const W: usize>(&self, map: &Map<W>, goals: &[Cell]) -> Result<(), MissionError> {
        let mut named =
            self.cells.iter().map(|place| place.cell).chain(self.sights.iter().map(|sight| sight.from));
        if let Some(cell) = named.find(|&cell| !map.is_free(cell)) {
            return Err(MissionError::Unknown(cell));
        }
        let is_goal = |place: &&Place| goals.contains(&place.cell);
        if self.effect != Effect::Blocks
            && let Some(place) = self.cells.iter().find(|place| !is_goal(place))
        {
            return Err(MissionError::Unknown(place.cell));
        }
        let mut seen = CellSet::<W>::EMPTY;
        if let Some(place) = self.cells.iter().find(|place| !seen.insert(place.cell)) {
            return Err(MissionError::Unknown(place.cell));
        }
        let has = |value: u8| usize::from(value) < self.prior.len();
        let tells = |sight: &Sight| match sight.tells {
            Tells::Value => true,
            Tells::Whether(value) => has(value),
        };
        let is_sound = |sight: &Sight| tells(sight) && (0.0..=1.0).contains(&sight.right);
        let fits = self.cells.iter().all(|place| has(place.value)) && self.sights.iter().all(is_sound);
        if fits { Ok(()) } else { Err(MissionError::Number) }
    }
}

/// Checks all unknowns of a mission.
///
/// # Errors
/// The first [`MissionError`] found.
pub(super) fn check<const W: usize>(
    unknowns: &[Unknown<'_>],
    map: &Map<W>,
    goals: &[Cell],
) -> Result<(), MissionError> {
    if unknowns.len() > MAX_UNKNOWNS || values(unknowns) > MAX_VALUES {
        return Err(MissionError::UnknownCount);
    }
    for unknown in unknowns {
        unknown.check(map, goals)?;
    }
    worlds(unknowns).map(|_| ()).map_err(|error| match error.what {
        Argument::Prior => MissionError::Prior(error.index as u8),
        _ => MissionError::UnknownCount,
    })
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
