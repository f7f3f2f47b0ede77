//! What all members of a round know alike: each other's facts, and the digest over them.

use super::super::{MAX_TEAM, RobotId};
use super::digest::Digester;
use super::{Claim, Digest, Fact, Heard, Protocol, Teammates, View, Waiting};

impl<F: Fact, const K: usize> Protocol<F, K> {
    /// The facts of the members that are known to be in this round, or [last](Fact::LASTS), in the
    /// order of the robots.
    pub fn facts<'a>(
        &'a self,
        teammates: &Teammates<'a, F, K>,
    ) -> impl Iterator<Item = (RobotId, &'a F)> + Clone {
        let teammates = *teammates;
        let fact = move |robot| Some((robot, self.brought(robot, &teammates)?.1));
        self.proposal.view.iter().filter_map(fact)
    }

    /// The newest message of a robot, unless it is of an earlier start than one known before.
    pub(super) fn newest<'a>(
        &self,
        robot: RobotId,
        teammates: &Teammates<'a, F, K>,
    ) -> Option<Heard<'a, F, K>> {
        teammates.get(robot).filter(|&heard| self.is_current(robot, heard))
    }

    /// Whether a robot has scored the list that this one has scored, in this round.
    pub(super) fn follows(&self, heard: Heard<'_, F, K>) -> bool {
        let message = heard.message;
        let digest = message.answer.digest();
        message.proposal.round == self.proposal.round && digest.is_some() && digest == self.digest()
    }

    /// Whether the epoch of a robot is another than the one under the digest.
    pub(super) fn has_restarted(&self, robot: RobotId, heard: Heard<'_, F, K>) -> bool {
        let epoch = self.given.as_ref().and_then(|given| given.epochs.get(robot.index()));
        epoch.is_some_and(|&epoch| epoch != heard.stamp.epoch)
    }

    /// The digest of what all members decide from.
    ///
    /// # Errors
    /// What is missing.
    pub(super) fn common(&self, teammates: &Teammates<'_, F, K>) -> Result<Digest, Waiting> {
        self.is_seated(self.proposal.view)?;
        for robot in self.others().filter(|&robot| self.lasting(robot, teammates).is_none()) {
            self.is_in_round(robot, teammates)?;
        }
        self.is_disjoint(teammates)?;
        let digest = self.sum(teammates);
        self.accepts_walls(self.is_vouched(digest, teammates))?;
        Ok(digest)
    }

    /// Whether members that are a quorum without this robot have scored what it would score: then
    /// they have checked the walls, and one of them was in every view in which a robot left out may
    /// have got the plan that it still follows.
    ///
    /// The first robot that relies on this relies on a quorum that has not restarted since. Others
    /// may then rely on the first.
    fn is_vouched(&self, digest: Digest, teammates: &Teammates<'_, F, K>) -> bool {
        let has_scored = |robot: &RobotId| {
            self.newest(*robot, teammates).and_then(|heard| heard.message.answer.digest()) == Some(digest)
        };
        self.others().filter(has_scored).collect::<View>().is_quorum(self.member.team())
    }

    /// Whether a member is known to be in this round, with the same members and walls.
    pub(super) fn is_in_round(&self, robot: RobotId, teammates: &Teammates<'_, F, K>) -> Result<(), Waiting> {
        let heard = self.newest(robot, teammates).ok_or(Waiting::Unheard(robot))?;
        if heard.message.proposal.round != self.proposal.round {
            Err(Waiting::Fact(robot))
        } else if heard.message.proposal != self.proposal {
            Err(Waiting::Proposal(robot))
        } else {
            Ok(())
        }
    }

    /// Whether no two members claim the same place. They can, if one message is outdated.
    fn is_disjoint(&self, teammates: &Teammates<'_, F, K>) -> Result<(), Waiting> {
        for (robot, fact) in self.facts(teammates) {
            let anchor = fact.anchor();
            let mut others = self.facts(teammates).filter(|&(other, _)| other > robot);
            if let Some((other, _)) = others.find(|(_, fact)| fact.anchor().overlaps(&anchor)) {
                let is_own = robot == self.member.robot();
                return Err(if is_own {
                    Waiting::Overlap(other, robot)
                } else {
                    Waiting::Overlap(robot, other)
                });
            }
        }
        Ok(())
    }

    fn sum(&self, teammates: &Teammates<'_, F, K>) -> Digest {
        let members = self.proposal.view.iter().filter_map(|robot| self.brought(robot, teammates));
        members
            .fold(Digester::new(self.mission).absorb(&self.proposal), |sum, member| sum.absorb(&member))
            .finish()
    }

    /// Epoch and fact of a member that is in this round.
    pub(super) fn declared<'a>(
        &'a self,
        robot: RobotId,
        teammates: &Teammates<'a, F, K>,
    ) -> Option<(u32, &'a F)> {
        if robot == self.member.robot() {
            return Some((self.epoch, &self.fact));
        }
        let heard = self.newest(robot, teammates)?;
        (heard.message.proposal == self.proposal).then_some((heard.stamp.epoch, &heard.message.fact))
    }

    /// Epoch and fact that a member brings: what it has declared, or what is taken to last.
    fn brought<'a>(&'a self, robot: RobotId, teammates: &Teammates<'a, F, K>) -> Option<(u32, &'a F)> {
        self.declared(robot, teammates).or_else(|| self.lasting(robot, teammates))
    }

    /// Epoch and fact of a member that was in an earlier round when it was heard last, if
    /// [facts last](Fact::LASTS).
    fn lasting<'a>(&self, robot: RobotId, teammates: &Teammates<'a, F, K>) -> Option<(u32, &'a F)> {
        let heard = self.newest(robot, teammates).filter(|_| F::LASTS && robot != self.member.robot())?;
        let is_earlier = heard.message.proposal.round < self.proposal.round;
        is_earlier.then_some((heard.stamp.epoch, &heard.message.fact))
    }

    /// Takes back scores that no member gives anymore: a member has started again, or has declared
    /// another fact than it was [taken](Fact::LASTS) to bring.
    ///
    /// A member decides by a digest only with the scores of all. None scores under a fact of its
    /// own that it has not, or under an epoch that is over: scores that it gave in that epoch stay
    /// with those who heard them, and the list for them stays within the reach of each.
    pub(super) fn take_back(&mut self, teammates: &Teammates<'_, F, K>) {
        let Some(given) = self.given.as_ref().filter(|given| given.plan.is_none()) else { return };
        let is_in_round = |robot| self.is_in_round(robot, teammates).is_ok();
        let has_restarted =
            |robot| self.newest(robot, teammates).is_some_and(|heard| self.has_restarted(robot, heard));
        let is_over = self.others().any(|robot| is_in_round(robot) && has_restarted(robot));
        let is_declared = || self.others().all(|robot| is_in_round(robot) && !has_restarted(robot));
        if is_over || (F::LASTS && is_declared() && self.sum(teammates) != given.digest) {
            self.given = None;
        }
    }

    pub(super) fn epochs(&self, teammates: &Teammates<'_, F, K>) -> [u32; MAX_TEAM] {
        let mut epochs = [0; MAX_TEAM];
        for (robot, epoch) in (0..).map(RobotId).zip(&mut epochs) {
            *epoch = self.brought(robot, teammates).map_or(0, |(epoch, _)| epoch);
        }
        epochs
    }

    pub(super) fn is_current(&self, robot: RobotId, heard: Heard<'_, F, K>) -> bool {
        self.located.get(robot.index()).is_some_and(|location| heard.stamp.epoch >= location.known.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::{Member, Stamp};
    use super::super::{Event, JointPolicies, RoundMessage, Score, Scores, View};
    use super::*;
    use serde::{Deserialize, Serialize};

    /// What a robot holds.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
    struct Load(u8);

    impl Fact for Load {
        type Claim = ();
        const MAX_BYTES: usize = 1;
        const LASTS: bool = true;

        fn anchor(&self) {}
    }

    /// One joint policy.
    struct Single;

    impl JointPolicies for Single {
        type Claim = ();

        fn len(&self) -> usize {
            1
        }
        fn cost(&self, _: usize) -> u16 {
            0
        }
        fn claim(&self, _: usize, _: RobotId, _: u16) {}
        fn moves(&self, _: usize, _: RobotId) -> u16 {
            0
        }
        fn is_clear(&self, _: usize, _: RobotId, _: u16, _: RobotId, _: u16) -> bool {
            true
        }
        fn choose<'s>(&self, _: impl Iterator<Item = (RobotId, &'s [Score])> + Clone) -> Option<usize> {
            Some(0)
        }
    }

    struct Team {
        robots: [Protocol<Load, 1>; 3],
        loads: [Load; 3],
        said: [Option<RoundMessage<Load, 1>>; 3],
        sequence: u32,
    }

    impl Team {
        fn new() -> Self {
            let member = |robot| Member::new(RobotId(robot), 3).expect("a team");
            let robot = |robot| Protocol::new(member(robot), 1, 0, Load(0));
            let robots = [robot(0), robot(1), robot(2)];
            Self { robots, loads: [Load(0); 3], said: [const { None }; 3], sequence: 0 }
        }

        /// A tick in which the robots hear what was said, score what they can, and speak; `deaf`
        /// hears nothing.
        fn tick(&mut self, opens: Option<usize>, deaf: Option<usize>) -> [Option<Event>; 3] {
            let said = self.said.clone();
            let stamp = Stamp { epoch: 1, sequence: self.sequence };
            self.sequence += 1;
            core::array::from_fn(|own| {
                let heard = said.iter().enumerate().filter(|&(robot, _)| robot != own && deaf != Some(own));
                let heard = heard.filter_map(|(robot, said)| {
                    Some((RobotId(robot as u8), Heard { stamp, message: said.as_ref()? }))
                });
                let (teammates, load): (Teammates<'_, _, 1>, _) = (heard.collect(), self.loads[own]);
                let protocol = &mut self.robots[own];
                let event = protocol.attend(&load, true, &teammates, &Single);
                if opens == Some(own) {
                    protocol.open(View::full(3), &load).expect("it may");
                }
                if let Some(digest) = protocol.wanted(&teammates) {
                    let scores: Scores<1> = [Score::default()].into_iter().collect();
                    protocol.give(digest, scores, &Single, &teammates).expect("it is of these facts");
                }
                self.said[own] = Some(protocol.message(&teammates, 0, 1.0));
                event
            })
        }

        fn ticks(&mut self, ticks: usize) {
            for _ in 0..ticks {
                self.tick(None, None);
            }
        }

        fn decided(&self) -> [bool; 3] {
            self.robots.each_ref().map(Protocol::has_decided)
        }
    }

    /// A team that has decided its first round.
    fn settled() -> Team {
        let mut team = Team::new();
        team.ticks(3);
        assert_eq!(team.decided(), [true; 3]);
        team
    }

    #[test]
    fn the_scores_go_with_the_first_message_where_the_facts_of_the_others_last() {
        let mut team = settled();
        team.loads[0] = Load(1);
        team.tick(Some(0), None);
        assert!(team.robots[0].digest().is_some() && !team.robots[0].has_decided());
        team.tick(None, None);
        team.tick(None, None);
        assert_eq!(team.decided(), [true; 3], "two ticks after it was opened");
    }

    #[test]
    fn scores_are_given_again_where_a_member_brings_another_fact() {
        for deaf in [None, Some(0), Some(1), Some(2)] {
            let mut team = settled();
            team.loads = [Load(1), Load(0), Load(7)];
            team.tick(Some(0), None);
            let first = team.robots[0].digest();
            team.tick(None, deaf);
            team.tick(None, None);
            assert!(
                team.robots.iter().all(|robot| !robot.has_decided() || robot.digest() != first),
                "{deaf:?}"
            );
            team.ticks(4);
            let digests = team.robots.each_ref().map(Protocol::digest);
            assert_eq!(team.decided(), [true; 3], "{deaf:?}");
            assert!(digests[0] != first && digests.iter().all(|digest| *digest == digests[0]), "{deaf:?}");
        }
    }
}
