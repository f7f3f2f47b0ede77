//! A model run through the core: beliefs by observation, decisions by policy.

use super::assembly::ModelAssembly;
use super::choices::Choices;
use super::convention::{self, Convention};
use super::fault::NotebookFault;
use super::model::{MAX_STATES, Notebook, Observation, Observations, Step};
use super::numpy::Floors;
use super::observing::{Observed, observe};
use super::report::{InferenceOutcome, InferenceReport, PolicyReport, Ranking, StepReport, StructureReport};
use super::structure::Forms;
use super::tally::Tally;
use crate::input::FileError;
use iibt_core::inference::{
    Beliefs, Candidates, Evaluation, Evidence, MAX_FACTORS, Model, OutOfRange, Problem, Scoring, Terms,
    policy,
};
use iibt_core::math;

/// The options of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct InferenceRun {
    /// The conventions.
    pub convention: Convention,
    /// The method of state inference, in place of the convention's.
    pub beliefs: Option<convention::BeliefMethod>,
    /// Whether structure is looked for.
    pub forms: Forms,
}

/// The progress of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InferenceProgress {
    /// The observations that are done.
    pub step: usize,
    /// All observations.
    pub steps: usize,
    /// The policies that are scored after the next one.
    pub policy: usize,
    /// All policies.
    pub policies: usize,
}

/// The stack for the largest sizes: tables lie in it on their way to the heap.
const STACK: usize = 64 << 20;

/// The factors' states that the small size has room for, by group.
const SMALL: usize = 8;

/// The states that the large size has room for, by group.
const LARGE: usize = MAX_STATES / MAX_FACTORS;

/// The candidates that are rolled out side by side, and the policies by candidate.
const ROWS: usize = 64;
const PLANES: usize = 4;

/// The policies that are scored before progress is told.
const BATCH: usize = ROWS * PLANES;

impl Notebook {
    /// Runs the model and returns the report; `progress` receives the progress.
    ///
    /// # Errors
    /// A [`FileError`] when there is no observation, or too many combinations for the joint
    /// information gain.
    pub fn infer(
        &self,
        run: InferenceRun,
        progress: &mut (dyn FnMut(InferenceProgress) + Send),
    ) -> Result<InferenceReport, FileError> {
        let work = || self.run(run, progress).map_err(|fault| fault.in_file(&self.file));
        std::thread::scope(|scope| {
            let worker = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work);
            let failed = |reason: &str| NotebookFault::new(reason).in_file(&self.file);
            worker
                .map_err(|error| failed(&error.to_string()))?
                .join()
                .map_err(|_| failed("the run broke off"))?
        })
    }

    fn run(
        &self,
        run: InferenceRun,
        progress: &mut (dyn FnMut(InferenceProgress) + Send),
    ) -> Result<InferenceReport, NotebookFault> {
        let (steps, once) = match &self.observations {
            Observations::None => {
                return Err(NotebookFault::new("obs and steps are missing: what was observed?"));
            }
            Observations::Once(observation) => {
                (vec![Step { action: None, observation: observation.clone() }], true)
            }
            Observations::Steps(steps) => (steps.clone(), false),
        };
        let assembly = ModelAssembly::new(self, run.forms);
        let floors = if run.convention == Convention::Joint { Some(Floors::new(self)?) } else { None };
        let structure = StructureReport {
            A: assembly.likelihoods.iter().map(|form| form.name()).collect(),
            B: assembly.transitions.iter().map(|form| form.name()).collect(),
            bytes: assembly.bytes(),
            dense_bytes: self.dense_bytes(),
        };
        let reports = assembly.with_model(|model| {
            let scoring = Scoring { precision: self.precision, ..run.convention.scoring() };
            let runner = Runner { notebook: self, model, run, scoring, floors: floors.as_ref() };
            if model.states() <= SMALL * MAX_FACTORS {
                runner.all::<SMALL>(&steps, progress)
            } else {
                runner.all::<LARGE>(&steps, progress)
            }
        })?;
        let (name, convention) = (self.name.clone(), run.convention.name());
        let result = match <[StepReport; 1]>::try_from(reports) {
            Ok([report]) if once => InferenceOutcome::Once(Box::new(report)),
            Ok(reports) => InferenceOutcome::Record { steps: reports.into() },
            Err(steps) => InferenceOutcome::Record { steps },
        };
        Ok(InferenceReport { name, convention, gamma: self.precision, structure, result })
    }
}

struct Runner<'a> {
    notebook: &'a Notebook,
    model: &'a Model<'a>,
    run: InferenceRun,
    scoring: Scoring,
    floors: Option<&'a Floors<'a>>,
}

impl Runner<'_> {
    /// Every step, in beliefs of `S` states by group.
    fn all<const S: usize>(
        &self,
        steps: &[Step],
        progress: &mut (dyn FnMut(InferenceProgress) + Send),
    ) -> Result<Vec<StepReport>, NotebookFault> {
        let misfit = |error: OutOfRange| NotebookFault::new(error.to_string());
        let mut beliefs = Beliefs::<S, MAX_FACTORS>::try_prior(self.model).map_err(misfit)?;
        let mut evaluation = Box::new(Evaluation::<S, MAX_FACTORS, ROWS, PLANES>::new());
        let mut reports = Vec::new();
        for (number, step) in steps.iter().enumerate() {
            if let Some(action) = &step.action {
                // A factor that moves by itself has an action in the file and none in the model.
                let controlled = &action[..self.model.controls().min(action.len())];
                beliefs.predict(self.model, controlled).map_err(misfit)?;
            }
            let observed = self.observe(&mut beliefs, &step.observation);
            let policies = self.notebook.policies.len();
            let mut tell =
                |policy| progress(InferenceProgress { step: number, steps: steps.len(), policy, policies });
            let decided = self.decide(&beliefs, &mut evaluation, &mut tell).map_err(misfit)?;
            reports.push(self.report(&beliefs, observed, decided));
        }
        Ok(reports)
    }

    fn observe<const S: usize>(
        &self,
        beliefs: &mut Beliefs<S, MAX_FACTORS>,
        observation: &[Observation],
    ) -> Observed {
        let evidence: Vec<Evidence> = observation.iter().map(Observation::evidence).collect();
        let convention = self.run.convention;
        let method = self.run.beliefs.unwrap_or(convention.beliefs());
        observe(beliefs, self.model, &evidence, method, convention.sweeps())
    }

    /// The terms of every policy from the core, and their parts.
    fn decide<const S: usize>(
        &self,
        beliefs: &Beliefs<S, MAX_FACTORS>,
        evaluation: &mut Evaluation<S, MAX_FACTORS, ROWS, PLANES>,
        tell: &mut dyn FnMut(usize),
    ) -> Result<DecidedStep, OutOfRange> {
        let notebook = self.notebook;
        let mut decided = DecidedStep { terms: Vec::new(), tallies: Vec::new() };
        for batch in notebook.policies.chunks(BATCH) {
            let choices = Choices::new(notebook, batch, self.model.controls());
            let (lists, rows) = (choices.lists(), choices.numbers());
            let candidates = Candidates::listed(&lists, &rows);
            let problem = Problem::new(self.model, beliefs, candidates, self.scoring);
            let problem = Problem { horizon: notebook.horizon, ..problem };
            evaluation.begin(&problem)?;
            while evaluation.advance(&problem, ROWS) {
                tell(decided.terms.len() + evaluation.done());
            }
            decided.terms.extend_from_slice(evaluation.terms());
            for policy in 0..batch.len() {
                tell(decided.tallies.len());
                decided.tallies.push(Tally::of(&problem, policy, self.floors)?);
            }
        }
        for (terms, tally) in decided.terms.iter_mut().zip(&decided.tallies) {
            terms.information_gain += tally.floors as f32;
            terms.ambiguity -= tally.floors as f32;
        }
        Ok(decided)
    }

    fn report<const S: usize>(
        &self,
        beliefs: &Beliefs<S, MAX_FACTORS>,
        observed: Observed,
        decided: DecidedStep,
    ) -> StepReport {
        let habits = self.notebook.habits.as_deref();
        let ln_prior = |policy: usize| habits.map_or(0.0, |habits| habits[policy]);
        let convention = self.run.convention;
        let free_energies: Vec<f32> =
            decided.terms.iter().map(|terms| convention.expected_free_energy(terms)).collect();
        let values: Vec<f32> = free_energies.iter().map(|free_energy| -free_energy).collect();
        let numbered = values.iter().enumerate();
        let scores: Vec<f32> =
            numbered.map(|(policy, &value)| self.scoring.score(ln_prior(policy), 0.0, value)).collect();
        let mut q_pi = scores.clone();
        policy::posterior(&mut q_pi, self.scoring.window);
        let chosen = math::argmax(&scores);
        let ranking =
            Ranking { scores: &scores, values: &values, habits, tallies: &decided.tallies, convention };
        let floors = |tally: &Tally| self.floors.map(|_| tally.floors);
        let parts = decided.terms.iter().zip(&decided.tallies);
        StepReport {
            beliefs: observed.method,
            note: observed.note,
            qs: (0..self.model.factors().len())
                .map(|factor| beliefs.of(self.model, factor).expect("the model has it").to_vec())
                .collect(),
            F: observed.update.map(|update| update.free_energy),
            surprise: observed.surprise,
            converged: observed.update.is_some_and(|update| update.converged),
            sweeps: observed.update.map_or(0, |update| update.sweeps),
            impossible: observed.impossible.map(|impossible| impossible.to_string()),
            why: ranking.why(chosen),
            terms: parts.map(|(&terms, tally)| PolicyReport::new(terms, tally, floors(tally))).collect(),
            policy: chosen,
            actions: self.notebook.policies[chosen].clone(),
            G: values,
            expected_free_energy: free_energies,
            q_pi,
        }
    }
}

/// The figures of every policy.
struct DecidedStep {
    terms: Vec<Terms>,
    tallies: Vec<Tally>,
}
