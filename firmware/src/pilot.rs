//! The robot's behavior tree and the skills behind its leaves.

use iibt_core::iibt::{Navigation, Node};
use iibt_core::time::Instant;
use iibt_core::tree;
use iibt_core::tree::{Halt, Leaves, Status, Tree};

/// What the leaves of the tree stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Skill {
    BatteryEnough,
    Recharge,
    MoveToGoal,
}

/// How many nodes the tree has.
pub(crate) const NODES: usize = 5;

/// The tree of the paper's table 3: one inference node in the place of sixteen ordinary ones.
#[rustfmt::skip]
pub(crate) static TREE: Tree<Skill, NODES> = tree! {
    ReactiveSequence {
        Fallback {
            Condition(Skill::BatteryEnough),
            Action(Skill::Recharge),
        },
        Inference(Skill::MoveToGoal),
    }
};

/// What the action or inference node in row `node` of the tree does; `None` for the other nodes.
pub(crate) const fn activity(node: u16) -> Option<&'static str> {
    match node {
        3 => Some("Recharge"),
        4 => Some("MoveToGoal"),
        _ => None,
    }
}

/// The skills, and the state they share.
#[derive(Clone, Debug)]
pub(crate) struct Pilot<'m, const S: usize, const W: usize, const P: usize> {
    pub(crate) navigation: Navigation<'m, S, W, P>,
    pub(crate) node: Node,
    pub(crate) charge: u8,
    pub(crate) low_battery: u8,
    pub(crate) charged: u8,
}

impl<const S: usize, const W: usize, const P: usize> Pilot<'_, S, W, P> {
    /// The robot takes no part until its battery is charged, and drives to its charger if it has one.
    fn recharge(&mut self) -> Status {
        if self.charge >= self.charged {
            return Status::Success;
        }
        self.navigation.recharge();
        Status::Running
    }
}

impl<const S: usize, const W: usize, const P: usize> Leaves<Skill> for Pilot<'_, S, W, P> {
    fn condition(&mut self, leaf: &Skill, _: Instant) -> bool {
        *leaf == Skill::BatteryEnough && self.charge >= self.low_battery
    }

    fn on_start(&mut self, leaf: &Skill, now: Instant) -> Status {
        self.on_running(leaf, now)
    }

    fn on_running(&mut self, leaf: &Skill, now: Instant) -> Status {
        match leaf {
            Skill::MoveToGoal if self.navigation.step_aside() => Status::Running,
            Skill::MoveToGoal => self.node.tick(&mut self.navigation, now),
            Skill::Recharge => self.recharge(),
            Skill::BatteryEnough => Status::Failure,
        }
    }

    fn on_halted(&mut self, leaf: &Skill, _: Instant) -> Halt {
        match leaf {
            Skill::MoveToGoal => self.node.halt(&mut self.navigation),
            Skill::Recharge | Skill::BatteryEnough => {}
        }
        Halt::Done
    }
}
