//! The contract between the interactive inference node and a task.

use super::Literal;
use crate::team::{Message, Peers};

/// A task of the interactive inference node. Each method is a line of Algorithm 1, whose numbers
/// are given.
///
/// Data flows through the signatures: a percept and the teammates' messages become belief, a
/// preference becomes candidates, candidates become a choice, and a choice becomes its precondition
/// or an execution. What Algorithm 1 keeps between those lines is the
/// [`InferenceNode`](super::InferenceNode)'s.
///
/// ```
/// use iibt_core::iibt::{Literal, InferenceNode, Task};
/// use iibt_core::team::{Limits, Member, Message, Peers, RobotId, Roster};
/// use iibt_core::time::{Duration, Instant};
/// use iibt_core::tree::Status;
/// use serde::{Deserialize, Serialize};
///
/// /// A lamp that is to be lit, by a robot that has to plug it in first.
/// #[derive(Default)]
/// struct Lamp {
///     plugged: bool,
///     lit: bool,
/// }
///
/// #[derive(Clone, Copy, PartialEq)]
/// enum Action {
///     Plug,
///     Light,
/// }
///
/// #[derive(Clone, Serialize, Deserialize)]
/// struct Silence;
///
/// impl Message for Silence {
///     const SCHEMA: &'static str = "nothing";
///     const MAX_BYTES: usize = 0;
/// }
///
/// const PLUGGED: Literal = Literal { variable: 0, value: true };
///
/// impl Task for Lamp {
///     type Percept = bool;
///     type Message = Silence;
///     /// The preference for a lamp that is plugged in, and for one that is lit.
///     type Preference = [f32; 2];
///     type Candidates = [Action; 2];
///     type Policy = Action;
///
///     fn observe(&mut self, lit: &bool, _: Peers<'_, Silence>) {
///         self.lit = *lit;
///     }
///     fn is_done(&self) -> bool {
///         self.lit
///     }
///     fn preference(&self) -> [f32; 2] {
///         [0.0, 1.0]
///     }
///     fn candidates(&mut self, _: &[f32; 2], _: Peers<'_, Silence>) -> [Action; 2] {
///         [Action::Plug, Action::Light]
///     }
///     fn infer(
///         &mut self,
///         actions: &[Action; 2],
///         worth: &[f32; 2],
///         _: Peers<'_, Silence>,
///     ) -> Option<Action> {
///         let best = if worth[0] > worth[1] { 0 } else { 1 };
///         Some(actions[best])
///     }
///     fn unmet(&self, action: Action, _: &[Action; 2]) -> Option<Literal> {
///         (action == Action::Light && !self.plugged).then_some(PLUGGED)
///     }
///     fn raise(&mut self, _: Literal, _: &[Action; 2], worth: &mut [f32; 2]) {
///         worth[0] = worth[1] + 1.0;
///     }
///     fn execute(&mut self, action: Action, _: &[Action; 2], _: Peers<'_, Silence>) {
///         self.plugged |= action == Action::Plug;
///     }
///     fn wait(&mut self) {}
/// }
///
/// let limits = Limits::for_beacons(Duration(1))?;
/// let alone = Roster::<Silence>::new(Member::new(RobotId(0), 1)?, limits);
/// let (mut lamp, mut node) = (Lamp::default(), InferenceNode::new(Duration(100)));
/// let mut tick = |lit, now| node.tick(&mut lamp, &lit, alone.at(Instant(now)), Instant(now));
/// assert_eq!(tick(false, 0), Status::Running); // it is plugged in first, because that was missing
/// assert_eq!(tick(false, 1), Status::Running); // then it is lit
/// assert_eq!(tick(true, 2), Status::Success);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "planner")]
#[doc(alias = "domain")]
pub trait Task {
    /// The readings of the robot in a tick.
    type Percept;
    /// The messages between robots with this task.
    type Message: Message;
    /// C, the current preferences, temporary raises included.
    type Preference;
    /// The candidates of a decision.
    type Candidates;
    /// A policy that can be chosen.
    type Policy: Copy;

    /// 5-6: takes a percept and the teammates' messages into the belief and the logic variables.
    fn observe(&mut self, percept: &Self::Percept, peers: Peers<'_, Self::Message>);

    /// 13 and 37: whether the precondition of the stop policy holds.
    fn is_done(&self) -> bool;

    /// 3-4: gives the base preference, without any raise.
    fn preference(&self) -> Self::Preference;

    /// 7 and 20: builds the robot's own candidates for a preference.
    fn candidates(
        &mut self,
        preference: &Self::Preference,
        peers: Peers<'_, Self::Message>,
    ) -> Self::Candidates;

    /// 8-12 and 21-25: joins the teammates' intentions and chooses by interactive inference; `None`
    /// when there is nothing to choose from.
    fn infer(
        &mut self,
        candidates: &Self::Candidates,
        preference: &Self::Preference,
        peers: Peers<'_, Self::Message>,
    ) -> Option<Self::Policy>;

    /// 17: names the first literal of a policy's precondition that does not hold.
    fn unmet(&self, policy: Self::Policy, candidates: &Self::Candidates) -> Option<Literal>;

    /// 18-19: raises the preference for the evidence that would make a missing literal hold (f_L).
    fn raise(&mut self, missing: Literal, candidates: &Self::Candidates, preference: &mut Self::Preference);

    /// 31: whether the robots that the policy needs are connected: by default all teammates.
    fn is_connected(&self, peers: Peers<'_, Self::Message>) -> bool {
        peers.all_connected()
    }

    /// 32: executes one step of a policy.
    fn execute(
        &mut self,
        policy: Self::Policy,
        candidates: &Self::Candidates,
        peers: Peers<'_, Self::Message>,
    );

    /// 35: executes the wait policy.
    fn wait(&mut self);
}
