//! Two joint policies for robots on a small grid, found by a search over all of them at once.

use super::task::{Joint, List, Place, Places};
use iibt_core::team::RobotId;
use iibt_core::team::rounds::{Claim, JointPolicies, Proposal};
use std::cell::RefCell;
use std::collections::{HashMap, VecDeque};
use std::rc::Rc;

/// A grid of at most 16 places, and where each robot would like to be in each policy.
pub(super) struct Grid {
    pub(super) width: u8,
    pub(super) height: u8,
    targets: [Vec<u8>; 2],
    is_together: bool,
    lists: RefCell<HashMap<Problem, Rc<List>>>,
}

/// Members and their places, and where nobody may enter.
type Problem = (Vec<(RobotId, Places)>, Places);

impl Grid {
    pub(super) fn new(width: u8, height: u8, targets: [&[u8]; 2]) -> Self {
        let targets = targets.map(<[u8]>::to_vec);
        Self { width, height, targets, is_together: false, lists: RefCell::default() }
    }

    /// The same, with plans in which all make their last moves together, where they can.
    pub(super) fn together(self) -> Self {
        Self { is_together: true, ..self }
    }

    /// The list of a round, from its facts and walls alone.
    pub(super) fn list(&self, proposal: &Proposal<Places>, facts: &[(RobotId, Place)]) -> Rc<List> {
        let walls = proposal.walls.iter().fold(Places::EMPTY, |all, wall| all.union(wall));
        let problem = (facts.iter().map(|(robot, fact)| (*robot, fact.at)).collect(), walls);
        let mut lists = self.lists.borrow_mut();
        lists.entry(problem).or_insert_with_key(|problem| Rc::new(self.search_all(problem))).clone()
    }

    fn search_all(&self, problem: &Problem) -> List {
        List([0, 1].map(|policy| self.search(policy, problem)).to_vec())
    }

    /// The shortest conflict-free way to where the robots are nearest to their targets. A robot
    /// between two places stays.
    fn search(&self, policy: usize, (members, walls): &Problem) -> Joint {
        let start: Vec<Places> = members.iter().map(|(_, at)| *at).collect();
        let mut from: HashMap<Vec<Places>, Vec<Places>> = HashMap::from([(start.clone(), Vec::new())]);
        let mut queue = VecDeque::from([start.clone()]);
        let mut best = (self.distance(policy, members, &start), start);
        while let Some(state) = queue.pop_front() {
            for next in self.successors(&state, *walls) {
                if !from.contains_key(&next) {
                    let distance = self.distance(policy, members, &next);
                    if distance < best.0 {
                        best = (distance, next.clone());
                    }
                    from.insert(next.clone(), state.clone());
                    queue.push_back(next);
                }
            }
        }
        let mut steps = vec![best.1];
        while let Some(before) = from.get(&steps[steps.len() - 1]).filter(|before| !before.is_empty()) {
            steps.push(before.clone());
        }
        let mut paths = vec![Vec::new(); 8];
        for (column, (robot, _)) in members.iter().enumerate() {
            paths[robot.index()] = steps.iter().rev().map(|state| state[column]).collect();
        }
        let joint = Joint { paths, cost: 8, is_together: true };
        Joint { is_together: self.is_together && passes_barrier(&joint), ..joint }
    }

    fn distance(&self, policy: usize, members: &[(RobotId, Places)], state: &[Places]) -> u32 {
        let far = |a: u8, b: u8| {
            u32::from((a % self.width).abs_diff(b % self.width) + (a / self.width).abs_diff(b / self.width))
        };
        let apart = |((robot, _), at): (&(RobotId, Places), &Places)| {
            far(self.targets[policy][robot.index()], at.0.trailing_zeros() as u8)
        };
        members.iter().zip(state).map(apart).sum()
    }

    /// All joint steps in which no robot enters a wall, no two share a place or swap, and none go
    /// round in a circle.
    fn successors(&self, state: &[Places], walls: Places) -> Vec<Vec<Places>> {
        let mut all = vec![Vec::new()];
        for (index, &here) in state.iter().enumerate() {
            let mut longer = Vec::new();
            for prefix in &all {
                for next in self.steps(here, walls) {
                    let meets = |(other, &there): (usize, &Places)| {
                        there.overlaps(&next) || (state[other].overlaps(&next) && there.overlaps(&here))
                    };
                    if !prefix.iter().enumerate().any(meets) {
                        longer.push([&prefix[..], &[next]].concat());
                    }
                }
            }
            all = longer;
            debug_assert!(index < 4);
        }
        all.retain(|next| !go_round(state, next));
        all
    }

    fn steps(&self, here: Places, walls: Places) -> Vec<Places> {
        let mut steps = vec![here];
        if here.0.count_ones() == 1 {
            let (x, y) =
                (here.0.trailing_zeros() as u8 % self.width, here.0.trailing_zeros() as u8 / self.width);
            let near = [(x.wrapping_sub(1), y), (x + 1, y), (x, y.wrapping_sub(1)), (x, y + 1)];
            let inside = near.into_iter().filter(|&(x, y)| x < self.width && y < self.height);
            steps.extend(
                inside.map(|(x, y)| Places::at(y * self.width + x)).filter(|step| !step.overlaps(&walls)),
            );
        }
        steps
    }
}

/// Whether robots enter each other's places in a circle: each would wait for the next to leave.
fn go_round(before: &[Places], after: &[Places]) -> bool {
    let follows = |&robot: &usize| {
        let left = after[robot];
        before.iter().position(|&place| place == left).filter(|&other| other != robot)
    };
    (0..before.len()).any(|first| {
        let mut chain = std::iter::successors(Some(first), follows).skip(1).take(before.len());
        chain.any(|robot| robot == first)
    })
}

/// Whether all arrive that keep the order of a plan and wait for each other before their last
/// moves.
fn passes_barrier(joint: &Joint) -> bool {
    let list = List(vec![joint.clone()]);
    let robots: Vec<RobotId> = (0..joint.paths.len() as u8).map(RobotId).collect();
    let mut steps = vec![0_u16; robots.len()];
    let may_move = |robot: RobotId, steps: &[u16]| {
        let (step, moves) = (steps[robot.index()], list.moves(0, robot));
        let lets = |&mate: &RobotId| {
            let reported = steps[mate.index()];
            let is_ready = step + 1 < moves || reported + 1 >= list.moves(0, mate);
            mate == robot || (is_ready && list.is_clear(0, robot, step, mate, reported))
        };
        step < moves && robots.iter().all(lets)
    };
    while let Some(&robot) = robots.iter().find(|&&robot| may_move(robot, &steps)) {
        steps[robot.index()] += 1;
    }
    robots.iter().all(|&robot| steps[robot.index()] == list.moves(0, robot))
}
