//! The policies of a notebook as the core's candidates.

use super::model::{MAX_POLICIES, Notebook};
use iibt_core::inference::{Candidates, Policy};

/// The rows are numbers of two bytes.
const _: () = assert!(MAX_POLICIES <= u16::MAX as usize);

/// The different action sequences of each factor, and which of them each policy combines.
pub(super) struct Choices {
    /// By control; none for a factor that moves by itself.
    pub(super) sequences: Vec<Vec<Policy>>,
    /// By policy the number of each control's sequence.
    pub(super) rows: Vec<Vec<usize>>,
}

impl Choices {
    /// The choices in some of a notebook's policies, for a model with `controls` controls.
    pub(super) fn new(notebook: &Notebook, policies: &[Vec<Vec<u8>>], controls: usize) -> Self {
        let mut choices = Self { sequences: vec![Vec::new(); controls.max(1)], rows: Vec::new() };
        for policy in policies {
            let mut row = vec![0; controls.max(1)];
            for (control, place) in row.iter_mut().enumerate().take(controls) {
                if !notebook.is_uncontrolled(control) {
                    let actions: Vec<u8> = policy.iter().map(|step| step[control]).collect();
                    *place = choices.place(control, Policy::new(&actions).unwrap_or_default());
                }
            }
            choices.rows.push(row);
        }
        choices
    }

    fn place(&mut self, control: usize, sequence: Policy) -> usize {
        let known = &mut self.sequences[control];
        known.iter().position(|known| *known == sequence).unwrap_or_else(|| {
            known.push(sequence);
            known.len() - 1
        })
    }

    /// Whether the policies are all combinations of the sequences, in the core's order.
    pub(super) fn are_all(&self) -> bool {
        let lists = self.lists();
        let all = Candidates::all(&lists);
        let same = |(policy, row): (usize, &Vec<usize>)| {
            row.iter().enumerate().all(|(control, &place)| all.sequence(policy, control) == place)
        };
        all.len() == self.rows.len() && self.rows.iter().enumerate().all(same)
    }

    /// The candidates of these lists and rows, in the order of the notebook.
    pub(super) fn candidates<'a>(&self, lists: &'a [&'a [Policy]], rows: &'a [u16]) -> Candidates<'a> {
        if self.are_all() { Candidates::all(lists) } else { Candidates::listed(lists, rows) }
    }

    /// The sequences as slices.
    pub(super) fn lists(&self) -> Vec<&[Policy]> {
        self.sequences.iter().map(Vec::as_slice).collect()
    }

    /// The rows in the core's numbers: there are no more sequences than policies, which are
    /// [`MAX_POLICIES`] at the most.
    pub(super) fn numbers(&self) -> Vec<u16> {
        self.rows.iter().flatten().map(|&place| place as u16).collect()
    }
}
