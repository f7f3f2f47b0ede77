//! What a robot announces of a round.

use super::super::{Invalid, MAX_TEAM, RobotId, reading};
use super::{Claim, Digest, Fact, View};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// The most robots that a quorum leaves out.
pub const MAX_LEFT_OUT: usize = MAX_TEAM / 2;

/// What a round is opened with: its number, its members, and where the others may be.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Proposal<C: Claim> {
    /// The number: the larger one supersedes. Robot `round % team` opens it.
    pub round: u32,
    /// The members.
    pub view: View,
    /// The claims of the robots left out, in the order of their numbers: walls to the members.
    pub walls: Vec<C::Wire, MAX_LEFT_OUT>,
}

impl<C: Claim> Proposal<C> {
    /// The round that every robot begins in: the whole team, no walls.
    #[must_use]
    pub const fn first(team: usize) -> Self {
        Self { round: 0, view: View::full(team), walls: Vec::new() }
    }

    /// The robots of a team of `team` that are left out, with their claims.
    pub fn left_out(&self, team: usize) -> impl Iterator<Item = (RobotId, C)> + Clone {
        View::full(team).difference(self.view).iter().zip(self.walls.iter().map(C::from_wire))
    }

    /// The claim of a robot left out of a team of `team`; `None` for a member.
    #[must_use]
    pub fn wall(&self, robot: RobotId, team: usize) -> Option<C> {
        self.left_out(team).find_map(|(other, claim)| (other == robot).then_some(claim))
    }
}

/// What a policy costs a robot, by what only this robot knows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Score {
    /// How much later than the policy's end the robot expects to arrive, in 1/8 tick.
    pub delay: u8,
    /// What else the policy costs it (energy, wear), in 1/8 tick.
    pub price: u8,
}

impl Score {
    /// The number that stands for "cannot", as a delay or as a price.
    pub const IMPOSSIBLE: u8 = u8::MAX;

    /// The robot cannot follow the policy.
    pub const CANNOT: Self = Self { delay: Self::IMPOSSIBLE, price: Self::IMPOSSIBLE };

    /// A cost in 1/8 tick as a delay or a price: one that is too large counts as the largest that
    /// is not "cannot".
    ///
    /// ```
    /// use iibt_core::team::rounds::Score;
    ///
    /// assert_eq!([7, 255, 9000].map(Score::finite), [7, 254, 254]);
    /// ```
    #[must_use]
    pub fn finite(cost: u16) -> u8 {
        u8::try_from(cost).unwrap_or(u8::MAX).min(Self::IMPOSSIBLE - 1)
    }
}

/// A robot's scores of the policies of a list, in the order of the list.
pub type Scores<const K: usize> = Vec<Score, K>;

/// The chosen policy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Choice {
    /// Its number in the list.
    pub policy: u8,
    /// Its posterior probability in 1/255.
    pub probability: u8,
}

impl Choice {
    /// The choice of a policy that has this probability.
    pub(super) fn new(policy: u8, probability: f32) -> Self {
        Self { policy, probability: (255.0 * probability + 0.5) as u8 } // a cast saturates
    }
}

/// How far a robot is in its round.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Answer<const K: usize> {
    /// It has announced its fact, and works on the list, of which this many policies are done.
    Listing(u8),
    /// It has scored the list that belongs to the digest.
    Scored {
        /// What the list was made from.
        digest: Digest,
        /// The scores.
        scores: Scores<K>,
    },
    /// It knows every member's scores, and so the choice.
    Decided {
        /// What the list was made from.
        digest: Digest,
        /// Its scores, until every member has said that it has decided.
        scores: Option<Scores<K>>,
        /// The choice; `None` if every policy is impossible for some member.
        choice: Option<Choice>,
        /// The number of steps of its path that are done.
        step: u16,
    },
}

impl<const K: usize> Answer<K> {
    /// Takes what [`Serialize`] writes from the front of `bytes`.
    #[inline]
    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let mut scores = Vec::new();
        match reading::value::<u32>(bytes)? {
            0 => Some(Self::Listing(reading::value(bytes)?)),
            1 => {
                let digest = reading::value(bytes)?;
                reading::list(&mut scores, bytes)?;
                Some(Self::Scored { digest, scores })
            }
            2 => {
                let digest = reading::value(bytes)?;
                let has_scores = reading::value::<Option<()>>(bytes)?.is_some();
                if has_scores {
                    reading::list(&mut scores, bytes)?;
                }
                let (choice, step) = (reading::value(bytes)?, reading::value(bytes)?);
                Some(Self::Decided { digest, scores: Some(scores).filter(|_| has_scores), choice, step })
            }
            _ => None,
        }
    }

    /// The digest of the list that the robot has scored.
    #[must_use]
    pub const fn digest(&self) -> Option<Digest> {
        match self {
            Self::Listing(_) => None,
            Self::Scored { digest, .. } | Self::Decided { digest, .. } => Some(*digest),
        }
    }

    /// The robot's scores, as long as it sends them.
    #[must_use]
    pub const fn scores(&self) -> Option<&Scores<K>> {
        match self {
            Self::Listing(_) => None,
            Self::Scored { scores, .. } => Some(scores),
            Self::Decided { scores, .. } => scores.as_ref(),
        }
    }

    /// The number of steps done: zero before the robot has decided.
    #[must_use]
    pub const fn step(&self) -> u16 {
        if let Self::Decided { step, .. } = self { *step } else { 0 }
    }
}

/// The part of a task's message that belongs to the rounds.
///
/// In postcard: number (varint of 1 to 5 bytes), view (1), walls (a count and one each), the fact,
/// then a tag byte and the answer. Two bytes a policy, as long as they are needed.
///
/// ```
/// use iibt_core::team::rounds::{Answer, Fact, Proposal, RoundMessage};
/// use serde::{Deserialize, Serialize};
///
/// #[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
/// struct Reading(u8);
///
/// impl Fact for Reading {
///     type Claim = ();
///     const MAX_BYTES: usize = 1;
///
///     fn anchor(&self) {}
/// }
///
/// let message = RoundMessage::<Reading, 4> {
///     proposal: Proposal { round: 300, ..Proposal::first(3) },
///     fact: Reading(7),
///     answer: Answer::Listing(2),
/// };
/// assert!(message.validate(3).is_ok());
/// assert!(message.validate(2).is_err(), "its view has three members");
/// let mut buffer = [0; RoundMessage::<Reading, 4>::MAX_BYTES];
/// let bytes = postcard::to_slice(&message, &mut buffer)?;
/// assert_eq!(bytes, &[0xac, 0x02, 0b111, 0, 7, 0, 2]);
/// # Ok::<(), postcard::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct RoundMessage<F: Fact, const K: usize> {
    /// The round that the robot is in.
    pub proposal: Proposal<F::Claim>,
    /// Its fact, frozen when it joined.
    pub fact: F,
    /// How far it is.
    pub answer: Answer<K>,
}

impl<F: Fact, const K: usize> RoundMessage<F, K> {
    /// The layout, for the [`SCHEMA`](super::super::Message::SCHEMA) of a message that holds this
    /// part; the task adds what its fact and its claim are.
    pub const LAYOUT: &'static str = "round u32; view u8; walls sequence; fact; answer Listing u8, \
        Scored digest 4 u8 scores sequence u8 u8, Decided digest 4 u8 option scores option policy u8 \
        probability u8 step u16";

    /// The longest encoding in bytes.
    pub const MAX_BYTES: usize = {
        assert!(K < 128, "one byte counts the scores");
        let proposal = 5 + 1 + 1 + <F::Claim as Claim>::WIRE_BYTES;
        let decided = 4 + (1 + 1 + 2 * K) + (1 + 2) + 3;
        proposal + F::MAX_BYTES + 1 + decided
    };

    /// The view has robots that the team does not have.
    pub const STRANGER: Invalid = Invalid("the view has a robot that the team does not have");
    /// There is not one wall for each robot that is left out.
    pub const WALLS: Invalid = Invalid("there is not one wall for each robot left out");
    /// More policies are done than a list has.
    pub const LISTING: Invalid = Invalid("more policies are done than a list can have");
    /// The chosen policy is not in the list.
    pub const CHOICE: Invalid = Invalid("the chosen policy is beyond the end of the list");

    /// Reads what [`Serialize`] writes, for the [`read_into`](super::super::Message::read_into) of
    /// a message that holds this part; returns the bytes that follow.
    ///
    /// Field by field: each value that is handed on by serde is copied several times, and the
    /// walls are large.
    #[must_use]
    pub fn read_into<'b>(&mut self, mut bytes: &'b [u8]) -> Option<&'b [u8]> {
        self.proposal.round = reading::value(&mut bytes)?;
        self.proposal.view = reading::value(&mut bytes)?;
        reading::list(&mut self.proposal.walls, &mut bytes)?;
        bytes = self.fact.read_into(bytes)?;
        self.answer = Answer::read(&mut bytes)?;
        Some(bytes)
    }

    /// Checks what the types do not say, for a team of `team` robots.
    ///
    /// # Errors
    /// [`Invalid`] with the first value that is out of its range.
    pub fn validate(&self, team: usize) -> Result<(), Invalid> {
        let Proposal { view, walls, .. } = &self.proposal;
        if !view.fits(team) {
            return Err(Self::STRANGER);
        }
        if view.len() + walls.len() != team.min(MAX_TEAM) {
            return Err(Self::WALLS);
        }
        match &self.answer {
            Answer::Listing(done) if usize::from(*done) > K => Err(Self::LISTING),
            Answer::Decided { scores, choice: Some(choice), .. }
                if usize::from(choice.policy) >= scores.as_ref().map_or(K, |scores| scores.len()) =>
            {
                Err(Self::CHOICE)
            }
            _ => Ok(()),
        }
    }
}

#[cfg(feature = "defmt")]
impl<F: Fact + defmt::Format, const K: usize> defmt::Format for RoundMessage<F, K> {
    fn format(&self, f: defmt::Formatter<'_>) {
        let Proposal { round, view, .. } = &self.proposal;
        defmt::write!(f, "round {} {} {} {}", round, view, self.fact, self.answer);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::team::{Key, MAX_FRAME, Message, SipHash64, Stamp};
    use std::vec::Vec as List;

    /// What navigation says: a cell or two, a purpose and its cell, evidence on four unknowns.
    #[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
    struct Whole {
        anchor: (u16, Option<u16>),
        purpose: (u8, u16),
        evidence: Vec<(u16, i8), 4>,
    }

    /// Cells as a list of three rectangles at most.
    #[derive(Clone, Debug, PartialEq, Eq, Hash)]
    struct Cells;

    impl Claim for Cells {
        type Wire = Vec<[u8; 4], 3>;
        const WIRE_BYTES: usize = 27; // 3 x 9: two rectangles for each of three
        const EMPTY: Self = Self;

        fn union(&self, _: &Self) -> Self {
            Self
        }
        fn contains(&self, _: &Self) -> bool {
            true
        }
        fn overlaps(&self, _: &Self) -> bool {
            false
        }
        fn to_wire(&self, left_out: usize) -> Self::Wire {
            let rectangles = [3, 3, 3, 2, 1].get(left_out).copied().unwrap_or(0);
            (0..rectangles).map(|_| [1, 2, 3, 4]).collect()
        }
        fn from_wire(_: &Self::Wire) -> Self {
            Self
        }
    }

    impl Fact for Whole {
        type Claim = Cells;
        const MAX_BYTES: usize = 2 + 3 + 3 + 1 + 4 * 3; // cells below 2^14

        fn anchor(&self) -> Cells {
            Cells
        }
    }

    #[derive(Clone, Debug, Serialize, Deserialize)]
    struct Frame(RoundMessage<Whole, 16>);

    impl Message for Frame {
        const SCHEMA: &'static str = RoundMessage::<Whole, 16>::LAYOUT;
        const MAX_BYTES: usize = RoundMessage::<Whole, 16>::MAX_BYTES;
    }

    fn message(left_out: usize, answer: Answer<16>) -> RoundMessage<Whole, 16> {
        let view = View::full(8 - left_out);
        let walls = (0..left_out).map(|_| Cells.to_wire(left_out)).collect();
        let evidence = [(200, 1), (201, -1), (202, 3), (203, -3)].into_iter().collect();
        let fact = Whole { anchor: (100, None), purpose: (1, 200), evidence };
        RoundMessage { proposal: Proposal { round: 300, view, walls }, fact, answer }
    }

    fn scores() -> Scores<16> {
        [Score { delay: 8, price: 2 }; 16].into_iter().collect()
    }

    fn scored() -> Answer<16> {
        Answer::Scored { digest: Digest([1, 2, 3, 4]), scores: scores() }
    }

    fn decided(scores: Option<Scores<16>>) -> Answer<16> {
        let choice = Some(Choice { policy: 15, probability: 200 });
        Answer::Decided { digest: Digest([1, 2, 3, 4]), scores, choice, step: 9 }
    }

    /// Both delimiters, COBS, header and tag included.
    fn frame_bytes(message: RoundMessage<Whole, 16>) -> usize {
        let stamp = Stamp { epoch: 40, sequence: 100_000 };
        let envelope = super::super::super::Envelope { sender: RobotId(1), stamp, message: Frame(message) };
        let auth = SipHash64::new(Key::new([7; 16]));
        let mut buffer = [0; MAX_FRAME];
        let context = super::super::super::Context::of::<Frame>(1, 1);
        super::super::super::encode(&envelope, &auth, context, &mut buffer).expect("it fits").len()
    }

    #[test]
    fn a_frame_has_85_bytes_deciding_and_53_driving_and_14_more_for_each_robot_left_out() {
        let full =
            [scored(), decided(Some(scores())), decided(None)].map(|answer| frame_bytes(message(0, answer)));
        assert_eq!(full, [77, 82, 49]);
        assert!(full[0].max(full[1]) <= 85 && full[2] <= 53);
        for left_out in 1..=3 {
            assert!(
                frame_bytes(message(left_out, scored())) <= full[0] + 14 * left_out,
                "{left_out} left out"
            );
        }
        assert!(frame_bytes(message(4, decided(Some(scores())))) <= MAX_FRAME);
    }

    #[test]
    fn is_read_as_it_was_written_and_never_longer_than_said() {
        for answer in [Answer::Listing(3), scored(), decided(None), decided(Some(scores()))] {
            let message = RoundMessage { answer, ..message(2, scored()) };
            let mut buffer = [0; RoundMessage::<Whole, 16>::MAX_BYTES];
            let bytes: List<u8> = postcard::to_slice(&message, &mut buffer).expect("it fits").to_vec();
            assert_eq!(postcard::from_bytes(&bytes), Ok(message));
        }
    }

    /// Field by field as by serde, whatever the bytes: whole messages, changed and cut ones.
    #[test]
    fn any_bytes_are_read_as_serde_reads_them() {
        type Round = RoundMessage<Whole, 16>;
        let answers = || [Answer::Listing(3), scored(), decided(None), decided(Some(scores()))];
        let mut random = 1_u32;
        let mut draw = |below: usize| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 16) as usize % below
        };
        let mut read = 0;
        for (left_out, answer) in (0..=4).flat_map(|left_out| answers().map(|answer| (left_out, answer))) {
            let mut buffer = [0; Round::MAX_BYTES];
            let whole =
                postcard::to_slice(&message(left_out, answer), &mut buffer).expect("it fits").to_vec();
            for _ in 0..2000 {
                let mut bytes = whole.clone();
                bytes.push(9);
                for _ in 0..draw(3) {
                    let at = draw(bytes.len());
                    bytes[at] = draw(256) as u8;
                }
                bytes.truncate(whole.len() + 1 - draw(3));
                let expected = postcard::take_from_bytes::<Round>(&bytes).ok();
                read += usize::from(expected.is_some());
                let mut other = message(1, scored());
                let rest = other.read_into(&bytes);
                assert_eq!(rest.map(|rest| (other, rest)), expected, "{bytes:?}");
            }
        }
        assert!((10_000..39_000).contains(&read), "{read}");
    }

    #[test]
    fn names_the_value_that_is_out_of_range() {
        type Round = RoundMessage<Whole, 16>;
        let policy = |policy| Answer::Decided {
            digest: Digest([0; 4]),
            scores: None,
            choice: Some(Choice { policy, probability: 0 }),
            step: 0,
        };
        let of = |answer| message(2, answer);
        assert_eq!(of(scored()).validate(8), Ok(()));
        assert_eq!(of(scored()).validate(5), Err(Round::STRANGER));
        assert_eq!(of(scored()).validate(7), Err(Round::WALLS));
        assert_eq!(of(Answer::Listing(16)).validate(8), Ok(()));
        assert_eq!(of(Answer::Listing(17)).validate(8), Err(Round::LISTING));
        assert_eq!(of(policy(15)).validate(8), Ok(()));
        assert_eq!(of(policy(16)).validate(8), Err(Round::CHOICE));
    }
}
