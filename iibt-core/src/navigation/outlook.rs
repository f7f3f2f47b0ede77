//! What lies ahead of a team that does not know all of its mission: how long a plan is expected to
//! take, and what is seen on the way.
//!
//! A joint policy is weighed over the worlds until something new can be seen, and from then on by
//! the best of a few ways to go on.

use super::mission::Mission;
use super::policies::{TeamPlan, ahead, moves_of, visits};
use super::prospects::{Bits, LONGEST, Prospects, Robots, bits, of, worlds_of};
use super::unknown::{Effect, MAX_WORLDS, Says, Sight, Tells, Unknown};
use super::ways::{ROUND, Way};
use crate::bounded::up_to;
use crate::grid::{Cell, CellSet, Map, Path};
use crate::inference::{Eighths, ExpectedTime, Outlook};
use crate::team::MAX_TEAM;
use heapless::Vec;

/// The readings that may come at once.
const MOST_READINGS: usize = 8;

/// The ticks after which the moves of a stranger are taken to have shown where it goes.
const SHOWN: u16 = 2;

/// How probably they are then taken for what they mean.
const SHOWN_RIGHT: f32 = 0.9;

/// The members of a round that go to goals which no robot owns, by their places: a bit for each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Seekers(u8);

impl Seekers {
    pub(super) const NONE: Self = Self(0);

    pub(super) fn of(places: impl Iterator<Item = usize>) -> Self {
        Self(places.filter(|&place| place < MAX_TEAM).fold(0, |all, place| all | 1 << place))
    }

    pub(super) const fn len(self) -> usize {
        self.0.count_ones() as usize
    }

    pub(super) const fn is_empty(self) -> bool {
        self.0 == 0
    }

    pub(super) fn has(self, place: usize) -> bool {
        self.0.checked_shr(place as u32).unwrap_or(0) & 1 == 1
    }

    /// Where they are in a plan.
    pub(super) fn cells<const W: usize>(self, map: &Map<W>, plan: &TeamPlan, done: &Done) -> Robots {
        let all = plan.paths().iter().zip(done.moves).enumerate().filter(|&(place, _)| self.has(place));
        up_to(all.map(|(_, (path, made))| after(map, path, made)))
    }

    /// Their paths in a plan.
    pub(super) fn paths(self, plan: &TeamPlan) -> impl Iterator<Item = &Path> {
        plan.paths().iter().enumerate().filter(move |&(place, _)| self.has(place)).map(|(_, path)| path)
    }
}

/// After how many ticks a plan stops in each world; `None` where it goes on to its end.
type Stops = [Option<u16>; MAX_WORLDS];

/// What is left of a plan.
#[derive(Clone, Copy, Debug)]
struct Rest<'p> {
    plan: &'p TeamPlan,
    seekers: Seekers,
    done: Done,
    /// The ticks from then on.
    ticks: u16,
}

impl Rest<'_> {
    /// The paths, with the moves that their robots have made.
    fn paths(&self) -> impl Iterator<Item = (usize, &Path, u16)> + Clone {
        self.plan
            .paths()
            .iter()
            .zip(self.done.moves)
            .enumerate()
            .map(|(place, (path, made))| (place, path, made))
    }

    /// Where those that go to goals are after some more ticks.
    fn cells<const W: usize>(&self, map: &Map<W>, ticks: u16) -> Robots {
        self.seekers.cells(map, self.plan, &self.done.after(ticks))
    }

    /// Whether all have made their moves.
    fn is_at_its_end(&self) -> bool {
        self.paths().all(|(_, path, made)| moves_of(path) <= made)
    }

    /// After how many ticks a robot stands before one of these cells, if one is on what is left of
    /// a path.
    fn until<const W: usize>(&self, map: &Map<W>, closed: &CellSet<W>) -> Option<u16> {
        let enters = |(_, path, made): (usize, &Path, u16)| {
            let mut closed = ahead(path, map, made).filter(|&(_, cell)| closed.contains(cell));
            closed.next().map(|(moves, _)| moves.saturating_sub(made + 1))
        };
        if closed.is_empty() { None } else { self.paths().filter_map(enters).min() }
    }
}

/// How far the robots are with a plan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Done {
    /// The moves that each has made, in the order of the members.
    pub(super) moves: [u16; MAX_TEAM],
    /// The robot that asks, by its place: what it reads at the end of the plan is news, what others
    /// have read there they would have told. `None` for a plan that is not begun.
    pub(super) own: Option<usize>,
}

impl Done {
    pub(super) const NOTHING: Self = Self { moves: [0; MAX_TEAM], own: None };

    /// After some more ticks in which all robots move.
    fn after(self, ticks: u16) -> Self {
        Self { moves: self.moves.map(|moves| moves.saturating_add(ticks)), ..self }
    }

    fn most(&self) -> u16 {
        self.moves.iter().copied().max().unwrap_or(0)
    }
}

impl<const S: usize, const W: usize> Prospects<S, W> {
    /// What it would save to know everything, in eighths of a tick.
    pub(super) fn value_of_knowing(&self, mission: &Mission<'_, W>, robots: &[Cell]) -> Eighths {
        let blind = self.anew(mission, robots, self.belief());
        let times = core::array::from_fn(|world| 8 * (self.ticks_to(world, robots) + ROUND));
        blind.total().saturating_sub(whatever_is_seen(self.belief(), &[times]).total())
    }

    /// The expected time of the best way on after another decision.
    pub(super) fn anew(&self, mission: &Mission<'_, W>, robots: &[Cell], belief: &[f32]) -> ExpectedTime {
        whatever_is_seen(belief, &self.ways(mission, robots))
    }

    /// The expected time of what is left of a plan after so many moves, by a belief of now.
    pub(super) fn expected(
        &self,
        mission: &Mission<'_, W>,
        plan: &TeamPlan,
        seekers: Seekers,
        done: Done,
        belief: &[f32],
    ) -> ExpectedTime {
        let ticks = u16::from(plan.execution().ticks).saturating_sub(done.most());
        let rest = Rest { plan, seekers, ticks, done };
        // A team that has come to its end would wait for ever for a stranger that waits for it.
        let strangers = || self.strangers(mission, belief).filter(|_| !rest.is_at_its_end());
        let shown = strangers().next().map(|_| SHOWN.min(ticks.max(1)));
        let looks = [self.first_look(mission, &rest, belief), shown];
        let look = looks.into_iter().flatten().min().filter(|_| mission.decider().branches());
        let Some(look) = look else {
            let way = self.to_its_end(mission, &rest, &self.stops(mission, &rest));
            return whatever_is_seen(belief, &[way]);
        };
        let mut readings: Vec<[f32; MAX_WORLDS], MOST_READINGS> = up_to([[1.0; MAX_WORLDS]]);
        for (_, path, made) in rest.paths() {
            self.read(mission, after(&mission.map, path, made.saturating_add(look)), belief, &mut readings);
        }
        for (number, unknown) in strangers().filter(|_| shown == Some(look)) {
            let moves = Sight { from: Cell(0), tells: Tells::Value, right: SHOWN_RIGHT };
            self.read_from((number, unknown), &moves, &mut readings);
        }
        let mut ways = self.ways(mission, &rest.cells(&mission.map, look));
        let later = Rest { done: done.after(look), ticks: ticks.saturating_sub(look), ..rest };
        let shut = self.stops(mission, &later);
        // There is room for one more than those.
        let _ = ways.push(self.to_its_end(mission, &later, &shut));
        let once = Outlook { until: 8 * look, readings: &readings, ways: &ways }.expected(belief);
        // What is seen later still can change how the team goes on as well.
        if let Some(way) = ways.last_mut() {
            *way = self.until_known(mission, &later, &shut, *way);
        }
        let total = Outlook { until: 8 * look, readings: &readings, ways: &ways }.expected(belief).total();
        ExpectedTime { epistemic: once.pragmatic.saturating_sub(total), ..once }
    }

    /// After how many ticks a plan ends before a cell that is blocked, in each world in which it
    /// does.
    fn stops(&self, mission: &Mission<'_, W>, rest: &Rest<'_>) -> Stops {
        let mut stops = [None; MAX_WORLDS];
        for world in worlds_of(self.all()) {
            if let Some(stop) = stops.get_mut(world) {
                *stop = rest.until(&mission.map, &self.walls(mission, world));
            }
        }
        stops
    }

    /// The time in each world if a plan is followed to its end, whatever is seen. Before a cell
    /// that is blocked, or where it does not end on goals that serve, the team decides again; one
    /// that is there already stays for ever.
    fn to_its_end(&self, mission: &Mission<'_, W>, rest: &Rest<'_>, shut: &Stops) -> [Eighths; MAX_WORLDS] {
        let end = rest.cells(&mission.map, u16::MAX);
        let mut stops = *shut;
        for world in worlds_of(self.all()) {
            if let Some(stop @ None) = stops.get_mut(world) {
                *stop = (!self.is_done(world, &end)).then_some(rest.ticks);
            }
        }
        let mut times = [8 * rest.ticks; MAX_WORLDS];
        let stop = |world: usize| stops.get(world).copied().flatten();
        let mut left = bits(worlds_of(self.all()).filter(|&world| stop(world).is_some()));
        while let Some(ticks) = worlds_of(left).filter_map(stop).min() {
            let here = bits(worlds_of(left).filter(|&world| stop(world) == Some(ticks)));
            left &= !here;
            let stays = rest.done.own.is_some() && rest.is_at_its_end();
            let more = if stays {
                [8 * LONGEST; MAX_WORLDS]
            } else {
                self.times(mission, &rest.cells(&mission.map, ticks), here, Way::Nearest)
            };
            for world in worlds_of(here) {
                if let Some((time, more)) = times.get_mut(world).zip(more.get(world)) {
                    *time = (8 * (ticks + ROUND) + more).min(8 * LONGEST);
                }
            }
        }
        times
    }

    /// The time in each world if a plan is followed until the team knows the world, or to its end,
    /// which takes these times.
    fn until_known(
        &self,
        mission: &Mission<'_, W>,
        rest: &Rest<'_>,
        shut: &Stops,
        mut times: [Eighths; MAX_WORLDS],
    ) -> [Eighths; MAX_WORLDS] {
        let mut alike = [self.all(); MAX_WORLDS];
        let (mut left, mut stay) = (self.all(), 0);
        let stop = |world: usize| shut.get(world).copied().flatten();
        for ticks in 0..=rest.ticks {
            let cells = rest.cells(&mission.map, ticks);
            for &cell in cells.iter().filter(|cell| self.has_sight(**cell)) {
                stay = stay.max(self.tell_apart(mission, cell, &mut alike));
            }
            let is_known = |&world: &usize| alike.get(world).is_some_and(|alike| *alike == 1 << world);
            for world in worlds_of(left).filter(is_known) {
                left &= !(1 << world);
                if stop(world).is_some_and(|stop| stop < ticks) {
                    continue;
                }
                let anew = 8 * (ticks + stay + ROUND + self.ticks_to(world, &cells)).min(LONGEST);
                if let Some(time) = times.get_mut(world) {
                    *time = anew.min(*time);
                }
            }
            if left == 0 {
                break;
            }
        }
        times
    }

    /// Takes from the worlds that look like each one those that look otherwise from a cell; returns
    /// for how many ticks a robot stays there to be sure.
    fn tell_apart(&self, mission: &Mission<'_, W>, cell: Cell, alike: &mut [Bits; MAX_WORLDS]) -> u16 {
        let mut longest = 0;
        for (number, unknown) in (0..).zip(mission.unknowns) {
            for sight in unknown.sights.iter().filter(|sight| sight.from == cell) {
                let Some(stay) = sight.stay(unknown.values()) else { continue };
                for (world, alike) in alike.iter_mut().enumerate() {
                    let left = *alike & self.alike(number, sight, world);
                    if left != core::mem::replace(alike, left) {
                        longest = longest.max(stay);
                    }
                }
            }
        }
        longest
    }

    /// After how many ticks a robot comes to where it sees something of what is not known; of a
    /// team that stands, after one more tick.
    fn first_look(&self, mission: &Mission<'_, W>, rest: &Rest<'_>, belief: &[f32]) -> Option<u16> {
        let map = &mission.map;
        let tells = |cell| self.has_sight(cell) && self.is_informative(mission, cell, belief);
        let sees = |(_, path, made): (usize, &Path, u16)| {
            ahead(path, map, made).find(|&(_, cell)| tells(cell)).map(|(moves, _)| moves - made)
        };
        let stays = || {
            let mut own = rest.paths().filter(|&(place, ..)| rest.done.own.is_none_or(|own| own == place));
            let tells = own.any(|(_, path, _)| tells(path.end(map)));
            (rest.is_at_its_end() && tells).then_some(1)
        };
        rest.paths().filter_map(sees).min().or_else(stays)
    }

    /// Multiplies the likelihoods of the readings by those that come from a cell, as far as there
    /// is room.
    fn read(
        &self,
        mission: &Mission<'_, W>,
        from: Cell,
        belief: &[f32],
        readings: &mut Vec<[f32; MAX_WORLDS], MOST_READINGS>,
    ) {
        for (number, unknown) in (0..).zip(mission.unknowns) {
            let here = unknown.sights.iter().filter(|sight| sight.from == from);
            for sight in here.filter(|sight| self.is_open((number, unknown), sight, belief)) {
                self.read_from((number, unknown), sight, readings);
            }
        }
    }

    /// Multiplies the likelihoods of the readings by those of a sight, if there is room.
    fn read_from(
        &self,
        (number, unknown): (usize, &Unknown<'_>),
        sight: &Sight,
        readings: &mut Vec<[f32; MAX_WORLDS], MOST_READINGS>,
    ) {
        let outcomes = sight.outcomes(unknown.values());
        if readings.len() * outcomes.clone().count() > MOST_READINGS {
            return;
        }
        let with = |row: &[f32; MAX_WORLDS], says: Says| {
            let mut row = *row;
            for (world, p) in row.iter_mut().enumerate() {
                *p *= sight.likelihood(says, self.value(world, number) as u8, unknown.values());
            }
            row
        };
        let all = readings.iter().flat_map(|row| outcomes.clone().map(move |says| with(row, says)));
        *readings = up_to(all);
    }

    /// The unknowns that say where strangers go, as far as that is not known.
    fn strangers<'m>(
        &self,
        mission: &Mission<'m, W>,
        belief: &[f32],
    ) -> impl Iterator<Item = (usize, &'m Unknown<'m>)> {
        of(mission, Effect::Takes).filter(|&unknown| self.is_undecided_by(unknown, belief))
    }
}

/// The expected time of the best of some ways, whatever is seen on them.
fn whatever_is_seen(belief: &[f32], ways: &[[Eighths; MAX_WORLDS]]) -> ExpectedTime {
    Outlook { until: 0, readings: &[], ways }.expected(belief)
}

/// The cell of a path after so many moves.
pub(super) fn after<const W: usize>(map: &Map<W>, path: &Path, moves: u16) -> Cell {
    visits(path, map).take_while(|&(made, _)| made <= moves).last().map_or(path.start, |(_, cell)| cell)
}

#[cfg(all(test, feature = "unknowns"))]
mod tests {
    use super::super::fact::Fact;
    use super::super::policies::{Members, Policies};
    use super::super::prospects::Certainty;
    use super::super::unknown::Place;
    use super::*;
    use crate::grid::words;
    use crate::team::rounds::{Proposal, View};

    const CELLS: usize = 42;
    const W: usize = words(21, 2);

    const fn whether(from: u16, value: u8) -> Sight {
        Sight { from: Cell(from), tells: Tells::Whether(value), right: 1.0 }
    }

    const ENDS: [Place; 2] = [Place::new(Cell(0), 0), Place::new(Cell(20), 1)];
    const BESIDE_ENDS: [Sight; 5] =
        [whether(0, 0), whether(1, 0), whether(21, 0), whether(20, 1), whether(19, 1)];
    const SERVES: Unknown<'_> =
        Unknown { effect: Effect::Serves, cells: &ENDS, prior: &[0.5, 0.5], sights: &BESIDE_ENDS };

    const DOOR: [Place; 1] = [Place::new(Cell(5), 1)];
    const BESIDE_DOOR: [Sight; 3] = [whether(4, 1), whether(6, 1), whether(26, 1)];

    fn door(prior: &'static [f32]) -> Unknown<'static> {
        Unknown { effect: Effect::Blocks, cells: &DOOR, prior, sights: &BESIDE_DOOR }
    }

    /// The expected times, in eighths of a tick, of the plans that a robot in the middle of a
    /// corridor has to each of its ends, along which there is a way around the door on the left.
    fn times(row: &str, unknowns: &[Unknown<'_>]) -> [Option<Eighths>; 2] {
        let map = std::format!("{row}\n.........#.##########");
        let (starts, goals) = ([Cell(10)], [Cell(0), Cell(20)]);
        let mission = Mission::new(Map::<W>::drawn(&map).unwrap(), &starts, &goals);
        let mission = Mission { unknowns, need: Some(1), ..mission };
        mission.check::<CELLS>().unwrap();
        let proposal = Proposal { round: 0, view: View::full(1), walls: Vec::new() };
        let fact = Fact { anchor: starts[0], ..Fact::default() };
        let policies = Policies::<CELLS, W, 65, 256, 16>::of_round(&mission, &proposal, |_| Some(&fact));
        let policies = policies.unwrap();
        let plans = || policies.plans().iter().zip(policies.expected());
        goals.map(|goal| {
            let ends_there = |plan: &TeamPlan| plan.paths()[0].end(&mission.map) == goal;
            plans().filter(|(plan, _)| ends_there(plan)).map(|(_, time)| time.total()).min()
        })
    }

    const OPEN: &str = ".....................";

    #[test]
    fn a_team_decides_again_before_a_door_that_is_shut() {
        // To the right: 9 moves and 1 more, or 3 ticks and back: 19 moves where the door is open;
        // else 13, 3 ticks, and 8 around it.
        let right = 0.5 * 10.0 + 0.5 * (9.0 + 3.0 + 0.7 * 19.0 + 0.3 * (13.0 + 3.0 + 8.0));
        // To the left: 20.5 where the door is open. Else 4 moves and 3 ticks to the door, and 8 or,
        // when it reads there that it is the other end, 31 more.
        let left = 0.7 * 20.5 + 0.3 * (4.0 + 3.0 + 0.5 * 8.0 + 0.5 * 31.0);
        let eighths = |ticks: f32| (8.0 * ticks) as Eighths;
        let [to_the_left, to_the_right] = times(OPEN, &[SERVES, door(&[0.7, 0.3])]).map(Option::unwrap);
        assert!(to_the_left.abs_diff(eighths(left)) <= 1, "{to_the_left} {left}");
        assert!(to_the_right.abs_diff(eighths(right)) <= 1, "{to_the_right} {right}");
    }

    #[test]
    fn a_door_that_is_known_to_be_shut_costs_what_a_wall_does() {
        let wall = times(".....#...............", &[SERVES]);
        for prior in [&[0.002, 0.998], &[0.0001, 0.9999], &[0.0, 1.0]] {
            assert_eq!(times(OPEN, &[SERVES, door(prior)]), wall, "{prior:?}");
        }
        assert_eq!(times(OPEN, &[SERVES, door(&[0.999, 0.001])]), times(OPEN, &[SERVES]));
    }

    /// What a robot expects that stands beside a sign which is right so often.
    fn beside_a_sign(right: f32) -> Eighths {
        let sign = Sight { from: Cell(11), tells: Tells::Value, right };
        let sights: std::vec::Vec<_> = BESIDE_ENDS.into_iter().chain([sign]).collect();
        let [_, to_the_right] = times(OPEN, &[Unknown { sights: &sights, ..SERVES }]);
        to_the_right.unwrap()
    }

    #[test]
    fn a_sign_is_worth_less_the_more_often_it_is_wrong() {
        let [sure, good, poor, guess] = [1.0, 0.9, 0.8, 0.51].map(beside_a_sign);
        assert!(sure < good && good < poor && poor + 16 < guess, "{sure} {good} {poor} {guess}");
        let nothing = times(OPEN, &[SERVES])[1].unwrap();
        assert!(nothing - guess <= 2, "it tells next to nothing: {guess} {nothing}");
    }

    /// What is known of an unknown with this prior when a robot has read all that it can.
    fn known(prior: &[f32], told: &[u8]) -> Option<usize> {
        let map = Map::<W>::drawn("....................................").unwrap();
        let goals: std::vec::Vec<Cell> = (0..prior.len() as u16).map(Cell).collect();
        let cells: std::vec::Vec<Place> =
            (0..).map(|value| Place::new(Cell(value.into()), value)).take(goals.len()).collect();
        let unknown = Unknown { effect: Effect::Serves, cells: &cells, prior, sights: &[] };
        let starts = [Cell(30)];
        let mission = Mission { unknowns: &[unknown], need: Some(1), ..Mission::new(map, &starts, &goals) };
        let fact = Fact { anchor: starts[0], readings: up_to(told.iter().copied()), ..Fact::default() };
        let members = Members::new(View::full(1), |_| Some(&fact));
        let mut prospects = Prospects::<CELLS, W>::NONE;
        prospects.start(&mission, &members, 1);
        let is_open = prospects.open(&mission).next().is_some();
        let likeliest = prospects.likeliest();
        let here = [goals[likeliest]];
        (0..goals.len()).for_each(|_| prospects.make(&mission, &goals, &CellSet::EMPTY));
        let is_done = prospects.are_done(&mission, prospects.belief(), &here) == Certainty::Known;
        assert!(is_done || is_open, "{:?}", prospects.belief());
        (!is_open).then_some(likeliest)
    }

    #[test]
    fn what_one_robot_can_read_is_enough_to_know() {
        let mut told = [0xff; 8];
        told[7] = 0x0f; // all against all but the last value
        assert_eq!(known(&[1.0 / 16.0; 16], &told), Some(15));
        assert_eq!(known(&[0.97, 0.03], &[0x0f]), Some(1));
        assert_eq!(known(&[0.5, 0.5], &[0x0f]), Some(1));
        assert_eq!(known(&[0.5, 0.5], &[0x08]), None, "it reads on");
        assert_eq!(known(&[1.0 / 16.0; 16], &[0; 8]), None);
    }
}
