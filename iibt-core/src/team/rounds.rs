//! Rounds in which a team decides on one joint policy.
mod choice;
mod claim;
mod digest;
mod execution;
mod message;
mod patience;
mod policies;
mod protocol;
mod robot;
mod teammates;
mod view;
mod waiting;

pub use choice::{choose, total};
pub use claim::{Claim, Fact};
pub use digest::Digest;
pub use message::{Answer, Choice, Proposal, RoundMessage, Score, Scores};
pub use patience::{Timing, Want};
pub use policies::JointPolicies;
pub use protocol::{Event, Protocol};
pub use robot::{Own, Rounds};
pub use teammates::{Heard, Teammates};
pub use view::View;
pub use waiting::Waiting;
