//! The leaves of the tree in a tick.

use super::skills::{Skills, TaskLeaf, Turn};
use core::marker::PhantomData;
use iibt_core::iibt::table::{Percept, TableMessage, TableTask};
use iibt_core::iibt::{InferenceNode, Task};
use iibt_core::team::Peers;
use iibt_core::time::Instant;
use iibt_core::tree::{Halt, Leaves, Status};

/// What the leaves work with.
pub(super) struct Parts<K, T: Task> {
    pub(super) skills: K,
    pub(super) task: T,
    pub(super) node: InferenceNode<T>,
}

/// The leaves in a tick.
pub(super) struct Ticking<'r, 't, 'k, H, K: Skills<H>, const S: usize, const N: usize, const P: usize> {
    parts: &'r mut Parts<K, TableTask<'t, S, N, P, K::Message>>,
    turn: Turn<'k, K::Message>,
    hardware: PhantomData<fn(&mut H)>,
}

impl<'r, 't, 'k, H, K: Skills<H>, const S: usize, const N: usize, const P: usize>
    Ticking<'r, 't, 'k, H, K, S, N, P>
{
    pub(super) fn new(
        parts: &'r mut Parts<K, TableTask<'t, S, N, P, K::Message>>,
        percept: &Percept,
        peers: Peers<'k, TableMessage<K::Message>>,
        now: Instant,
    ) -> Self {
        let task = &mut parts.task;
        task.observe(percept, peers);
        let sure = core::array::from_fn(|factor| task.sure(factor).map(|state| state as u8));
        let turn = Turn { now, peers, percept: *percept, is_settled: task.is_settled(), sure, begun: None };
        Self { parts, turn, hardware: PhantomData }
    }

    fn pursue(&mut self, aim: u8) -> Status {
        let (Parts { task, node, .. }, Turn { percept, peers, now, .. }) = (&mut *self.parts, &self.turn);
        if task.pursue(aim) { node.tick(task, percept, *peers, *now) } else { Status::Failure }
    }

    /// Calls a skill, and takes up the operator that it begins.
    fn call<T>(&mut self, skill: impl FnOnce(&mut K, &mut Turn<'k, K::Message>) -> T) -> T {
        let result = skill(&mut self.parts.skills, &mut self.turn);
        if let Some(command) = self.turn.begun.take() {
            self.parts.task.begin(command);
        }
        result
    }
}

impl<H, K: Skills<H>, const S: usize, const N: usize, const P: usize> Leaves<TaskLeaf<K::Leaf>>
    for Ticking<'_, '_, '_, H, K, S, N, P>
{
    fn condition(&mut self, leaf: &TaskLeaf<K::Leaf>, _: Instant) -> bool {
        match leaf {
            TaskLeaf::Aim(aim) => self.parts.task.pursue(*aim) && self.parts.task.is_done(),
            TaskLeaf::Fact(fact) => {
                let task = &self.parts.task;
                task.logic(task.preference().target).is(*fact)
            }
            TaskLeaf::Own(own) => self.parts.skills.condition(own, &self.turn),
        }
    }

    fn on_start(&mut self, leaf: &TaskLeaf<K::Leaf>, now: Instant) -> Status {
        match leaf {
            TaskLeaf::Own(own) => self.call(|skills, turn| skills.on_start(own, turn)),
            _ => self.on_running(leaf, now),
        }
    }

    fn on_running(&mut self, leaf: &TaskLeaf<K::Leaf>, now: Instant) -> Status {
        match leaf {
            TaskLeaf::Aim(aim) => self.pursue(*aim),
            TaskLeaf::Fact(_) => Status::from(self.condition(leaf, now)),
            TaskLeaf::Own(own) => self.call(|skills, turn| skills.on_running(own, turn)),
        }
    }

    fn on_halted(&mut self, leaf: &TaskLeaf<K::Leaf>, _: Instant) -> Halt {
        match leaf {
            TaskLeaf::Own(own) => {
                self.parts.task.wait();
                self.call(|skills, turn| skills.on_halted(own, turn))
            }
            _ => {
                self.parts.node.halt(&mut self.parts.task);
                Halt::Done
            }
        }
    }

    fn on_halting(&mut self, leaf: &TaskLeaf<K::Leaf>, _: Instant) -> Halt {
        match leaf {
            TaskLeaf::Own(own) => self.call(|skills, turn| skills.on_halting(own, turn)),
            _ => Halt::Done,
        }
    }

    fn case(&mut self, leaf: &TaskLeaf<K::Leaf>, _: Instant) -> usize {
        match leaf {
            TaskLeaf::Own(own) => self.parts.skills.case(own, &self.turn),
            _ => usize::MAX,
        }
    }
}
