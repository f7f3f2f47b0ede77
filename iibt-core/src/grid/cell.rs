//! Cells and the five moves between them.

use crate::actions::Action;
use serde::{Deserialize, Serialize};

/// One cell of a map by its number, row by row from the top left, from zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Cell(pub u16);

impl Cell {
    /// The number as an index into tables with one entry per cell.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// A move of a robot on a grid in one step; the codes are the action codes of its transition model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Move {
    /// One row up.
    Up = 0,
    /// One row down.
    Down = 1,
    /// One column to the left.
    Left = 2,
    /// One column to the right.
    Right = 3,
    /// Stay for one step.
    Wait = 4,
}

impl Move {
    /// Every move, in the order of the codes.
    pub const ALL: [Self; 5] = [Self::Up, Self::Down, Self::Left, Self::Right, Self::Wait];

    /// The action code of this move.
    #[must_use]
    pub const fn code(self) -> Action {
        self as Action
    }

    /// The move with an action code, or `None` for a code that is no move.
    #[must_use]
    pub const fn from_code(code: Action) -> Option<Self> {
        match code {
            0 => Some(Self::Up),
            1 => Some(Self::Down),
            2 => Some(Self::Left),
            3 => Some(Self::Right),
            4 => Some(Self::Wait),
            _ => None,
        }
    }
}
