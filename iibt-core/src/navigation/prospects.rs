//! The worlds of a mission of which a team does not know all: how likely each is, and how far every
//! cell is from its goals.

use super::mission::Mission;
use super::policies::{HAS_UNKNOWNS, Members};
use super::readings::{AnnouncedReadings, LEAST_LIKELIHOOD, evidence};
use super::unknown::{Effect, MAX_UNKNOWNS, MAX_VALUES, MAX_WORLDS, Place, Sight, Tells, Unknown, worlds};
use crate::grid::{Cell, CellSet};
use crate::inference::Worlds;
use crate::team::{MAX_TEAM, RobotId};
use heapless::Vec;

/// The distance of a cell from which there is no way.
pub(super) const NO_WAY: u8 = u8::MAX;

/// The ticks that count where no way leads to the goals, and the most that a way on takes.
pub(super) const LONGEST: u16 = 96;

/// The probability above which a value counts as known: it is not worth another look. What one
/// robot reads is capped, so a value that was improbable beforehand is known from a lower one on.
const KNOWN: f32 = 0.995;

/// The probability from which on a team takes its work for done.
const DONE: f32 = 0.98;

/// How much of the probability that a robot's readings can give counts as all of it.
const AS_GOOD_AS: f32 = 0.999;

/// Some of the worlds, a bit for each.
pub(super) type Bits = u16;

/// The cells of robots.
pub(super) type Robots = Vec<Cell, MAX_TEAM, u8>;

/// The distance tables of a robot. One that can have no unknowns needs none.
const TABLES: usize = if HAS_UNKNOWNS { MAX_WORLDS } else { 0 };

/// The worlds of a mission as a team sees them in a round, on maps of up to `S` cells in `W` words.
#[derive(Clone, Debug)]
pub(super) struct Prospects<const S: usize, const W: usize> {
    worlds: Worlds<MAX_WORLDS>,
    /// The place of the first value of each unknown among those of all.
    first: [u8; MAX_UNKNOWNS],
    /// The worlds in which each value holds.
    having: [Bits; MAX_VALUES],
    belief: Vec<f32, MAX_WORLDS>,
    /// What each robot had told of its readings when the round began.
    told: [AnnouncedReadings; MAX_TEAM],
    /// The distance of each cell to the nearest goal of each world.
    distances: [[u8; S]; TABLES],
    /// How many of them are made.
    made: usize,
    /// On how many goals robots must end.
    need: usize,
    /// From where anything is seen of what is not known.
    sights: CellSet<W>,
    /// The cells that may be blocked.
    doubtful: CellSet<W>,
    /// The worlds that agree with all that is known; nothing where nothing can be unknown.
    believable: [Bits; HAS_UNKNOWNS as usize],
    /// Where members stand: a stranger does not come there before they leave.
    standing: CellSet<W>,
}

/// How certain something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Certainty {
    /// As good as certain.
    Known,
    Likely,
    Unlikely,
}

impl<const S: usize, const W: usize> Prospects<S, W> {
    /// Nothing is unknown.
    pub(super) const NONE: Self = Self {
        worlds: Worlds::NONE,
        first: [0; MAX_UNKNOWNS],
        having: [0; MAX_VALUES],
        belief: Vec::new(),
        told: [const { AnnouncedReadings::new() }; MAX_TEAM],
        // Zeros: a robot that is zeros but for a little is built in place, not on the stack.
        distances: [[0; S]; TABLES],
        made: 0,
        need: 0,
        sights: CellSet::EMPTY,
        doubtful: CellSet::EMPTY,
        believable: [0; HAS_UNKNOWNS as usize],
        standing: CellSet::EMPTY,
    };

    /// Starts over with the facts of a round.
    pub(super) fn start(&mut self, mission: &Mission<'_, W>, members: &Members<'_, W>, need: usize) {
        self.made = 0;
        self.need = need;
        // A mission with more worlds than there is room for is refused.
        self.worlds = worlds(mission.unknowns).unwrap_or(Worlds::NONE);
        self.find_values();
        self.told = core::array::from_fn(|_| AnnouncedReadings::new());
        for (robot, fact) in members.iter() {
            if let Some(slot) = self.told.get_mut(robot.index()) {
                slot.clone_from(&fact.readings);
            }
        }
        self.belief = self.worlds.belief(evidence(mission.unknowns, self.told.iter()));
        self.find_sights(mission);
        let believable = self.believable_by(mission, &self.belief);
        self.believable.fill(believable);
        self.standing = members.facts().map(|fact| fact.anchor).collect();
    }

    fn find_values(&mut self) {
        let mut places = self.having.iter_mut();
        let mut place = 0;
        for (unknown, first) in self.first.iter_mut().enumerate() {
            *first = place;
            for (value, having) in (0..self.worlds.values(unknown)).zip(&mut places) {
                let has = |&world: &usize| self.worlds.value(world, unknown) == value;
                *having = bits((0..self.worlds.len()).filter(has));
                place += 1;
            }
        }
    }

    fn find_sights(&mut self, mission: &Mission<'_, W>) {
        let (mut sights, mut doubtful) = (CellSet::EMPTY, CellSet::EMPTY);
        for (_, unknown) in self.open(mission) {
            unknown.sights.iter().for_each(|sight| _ = sights.insert(sight.from));
            if unknown.effect == Effect::Blocks {
                unknown.cells.iter().for_each(|place| _ = doubtful.insert(place.cell));
            }
        }
        (self.sights, self.doubtful) = (sights, doubtful);
    }

    /// The probability of each world.
    pub(super) fn belief(&self) -> &[f32] {
        &self.belief
    }

    /// The belief of a robot that may have read more since the round began.
    pub(super) fn belief_after(
        &self,
        mission: &Mission<'_, W>,
        robot: RobotId,
        now: &AnnouncedReadings,
    ) -> Vec<f32, MAX_WORLDS> {
        let of = |(other, told)| if other == robot.index() { now } else { told };
        self.worlds.belief(evidence(mission.unknowns, self.told.iter().enumerate().map(of)))
    }

    /// The number of distance tables that are still to be made.
    pub(super) fn to_make(&self) -> usize {
        self.belief.len() - self.made.min(self.belief.len())
    }

    /// Makes the next distance table, around the cells that are closed in every world.
    pub(super) fn make(&mut self, mission: &Mission<'_, W>, goals: &[Cell], closed: &CellSet<W>) {
        let world = self.made;
        let shut = closed.union(&self.walls(mission, world));
        let to = self.goals(mission, world, goals).collect();
        if let Some(table) = self.distances.get_mut(world) {
            mission.map.distances(&to, &shut, table);
        }
        self.made += 1;
    }

    /// Whether it is open if an unknown has a value.
    pub(super) fn is_undecided(&self, unknown: (usize, &Unknown<'_>), value: usize) -> bool {
        self.may_have(unknown, value, &self.belief) && self.is_undecided_by(unknown, &self.belief)
    }

    /// The worlds that agree with all that is known by a belief.
    fn believable_by(&self, mission: &Mission<'_, W>, belief: &[f32]) -> Bits {
        let mut worlds = bits(0..belief.len());
        for (number, unknown) in (0..).zip(mission.unknowns) {
            let known = self.known((number, unknown), belief);
            let agrees = |&world: &usize| {
                let value = self.value(world, number);
                known.map_or_else(|| self.may_have((number, unknown), value, belief), |known| value == known)
            };
            worlds = bits(worlds_of(worlds).filter(agrees));
        }
        worlds
    }

    /// The worlds that agree with all that is known.
    pub(super) fn believable(&self) -> Bits {
        self.believable.first().copied().unwrap_or(Bits::MAX)
    }

    /// The value of an unknown in a world.
    pub(super) fn value(&self, world: usize, unknown: usize) -> usize {
        let mut values = 0..self.worlds.values(unknown);
        values.find(|&value| self.having(unknown, value) >> world & 1 == 1).unwrap_or(0)
    }

    /// The worlds in which an unknown has a value.
    pub(super) fn having(&self, unknown: usize, value: usize) -> Bits {
        let first = self.first.get(unknown).map_or(usize::MAX, |&first| first.into());
        self.having.get(first.saturating_add(value)).copied().unwrap_or(0)
    }

    /// The worlds that look like one of them from a sight of an unknown.
    pub(super) fn alike(&self, unknown: usize, sight: &Sight, world: usize) -> Bits {
        match sight.tells {
            Tells::Value => self.having(unknown, self.value(world, unknown)),
            Tells::Whether(value) => {
                let has = self.having(unknown, value.into());
                if has >> world & 1 == 1 { has } else { !has }
            }
        }
    }

    /// The probability that an unknown has a value by a belief.
    fn probability_by(&self, belief: &[f32], unknown: usize, value: usize) -> f32 {
        worlds_of(self.having(unknown, value)).filter_map(|world| belief.get(world)).sum()
    }

    /// The probability of a world.
    pub(super) fn p(&self, world: usize) -> f32 {
        self.belief.get(world).copied().unwrap_or(0.0)
    }

    /// On how many goals robots must end.
    pub(super) const fn need(&self) -> usize {
        self.need
    }

    /// The probability that an unknown has a value.
    pub(super) fn probability(&self, unknown: usize, value: usize) -> f32 {
        self.probability_by(&self.belief, unknown, value)
    }

    /// The values of an unknown from the likeliest on, the first of equals first.
    pub(super) fn by_value(&self, unknown: usize) -> impl Iterator<Item = usize> + '_ {
        descending(bits(0..self.worlds.values(unknown)), move |value| self.probability(unknown, value))
    }

    /// The likeliest world, the first of equals.
    pub(super) fn likeliest(&self) -> usize {
        self.by_belief().next().unwrap_or(0)
    }

    /// The worlds from the likeliest on, the first of equals first.
    pub(super) fn by_belief(&self) -> impl Iterator<Item = usize> + '_ {
        descending(self.all(), |world| self.p(world))
    }

    /// The cells that may be blocked, by unknowns that are not known.
    pub(super) const fn doubtful(&self) -> &CellSet<W> {
        &self.doubtful
    }

    /// The unknowns that are not known, by their places in the mission.
    pub(super) fn open<'m>(
        &self,
        mission: &Mission<'m, W>,
    ) -> impl Iterator<Item = (usize, &'m Unknown<'m>)> {
        (0..).zip(mission.unknowns).filter(|&unknown| self.known(unknown, &self.belief).is_none())
    }

    /// The cells that are blocked in a world, of those that may be.
    pub(super) fn walls(&self, mission: &Mission<'_, W>, world: usize) -> CellSet<W> {
        self.cells(mission, Effect::Blocks, world)
    }

    /// The cells that no path is to lead to in a world: those that are blocked, and where strangers
    /// come to stand.
    pub(super) fn closed(&self, mission: &Mission<'_, W>, world: usize) -> CellSet<W> {
        self.walls(mission, world).union(&self.cells(mission, Effect::Takes, world).without(&self.standing))
    }

    /// The cells of all unknowns with an effect that belong to their values in a world.
    fn cells(&self, mission: &Mission<'_, W>, effect: Effect, world: usize) -> CellSet<W> {
        let of = of(mission, effect);
        of.flat_map(|(number, unknown)| unknown.cells_of(self.value(world, number) as u8)).collect()
    }

    /// Whether it is not known which goals serve.
    pub(super) fn has_doubtful_goals(&self, mission: &Mission<'_, W>) -> bool {
        self.open(mission).any(|(_, unknown)| unknown.effect != Effect::Blocks)
    }

    /// The goals that serve in a world, of these: not those that strangers take.
    pub(super) fn goals<'a>(
        &'a self,
        mission: &'a Mission<'_, W>,
        world: usize,
        goals: &'a [Cell],
    ) -> impl Iterator<Item = Cell> + Clone + 'a {
        let serves = move |&goal: &Cell| {
            (0..).zip(mission.unknowns).all(|(number, unknown)| {
                let value = self.value(world, number);
                let mut here = unknown.cells.iter().filter(|place| place.cell == goal);
                match unknown.effect {
                    Effect::Blocks => true,
                    Effect::Serves => here.all(|place| usize::from(place.value) == value),
                    Effect::Takes => here.all(|place| usize::from(place.value) != value),
                }
            })
        };
        goals.iter().copied().filter(serves)
    }

    /// The cells that are as good as certain to be blocked, of those that might not have been.
    pub(super) fn shut(&self, mission: &Mission<'_, W>) -> CellSet<W> {
        let known = (0..).zip(mission.unknowns).filter(|(_, unknown)| unknown.effect != Effect::Serves);
        let cells = known.flat_map(|unknown| {
            let value = self.known(unknown, &self.belief);
            value.into_iter().flat_map(move |value| unknown.1.cells_of(value as u8))
        });
        cells.collect::<CellSet<W>>().without(&self.standing)
    }

    /// The probability that a cell is blocked.
    pub(super) fn p_blocked(&self, mission: &Mission<'_, W>, cell: Cell) -> f32 {
        let here = may_block(mission).filter(|(_, place)| place.cell == cell);
        here.map(|(number, place)| self.probability(number, place.value.into())).sum()
    }

    /// The cells that are blocked with at least this probability.
    pub(super) fn blocked(&self, mission: &Mission<'_, W>, belief: &[f32], least: f32) -> CellSet<W> {
        let p = |number, place: &Place| self.probability_by(belief, number, place.value.into());
        let blocked = may_block(mission).filter(|(number, place)| p(*number, place) >= least);
        blocked.map(|(_, place)| place.cell).collect()
    }

    /// Whether something can still be learnt from a cell.
    pub(super) const fn has_sight(&self, from: Cell) -> bool {
        self.sights.contains(from)
    }

    /// Whether a reading from a cell can tell something.
    pub(super) fn is_informative(&self, mission: &Mission<'_, W>, from: Cell, belief: &[f32]) -> bool {
        (0..).zip(mission.unknowns).any(|(number, unknown)| {
            let mut sights = unknown.sights.iter().filter(|sight| sight.from == from);
            sights.any(|sight| self.is_open((number, unknown), sight, belief))
        })
    }

    /// Whether what a sight tells is not known.
    pub(super) fn is_open(&self, unknown: (usize, &Unknown<'_>), sight: &Sight, belief: &[f32]) -> bool {
        let is_of_interest = match sight.tells {
            Tells::Value => true,
            Tells::Whether(value) => self.may_have(unknown, value.into(), belief),
        };
        is_of_interest && self.is_undecided_by(unknown, belief)
    }

    /// Whether the value of an unknown is open by a belief.
    pub(super) fn is_undecided_by(&self, unknown: (usize, &Unknown<'_>), belief: &[f32]) -> bool {
        self.known(unknown, belief).is_none()
    }

    /// The value of an unknown, if it is known by a belief.
    fn known(&self, (number, unknown): (usize, &Unknown<'_>), belief: &[f32]) -> Option<usize> {
        (0..).zip(unknown.prior).find_map(|(value, &prior)| {
            let surest = prior / (prior + LEAST_LIKELIHOOD * (1.0 - prior));
            let p = self.probability_by(belief, number, value);
            (p >= (AS_GOOD_AS * surest).clamp(0.5, KNOWN)).then_some(value)
        })
    }

    /// Whether an unknown is not known by a belief not to have a value.
    fn may_have(&self, (number, unknown): (usize, &Unknown<'_>), value: usize, belief: &[f32]) -> bool {
        let prior = unknown.prior.get(value).copied().unwrap_or(0.0);
        let left = LEAST_LIKELIHOOD * prior;
        let least = left / (left + 1.0 - prior);
        self.probability_by(belief, number, value) > (1.0 - KNOWN).max(least / AS_GOOD_AS)
    }

    /// The worlds that are possible.
    pub(super) fn all(&self) -> Bits {
        bits((0..self.belief.len()).filter(|&world| self.p(world) > 0.0))
    }

    pub(super) fn distance(&self, world: usize, cell: Cell) -> u8 {
        self.distances.get(world).and_then(|table| table.get(cell.index())).copied().unwrap_or(NO_WAY)
    }

    /// The expected number of moves from a cell to the nearest goal.
    pub(super) fn mean_distance(&self, cell: Cell) -> f32 {
        let worlds = self.belief.iter().enumerate();
        worlds.map(|(world, p)| p * f32::from(self.distance(world, cell))).sum()
    }

    /// The ticks until as many robots as needed are on the goals of a world: those that are
    /// nearest, the first of them on the farthest cell where goals lie behind each other.
    pub(super) fn ticks_to(&self, world: usize, cells: &[Cell]) -> u16 {
        let mut sorted = [NO_WAY; MAX_TEAM];
        let need = self.need.min(cells.len());
        let needed = sorted.get_mut(..need).unwrap_or_default();
        for &cell in cells {
            let mut distance = self.distance(world, cell);
            for slot in &mut *needed {
                if distance < *slot {
                    core::mem::swap(slot, &mut distance);
                }
            }
        }
        if needed.iter().all(|&distance| distance == 0) {
            return 0;
        }
        let each = needed.iter().zip((0..need as u16).rev());
        let ticks = each.map(|(&distance, behind)| u16::from(distance) + behind).max().unwrap_or(0);
        ticks.min(LONGEST)
    }

    /// Whether as many robots as needed are on goals of a world.
    pub(super) fn is_done(&self, world: usize, cells: &[Cell]) -> bool {
        let on_goals = cells.iter().filter(|&&cell| self.distance(world, cell) == 0).count();
        on_goals >= self.need.min(cells.len())
    }

    /// Whether a cell is a goal that might have served, but is known not to.
    pub(super) fn is_in_vain(&self, mission: &Mission<'_, W>, belief: &[f32], cell: Cell) -> bool {
        let serves = bits((0..belief.len()).filter(|&world| self.distance(world, cell) == 0));
        serves != 0 && serves & self.believable_by(mission, belief) == 0
    }

    /// How certain it is that as many robots as needed are on goals that serve.
    pub(super) fn are_done(&self, mission: &Mission<'_, W>, belief: &[f32], cells: &[Cell]) -> Certainty {
        let done = bits((0..belief.len()).filter(|&world| self.is_done(world, cells)));
        let p: f32 = worlds_of(done).filter_map(|world| belief.get(world)).sum();
        let is_known = || self.believable_by(mission, belief) & !done == 0;
        match p {
            DONE.. => Certainty::Known,
            0.5.. if is_known() => Certainty::Known,
            0.5.. => Certainty::Likely,
            _ => Certainty::Unlikely,
        }
    }
}

/// The cells that may be blocked, or taken by strangers, with their unknowns.
fn may_block<'m, const W: usize>(mission: &Mission<'m, W>) -> impl Iterator<Item = (usize, &'m Place)> {
    let unknowns = (0..).zip(mission.unknowns).filter(|(_, unknown)| unknown.effect != Effect::Serves);
    unknowns.flat_map(|(number, unknown)| unknown.cells.iter().map(move |place| (number, place)))
}

/// The unknowns with an effect, by their places in the mission.
pub(super) fn of<'m, const W: usize>(
    mission: &Mission<'m, W>,
    effect: Effect,
) -> impl Iterator<Item = (usize, &'m Unknown<'m>)> {
    (0..).zip(mission.unknowns).filter(move |(_, unknown)| unknown.effect == effect)
}

/// Some of the worlds, or values, from the likeliest on, the first of equals first.
pub(super) fn descending(mut left: Bits, p: impl Fn(usize) -> f32) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let next = worlds_of(left).reduce(|best, other| if p(other) > p(best) { other } else { best })?;
        left &= !(1 << next);
        Some(next)
    })
}

pub(super) fn bits(worlds: impl Iterator<Item = usize>) -> Bits {
    worlds.fold(0, |all, world| all | 1 << world)
}

pub(super) fn worlds_of(bits: Bits) -> impl Iterator<Item = usize> + Clone {
    (0..MAX_WORLDS).filter(move |world| bits >> world & 1 == 1)
}
