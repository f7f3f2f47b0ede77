//! What a robot may occupy, and what it announces for a round.

use core::fmt::Debug;
use core::hash::Hash;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A part of what the robots of a task share, such as cells of a grid: where a robot may be.
///
/// Claims only have to be large enough: any superset of the truth is sound, and costs the others
/// space. A task whose robots share nothing claims `()`.
///
/// ```
/// use iibt_core::team::rounds::Claim;
///
/// /// Up to eight docks, one bit each.
/// #[derive(Clone, Debug, PartialEq, Eq, Hash)]
/// struct Docks(u8);
///
/// impl Claim for Docks {
///     type Wire = u8;
///     const WIRE_BYTES: usize = 4; // a quorum leaves out at most four robots of eight
///     const EMPTY: Self = Self(0);
///
///     fn union(&self, other: &Self) -> Self {
///         Self(self.0 | other.0)
///     }
///     fn contains(&self, other: &Self) -> bool {
///         other.0 & !self.0 == 0
///     }
///     fn overlaps(&self, other: &Self) -> bool {
///         self.0 & other.0 != 0
///     }
///     fn to_wire(&self, _: usize) -> u8 {
///         self.0
///     }
///     fn from_wire(wire: &u8) -> Self {
///         Self(*wire)
///     }
/// }
///
/// let (left, right) = (Docks(0b0011), Docks(0b1100));
/// let both = left.union(&right);
/// assert!(both.contains(&left) && !left.contains(&both) && !left.overlaps(&right));
/// assert!(Docks::from_wire(&both.to_wire(1)).contains(&both));
/// ```
#[doc(alias = "reachable set")]
#[doc(alias = "reservation")]
pub trait Claim: Clone + Debug + Eq + Hash {
    /// What a frame carries of a claim.
    type Wire: Clone + Debug + Eq + Hash + Serialize + DeserializeOwned;

    /// The most bytes that the claims of all robots left out take in a frame together.
    const WIRE_BYTES: usize;

    /// Nothing.
    const EMPTY: Self;

    /// What either claim has.
    #[must_use]
    fn union(&self, other: &Self) -> Self;

    /// Whether this claim has all that the other has.
    fn contains(&self, other: &Self) -> bool;

    /// Whether the claims have something in common.
    fn overlaps(&self, other: &Self) -> bool;

    /// A form for the frame that holds at least this claim, small enough that those of `left_out`
    /// robots fit a frame together.
    fn to_wire(&self, left_out: usize) -> Self::Wire;

    /// The claim that a frame carries.
    fn from_wire(wire: &Self::Wire) -> Self;
}

impl Claim for () {
    type Wire = ();
    const WIRE_BYTES: usize = 0;
    const EMPTY: Self = ();

    fn union(&self, (): &Self) -> Self {}

    fn contains(&self, (): &Self) -> bool {
        true
    }

    fn overlaps(&self, (): &Self) -> bool {
        false
    }

    fn to_wire(&self, _: usize) -> Self::Wire {}

    fn from_wire((): &Self::Wire) -> Self {}
}

/// What a robot announces for a round: where it stands, what it is for, what it has observed.
///
/// A fact is frozen when the robot joins the round, so that all members plan from the same. The
/// digest is taken over the bytes that the frame carries.
///
/// ```
/// use iibt_core::team::rounds::Fact;
/// use serde::{Deserialize, Serialize};
///
/// /// The reading of a valve, in a task whose robots share no space.
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
/// assert_eq!(Reading(3).anchor(), ());
/// ```
pub trait Fact: Clone + Debug + Eq + Hash + Serialize + DeserializeOwned {
    /// What the robots of the task share.
    type Claim: Claim;

    /// The longest encoding in bytes.
    const MAX_BYTES: usize;

    /// Whether a member that has not joined yet is taken to bring the fact that it announced last.
    ///
    /// Scores can then be given with the first message of a round. If a member brings another fact,
    /// they are given again: no robot can have decided by them, because that member has not.
    const LASTS: bool = false;

    /// What the robot occupies while it stands: two cells after a restart in the middle of a move.
    fn anchor(&self) -> Self::Claim;

    /// Reads what [`Serialize`] writes from the front of `bytes`, in the place of another fact;
    /// returns the bytes that follow. If there is no fact in the bytes, what is left in its place
    /// is any one.
    #[must_use]
    fn read_into<'b>(&mut self, bytes: &'b [u8]) -> Option<&'b [u8]> {
        let (fact, rest) = postcard::take_from_bytes(bytes).ok()?;
        *self = fact;
        Some(rest)
    }
}
