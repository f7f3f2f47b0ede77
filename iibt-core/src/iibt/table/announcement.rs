//! The announcement of a robot with a table task.

use super::definition::MAX_FACTORS;
use crate::team::{Invalid, Message};
use serde::{Deserialize, Serialize};

/// Where a robot is sure to be, what it is doing, and how sure its decision was: 3 to 7 bytes in a
/// frame, and those of `X`, which a robot adds for uses of its own.
///
/// ```
/// use iibt_core::iibt::table::Announcement;
/// use iibt_core::team::Message;
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
/// let said = Announcement::new([Some(3), None], 1, 0.75).with(Charge(80));
/// assert_eq!((said.state(0), said.state(1), said.operator()), (Some(3), None, 1));
/// assert!((said.probability() - 0.75).abs() < 0.002);
/// assert_eq!((said.own, Announcement::<Charge>::MAX_BYTES), (Charge(80), 8));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Announcement<X = ()> {
    /// Half a byte per factor, the first lowest: its state plus one, zero for one that is not
    /// known.
    states: u32,
    operator: u8,
    probability: u8,
    /// What the robot adds for uses of its own.
    pub own: X,
}

impl Announcement {
    /// An announcement of the state of each factor, `None` for one that the robot is not sure of,
    /// of the operator under way, and of the posterior probability of the last decision.
    #[must_use]
    pub fn new(states: impl IntoIterator<Item = Option<u8>>, operator: u8, probability: f32) -> Self {
        let packed = states.into_iter().take(MAX_FACTORS).zip(0..).fold(0, |packed, (state, factor)| {
            let code = state.map_or(0, |state| (u32::from(state) + 1) & 0xf);
            packed | code << (4 * factor)
        });
        let probability = (probability.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        Self { states: packed, operator, probability, own: () }
    }
}

impl<X> Announcement<X> {
    /// The same announcement with another addition.
    #[must_use]
    pub fn with<Y>(&self, own: Y) -> Announcement<Y> {
        let &Self { states, operator, probability, .. } = self;
        Announcement { states, operator, probability, own }
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

    /// The posterior probability of the sender's last decision, to a 255th.
    #[must_use]
    pub fn probability(&self) -> f32 {
        f32::from(self.probability) / 255.0
    }
}

impl<X: Message> Message for Announcement<X> {
    const SCHEMA: &'static str = "iibt.table.announcement/1: states u32, operator u8, probability u8; ";
    const PART_SCHEMA: &'static str = X::SCHEMA;
    const MAX_BYTES: usize = 7 + X::MAX_BYTES;

    fn validate(&self) -> Result<(), Invalid> {
        if usize::from(self.operator) < super::definition::MAX_OPERATORS {
            self.own.validate()
        } else {
            Err(Invalid("the operator has a number of 16 or above"))
        }
    }

    fn takes_part(&self) -> bool {
        self.own.takes_part()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::team::Context;

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

    #[test]
    fn an_addition_is_part_of_the_layout_and_of_what_is_checked() {
        assert_ne!(Context::of::<Announcement<Charge>>(1, 1), Context::of::<Announcement>(1, 1));
        let said = Announcement::new([Some(3)], 1, 1.0);
        let with = |percent| said.with(Charge(percent));
        assert!(said.validate().is_ok() && with(100).validate().is_ok());
        assert_eq!(with(101).validate(), Err(Invalid("more than full")));
        assert!(with(21).takes_part() && !with(20).takes_part());
    }
}
