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

    /// Whether one of these cells is on what is left of a path.
    fn is_shut<const W: usize>(&self, map: &Map<W>, closed: &CellSet<W>) -> bool {
        let enters = |(_, path, made): (usize, &Path, u16)| {
            ahead(path, map, made).any(|(_, cell)| closed.contains(cell))
        };
        !closed.is_empty() && self.paths().any(enters)
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
            let way = self.to_its_end(mission, &rest);
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
        // There is room for one more than those.
        let _ = ways.push(self.to_its_end(mission, &later));
        let once = Outlook { until: 8 * look, readings: &readings, ways: &ways }.expected(belief);
        // What is seen later still can change how the team goes on as well.
        if let Some(way) = ways.last_mut() {
            *way = self.until_known(mission, &later, *way);
        }
        let total = Outlook { until: 8 * look, readings: &readings, ways: &ways }.expected(belief).total();
        ExpectedTime { epistemic: once.pragmatic.saturating_sub(total), ..once }
    }

    /// The time in each world if a plan is followed to its end, whatever is seen. Where a way is
    /// blocked, or it does not end on goals that serve, the team decides again; one that is there
    /// already stays for ever.
    fn to_its_end(&self, mission: &Mission<'_, W>, rest: &Rest<'_>) -> [Eighths; MAX_WORLDS] {
        let (end, now) = (rest.cells(&mission.map, u16::MAX), rest.cells(&mission.map, 0));
        let of = |is: &dyn Fn(usize) -> bool| bits(worlds_of(self.all()).filter(|&world| is(world)));
        let shut = of(&|world| rest.is_shut(&mission.map, &self.walls(mission, world)));
        let missed = of(&|world| !self.is_done(world, &end)) & !shut;
        let mut times = [8 * rest.ticks; MAX_WORLDS];
        for (worlds, from, ticks) in [(shut, &now, 0), (missed, &end, rest.ticks)] {
            if worlds == 0 {
                continue;
            }
            let stays = rest.done.own.is_some() && rest.is_at_its_end();
            let more = if stays {
                [8 * LONGEST; MAX_WORLDS]
            } else {
                self.times(mission, from, worlds, Way::Nearest)
            };
            for world in worlds_of(worlds) {
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
        mut times: [Eighths; MAX_WORLDS],
    ) -> [Eighths; MAX_WORLDS] {
        let mut alike = [self.all(); MAX_WORLDS];
        let mut left = self.all();
        for ticks in 0..=rest.ticks {
            let cells = rest.cells(&mission.map, ticks);
            for &cell in cells.iter().filter(|cell| self.has_sight(**cell)) {
                self.tell_apart(mission, cell, &mut alike);
            }
            let is_known = |&world: &usize| alike.get(world).is_some_and(|alike| *alike == 1 << world);
            for world in worlds_of(left).filter(is_known) {
                left &= !(1 << world);
                let anew = 8 * (ticks + ROUND + self.ticks_to(world, &cells)).min(LONGEST);
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

    /// Takes from the worlds that look like each one those that look otherwise from a cell.
    fn tell_apart(&self, mission: &Mission<'_, W>, cell: Cell, alike: &mut [Bits; MAX_WORLDS]) {
        for (number, unknown) in (0..).zip(mission.unknowns) {
            for sight in unknown.sights.iter().filter(|sight| sight.from == cell) {
                for (world, alike) in alike.iter_mut().enumerate() {
                    let looks_like = |&other: &usize| self.looks_like(number, sight, world, other);
                    *alike = bits(worlds_of(*alike).filter(looks_like));
                }
            }
        }
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
            for sight in here.filter(|sight| self.is_open(number, sight, belief)) {
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
        of(mission, Effect::Takes).filter(|&(number, _)| self.is_undecided_by(number, belief))
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
