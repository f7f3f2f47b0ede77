//! One joint step by priorities: every robot takes the best neighbouring cell and pushes aside the
//! robot that stands there (PIBT; Okumura, Machida, Défago, Tamura 2022), without a ring.
//!
//! A step leads from one joint state to the next. It may have a robot follow on the heels of
//! another, for the first of the chain enters a cell that is empty. It has no two robots on one
//! cell and no *ring*: robots each of which enters the cell that the next one leaves, the last that
//! of the first. A ring of two is a swap, a longer one a rotation. No robot of a ring can begin.

use super::super::{Cell, Map};
use super::assignment::{NOWHERE, State};
use super::distances::{Distances, UNREACHED};

/// A joint step while it is being decided.
pub(super) struct Step<'a, const W: usize, const N: usize> {
    map: &'a Map<W>,
    distances: &'a [Distances<W>; N],
    from: &'a State<N>,
    to: State<N>,
    /// Breaks ties between cells equally near.
    seed: u32,
}

impl<'a, const W: usize, const N: usize> Step<'a, W, N> {
    /// A step from a joint state in which nothing is decided yet.
    pub(super) fn new(
        map: &'a Map<W>,
        distances: &'a [Distances<W>; N],
        from: &'a State<N>,
        seed: u32,
    ) -> Self {
        Self { map, distances, from, to: [NOWHERE; N], seed }
    }

    /// The cells that a robot can be on after the step: the free ones beside its own, and its own,
    /// which comes last. From a target that cannot be entered again there is no way but to stay.
    pub(super) fn moves(&self, robot: usize) -> impl Iterator<Item = Cell> + '_ {
        let at = self.at(robot);
        let stays = self.distance(robot, at) == 0 && !self.map.is_free(at);
        let beside = self.map.free_neighbours(at).map(|(_, next)| next);
        beside.take(if stays { 0 } else { 4 }).chain([at])
    }

    /// Binds a robot to be on a cell after the step; returns whether it can.
    #[inline(never)] // as for `choices`
    pub(super) fn bind(&mut self, robot: usize, cell: Cell) -> bool {
        let open = !self.is_taken(cell) && !self.closes_ring(robot, cell);
        if open {
            self.decide(robot, cell);
        }
        open
    }

    /// Decides for all the other robots in this order; `None` when one of them has no cell left.
    pub(super) fn complete(mut self, order: &[u8]) -> Option<State<N>> {
        for robot in order.iter().map(|&robot| robot.into()) {
            if self.next(robot) == NOWHERE && !self.place(robot) {
                return None;
            }
        }
        Some(self.to)
    }

    /// Finds a cell for a robot and for all that it pushes aside. If there is none, the robot
    /// stays, and the one that wanted its cell looks for another.
    ///
    /// It calls itself for the robot that is pushed: at most as deep as there are robots.
    fn place(&mut self, robot: usize) -> bool {
        for cell in self.choices(robot).into_iter().take_while(|&cell| cell != NOWHERE) {
            if !self.bind(robot, cell) {
                continue;
            }
            match self.occupant(cell).filter(|&other| self.next(other) == NOWHERE) {
                Some(pushed) if !self.place(pushed) => {}
                _ => return true,
            }
        }
        self.decide(robot, self.at(robot));
        false
    }

    /// The moves of a robot, the nearest to its target first; of equally near cells an empty one,
    /// and then as the seed has it. Past the last one they are [`NOWHERE`].
    #[inline(never)] // `place` is on the stack once for each robot
    fn choices(&self, robot: usize) -> [Cell; 5] {
        let mut choices = [(u32::MAX, NOWHERE); 5];
        for (slot, cell) in choices.iter_mut().zip(self.moves(robot)) {
            let occupied = self.occupant(cell).is_some_and(|other| other != robot);
            let tie = scramble(self.seed ^ u32::from(cell.0)) >> 17;
            let distance = u32::from(self.distance(robot, cell));
            *slot = (distance << 16 | u32::from(occupied) << 15 | tie, cell);
        }
        let mut before = None;
        core::array::from_fn(|_| {
            let open = choices.iter().filter(|choice| choice.1 != NOWHERE);
            let next = open.filter(|&choice| before.is_none_or(|before| choice > before)).min();
            before = next.or(before);
            next.map_or(NOWHERE, |&(_, cell)| cell)
        })
    }

    /// Whether the decided moves lead from a cell back to the robot that wants it: the robot that
    /// leaves the cell enters the cell of another one, and so on to the cell of the first.
    fn closes_ring(&self, robot: usize, cell: Cell) -> bool {
        leads_back(self.from, &self.to, robot, cell)
    }

    fn is_taken(&self, cell: Cell) -> bool {
        self.to.contains(&cell)
    }

    /// The robot on a cell before the step.
    fn occupant(&self, cell: Cell) -> Option<usize> {
        self.from.iter().position(|&at| at == cell)
    }

    fn at(&self, robot: usize) -> Cell {
        self.from.get(robot).copied().unwrap_or(NOWHERE)
    }

    fn next(&self, robot: usize) -> Cell {
        self.to.get(robot).copied().unwrap_or(NOWHERE)
    }

    fn decide(&mut self, robot: usize, cell: Cell) {
        if let Some(to) = self.to.get_mut(robot) {
            *to = cell;
        }
    }

    fn distance(&self, robot: usize, cell: Cell) -> u16 {
        self.distances.get(robot).map_or(UNREACHED, |distances| distances.from(cell))
    }
}

/// Whether a robot that enters a cell closes a ring with the moves from one state to another that
/// are decided.
pub(super) fn leads_back<const N: usize>(from: &State<N>, to: &State<N>, robot: usize, cell: Cell) -> bool {
    let leaver = |cell: &Cell| from.iter().position(|at| at == cell).filter(|_| *cell != NOWHERE);
    let onwards = |&other: &usize| leaver(to.get(other)?);
    from.get(robot) != Some(&cell)
        && core::iter::successors(leaver(&cell), onwards).take(N).any(|other| other == robot)
}

/// Thirty-two bits that look like chance and are the same on every machine (the finaliser of
/// MurmurHash3).
pub(super) const fn scramble(bits: u32) -> u32 {
    let bits = (bits ^ bits >> 16).wrapping_mul(0x85eb_ca6b);
    let bits = (bits ^ bits >> 13).wrapping_mul(0xc2b2_ae35);
    bits ^ bits >> 16
}
