//! Families of random missions with something unknown, as scenario files.
//!
//! The same seed draws the same file on every machine. What is drawn can be accomplished however
//! the unknowns are. Their values are left open: the seed of a flight draws them from the prior.

mod far_sign;
mod floor;
mod gates;
mod hall;
mod prior;
mod rooms;
mod search;
mod sign;
mod sketch;
mod soluble;

use crate::draws::{DRAWS, within};
use crate::missions::NotDrawn;
use crate::random::{Random, Stream};
use crate::scenario::{MAX_TICKS, Scenario};
use clap::ValueEnum;
use iibt_core::team::MAX_TEAM;
use sketch::Sketch;
use std::ops::RangeInclusive;
use thiserror::Error;

/// A family of random missions with something unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ValueEnum)]
pub enum Family {
    /// Two to four bays off a hall, one of which serves; a sign tells which.
    Sign,
    /// Three to five rooms along a corridor, one of which serves; a board at its end tells which.
    Rooms,
    /// Two or three alleys with a gate each, which may be shut, and a way around that is open.
    Gates,
    /// Six to twelve corners, one of which serves; only a robot beside it sees that.
    Search,
    /// An open floor with three cells that may be blocked; to look first gains nothing.
    Floor,
    /// Two bays, one of which serves almost surely; the sign is too far away to be worth the way.
    FarSign,
}

/// The missions of a family.
///
/// ```
/// use host_sim::families::{Family, FamilyMissions};
/// use host_sim::{Conditions, Scenario, fly};
///
/// let missions = FamilyMissions { right: 0.9, ..FamilyMissions::of(Family::Sign) };
/// let text = missions.draw(7)?;
/// assert_eq!(text, missions.draw(7)?);
/// let mission = Scenario::parse("7.toml", &text)?;
/// assert_eq!((mission.robots.len(), mission.need, mission.unknowns.len()), (3, 2, 1));
/// assert!(fly(&mission, Conditions::default(), &mut ())?.outcome.is_success());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FamilyMissions {
    /// The family.
    pub family: Family,
    /// The least and the most robots, 1 to [`MAX_TEAM`].
    pub robots: RangeInclusive<usize>,
    /// The least and the most goals that must be held at the end; `None` for as many as robots.
    ///
    /// At most two of [`Family::Sign`], [`Family::Rooms`] and [`Family::FarSign`], one of
    /// [`Family::Gates`] and [`Family::Search`], and never more than the least robots.
    pub need: Option<RangeInclusive<usize>>,
    /// The probability that a reading is right, more than that of a guess between two: over 0.5,
    /// and up to 1.
    pub right: f64,
    /// The ticks after which a mission counts as not accomplished, 1 to [`MAX_TICKS`].
    pub limit: u32,
}

/// The reason why no mission of a family was drawn.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum FamilyError {
    /// No team has so many robots.
    #[error("{least}..{most} robots, but a team has 1 to {MAX_TEAM}")]
    Robots {
        /// The least robots.
        least: usize,
        /// The most robots.
        most: usize,
    },
    /// No mission of this family needs so many goals.
    #[error("a need of {least}..{most} goals, but in this family with so many robots it is 1 to {serving}")]
    Need {
        /// The least goals that are needed.
        least: usize,
        /// The most goals that are needed.
        most: usize,
        /// The most goals that such a mission can need.
        serving: usize,
    },
    /// Readings are right no more often than a guess, or this is no probability.
    #[error("readings are right with a probability over 0.5 and up to 1, not {0}")]
    Right(f64),
    /// No mission has this limit.
    #[error("a limit of {0} ticks is not between 1 and {MAX_TICKS}")]
    Limit(u32),
    /// No draw was such a mission.
    #[error(transparent)]
    NotDrawn(#[from] NotDrawn),
}

impl FamilyMissions {
    /// The missions of a family with its own numbers of robots and goals, readings that are right,
    /// and a limit of 200 ticks.
    #[must_use]
    pub const fn of(family: Family) -> Self {
        let (robots, need) = match family {
            Family::Sign | Family::FarSign => (3..=3, Some(2..=2)),
            Family::Rooms => (3..=3, Some(1..=2)),
            Family::Gates => (2..=3, Some(1..=1)),
            Family::Search => (3..=3, Some(1..=1)),
            Family::Floor => (2..=3, None),
        };
        Self { family, robots, need, right: 1.0, limit: 200 }
    }

    /// Returns the scenario file that a seed draws.
    ///
    /// # Errors
    /// [`FamilyError`] for a number out of its range, or when no draw was such a mission.
    pub fn draw(&self, seed: u64) -> Result<String, FamilyError> {
        self.check()?;
        let mut random = Random::of(seed, Stream::Family);
        for _ in 0..DRAWS {
            let robots = within(&mut random, &self.robots);
            let need = self.need.as_ref().map_or(robots, |need| within(&mut random, need));
            let Some(sketch) = self.sketch(&mut random, robots, need) else { continue };
            let text = sketch.text(seed, need, self.right, self.limit);
            if Scenario::parse("", &text).is_ok_and(|scenario| soluble::is_soluble(&scenario)) {
                return Ok(text);
            }
        }
        Err(NotDrawn::NoRoom { seed }.into())
    }

    fn check(&self) -> Result<(), FamilyError> {
        let (least, most) = (*self.robots.start(), *self.robots.end());
        if least < 1 || least > most || most > MAX_TEAM {
            return Err(FamilyError::Robots { least, most });
        }
        let all = self.family.most_serving();
        let (need, serving) = self.need.as_ref().map_or((&self.robots, all), |need| (need, all.min(least)));
        let (least, most) = (*need.start(), *need.end());
        if least < 1 || least > most || most > serving {
            return Err(FamilyError::Need { least, most, serving });
        }
        if !(self.right > 0.5 && self.right <= 1.0) {
            return Err(FamilyError::Right(self.right));
        }
        if (1..=MAX_TICKS).contains(&self.limit) { Ok(()) } else { Err(FamilyError::Limit(self.limit)) }
    }

    /// One draw; `None` where something has no room.
    fn sketch(&self, random: &mut Random, robots: usize, need: usize) -> Option<Sketch> {
        match self.family {
            Family::Sign => sign::sketch(random, robots),
            Family::Rooms => rooms::sketch(random, robots, need),
            Family::Gates => gates::sketch(random, robots),
            Family::Search => search::sketch(random, robots),
            Family::Floor => floor::sketch(random, robots),
            Family::FarSign => far_sign::sketch(random, robots),
        }
    }
}

impl Family {
    /// The most goals that serve at once.
    const fn most_serving(self) -> usize {
        match self {
            Self::Sign | Self::Rooms | Self::FarSign => 2,
            Self::Gates | Self::Search => 1,
            Self::Floor => MAX_TEAM,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Floor, MAX_CELLS, UnknownSpec};
    use iibt_core::grid::{Cell, Planner};
    use iibt_core::navigation::{Effect, MAX_GOALS, MAX_UNKNOWNS, MAX_VALUES, MAX_WORLDS, Tells};
    use std::collections::HashSet;

    const SEEDS: u64 = 200;

    /// The missions of the first seeds.
    fn drawn(missions: &FamilyMissions) -> Vec<Scenario> {
        let parsed = |seed| Scenario::parse("drawn", &missions.draw(seed).expect("there is room"));
        (0..SEEDS).map(|seed| parsed(seed).expect("what is drawn is sound")).collect()
    }

    fn of(family: Family) -> Vec<Scenario> {
        drawn(&FamilyMissions::of(family))
    }

    /// The numbers that missions have, each once and in order.
    fn numbers(missions: &[Scenario], number: impl Fn(&Scenario) -> usize) -> Vec<usize> {
        let mut all: Vec<_> = missions.iter().map(number).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    fn moves(map: &Floor, from: Cell, to: Cell) -> Option<u16> {
        Planner::<MAX_CELLS>::new().distances(map, from).expect("a free cell").to(to)
    }

    /// The cell from where the value is read.
    fn sign(unknown: &UnknownSpec) -> Option<Cell> {
        unknown.sights.iter().find(|sight| sight.tells == Tells::Value).map(|sight| sight.from)
    }

    fn groups(unknown: &UnknownSpec) -> Vec<Vec<Cell>> {
        (0..unknown.prior.len() as u8).map(|value| unknown.as_known().cells_of(value).collect()).collect()
    }

    #[test]
    fn missions_have_what_was_asked_for_and_a_seed_draws_the_same_again() {
        for &family in Family::value_variants() {
            let usual = FamilyMissions::of(family);
            let missions = FamilyMissions { robots: 2..=4, right: 0.9, limit: 300, ..usual };
            let mut texts = HashSet::new();
            for (seed, scenario) in (0..).zip(drawn(&missions)) {
                let text = missions.draw(seed).expect("there is room");
                let (robots, need) = (scenario.robots.len(), scenario.need);
                let asked = missions.need.clone().unwrap_or(robots..=robots);
                assert!((2..=4).contains(&robots) && asked.contains(&need), "{text}");
                assert_eq!(scenario.limit, 300, "{text}");
                let unknowns = &scenario.unknowns;
                assert!(unknowns.iter().flat_map(|unknown| &unknown.sights).all(|sight| sight.right == 0.9));
                let (values, worlds): (usize, usize) = (
                    unknowns.iter().map(|unknown| unknown.prior.len()).sum(),
                    unknowns.iter().map(|unknown| unknown.prior.len()).product(),
                );
                assert!((1..=MAX_UNKNOWNS).contains(&unknowns.len()) && values <= MAX_VALUES, "{text}");
                assert!(worlds <= MAX_WORLDS && scenario.goals.len() <= MAX_GOALS, "{text}");
                assert!(scenario.map.len() <= 128, "{text}");
                for unknown in unknowns {
                    let hundredths = unknown.prior.iter().map(|p| (p * 100.0).round());
                    assert!(hundredths.clone().zip(&unknown.prior).all(|(h, p)| h / 100.0 == *p), "{text}");
                    assert_eq!(hundredths.sum::<f32>(), 100.0, "{text}");
                    assert!(unknown.prior.iter().all(|&p| p >= 0.03) && unknown.real.is_none(), "{text}");
                }
                assert!(soluble::is_soluble(&scenario), "{text}");
                texts.insert(text);
            }
            assert_eq!(texts.len() as u64, SEEDS, "{family:?}");
        }
    }

    #[test]
    fn a_sign_is_in_the_hall_or_in_its_wall_and_tells_which_of_two_to_four_bays_serves() {
        let missions = of(Family::Sign);
        assert_eq!(numbers(&missions, |mission| mission.unknowns[0].prior.len()), [2, 3, 4]);
        assert!(numbers(&missions, |mission| mission.map.height().into()).len() > 4);
        let mut niches = 0;
        for Scenario { map, robots, unknowns, .. } in &missions {
            let sign = sign(&unknowns[0]).expect("there is one");
            assert!(map.is_free(sign) && robots.iter().all(|robot| robot.start != sign));
            assert!(robots.iter().all(|robot| (4..=6).contains(&(robot.start.0 % 11))));
            assert!((3..=7).contains(&(sign.0 % 11)));
            niches += u32::from(!(4..=6).contains(&(sign.0 % 11)));
            for bay in groups(&unknowns[0]) {
                assert_eq!(bay.len(), 2);
                assert_eq!(moves(map, bay[0], bay[1]), Some(1));
                assert!(bay.iter().any(|&cell| map.free_neighbours(cell).count() == 1), "it is a dead end");
            }
        }
        assert!((10..190).contains(&niches), "{niches}");
    }

    #[test]
    fn a_board_at_the_end_of_the_corridor_tells_which_of_three_to_five_rooms_serves() {
        let missions = of(Family::Rooms);
        assert_eq!(numbers(&missions, |mission| mission.unknowns[0].prior.len()), [3, 4, 5]);
        assert_eq!(numbers(&missions, |mission| mission.need), [1, 2]);
        for Scenario { map, need, unknowns, .. } in &missions {
            let column = sign(&unknowns[0]).expect("there is one").0 % map.width();
            assert!(column == 0 || column == map.width() - 1);
            for room in groups(&unknowns[0]) {
                assert_eq!(room.len(), *need);
                let outside =
                    |cell: &Cell| map.free_neighbours(*cell).filter(|(_, next)| !room.contains(next)).count();
                assert_eq!(room.iter().map(outside).sum::<usize>(), 1, "it has one door");
            }
        }
    }

    #[test]
    fn a_way_around_gates_is_open_and_longer() {
        let missions = of(Family::Gates);
        assert_eq!(numbers(&missions, |mission| mission.unknowns.len()), [2, 3]);
        assert_eq!(numbers(&missions, |mission| mission.robots.len()), [2, 3]);
        for Scenario { map, robots, goals, need, unknowns, .. } in &missions {
            let shut = map.avoiding(unknowns.iter().map(|unknown| unknown.cells[0].cell));
            for unknown in unknowns {
                assert!(unknown.effect == Effect::Blocks && (0.2..=0.8).contains(&unknown.prior[1]));
                assert_eq!((unknown.cells.len(), map.free_neighbours(unknown.cells[0].cell).count()), (1, 2));
            }
            let way = |map, robot: usize| moves(map, robots[robot].start, goals[0]).expect("a way");
            assert!((0..robots.len()).all(|robot| way(&shut, robot) > way(map, robot)));
            assert_eq!((goals.len(), *need), (1, 1));
        }
    }

    #[test]
    fn a_search_is_among_six_to_twelve_corners_apart_from_each_other() {
        let missions = of(Family::Search);
        assert_eq!(numbers(&missions, |mission| mission.goals.len()), [6, 7, 8, 9, 10, 11, 12]);
        for Scenario { map, goals, unknowns, .. } in &missions {
            assert!(unknowns.len() == 1 && sign(&unknowns[0]).is_none());
            assert!(groups(&unknowns[0]).iter().all(|group| group.len() == 1));
            for (number, &goal) in goals.iter().enumerate() {
                assert!(map.free_neighbours(goal).count() <= 2);
                assert!(goals[..number].iter().all(|&other| map.manhattan(goal, other) > 2));
            }
        }
    }

    #[test]
    fn a_floor_is_open_but_for_three_cells_that_may_be_blocked() {
        let missions = of(Family::Floor);
        assert_eq!(numbers(&missions, |mission| mission.robots.len()), [2, 3]);
        for Scenario { map, robots, goals, need, unknowns, .. } in &missions {
            assert_eq!((map.free_cells().len(), goals.len(), *need), (64, robots.len(), robots.len()));
            assert_eq!(unknowns.len(), 3);
            assert!(
                unknowns.iter().all(|unknown| unknown.effect == Effect::Blocks && unknown.prior == [0.5; 2])
            );
        }
    }

    #[test]
    fn a_far_sign_is_six_moves_or_more_from_all_and_a_bay_serves_almost_surely() {
        let missions = of(Family::FarSign);
        for Scenario { map, robots, unknowns, .. } in &missions {
            let sign = sign(&unknowns[0]).expect("there is one");
            assert!(robots.iter().all(|robot| moves(map, robot.start, sign) >= Some(6)));
            let likely = unknowns[0].prior.iter().copied().fold(0.0, f32::max);
            assert!(unknowns[0].prior.len() == 2 && (0.8..=0.95).contains(&likely), "{likely}");
        }
        let likelier = |mission: &Scenario| usize::from(mission.unknowns[0].prior[1] > 0.5);
        assert_eq!(numbers(&missions, likelier), [0, 1]);
    }

    #[test]
    fn any_team_has_room() {
        for &family in Family::value_variants() {
            for robots in 1..=MAX_TEAM {
                let need = (family != Family::Floor).then_some(1..=1);
                let missions = FamilyMissions { robots: robots..=robots, need, ..FamilyMissions::of(family) };
                let scenario = Scenario::parse("drawn", &missions.draw(1).expect("there is room"));
                assert_eq!(scenario.expect("it is sound").robots.len(), robots, "{family:?}");
            }
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_said() {
        let sign = FamilyMissions::of(Family::Sign);
        let refused = |missions: FamilyMissions| missions.draw(0).expect_err("it is out of range");
        for (least, most) in [(0, 3), (3, 2), (3, MAX_TEAM + 1)] {
            let missions = FamilyMissions { robots: least..=most, ..sign.clone() };
            assert_eq!(refused(missions), FamilyError::Robots { least, most });
        }
        for (robots, need, serving) in
            [(3..=3, Some(0..=1), 2), (3..=3, Some(2..=3), 2), (1..=3, Some(2..=2), 1), (3..=3, None, 2)]
        {
            let (least, most) = need.clone().map_or((3, 3), RangeInclusive::into_inner);
            let missions = FamilyMissions { robots, need, ..sign.clone() };
            assert_eq!(refused(missions), FamilyError::Need { least, most, serving });
        }
        let right = |right| FamilyMissions { right, ..sign.clone() };
        for wrong in [0.0, 0.5, 1.5] {
            assert_eq!(refused(right(wrong)), FamilyError::Right(wrong));
        }
        assert!(matches!(refused(right(f64::NAN)), FamilyError::Right(_)));
        for limit in [0, MAX_TICKS + 1] {
            assert_eq!(refused(FamilyMissions { limit, ..sign.clone() }), FamilyError::Limit(limit));
        }
    }
}
