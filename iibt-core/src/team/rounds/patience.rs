//! When to open a round: what a robot wants, and how long it bears with the others.

use super::super::{MAX_TEAM, RobotId, Stamp};
use super::{Fact, JointPolicies, Protocol, Teammates, View, Waiting};

/// How long a robot waits before it opens a round, in ticks.
///
/// ```
/// use iibt_core::team::rounds::Timing;
///
/// assert_eq!(Timing::DEFAULT.lost_after(), 20);
/// assert_eq!(Timing::new(30, 10).map(|timing| timing.lost_after()), Some(30));
/// assert_eq!(Timing::new(19, 10), None, "ten losses in a row are common among eight robots");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Timing {
    lost_after: u16,
    refractory: u16,
}

impl Timing {
    /// Lost after 20 ticks, 10 ticks between two rounds that a robot opens by its own wish.
    pub const DEFAULT: Self = Self { lost_after: Self::LEAST, refractory: 10 };

    /// The least time before a teammate is left out.
    pub const LEAST: u16 = 20;

    /// The most that silences make of the time before a teammate is left out, as a multiple.
    const MOST_PATIENCE: u16 = 4;

    /// A teammate that blocks is left out after this many ticks in which it was not heard, or twice
    /// as many in which it was heard without progress. Where teammates came back from silences of
    /// more than a third of that time, as on a radio that loses frames in bursts, it is thrice the
    /// longest such silence, up to four times as long. After a round that a robot opened by its
    /// own wish, it opens no other before it has moved or the refractory time is over.
    ///
    /// `None` if the first is below [`LEAST`](Self::LEAST).
    #[must_use]
    pub const fn new(lost_after: u16, refractory: u16) -> Option<Self> {
        if lost_after < Self::LEAST { None } else { Some(Self { lost_after, refractory }) }
    }

    /// How long a teammate that blocks may be silent, before longer silences were seen.
    #[must_use]
    pub const fn lost_after(self) -> u16 {
        self.lost_after
    }
}

/// How much a robot needs another decision, by what it has learned since its fact was frozen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Want {
    /// Another would be better: not twice within the refractory time.
    Better,
    /// It cannot go on with the present one, because its way is blocked: at once.
    Needed,
}

/// What a robot remembers to tell a teammate that is slow from one that is lost.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Patience {
    timing: Timing,
    teammates: [Acquaintance; MAX_TEAM],
    /// The view of the round before.
    view: View,
    /// Ticks with trouble that another round would end.
    trouble: u16,
    /// Ticks until the next wish is granted.
    refractory: u16,
    /// The most ticks of silence after which a teammate was heard again, in the same epoch.
    longest_silence: u16,
}

/// One teammate over time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
struct Acquaintance {
    stamp: Stamp,
    progress: (u32, u8, u16),
    /// Ticks since it was heard.
    silence: u16,
    /// Grows while the teammate blocks without progress: by two for a tick in silence, else by one.
    quiet: u16,
    /// Ticks that it has stood in this round, left out.
    standing: u16,
    /// Ticks that it must, before it is taken in.
    backoff: u16,
}

impl Acquaintance {
    const LONGEST_BACKOFF: u16 = 1280;

    const NEW: Self = Self {
        stamp: Stamp { epoch: 0, sequence: 0 },
        progress: (0, 0, 0),
        silence: 0,
        quiet: 0,
        standing: 0,
        backoff: 0,
    };

    /// Takes in the newest stamp; returns the ticks of silence that it ends. A new start ends none:
    /// the teammate was not there before.
    fn hear(&mut self, stamp: Stamp) -> u16 {
        let is_known = self.stamp.epoch == stamp.epoch;
        let ended = if is_known && stamp != self.stamp { self.silence } else { 0 };
        self.silence = if stamp == self.stamp { self.silence.saturating_add(1) } else { 0 };
        self.stamp = stamp;
        ended
    }

    /// Waits longer before the next readmission.
    fn back_off(&mut self) {
        let doubled = self.backoff.saturating_mul(2);
        self.backoff = doubled.clamp(Timing::LEAST, Self::LONGEST_BACKOFF);
    }
}

impl Patience {
    pub(super) const fn new(timing: Timing, view: View) -> Self {
        let teammates = [Acquaintance::NEW; MAX_TEAM];
        Self { timing, teammates, view, trouble: 0, refractory: 0, longest_silence: 0 }
    }

    /// Takes in a tick, after the newest messages were heard; returns the trouble in it. Members
    /// that are `expected` to open a round are missed when they are silent.
    pub(super) fn observe<F, L, const K: usize>(
        &mut self,
        protocol: &Protocol<F, K>,
        expected: View,
        teammates: &Teammates<'_, F, K>,
        list: &L,
    ) -> Trouble
    where
        F: Fact,
        L: JointPolicies<Claim = F::Claim>,
    {
        self.refractory = if protocol.step() > 0 { 0 } else { self.refractory.saturating_sub(1) };
        let trouble = trouble(protocol, teammates, list);
        let view = protocol.proposal().view;
        // A robot whose link is gone does not drive its plan to the end.
        let is_cut_off = protocol.has_moves_left(list) && !self.hears_any(protocol, teammates);
        for (robot, acquaintance) in (0..).map(RobotId).zip(&mut self.teammates) {
            if view.difference(self.view).contains(robot) {
                acquaintance.back_off();
            }
            let heard = protocol.newest(robot, teammates);
            let stamp = heard.map_or(acquaintance.stamp, |heard| heard.stamp);
            let progress = heard.map_or(acquaintance.progress, Protocol::progress);
            let works = heard.is_some_and(|heard| protocol.follows(heard) && progress.2 > 0);
            if stamp.epoch != acquaintance.stamp.epoch || works {
                acquaintance.backoff = 0;
            }
            self.longest_silence = self.longest_silence.max(acquaintance.hear(stamp));
            // A tick without a frame is no silence: it may have passed on one of another robot.
            let is_silent = acquaintance.silence > 1;
            let weight = if is_silent { 2 } else { 1 };
            let is_missed = is_silent && (is_cut_off || expected.contains(robot));
            let is_awaited = is_missed || trouble.blocking.contains(robot);
            let is_stuck = is_awaited && progress == acquaintance.progress;
            acquaintance.quiet = if is_stuck { acquaintance.quiet.saturating_add(weight) } else { 0 };
            let is_outside = !view.contains(robot) && protocol.is_in_round(robot, teammates).is_ok();
            acquaintance.standing = if is_outside { acquaintance.standing.saturating_add(1) } else { 0 };
            acquaintance.progress = progress;
        }
        self.view = view;
        trouble
    }

    /// Whether a member has been heard since the last tick.
    fn hears_any<F: Fact, const K: usize>(
        &self,
        protocol: &Protocol<F, K>,
        teammates: &Teammates<'_, F, K>,
    ) -> bool {
        let last = |robot: RobotId| self.teammates.get(robot.index()).map(|it| it.stamp);
        let is_new =
            |robot| protocol.newest(robot, teammates).is_some_and(|it| last(robot) != Some(it.stamp));
        protocol.others().any(is_new)
    }

    /// The view to open a round with now, if trouble with the others has lasted long enough.
    pub(super) fn view_to_open<F: Fact, const K: usize>(
        &mut self,
        trouble: Trouble,
        protocol: &Protocol<F, K>,
    ) -> Option<View> {
        let view = self.best_view(protocol)?;
        let is_troubled = view != protocol.proposal().view || trouble.is_void;
        self.trouble = if is_troubled { self.trouble.saturating_add(1) } else { 0 };
        let is_due = self.trouble > 2 + 2 * u16::from(protocol.member().robot().0);
        if is_due {
            self.trouble = 0;
        }
        is_due.then_some(view)
    }

    /// The view to open a round with, if the wish is granted.
    pub(super) fn wish<F: Fact, const K: usize>(
        &mut self,
        want: Want,
        protocol: &Protocol<F, K>,
    ) -> Option<View> {
        let view = self.best_view(protocol)?;
        let is_due = match want {
            Want::Better => self.refractory == 0,
            Want::Needed => true,
        };
        // A round that is being decided goes first: robots that learn something at every tick would
        // otherwise decide nothing.
        let is_granted = is_due && protocol.has_decided();
        if is_granted {
            self.refractory = self.timing.refractory;
        }
        is_granted.then_some(view)
    }

    /// A teammate that is lost and cannot be left out.
    pub(super) fn stranded<F: Fact, const K: usize>(&self, protocol: &Protocol<F, K>) -> Option<Waiting> {
        let lost = self.lost(protocol);
        let view = protocol.proposal().view.difference(lost);
        let robot = lost.iter().next()?;
        match protocol.may_open(view) {
            Err(Waiting::Quorum(_)) => Some(Waiting::Quorum(robot)),
            other => other.err(),
        }
    }

    /// The ticks since a teammate was heard; since the start for one that was not.
    pub(super) fn silence(&self, robot: RobotId) -> u16 {
        self.teammates.get(robot.index()).map_or(u16::MAX, |teammate| teammate.silence)
    }

    /// The present members without those that are lost, and with those that stand outside.
    fn best_view<F: Fact, const K: usize>(&self, protocol: &Protocol<F, K>) -> Option<View> {
        let back = self.those(|acquaintance| acquaintance.standing > acquaintance.backoff);
        let grown = protocol.proposal().view.union(back);
        let views = [grown.difference(self.lost(protocol)), grown];
        views.into_iter().find(|&view| protocol.may_open(view).is_ok())
    }

    fn lost<F: Fact, const K: usize>(&self, protocol: &Protocol<F, K>) -> View {
        let limit = self.lost_after().saturating_mul(2);
        let is_lost = |robot: &RobotId| self.teammates.get(robot.index()).is_some_and(|it| it.quiet >= limit);
        protocol.others().filter(is_lost).collect()
    }

    /// How long a teammate that blocks may be silent: thrice the longest silence from which one has
    /// come back, within limits. A link in a burst of losses is then not taken for a lost robot.
    fn lost_after(&self) -> u16 {
        let usual = self.timing.lost_after;
        let most = usual.saturating_mul(Timing::MOST_PATIENCE);
        // Not `clamp`, which panics where the limits are the wrong way round.
        self.longest_silence.saturating_mul(3).min(most).max(usual)
    }

    fn those(&self, is_one: impl Fn(&Acquaintance) -> bool) -> View {
        let robots = (0..).map(RobotId).zip(&self.teammates);
        robots.filter(|(_, acquaintance)| is_one(acquaintance)).map(|(robot, _)| robot).collect()
    }
}

/// What the others do to this robot in a tick.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Trouble {
    /// The members that keep it from going on.
    blocking: View,
    /// Whether the present round cannot be decided, however long one waits.
    is_void: bool,
    /// What [`Protocol::waiting`] says.
    pub(super) waiting: Option<Waiting>,
}

fn trouble<F, L, const K: usize>(
    protocol: &Protocol<F, K>,
    teammates: &Teammates<'_, F, K>,
    list: &L,
) -> Trouble
where
    F: Fact,
    L: JointPolicies<Claim = F::Claim>,
{
    let mut trouble = Trouble::default();
    let obstacles = protocol.obstacles(teammates, list);
    trouble.waiting = protocol.first(obstacles.inspect(|obstacle| {
        trouble.blocking = obstacle.robot().map_or(trouble.blocking, |robot| trouble.blocking.with(robot));
        trouble.is_void |= matches!(obstacle, Waiting::Outdated(_) | Waiting::Proposal(_));
    }));
    if protocol.digest().is_none() {
        trouble.waiting = Some(protocol.missing(teammates));
        if let Some(Waiting::Overlap(one, other)) = trouble.waiting {
            trouble.blocking = trouble.blocking.with(one).with(other);
        }
        trouble.is_void |= matches!(protocol.accepts_walls(false), Err(Waiting::Wall(_)));
    }
    trouble
}
