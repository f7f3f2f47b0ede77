//! Flights of a task file.

use super::HostTask;
use super::Station;
use super::flight::{Flown, TaskFlight};
use super::read::TableMission;
use super::robot::{HostRobot, TIMEOUT};
use super::tree::flown;
use crate::radio::KEY;
use crate::testbed::{Shadow, settings};
use firmware::Finished;
use iibt_core::iibt::table::TablesError;
use iibt_core::team::{Keys, MemberError, RobotId};
use iibt_core::time::Duration;
use iibt_core::tree::{NodeMemory, Status};
use thiserror::Error;

/// The most work units of a decision for each joint policy: eight raises and nine inferences, the
/// list, and the same again once the choice is known.
const UNITS_OF_A_DECISION: u32 = 20;

/// Disturbances in place of those of the file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trouble {
    /// The probability that a reading is wrong, of every sensor.
    pub wrong: Option<f64>,
    /// The probability that an action fails, of every action with an effect.
    pub fails: Option<f64>,
    /// The probability that a frame does not reach a teammate.
    pub loss: Option<f64>,
}

/// Why a task is not flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TaskError {
    /// The tables need more room than the simulator has.
    #[error(transparent)]
    Tables(#[from] TablesError),
    /// There is no such team.
    #[error(transparent)]
    Team(#[from] MemberError),
    /// The tree has a skill that robots in simulation do not have.
    #[error("the robots in simulation have the skill 0, which is finished, and no skill {0}")]
    NoSkill(u8),
    /// The nodes are no tree.
    #[error("the nodes of a robot are no tree")]
    NoTree,
    /// What was to run beside the robots has not started.
    #[error("the flight has not begun")]
    Halted,
}

/// What is beside a flight of a task.
pub(crate) struct Beside<'a> {
    /// The keys of the team.
    pub(crate) keys: Keys,
    /// What runs beside its robots.
    pub(crate) shadow: Option<TaskShadow>,
    /// Whether that has halted.
    pub(crate) has_halted: &'a dyn Fn() -> bool,
    /// Gets the frames of every tick.
    pub(crate) record: &'a mut dyn FnMut(&[u8]),
}

/// What runs beside the robots of a task.
pub(crate) type TaskShadow = Box<dyn for<'x> Shadow<HostRobot<'x, Finished>, Station>>;

impl TableMission<'_> {
    /// Flies the task until the trees of all robots have succeeded, or to the limit.
    ///
    /// # Errors
    /// [`TaskError`] when the simulator has no room for it.
    pub fn fly(&self, seed: u64, trouble: Trouble) -> Result<Flown, TaskError> {
        self.fly_recorded(seed, trouble, &mut |_| ())
    }

    /// The same; `record` gets the frames of every tick as the robots send them, one after the
    /// other.
    ///
    /// # Errors
    /// As [`fly`](Self::fly).
    pub fn fly_recorded(
        &self,
        seed: u64,
        trouble: Trouble,
        record: &mut dyn FnMut(&[u8]),
    ) -> Result<Flown, TaskError> {
        self.fly_with(
            seed,
            trouble,
            Beside { keys: Keys::shared(&KEY), shadow: None, has_halted: &|| false, record },
        )
    }

    /// Flies the task with what is beside its robots, until that has halted.
    pub(crate) fn fly_with(
        &self,
        seed: u64,
        trouble: Trouble,
        beside: Beside<'_>,
    ) -> Result<Flown, TaskError> {
        let mut truth = self.truth.clone();
        truth.wrong = trouble.wrong.or(truth.wrong);
        if let Some(fails) = trouble.fails {
            for (role, shares) in self.tables.roles().iter().zip(&mut truth.fails) {
                let real =
                    role.operators.iter().zip(shares).filter(|(operator, _)| !operator.effects.is_empty());
                real.for_each(|(_, share)| *share = fails);
            }
        }
        let radio = crate::scenario::Radio { loss: trouble.loss.unwrap_or(self.radio.loss), ..self.radio };
        let trees = (0..self.tables.robots()).map(|robot| flown(&self.tree(robot)?));
        let trees = trees.collect::<Result<Vec<_>, TaskError>>()?;
        // Emulated robots have the budget of images.
        let default_budget = if beside.shadow.is_some() { HostTask::BUDGET } else { u32::MAX };
        let robots = (0..).zip(&trees).map(|(robot, tree)| {
            let settings = settings(RobotId(robot), trees.len())?;
            let (tree, memory) = (tree.by_ref(), vec![NodeMemory::NEW; tree.len()]);
            let robot = HostRobot::with_memory(
                &self.tables,
                &settings,
                tree,
                memory,
                Finished::default(),
                self.timeout(),
            )?;
            Ok(robot.with_budget(self.budget.unwrap_or(default_budget)))
        });
        let robots = robots.collect::<Result<_, TaskError>>()?;
        let Beside { keys, shadow, has_halted, record } = beside;
        let flight = TaskFlight::beside(&self.tables, &truth, (radio, seed), robots, keys, shadow)?;
        let done =
            |statuses: &[Status]| has_halted() || statuses.iter().all(|&status| status == Status::Success);
        Ok(flight.fly(self.limit, done, &mut |flight| record(flight.frames())))
    }

    /// The timeout of inference nodes: with a budget, a decision takes as many more ticks as it has
    /// units.
    fn timeout(&self) -> Duration {
        let Some(budget) = self.budget else { return TIMEOUT };
        let units = UNITS_OF_A_DECISION * self.tables.policies() as u32;
        Duration(TIMEOUT.0.saturating_add(units.div_ceil(budget.max(1))))
    }

    /// Narrates a flight line by line: the actions, the outcome, and what is missing.
    #[must_use]
    pub fn narrate(&self, flown: &Flown) -> String {
        let missing: String = flown.missing.iter().map(|line| format!("  {line}\n")).collect();
        self.actions(flown) + &outcome_line(flown) + "\n" + &missing
    }

    fn actions(&self, flown: &Flown) -> String {
        let mut text = String::new();
        for one in &flown.operated {
            let role = &self.tables.roles()[one.robot];
            let operator = &role.operators[usize::from(one.operator)];
            let target = one.target.and_then(|target| {
                let factor = operator.effects.first()?.factor;
                Some(format!(
                    " to {}",
                    role.factors.get(usize::from(factor))?.states.get(usize::from(target))?
                ))
            });
            let why = one.policy.map_or_else(String::new, |(policy, p)| format!(", by pi{policy}, P {p:.3}"));
            let (tick, target) = (one.tick, target.unwrap_or_default());
            text += &format!("tick {tick:>3}  {} begins {}{target}{why}\n", role.name, operator.name);
        }
        text
    }
}

/// The outcome of a flight in one line.
#[must_use]
pub fn outcome_line(flown: &Flown) -> String {
    let came = match (flown.success, flown.believed) {
        (true, _) => "All goals are reached",
        (false, true) => "The robots believe that they are done, and they are not",
        (false, false) => "The robots are not done",
    };
    let (ticks, actions, frames) = (flown.ticks, flown.operated.len(), flown.frames);
    let (sent, lost) = (frames.sent, frames.lost);
    format!("{came}: {ticks} ticks, {actions} actions, {sent} frames of which {lost} were lost.")
}
