//! The messages between a robot and its base.

use heapless::Vec;
use iibt_core::grid::{Cell, Move};
use iibt_core::iibt::table::{Command, MAX_SENSORS};
use iibt_core::navigation::{MAX_HAZARDS, MAX_OBSTACLES, MAX_WAYPOINTS};
use iibt_core::team::{
    Context, DecodeError, EncodeError, Envelope, Invalid, Key, Message, RobotId, SipHash64, Stamp, decode,
    encode,
};
use serde::{Deserialize, Serialize};

/// The most cells that a robot asks its base to look at again.
pub const MAX_WATCHED: usize = 24;

/// The most joint policies of a [`Decision`].
pub const MAX_POSTERIOR: usize = 16;

/// The key of the tags on the line. Everybody knows it: the tag finds damage, it proves no origin.
pub const BASE_KEY: Key = Key::new(*b"robot and a base");

/// What a base tells the robot, or asks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum BaseRequest {
    /// The readings of a tick: the robot ticks, and answers with [`BaseAnswer::Act`].
    Tick(Readings),
    /// The question how many bytes of teammates wait to be read; the robot does not tick.
    Waiting,
    /// The readings of a tick of a robot whose task is written as tables: it ticks, and answers
    /// with [`BaseAnswer::Operate`].
    Sense(Sensed),
}

/// What a base reads in a tick.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Readings {
    /// The time, in ticks of the controller's [`Settings`](crate::Settings).
    pub time: u32,
    /// The robot's own cell, if it is known.
    pub cell: Option<Cell>,
    /// Whether the last move is still going on.
    pub moving: bool,
    /// The charge of the battery in percent.
    pub charge: u8,
    /// The cells in view that are blocked, those first that have come into view last.
    pub hazards: Vec<Cell, MAX_HAZARDS>,
    /// The cells in view that are free, of those that the last answer asked for.
    pub clear: Vec<Cell, MAX_OBSTACLES>,
    /// The cells that an operator at the base has told the robot to visit since the last tick.
    pub visits: Vec<Cell, MAX_WAYPOINTS>,
}

impl Readings {
    /// Nothing read: the time of zero, no charge.
    pub(super) const NONE: Self = Self {
        time: 0,
        cell: None,
        moving: false,
        charge: 0,
        hazards: Vec::new(),
        clear: Vec::new(),
        visits: Vec::new(),
    };
}

/// What the sensors of a table task read in a tick.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sensed {
    /// The time, in ticks of the controller's [`Settings`](crate::Settings).
    pub time: u32,
    /// Whether an operator is under way.
    pub busy: bool,
    /// The reading of each sensor by its number in the tables; `None` while it is silent.
    pub readings: Vec<Option<u8>, MAX_SENSORS>,
}

/// What a robot tells its base.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum BaseAnswer {
    /// The robot has started and listens.
    Ready,
    /// The end of a tick.
    Act(Act),
    /// What the robot has decided, before the end of the tick.
    Decided(Decision),
    /// The bytes of teammates that wait to be read.
    Waiting(u16),
    /// Stop at once.
    Stop,
    /// The end of a tick of a table task, and the operator to begin.
    Operate(Option<Operation>),
}

/// An operator to begin, by the numbers that it has in the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Operation {
    /// The operator.
    pub operator: u8,
    /// The state that it leads to, if that is the target.
    pub target: Option<u8>,
}

impl From<Command> for Operation {
    fn from(Command { operator, target }: Command) -> Self {
        Self { operator, target }
    }
}

/// What the base is to do until the next tick.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Act {
    /// The code of the [`Move`] to begin, if there is one.
    step: Option<u8>,
    /// Cells of which the robot wants to know whether they are free.
    pub watched: Vec<Cell, MAX_WATCHED>,
}

impl Act {
    /// The command to make a move, if any, and to look at cells, as many as fit.
    #[must_use]
    pub fn new(step: Option<Move>, watched: impl IntoIterator<Item = Cell>) -> Self {
        Self { step: step.map(Move::code), watched: first(watched) }
    }

    /// Returns the move to begin, if there is one.
    #[must_use]
    pub fn step(&self) -> Option<Move> {
        self.step.and_then(Move::from_code)
    }
}

/// A joint decision, for a display or a recorder.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Decision {
    /// The number of the round.
    pub round: u32,
    /// The number of the chosen policy in the list.
    pub policy: u8,
    /// The posterior over the joint policies.
    pub posterior: Vec<f32, MAX_POSTERIOR>,
}

impl Decision {
    /// The choice of a policy in a round, with the posterior of as many policies as fit.
    #[must_use]
    pub fn new(round: u32, policy: usize, posterior: &[f32]) -> Self {
        let policy = u8::try_from(policy).unwrap_or(u8::MAX);
        Self { round, policy, posterior: first(posterior.iter().copied()) }
    }
}

/// As many of the items as fit, the first ones.
pub fn first<T, const N: usize>(items: impl IntoIterator<Item = T>) -> Vec<T, N> {
    let mut list = Vec::new();
    for item in items {
        if list.push(item).is_err() {
            break;
        }
    }
    list
}

impl Message for BaseRequest {
    const SCHEMA: &'static str = "base request: 0 tick time u32, cell option u16, moving bool, charge u8, \
        hazards [u16], clear [u16], visits [u16]; 1 waiting; 2 sense time u32, busy bool, readings [option u8]";
    const MAX_BYTES: usize =
        1 + 5 + 4 + 1 + 1 + (1 + 3 * MAX_HAZARDS) + (1 + 3 * MAX_OBSTACLES) + (1 + 3 * MAX_WAYPOINTS);

    fn validate(&self) -> Result<(), Invalid> {
        match self {
            Self::Tick(readings) if readings.charge > 100 => Err(Invalid("a charge of more than 100 %")),
            _ => Ok(()),
        }
    }
}

impl Message for BaseAnswer {
    const SCHEMA: &'static str = "base answer: 0 ready; 1 act step option u8, watched [u16]; 2 decided round \
        u32, policy u8, posterior [f32]; 3 waiting u16; 4 stop; 5 operate option (operator u8, target option u8)";
    const MAX_BYTES: usize = 1 + 2 + (1 + 3 * MAX_WATCHED);

    fn validate(&self) -> Result<(), Invalid> {
        match self {
            Self::Act(act) if act.step.is_some() && act.step().is_none() => Err(Invalid("no such move")),
            _ => Ok(()),
        }
    }
}

const _: () = assert!(1 + 5 + 1 + (1 + 4 * MAX_POSTERIOR) <= BaseAnswer::MAX_BYTES);
const _: () = assert!(1 + 5 + 1 + (1 + 2 * MAX_SENSORS) <= BaseRequest::MAX_BYTES);

/// Writes a frame of the line to the front of a buffer of
/// [`MAX_FRAME`](iibt_core::team::MAX_FRAME) bytes, and returns it.
///
/// # Errors
/// [`EncodeError`] when the message is invalid or the buffer is too small.
pub fn write<M: Message>(message: M, stamp: Stamp, buffer: &mut [u8]) -> Result<&[u8], EncodeError> {
    let envelope = Envelope { sender: RobotId(0), stamp, message };
    encode(&envelope, &SipHash64::new(BASE_KEY), Context::of::<M>(0, 0), buffer)
}

/// Reads a frame of the line, which is given without its delimiters.
///
/// # Errors
/// [`DecodeError`] names the first check that failed.
pub fn read<M: Message>(frame: &[u8]) -> Result<(Stamp, M), DecodeError> {
    let envelope = decode(frame, &SipHash64::new(BASE_KEY), Context::of::<M>(0, 0))?;
    Ok((envelope.stamp, envelope.message))
}
