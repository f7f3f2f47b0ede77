//! A model with something to decide, and the memory to decide it in.

use iibt_core::inference::{Beliefs, Candidates, Evaluation, Evidence, Impossible, Model, Problem, Scoring};

/// The joint policies of a benchmark.
pub const POLICIES: usize = 16;

/// One robot's candidates in a benchmark.
const CANDIDATES: usize = 4;

/// Two robots of `S` states each, who choose among 4 x 4 joint policies.
#[derive(Clone, Copy, Debug)]
pub struct Benchmark<const S: usize> {
    /// What it is called.
    pub name: &'static str,
    /// The generative model.
    pub model: &'static Model<'static>,
    /// What there is to choose from.
    pub candidates: &'static Candidates<'static>,
    /// What was observed.
    pub observed: [Evidence<'static>; 3],
}

/// The memory that a benchmark works in.
#[derive(Clone, Debug)]
pub struct Workspace<const S: usize> {
    /// q(s) after the update.
    pub beliefs: Beliefs<S, 2>,
    /// The policies' scores.
    pub evaluation: Evaluation<S, 2, CANDIDATES, CANDIDATES>,
}

impl<const S: usize> Workspace<S> {
    /// Empty.
    #[must_use]
    pub fn new(benchmark: &Benchmark<S>) -> Self {
        Self { beliefs: Beliefs::prior(benchmark.model), evaluation: Evaluation::new() }
    }
}

impl<const S: usize> Benchmark<S> {
    /// One belief update and the posterior over the policies.
    ///
    /// # Errors
    /// [`Impossible`] when the observation has probability zero, which those of the benchmarks have not.
    pub fn run(&self, workspace: &mut Workspace<S>, scoring: Scoring) -> Result<[f32; POLICIES], Impossible> {
        workspace.beliefs = Beliefs::prior(self.model);
        workspace.beliefs.update(self.model, &self.observed)?;
        let problem = Problem::new(self.model, &workspace.beliefs, *self.candidates, scoring);
        workspace.evaluation.evaluate(&problem);
        let mut posterior = [0.0; POLICIES];
        iibt_core::math::assign(&mut posterior, workspace.evaluation.posterior().as_flattened());
        Ok(posterior)
    }
}
