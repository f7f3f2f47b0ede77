//! The interactive inference node: Algorithm 1 of the paper, one tick.

use super::Literal;
use crate::time::{Duration, Instant};
use crate::tree::Status;

/// What the node asks of a task. Each method is a line of Algorithm 1, whose numbers are given.
///
/// A task holds its percept, its candidates and its choice; the node decides the order.
pub trait Task {
    /// A policy the task can choose.
    type Policy: Copy;

    /// 3-4: take the task's own model and preferences.
    fn prepare(&mut self);
    /// 5: take the current observation.
    fn observe(&mut self);
    /// 6: update the belief, and the logic variables with it.
    fn update(&mut self);
    /// 7 and 20: build the robot's own candidates for the preferences as they are now.
    fn candidates(&mut self);
    /// 8-11 and 21-24: read the teammates' intentions and form the joint candidates.
    fn intentions(&mut self);
    /// 12 and 25: choose by interactive inference; `None` when there is nothing to choose from.
    fn infer(&mut self) -> Option<Self::Policy>;
    /// 13: whether this is the policy to stop.
    fn is_stop(&self, policy: Self::Policy) -> bool;
    /// 17: the first literal of the policy's precondition that does not hold.
    fn unmet(&self, policy: Self::Policy) -> Option<Literal>;
    /// 18-19: raise the preference for the evidence that would make it hold.
    fn raise(&mut self, missing: Literal);
    /// 31: whether all N - 1 teammates are connected.
    fn connected(&self) -> bool;
    /// 32: execute one step of the policy.
    fn execute(&mut self, policy: Self::Policy);
    /// 33: take every temporary preference back, exactly.
    fn roll_back(&mut self);
    /// 35: execute the wait policy.
    fn wait(&mut self);
    /// 37: whether executing the policy establishes the precondition of stopping.
    fn reaches_stop(&self, policy: Self::Policy) -> bool;
    /// 38: choose to stop at the next tick.
    fn promote_stop(&mut self);
}

/// The node's memory between ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Node {
    timeout: Duration,
    unmet_since: Option<Instant>,
}

impl Node {
    /// How often at the most one tick passes the precondition loop (lines 17-30). What is left unmet goes on
    /// at the next tick, so a tick has bounded work and the timeout a clock to run on.
    pub const PASSES: usize = 8;

    /// A node that fails when a precondition stays unmet for `timeout`.
    #[must_use]
    pub const fn new(timeout: Duration) -> Self {
        Self { timeout, unmet_since: None }
    }

    /// One tick of Algorithm 1; the comments are its lines.
    pub fn tick<T: Task>(&mut self, task: &mut T, now: Instant) -> Status {
        // 2: running, unless a line below says otherwise.
        if self.unmet_since.is_none() {
            task.prepare(); // 3-4
        }
        task.observe(); // 5
        task.update(); // 6
        task.candidates(); // 7
        task.intentions(); // 8-11
        let choice = task.infer(); // 12
        if choice.is_some_and(|policy| task.is_stop(policy)) {
            self.unmet_since = None;
            return Status::Success; // 13-15
        }
        let since = *self.unmet_since.get_or_insert(now);
        match self.satisfy(task, choice) {
            Some(policy) => {
                self.unmet_since = None;
                Self::act(task, policy); // 31-38
            }
            None if now.since(since) >= self.timeout => {
                self.unmet_since = None;
                task.wait();
                return Status::Failure; // 26-28
            }
            None => task.wait(),
        }
        Status::Running // 40-41
    }

    /// Forgets an unfinished precondition loop and takes back what it raised.
    pub fn halt<T: Task>(&mut self, task: &mut T) {
        self.unmet_since = None;
        task.wait();
        task.roll_back();
    }

    /// Lines 17-30: raise, rebuild, read and infer again until the choice may be executed.
    fn satisfy<T: Task>(&self, task: &mut T, mut choice: Option<T::Policy>) -> Option<T::Policy> {
        for _ in 0..Self::PASSES {
            let policy = choice?;
            let Some(missing) = task.unmet(policy) else { return Some(policy) }; // 17
            task.raise(missing); // 18-19
            task.candidates(); // 20
            task.intentions(); // 21-24
            choice = task.infer(); // 25
        }
        choice.filter(|&policy| task.unmet(policy).is_none())
    }

    /// Lines 31-38: execute together or wait, roll back, and see whether that was the last step.
    fn act<T: Task>(task: &mut T, policy: T::Policy) {
        if !task.connected() {
            task.wait(); // 35
            return;
        }
        task.execute(policy); // 32
        task.roll_back(); // 33
        if task.reaches_stop(policy) {
            task.promote_stop(); // 37-38
        }
    }
}
