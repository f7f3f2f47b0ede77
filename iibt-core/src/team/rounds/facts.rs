//! What all members of a round know alike: each other's facts, and the digest over them.

use super::super::{MAX_TEAM, RobotId};
use super::digest::Digester;
use super::{Claim, Digest, Fact, Heard, Protocol, Teammates, Waiting};

impl<F: Fact, const K: usize> Protocol<F, K> {
    /// The facts of the members that are known to be in this round, in the order of the robots.
    pub fn facts<'a>(
        &'a self,
        teammates: &Teammates<'a, F, K>,
    ) -> impl Iterator<Item = (RobotId, &'a F)> + Clone {
        let teammates = *teammates;
        let fact = move |robot| Some((robot, self.declared(robot, &teammates)?.1));
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
        for robot in self.others() {
            self.is_in_round(robot, teammates)?;
        }
        self.is_disjoint(teammates)?;
        self.accepts_walls()?;
        Ok(self.sum(teammates))
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
        let members = self.proposal.view.iter().filter_map(|robot| self.declared(robot, teammates));
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

    pub(super) fn epochs(&self, teammates: &Teammates<'_, F, K>) -> [u32; MAX_TEAM] {
        let mut epochs = [0; MAX_TEAM];
        for (robot, epoch) in (0..).map(RobotId).zip(&mut epochs) {
            *epoch = self.declared(robot, teammates).map_or(0, |(epoch, _)| epoch);
        }
        epochs
    }

    pub(super) fn is_current(&self, robot: RobotId, heard: Heard<'_, F, K>) -> bool {
        self.located.get(robot.index()).is_some_and(|location| heard.stamp.epoch >= location.known.0)
    }
}
