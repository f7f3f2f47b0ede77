//! What two robots are to do, and by which numbers they judge it.

/// How many robots a handling mission has.
pub const TEAM: usize = 2;

/// Where a robot can be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Place {
    /// At none of the others.
    #[default]
    Elsewhere,
    /// Goal A.
    GoalA,
    /// Goal B.
    GoalB,
    /// Goal C.
    GoalC,
}

impl Place {
    /// All, in the order of their codes.
    pub const ALL: [Self; 4] = [Self::Elsewhere, Self::GoalA, Self::GoalB, Self::GoalC];

    /// The place with a code.
    #[must_use]
    pub fn of(code: usize) -> Option<Self> {
        Self::ALL.get(code).copied()
    }
}

/// What a robot does with its object at the meeting place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Ending {
    /// It goes on holding it.
    Hold,
    /// It places it on what the other robot holds.
    Place,
}

/// One robot's part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Role {
    /// Where its object is picked up.
    pub source: Place,
    /// What becomes of the object at the meeting place.
    pub ending: Ending,
}

/// Who fetches when.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Order {
    /// One after the other, in the order of their numbers, as published: the first is to be free before the second
    /// begins, and both leave for the meeting place together.
    #[default]
    InTurn,
    /// Both at once.
    Together,
}

/// The numbers by which joint policies are judged.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Preset {
    /// How likely a reading is right; each of the three others has an equal share of the rest.
    pub sensor: f32,
    /// How likely an action is taken to bring its state about when policies are compared; else the robot is free.
    pub success: f32,
    /// γ, the precision.
    pub precision: f32,
}

impl Preset {
    /// Equation 8 with its columns normalised: 0.9 of 0.975. As printed they sum to 0.975 and are no distributions.
    pub const SENSOR: f32 = 0.9 / 0.975;

    /// Nothing tuned: actions are judged by what they bring about, and γ is one.
    pub const DEFAULT: Self = Self { sensor: Self::SENSOR, success: 1.0, precision: 1.0 };

    /// The reported probabilities to a thousandth. The pair of success and precision is one of several that give them.
    pub const CALIBRATED: Self = Self { success: 0.863, precision: 1.381, ..Self::DEFAULT };
}

/// Two robots that fetch an object each and join them where they meet.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Mission {
    roles: [Role; TEAM],
    meeting: Place,
    /// The numbers of the decision.
    pub preset: Preset,
    /// Who fetches when.
    pub order: Order,
}

/// Why there is no such mission, or no such robot in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MissionError {
    /// Not exactly one robot places its object.
    Endings,
    /// A place is [`Place::Elsewhere`], or two of the three places are the same.
    Places,
    /// The sensor or the success is no probability, or the precision is negative or not finite.
    Preset,
    /// The mission has no robot with this number, or the roster is not for a team of [`TEAM`].
    NoSuchRobot,
}

impl Mission {
    /// Section 6.2: robot 0 takes the bottle from goal A, robot 1 the plate from goal B; at goal C the bottle is placed on
    /// the plate.
    pub const BOTTLE_AND_PLATE: Self = Self {
        roles: [
            Role { source: Place::GoalA, ending: Ending::Place },
            Role { source: Place::GoalB, ending: Ending::Hold },
        ],
        meeting: Place::GoalC,
        preset: Preset::DEFAULT,
        order: Order::InTurn,
    };

    /// A mission.
    ///
    /// # Errors
    /// [`MissionError`] when the parts do not fit together.
    pub fn new(
        roles: [Role; TEAM],
        meeting: Place,
        preset: Preset,
        order: Order,
    ) -> Result<Self, MissionError> {
        let [first, second] = roles;
        if first.ending == second.ending {
            return Err(MissionError::Endings);
        }
        let places = [first.source, second.source, meeting];
        let same = first.source == second.source || first.source == meeting || second.source == meeting;
        if same || places.contains(&Place::Elsewhere) {
            return Err(MissionError::Places);
        }
        let probability = |p: f32| (0.0..=1.0).contains(&p);
        let sound = preset.precision.is_finite() && preset.precision >= 0.0;
        if !probability(preset.sensor) || !probability(preset.success) || !sound {
            return Err(MissionError::Preset);
        }
        Ok(Self { roles, meeting, preset, order })
    }

    /// A robot's part; `None` when there is no such robot.
    #[must_use]
    pub fn role(&self, robot: usize) -> Option<Role> {
        self.roles.get(robot).copied()
    }

    /// Where the robots meet.
    #[must_use]
    pub const fn meeting(&self) -> Place {
        self.meeting
    }
}

impl core::fmt::Display for MissionError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Endings => "exactly one of the two robots places its object",
            Self::Places => "the two sources and the meeting place are three different goals",
            Self::Preset => "sensor and success are probabilities, and the precision is not negative",
            Self::NoSuchRobot => "the mission is for robots 0 and 1 of a team of two",
        })
    }
}

impl core::error::Error for MissionError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mission_whose_parts_do_not_fit_is_refused_by_name() {
        let Mission { roles, meeting, preset, order } = Mission::BOTTLE_AND_PLATE;
        let role = |source, ending| Role { source, ending };
        assert_eq!(Mission::new(roles, meeting, preset, order), Ok(Mission::BOTTLE_AND_PLATE));
        let both = roles.map(|role| Role { ending: Ending::Place, ..role });
        assert_eq!(Mission::new(both, meeting, preset, order), Err(MissionError::Endings));
        assert_eq!(Mission::new(roles, Place::GoalA, preset, order), Err(MissionError::Places));
        let away = [role(Place::Elsewhere, Ending::Place), roles[1]];
        assert_eq!(Mission::new(away, meeting, preset, order), Err(MissionError::Places));
        for preset in [
            Preset { sensor: f32::NAN, ..preset },
            Preset { success: 1.1, ..preset },
            Preset { precision: -1.0, ..preset },
            Preset { precision: f32::INFINITY, ..preset },
        ] {
            assert_eq!(Mission::new(roles, meeting, preset, order), Err(MissionError::Preset), "{preset:?}");
        }
    }
}
