//! Everything that a robot whose task is written as tables is made of, for one `use`.

pub use crate::hardware::{Battery, Clock, Equipment, Link};
pub use crate::{Controller, Robot, Settings, Skills, TableRobot, TaskLeaf, Turn, table_robot};
pub use iibt_core::iibt::table::{
    Accuracy, Aim, Announcement, Command, Effect, Fact, Given, HiddenFactor, Holds, JointOutcome, Labels,
    Operator, Percept, Postcondition, Reads, Remedy, Role, Sensor, TableMessage, TableTask, Tables,
    TablesError, To, Wish,
};
pub use iibt_core::iibt::{Literal, rules::Raise};
pub use iibt_core::team::{Invalid, Key, Member, MemberError, Message, Peers, RobotId};
pub use iibt_core::time::{Duration, Instant};
pub use iibt_core::tree;
pub use iibt_core::tree::{Basic, Full, Halt, Memory, Status, Tree};
