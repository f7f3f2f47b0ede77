//! Ways to go on in worlds that a team cannot tell apart yet, and how long each takes in every one
//! of them.
//!
//! A way is a rule by which the team assumes one of the worlds that are still possible, goes to the
//! goals of that world, and assumes another one when it sees that it was wrong. How long that takes
//! comes from distance tables, one a world; robots do not get in each other's way there.

use super::mission::Mission;
use super::prospects::{Bits, LONGEST, NO_WAY, Prospects, Robots, bits, descending, of, worlds_of};
use super::unknown::{Effect, MAX_WORLDS};
use crate::bounded::up_to;
use crate::grid::{Cell, Map, Move};
use crate::inference::Eighths;
use crate::team::MAX_TEAM;
use heapless::Vec;

/// The ticks that another decision of the team takes.
pub(super) const ROUND: u16 = 3;

/// The ways to go on that are compared.
pub(super) const MOST_WAYS: usize = 8;

/// A rule by which a team assumes one of the worlds that are possible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// The one whose goals are nearest.
    Nearest,
    /// The likeliest one.
    Likeliest,
    /// The one whose goals are farthest.
    Farthest,
    /// This one, then the one whose goals are nearest.
    First(usize),
}

/// Robots on their way, in all worlds that they cannot yet tell apart.
#[derive(Clone, Debug)]
struct Leg {
    cells: Robots,
    ticks: u16,
    worlds: Bits,
}

impl<const S: usize, const W: usize> Prospects<S, W> {
    /// The ways on that are compared, each after another decision: their times.
    pub(super) fn ways(
        &self,
        mission: &Mission<'_, W>,
        robots: &[Cell],
    ) -> Vec<[Eighths; MAX_WORLDS], MOST_WAYS> {
        let later = |time: Eighths| (time + 8 * ROUND).min(8 * LONGEST);
        let times = |way| self.times(mission, robots, self.all(), way).map(later);
        let nearest = times(Way::Nearest);
        let nearest_first = self.assume(Way::Nearest, robots, self.all()).map(Way::First);
        let others = [Way::Likeliest, Way::Farthest].into_iter().chain(self.by_belief().map(Way::First));
        // The nearest world first, and then the nearest one, is one of those that are made already.
        let others = others.map(|way| if Some(way) == nearest_first { nearest } else { times(way) });
        up_to(core::iter::once(nearest).chain(others).take(MOST_WAYS - 1))
    }

    /// The time in each world that a way takes from where the robots are.
    pub(super) fn times(
        &self,
        mission: &Mission<'_, W>,
        robots: &[Cell],
        worlds: Bits,
        way: Way,
    ) -> [Eighths; MAX_WORLDS] {
        let mut times = [8 * LONGEST; MAX_WORLDS];
        let mut legs: Vec<Leg, MAX_WORLDS> =
            up_to([Leg { cells: up_to(robots.iter().copied()), ticks: 0, worlds }]);
        while let Some(leg) = legs.pop() {
            self.walk(mission, leg, way, &mut times, &mut legs);
        }
        times
    }

    /// Goes to the goals of the world that is assumed, as far as nothing speaks against it.
    fn walk(
        &self,
        mission: &Mission<'_, W>,
        mut leg: Leg,
        way: Way,
        times: &mut [Eighths; MAX_WORLDS],
        legs: &mut Vec<Leg, MAX_WORLDS>,
    ) {
        let Some(assumed) = self.assume(way, &leg.cells, leg.worlds) else { return };
        let only = 1 << assumed;
        let ticks = self.ticks_to(assumed, &leg.cells);
        let towards = self.towards(assumed, &leg);
        for _ in 0..ticks.min(LONGEST.saturating_sub(leg.ticks)) {
            if leg.worlds == only {
                break;
            }
            self.step(mission, assumed, &towards, &mut leg, legs);
        }
        let rest = if leg.worlds == only { self.ticks_to(assumed, &leg.cells) } else { 0 };
        let end = leg.ticks + rest;
        let is_done = |&world: &usize| world == assumed || self.is_done(world, &leg.cells);
        let done = bits(worlds_of(leg.worlds).filter(is_done));
        for world in worlds_of(done) {
            if let Some(time) = times.get_mut(world) {
                *time = 8 * end.min(LONGEST);
            }
        }
        part(legs, &leg, leg.worlds & !done);
    }

    /// The world to whose goals each robot goes: as many as needed to those of the assumed one, the
    /// nearest of them; each of the others to those of another world, the nearest that is left.
    fn towards(&self, assumed: usize, leg: &Leg) -> Vec<usize, MAX_TEAM, u8> {
        let mut towards: Vec<usize, MAX_TEAM, u8> = up_to(leg.cells.iter().map(|_| assumed));
        let rank = |place: usize, cell: Cell| {
            let key = (self.distance(assumed, cell), place);
            let others = leg.cells.iter().enumerate();
            others.filter(|&(other, &at)| (self.distance(assumed, at), other) < key).count()
        };
        let mut left = leg.worlds & !(1 << assumed);
        for (place, (&cell, world)) in leg.cells.iter().zip(&mut towards).enumerate() {
            if rank(place, cell) < self.need() {
                continue;
            }
            let nearest = worlds_of(left).min_by_key(|&other| self.distance(other, cell));
            if let Some(other) = nearest {
                *world = other;
                left &= !(1 << other);
            }
        }
        towards
    }

    /// One move of all robots towards the goals of their worlds, and what they see then.
    fn step(
        &self,
        mission: &Mission<'_, W>,
        assumed: usize,
        towards: &[usize],
        leg: &mut Leg,
        legs: &mut Vec<Leg, MAX_WORLDS>,
    ) {
        let before = leg.cells.clone();
        for (cell, &world) in leg.cells.iter_mut().zip(towards) {
            *cell = self.next(&mission.map, world, *cell);
        }
        for (number, unknown) in of(mission, Effect::Blocks) {
            for &cell in &leg.cells {
                let blocked = unknown.cells.iter().find(|place| place.cell == cell);
                let Some(place) = blocked else { continue };
                let shut = leg.worlds & self.having(number, place.value.into());
                part(legs, &Leg { cells: before.clone(), ..*leg }, shut);
                leg.worlds &= !shut;
            }
        }
        leg.ticks += 1;
        self.see(mission, assumed, leg, legs);
    }

    /// The next cell on a shortest way to the goals of a world.
    fn next(&self, map: &Map<W>, world: usize, cell: Cell) -> Cell {
        let distance = self.distance(world, cell);
        let is_nearer = |next: &Cell| distance != NO_WAY && self.distance(world, *next) < distance;
        Move::ALL.into_iter().map(|step| map.neighbour(cell, step)).find(is_nearer).unwrap_or(cell)
    }

    /// Parts the worlds by what is seen from where the robots are, once they are sure of it: those
    /// that look like the assumed one stay together.
    fn see(&self, mission: &Mission<'_, W>, assumed: usize, leg: &mut Leg, legs: &mut Vec<Leg, MAX_WORLDS>) {
        let cells = leg.cells.clone();
        for &cell in cells.iter().filter(|cell| self.has_sight(**cell)) {
            for (number, unknown) in (0..).zip(mission.unknowns) {
                for sight in unknown.sights.iter().filter(|sight| sight.from == cell) {
                    let mut unlike = leg.worlds & !self.alike(number, sight, assumed);
                    if unlike == 0 {
                        continue;
                    }
                    let Some(stay) = sight.stay(unknown.values()) else { continue };
                    leg.ticks += stay;
                    leg.worlds &= !unlike;
                    while let Some(other) = worlds_of(unlike).next() {
                        let alike = unlike & self.alike(number, sight, other);
                        part(legs, leg, alike);
                        unlike &= !alike;
                    }
                }
            }
        }
    }

    /// The world that a team assumes, of some: one that agrees with all that is known, if there is
    /// one.
    pub(super) fn assume(&self, way: Way, cells: &[Cell], worlds: Bits) -> Option<usize> {
        let believable = worlds & self.believable();
        let worlds = if believable == 0 { worlds } else { believable };
        let ticks = |world: usize| self.ticks_to(world, cells);
        let all = worlds_of(worlds);
        match way {
            Way::First(world) if worlds >> world & 1 == 1 => Some(world),
            Way::Nearest | Way::First(_) => all.min_by_key(|&world| ticks(world)),
            Way::Farthest => all.max_by_key(|&world| ticks(world)),
            Way::Likeliest => descending(worlds, |world| self.p(world)).next(),
        }
    }
}

/// Lets robots decide anew in some worlds, if there are any.
fn part(legs: &mut Vec<Leg, MAX_WORLDS>, leg: &Leg, worlds: Bits) {
    if worlds != 0 && leg.ticks < LONGEST {
        // There is room: each leg has worlds of its own.
        let _ = legs.push(Leg { cells: leg.cells.clone(), ticks: leg.ticks + ROUND, worlds });
    }
}
