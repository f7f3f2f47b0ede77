//! Random missions: maps, starts and goals drawn from a seed, as scenario files.
//!
//! The same seed draws the same file on every machine. What is drawn can be flown: starts and goals
//! are in one part of the map, and not all robots stand on goals at the start.

mod solvable;

use crate::draws::{DRAWS, map_entry, some, within};
use crate::random::{Random, Stream};
use crate::scenario::{Floor, Scenario};
use iibt_core::grid::{Cell, CellSet};
use solvable::JointSearch;
use std::fmt::Write as _;
use std::ops::RangeInclusive;
use thiserror::Error;

/// The ground on which missions are drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Ground {
    /// A map of its own for each mission.
    Drawn {
        /// The least and the most columns.
        width: RangeInclusive<u16>,
        /// The least and the most rows.
        height: RangeInclusive<u16>,
        /// The least and the greatest share of blocked cells, 0 to 1.
        walls: RangeInclusive<f64>,
    },
    /// The same map for all missions.
    Given(Box<Floor>),
}

/// A kind of random mission.
///
/// ```
/// use host_sim::missions::{Ground, RandomMissions};
/// use host_sim::{Conditions, Scenario, fly};
///
/// let ground = Ground::Drawn { width: 8..=8, height: 8..=8, walls: 0.15..=0.15 };
/// let (robots, goals) = (4..=4, None);
/// let kind = RandomMissions { ground, robots, goals, is_owned: false, is_solvable: false, limit: 200 };
/// let text = kind.draw(7)?;
/// assert_eq!(text, kind.draw(7)?);
/// let mission = Scenario::parse("7.toml", &text)?;
/// let free = mission.map.free_cells().len();
/// assert_eq!((mission.robots.len(), mission.goals.len(), free), (4, 4, 54));
/// assert!(fly(&mission, Conditions::default(), &mut ())?.outcome.is_success());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RandomMissions {
    /// The ground.
    pub ground: Ground,
    /// The least and the most robots.
    pub robots: RangeInclusive<usize>,
    /// The number of goals; `None` for one for each robot.
    pub goals: Option<usize>,
    /// Whether each robot owns its goal; `goals` is ignored then.
    pub is_owned: bool,
    /// Whether missions are kept only if a search over all joint states finds a solution in which
    /// no robot enters a cell that another leaves in the same step.
    pub is_solvable: bool,
    /// The ticks after which a mission counts as not accomplished.
    pub limit: u32,
}

/// The reason why no mission was drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NotDrawn {
    /// No draw was a mission: there is no room, or nothing that can be solved.
    #[error(
        "none of {DRAWS} draws with seed {seed} is such a mission: is there room for the robots and goals?"
    )]
    NoRoom {
        /// The seed.
        seed: u64,
    },
    /// The joint states are too many to be searched.
    #[error(
        "the mission of seed {seed} has more than {most} joint states: too many to search for a solution"
    )]
    TooLarge {
        /// The seed.
        seed: u64,
        /// The most that are searched.
        most: usize,
    },
}

impl RandomMissions {
    /// Returns the scenario file that a seed draws.
    ///
    /// # Errors
    /// [`NotDrawn`].
    pub fn draw(&self, seed: u64) -> Result<String, NotDrawn> {
        let mut random = Random::of(seed, Stream::Mission);
        for _ in 0..DRAWS {
            let Some(drawn) = self.attempt(&mut random) else { continue };
            let text = drawn.text(seed, self.limit);
            if Scenario::parse("", &text).is_ok() && self.admits(&drawn, seed)? {
                return Ok(text);
            }
        }
        Err(NotDrawn::NoRoom { seed })
    }

    /// One draw; `None` without room or with nothing to do.
    fn attempt(&self, random: &mut Random) -> Option<DrawnMission> {
        let map = self.ground.draw(random)?;
        let robots = within(random, &self.robots);
        let goals = if self.is_owned { robots } else { self.goals.unwrap_or(robots) };
        let part = largest_part(&map);
        if part.len() < robots.max(goals) {
            return None;
        }
        let (starts, goals) = (some(random, &part, robots)?, some(random, &part, goals)?);
        let drawn = DrawnMission { map, starts, goals, is_owned: self.is_owned };
        (!drawn.is_done(&drawn.starts)).then_some(drawn)
    }

    fn admits(&self, drawn: &DrawnMission, seed: u64) -> Result<bool, NotDrawn> {
        if !self.is_solvable {
            return Ok(true);
        }
        let mut search = JointSearch::over(drawn);
        search.solves().ok_or(NotDrawn::TooLarge { seed, most: solvable::MOST })
    }
}

impl Ground {
    /// A map; `None` when one of this size is not possible.
    pub(crate) fn draw(&self, random: &mut Random) -> Option<Floor> {
        let (width, height, walls) = match self {
            Self::Given(map) => return Some(**map),
            Self::Drawn { width, height, walls } => (width, height, walls),
        };
        let mut side = |range: &RangeInclusive<u16>| {
            within(random, &(usize::from(*range.start())..=usize::from(*range.end()))) as u16
        };
        let mut map = Floor::new(side(width), side(height)).ok()?;
        let part = f64::from(random.bits()) / 4_294_967_296.0;
        let share = walls.start() + part * (walls.end() - walls.start());
        let mut free: Vec<Cell> = map.free_cells().iter().collect();
        for _ in 0..(share * map.len() as f64).round() as usize {
            map.block(free.swap_remove(random.below(free.len())));
        }
        Some(map)
    }
}

/// A mission as it is drawn.
struct DrawnMission {
    map: Floor,
    starts: Vec<Cell>,
    /// In the order of the robots where they own them.
    goals: Vec<Cell>,
    is_owned: bool,
}

impl DrawnMission {
    /// Whether robots in these cells hold as many goals as they can.
    fn is_done(&self, robots: &[Cell]) -> bool {
        if self.is_owned {
            return robots == self.goals;
        }
        let held = robots.iter().filter(|robot| self.goals.contains(robot)).count();
        held >= robots.len().min(self.goals.len())
    }

    /// The scenario file.
    fn text(&self, seed: u64, limit: u32) -> String {
        let robots = self.starts.len();
        let mut text = format!("title = \"Random mission {seed} with {robots} robots\"\nlimit = {limit}\n");
        if !self.is_owned {
            let goals: Vec<_> = self.goals.iter().map(|goal| goal.0.to_string()).collect();
            let _ = writeln!(text, "goals = [{}]", goals.join(", "));
        }
        text += &map_entry(&self.map, &self.starts, &[]);
        for goal in self.goals.iter().filter(|_| self.is_owned) {
            let _ = writeln!(text, "\n[[robot]]\ngoal = {}", goal.0);
        }
        text
    }
}

/// The cells of the largest part of a map between which ways lead.
pub(crate) fn largest_part(map: &Floor) -> Vec<Cell> {
    let (mut seen, mut largest) = (CellSet::EMPTY, CellSet::EMPTY);
    for cell in map.free_cells().iter() {
        let part = if seen.contains(cell) { CellSet::EMPTY } else { map.connected(cell) };
        seen = seen.union(&part);
        if part.len() > largest.len() {
            largest = part;
        }
    }
    largest.iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    fn kind(robots: RangeInclusive<usize>, is_owned: bool) -> RandomMissions {
        let ground = Ground::Drawn { width: 2..=4, height: 2..=4, walls: 0.0..=0.4 };
        RandomMissions { ground, robots, goals: None, is_owned, is_solvable: true, limit: 300 }
    }

    #[test]
    fn missions_have_what_was_asked_for_and_a_seed_draws_the_same_again() {
        let (mut texts, mut sizes) = (HashSet::new(), HashSet::new());
        for seed in 0..200 {
            let kind = kind(2..=4, seed % 2 == 0);
            let text = kind.draw(seed).expect("there is room");
            assert_eq!(kind.draw(seed).as_ref(), Ok(&text));
            let scenario = Scenario::parse("drawn", &text).expect("what is drawn is sound");
            let (robots, cells) = (scenario.robots.len(), scenario.map.len());
            assert!((2..=4).contains(&robots) && (4..=16).contains(&cells), "{text}");
            let (goals, need, limit) = (scenario.goals.len(), scenario.need, scenario.limit);
            assert_eq!((goals, need, limit), (robots, robots, 300), "{text}");
            assert!(scenario.robots.iter().all(|robot| robot.goal.is_some() == kind.is_owned), "{text}");
            texts.insert(text);
            sizes.insert((robots, cells));
        }
        assert!(texts.len() > 195 && sizes.len() > 15, "{} {}", texts.len(), sizes.len());
    }

    #[test]
    fn a_given_map_stays_and_the_share_of_walls_is_exact() {
        let map = Floor::new(5, 2).expect("ten cells");
        let given =
            RandomMissions { ground: Ground::Given(Box::new(map)), goals: Some(1), ..kind(8..=8, false) };
        let scenario = Scenario::parse("drawn", &given.draw(3).expect("room")).expect("sound");
        assert_eq!((scenario.map, scenario.robots.len(), scenario.goals.len()), (map, 8, 1));
        let ground = Ground::Drawn { width: 8..=8, height: 8..=8, walls: 0.2..=0.2 };
        for seed in 0..20 {
            let text = RandomMissions { ground: ground.clone(), is_solvable: false, ..kind(8..=8, false) }
                .draw(seed);
            assert_eq!(text.expect("room").matches('#').count(), 13);
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_said() {
        let crowded = RandomMissions {
            ground: Ground::Drawn { width: 2..=2, height: 2..=2, walls: 0.0..=0.0 },
            ..kind(5..=5, false)
        };
        assert_eq!(crowded.draw(1), Err(NotDrawn::NoRoom { seed: 1 }));
        let full = RandomMissions { robots: 4..=4, is_owned: true, ..crowded };
        assert_eq!(full.draw(1), Err(NotDrawn::NoRoom { seed: 1 }), "nobody can move");
        let large = RandomMissions {
            ground: Ground::Drawn { width: 8..=8, height: 8..=8, walls: 0.0..=0.0 },
            ..kind(8..=8, true)
        };
        assert_eq!(large.draw(2), Err(NotDrawn::TooLarge { seed: 2, most: solvable::MOST }));
    }
}
