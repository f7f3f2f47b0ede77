//! Rounds in which a team decides on one joint policy, and keeps to it, over a lossy radio.
//!
//! In a round every member stands and announces a [`Fact`]. From the facts all derive the same
//! [list of joint policies](JointPolicies). Each gives two bytes a policy: what only it knows. Who
//! has all scores knows the [choice](JointPolicies::choose), and that all others will make the
//! same. Without loss that takes three ticks, whatever the size of the team, and two for the first
//! of two robots.
//!
//! ```text
//! tick 0  a robot opens a round          Proposal: number, View, walls; its fact
//! tick 1  the others join, standing      their facts
//! tick 2  all know all facts             Digest, Scores of the list
//! tick 3  all know all scores            the choice; first moves
//! ```
//!
//! Members of a [`View`] that is a [quorum](View::is_quorum) go on without the others, behind walls
//! around all places where those may be. A robot that has started again stands until its new start
//! is answered.
//!
//! [`Protocol`] has all that safety rests on, and no clock. [`Rounds`] adds when to open a round.
//! [`Waiting`] names what a robot waits for. Rules, messages byte by byte, and why no two plans
//! meet: `docs/protocol.md`.

mod claim;
mod digest;
mod execution;
mod facts;
mod message;
mod patience;
mod policies;
mod protocol;
mod reach;
mod robot;
mod teammates;
mod view;
mod waiting;

pub use claim::{Claim, Fact};
pub use digest::Digest;
pub use message::{Answer, Choice, MAX_LEFT_OUT, Proposal, RoundMessage, Score, Scores};
pub use patience::{Timing, Want};
pub use policies::JointPolicies;
pub use protocol::{Event, Protocol};
pub use robot::{Own, Rounds};
pub use teammates::{Heard, Teammates};
pub use view::View;
pub use waiting::Waiting;
