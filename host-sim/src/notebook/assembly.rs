//! The core's model of a notebook: forms chosen, tables borrowed.

use super::fault::NotebookFault;
use super::model::Notebook;
use super::structure::{self, Forms, LikelihoodForm, TransitionForm};
use iibt_core::inference::{Control, Factor, Likelihood, Modality, Model, Shape, Transition};

/// The forms of all tables of a notebook.
pub(super) struct ModelAssembly<'n> {
    notebook: &'n Notebook,
    pub(super) likelihoods: Vec<LikelihoodForm>,
    pub(super) transitions: Vec<TransitionForm>,
}

impl<'n> ModelAssembly<'n> {
    pub(super) fn new(notebook: &'n Notebook, forms: Forms) -> Self {
        let likelihoods = notebook.likelihoods.iter().map(|of| structure::likelihood(&of.table, forms));
        let transitions = notebook.transitions.iter().map(|of| structure::transition(of, forms));
        Self { notebook, likelihoods: likelihoods.collect(), transitions: transitions.collect() }
    }

    /// The bytes of all numbers: A, B, C and D.
    pub(super) fn bytes(&self) -> usize {
        let tables = self.likelihoods.iter().map(LikelihoodForm::bytes).sum::<usize>();
        let motion = self.transitions.iter().map(TransitionForm::bytes).sum::<usize>();
        let vectors = self.notebook.priors.iter().chain(&self.notebook.preferences);
        tables + motion + vectors.map(|vector| size_of_val(&vector[..])).sum::<usize>()
    }

    /// Calls `then` with the model.
    pub(super) fn with_model<T>(
        &self,
        then: impl FnOnce(&Model) -> Result<T, NotebookFault>,
    ) -> Result<T, NotebookFault> {
        let labels: Vec<Vec<&[u8]>> = self.likelihoods.iter().map(labels).collect();
        let numbered = self.likelihoods.iter().zip(&labels).enumerate();
        let likelihoods = numbered
            .map(|(number, (form, labels))| {
                form.build(labels).map_err(|error| NotebookFault::new(format!("A[{number}]: {error}")))
            })
            .collect::<Result<Vec<_>, _>>()?;
        let numbered = self.transitions.iter().enumerate();
        let transitions = numbered
            .map(|(number, form)| {
                form.build().map_err(|error| NotebookFault::new(format!("B[{number}]: {error}")))
            })
            .collect::<Result<Vec<_>, _>>()?;
        let factors = self.factors(&transitions)?;
        let modalities = self.modalities(&likelihoods)?;
        let model =
            Model::try_new(&factors, &modalities).map_err(|error| NotebookFault::new(error.to_string()))?;
        then(&model)
    }

    fn factors<'a>(
        &'a self,
        transitions: &'a [Box<dyn Transition + 'a>],
    ) -> Result<Vec<Factor<'a>>, NotebookFault> {
        let parts = transitions.iter().zip(&self.notebook.transitions).zip(&self.notebook.priors).enumerate();
        parts
            .map(|(number, ((form, of), prior))| {
                let shape = Shape::new(of.states(), &of.table.shape()[2..]);
                let factor = shape.and_then(|shape| Factor::try_new(&**form, shape, prior));
                let factor = factor.ok_or_else(|| {
                    NotebookFault::new(format!("B[{number}] and D[{number}] are no factor"))
                })?;
                let uncontrolled = self.notebook.is_uncontrolled(number);
                let control = if uncontrolled { Control::None } else { Control::Own };
                Ok(factor.coupled_to(&of.coupled_to).controlled_by(control))
            })
            .collect()
    }

    fn modalities<'a>(
        &'a self,
        likelihoods: &'a [Box<dyn Likelihood + 'a>],
    ) -> Result<Vec<Modality<'a>>, NotebookFault> {
        let parts =
            likelihoods.iter().zip(&self.notebook.likelihoods).zip(&self.notebook.preferences).enumerate();
        parts
            .map(|(number, ((form, of), preference))| {
                let (outcomes, states) = of.table.shape().split_at(1);
                let shape = Shape::new(outcomes[0], states);
                shape
                    .and_then(|shape| Modality::try_new(&**form, shape, &of.factors, preference))
                    .ok_or_else(|| NotebookFault::new(format!("A[{number}] and C[{number}] are no modality")))
            })
            .collect()
    }
}

fn labels(form: &LikelihoodForm) -> Vec<&[u8]> {
    match form {
        LikelihoodForm::OutcomeTable { labels, .. } => labels.iter().map(Vec::as_slice).collect(),
        _ => Vec::new(),
    }
}
