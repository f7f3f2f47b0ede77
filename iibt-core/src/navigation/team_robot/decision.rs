//! How a robot decides with its team: rounds, the list, its scores, the choice.

use super::super::{Cause, Fact, Intention, Purpose};
use super::Navigation;
use super::outlook::OwnOutlook;
use crate::bounded::up_to;
use crate::grid::{CellSet, Move, Path};
use crate::inference::{Eighths, WeighedPolicies, worth_of_nats};
use crate::team::rounds::{Event, JointPolicies, Own, Score, Scores, Teammates, View, Waiting, Want};
use crate::team::{MAX_TEAM, Peers};

/// The ticks for which a robot is taken to stand on its goal: as many as the steps of a plan in an
/// image. A preference counts in each of them, and a tick without any goal counts as a nat.
const STAY: f32 = 32.0;

impl<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
    Navigation<'_, S, W, L, M, K>
{
    /// Hears the teammates; joins a round, opens one where there is trouble, or learns the choice.
    /// Those that are busy will open another round.
    pub(super) fn attend(&mut self, teammates: &Teammates<'_, Fact<W>, K>, busy: View) {
        let standing = self.standing();
        let anchor = standing.unwrap_or(self.localisation.position().0);
        let fact = self.fact(anchor, self.purpose());
        let Some(rounds) = &mut self.rounds else { return };
        let list = self.policies.on_map(self.mission, rounds.proposal().view);
        let protocol = rounds.protocol();
        if let Purpose::Visit(cell) = fact.purpose
            && Self::PLANS
            && protocol.is_vetoed()
            && *protocol.fact() == fact
        {
            self.waypoints.put_off(cell, View::EMPTY);
        }
        let own = Own { fact: &fact, is_standing: standing.is_some(), expected: busy };
        let (event, waiting) = rounds.tick(own, teammates, &list);
        let mut event = (event, Cause::Teammate);
        // Where all policies were impossible for some member, there is none whose precondition
        // could ask for another round.
        let protocol = rounds.protocol();
        let is_void = protocol.is_vetoed() && *protocol.fact() != fact;
        let asks = is_void && event.0.is_none() && own.is_standing;
        if asks {
            event = (rounds.ask(Want::Needed, &fact), Cause::Shortfall);
        }
        self.note(event.0, event.1, teammates);
        if asks {
            self.note_waiting(teammates);
        } else {
            self.wait_for(waiting);
        }
    }

    fn note(&mut self, event: Option<Event>, cause: Cause, teammates: &Teammates<'_, Fact<W>, K>) {
        match event {
            Some(Event::Joined(_)) => self.begin_round(None),
            Some(Event::Opened(_)) => self.begin_round(Some(cause)),
            Some(Event::Decided(_)) => self.take_choice(teammates),
            None => {}
        }
    }

    fn begin_round(&mut self, cause: Option<Cause>) {
        self.cause = cause;
        self.listing = None;
        self.outlook = OwnOutlook::NONE;
        self.weighed = WeighedPolicies::default();
    }

    /// Keeps the posterior over the policies, for displays and logs; and puts off a way-point to
    /// which the chosen plan does not lead, so that the robot goes on with the rest.
    fn take_choice(&mut self, teammates: &Teammates<'_, Fact<W>, K>) {
        let Some((rounds, list)) = self.rounds.as_ref().zip(self.on_map()) else { return };
        let view = list.view;
        self.weighed = list.weigh(rounds.protocol().scores(teammates));
        let end = self.course().map(|(path, _)| path.end(&self.mission.map));
        let announced = self.announced().map_or(Purpose::Goal, |fact| fact.purpose);
        if let (Purpose::Visit(cell), Some(end)) = (announced, end)
            && end != cell
            && Self::PLANS
            && !self.mission.waits_for_charging
        {
            let rivals = self.busy(teammates).difference(View::full(MAX_TEAM).difference(view));
            self.waypoints.put_off(cell, rivals);
        }
    }

    /// Lines 18 and 19: wants another round because of an unmet precondition.
    pub(in crate::navigation) const fn want(&mut self, cause: Cause) {
        self.wanted = Some(cause);
    }

    /// Line 20: opens the round that is wanted, if it may.
    pub(in crate::navigation) fn ask(&mut self, purpose: Purpose, peers: Peers<'_, Intention<W, K>>) {
        let (Some(cause), Some(here)) = (self.wanted.take(), self.standing()) else { return };
        let fact = self.fact(here, purpose);
        let Some(rounds) = &mut self.rounds else { return };
        let want = if cause == Cause::Shortfall { Want::Better } else { Want::Needed };
        let Some(event) = rounds.ask(want, &fact) else { return };
        let teammates = Teammates::from(peers);
        self.note(Some(event), cause, &teammates);
        self.note_waiting(&teammates);
    }

    /// Lines 7 and 20: works on the list of this round, within the budget of the tick.
    pub(in crate::navigation) fn list(&mut self, peers: Peers<'_, Intention<W, K>>) {
        let Some(rounds) = self.rounds.as_ref().filter(|rounds| rounds.protocol().digest().is_none()) else {
            return;
        };
        let teammates = Teammates::from(peers);
        let Some(digest) = rounds.protocol().wanted(&teammates) else { return };
        if self.listing != Some(digest) {
            self.policies.clear();
            self.listing = Some(digest);
        }
        let protocol = rounds.protocol();
        let facts =
            |robot| protocol.facts(&teammates).find_map(|(other, fact)| (other == robot).then_some(fact));
        self.policies.advance(self.mission, rounds.proposal(), facts, &mut self.left);
    }

    /// Lines 8 to 12 and 21 to 25: gives this robot's scores of the finished list, and returns the
    /// policy that all have chosen, once every score is known.
    pub(in crate::navigation) fn choose(&mut self, peers: Peers<'_, Intention<W, K>>) -> Option<usize> {
        let rounds = self.rounds.as_ref()?;
        if rounds.protocol().digest().is_none() && self.policies.is_done() {
            self.give(&Teammates::from(peers));
        }
        self.rounds.as_ref()?.protocol().policy()
    }

    /// Gives this robot's scores of the finished list, if it is the one that is wanted.
    fn give(&mut self, teammates: &Teammates<'_, Fact<W>, K>) {
        if let Some(digest) = self.listing
            && let Some(scores) = self.scores()
            && let Some(rounds) = &mut self.rounds
            && rounds.protocol().wanted(teammates) == Some(digest)
        {
            let list = self.policies.on_map(self.mission, rounds.proposal().view);
            let protocol = rounds.protocol_mut();
            if protocol.give(digest, scores, &list, teammates).is_ok() && protocol.has_decided() {
                self.take_choice(teammates);
            }
            self.note_waiting(teammates);
        }
    }

    /// What each policy costs this robot alone.
    fn scores(&self) -> Option<Scores<K>> {
        let list = self.on_map()?;
        let (shut, later) = (self.shut(), self.later());
        let score = |policy| {
            let later = later.get(policy).copied().unwrap_or(0);
            list.path(policy, self.robot()).map_or(Score::CANNOT, |path| self.score(path, &shut, later))
        };
        Some(up_to((0..list.len()).map(score)))
    }

    /// What a path costs this robot: the ticks by which its drive makes it late, and what its goal
    /// is worth less than others as long as it stands there. By what it has read, the policy is
    /// `later` by so many eighths of a tick.
    fn score(&self, path: &Path, shut: &CellSet<W>, later: Eighths) -> Score {
        let map = &self.mission.map;
        // It may leave a cell on which a stranger waits for that.
        let mut entered = path.cells(map).skip_while(|&cell| cell == path.start);
        if entered.any(|cell| self.is_blocked(cell) || shut.contains(cell)) {
            return Score::CANNOT;
        }
        let slips = self.localisation.slips();
        let pace = f32::from(self.mission.pace_of(self.robot()) - 1);
        let extra = |step: Move| {
            let slip = slips.get(usize::from(step.code())).copied().unwrap_or(0.0).min(0.9);
            if step == Move::Wait { 0.0 } else { pace + (1.0 + pace) * slip / (1.0 - slip) }
        };
        let delay: f32 = path.moves().map(extra).sum();
        let end = path.end(map);
        let value = self.mission.goals.iter().zip(self.goal_values).find(|&(&goal, _)| goal == end);
        let missed = value.map_or(0.0, |(_, value)| 1.0 - value);
        let price = Score::finite(worth_of_nats(missed * STAY, 1.0));
        let delay = later.saturating_add((8.0 * delay + 0.5) as Eighths);
        Score { delay: Score::finite(delay), price }
    }

    /// The purpose that the robot has announced for this round.
    pub(in crate::navigation) fn announced(&self) -> Option<&Fact<W>> {
        self.rounds.as_ref().map(|rounds| rounds.protocol().fact())
    }

    /// Whether more is known about obstacles than this round was decided from.
    pub(in crate::navigation) fn has_news(&self) -> bool {
        let most = Intention::<W, K>::places_beside(self.told().len());
        self.announced().is_some_and(|fact| fact.evidence != self.evidence(most))
    }

    /// Returns what to announce after a tick of the node; `None` until the robot knows where it
    /// stands, and once it has heard another robot with its number.
    #[must_use]
    pub fn intention(&self, peers: Peers<'_, Intention<W, K>>) -> Option<Intention<W, K>> {
        // Two robots with one number would each pass for the other.
        let rounds = self.rounds.as_ref().filter(|_| !peers.has_twin())?;
        let policy = rounds.protocol().policy();
        let probability = policy.map_or(0.0, |policy| self.weighed.probability(policy));
        let listed = self.policies.plans().len() as u8;
        let rounds = rounds.protocol().message(&Teammates::from(peers), listed, probability);
        Some(Intention { waypoints: self.pending(&rounds.fact), rounds })
    }

    /// Notes what the robot waits for: whenever it has heard or done something.
    fn note_waiting(&mut self, teammates: &Teammates<'_, Fact<W>, K>) {
        let waiting = self.rounds.as_ref().zip(self.on_map());
        self.wait_for(waiting.and_then(|(rounds, list)| rounds.waiting(teammates, &list)));
    }

    fn wait_for(&mut self, waiting: Option<Waiting>) {
        let waiting = waiting.filter(|_| !self.has_arrived());
        self.waiting = if self.has_twin { Some(Waiting::Twin) } else { waiting };
    }

    /// Whether every other member of the round follows the same plan, by its newest message. How
    /// old that is does not matter: what a robot that falls silent may still do is in the plan.
    pub(in crate::navigation) fn members_follow(&self) -> bool {
        self.waiting.is_none_or(Waiting::is_in_plan)
    }
}
