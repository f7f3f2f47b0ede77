//! The interactive inference node: Algorithm 1 of the paper, one tick.

use super::Task;
use crate::team::Peers;
use crate::time::{Duration, Instant};
use crate::tree::Status;

/// The interactive inference node of a task, with its memory between ticks.
///
/// It owns what Algorithm 1 owns: the preference with its temporary part, the roll-back, the
/// precondition loop with its timeout, waiting, and the connection to the teammates. [`Task`] has
/// an example.
#[doc(alias = "interactive inference node")]
#[doc(alias = "Algorithm 1")]
#[doc(alias = "active inference")]
#[derive(Clone, Debug)]
pub struct InferenceNode<T: Task> {
    timeout: Duration,
    /// C with its temporary part L, while a precondition is unmet; rolled back by dropping it.
    preference: Option<T::Preference>,
    unmet_since: Option<Instant>,
}

/// The result of the precondition loop.
struct Decided<T: Task> {
    candidates: T::Candidates,
    /// The choice whose precondition holds, if there is one.
    policy: Option<T::Policy>,
}

impl<T: Task> InferenceNode<T> {
    /// The most passes of the precondition loop (lines 17-30) in one tick. What is left unmet goes
    /// on at the next tick, so a tick has bounded work and the timeout a clock to run on.
    pub const PASSES: usize = 8;

    /// A node that fails when a precondition stays unmet, or a teammate unconnected, for `timeout`.
    #[must_use]
    pub const fn new(timeout: Duration) -> Self {
        Self { timeout, preference: None, unmet_since: None }
    }

    /// One tick of Algorithm 1; the comments are its lines.
    pub fn tick(
        &mut self,
        task: &mut T,
        percept: &T::Percept,
        peers: Peers<'_, T::Message>,
        now: Instant,
    ) -> Status {
        // 2: running, unless a line below says otherwise.
        task.observe(percept, peers); // 5-6
        if task.is_done() {
            self.forget();
            return Status::Success; // 13-15
        }
        let mut preference = self.preference.take().unwrap_or_else(|| task.preference()); // 3-4
        let decided = Self::decide(task, &mut preference, peers); // 7-12, 17-30
        // From the first tick of an unmet precondition; a choice that may be executed clears it.
        let since = *self.unmet_since.get_or_insert(now);
        match decided.policy {
            Some(policy) if task.is_connected(peers) => {
                task.execute(policy, &decided.candidates, peers); // 31-32
                self.forget(); // 33: the temporary preference is dropped, the base is the task's own
                return Status::Running; // 40-41
            }
            _ if now.since(since) >= self.timeout => self.forget(), // 26-28
            Some(_) => return self.wait(task, None),                // 34-36
            // What was raised so far is kept: the loop goes on at the next tick.
            None => return self.wait(task, Some(preference)),
        }
        task.wait();
        Status::Failure
    }

    fn wait(&mut self, task: &mut T, raised: Option<T::Preference>) -> Status {
        self.preference = raised;
        task.wait();
        Status::Running
    }

    /// Stops an unfinished precondition loop, rolls back its raises, and lets the task wait.
    pub fn halt(&mut self, task: &mut T) {
        self.forget();
        task.wait();
    }

    /// C with the raises of an unfinished precondition loop; `None` while nothing is raised.
    #[must_use]
    pub const fn raised(&self) -> Option<&T::Preference> {
        self.preference.as_ref()
    }

    fn forget(&mut self) {
        (self.preference, self.unmet_since) = (None, None);
    }

    /// Lines 7-12 and 17-30: infer, then raise, rebuild, read and infer again until the choice may
    /// be executed.
    fn decide(task: &mut T, preference: &mut T::Preference, peers: Peers<'_, T::Message>) -> Decided<T> {
        let mut candidates = task.candidates(preference, peers); // 7
        let mut choice = task.infer(&candidates, preference, peers); // 8-12
        for _ in 0..Self::PASSES {
            let Some(policy) = choice else { break };
            let Some(missing) = task.unmet(policy, &candidates) else {
                return Decided { candidates, policy: choice }; // 17
            };
            task.raise(missing, &candidates, preference); // 18-19
            candidates = task.candidates(preference, peers); // 20
            choice = task.infer(&candidates, preference, peers); // 21-25
        }
        let policy = choice.filter(|&policy| task.unmet(policy, &candidates).is_none());
        Decided { candidates, policy }
    }
}
