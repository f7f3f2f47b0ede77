//! What a robot with a table task announces: its fact of a round, and the message around it.

use super::definition::{MAX_FACTORS, MAX_OPERATORS};
use super::joint::MAX_POLICIES;
use crate::team::rounds::{self, RoundMessage};
use crate::team::{Invalid, Message};
use serde::{Deserialize, Serialize};

/// The states that a robot is sure of, the operator that it has under way, and the one that it
/// would choose by itself: 3 to 7 bytes in a frame.
///
/// In a round of a team it is frozen, so that all decide from the same. Robots with table tasks
/// share no space, so it claims nothing.
///
/// ```
/// use iibt_core::iibt::table::Announcement;
/// use iibt_core::team::rounds::Fact;
///
/// let said = Announcement::new([Some(3), None], 2, 1);
/// assert_eq!((said.state(0), said.state(1)), (Some(3), None));
/// assert_eq!((said.operator(), said.intends()), (2, 1));
/// assert_eq!(said.anchor(), ());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Announcement {
    /// Half a byte per factor, the first lowest: its state plus one, zero for one that is not
    /// known.
    states: u32,
    operator: u8,
    intends: u8,
}

impl Announcement {
    /// An announcement of the state of each factor, `None` for one that the robot is not sure of,
    /// of the operator under way, the idle one if there is none, and of the one that it would
    /// choose.
    #[must_use]
    pub fn new(states: impl IntoIterator<Item = Option<u8>>, operator: u8, intends: u8) -> Self {
        let packed = states.into_iter().take(MAX_FACTORS).zip(0..).fold(0, |packed, (state, factor)| {
            let code = state.map_or(0, |state| (u32::from(state) + 1) & 0xf);
            packed | code << (4 * factor)
        });
        Self { states: packed, operator, intends }
    }

    /// The state of a factor; `None` where the sender is not sure, or does not have the factor.
    #[must_use]
    pub fn state(&self, factor: usize) -> Option<u8> {
        let code = if factor < MAX_FACTORS { self.states >> (4 * factor) & 0xf } else { 0 };
        u8::try_from(code).ok()?.checked_sub(1)
    }

    /// The operator under way, the idle one if there is none.
    #[must_use]
    pub const fn operator(&self) -> u8 {
        self.operator
    }

    /// The operator that the robot would choose if it decided alone.
    #[must_use]
    pub const fn intends(&self) -> u8 {
        self.intends
    }

    /// Whether another robot would decide from this as from the other, whatever is intended.
    pub(super) const fn is_as(&self, other: &Self) -> bool {
        self.states == other.states && self.operator == other.operator
    }
}

impl rounds::Fact for Announcement {
    type Claim = ();
    const MAX_BYTES: usize = 5 + 1 + 1;
    /// Most robots wait for most of the rounds that others open.
    const LASTS: bool = true;

    fn anchor(&self) {}
}

/// The message of a robot with a table task: its part of the team's [round](crate::team::rounds),
/// and what it adds for uses of its own.
///
/// ```
/// use iibt_core::iibt::table::{Announcement, TableMessage};
/// use iibt_core::team::Message;
/// use iibt_core::team::rounds::{Answer, Proposal, RoundMessage};
/// use serde::{Deserialize, Serialize};
///
/// /// The charge of a battery in percent.
/// #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
/// struct Charge(u8);
///
/// impl Message for Charge {
///     const SCHEMA: &'static str = "charge: percent u8";
///     const MAX_BYTES: usize = 1;
/// }
///
/// let fact = Announcement::new([Some(3)], 0, 1);
/// let round = RoundMessage { proposal: Proposal::first(2), fact, answer: Answer::Listing(0) };
/// let said = TableMessage { round, own: () }.with(Charge(80));
/// assert_eq!((said.fact().state(0), said.own), (Some(3), Charge(80)));
/// assert_eq!(TableMessage::<Charge>::MAX_BYTES, TableMessage::<()>::MAX_BYTES + 1);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TableMessage<X = ()> {
    /// How far the robot is in its round.
    pub round: RoundMessage<Announcement, MAX_POLICIES>,
    /// What the robot adds for uses of its own.
    pub own: X,
}

impl<X> TableMessage<X> {
    /// The same message with another addition.
    #[must_use]
    pub fn with<Y>(self, own: Y) -> TableMessage<Y> {
        TableMessage { round: self.round, own }
    }

    /// What the robot has announced for its round.
    #[must_use]
    pub const fn fact(&self) -> &Announcement {
        &self.round.fact
    }
}

impl<X> AsRef<RoundMessage<Announcement, MAX_POLICIES>> for TableMessage<X> {
    fn as_ref(&self) -> &RoundMessage<Announcement, MAX_POLICIES> {
        &self.round
    }
}

impl<X: Message> Message for TableMessage<X> {
    const SCHEMA: &'static str = "iibt.table 2: round u32; view u8; walls sequence of nothing; states u32 operator \
        u8 intends u8; answer Listing u8, Scored digest 4 u8 scores sequence delay u8 price u8, Decided digest 4 u8 \
        option scores option policy u8 probability u8 step u16; own ";
    const PART_SCHEMA: &'static str = X::SCHEMA;
    const MAX_BYTES: usize = RoundMessage::<Announcement, MAX_POLICIES>::MAX_BYTES + X::MAX_BYTES;

    fn validate(&self) -> Result<(), Invalid> {
        let Announcement { operator, intends, .. } = *self.fact();
        if usize::from(operator.max(intends)) < MAX_OPERATORS {
            self.own.validate()
        } else {
            Err(Invalid("an operator has a number of 16 or above"))
        }
    }

    fn takes_part(&self) -> bool {
        self.own.takes_part()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::team::rounds::{Answer, Proposal, View};
    use crate::team::{Context, RobotId};

    #[derive(Clone, Copy, Serialize, Deserialize)]
    struct Charge(u8);

    impl Message for Charge {
        const SCHEMA: &'static str = "charge u8";
        const MAX_BYTES: usize = 1;

        fn validate(&self) -> Result<(), Invalid> {
            if self.0 <= 100 { Ok(()) } else { Err(Invalid("more than full")) }
        }
        fn takes_part(&self) -> bool {
            self.0 > 20
        }
    }

    fn said(operator: u8, intends: u8) -> TableMessage {
        let fact = Announcement::new([Some(3)], operator, intends);
        let round = RoundMessage { proposal: Proposal::first(2), fact, answer: Answer::Listing(0) };
        TableMessage { round, own: () }
    }

    #[test]
    fn an_addition_is_part_of_the_layout_and_of_what_is_checked() {
        assert_ne!(Context::of::<TableMessage<Charge>>(1, 1), Context::of::<TableMessage>(1, 1));
        let with = |percent| said(1, 1).with(Charge(percent));
        assert!(said(1, 15).validate().is_ok() && with(100).validate().is_ok());
        assert_eq!(with(101).validate(), Err(Invalid("more than full")));
        assert!(with(21).takes_part() && !with(20).takes_part());
        assert!(said(16, 0).validate().is_err() && said(0, 16).validate().is_err());
    }

    #[test]
    fn a_robot_left_out_is_a_wall_of_no_bytes() {
        let view = View::full(3).without(RobotId(2));
        let proposal = Proposal { round: 5, view, walls: [()].into_iter().collect() };
        let of_three = RoundMessage { proposal, ..said(1, 2).round };
        let mut buffer = [0; RoundMessage::<Announcement, MAX_POLICIES>::MAX_BYTES];
        let bytes = postcard::to_slice(&of_three, &mut buffer).expect("it fits");
        assert_eq!(bytes, &[5, 0b011, 1, 4, 1, 2, 0, 0]);
        assert_eq!(postcard::from_bytes(bytes), Ok(of_three.clone()));
        assert_eq!(of_three.validate(3), Ok(()));
    }
}
