//! Reading a task file: its tables and truth, or the first error.

use super::file::{self, File};
use super::names::{
    action_names, check_names, fact_names, factor_names, index, is_idle, state_names, states_of, target,
    texts, unknown,
};
use super::room;
use super::tree::TaskTree;
use super::world::{Goal, Truth};
use crate::input::{
    Fault, FileError, Read, RealNumber, Text, line_of_text, optional, real, refuse, share, toml, whole,
};
use crate::scenario::Radio;
use bumpalo::Bump;
use iibt_core::iibt::Literal;
use iibt_core::iibt::rules::Raise;
use iibt_core::iibt::table::{
    Accuracy, Aim, Effect, Fact, Given, HiddenFactor, Holds, JointOutcome, Labels, Operator, Postcondition,
    Reads, Remedy, Role, Sensor, Tables, TablesError, To, Wish,
};
use std::collections::BTreeMap;
use toml::Spanned;

/// A task to fly: its tables, and the true world.
#[derive(Clone, Debug)]
pub struct TableMission<'a> {
    /// Its name: that of the file.
    pub name: String,
    /// Its title, in one line.
    pub title: String,
    /// The tables.
    pub tables: Tables<'a>,
    /// The truth.
    pub truth: Truth,
    /// The limit in ticks, after which it counts as not accomplished.
    pub limit: u32,
    /// The radio between the robots.
    pub radio: Radio,
    /// The work units of a robot's tick; no limit if left out.
    pub budget: Option<u32>,
    /// The trees of the robots; `None` where each pursues its aims one after the other.
    pub(crate) trees: Option<Vec<TaskTree>>,
}

impl<'a> TableMission<'a> {
    /// Reads a task file into `arena`; `name` is what it will be called, in errors too.
    ///
    /// # Errors
    /// [`FileError`] with line, column and reason of the first thing that is wrong.
    pub fn parse(arena: &'a Bump, name: &str, text: &str) -> Result<Self, FileError> {
        let read = toml(text).and_then(|file: File| Reader { arena, file: &file }.mission(name));
        read.map_err(|fault| fault.in_file(name, text))
    }
}

struct Reader<'a, 'f> {
    arena: &'a Bump,
    file: &'f File,
}

impl<'a, 'f> Reader<'a, 'f> {
    fn mission(&self, name: &str) -> Read<TableMission<'a>> {
        let file = self.file;
        check_names(file)?;
        room::check(file)?;
        let roles = self.each(&file.robots, |robot| self.role(robot))?;
        let mut tables = Tables::try_new(roles).map_err(|error| self.misfit(error))?;
        if let Some(precision) = &file.precision {
            let with = tables.with_precision(*precision.get_ref() as f32);
            tables = with.map_err(|error| unfit("precision", precision, error))?;
        }
        if let Some(confidence) = &file.confidence {
            let with = tables.with_confidence(*confidence.get_ref() as f32);
            tables = with.map_err(|error| unfit("confidence", confidence, error))?;
        }
        Ok(TableMission {
            name: name.to_owned(),
            title: line_of_text("title", &file.title, 120)?,
            truth: self.truth(&tables)?,
            tables,
            limit: whole("limit", file.limit.as_ref(), 1..=100_000, 1000)?,
            radio: file.radio.check()?,
            budget: optional("budget", file.budget.as_ref(), 1..=1_000_000_000)?,
            trees: None,
        })
    }

    fn role(&self, robot: &Spanned<file::Robot>) -> Read<Role<'a>> {
        let robot = robot.get_ref();
        let states = match &robot.state {
            Some(labels) => self.labels(labels.get_ref(), robot)?,
            None => self.identity(robot)?,
        };
        let idle = robot.actions.iter().position(|action| is_idle(action.get_ref()));
        let idle = idle.ok_or_else(|| {
            Fault::new(robot.name.span(), "one action must have neither needs nor effects: to do nothing")
        })?;
        Ok(Role {
            name: self.text(&robot.name),
            factors: self.each(&robot.factors, |factor| self.factor(factor.get_ref()))?,
            states,
            sensors: self.each(&robot.sensors, |sensor| self.sensor(sensor.get_ref(), robot))?,
            operators: self.each(&robot.actions, |action| self.operator(action.get_ref(), robot))?,
            idle: idle as u8,
            facts: self.each(&robot.facts, |fact| self.fact(fact.get_ref(), robot))?,
            remedies: self.each(&robot.remedies, |remedy| self.remedy(remedy.get_ref(), robot))?,
            aims: self.each(&robot.aims, |aim| self.aim(aim.get_ref(), robot))?,
            outcome: robot.outcome.as_ref().map(|of| self.outcome(of.get_ref(), robot)).transpose()?,
        })
    }

    fn factor(&self, factor: &file::Factor) -> Read<HiddenFactor<'a>> {
        let certain = || factor.states.iter().enumerate().map(|(at, _)| if at == 0 { 1.0 } else { 0.0 });
        let prior: Vec<f32> = match &factor.prior {
            Some(prior) => prior.iter().map(|&p| p as f32).collect(),
            None => certain().collect(),
        };
        Ok(HiddenFactor {
            name: self.text(&factor.name),
            states: self.each(&factor.states, |state| Ok(self.text(state)))?,
            prior: self.arena.alloc_slice_copy(&prior),
        })
    }

    /// The states of the first factor as semantic states.
    fn identity(&self, robot: &file::Robot) -> Read<Labels<'a>> {
        let Some(first) = robot.factors.first() else {
            return refuse(robot.name.span(), "a robot needs a [[robot.factor]]");
        };
        let states = &first.get_ref().states;
        let numbers: Vec<u8> = (0..states.len().min(255) as u8).collect();
        Ok(Labels {
            names: self.each(states, |state| Ok(self.text(state)))?,
            factors: self.arena.alloc_slice_copy(&[0]),
            table: self.arena.alloc_slice_copy(&numbers),
        })
    }

    fn labels(&self, labels: &file::Labels, robot: &file::Robot) -> Read<Labels<'a>> {
        Ok(Labels {
            names: self.each(&labels.names, |name| Ok(self.text(name)))?,
            factors: self.each(&labels.of, |factor| index("factor", factor, &factor_names(robot)))?,
            table: self.each(&labels.table, |label| index("label", label, &texts(&labels.names)))?,
        })
    }

    fn sensor(&self, sensor: &file::Sensor, robot: &file::Robot) -> Read<Sensor<'a>> {
        let reads = match (&sensor.reads, &sensor.labels) {
            (Some(reads), None) if reads.get_ref() == "state" => Reads::State,
            (Some(reads), None) => Reads::Factor(index("factor", reads, &factor_names(robot))?),
            (None, Some(labels)) => Reads::Labels(self.labels(labels, robot)?),
            _ => return refuse(sensor.name.span(), "a sensor has either `reads` or `labels`"),
        };
        let accuracy = match (&sensor.right, &sensor.table) {
            (Some(right), None) => Accuracy::Even(*right.get_ref() as f32),
            (None, Some(rows)) => {
                let entries: Vec<f32> = rows.iter().flatten().map(|&p| p as f32).collect();
                Accuracy::Table(self.arena.alloc_slice_copy(&entries))
            }
            _ => return refuse(sensor.name.span(), "a sensor has either `right` or `table`"),
        };
        Ok(Sensor { name: self.text(&sensor.name), reads, accuracy })
    }

    fn operator(&self, action: &file::Action, robot: &file::Robot) -> Read<Operator<'a>> {
        let state = |state: &Text| index("state", state, &state_names(robot));
        let expected = share("expected", action.expected.as_ref(), 1.0)? as f32;
        let brings = match (&action.brings, &action.otherwise) {
            (Some(brings), Some(other)) => Postcondition::Reset(state(brings)?, expected, state(other)?),
            (Some(brings), None) => Postcondition::State(state(brings)?, expected),
            (None, Some(other)) => {
                return refuse(other.span(), "`otherwise` is what comes in the place of `brings`");
            }
            (None, None) => Postcondition::Nothing,
        };
        let fact = |fact: &Text| index("fact", fact, &fact_names(robot));
        Ok(Operator {
            name: self.text(&action.name),
            requires: self.each(&action.needs, fact)?,
            forbids: self.each(&action.forbids, fact)?,
            brings,
            effects: self.each(&action.effects, |effect| self.effect(effect, robot))?,
            success: share("success", action.success.as_ref(), 1.0)? as f32,
            habit: real("habit", action.habit.as_ref(), -1000.0..=1000.0, 0.0)? as f32,
        })
    }

    fn effect(&self, effect: &file::Effect, robot: &file::Robot) -> Read<Effect<'a>> {
        let factor = index("factor", &effect.factor, &factor_names(robot))?;
        let to = match effect.to.get_ref().as_str() {
            "target" => To::Target,
            _ => To::State(index("state", &effect.to, &states_of(robot, factor))?),
        };
        let mut given = Vec::new();
        for (name, state) in &effect.given {
            given.push(self.given(name, state, robot)?);
        }
        Ok(Effect { given: self.arena.alloc_slice_copy(&given), factor, to })
    }

    /// `place = "goal C"` of the robot itself, `"R2.place" = "goal C"` of a teammate.
    fn given(&self, name: &str, state: &Text, own: &file::Robot) -> Read<Given> {
        let (of, name) = match name.split_once('.') {
            Some((robot, name)) => (Some(Spanned::new(state.span(), robot.to_owned())), name),
            None => (None, name),
        };
        let (robot, holder) = self.holder(of.as_ref(), own)?;
        let name = Spanned::new(state.span(), name.to_owned());
        let factor = index("factor", &name, &factor_names(holder))?;
        Ok(Given { robot, factor, state: index("state", state, &states_of(holder, factor))? })
    }

    fn fact(&self, fact: &file::Fact, own: &file::Robot) -> Read<Fact<'a>> {
        let (robot, holder) = self.holder(fact.robot.as_ref(), own)?;
        let factor = |factor: &Text| index("factor", factor, &factor_names(holder));
        let holds = match (robot, &fact.factor, &fact.is, &fact.doing) {
            (_, Some(_), Some(is), None) if is.is_empty() => {
                return refuse(fact.name.span(), "`is` names no state, so the fact can never hold");
            }
            (_, Some(name), Some(is), None) => {
                let factor = factor(name)?;
                let states = self.each(is, |state| index("state", state, &states_of(holder, factor)))?;
                match robot {
                    Some(robot) => Holds::Announced { robot, factor, states },
                    None => Holds::Sure { factor, states },
                }
            }
            (None, Some(name), None, None) => Holds::AtTarget { factor: factor(name)? },
            (Some(_), None, None, Some(doing)) if doing.is_empty() => {
                return refuse(fact.name.span(), "`doing` names no action, so the fact can never hold");
            }
            (Some(robot), None, None, Some(doing)) => Holds::Doing {
                robot,
                operators: self.each(doing, |action| index("action", action, &action_names(holder)))?,
            },
            _ => {
                let reason =
                    "a fact has `factor` and `is`, `factor` alone for the target, or `robot` and `doing`";
                return refuse(fact.name.span(), reason);
            }
        };
        Ok(Fact { name: self.text(&fact.name), holds })
    }

    fn remedy(&self, remedy: &file::Remedy, robot: &file::Robot) -> Read<Remedy> {
        let by = |by: &RealNumber| real("by", Some(by), -1000.0..=1000.0, 0.0).map(|by| Raise::By(by as f32));
        Ok(Remedy {
            missing: Literal {
                variable: index("fact", &remedy.missing, &fact_names(robot))?,
                value: remedy.value.unwrap_or(true),
            },
            state: index("state", &remedy.prefer, &state_names(robot))?,
            raise: remedy.by.as_ref().map_or(Ok(Raise::AboveAll), by)?,
            target: target(remedy.target.as_ref(), robot)?,
        })
    }

    fn aim(&self, aim: &file::Aim, robot: &file::Robot) -> Read<Aim<'a>> {
        let wish = |wishes| self.wishes(wishes, aim, robot);
        let teammates = aim.wish.as_ref().map_or(Ok(Wish::AsAnnounced), wish)?;
        Ok(Aim {
            name: self.text(&aim.name),
            done: self.each(&aim.done, |fact| index("fact", fact, &fact_names(robot)))?,
            preference: self.preference(&aim.prefer, &state_names(robot))?,
            teammates,
            target: target(aim.target.as_ref(), robot)?,
        })
    }

    /// A row for each robot by its name; empty for the robot itself, whose row is not read.
    fn wishes(
        &self,
        wishes: &BTreeMap<String, BTreeMap<String, RealNumber>>,
        aim: &file::Aim,
        own: &file::Robot,
    ) -> Read<Wish<'a>> {
        let own = own.name.get_ref();
        let others = || self.file.robots.iter().map(Spanned::get_ref).filter(|of| of.name.get_ref() != own);
        let unknown = |name: &&String| !others().any(|of| of.name.get_ref() == *name);
        if let Some(name) = wishes.keys().find(unknown) {
            let reason = format!("the aim wishes something of \"{name}\", which is no teammate");
            return refuse(aim.name.span(), reason);
        }
        let row = |of: &Spanned<file::Robot>| match wishes.get(of.get_ref().name.get_ref()) {
            _ if of.get_ref().name.get_ref() == own => Ok(&[][..]),
            Some(wish) => self.preference(wish, &state_names(of.get_ref())),
            None => self.preference(&BTreeMap::new(), &state_names(of.get_ref())),
        };
        self.each(&self.file.robots, row).map(Wish::Rows)
    }

    fn outcome(&self, outcome: &file::OutcomeTable, robot: &file::Robot) -> Read<JointOutcome<'a>> {
        let names = texts(&outcome.names);
        let possible = outcome.possible.as_ref();
        Ok(JointOutcome {
            names: self.each(&outcome.names, |name| Ok(self.text(name)))?,
            preference: self.preference(&outcome.prefer, &names)?,
            table: self.each(&outcome.table, |label| index("outcome", label, &names))?,
            possible: possible.map(|action| index("action", action, &action_names(robot))).transpose()?,
        })
    }

    /// A preference by the names of states, zero for one that is not named.
    fn preference(&self, values: &BTreeMap<String, RealNumber>, names: &[&str]) -> Read<&'a [f32]> {
        let mut row = vec![0.0; names.len()];
        for (name, value) in values {
            let Some(place) = names.iter().position(|known| known == name) else {
                return refuse(value.span(), unknown("state", name, names));
            };
            row[place] = real(name, Some(value), -1e6..=1e6, 0.0)? as f32;
        }
        Ok(self.arena.alloc_slice_copy(&row))
    }

    fn truth(&self, tables: &Tables<'_>) -> Read<Truth> {
        let mut truth = Truth::of(tables);
        for (number, robot) in self.file.robots.iter().enumerate() {
            let robot = robot.get_ref();
            for (place, factor) in robot.factors.iter().enumerate() {
                if let Some(start) = &factor.get_ref().start {
                    truth.start[number][place] = Some(index("state", start, &states_of(robot, place as u8))?);
                }
            }
            for (place, action) in robot.actions.iter().enumerate() {
                let action = action.get_ref();
                truth.ticks[number][place] = whole("ticks", action.ticks.as_ref(), 1..=1000, 1)?;
                let usual = truth.fails[number][place];
                truth.fails[number][place] = share("fails", action.fails.as_ref(), usual)?;
            }
        }
        for goal in &self.file.goals {
            let goal = goal.get_ref();
            let (robot, holder) = self.robot(&goal.robot)?;
            if goal.is.is_empty() {
                return refuse(goal.factor.span(), "`is` names no state, so the goal can never be reached");
            }
            let factor = index("factor", &goal.factor, &factor_names(holder))?;
            let states: Result<_, _> =
                goal.is.iter().map(|state| index("state", state, &states_of(holder, factor))).collect();
            truth.goals.push(Goal { robot: robot.into(), factor: factor.into(), states: states? });
        }
        Ok(truth)
    }

    /// The fault of tables that do not fit, at the row in the file and with its name.
    fn misfit(&self, error: TablesError) -> Fault {
        let robot = error.role.and_then(|role| self.file.robots.get(usize::from(role)));
        let Some(robot) = robot else { return Fault::new(0..0, error.to_string()) };
        let (of, row) = (robot.get_ref(), usize::from(error.row.unwrap_or(0)));
        let place = match error.table {
            "factors" => of.factors.get(row).map(|at| (at.span(), "factor", &at.get_ref().name)),
            "sensors" => of.sensors.get(row).map(|at| (at.span(), "sensor", &at.get_ref().name)),
            "operators" | "idle" => of.actions.get(row).map(|at| (at.span(), "action", &at.get_ref().name)),
            "facts" => of.facts.get(row).map(|at| (at.span(), "fact", &at.get_ref().name)),
            "remedies" => of.remedies.get(row).map(|at| (at.span(), "the remedy of", &at.get_ref().missing)),
            "aims" => of.aims.get(row).map(|at| (at.span(), "aim", &at.get_ref().name)),
            "states" => of.state.as_ref().map(|at| (at.span(), "the states of", &of.name)),
            "outcome" => of.outcome.as_ref().map(|at| (at.span(), "the outcome of", &of.name)),
            _ => None,
        };
        let (span, what, name) = place.unwrap_or_else(|| (robot.span(), "robot", &of.name));
        // The words of the file for those of the tables.
        let reason = error.reason.replace("a role", "a robot").replace("operator", "action");
        Fault::new(span, format!("{what} \"{}\": {reason}", name.get_ref()))
    }

    /// The number and the tables of a robot by its name.
    fn robot(&self, name: &Text) -> Read<(u8, &'f file::Robot)> {
        let robots: Vec<_> = self.file.robots.iter().map(Spanned::get_ref).collect();
        let names: Vec<&str> = robots.iter().map(|robot| robot.name.get_ref().as_str()).collect();
        let number = index("robot", name, &names)?;
        Ok((number, robots[usize::from(number)]))
    }

    /// The same for the robot that has a factor: the own one where none is named.
    fn holder<'s>(&self, name: Option<&Text>, own: &'s file::Robot) -> Read<(Option<u8>, &'s file::Robot)>
    where
        'f: 's,
    {
        let Some(name) = name else { return Ok((None, own)) };
        self.robot(name).map(|(number, robot)| (Some(number), robot))
    }

    fn text(&self, text: &Text) -> &'a str {
        self.arena.alloc_str(text.get_ref())
    }

    /// Reads every row into a slice of the arena.
    fn each<R, T: Copy>(&self, rows: &[R], of: impl Fn(&R) -> Read<T>) -> Read<&'a [T]> {
        let rows: Vec<T> = rows.iter().map(of).collect::<Result<_, _>>()?;
        Ok(self.arena.alloc_slice_copy(&rows))
    }
}

/// The fault of a number for the whole task.
fn unfit(key: &str, number: &RealNumber, error: TablesError) -> Fault {
    Fault::new(number.span(), format!("{key} = {}: {}", number.get_ref(), error.reason))
}
