//! Flights of a task file: each robot's tree is a sequence of its aims, an inference node each.

use super::HostTask;
use super::flight::{Flown, TaskFlight};
use super::read::TableMission;
use super::robot::{TaskRobot, Ticked, Turn};
use iibt_core::iibt::table::TablesError;
use iibt_core::team::{MemberError, RobotId};
use iibt_core::time::Instant;
use iibt_core::tree::Status;
use thiserror::Error;

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

/// The reason why a task cannot be flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(transparent)]
pub enum TaskError {
    /// The tables need more room than the simulator has.
    Tables(#[from] TablesError),
    /// There is no such team.
    Team(#[from] MemberError),
}

impl TableMission<'_> {
    /// Flies the task until all robots have reached their last aim, or to the limit.
    ///
    /// # Errors
    /// [`TaskError`] when the simulator has no room for it.
    pub fn fly(&self, seed: u64, trouble: Trouble) -> Result<Flown, TaskError> {
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
        let robots: Result<Vec<_>, TaskError> = (0..self.tables.robots() as u8)
            .map(|robot| {
                let task = HostTask::new(&self.tables, RobotId(robot))?;
                let aims = self.tables.roles()[usize::from(robot)].aims.len();
                Ok(TaskRobot::new(Sequence { aims, aim: 0 }, task))
            })
            .collect();
        let flight = TaskFlight::new(&self.tables, &truth, radio, seed, robots?)?;
        let done = |statuses: &[Status]| statuses.iter().all(|&status| status == Status::Success);
        Ok(flight.fly(self.limit, done, &mut |_| ()))
    }

    /// Narrates a flight line by line.
    #[must_use]
    pub fn narrate(&self, flown: &Flown) -> String {
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
        let came = match (flown.success, flown.believed) {
            (true, _) => "All goals are reached",
            (false, true) => "The robots believe that they are done, and they are not",
            (false, false) => "The robots are not done",
        };
        let (ticks, actions, lost) = (flown.ticks, flown.operated.len(), flown.frames.lost);
        let frames = flown.frames.sent;
        text + &format!(
            "{came}: {ticks} ticks, {actions} actions, {frames} frames of which {lost} were lost.\n"
        )
    }
}

/// A robot's aims, one after the other.
struct Sequence {
    aims: usize,
    /// The aim that is pursued; all are reached when there is no such aim.
    aim: usize,
}

impl Ticked for Sequence {
    fn tick(&mut self, mut turn: Turn<'_, '_>, now: Instant) -> Status {
        while turn.task.pursue(self.aim) {
            match turn.infer(now) {
                Status::Success => self.aim += 1,
                Status::Failure => {
                    self.aim = 0;
                    return Status::Failure;
                }
                status => return status,
            }
        }
        debug_assert_eq!(self.aim, self.aims);
        Status::Success
    }
}
