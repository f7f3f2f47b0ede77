//! What a robot has beside its tables.

use iibt_core::iibt::table::{Command, MAX_FACTORS, Percept, TableMessage};
use iibt_core::team::{Message, Peers};
use iibt_core::time::Instant;
use iibt_core::tree::{Halt, Status};

/// A leaf of the tree of a [`TableRobot`](crate::TableRobot).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TaskLeaf<L> {
    /// The aim with this number in the robot's role. As an inference node, it pursues the aim; as a
    /// condition, it holds when the aim is reached.
    Aim(u8),
    /// The fact with this number in the robot's role: a condition.
    Fact(u8),
    /// One of the robot's own [`Skills`].
    Own(L),
}

impl core::fmt::Display for TaskLeaf<u8> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Aim(number) => write!(f, "aim {number}"),
            Self::Fact(number) => write!(f, "fact {number}"),
            Self::Own(number) => write!(f, "skill {number}"),
        }
    }
}

/// What a robot has beside its tables: leaves and a part of the message of its own.
///
/// Nothing is needed but what the tree and the teammates ask for; `()` has no leaf and adds nothing
/// to the message. The methods for leaves are those of [`Leaves`](iibt_core::tree::Leaves), whose
/// contract they share.
#[doc(alias = "blackboard")]
pub trait Skills<H> {
    /// The names of the robot's own leaves.
    type Leaf;
    /// What the robot adds to its [`TableMessage`].
    type Message: Message;

    /// Reads what the tables do not know of: a battery, a button.
    fn sense(&mut self, hardware: &mut H, now: Instant) {
        let _ = (hardware, now);
    }

    /// Returns what to add to the announcement.
    fn message(&self) -> Self::Message;

    /// Returns whether a condition holds now.
    fn condition(&mut self, leaf: &Self::Leaf, turn: &Turn<'_, Self::Message>) -> bool {
        let _ = (leaf, turn);
        false
    }

    /// Starts an action, by default as it continues.
    fn on_start(&mut self, leaf: &Self::Leaf, turn: &mut Turn<'_, Self::Message>) -> Status {
        self.on_running(leaf, turn)
    }

    /// Continues an action.
    fn on_running(&mut self, leaf: &Self::Leaf, turn: &mut Turn<'_, Self::Message>) -> Status {
        let _ = (leaf, turn);
        Status::Failure
    }

    /// Stops an action. An operator that it has begun in this tick is not carried out.
    fn on_halted(&mut self, leaf: &Self::Leaf, turn: &mut Turn<'_, Self::Message>) -> Halt {
        let _ = (leaf, turn);
        Halt::Done
    }

    /// Goes on stopping an action.
    fn on_halting(&mut self, leaf: &Self::Leaf, turn: &mut Turn<'_, Self::Message>) -> Halt {
        let _ = (leaf, turn);
        Halt::Done
    }

    /// Returns the child that a [`Switch`](iibt_core::tree::Node::Switch) ticks.
    fn case(&mut self, leaf: &Self::Leaf, turn: &Turn<'_, Self::Message>) -> usize {
        let _ = (leaf, turn);
        usize::MAX
    }

    /// Drives what the tables do not know of: a lamp, a horn.
    fn act(&mut self, hardware: &mut H) {
        let _ = hardware;
    }
}

impl<H> Skills<H> for () {
    type Leaf = ();
    type Message = ();

    fn message(&self) {}
}

/// The skill of a robot that is done when it has pursued its aims one after the other: one leaf,
/// which succeeds as an action and then holds as a condition for good.
///
/// ```text
/// Fallback { Condition(Own(())), Sequence { Inference(Aim(0)), Inference(Aim(1)), Action(Own(())) } }
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Finished(bool);

impl<H> Skills<H> for Finished {
    type Leaf = ();
    type Message = ();

    fn condition(&mut self, (): &(), _: &Turn<'_, ()>) -> bool {
        self.0
    }

    fn on_running(&mut self, (): &(), _: &mut Turn<'_, ()>) -> Status {
        self.0 = true;
        Status::Success
    }

    fn message(&self) {}
}

/// One tick as the robot's own leaves see it.
pub struct Turn<'k, X> {
    /// The time of the tick.
    pub now: Instant,
    /// The teammates and what they have announced.
    pub peers: Peers<'k, TableMessage<X>>,
    /// What was sensed.
    pub percept: Percept,
    /// Whether the robot is sure of all its factors, and no operator is under way.
    pub is_settled: bool,
    pub(super) sure: [Option<u8>; MAX_FACTORS],
    pub(super) begun: Option<Command>,
}

impl<X> Turn<'_, X> {
    /// Returns the state that a hidden factor is in, where the robot is sure of it.
    #[must_use]
    pub fn sure(&self, factor: u8) -> Option<u8> {
        self.sure.get(usize::from(factor)).copied().flatten()
    }

    /// Begins an operator, towards a target if it has one.
    pub const fn begin(&mut self, operator: u8, target: Option<u8>) {
        self.begun = Some(Command { operator, target });
    }
}
