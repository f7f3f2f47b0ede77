//! The engine against the rules of every node in their own form, on random trees.

mod node;
mod random;
mod recorder;

use self::node::OracleNode;
use self::random::{Lcg, composite, decorator, grow};
use self::recorder::{Call, Recorder};
use super::{Basic, Full, Halt, Kinds, MAX_DEPTH, Node, NodeMemory, Row, Status, Times, TreeRef};
use crate::time::Instant;
use Status::{Failure, Running, Skipped, Success};
use std::vec::Vec;

fn rows(table: &[Node<u16>]) -> Vec<Row<u16>> {
    table.iter().map(|&node| Row::new(node)).collect()
}

/// Ticks random trees, now and then halting them, and compares every call with the model's.
fn agrees<K: Kinds>(size: usize, trees: usize, answers: &'static [Status], seed: u64) {
    let mut random = Lcg(seed);
    for _ in 0..trees {
        let mut table = Vec::new();
        grow(&mut table, size, K::FULL, &mut random);
        let mut rows = rows(&table);
        let tree = TreeRef::<u16, K>::try_new(&mut rows).unwrap();
        let most = tree.visits(&mut std::vec![(0, 0); table.len()]);
        let mut model = OracleNode::read(&mut table.iter().copied());
        let mut memory = std::vec![NodeMemory::<K>::NEW; table.len()];
        let (mut ours, mut theirs) = (Recorder::new(&random, answers), Recorder::new(&random, answers));
        let mut now = Instant(u32::MAX - 20);
        for tick in 0..60 {
            now = Instant(now.0.wrapping_add(random.below(3) as u32));
            ours.begin(now);
            theirs.begin(now);
            let name = std::format!("{table:?} tick {tick}");
            if random.below(12) == 0 {
                assert_eq!(tree.halt(&mut memory, &mut ours, now), Halt::Done);
                model.interrupt(&mut theirs);
            } else {
                let result = tree.tick(&mut memory, &mut ours, now);
                assert_eq!(result.status, model.execute(&mut theirs), "{name} {:?}", ours.calls);
                assert!(theirs.visits <= most, "{} visits of {most}: {name}", theirs.visits);
                assert!(result.next != super::Next::Now || result.status == Running, "{name}");
                if theirs.woken && result.status == Running {
                    assert_eq!(result.next, super::Next::Now, "{name}");
                }
                if result.status != Running {
                    model.interrupt(&mut theirs);
                }
            }
            assert_eq!(ours.calls, theirs.calls, "{name}");
            let running: Vec<bool> = memory.iter().map(NodeMemory::is_running).collect();
            assert_eq!(running, model.running(), "{name}");
        }
    }
}

const NEVER_SKIPPED: &[Status] = &[Running, Success, Failure];
const ANY: &[Status] = &[Running, Running, Success, Success, Failure, Failure, Skipped];

#[test]
fn random_basic_trees_follow_their_rules() {
    for size in [1, 2, 3, 5, 8, 13, 21, 55] {
        agrees::<Basic>(size, 200, NEVER_SKIPPED, size as u64);
    }
}

#[test]
fn random_trees_of_every_kind_follow_their_rules() {
    for size in [1, 2, 3, 4, 5, 6, 8, 13, 21, 55] {
        agrees::<Full>(size, 2000, ANY, size as u64);
    }
}

#[test]
fn every_start_has_one_end() {
    let mut random = Lcg(7);
    for _ in 0..500 {
        let mut table = Vec::new();
        grow(&mut table, 34, true, &mut random);
        let mut rows = rows(&table);
        let tree = TreeRef::<u16, Full>::try_new(&mut rows).unwrap();
        let mut memory = std::vec![NodeMemory::NEW; table.len()];
        let mut leaves = Recorder::new(&random, ANY);
        let mut running = std::vec![false; table.len()];
        for tick in 0..40 {
            match tick {
                39 => _ = tree.halt(&mut memory, &mut leaves, Instant(tick)),
                _ => _ = tree.tick(&mut memory, &mut leaves, Instant(tick)),
            }
            for (leaf, call) in leaves.calls.drain(..) {
                let leaf = usize::from(leaf);
                if matches!(call, Call::Condition | Call::Case) {
                    continue;
                }
                assert_eq!(running[leaf], matches!(call, Call::Resume(_) | Call::Halt), "leaf {leaf}");
                running[leaf] = matches!(call, Call::Start(Running) | Call::Resume(Running));
            }
        }
        assert!(running.iter().all(|running| !running));
        assert!(memory.iter().all(NodeMemory::is_idle));
    }
}

#[test]
fn the_memory_of_another_tree_neither_panics_nor_loops() {
    let mut random = Lcg(11);
    for _ in 0..500 {
        let mut tables = [Vec::new(), Vec::new()];
        for table in &mut tables {
            grow(table, 21, true, &mut random);
        }
        let mut all = tables.each_ref().map(|table| rows(table));
        let [one, other] = all.each_mut().map(|rows| TreeRef::<u16, Full>::try_new(rows).unwrap());
        let mut memory = std::vec![NodeMemory::NEW; 21];
        let mut leaves = Recorder::new(&random, ANY);
        for tick in 0..20 {
            one.tick(&mut memory, &mut leaves, Instant(tick));
            other.tick(&mut memory, &mut leaves, Instant(tick));
        }
        other.halt(&mut memory, &mut leaves, Instant(20));
        assert!(memory.iter().all(|cell| !cell.is_running()));
    }
}

#[test]
fn random_tables_are_trees_or_errors_and_trees_can_be_ticked() {
    let mut random = Lcg(13);
    let mut trees = 0;
    for _ in 0..60_000 {
        let size = 1 + random.below(6);
        let table: Vec<Node<u16>> = (0..size as u16)
            .map(|row| match random.below(4) {
                0 => composite(row, random.below(5) as u8, true, &mut random),
                1 => decorator(row, &mut random),
                _ => Node::Action(row),
            })
            .collect();
        let mut rows = rows(&table);
        match TreeRef::<u16, Full>::try_new(&mut rows) {
            Ok(tree) => {
                trees += 1;
                let mut leaves = Recorder::new(&random, ANY);
                let mut memory = std::vec![NodeMemory::NEW; size];
                for tick in 0..4 {
                    tree.tick_until_idle(&mut memory, &mut leaves, Instant(tick), 8);
                }
            }
            Err(error) => assert!(usize::from(error.node) < table.len()),
        }
    }
    assert!(trees > 1000, "only {trees} trees");
}

/// What the check says can never be ticked is never ticked, and the trees of which it says nothing
/// are.
#[test]
fn nodes_that_are_said_to_be_unreachable_are() {
    let mut random = Lcg(17);
    let mut dead = 0;
    for _ in 0..3000 {
        let mut table = Vec::new();
        grow(&mut table, 9, true, &mut random);
        let mut rows = rows(&table);
        let tree = TreeRef::<u16, Full>::try_new(&mut rows).unwrap();
        let Some(never) = tree.never_ticked(&mut [0; 32]) else { continue };
        dead += 1;
        let mut memory = std::vec![NodeMemory::NEW; table.len()];
        let mut leaves = Recorder::new(&random, ANY);
        for tick in 0..100 {
            tree.tick(&mut memory, &mut leaves, Instant(tick));
        }
        assert!(leaves.calls.iter().all(|(leaf, _)| *leaf != never), "{table:?}: {never}");
    }
    assert!(dead > 100, "only {dead} trees");
}

#[test]
fn the_deepest_tree_is_ticked_to_its_leaf() {
    let mut table = [Node::Repeat(Times::FOREVER); MAX_DEPTH];
    table[MAX_DEPTH - 1] = Node::Action(0);
    let mut rows = rows(&table);
    let tree = TreeRef::<u16, Full>::try_new(&mut rows).unwrap();
    let mut leaves = Recorder::new(&Lcg(0), &[Success]);
    let result = tree.tick_until_idle(&mut [NodeMemory::NEW; MAX_DEPTH], &mut leaves, Instant(0), 10);
    assert_eq!((result.status, leaves.calls.len()), (Running, 10));
}
