//! One robot's rounds, tick by tick.

use super::super::{Member, RobotId};
use super::patience::Patience;
use super::{Event, Fact, JointPolicies, Proposal, Protocol, Teammates, Timing, View, Waiting, Want};

/// What a robot brings to a tick.
#[derive(Debug)]
pub struct Own<'a, F> {
    /// Its fact as of now, to be frozen if a round begins.
    pub fact: &'a F,
    /// Whether it stands at the place of the fact, between no two others.
    pub is_standing: bool,
    /// The teammates that are to open another round by themselves: one that falls silent is left
    /// out in time, although it keeps no other from going on.
    pub expected: View,
}

impl<F> Clone for Own<'_, F> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F> Copy for Own<'_, F> {}

/// The rounds of one robot: the [`Protocol`], and when to open a round.
///
/// Here two robots that share no space agree on one of two tables, of which the second robot can
/// only use the second.
///
/// ```
/// use iibt_core::iibt::cheapest_policy;
/// use iibt_core::team::rounds::{
///     Event, Fact, Heard, JointPolicies, Own, RoundMessage, Rounds, Score, Teammates, Timing, View,
///     Waiting,
/// };
/// use iibt_core::team::{Member, RobotId, Stamp};
/// use serde::{Deserialize, Serialize};
///
/// #[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
/// struct Load(u8);
///
/// impl Fact for Load {
///     type Claim = ();
///     const MAX_BYTES: usize = 1;
///
///     fn anchor(&self) {}
/// }
///
/// struct Tables;
///
/// impl JointPolicies for Tables {
///     type Claim = ();
///
///     fn len(&self) -> usize {
///         2
///     }
///     fn cost(&self, policy: usize) -> u16 {
///         [40, 48][policy]
///     }
///     fn claim(&self, _: usize, _: RobotId, _: u16) {}
///     fn moves(&self, _: usize, _: RobotId) -> u16 {
///         1
///     }
///     fn is_clear(&self, _: usize, _: RobotId, _: u16, _: RobotId, _: u16) -> bool {
///         true
///     }
///     fn choose<'s>(&self, members: impl Iterator<Item = (RobotId, &'s [Score])> + Clone) -> Option<usize> {
///         cheapest_policy(self, members)
///     }
/// }
///
/// let robot = |robot, load| -> Result<Rounds<Load, 2>, Box<dyn std::error::Error>> {
///     let member = Member::new(RobotId(robot), 2)?;
///     Ok(Rounds::new(member, 1, 0, Load(load), Timing::DEFAULT))
/// };
/// let (mut first, mut second) = (robot(0, 3)?, robot(1, 5)?);
/// let own = Own { fact: &Load(3), is_standing: true, expected: View::EMPTY };
/// let hears = |robot, message| -> Teammates<'_, Load, 2> {
///     let stamp = Stamp { epoch: 1, sequence: 0 };
///     [(RobotId(robot), Heard { stamp, message })].into_iter().collect()
/// };
///
/// // The first robot has heard nothing yet.
/// let nothing = Teammates::from_iter([]);
/// assert_eq!(first.tick(own, &nothing, &Tables), (None, Some(Waiting::Unheard(RobotId(1)))));
/// let fact = first.protocol().message(&nothing, 0, 0.0);
///
/// // The second knows all facts with that, and scores: it cannot use the first table.
/// let heard = hears(0, &fact);
/// second.tick(own, &heard, &Tables);
/// let digest = second.protocol().wanted(&heard).ok_or("all facts are known")?;
/// second.protocol_mut().give(digest, [Score::CANNOT, Score::default()].into_iter().collect(), &Tables, &heard)?;
/// let scored = second.protocol().message(&heard, 2, 0.0);
///
/// // The first knows all scores with that.
/// let heard = hears(1, &scored);
/// first.tick(own, &heard, &Tables);
/// assert_eq!(first.protocol().wanted(&heard), Some(digest));
/// first.protocol_mut().give(digest, [Score::default(); 2].into_iter().collect(), &Tables, &heard)?;
/// assert_eq!(first.protocol().policy(), Some(1));
/// assert!(first.may_move(&heard, &Tables));
///
/// // So does the second, when it hears that.
/// let decided = first.protocol().message(&heard, 2, 0.0);
/// let (event, waiting) = second.tick(own, &hears(0, &decided), &Tables);
/// assert_eq!((event, waiting), (Some(Event::Decided(Some(1))), None));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "consensus")]
#[doc(alias = "agreement")]
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Rounds<F: Fact, const K: usize> {
    protocol: Protocol<F, K>,
    patience: Patience,
}

impl<F: Fact, const K: usize> Rounds<F, K> {
    /// The rounds of a robot that has just started; see [`Protocol::new`].
    #[must_use]
    pub const fn new(member: Member, epoch: u32, mission: u64, fact: F, timing: Timing) -> Self {
        Self::of(Protocol::new(member, epoch, mission, fact), timing)
    }

    /// The rounds of a robot in this state, which has not yet waited for anything.
    #[must_use]
    pub const fn of(protocol: Protocol<F, K>, timing: Timing) -> Self {
        let patience = Patience::new(timing, protocol.proposal().view);
        Self { protocol, patience }
    }

    /// Hears the teammates; joins a round, learns the choice, or opens a round where there is
    /// trouble. Returns what happened, and what the robot [waits](Self::waiting) for after that.
    ///
    /// Call it once in every tick; then [ask](Self::ask) for another decision if there is a reason,
    /// [work on the list](Protocol::wanted), [move](Self::may_move) and
    /// [announce](Protocol::message). `list` is the one that was scored in this round; before, it
    /// is not looked at.
    pub fn tick<L>(
        &mut self,
        own: Own<'_, F>,
        teammates: &Teammates<'_, F, K>,
        list: &L,
    ) -> (Option<Event>, Option<Waiting>)
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        let event = self.protocol.attend(own.fact, own.is_standing, teammates, list);
        let trouble = self.patience.observe(&self.protocol, own.expected, teammates, list);
        let may_open = event.is_none() && own.is_standing;
        let view = if may_open { self.patience.view_to_open(trouble, &self.protocol) } else { None };
        match view.and_then(|view| self.open(view, own.fact)) {
            None => (event, self.patience.stranded(&self.protocol).or(trouble.waiting)),
            opened => (opened, self.waiting(teammates, list)),
        }
    }

    /// Opens a round because the robot wants another decision, if it may now; `fact` is that of
    /// now, and the robot stands at its place.
    pub fn ask(&mut self, want: Want, fact: &F) -> Option<Event> {
        let view = self.patience.wish(want, &self.protocol)?;
        self.open(view, fact)
    }

    fn open(&mut self, view: View, fact: &F) -> Option<Event> {
        self.protocol.open(view, fact).ok()?;
        Some(Event::Opened(self.protocol.proposal().round))
    }

    /// What the robot waits for; `None` if it may move, or has nothing more to do.
    pub fn waiting<L>(&self, teammates: &Teammates<'_, F, K>, list: &L) -> Option<Waiting>
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        self.patience.stranded(&self.protocol).or_else(|| self.protocol.waiting(teammates, list))
    }

    /// Whether the robot may begin its next step now: see [`Protocol::may_move`]. One that is cut
    /// off from its team, and no quorum by itself, may not.
    pub fn may_move<L>(&self, teammates: &Teammates<'_, F, K>, list: &L) -> bool
    where
        L: JointPolicies<Claim = F::Claim>,
    {
        self.patience.stranded(&self.protocol).is_none() && self.protocol.may_move(teammates, list)
    }

    /// The ticks since a teammate was last heard, as of the last [tick](Self::tick).
    #[must_use]
    pub fn silence(&self, robot: RobotId) -> u16 {
        self.patience.silence(robot)
    }

    /// The state that safety rests on.
    #[must_use]
    pub const fn protocol(&self) -> &Protocol<F, K> {
        &self.protocol
    }

    /// The same, to give scores and to count steps.
    pub const fn protocol_mut(&mut self) -> &mut Protocol<F, K> {
        &mut self.protocol
    }

    /// The round that the robot is in.
    #[must_use]
    pub const fn proposal(&self) -> &Proposal<F::Claim> {
        self.protocol.proposal()
    }
}
