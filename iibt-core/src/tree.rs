//! Behavior trees as flat constant tables.
//!
//! A tree is a table of nodes in preorder that lives in flash. What it remembers between two ticks is kept
//! apart from it, two bytes a node, so that any number of robots share one table. The nodes are those
//! of BehaviorTree.CPP 4 and mean the same:
//!
//! | node | ticks its children | on an unfinished child |
//! |---|---|---|
//! | [`Sequence`](Node::Sequence) | until one fails | resumes at it |
//! | [`Fallback`](Node::Fallback) | until one succeeds | resumes at it |
//! | [`ReactiveSequence`](Node::ReactiveSequence) | until one fails | starts again from the first child |
//! | [`ReactiveFallback`](Node::ReactiveFallback) | until one succeeds | starts again from the first child |
//! | [`Inverter`](Node::Inverter) | its only one, exchanging success and failure | resumes at it |
//!
//! A reactive node that ends its tick at an earlier child than the one it left running halts the
//! latter. What the leaves do is the caller's: [`Leaves`] states when they are started, continued and halted.
//!
//! Cost: a tick visits each node at most once and needs no stack that grows with the tree; a halt
//! looks at each node below it once. The 21-node reference tree of four guarded actions takes about 450
//! instructions a tick on x86-64, leaves included.
//!
//! ```
//! use iibt_core::time::Instant;
//! use iibt_core::tree::{Halt, Leaves, Memory, Status, Tree};
//!
//! #[derive(Clone, Copy)]
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
//!     fn on_start(&mut self, skill: &Skill, now: Instant) -> Status { self.on_running(skill, now) }
//!     fn on_running(&mut self, _: &Skill, _: Instant) -> Status { Status::Running }
//!     fn on_halted(&mut self, _: &Skill, _: Instant) -> Halt { /* stop the wheels */ Halt::Done }
//! }
//!
//! let mut robot = Robot { battery: 80 };
//! let mut memory = Memory::new();
//! assert_eq!(GUARD.tick(&mut memory, &mut robot, Instant(0)).status, Status::Running);
//! assert!(memory.is_running(4), "it patrols");
//! robot.battery = 10;
//! GUARD.tick(&mut memory, &mut robot, Instant(1));
//! assert!(memory.is_running(3) && !memory.is_running(4), "it charges instead");
//! ```

mod census;
mod check;
mod composites;
mod deadline;
mod decorators;
mod full;
mod interrupt;
mod kinds;
mod leaves;
mod log;
mod macros;
mod memory;
mod node;
mod overdue;
mod table;
mod walk;

#[cfg(test)]
mod oracle;
#[cfg(test)]
mod script;

pub use census::Census;
pub use check::{Rule, TreeError};
pub use kinds::{Basic, Compat, Full, Kinds};
pub use leaves::{Halt, Leaves, Status};
pub use log::{Log, Transition};
pub use memory::{Cell, Memory};
pub use node::{Millis, Node, Times};
pub use table::{MAX_DEPTH, MAX_NODES, Next, Row, Tick, Tree, TreeRef};
