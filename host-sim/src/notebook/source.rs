//! A model as Rust source: tables for the firmware, each in its smallest form.

use super::assembly::ModelAssembly;
use super::choices::Choices;
use super::convention::Convention;
use super::fault::NotebookFault;
use super::model::Notebook;
use super::structure::{Forms, LikelihoodForm, TransitionForm};
use crate::input::FileError;
use iibt_core::actions::BYTES;
use iibt_core::inference::{Room, Scoring, Terms};
use std::collections::BTreeSet;
use std::fmt::{Display, Write};

/// The columns of a line of source.
const WIDTH: usize = 100;

impl Notebook {
    /// The model as a module of Rust source, for a crate that depends on `iibt-core` and on nothing
    /// else.
    ///
    /// # Errors
    /// A [`FileError`] when the tables are no model.
    pub fn to_rust(&self, forms: Forms) -> Result<String, FileError> {
        self.write(forms).map_err(|fault| fault.in_file(&self.file))
    }

    /// Renames the model.
    #[must_use]
    pub fn named(mut self, name: &str) -> Self {
        name.clone_into(&mut self.name);
        self
    }

    fn write(&self, forms: Forms) -> Result<String, NotebookFault> {
        let assembly = ModelAssembly::new(self, forms);
        let (choices, room) = assembly.with_model(|model| {
            let choices = Choices::new(self, &self.policies, model.controls());
            let room = Room::for_candidates(model, &choices.candidates(&choices.lists(), &choices.numbers()));
            Ok((choices, room))
        })?;
        let mut source = Source { text: String::new(), used: BTreeSet::new() };
        for (number, form) in assembly.transitions.iter().enumerate() {
            source.transition(number, form);
        }
        for (number, form) in assembly.likelihoods.iter().enumerate() {
            source.likelihood(number, form);
        }
        source.factors(self, &assembly);
        source.modalities(self, &assembly);
        source.policies(self, &choices);
        source.agent(self);
        Ok(self.heading(&assembly, &room, &choices) + &source.uses() + &source.text)
    }

    fn heading(&self, assembly: &ModelAssembly, room: &Room, choices: &Choices) -> String {
        let states = assembly.transitions.iter().zip(&self.transitions).enumerate();
        let factors = states.map(|(number, (form, of))| {
            format!(
                "//! - factor {number}: {} states, {} actions, {}\n",
                of.states(),
                of.actions(),
                form.name()
            )
        });
        let outcomes = assembly.likelihoods.iter().zip(&self.likelihoods).enumerate();
        let modalities = outcomes.map(|(number, (form, of))| {
            let (outcomes, on) = (of.table.shape()[0], joined(&of.factors));
            format!("//! - modality {number}: {outcomes} outcomes of factor {on}, {}\n", form.name())
        });
        let name: String = self.name.chars().map(|sign| if sign.is_control() { ' ' } else { sign }).collect();
        format!(
            "//! The model \"{name}\", written by `host-sim export`.\n//!\n{}{}//!\n\
             //! The numbers of A, B, C and D take {} bytes, as full tables {}; {} policies \
             take {}.\n\
             //! `Agent` takes about {} bytes of RAM.\n\n",
            factors.collect::<String>(),
            modalities.collect::<String>(),
            assembly.bytes(),
            self.dense_bytes(),
            self.policies.len(),
            policy_bytes(choices),
            agent_bytes(room),
        )
    }
}

/// The bytes of the sequences and, where the policies are not simply all of them, the rows.
fn policy_bytes(choices: &Choices) -> usize {
    let sequences: usize = choices.sequences.iter().map(Vec::len).sum();
    let rows = if choices.are_all() { 0 } else { 2 * choices.rows.iter().map(Vec::len).sum::<usize>() };
    sequences * (BYTES + 1) + rows
}

/// The approximate RAM of the agent on the robot.
fn agent_bytes(room: &Room) -> usize {
    let (terms, beliefs) = (size_of::<Terms>(), 4 * room.states() * room.groups());
    let candidates = room.rows() * (beliefs + room.groups() * (terms + 8));
    let policies = room.rows() * room.planes() * (room.groups() + 2 * terms + 4);
    beliefs + candidates + policies + 8 * room.groups() + 32
}

/// The text so far, and the names that it uses.
struct Source {
    text: String,
    used: BTreeSet<&'static str>,
}

impl Source {
    fn line(&mut self, line: impl Display) {
        writeln!(self.text, "{line}").expect("writing to memory");
    }

    fn uses(&mut self) -> String {
        let list = wrapped(self.used.iter(), "    ");
        format!("use iibt_core::inference::{{\n{list}}};\n\n")
    }

    fn transition(&mut self, number: usize, form: &TransitionForm) {
        match form {
            TransitionForm::NextState { table, states, slip } => {
                self.used.insert("NextState");
                self.list(format_args!("static B_{number}_NEXT: [u16; {}]", table.len()), table);
                let new = if *slip == 0.0 {
                    format!("NextState::new(&B_{number}_NEXT, {states})")
                } else {
                    format!("NextState::with_slip(&B_{number}_NEXT, {states}, {slip:?})")
                };
                self.line(format_args!("static B_{number}: NextState = {new};\n"));
            }
            TransitionForm::Dense { table, actions, states } => {
                self.used.insert("DenseTransition");
                self.numbers(format_args!("static B_{number}_TABLE: [f32; {}]", table.len()), table);
                let new = format!("DenseTransition::new(&B_{number}_TABLE, {actions}, &{states:?})");
                self.line(format_args!("static B_{number}: DenseTransition = {new};\n"));
            }
        }
    }

    fn likelihood(&mut self, number: usize, form: &LikelihoodForm) {
        match form {
            LikelihoodForm::IdentityNoise { correct, states } => {
                self.used.insert("IdentityNoise");
                let new = format!("IdentityNoise::new({correct:?}, {states})");
                self.line(format_args!("static A_{number}: IdentityNoise = {new};\n"));
            }
            LikelihoodForm::OutcomeTable { labels, kinds, columns, outcomes } => {
                self.used.insert("OutcomeTable");
                for (condition, labels) in labels.iter().enumerate() {
                    let declaration = format!("static A_{number}_LABELS_{condition}: [u8; {}]", labels.len());
                    self.list(declaration, labels);
                }
                self.list(format_args!("static A_{number}_KINDS: [u8; {}]", kinds.len()), kinds);
                self.numbers(format_args!("static A_{number}_COLUMNS: [f32; {}]", columns.len()), columns);
                let names = (0..labels.len()).map(|condition| format!("&A_{number}_LABELS_{condition}"));
                let names = names.collect::<Vec<_>>().join(", ");
                self.line(format_args!("static A_{number}: OutcomeTable = OutcomeTable::new("));
                self.line(format_args!("    &[{names}],\n    &A_{number}_KINDS,\n    &A_{number}_COLUMNS,"));
                self.line(format_args!("    {outcomes},\n);\n"));
            }
            LikelihoodForm::Dense { table, outcomes, states } => {
                self.used.insert("DenseLikelihood");
                self.numbers(format_args!("static A_{number}_TABLE: [f32; {}]", table.len()), table);
                let new = format!("DenseLikelihood::new(&A_{number}_TABLE, {outcomes}, &{states:?})");
                self.line(format_args!("static A_{number}: DenseLikelihood = {new};\n"));
            }
        }
    }

    fn factors(&mut self, notebook: &Notebook, assembly: &ModelAssembly) {
        self.used.insert("Factor");
        for (number, prior) in notebook.priors.iter().enumerate() {
            self.numbers(format_args!("static D_{number}: [f32; {}]", prior.len()), prior);
        }
        let count = assembly.transitions.len();
        self.line("\n/// The hidden factors: B and D.");
        self.line(format_args!("pub static FACTORS: [Factor; {count}] = ["));
        for (number, of) in notebook.transitions.iter().enumerate() {
            let mut factor = format!("    Factor::new(&B_{number}, B_{number}.shape(), &D_{number})");
            if !of.coupled_to.is_empty() {
                factor += &format!(".coupled_to(&{:?})", of.coupled_to);
            }
            if notebook.is_uncontrolled(number) {
                self.used.insert("Control");
                factor += ".controlled_by(Control::None)";
            }
            self.line(format_args!("{factor},"));
        }
        self.line("];\n");
    }

    fn modalities(&mut self, notebook: &Notebook, assembly: &ModelAssembly) {
        self.used.extend(["Modality", "Model"]);
        for (number, preference) in notebook.preferences.iter().enumerate() {
            self.numbers(format_args!("static C_{number}: [f32; {}]", preference.len()), preference);
        }
        let count = assembly.likelihoods.len();
        self.line("\n/// The modalities: A and C.");
        self.line(format_args!("pub static MODALITIES: [Modality; {count}] = ["));
        for (number, of) in notebook.likelihoods.iter().enumerate() {
            let on = &of.factors;
            self.line(format_args!(
                "    Modality::new(&A_{number}, A_{number}.shape(), &{on:?}, &C_{number}),"
            ));
        }
        self.line("];\n\n/// The generative model.");
        self.line("pub static MODEL: Model = Model::new(&FACTORS, &MODALITIES);\n");
    }

    fn policies(&mut self, notebook: &Notebook, choices: &Choices) {
        self.used.extend(["Candidates", "Policy"]);
        for (control, list) in choices.sequences.iter().enumerate() {
            let skip =
                if list.iter().any(|sequence| sequence.len() > 24) { "#[rustfmt::skip]\n" } else { "" };
            self.line(format_args!("{skip}static SEQUENCES_{control}: [Policy; {}] = [", list.len()));
            for sequence in list {
                let actions = sequence.iter().collect::<Vec<_>>();
                self.line(format_args!("    Policy::of(&{}),", bracketed(&actions)));
            }
            self.line("];");
        }
        let names = (0..choices.sequences.len()).map(|control| format!("&SEQUENCES_{control}"));
        let names = names.collect::<Vec<_>>().join(", ");
        let mut candidates = format!("Candidates::all(&[{names}])");
        if !choices.are_all() {
            let rows = choices.numbers();
            self.list(format_args!("static ROWS: [u16; {}]", rows.len()), &rows);
            candidates = format!("Candidates::listed(&[{names}], &ROWS)");
        }
        if let Some(habits) = &notebook.habits {
            self.used.insert("Habits");
            self.numbers(format_args!("static LN_E: [f32; {}]", habits.len()), habits);
            candidates += ".with_habits(Habits::Joint(&LN_E))";
        }
        self.line("\n/// The policies to choose from, in the order of the notebook.");
        self.line(format_args!("pub static CANDIDATES: Candidates = {candidates};\n"));
    }

    fn agent(&mut self, notebook: &Notebook) {
        self.used.insert("Scoring");
        debug_assert!(Convention::Default.scoring() == Scoring::JAX_PYMDP);
        self.line(
            "/// How policies are scored: every preference at every step, per-modality information gain.",
        );
        self.line(format_args!(
            "pub const SCORING: Scoring = Scoring {{ precision: {:?}, ..Scoring::JAX_PYMDP }};\n",
            notebook.precision
        ));
        self.line("/// An agent with room for all policies.");
        self.line("pub type Agent = iibt_core::Agent![MODEL, for CANDIDATES];\n");
        self.line("/// An agent that has observed nothing yet.");
        let longest = notebook.policies.iter().map(Vec::len).max().unwrap_or(0);
        let horizon = match notebook.horizon {
            steps if steps == longest => String::new(),
            steps => format!(".with_horizon({steps})"),
        };
        self.line(format_args!(
            "pub const AGENT: Agent = Agent::new(&MODEL).with_scoring(SCORING){horizon};"
        ));
    }

    /// A declaration and its entries.
    fn list(&mut self, declaration: impl Display, items: &[impl Display]) {
        let short = format!("{declaration} = {};", bracketed(items));
        if short.len() <= WIDTH {
            self.line(short);
        } else {
            self.line(format_args!(
                "#[rustfmt::skip]\n{declaration} = [\n{}];",
                wrapped(items.iter(), "    ")
            ));
        }
    }

    /// A declaration of numbers with all their digits.
    fn numbers(&mut self, declaration: impl Display, items: &[f32]) {
        let items: Vec<String> = items.iter().map(|&item| number(item)).collect();
        self.list(declaration, &items);
    }
}

/// A number that Rust reads back to the last bit.
fn number(value: f32) -> String {
    if value == f32::NEG_INFINITY { "f32::NEG_INFINITY".to_owned() } else { format!("{value:?}") }
}

/// A list on one line.
fn bracketed(items: &[impl Display]) -> String {
    format!("[{}]", items.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "))
}

/// Items with commas, in lines that are indented.
fn wrapped(items: impl Iterator<Item = impl Display>, indent: &str) -> String {
    let mut text = String::new();
    let mut line = indent.to_owned();
    for item in items {
        let item = format!("{item},");
        if line.len() > indent.len() && line.len() + 1 + item.len() > WIDTH {
            text += &(line + "\n");
            line = indent.to_owned();
        }
        if line.len() > indent.len() {
            line.push(' ');
        }
        line += &item;
    }
    text + &line + "\n"
}

/// Numbers in words: `0`, or `0 and 1`.
fn joined(numbers: &[usize]) -> String {
    numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(" and ")
}
