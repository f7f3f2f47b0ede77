//! A node of a behavior tree in four bytes.

use crate::TaskLeaf;
use iibt_core::tree::{Millis, Node, Status, Times};

/// The length of a node in bytes.
pub(super) const NODE: u32 = 4;

/// From this code on, a duration is in seconds.
const SECONDS: u32 = 1 << 23;

/// Returns a node as it is written: its kind, then what it holds in three bytes, filled with zeros.
/// `docs/page.md` has the kinds.
///
/// ```
/// use firmware::TaskLeaf;
/// use firmware::page::node_bytes;
/// use iibt_core::tree::{Millis, Node};
///
/// assert_eq!(node_bytes(&Node::Sequence(3)), [3, 3, 0, 0]);
/// assert_eq!(node_bytes(&Node::Condition(TaskLeaf::Fact(7))), [2, 1, 7, 0]);
/// assert_eq!(node_bytes(&Node::Sleep(Millis::new(1000))), [32, 0xe8, 3, 0]);
/// ```
#[must_use]
pub fn node_bytes(node: &Node<TaskLeaf<u8>>) -> [u8; NODE as usize] {
    match *node {
        Node::Action(leaf) => with_leaf(0, leaf, 0),
        Node::Inference(leaf) => with_leaf(1, leaf, 0),
        Node::Condition(leaf) => with_leaf(2, leaf, 0),
        Node::Sequence(children) => [3, children, 0, 0],
        Node::Fallback(children) => [4, children, 0, 0],
        Node::ReactiveSequence(children) => [5, children, 0, 0],
        Node::ReactiveFallback(children) => [6, children, 0, 0],
        Node::Inverter => [7, 0, 0, 0],
        Node::SequenceWithMemory(children) => [8, children, 0, 0],
        Node::AsyncSequence(children) => [9, children, 0, 0],
        Node::AsyncFallback(children) => [10, children, 0, 0],
        Node::Parallel { children, success_count, failure_count } => {
            [11, children, success_count as u8, failure_count as u8]
        }
        Node::ParallelAll { children, max_failures } => [12, children, max_failures as u8, 0],
        Node::IfThenElse(children) => [13, children, 0, 0],
        Node::WhileDoElse(children) => [14, children, 0, 0],
        Node::Switch(children, leaf) => {
            let [kind, leaf, number, _] = with_leaf(15, leaf, 0);
            [kind, children, leaf, number]
        }
        Node::PipelineSequence(children) => [16, children, 0, 0],
        Node::RoundRobin(children) => [17, children, 0, 0],
        Node::RecoveryNode(retries) => [18, retries, 0, 0],
        Node::ForceSuccess => [19, 0, 0, 0],
        Node::ForceFailure => [20, 0, 0, 0],
        Node::KeepRunningUntilFailure => [21, 0, 0, 0],
        Node::RetryUntilSuccessful(times) => with_number(22, times.get() as u32),
        Node::Repeat(times) => with_number(23, times.get() as u32),
        Node::Timeout(time) => with_number(24, duration_code(time)),
        Node::Delay(time) => with_number(25, duration_code(time)),
        Node::RunOnce { then_skip } => [26, then_skip.into(), 0, 0],
        Node::Precondition { condition, otherwise } => with_leaf(27, condition, otherwise as u8),
        Node::RateController(period) => with_number(28, duration_code(period)),
        Node::SubTree => [29, 0, 0, 0],
        Node::AlwaysSuccess => [30, 0, 0, 0],
        Node::AlwaysFailure => [31, 0, 0, 0],
        Node::Sleep(time) => with_number(32, duration_code(time)),
    }
}

const fn with_leaf(kind: u8, leaf: TaskLeaf<u8>, last: u8) -> [u8; 4] {
    match leaf {
        TaskLeaf::Aim(number) => [kind, 0, number, last],
        TaskLeaf::Fact(number) => [kind, 1, number, last],
        TaskLeaf::Own(number) => [kind, 2, number, last],
    }
}

const fn with_number(kind: u8, number: u32) -> [u8; 4] {
    let [a, b, c, _] = number.to_le_bytes();
    [kind, a, b, c]
}

const fn duration_code(time: Millis) -> u32 {
    let milliseconds = time.get();
    if milliseconds < SECONDS { milliseconds } else { SECONDS | (milliseconds / 1000) }
}

/// Returns the node that is written so, if one is.
pub(super) fn node_of(bytes: [u8; NODE as usize]) -> Option<Node<TaskLeaf<u8>>> {
    let [kind, a, b, c] = bytes;
    let leaf = || leaf_of(a, b);
    let times = || Times::new(i32::from_le_bytes([0, a, b, c]) >> 8);
    let time = || duration(u32::from_le_bytes([a, b, c, 0]));
    let node = match kind {
        0 => Node::Action(leaf()?),
        1 => Node::Inference(leaf()?),
        2 => Node::Condition(leaf()?),
        3 => Node::Sequence(a),
        4 => Node::Fallback(a),
        5 => Node::ReactiveSequence(a),
        6 => Node::ReactiveFallback(a),
        7 => Node::Inverter,
        8 => Node::SequenceWithMemory(a),
        9 => Node::AsyncSequence(a),
        10 => Node::AsyncFallback(a),
        11 => Node::Parallel { children: a, success_count: b as i8, failure_count: c as i8 },
        12 => Node::ParallelAll { children: a, max_failures: b as i8 },
        13 => Node::IfThenElse(a),
        14 => Node::WhileDoElse(a),
        15 => Node::Switch(a, leaf_of(b, c)?),
        16 => Node::PipelineSequence(a),
        17 => Node::RoundRobin(a),
        18 => Node::RecoveryNode(a),
        19 => Node::ForceSuccess,
        20 => Node::ForceFailure,
        21 => Node::KeepRunningUntilFailure,
        22 => Node::RetryUntilSuccessful(times()),
        23 => Node::Repeat(times()),
        24 => Node::Timeout(time()),
        25 => Node::Delay(time()),
        26 => Node::RunOnce { then_skip: a == 1 },
        27 => Node::Precondition { condition: leaf()?, otherwise: status(c)? },
        28 => Node::RateController(time()),
        29 => Node::SubTree,
        30 => Node::AlwaysSuccess,
        31 => Node::AlwaysFailure,
        32 => Node::Sleep(time()),
        _ => return None,
    };
    // Whatever does not come back as it was has a byte that means nothing.
    Some(node).filter(|node| node_bytes(node) == bytes)
}

const fn leaf_of(kind: u8, number: u8) -> Option<TaskLeaf<u8>> {
    match kind {
        0 => Some(TaskLeaf::Aim(number)),
        1 => Some(TaskLeaf::Fact(number)),
        2 => Some(TaskLeaf::Own(number)),
        _ => None,
    }
}

fn status(code: u8) -> Option<Status> {
    let all = [Status::Running, Status::Success, Status::Failure, Status::Skipped];
    all.into_iter().find(|status| *status as u8 == code)
}

const fn duration(code: u32) -> Millis {
    Millis::new(if code < SECONDS { code } else { (code - SECONDS).saturating_mul(1000) })
}
