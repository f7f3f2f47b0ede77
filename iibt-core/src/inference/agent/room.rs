//! The sizes of an agent, derived from its model.

use crate::inference::candidates::Candidates;
use crate::inference::model::{MAX_FACTORS, Model};

/// The sizes of an [`Agent`](super::Agent), derived from a model and its candidates.
///
/// [`agent!`](crate::agent) and [`Agent!`](crate::Agent) derive them, so you need not write them.
///
/// ```
/// use iibt_core::inference::{Factor, IdentityNoise, Modality, Model, NextState, Room};
///
/// static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 3);
/// static MOVES: NextState = NextState::new(&[0, 0, 1, 1, 2, 2], 3);
/// static FACTORS: [Factor; 2] = [Factor::new(&MOVES, MOVES.shape(), &[1.0, 0.0, 0.0]); 2];
/// static MODALITIES: [Modality; 1] = [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0; 3])];
/// static MODEL: Model = Model::new(&FACTORS, &MODALITIES);
///
/// // Two robots of three states, which choose among four policies each: sixteen joint policies.
/// const ROOM: Room = Room::of(&MODEL, 4);
/// assert_eq!((ROOM.states(), ROOM.groups()), (3, 2));
/// assert_eq!(ROOM.rows() * ROOM.planes(), 16);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    states: usize,
    groups: usize,
    rows: usize,
    planes: usize,
}

/// The most candidates of one group that are rolled out side by side.
const MOST_ROWS: usize = 64;

impl Room {
    /// Room for all combinations of up to `policies` action sequences of each control.
    ///
    /// # Panics
    /// When that is no policy, or more than 65,535; in a `const` this fails the build.
    #[must_use]
    pub const fn of(model: &Model, policies: usize) -> Self {
        let (mut joint, mut control) = (1_usize, 0);
        while control < model.controls() {
            joint = joint.saturating_mul(policies);
            control += 1;
        }
        let (mut rows, mut group) = (1, 0);
        while group < model.groups() {
            let all = policies.saturating_pow(model.moved_by(group).count_ones());
            rows = if all > rows { all } else { rows };
            group += 1;
        }
        Self::with(model, rows, joint)
    }

    /// Room for these joint policies.
    ///
    /// # Panics
    /// When there is none, or more than 65,535; in a `const` this fails the build.
    #[must_use]
    pub const fn for_candidates(model: &Model, candidates: &Candidates) -> Self {
        let (mut rows, mut group) = (1, 0);
        while group < model.groups() {
            let (mut all, mut control) = (1_usize, 0);
            while control < MAX_FACTORS {
                if model.moved_by(group) >> control & 1 == 1 {
                    all = all.saturating_mul(candidates.choices(control));
                }
                control += 1;
            }
            rows = if all > rows { all } else { rows };
            group += 1;
        }
        Self::with(model, rows, candidates.len())
    }

    const fn with(model: &Model, rows: usize, joint: usize) -> Self {
        assert!(joint > 0, "an agent needs a policy to choose");
        assert!(
            joint <= u16::MAX as usize,
            "an agent has more than 65,535 joint policies: list those that matter"
        );
        let rows = if rows > MOST_ROWS { MOST_ROWS } else { rows };
        let rows = if rows > joint { joint } else { rows };
        let groups = model.groups();
        Self { states: model.states().div_ceil(groups), groups, rows, planes: joint.div_ceil(rows) }
    }

    /// The states of a group, at most and on average: `S` of an [`Agent`](super::Agent).
    #[must_use]
    pub const fn states(&self) -> usize {
        self.states
    }

    /// The groups of factors that move independently of each other: `G`.
    #[must_use]
    pub const fn groups(&self) -> usize {
        self.groups
    }

    /// The candidates of one group that are rolled out side by side: `R`.
    #[must_use]
    pub const fn rows(&self) -> usize {
        self.rows
    }

    /// The joint policies for each of those: `P`.
    #[must_use]
    pub const fn planes(&self) -> usize {
        self.planes
    }
}

/// The type of an [`Agent`](crate::inference::Agent) for a model in a `static`: `Agent![MODEL, 4]`
/// has room for four action sequences of each control, `Agent![MODEL, for CANDIDATES]` for the
/// joint policies of a `static` [`Candidates`](crate::inference::Candidates).
///
/// ```
/// # use iibt_core::inference::{Factor, IdentityNoise, Modality, Model, NextState};
/// # static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 2);
/// # static PUSH: NextState = NextState::new(&[0, 1, 0, 0], 2);
/// # static FACTORS: [Factor; 1] = [Factor::new(&PUSH, PUSH.shape(), &[0.5, 0.5])];
/// # static MODALITIES: [Modality; 1] =
/// #     [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[2.0, 0.0])];
/// # static DOOR: Model = Model::new(&FACTORS, &MODALITIES);
/// struct Robot {
///     mind: iibt_core::Agent![DOOR, 2],
/// }
/// static ROBOT: Robot = Robot { mind: iibt_core::agent!(DOOR, 2) };
/// assert_eq!(ROBOT.mind.belief(0), Ok(&[0.5, 0.5][..]));
/// ```
#[macro_export]
macro_rules! Agent {
    ($model:path, for $candidates:path) => {
        $crate::Agent![@ $crate::inference::Room::for_candidates(&$model, &$candidates)]
    };
    ($model:path, $policies:expr) => {
        $crate::Agent![@ $crate::inference::Room::of(&$model, $policies)]
    };
    (@ $room:expr) => {
        $crate::inference::Agent<
            'static,
            { $room.states() },
            { $room.groups() },
            { $room.rows() },
            { $room.planes() },
        >
    };
}

/// An [`Agent`](crate::inference::Agent) for a model in a `static`, with the sizes of
/// [`Agent!`](crate::Agent): `agent!(MODEL, 4)` or `agent!(MODEL, for CANDIDATES)`. It is checked
/// when it is compiled.
#[macro_export]
macro_rules! agent {
    ($model:path, $($room:tt)+) => {
        const { <$crate::Agent![$model, $($room)+]>::new(&$model) }
    };
}
