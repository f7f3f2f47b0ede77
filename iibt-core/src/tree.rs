//! Behavior trees as flat constant tables: no heap, no recursion, bounded time.
//!
//! A tree is a table of nodes in preorder that lives in flash, eight bytes a node for leaf names of
//! up to two. What it remembers between two ticks is kept apart, in a [`Memory`], so that any
//! number of robots share one table. The nodes are those of BehaviorTree.CPP 4.10 and four of Nav2,
//! and mean the same; [`Node`] says what each does.
//!
//! | set | kinds of nodes | RAM a node |
//! |---|---|---|
//! | [`Basic`], the default | sequences and fallbacks, also reactive; inverters; leaves | 4 bytes |
//! | [`Full`] | every node, [`Status::Skipped`], halts over several ticks, deadlines | 8 bytes |
//! | [`Compat`] | as `Full`, following BehaviorTree.CPP also where it is peculiar | 8 bytes |
//! | [`compiled`] | the basic kinds as straight-line code | 1 byte for the whole tree |
//!
//! # A first tree
//! [`tree!`](crate::tree!) writes a tree as it nests. [`Leaves`] says what its leaves do. The
//! compiler checks the tree: one that breaks a [`TreeRule`] does not build.
//!
//! ```
//! use iibt_core::time::Instant;
//! use iibt_core::tree::{Halt, Leaves, Memory, Status, Tree};
//!
//! #[derive(Clone, Copy, Debug, PartialEq)]
//! enum Skill { BatteryEnough, Charge, Patrol }
//!
//! static GUARD: Tree<Skill, 5> = iibt_core::tree! {
//!     ReactiveSequence {
//!         Fallback { Condition(Skill::BatteryEnough), Action(Skill::Charge) },
//!         Action(Skill::Patrol),
//!     }
//! };
//!
//! struct Robot { battery: u8 }
//!
//! impl Leaves<Skill> for Robot {
//!     fn condition(&mut self, _: &Skill, _: Instant) -> bool { self.battery > 20 }
//!     fn on_start(&mut self, leaf: &Skill, now: Instant) -> Status { self.on_running(leaf, now) }
//!     fn on_running(&mut self, _: &Skill, _: Instant) -> Status { Status::Running }
//!     fn on_halted(&mut self, _: &Skill, _: Instant) -> Halt { /* stop the wheels */ Halt::Done }
//! }
//!
//! let mut robot = Robot { battery: 80 };
//! let mut memory = Memory::new();
//! assert_eq!(GUARD.tick(&mut memory, &mut robot, Instant(0)).status, Status::Running);
//! assert_eq!(GUARD.running(&memory), Some(&Skill::Patrol));
//! robot.battery = 10;
//! GUARD.tick(&mut memory, &mut robot, Instant(1));
//! assert_eq!(GUARD.running(&memory), Some(&Skill::Charge), "patrolling was halted");
//! ```
//!
//! # Blackboard
//! The blackboard is the caller's. Leaves are named by values of any type, mostly an enum. What
//! they share are the fields of the type that implements [`Leaves`], and their ports are the fields
//! of the leaf's own value:
//!
//! ```
//! # use iibt_core::time::Instant;
//! # use iibt_core::tree::{Halt, Leaves, Memory, Status, Tree};
//! #[derive(Clone, Copy)]
//! enum Skill { Charged { percent: u8 }, Charge { step: u8 } }
//!
//! static CHARGE: Tree<Skill, 3> = iibt_core::tree! {
//!     ReactiveFallback {
//!         Condition(Skill::Charged { percent: 90 }),
//!         Action(Skill::Charge { step: 25 }),
//!     }
//! };
//!
//! struct Blackboard { percent: u8 }
//!
//! impl Leaves<Skill> for Blackboard {
//!     fn condition(&mut self, leaf: &Skill, _: Instant) -> bool {
//!         matches!(leaf, Skill::Charged { percent } if self.percent >= *percent)
//!     }
//!     fn on_start(&mut self, leaf: &Skill, now: Instant) -> Status { self.on_running(leaf, now) }
//!     fn on_running(&mut self, leaf: &Skill, _: Instant) -> Status {
//!         if let Skill::Charge { step } = leaf { self.percent += step; }
//!         Status::Running
//!     }
//!     fn on_halted(&mut self, _: &Skill, _: Instant) -> Halt { Halt::Done }
//! }
//!
//! let (mut board, mut memory) = (Blackboard { percent: 50 }, Memory::new());
//! let mut statuses = [Status::Running; 3];
//! for (tick, status) in (0..).zip(&mut statuses) {
//!     *status = CHARGE.tick(&mut memory, &mut board, Instant(tick)).status;
//! }
//! assert_eq!(statuses, [Status::Running, Status::Running, Status::Success]);
//! assert_eq!(board.percent, 100);
//! ```
//!
//! # Ticks
//! [`Tree::tick`] makes exactly one pass. [`Tree::tick_until_idle`] goes on while a node yields, up
//! to a bound. Time is an argument, a wrapping counter of milliseconds. [`Tick::next`] says when
//! another tick can change something, so that a controller can sleep until then or until an
//! interrupt.
//!
//! A pass needs no stack that grows with the tree and visits at most [`Tree::visits`] nodes, which
//! is a constant: each once, but for loops whose child was running before (one round more) and a
//! recovery (as often as it retries). Loops yield after every other round, so `Repeat` without end
//! cannot hold a tick up. Each halt looks at each node below it once, and finding the deadline at
//! each node of the tree once.
//!
//! # Differences from BehaviorTree.CPP
//! | where | there | here |
//! |---|---|---|
//! | a halt of the tree | then halts every node again | halts each running action once |
//! | `Precondition` | not asked while its child runs | asked at every tick, halts the child |
//! | `tickOnce` | has no bound | [`Tree::tick_until_idle`] has one |
//! | a node skipped while running | runs until its parent resets it | is idle at once |
//! | a skipped `Repeat`, `RetryUntilSuccessful` | goes on counting | starts again |
//! | a skipped `Timeout`, `Delay` | goes on counting | starts again |
//! | `IfThenElse`, `WhileDoElse` with a skipped condition | an exception | skipped |
//! | `Timeout` | a thread halts the child when time is up | the tick that next visits it does |
//! | `RecoveryNode` whose recovery is skipped | fails and keeps its count | fails and forgets it |
//! | `RateController` | keeps its rate until a reset | keeps it below a `PipelineSequence` only |
//! | a node that yields in the last pass | wakes the tree in the next `tickOnce` | is ignored |
//! | wrong thresholds, children, parameters | exceptions at run time | build errors: [`TreeRule`] |
//!
//! [`Compat`] does as BehaviorTree.CPP in three points: a halt of the tree reaches idle actions
//! too, a `Precondition` is not asked while its child runs, and a `Timeout` halts its child in the
//! next tick, before anything else.

mod check;
pub mod compiled;
mod composites;
mod context;
mod counts;
mod deadline;
mod decorators;
mod halt;
mod kinds;
mod leaves;
mod log;
mod macros;
mod memory;
mod node;
mod owned;
mod row;
mod rules;
mod status;
mod table;
mod tick_log;
mod visit;
mod walk;

#[cfg(test)]
mod oracle;
#[cfg(test)]
mod script;

pub use check::{TreeError, TreeRule};
pub use compiled::Compiled;
pub use counts::NodeCounts;
pub use kinds::{Basic, Compat, Full, Kinds};
pub use leaves::Leaves;
pub use log::{Log, StatusChange};
pub use memory::{Memory, NodeMemory};
pub use node::{Millis, Node, Times};
pub use owned::OwnedTree;
pub use row::{MAX_DEPTH, MAX_NODES, Row};
pub use status::{Halt, Next, Status, Tick};
pub use table::{Tree, TreeRef};
pub use tick_log::{NodeChange, TickEntry, TickLog};
