//! Shorter joint plans out of long ones, in the memory of the search that found them.
//!
//! A depth-first search wanders, so its plans have detours. They are taken out in three kinds of
//! passes, in turn, until nothing changes. *Joining* goes from each joint state at once to the last
//! one that a single step leads to. *Holding* leaves a robot on a cell that it comes back to later,
//! if no other robot is there in the meantime. *Advancing* has a robot that waits make its next
//! move at once, if its next cell is empty until then. None of them makes a shared cell, a swap or
//! a rotation: a join is checked for them, a robot that holds still is in no ring, and no other
//! robot enters the cell on which one that advances would have waited.

use super::super::{Cell, Map};
use super::assignment::{NOWHERE, State};
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
    pass: Pass,
    changed: bool,
    passes: u8,
}

/// What is done to the states one after another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pass {
    Join,
    Hold,
    Advance,
}

impl Shortening {
    /// The shortening of the plan whose states are linked from this one on.
    pub(super) const fn new(first: u16) -> Self {
        Self { first, at: first, pass: Pass::Join, changed: false, passes: 0 }
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
        self.changed |= match self.pass {
            Pass::Join => join(nodes, map, self.at),
            Pass::Hold => hold(nodes, self.at),
            Pass::Advance => advance(nodes, self.at),
        };
        self.at = next(nodes, self.at);
        self.at != NONE || self.turn()
    }

    /// Begins at the first state again with what comes next; returns `false` when nothing does.
    fn turn(&mut self) -> bool {
        self.at = self.first;
        self.pass = match self.pass {
            Pass::Join => Pass::Hold,
            Pass::Hold => Pass::Advance,
            Pass::Advance => Pass::Join,
        };
        if self.pass != Pass::Join {
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

/// Has every robot that waits make its next move at once if it can; returns whether one does.
///
/// That closes no ring, for no other robot enters the cell on which it would have waited.
fn advance<const N: usize>(nodes: &mut [Node<N>], at: u16) -> bool {
    let mut changed = false;
    for (robot, home) in cells(nodes, at).into_iter().enumerate().filter(|&(_, home)| home != NOWHERE) {
        let cell_in = |state: u16| cells(nodes, state).get(robot).copied().unwrap_or(home);
        let Some(leaves) = later(nodes, at).find(|&state| cell_in(state) != home) else { continue };
        let to = cell_in(leaves);
        let waits = later(nodes, at).take_while(|&state| state != leaves);
        let is_taken = waits.map(|state| cells(nodes, state)).any(|cells| cells.contains(&to));
        changed |= !is_taken && hold_until(nodes, at, leaves, robot, to);
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

#[cfg(test)]
mod tests {
    use super::super::states::States;
    use super::*;
    use crate::grid::Map;
    use std::string::String;
    use std::vec::Vec;

    /// What is left of a plan that is drawn state by state, robots as letters from `a` on.
    #[track_caller]
    fn check(frames: &[&str], expected: &[&str]) {
        let width = frames[0].split(' ').next().unwrap().len();
        let rows = frames[0].split(' ').count();
        let map = Map::<1>::new(width as u16, rows as u16).unwrap();
        let mut states = States::<4, 16>::new();
        let mut last = NONE;
        for frame in frames {
            let signs = frame.replace(' ', "");
            let at = |letter| signs.find(letter).map_or(NOWHERE, |cell| Cell(cell as u16));
            last = states.add(['a', 'b', 'c', 'd'].map(at), [0; 4], last).unwrap();
        }
        let mut shortening = Shortening::new(states.turn_back(last));
        while shortening.work(states.nodes_mut(), &map) {}
        let first = states.node(shortening.first());
        let plan = core::iter::successors(first, |node| states.node(node.link));
        let shown: Vec<String> = plan.map(|node| picture(&node.cells, width, rows)).collect();
        assert_eq!(shown, expected, "{frames:?}");
    }

    fn picture(cells: &State<4>, width: usize, rows: usize) -> String {
        let mut signs = std::vec!['.'; width * rows];
        for (name, cell) in ('a'..).zip(cells).filter(|(_, cell)| **cell != NOWHERE) {
            signs[cell.index()] = name;
        }
        let rows: Vec<String> = signs.chunks(width).map(|row| row.iter().collect()).collect();
        rows.join(" ")
    }

    #[test]
    fn joins_states_that_are_a_step_apart() {
        check(&["a.. ...", "... a..", "... .a.", ".a. ...", "..a ..."], &["a.. ...", ".a. ...", "..a ..."]);
        check(&["a.b", "a.b", "ab.", "a.b", ".ab"], &["a.b", ".ab"]);
    }

    #[test]
    fn holds_a_robot_where_no_other_comes() {
        // No robot has asked robot a to make way.
        check(&["a.b. ....", "..b. a...", "...b a...", "a..b ...."], &["a.b. ....", "a..b ...."]);
        // Here b passes the cell, and a has to be away.
        let passing = ["ab ..", ".b a.", "b. a.", "b. .a", "ba .."];
        check(&passing, &["ab ..", "b. a.", "b. .a", "ba .."]);
    }

    #[test]
    fn advances_moves_that_wait_for_nothing() {
        check(
            &["a..b ....", ".a.b ....", "..ab ....", "..a. ...b", "..a. ..b."],
            &["a..b ....", ".a.. ...b", "..a. ..b."],
        );
    }

    #[test]
    fn makes_no_swap_and_no_rotation_of_many_steps() {
        // Both are one joint step apart from first to last, and the step cannot be made.
        let swap = ["ab. ...", "a.b ...", "..b a..", ".b. a..", "b.. a..", "b.. .a.", "ba. ..."];
        check(&swap, &["ab. ...", "b.. a..", "b.. .a.", "ba. ..."]);
        let rotation = [
            "ab. dc.", "a.b dc.", "a.b d.c", ".ab d.c", "dab ..c", "dab .c.", "dab c..", "da. c.b", "da. cb.",
        ];
        check(&rotation, &["ab. dc.", "dab c..", "da. c.b", "da. cb."]);
    }
}
