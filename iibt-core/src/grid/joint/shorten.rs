//! Shorter joint plans out of long ones, in the memory of the search that found them.
//!
//! A depth-first search wanders, so a plan of its has detours. Two kinds are taken out in turn, until
//! nothing changes: *joining* goes from each joint state at once to the last one that a single step
//! leads to, and *holding* leaves a robot where it comes back to later, if nobody else is there in
//! the meantime. Neither makes a shared cell, a swap or a rotation: a join is checked for them, and
//! a robot that holds still is in no ring.

use super::super::{Cell, Map};
use super::owned::{NOWHERE, State};
use super::pibt::leads_back;
use super::states::{NONE, Node};

/// The most times that a plan is gone over.
const MOST_PASSES: u8 = 16;

/// How far the shortening of a plan has come.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shortening {
    first: u16,
    /// The state that is next; [`NONE`] at the end of a pass.
    at: u16,
    /// Whether robots hold in this pass; states are joined in the other ones.
    holds: bool,
    changed: bool,
    passes: u8,
}

impl Shortening {
    /// The shortening of the plan whose states are linked from this one on.
    pub(super) const fn new(first: u16) -> Self {
        Self { first, at: first, holds: false, changed: false, passes: 0 }
    }

    /// The state with which the plan begins.
    pub(super) const fn first(&self) -> u16 {
        self.first
    }

    /// Does one work unit; returns whether there is more to do.
    ///
    /// Cost: linear in the states that follow times the robots.
    pub(super) fn work<const W: usize, const N: usize>(
        &mut self,
        nodes: &mut [Node<N>],
        map: &Map<W>,
    ) -> bool {
        self.changed |= if self.holds { hold(nodes, self.at) } else { join(nodes, map, self.at) };
        self.at = next(nodes, self.at);
        self.at != NONE || self.turn()
    }

    /// Begins at the first state again with what comes next; returns `false` when nothing does.
    fn turn(&mut self) -> bool {
        self.at = self.first;
        self.holds = !self.holds;
        if self.holds {
            return true;
        }
        self.passes += 1;
        core::mem::take(&mut self.changed) && self.passes < MOST_PASSES
    }
}

/// Links a state to the last one to which one step leads; returns whether that made the plan
/// shorter.
fn join<const W: usize, const N: usize>(nodes: &mut [Node<N>], map: &Map<W>, at: u16) -> bool {
    let (here, before) = (cells(nodes, at), next(nodes, at));
    let again = later(nodes, at).filter(|&state| cells(nodes, state) == here).last();
    link(nodes, at, again.map_or(before, |state| next(nodes, state)));
    if let Some(far) = later(nodes, at).filter(|&state| is_step(map, &here, &cells(nodes, state))).last() {
        link(nodes, at, far);
    }
    next(nodes, at) != before
}

/// Leaves every robot where it is until the last time that it is there again before another robot
/// is; returns whether that changed anything.
fn hold<const N: usize>(nodes: &mut [Node<N>], at: u16) -> bool {
    let mut changed = false;
    for (robot, home) in cells(nodes, at).into_iter().enumerate().filter(|&(_, home)| home != NOWHERE) {
        let is_home = |state: &u16| cells(nodes, *state).get(robot) == Some(&home);
        let is_clear = |state: &u16| is_home(state) || !cells(nodes, *state).contains(&home);
        if let Some(back) = later(nodes, at).take_while(is_clear).filter(is_home).last() {
            changed |= hold_until(nodes, at, back, robot, home);
        }
    }
    changed
}

/// Leaves a robot on a cell between two states of the plan; returns whether that changed anything.
fn hold_until<const N: usize>(nodes: &mut [Node<N>], at: u16, back: u16, robot: usize, home: Cell) -> bool {
    let mut changed = false;
    let mut state = next(nodes, at);
    while let Some(node) = nodes.get_mut(usize::from(state)).filter(|_| state != back) {
        if let Some(cell) = node.cells.get_mut(robot) {
            changed |= core::mem::replace(cell, home) != home;
        }
        state = node.link;
    }
    changed
}

/// Whether one step of all robots leads from a joint state to another.
fn is_step<const W: usize, const N: usize>(map: &Map<W>, from: &State<N>, to: &State<N>) -> bool {
    let near = |(&from, &to): (&Cell, &Cell)| from == to || map.move_between(from, to).is_some();
    let ring = |(robot, &cell)| leads_back(from, to, robot, cell);
    from.iter().zip(to).all(near) && !to.iter().enumerate().any(ring)
}

/// The states after one, in the order of the plan.
fn later<const N: usize>(nodes: &[Node<N>], at: u16) -> impl Iterator<Item = u16> + '_ {
    core::iter::successors(Some(next(nodes, at)), |&state| Some(next(nodes, state)))
        .take_while(|&state| state != NONE)
}

fn next<const N: usize>(nodes: &[Node<N>], state: u16) -> u16 {
    nodes.get(usize::from(state)).map_or(NONE, |node| node.link)
}

fn link<const N: usize>(nodes: &mut [Node<N>], state: u16, to: u16) {
    if let Some(node) = nodes.get_mut(usize::from(state)) {
        node.link = to;
    }
}

fn cells<const N: usize>(nodes: &[Node<N>], state: u16) -> State<N> {
    nodes.get(usize::from(state)).map_or([NOWHERE; N], |node| node.cells)
}
