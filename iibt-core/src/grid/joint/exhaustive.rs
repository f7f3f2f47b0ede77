//! A search over all joint states of a small team, which finds every plan that there is.
//!
//! It goes breadth first from the targets back, one move of one robot at a time, so that every
//! joint move without a [ring](super::pibt) is a sequence of such moves. All joint states have a
//! number: the robots' places in mixed radix, where each counts the places that those before it
//! leave. Two bits a state are all that is kept, for a move changes the colour of one robot's cell:
//! whether a distance is odd can be seen from the cells, and of the rest one bit tells the
//! neighbours apart that are one move nearer from those one farther (compare Cooperman and
//! Finkelstein 1992). From the start the plan then follows the distances down. Of the moves that
//! lead nearer, it takes the one that can be made soonest, and makes it beside the others.
//!
//! Where the targets cannot be reached, that is proved.

use super::super::{Cell, CellSet, Map, Move, Path};
use super::assignment::{self, Answer, Assignment, NOWHERE};
use super::{Failure, JointPlan, Problem};

#[cfg(test)]
mod tests;

/// The bytes for marks that each node of the arena stands for.
const ROW: usize = 40;

const MARKS_A_BYTE: usize = 4;

/// How many marks of a table are looked at in one work unit.
const STRIDE: u32 = 64;

/// The mark of a state that was not met, and of one whose neighbours were not.
const UNSEEN: u8 = 0;
const EDGE: u8 = 3;

/// Plans for up to `N` robots of which each has a target, over at most `160 M` joint states.
///
/// No robot enters a cell in the step in which another leaves it. The moves are the fewest, the
/// steps not always.
///
/// It needs `40 M` bytes for the states, and 36 for the path of each robot.
#[derive(Clone, Debug)]
pub(super) struct Exhaustive<const W: usize, const N: usize, const M: usize> {
    marks: [[u8; ROW]; M],
    most_states: u32,
    /// The cells that robots can be on, and the robots that can move.
    places: CellSet<W>,
    movers: [u8; N],
    count: usize,
    states: u32,
    /// The number of the state in which the plan begins.
    start: u32,
    /// On how many black cells robots are at their targets, up to a multiple of two.
    end_colours: u32,
    plan: JointPlan<N>,
    stage: Stage<N>,
}

/// The places of the robots that can move.
type Places<const N: usize> = [u16; N];

/// What is to be done next. The first stage is all zeros, so that a new search is cleared memory.
#[derive(Clone, Copy, Debug)]
#[repr(u8)]
enum Stage<const N: usize> {
    /// Number the states.
    Begin,
    /// Go on from the edge at this distance; these states were looked at, and some were new.
    Spread { distance: u32, done: u32, grows: bool },
    /// Make the next move of the plan from here, at this distance.
    Walk { distance: u32, at: Places<N> },
}

impl<const W: usize, const N: usize, const M: usize> Exhaustive<W, N, M> {
    /// How many states the arena has room for.
    pub(super) const MOST_STATES: u32 = (MARKS_A_BYTE * ROW * M) as u32;

    /// An arena for problems of at most this many states, which are [`Failure::NotFound`]
    /// otherwise.
    pub(super) const fn new(most_states: u32) -> Self {
        Self {
            marks: [[0; ROW]; M],
            most_states,
            places: CellSet::EMPTY,
            movers: [0; N],
            count: 0,
            states: 0,
            start: 0,
            end_colours: 0,
            plan: JointPlan::NOBODY,
            stage: Stage::Begin,
        }
    }

    /// Begins with a problem of at most this many states.
    pub(super) const fn start_with(&mut self, most_states: u32) {
        self.most_states = most_states;
        self.stage = Stage::Begin;
    }

    /// Whether it searches fewer states than it has room for.
    pub(super) const fn is_limited(&self) -> bool {
        self.most_states < Self::MOST_STATES
    }

    /// Works on the plan as [`Lacam::work`](super::Lacam::work) does.
    ///
    /// A work unit is a state whose neighbours are looked at, 64 states without any, or a move.
    #[inline(never)] // one search at a time is on the stack
    pub(super) fn work(
        &mut self,
        problem: &Problem<'_, W>,
        targets: &[Cell; N],
        budget: &mut u32,
    ) -> Option<Answer<N>> {
        assignment::search(problem, targets, budget, |team| match self.stage {
            Stage::Begin => self.begin(team).err().map(Err),
            Stage::Spread { distance, done, grows } => self.spread(team, distance, done, grows).map(Err),
            Stage::Walk { distance: 0, .. } => Some(Ok(self.plan)),
            Stage::Walk { distance, at } => self.walk(team, distance, at).map(Err),
        })
    }

    /// Numbers the states and puts the edge around the targets.
    fn begin(&mut self, team: &Assignment<W, N>) -> Result<(), Failure> {
        self.number_places(team);
        self.states = self.count_states().ok_or(Failure::NotFound)?;
        self.marks.as_flattened_mut().fill(UNSEEN);
        self.plan.stand(team.from.iter().copied().take(team.robots));
        let start = self.places_of(&team.from).ok_or(Failure::NoWay)?;
        let end = self.places_of(&team.to).ok_or(Failure::NoWay)?;
        self.start = self.number(&start);
        self.set_mark(self.number(&end), EDGE);
        self.end_colours = self.colours(&team.map, &end);
        self.stage = if start == end {
            Stage::Walk { distance: 0, at: start }
        } else {
            Stage::Spread { distance: 0, done: 0, grows: false }
        };
        Ok(())
    }

    /// Finds the robots that move in any plan, and the cells that they can be on.
    fn number_places(&mut self, team: &Assignment<W, N>) {
        (self.places, self.count) = (team.map.free_cells(), 0);
        for (robot, (&from, &to)) in team.from.iter().zip(&team.to).enumerate().take(team.robots) {
            // A closed cell that a robot leaves it cannot enter again.
            let stays = from == to && !team.map.is_free(from);
            if let Some(slot) = self.movers.get_mut(self.count).filter(|_| !stays) {
                *slot = robot as u8;
                self.count += 1;
                self.places.insert(from);
            }
        }
    }

    /// How many states there are; `None` when the table has no room for them.
    fn count_states(&self) -> Option<u32> {
        let room = self.most_states.min(Self::MOST_STATES);
        let places = self.places.len() as u32;
        (0..self.count as u32).try_fold(1_u32, |product, robot| {
            product.checked_mul(places.checked_sub(robot)?).filter(|&product| product <= room)
        })
    }

    /// Looks for the next state of the edge and at its neighbours.
    fn spread(&mut self, team: &Assignment<W, N>, distance: u32, done: u32, grows: bool) -> Option<Failure> {
        let end = done.saturating_add(STRIDE).min(self.states);
        let edge = (done..end).find(|&state| self.mark(state) == EDGE);
        let grows = edge.is_some_and(|state| self.expand(team, distance, state)) || grows;
        if let Stage::Walk { .. } = self.stage {
            return None;
        }
        let done = edge.map_or(end, |state| state + 1);
        let is_layer_done = done >= self.states;
        self.stage = if is_layer_done {
            Stage::Spread { distance: distance + 1, done: 0, grows: false }
        } else {
            Stage::Spread { distance, done, grows }
        };
        (is_layer_done && !grows).then_some(Failure::Impossible)
    }

    /// Makes the neighbours of a state the edge of the next distance, if the state is of this one;
    /// returns whether any of them is new.
    fn expand(&mut self, team: &Assignment<W, N>, distance: u32, state: u32) -> bool {
        let at = self.state(state);
        if (self.colours(&team.map, &at) ^ self.end_colours ^ distance) & 1 == 1 {
            return false;
        }
        self.set_mark(state, mark_of(distance));
        let mut grows = false;
        for mover in 0..self.count {
            let (Some(&robot), Some(to)) = (self.movers.get(mover), self.cell_of(&at, mover)) else {
                continue;
            };
            let from = team.from.get(usize::from(robot)).copied().unwrap_or(NOWHERE);
            // A start that is closed can only be left.
            let start =
                Some(from).filter(|&from| !team.map.is_free(from) && team.map.manhattan(from, to) == 1);
            let before = team.map.free_neighbours(to).map(|(_, cell)| cell).chain(start);
            for cell in before.filter(|_| team.map.is_free(to)) {
                grows |= self.meet(distance, &at, mover, cell);
            }
        }
        grows
    }

    /// Puts a neighbour on the edge if it is new; returns whether it is.
    fn meet(&mut self, distance: u32, at: &Places<N>, mover: usize, cell: Cell) -> bool {
        let Some(next) = self.moved(at, mover, cell) else { return false };
        let number = self.number(&next);
        let is_new = self.mark(number) == UNSEEN;
        if is_new {
            self.set_mark(number, EDGE);
        }
        if number == self.start {
            self.stage = Stage::Walk { distance: distance + 1, at: next };
        }
        is_new
    }

    /// Makes the move that can be made soonest of those that lead nearer to the targets.
    fn walk(&mut self, team: &Assignment<W, N>, distance: u32, at: Places<N>) -> Option<Failure> {
        let mut best: Option<(usize, usize, Cell, Places<N>)> = None;
        for mover in 0..self.count {
            let Some(from) = self.cell_of(&at, mover) else { continue };
            for (_, to) in team.map.free_neighbours(from) {
                let Some(next) = self.moved(&at, mover, to) else { continue };
                if self.mark(self.number(&next)) == mark_of(distance - 1) {
                    let step = self.soonest(&team.map, mover, to);
                    if best.is_none_or(|(soonest, ..)| step < soonest) {
                        best = Some((step, mover, to, next));
                    }
                }
            }
        }
        let Some((step, mover, to, next)) = best else { return Some(Failure::NotFound) };
        self.stage = Stage::Walk { distance: distance - 1, at: next };
        self.add_move(&team.map, mover, step, to).is_none().then_some(Failure::NotFound)
    }

    /// The first step at whose end a robot can be on a cell, one after all that were there left it.
    fn soonest(&self, map: &Map<W>, mover: usize, cell: Cell) -> usize {
        let robot = self.movers.get(mover).map_or(N, |&robot| robot.into());
        let paths = self.plan.paths().iter().enumerate();
        let steps = paths.map(|(other, path)| {
            if other == robot {
                return path.len() + 1;
            }
            let there = path.cells(map).enumerate().filter(|&(_, at)| at == cell).last();
            there.map_or(0, |(step, _)| step + 2)
        });
        steps.max().unwrap_or(0)
    }

    /// Has a robot wait and be on a cell at the end of a step; `None` when its path is too long.
    fn add_move(&mut self, map: &Map<W>, mover: usize, step: usize, to: Cell) -> Option<()> {
        let robot = *self.movers.get(mover)?;
        let path: &mut Path = self.plan.paths_mut().get_mut(usize::from(robot))?;
        let way = map.move_between(path.end(map), to)?;
        while path.len() + 1 < step {
            path.push(Move::Wait).ok()?;
        }
        path.push(way).ok()
    }

    /// The places after a robot has gone to a cell; `None` when another one is there.
    fn moved(&self, at: &Places<N>, mover: usize, cell: Cell) -> Option<Places<N>> {
        let place = self.place(cell)?;
        let mut next = *at;
        *next.get_mut(mover)? = place;
        (!at.get(..self.count)?.contains(&place)).then_some(next)
    }

    /// The number of a state.
    fn number(&self, at: &Places<N>) -> u32 {
        let mut radix = self.places.len() as u32;
        let mut number: u32 = 0;
        for (mover, place) in at.iter().enumerate().take(self.count) {
            let before = at.iter().take(mover).filter(|&other| other < place).count();
            number = number.wrapping_mul(radix).wrapping_add(u32::from(*place)).wrapping_sub(before as u32);
            radix = radix.wrapping_sub(1);
        }
        number
    }

    /// The state with a number.
    fn state(&self, mut number: u32) -> Places<N> {
        let mut at = [0; N];
        let mut radix = (self.places.len() as u32).wrapping_sub(self.count as u32);
        for mover in (0..self.count).rev() {
            radix = radix.wrapping_add(1);
            let place = number.checked_rem(radix).unwrap_or(0) as u16;
            number = number.checked_div(radix).unwrap_or(0);
            let (first, later) = at.split_at_mut_checked(mover + 1).unwrap_or_default();
            later
                .iter_mut()
                .take(self.count - mover - 1)
                .for_each(|other| *other += u16::from(*other >= place));
            if let Some(last) = first.last_mut() {
                *last = place;
            }
        }
        at
    }

    /// The places of the robots that can move; `None` when one is on a cell that is none.
    fn places_of(&self, cells: &[Cell; N]) -> Option<Places<N>> {
        let mut at = [0; N];
        for (slot, &robot) in at.iter_mut().zip(&self.movers).take(self.count) {
            *slot = self.place(*cells.get(usize::from(robot))?)?;
        }
        Some(at)
    }

    fn place(&self, cell: Cell) -> Option<u16> {
        let before = self.places.intersection(&CellSet::first(cell.index()));
        self.places.contains(cell).then(|| before.len() as u16)
    }

    fn cell_of(&self, at: &Places<N>, mover: usize) -> Option<Cell> {
        self.places.iter().nth(usize::from(*at.get(mover)?))
    }

    /// On how many black cells robots are, up to a multiple of two.
    fn colours(&self, map: &Map<W>, at: &Places<N>) -> u32 {
        let cells = (0..self.count).filter_map(|mover| self.cell_of(at, mover));
        cells.map(|cell| u32::from(map.manhattan(cell, Cell(0)))).sum()
    }

    fn mark(&self, state: u32) -> u8 {
        let (index, shift) = slot(state);
        self.marks.as_flattened().get(index).map_or(UNSEEN, |byte| byte >> shift & 3)
    }

    fn set_mark(&mut self, state: u32, mark: u8) {
        let (index, shift) = slot(state);
        if let Some(byte) = self.marks.as_flattened_mut().get_mut(index) {
            *byte = *byte & !(3 << shift) | mark << shift;
        }
    }
}

/// The byte of a state's mark and the place in it.
const fn slot(state: u32) -> (usize, u32) {
    (state as usize / MARKS_A_BYTE, 2 * (state % MARKS_A_BYTE as u32))
}

/// The mark of the states at a distance: one of two for each pair of distances.
const fn mark_of(distance: u32) -> u8 {
    1 + (distance >> 1 & 1) as u8
}
