//! What a team that does not know all of its mission can plan for: one world or another, or to look
//! first.

use super::mission::Mission;
use super::policies::TeamPlan;
use super::prospects::Prospects;
use super::targets::Targets;
use super::unknown::{Effect, Sight, Tells, Unknown};
use crate::bounded::up_to;
use crate::grid::joint::{Prefix, Target};
use crate::grid::{Cell, CellSet};
use crate::team::MAX_TEAM;
use heapless::Vec;

/// How many moves away the cell may be where robots wait for what another one reads.
const MIDDLE: u8 = 8;

/// What a plan is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Alternative {
    /// All that may be blocked is free, and every goal serves.
    Free,
    /// The world with this place among the worlds, the likeliest one first.
    World(usize),
    /// All that may be blocked is.
    Shut,
    /// The nearest robot reads this unknown first.
    Look(usize, Others),
    /// Each robot goes from one cell where it sees something to the next.
    Tours,
    /// Each robot goes where it sees something else.
    Spread,
}

/// What the others do while one robot looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Others {
    /// They wait where all worlds are near.
    Middle,
    /// They go on to the goals of the likeliest world.
    GoOn,
    Stand,
}

/// The alternatives in the order of a list: one that is cut short has those that matter most.
#[derive(Clone, Debug)]
pub(super) struct Alternatives {
    current: Alternative,
    /// Whether it is worth it to look.
    may_look: bool,
}

impl Alternatives {
    pub(super) const NONE: Self = Self { current: Alternative::Free, may_look: false };

    pub(super) const fn new(may_look: bool) -> Self {
        Self { current: Alternative::Free, may_look }
    }

    pub(super) const fn current(&self) -> Alternative {
        self.current
    }

    /// Turns to the next one; returns whether there is one, with so many unknowns and worlds.
    pub(super) fn go_on(&mut self, unknowns: usize, worlds: usize) -> bool {
        let world = |rank: usize| Some(Alternative::World(rank)).filter(|_| rank < worlds);
        let look = |unknown: usize| {
            let is_there = self.may_look && unknown < unknowns;
            Some(Alternative::Look(unknown, Others::Middle)).filter(|_| is_there)
        };
        let tours = || Some(Alternative::Tours).filter(|_| self.may_look);
        let next = match self.current {
            Alternative::Free => world(0),
            Alternative::World(0) => Some(Alternative::Shut),
            Alternative::Shut => look(0).or_else(|| world(1)),
            Alternative::Look(unknown, Others::Middle) => Some(Alternative::Look(unknown, Others::GoOn)),
            Alternative::Look(unknown, Others::GoOn) => Some(Alternative::Look(unknown, Others::Stand)),
            Alternative::Look(unknown, Others::Stand) => look(unknown + 1).or_else(tours),
            Alternative::Tours => Some(Alternative::Spread),
            Alternative::Spread => world(1),
            Alternative::World(rank) => world(rank + 1),
        };
        self.current = next.unwrap_or(self.current);
        next.is_some()
    }
}

/// How the plan for an alternative comes about.
#[derive(Clone, Debug)]
pub(super) enum Variant<const W: usize> {
    /// A planner makes it for these targets, with cells blocked beside those that are so in every
    /// world.
    Searched(Targets, CellSet<W>),
    /// It is there.
    Made(TeamPlan),
}

impl Targets {
    /// How the plan for an alternative comes about; `None` where there is nothing of the kind.
    pub(super) fn variant<const S: usize, const W: usize>(
        &self,
        mission: &Mission<'_, W>,
        prospects: &Prospects<S, W>,
        alternative: Alternative,
        closed: &CellSet<W>,
    ) -> Option<Variant<W>> {
        let in_world = |world| {
            Variant::Searched(
                self.clone().in_world(mission, prospects, world),
                prospects.closed(mission, world),
            )
        };
        match alternative {
            Alternative::Free => Some(Variant::Searched(self.clone(), CellSet::EMPTY)),
            Alternative::World(rank) => prospects.by_belief().nth(rank).map(in_world),
            Alternative::Shut => {
                let shut = prospects.doubtful();
                (!shut.is_empty()).then(|| Variant::Searched(self.clone(), *shut))
            }
            Alternative::Look(number, others) => {
                let (_, unknown) = prospects.open(mission).find(|&(open, _)| open == number)?;
                let closed = closed.union(prospects.doubtful());
                let (place, at) = self.look_out(mission, prospects, (number, unknown), &closed)?;
                self.looking(mission, prospects, (place, at), others, &closed)
            }
            Alternative::Tours => self.tours(mission, prospects, closed).map(Variant::Made),
            Alternative::Spread => self.spread(mission, prospects, closed),
        }
    }

    /// The robot that is nearest to where it reads an unknown, by its place, and that cell.
    fn look_out<const S: usize, const W: usize>(
        &self,
        mission: &Mission<'_, W>,
        prospects: &Prospects<S, W>,
        (number, unknown): (usize, &Unknown<'_>),
        closed: &CellSet<W>,
    ) -> Option<(usize, Cell)> {
        let is_open = |sight: &&Sight| match sight.tells {
            Tells::Value => true,
            Tells::Whether(value) => prospects.is_undecided((number, unknown), value.into()),
        };
        let tells_all = unknown.sights.iter().any(|sight| sight.tells == Tells::Value);
        let fits = |sight: &&Sight| !tells_all || sight.tells == Tells::Value;
        let cells = unknown.sights.iter().filter(is_open).filter(fits).map(|sight| sight.from);
        let nearest = |cell: Cell| {
            let mut distances = [u8::MAX; S];
            mission.map.distances(&[cell].into_iter().collect(), closed, &mut distances);
            let distance = |from: Cell| distances.get(from.index()).copied().unwrap_or(u8::MAX);
            let seekers = self.errands.iter().enumerate().filter(|(_, errand)| errand.target == Target::Any);
            let ways = seekers.map(|(place, errand)| (distance(errand.from), place, cell));
            ways.filter(|&(distance, ..)| distance < u8::MAX).min()
        };
        let in_reach = |(moves, ..): &(u8, usize, Cell)| *moves <= mission.decider().farthest_look();
        let (_, place, cell) = cells.filter_map(nearest).min().filter(in_reach)?;
        Some((place, cell))
    }

    /// One robot goes to a cell from where it sees something, the others do something else.
    fn looking<const S: usize, const W: usize>(
        &self,
        mission: &Mission<'_, W>,
        prospects: &Prospects<S, W>,
        (place, at): (usize, Cell),
        others: Others,
        closed: &CellSet<W>,
    ) -> Option<Variant<W>> {
        let mut targets = self.clone();
        targets.errands.get_mut(place)?.target = Target::Own(at);
        let way = Prefix::by(&targets.problem(mission, *closed), place as u8, at, 0)?;
        targets.prefix = up_to([way]);
        let rest = targets.seekers().len();
        match others {
            Others::Middle => {
                targets.goals = up_to(targets.middle(mission, prospects, at, closed).take(rest));
                targets.need = rest.min(targets.goals.len());
                Some(Variant::Searched(targets, *prospects.doubtful()))
            }
            Others::GoOn => {
                let world = prospects.likeliest();
                targets.need = targets.need.min(rest);
                let closed = prospects.closed(mission, world);
                Some(Variant::Searched(targets.in_world(mission, prospects, world), closed))
            }
            Others::Stand => {
                let waiting = targets.errands.iter_mut().filter(|errand| errand.target == Target::Any);
                waiting.for_each(|errand| errand.target = Target::Stand);
                targets.need = 0;
                Some(Variant::Searched(targets, *prospects.doubtful()))
            }
        }
    }

    /// The cells near the robots from which the goals are nearest in the mean over the worlds, the
    /// best one first.
    fn middle<const S: usize, const W: usize>(
        &self,
        mission: &Mission<'_, W>,
        prospects: &Prospects<S, W>,
        but: Cell,
        closed: &CellSet<W>,
    ) -> impl Iterator<Item = Cell> {
        let mut distances = [u8::MAX; S];
        let starts: CellSet<W> = self.seeking().iter().copied().collect();
        mission.map.distances(&starts, &closed.without(&starts), &mut distances);
        let mut near: CellSet<W> = CellSet::EMPTY;
        for (number, _) in (0..).zip(distances).filter(|&(_, distance)| distance <= MIDDLE) {
            near.insert(Cell(number));
        }
        near.remove(but);
        core::iter::from_fn(move || {
            let mean = |cell: Cell| prospects.mean_distance(cell);
            let best = near.iter().reduce(|best, cell| if mean(cell) < mean(best) { cell } else { best })?;
            near.remove(best);
            Some(best)
        })
    }

    /// As many robots as there are questions go each to where it is seen whether another value is
    /// the one: to goals that may serve, or to cells from where it is seen whether a way is open.
    fn spread<const S: usize, const W: usize>(
        &self,
        mission: &Mission<'_, W>,
        prospects: &Prospects<S, W>,
        closed: &CellSet<W>,
    ) -> Option<Variant<W>> {
        let mut targets = self.clone();
        let closed = closed.union(prospects.doubtful());
        let mut places: Vec<Cell, MAX_TEAM> = Vec::new();
        let serving = prospects.open(mission).find(|(_, unknown)| unknown.effect == Effect::Serves);
        if let Some((number, unknown)) = serving {
            let mut left: CellSet<W> = CellSet::EMPTY;
            let is_open = |&value: &usize| prospects.is_undecided((number, unknown), value);
            for value in prospects.by_value(number).filter(is_open) {
                let goal = unknown.cells_of(value as u8).find(|&cell| !closed.contains(cell));
                goal.iter().for_each(|&goal| _ = left.insert(goal));
            }
            let worth = |cell: Cell| {
                let value =
                    unknown.cells.iter().find(|place| place.cell == cell).map_or(0, |place| place.value);
                prospects.probability(number, value.into())
            };
            for seeker in self.seeking() {
                let mut distances = [u8::MAX; S];
                mission.map.distances(
                    &[seeker].into_iter().collect(),
                    &closed.without(&[seeker].into_iter().collect()),
                    &mut distances,
                );
                let rate = |cell: Cell| {
                    worth(cell) / (1.0 + f32::from(distances.get(cell.index()).copied().unwrap_or(u8::MAX)))
                };
                let best = left.iter().reduce(|best, cell| if rate(cell) > rate(best) { cell } else { best });
                let Some(best) = best else { break };
                left.remove(best);
                // There is room: one for each robot.
                let _ = places.push(best);
            }
        } else {
            for (number, unknown) in prospects.open(mission) {
                let look_out = self.look_out(mission, prospects, (number, unknown), &closed);
                let Some((_, cell)) = look_out else { continue };
                if !places.contains(&cell) {
                    // Those beyond the room are of no use: there are no more robots.
                    let _ = places.push(cell);
                }
            }
        }
        let seekers = targets.seekers().len();
        targets.goals = up_to(places.into_iter().take(seekers));
        targets.need = targets.goals.len();
        (targets.need > 1).then_some(Variant::Searched(targets, *prospects.doubtful()))
    }
}
