//! A team that looks for the bay that serves, on 11 x 9 cells, and eyes that read what a robot sees
//! there: the same on the host and on the target. Robots fly it with the feature `unknowns` only.

use super::lockstep::Senses;
use crate::hardware::Scanner;
use iibt_core::grid::{Cell, Map, words};
use iibt_core::navigation::{Effect, Mission, Place, Reading, Says, Sight, Tells, Unknown};

/// The most cells of the map.
pub const CELLS: usize = 128;

/// The words of the map.
pub const WORDS: usize = words(11, 9);

/// The bays, of two cells each: one of them serves.
const BAYS: [[Cell; 2]; 4] =
    [[Cell(11), Cell(12)], [Cell(20), Cell(21)], [Cell(77), Cell(78)], [Cell(86), Cell(87)]];

/// The cells before the bays, from where is seen whether one serves.
const BEFORE: [Cell; 4] = [Cell(13), Cell(19), Cell(79), Cell(85)];

/// Where the sign is read, which tells the bay.
const SIGN: Cell = Cell(46);

static STARTS: [Cell; 8] = [Cell(38), Cell(49), Cell(60), Cell(37), Cell(59), Cell(26), Cell(71), Cell(48)];

static GOALS: [Cell; 8] = {
    let [a, b, c, d] = BAYS;
    [a[0], a[1], b[0], b[1], c[0], c[1], d[0], d[1]]
};

static PLACES: [Place; 8] = {
    let mut places = [Place::new(Cell(0), 0); 8];
    let mut at = 0;
    while at < 8 {
        places[at] = Place::new(BAYS[at / 2][at % 2], at as u8 / 2);
        at += 1;
    }
    places
};

static SIGHTS: [Sight; 13] = {
    let mut sights = [sure(SIGN, Tells::Value); 13];
    let mut bay = 0;
    while bay < 4 {
        let tells = Tells::Whether(bay as u8);
        sights[1 + 3 * bay] = sure(BAYS[bay][0], tells);
        sights[2 + 3 * bay] = sure(BAYS[bay][1], tells);
        sights[3 + 3 * bay] = sure(BEFORE[bay], tells);
        bay += 1;
    }
    sights
};

const fn sure(from: Cell, tells: Tells) -> Sight {
    Sight { from, tells, right: 1.0 }
}

static UNKNOWNS: [Unknown<'static>; 1] =
    [Unknown { effect: Effect::Serves, cells: &PLACES, prior: &[0.4, 0.3, 0.2, 0.1], sights: &SIGHTS }];

/// The mission of a team of up to eight robots, two of which are needed in the bay that serves.
///
/// `None` for another number of robots.
#[must_use]
pub fn mission(robots: usize) -> Option<Mission<'static, WORDS>> {
    let rows = "####...####\n...........\n####...####\n####...####\n##.....####\n####...####\n####...####\n\
                ...........\n####...####";
    let starts = STARTS.get(..robots).filter(|starts| !starts.is_empty())?;
    Some(Mission {
        unknowns: &UNKNOWNS,
        need: Some(2),
        ..Mission::new(Map::drawn(rows).ok()?, starts, &GOALS)
    })
}

/// Eyes that read from a cell what there is to be read, where this bay serves.
#[derive(Clone, Copy, Debug)]
pub struct Eyes {
    serving: u8,
    at: Cell,
    /// How many sights are read.
    read: usize,
}

impl Eyes {
    /// Eyes in a world in which this bay serves.
    #[must_use]
    pub const fn new(serving: u8) -> Self {
        Self { serving, at: Cell(0), read: SIGHTS.len() }
    }
}

impl Senses for Eyes {
    fn stand(&mut self, at: Cell) {
        (self.at, self.read) = (at, 0);
    }
}

impl Scanner for Eyes {
    fn scan(&mut self) -> Option<Cell> {
        None
    }

    fn recognise(&mut self) -> Option<Reading> {
        let left = SIGHTS.iter().enumerate().skip(self.read);
        let (place, sight) = left.into_iter().find(|(_, sight)| sight.from == self.at)?;
        self.read = place + 1;
        let says = match sight.tells {
            Tells::Value => Says::Value(self.serving),
            Tells::Whether(bay) if bay == self.serving => Says::Is(bay),
            Tells::Whether(bay) => Says::IsNot(bay),
        };
        Some(Reading { unknown: 0, says })
    }
}
