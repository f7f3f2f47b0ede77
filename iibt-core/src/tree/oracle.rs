//! BehaviorTree.CPP's rules in their own, recursive form, and random trees that must agree with them.

use super::{Leaves, MAX_DEPTH, Memory, Node, Status, Tree};
use crate::time::Instant;
use std::vec::Vec;

/// A node that keeps its children, its status and its place, as BehaviorTree.CPP's do.
struct Model {
    node: Node<u16>,
    children: Vec<Model>,
    status: Option<Status>,
    place: usize,
}

impl Model {
    /// Takes the first node and its descendants off a table.
    fn read(table: &mut impl Iterator<Item = Node<u16>>) -> Self {
        let node = table.next().unwrap();
        let children = (0..node.children().unwrap_or(0)).map(|_| Self::read(table)).collect();
        Self { node, children, status: None, place: 0 }
    }

    fn execute(&mut self, leaves: &mut Recorder) -> Status {
        let status = match self.node {
            Node::Sequence(_) => self.with_memory(Status::Failure, leaves),
            Node::Fallback(_) => self.with_memory(Status::Success, leaves),
            Node::ReactiveSequence(_) => self.reactive(Status::Failure, leaves),
            Node::ReactiveFallback(_) => self.reactive(Status::Success, leaves),
            Node::Inverter => self.inverter(leaves),
            Node::Condition(leaf) => leaves.condition(&leaf, NOW).into(),
            Node::Action(leaf) | Node::Inference(leaf) => match self.status {
                Some(Status::Running) => leaves.on_running(&leaf, NOW),
                _ => leaves.on_start(&leaf, NOW),
            },
        };
        self.status = Some(status);
        status
    }

    fn with_memory(&mut self, decisive: Status, leaves: &mut Recorder) -> Status {
        let mut last = decisive;
        while let Some(child) = self.children.get_mut(self.place) {
            last = child.execute(leaves);
            if last == Status::Running {
                return last;
            }
            if last == decisive {
                break;
            }
            self.place += 1;
        }
        self.reset(leaves);
        last
    }

    fn reactive(&mut self, decisive: Status, leaves: &mut Recorder) -> Status {
        let mut last = decisive;
        for index in 0..self.children.len() {
            last = self.children[index].execute(leaves);
            if last == Status::Running {
                let others = self.children.iter_mut().enumerate().filter(|(other, _)| *other != index);
                others.for_each(|(_, child)| child.interrupt(leaves));
                return last;
            }
            if last == decisive {
                break;
            }
        }
        self.reset(leaves);
        last
    }

    fn inverter(&mut self, leaves: &mut Recorder) -> Status {
        match self.children[0].execute(leaves) {
            Status::Running => Status::Running,
            status => {
                self.reset(leaves);
                (status == Status::Failure).into()
            }
        }
    }

    fn reset(&mut self, leaves: &mut Recorder) {
        self.place = 0;
        self.children.iter_mut().for_each(|child| child.interrupt(leaves));
    }

    fn interrupt(&mut self, leaves: &mut Recorder) {
        if self.status == Some(Status::Running) {
            if let Node::Action(leaf) | Node::Inference(leaf) = self.node {
                leaves.on_halted(&leaf, NOW);
            }
            self.reset(leaves);
        }
        self.status = None;
    }

    /// Whether each node is running, in preorder.
    fn running(&self) -> Vec<bool> {
        let below = self.children.iter().flat_map(Self::running);
        core::iter::once(self.status == Some(Status::Running)).chain(below).collect()
    }
}

const NOW: Instant = Instant(0);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Call {
    Condition,
    Start(Status),
    Resume(Status),
    Halt,
}

/// Leaves that answer at random and note each call.
#[derive(Clone)]
struct Recorder {
    random: Lcg,
    calls: Vec<(u16, Call)>,
}

impl Recorder {
    fn status(&mut self) -> Status {
        [Status::Running, Status::Success, Status::Failure][self.random.below(3)]
    }
}

impl Leaves<u16> for Recorder {
    fn condition(&mut self, leaf: &u16, _: Instant) -> bool {
        self.calls.push((*leaf, Call::Condition));
        self.random.below(2) == 0
    }

    fn on_start(&mut self, leaf: &u16, _: Instant) -> Status {
        let status = self.status();
        self.calls.push((*leaf, Call::Start(status)));
        status
    }

    fn on_running(&mut self, leaf: &u16, _: Instant) -> Status {
        let status = self.status();
        self.calls.push((*leaf, Call::Resume(status)));
        status
    }

    fn on_halted(&mut self, leaf: &u16, _: Instant) {
        self.calls.push((*leaf, Call::Halt));
    }
}

/// A linear congruential generator (Knuth's MMIX constants).
#[derive(Clone)]
struct Lcg(u64);

impl Lcg {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % bound
    }
}

/// Appends a random subtree of `size` nodes to `table`; a leaf is named by its row.
fn grow(table: &mut Vec<Node<u16>>, size: usize, random: &mut Lcg) {
    if size == 1 {
        let row = table.len() as u16;
        let leaves = [Node::Condition(row), Node::Action(row), Node::Action(row), Node::Inference(row)];
        return table.push(leaves[random.below(leaves.len())]);
    }
    if random.below(6) == 0 {
        table.push(Node::Inverter);
        return grow(table, size - 1, random);
    }
    let mut sizes = Vec::new();
    let mut rest = size - 1;
    while rest > 0 {
        sizes.push(1 + random.below(rest));
        rest -= sizes[sizes.len() - 1];
    }
    let count = sizes.len() as u8;
    let composites = [Node::Sequence, Node::Fallback, Node::ReactiveSequence, Node::ReactiveFallback];
    table.push(composites[random.below(composites.len())](count));
    sizes.into_iter().for_each(|size| grow(table, size, random));
}

fn random_tree<const N: usize>(random: &mut Lcg) -> ([Node<u16>; N], Tree<u16, N>) {
    let mut table = Vec::new();
    grow(&mut table, N, random);
    let table = table.try_into().unwrap();
    (table, Tree::try_new(table).unwrap())
}

/// Ticks random trees, now and then halting them, and compares every call with the model's.
fn agrees<const N: usize>(seed: u64) {
    let mut random = Lcg(seed);
    for _ in 0..200 {
        let (table, tree) = random_tree::<N>(&mut random);
        let mut model = Model::read(&mut table.into_iter());
        let mut memory = Memory::new();
        let mut ours = Recorder { random: random.clone(), calls: Vec::new() };
        let mut theirs = ours.clone();
        for tick in 0..60 {
            if random.below(12) == 0 {
                tree.halt(&mut memory, &mut ours, NOW);
                model.interrupt(&mut theirs);
            } else {
                let status = tree.tick(&mut memory, &mut ours, NOW);
                assert_eq!(status, model.execute(&mut theirs), "{table:?} tick {tick}");
            }
            assert_eq!(ours.calls, theirs.calls, "{table:?} tick {tick}");
            let running: Vec<bool> = (0..N as u16).map(|node| memory.is_running(node)).collect();
            assert_eq!(running, model.running(), "{table:?} tick {tick}");
            ours.calls.clear();
            theirs.calls.clear();
        }
    }
}

#[test]
fn random_trees_behave_as_in_behavior_tree_cpp() {
    agrees::<1>(1);
    agrees::<2>(2);
    agrees::<3>(3);
    agrees::<5>(5);
    agrees::<8>(8);
    agrees::<13>(13);
    agrees::<21>(21);
    agrees::<55>(55);
}

#[test]
fn every_start_has_one_end_and_no_leaf_is_called_twice_a_tick() {
    let mut random = Lcg(7);
    for _ in 0..500 {
        let (_, tree) = random_tree::<34>(&mut random);
        let mut memory = Memory::new();
        let mut leaves = Recorder { random: random.clone(), calls: Vec::new() };
        let mut running = [false; 34];
        for tick in 0..40 {
            match tick {
                39 => tree.halt(&mut memory, &mut leaves, NOW),
                _ => _ = tree.tick(&mut memory, &mut leaves, NOW),
            }
            let mut called = [false; 34];
            for (leaf, call) in leaves.calls.drain(..) {
                let leaf = usize::from(leaf);
                assert!(!core::mem::replace(&mut called[leaf], true), "leaf {leaf} is called twice");
                assert_eq!(running[leaf], matches!(call, Call::Resume(_) | Call::Halt), "leaf {leaf}");
                running[leaf] = matches!(call, Call::Start(Status::Running) | Call::Resume(Status::Running));
            }
        }
        assert_eq!(running, [false; 34]);
        assert!(memory.is_idle());
    }
}

#[test]
fn the_memory_of_another_tree_neither_panics_nor_loops() {
    let mut random = Lcg(11);
    for _ in 0..500 {
        let (_, one) = random_tree::<21>(&mut random);
        let (_, other) = random_tree::<21>(&mut random);
        let mut memory = Memory::new();
        let mut leaves = Recorder { random: random.clone(), calls: Vec::new() };
        for _ in 0..20 {
            one.tick(&mut memory, &mut leaves, NOW);
            leaves.calls.clear();
            other.tick(&mut memory, &mut leaves, NOW);
            let ticked = leaves.calls.iter().filter(|(_, call)| *call != Call::Halt).count();
            assert!(ticked <= 21);
            leaves.calls.clear();
        }
        other.halt(&mut memory, &mut leaves, NOW);
        assert!(memory.is_idle());
    }
}

#[test]
fn random_tables_are_trees_or_errors_and_trees_can_be_ticked() {
    let mut random = Lcg(13);
    let mut trees = 0;
    for _ in 0..20_000 {
        let table: [Node<u16>; 4] = core::array::from_fn(|row| match random.below(8) {
            0 => Node::Sequence(random.below(4) as u8),
            1 => Node::ReactiveFallback(random.below(4) as u8),
            2 => Node::Inverter,
            _ => Node::Action(row as u16),
        });
        match Tree::try_new(table) {
            Ok(tree) => {
                trees += 1;
                let mut leaves = Recorder { random: random.clone(), calls: Vec::new() };
                tree.tick(&mut Memory::new(), &mut leaves, NOW);
                assert!(!leaves.calls.is_empty());
            }
            Err(error) => assert!(usize::from(error.node) < table.len()),
        }
    }
    assert!(trees > 100, "only {trees} trees");
}

#[test]
fn the_deepest_tree_is_ticked_to_its_leaf() {
    let mut table = [Node::Inverter; MAX_DEPTH];
    table[MAX_DEPTH - 1] = Node::Condition(0);
    let tree = Tree::try_new(table).unwrap();
    let mut leaves = Recorder { random: Lcg(0), calls: Vec::new() };
    tree.tick(&mut Memory::new(), &mut leaves, NOW);
    assert_eq!(leaves.calls, [(0, Call::Condition)]);
}
