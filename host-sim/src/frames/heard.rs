//! Recorded frames of any team that decides in rounds, round by round.

use iibt_core::team::rounds::{Answer, Choice, Fact, Proposal, RoundMessage};
use iibt_core::team::{
    Context, Deframer, Envelope, Invalid, Key, Keys, MAX_TEAM, Message, RobotId, SipHash64, Stamp, decode,
};
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// What was heard so far.
pub(super) struct Heard<F: Fact, M> {
    /// The number of frames that were accepted.
    pub(super) accepted: u32,
    /// The reasons why others were refused, and how often.
    pub(super) refused: BTreeMap<String, u32>,
    /// The rounds by their numbers.
    pub(super) rounds: Vec<Round<F, M>>,
    /// How many frames of each sender another robot with its number has sent.
    pub(super) twins: BTreeMap<RobotId, u32>,
}

/// What the members of one round have said.
pub(super) struct Round<F: Fact, M> {
    pub(super) proposal: Proposal<F::Claim>,
    /// Empty for robots that are no members, and for those whose facts are missing.
    pub(super) facts: [Option<F>; MAX_TEAM],
    pub(super) made: [u16; MAX_TEAM],
    /// The newest message of each.
    pub(super) newest: [Option<M>; MAX_TEAM],
    pub(super) choice: Option<Choice>,
}

impl<F: Fact, M> Heard<F, M> {
    /// Reads frames with their delimiters.
    pub(super) fn read<const K: usize>(
        bytes: &[u8],
        key: &Key,
        context: Context,
        accepts: impl Fn(&M) -> Result<(), Invalid>,
    ) -> Self
    where
        M: Message + AsRef<RoundMessage<F, K>>,
    {
        let mut heard =
            Self { accepted: 0, refused: BTreeMap::new(), rounds: Vec::new(), twins: BTreeMap::new() };
        let mut stamps = Stamps::default();
        // Robots that were provisioned send under keys of their own, those of the simulator under
        // one.
        let auth = SipHash64::with(Keys::of_team(key, 0, 0).accepting(&Keys::shared(key)));
        let mut deframer = Deframer::new();
        // A delimiter more, so that a frame that was cut off is refused and not forgotten.
        for &byte in bytes.iter().chain(&[0]) {
            let Some(frame) = deframer.feed(byte) else { continue };
            let read = decode::<M>(frame, &auth, context).map_err(|error| error.to_string());
            let read = read.and_then(|envelope: Envelope<M>| {
                let accepted = accepts(&envelope.message).map_err(|invalid| invalid.to_string());
                accepted.map(|()| envelope)
            });
            match read {
                Ok(Envelope { sender, stamp, message }) => {
                    if !stamps.note(sender, stamp, frame) {
                        *heard.twins.entry(sender).or_default() += 1;
                    }
                    heard.note(sender, message);
                }
                Err(reason) => *heard.refused.entry(reason).or_default() += 1,
            }
        }
        if deframer.dropped() > 0 {
            heard.refused.insert("longer than the longest frame".to_owned(), deframer.dropped());
        }
        heard.rounds.sort_by_key(|round| round.proposal.round);
        heard
    }

    fn note<const K: usize>(&mut self, sender: RobotId, said: M)
    where
        M: AsRef<RoundMessage<F, K>>,
    {
        self.accepted += 1;
        let message = said.as_ref();
        let known = self.rounds.iter().position(|round| round.proposal == message.proposal);
        let index = known.unwrap_or_else(|| {
            let proposal = message.proposal.clone();
            self.rounds.push(Round {
                proposal,
                facts: [const { None }; MAX_TEAM],
                made: [0; MAX_TEAM],
                newest: [const { None }; MAX_TEAM],
                choice: None,
            });
            self.rounds.len() - 1
        });
        let round = &mut self.rounds[index];
        if round.proposal.view.contains(sender) {
            round.facts[sender.index()] = Some(message.fact.clone());
        }
        if let Answer::Decided { choice: Some(choice), .. } = message.answer {
            round.choice = Some(choice);
        }
        // A frame that a teammate has passed on can be older than one before it.
        let made = &mut round.made[sender.index()];
        if message.answer.step() >= *made {
            *made = message.answer.step();
            round.newest[sender.index()] = Some(said);
        }
    }
}

/// The stamps of the frames so far.
#[derive(Default)]
struct Stamps {
    /// A number for the bytes of the frame with each stamp.
    contents: BTreeMap<(RobotId, Stamp), u64>,
    /// The largest sequence number of each sender in each epoch.
    newest: BTreeMap<(RobotId, u32), u32>,
}

impl Stamps {
    /// How far the numbers of one robot may go back: twice as far as those of frames that teammates
    /// pass on.
    const LATE: u32 = 16;

    /// Notes a frame; returns whether it can be of the robot that sent the others of its number.
    /// One robot numbers its frames in order and each once; the same frame may be heard again.
    fn note(&mut self, sender: RobotId, stamp: Stamp, frame: &[u8]) -> bool {
        let mut hasher = DefaultHasher::new();
        frame.hash(&mut hasher);
        let content = hasher.finish();
        if let Some(known) = self.contents.get(&(sender, stamp)) {
            return *known == content;
        }
        self.contents.insert((sender, stamp), content);
        let newest = self.newest.entry((sender, stamp.epoch)).or_default();
        let is_in_order = stamp.sequence.saturating_add(Self::LATE) >= *newest;
        *newest = stamp.sequence.max(*newest);
        is_in_order
    }
}

impl<F: Fact, M> Round<F, M> {
    /// The members.
    pub(super) fn members(&self) -> impl Iterator<Item = RobotId> + Clone + use<F, M> {
        self.proposal.view.iter()
    }

    /// The members whose facts are missing.
    pub(super) fn missing(&self) -> impl Iterator<Item = RobotId> {
        self.members().filter(|robot| self.facts[robot.index()].is_none())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Which of the frames, by sequence number and content, cannot be of one robot.
    fn strange(frames: &[(u32, u8)]) -> Vec<u32> {
        let mut stamps = Stamps::default();
        let is_strange = |&&(sequence, content): &&(u32, u8)| {
            !stamps.note(RobotId(1), Stamp { epoch: 3, sequence }, &[content])
        };
        frames.iter().filter(is_strange).map(|&(sequence, _)| sequence).collect()
    }

    #[test]
    fn two_frames_of_one_number_or_numbers_that_go_back_are_of_two_robots() {
        assert_eq!(strange(&[(0, 9), (1, 9), (1, 9), (0, 9), (2, 8)]), [0; 0], "heard again");
        assert_eq!(strange(&[(0, 9), (20, 9), (4, 7), (5, 7)]), [0; 0], "passed on late by a teammate");
        assert_eq!(strange(&[(0, 9), (1, 9), (1, 8), (0, 8), (2, 9)]), [1, 0]);
        assert_eq!(strange(&[(40, 9), (7, 8), (41, 9), (8, 8), (42, 9)]), [7, 8]);
    }
}
