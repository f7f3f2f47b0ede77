//! An outcome that labels of the states determine, exactly or with noise.

use super::{FLOOR, Likelihood, TableError};
use crate::inference::table;
use crate::inference::{Evidence, Shape, Terms};
use crate::math::{self, Prediction};

/// The most labels that the states of one condition carry.
pub const MAX_LABELS: usize = 16;

/// The most kinds of columns.
pub const MAX_KINDS: usize = 16;

/// P(o | s1, ..., sn) = column(kind(label1(s1), ..., labeln(sn)), o).
///
/// A byte per state, a byte per combination of labels and one column per kind take the place of a
/// number for each outcome and combination of states. A prediction costs the states' sum and the
/// labels' product. Where every column has a single one, the outcome is certain given the states.
///
/// ```
/// use iibt_core::inference::{Likelihood, OutcomeTable};
///
/// // Two robots among three cells, of which cell 2 is the goal: are none, one or both there?
/// static AT_GOAL: OutcomeTable = OutcomeTable::new(
///     &[&[0, 0, 1], &[0, 0, 1]],                              // which cells are the goal
///     &[0, 1, 1, 2],                                          // none, one, one, both
///     &[1.0, 0.0, 0.0, 0.0, 0.9, 0.1, 0.0, 0.2, 0.8],         // what is then observed
///     3,
/// );
/// assert_eq!(AT_GOAL.probability(0, &[0, 1]), 1.0);
/// assert_eq!(AT_GOAL.probability(2, &[2, 2]), 0.8);
/// // Kind 1 has no column.
/// assert!(OutcomeTable::try_new(&[&[0, 1]], &[0, 1], &[1.0, 0.0], 2).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutcomeTable<'a> {
    labels: &'a [&'a [u8]],
    kinds: &'a [u8],
    columns: &'a [f32],
    shape: Shape,
    combinations: Shape,
    ambiguity: [f32; MAX_KINDS],
    count: usize,
}

impl<'a> OutcomeTable<'a> {
    /// A table from the label of each state of each condition, the kind of each combination of
    /// labels, the last condition's labels running fastest, and the distribution over `outcomes`
    /// outcomes of each kind.
    ///
    /// # Panics
    /// When a label, kind or column is not what it should be; in a `const` or `static` this fails
    /// the build.
    #[must_use]
    pub const fn new(labels: &'a [&'a [u8]], kinds: &'a [u8], columns: &'a [f32], outcomes: usize) -> Self {
        match Self::try_new(labels, kinds, columns, outcomes) {
            Ok(table) => table,
            Err(TableError::Column(..) | TableError::Entry(_)) => {
                panic!("a column of an outcome table is no distribution")
            }
            Err(TableError::Range(_)) => panic!("a label or kind of an outcome table is out of range"),
            Err(_) => panic!("an outcome table does not have the entries that its labels ask for"),
        }
    }

    /// Builds it from numbers that are only known at run time.
    ///
    /// # Errors
    /// [`TableError::Empty`] without conditions, states, labels or outcomes, [`TableError::Range`]
    /// with the place of a label of [`MAX_LABELS`] or more or of a kind that has no column,
    /// [`TableError::Length`] when there are not as many kinds as combinations of labels, and what
    /// is wrong with a column.
    pub const fn try_new(
        labels: &'a [&'a [u8]],
        kinds: &'a [u8],
        columns: &'a [f32],
        outcomes: usize,
    ) -> Result<Self, TableError> {
        let (shape, combinations) = match shapes(labels, outcomes) {
            Ok(shapes) => shapes,
            Err(error) => return Err(error),
        };
        if outcomes == 0 || !columns.len().is_multiple_of(outcomes) || columns.len() / outcomes > MAX_KINDS {
            return Err(TableError::Length(columns.len()));
        }
        if !matches!(combinations.columns(), Some(count) if count == kinds.len()) {
            return Err(TableError::Length(kinds.len()));
        }
        let count = columns.len() / outcomes;
        let mut at = 0;
        while at < kinds.len() {
            if kinds[at] as usize >= count {
                return Err(TableError::Range(at));
            }
            at += 1;
        }
        let mut ambiguity = [0.0; MAX_KINDS];
        let mut kind = 0;
        let mut rest = columns;
        while kind < count {
            let (column, others) = rest.split_at(outcomes);
            let Some(one) = Shape::new(outcomes, &[1]) else { return Err(TableError::Empty) };
            match table::check(column, &one) {
                Ok(()) => {}
                Err(TableError::Column(_, sum)) => return Err(TableError::Column(kind, sum)),
                Err(error) => return Err(error),
            }
            ambiguity[kind] = math::entropy(column);
            rest = others;
            kind += 1;
        }
        Ok(Self { labels, kinds, columns, shape, combinations, ambiguity, count })
    }

    /// Its shape.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// The kind of a combination of states; kind zero outside the table.
    fn kind(&self, states: &[usize]) -> usize {
        let mut at = 0;
        for (condition, (labels, &state)) in self.labels.iter().zip(states).enumerate() {
            let label = labels.get(state).copied().map_or(0, usize::from);
            at = at * self.combinations.states(condition) + label;
        }
        self.kinds.get(at).copied().map_or(0, usize::from)
    }

    /// The distribution of outcomes of one kind.
    fn column(&self, kind: usize) -> &[f32] {
        self.columns.chunks_exact(self.shape.values().max(1)).nth(kind).unwrap_or(&[])
    }

    /// The mass of each label of one condition under its belief.
    #[inline(never)]
    fn label_masses(&self, condition: usize, belief: &[f32]) -> [f32; MAX_LABELS] {
        let mut masses = [0.0; MAX_LABELS];
        let labels = self.labels.get(condition).copied().unwrap_or(&[]);
        for (&label, q) in labels.iter().zip(belief) {
            masses[usize::from(label) % MAX_LABELS] += q;
        }
        masses
    }

    /// The kinds in rows, one for each label of the first of two conditions.
    fn rows(&self) -> impl Iterator<Item = &'a [u8]> {
        self.kinds.chunks_exact(self.combinations.states(1).max(1))
    }

    /// The mass of each kind under independent beliefs.
    fn kind_masses(&self, beliefs: &[&[f32]]) -> [f32; MAX_KINDS] {
        let mut masses = [0.0; MAX_KINDS];
        self.for_each_combination(beliefs, None, &mut |_, kind, mass| masses[kind % MAX_KINDS] += mass);
        masses
    }

    /// Four outcomes' probabilities of one kind; zero beyond the last outcome.
    #[inline]
    fn block(&self, kind: usize, block: usize) -> Lanes {
        let mut lanes = [0.0; LANES];
        let outcomes = self.shape.values();
        let (from, until) = (kind * outcomes + LANES * block, (kind + 1) * outcomes);
        match self.columns.get(from..from + LANES) {
            Some(column) if from + LANES <= until => math::assign(&mut lanes, column),
            _ => math::assign(&mut lanes, self.columns.get(from..until).unwrap_or(&[])),
        }
        lanes
    }

    /// The terms of four outcomes for every pair.
    fn expect_block(&self, block: &Block, firsts: &[&[f32]], seconds: &[&[f32]], pairs: &mut [Terms]) {
        let count = seconds.len().max(1);
        let mut left = [Remains::NONE; MAX_LABELS];
        let left = left.get_mut(..self.combinations.states(1)).unwrap_or_default();
        for (at, seconds) in seconds.chunks(SIDE_BY_SIDE).enumerate() {
            let mut masses = [[0.0; MAX_LABELS]; SIDE_BY_SIDE];
            for (masses, second) in masses.iter_mut().zip(seconds) {
                *masses = self.label_masses(1, second);
            }
            for (first, row) in firsts.iter().zip(pairs.chunks_exact_mut(count)) {
                self.sum_out(&self.label_masses(0, first), &block.columns, left);
                let row = row.chunks_mut(SIDE_BY_SIDE).nth(at).unwrap_or_default();
                for (masses, terms) in masses.iter().zip(row) {
                    *terms += block.pair(left, masses);
                }
            }
        }
    }

    /// The columns and their entropies for each label of the second condition, with the first
    /// summed out.
    #[inline]
    fn sum_out(&self, first: &[f32; MAX_LABELS], columns: &[Remains; MAX_KINDS], left: &mut [Remains]) {
        left.fill(Remains::NONE);
        for (kinds, p) in self.rows().zip(first) {
            for (&kind, left) in kinds.iter().zip(left.iter_mut()) {
                *left = left.plus(*p, &columns[usize::from(kind) % MAX_KINDS]);
            }
        }
    }

    /// Visits every combination of labels with its kind and its mass, one condition's mass left
    /// out.
    fn for_each_combination(
        &self,
        beliefs: &[&[f32]],
        except: Option<usize>,
        visit: &mut dyn FnMut(&[usize], usize, f32),
    ) {
        let mut masses = [[0.0; MAX_LABELS]; super::super::shape::MAX_CONDITIONS];
        for (condition, (masses, belief)) in masses.iter_mut().zip(beliefs).enumerate() {
            *masses = self.label_masses(condition, belief);
        }
        self.combinations.for_each_column(|at, labels| {
            let mut product = 1.0;
            for (condition, (&label, masses)) in labels.iter().zip(&masses).enumerate() {
                if except != Some(condition) {
                    product *= masses.get(label).copied().unwrap_or(0.0);
                }
            }
            visit(labels, self.kinds.get(at).copied().map_or(0, usize::from), product);
        });
    }

    /// Adds to `message`, for each state, the message to its label, given `of` for each kind.
    fn tell(&self, of: &[f32; MAX_KINDS], beliefs: &[&[f32]], to: usize, message: &mut [f32]) {
        let mut told = [0.0; MAX_LABELS];
        let about = |kind: u8| of[usize::from(kind) % MAX_KINDS];
        match (beliefs, to) {
            ([_], _) => told.iter_mut().zip(self.kinds).for_each(|(told, &kind)| *told = about(kind)),
            ([_, second], 0) => {
                let masses = self.label_masses(1, second);
                for (told, row) in told.iter_mut().zip(self.rows()) {
                    *told = row.iter().zip(masses).map(|(&kind, q)| q * about(kind)).sum();
                }
            }
            ([first, _], _) => {
                for (row, p) in self.rows().zip(self.label_masses(0, first)) {
                    told.iter_mut().zip(row).for_each(|(told, &kind)| *told += p * about(kind));
                }
            }
            _ => self.for_each_combination(beliefs, Some(to), &mut |labels, kind, mass| {
                if let Some(told) = labels.get(to).and_then(|&label| told.get_mut(label)) {
                    *told += mass * of[kind % MAX_KINDS];
                }
            }),
        }
        let labels = self.labels.get(to).copied().unwrap_or(&[]);
        for (sum, &label) in message.iter_mut().zip(labels) {
            *sum += told.get(usize::from(label)).copied().unwrap_or(0.0);
        }
    }

    /// P(e | kind) of each kind.
    fn evidence(&self, evidence: Evidence) -> [f32; MAX_KINDS] {
        let mut of = [0.0; MAX_KINDS];
        for (of, column) in of.iter_mut().zip(self.columns.chunks_exact(self.shape.values().max(1))) {
            *of = evidence.probability(column.len(), |outcome| column.get(outcome).copied().unwrap_or(0.0));
        }
        of
    }
}

/// The number of outcomes that are computed side by side.
const LANES: usize = 4;

/// The numbers of four outcomes.
type Lanes = [f32; LANES];

/// The number of beliefs about the second condition whose label masses are summed beforehand.
const SIDE_BY_SIDE: usize = 4;

/// A column's probabilities of four outcomes, and its entropy: or a mixture of columns.
#[derive(Clone, Copy)]
struct Remains {
    outcomes: Lanes,
    ambiguity: f32,
}

impl Remains {
    const NONE: Self = Self { outcomes: [0.0; LANES], ambiguity: 0.0 };

    /// The sum of both, the other scaled. By value, so that a vector unit can carry it out.
    #[inline]
    fn plus(mut self, by: f32, other: &Self) -> Self {
        add_scaled(&mut self.outcomes, by, &other.outcomes);
        self.ambiguity += by * other.ambiguity;
        self
    }
}

/// Four outcomes: each kind's column, and the preferences.
struct Block {
    columns: [Remains; MAX_KINDS],
    preferences: Lanes,
}

impl Block {
    /// The terms of a pair.
    #[inline]
    fn pair(&self, left: &[Remains], masses: &[f32; MAX_LABELS]) -> Terms {
        let parts = left.iter().zip(masses);
        let expected = parts.fold(Remains::NONE, |sum, (left, mass)| sum.plus(*mass, left));
        let mut prediction = Prediction::new();
        prediction.add(&expected.outcomes, &self.preferences);
        Terms::of(&prediction, expected.ambiguity)
    }
}

#[inline]
fn add_scaled(sums: &mut Lanes, by: f32, terms: &Lanes) {
    sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += by * term);
}

/// The shape over states, and the one over labels with its kinds left open.
const fn shapes(labels: &[&[u8]], outcomes: usize) -> Result<(Shape, Shape), TableError> {
    let mut states = [0; super::super::shape::MAX_CONDITIONS];
    let mut counts = [0; super::super::shape::MAX_CONDITIONS];
    if labels.is_empty() || labels.len() > states.len() {
        return Err(TableError::Empty);
    }
    let mut condition = 0;
    while condition < labels.len() {
        let of = labels[condition];
        let mut state = 0;
        while state < of.len() {
            if of[state] as usize >= MAX_LABELS {
                return Err(TableError::Range(state));
            }
            if of[state] as usize >= counts[condition] {
                counts[condition] = of[state] as usize + 1;
            }
            state += 1;
        }
        states[condition] = of.len();
        condition += 1;
    }
    let (states, _) = states.split_at(labels.len());
    let (counts, _) = counts.split_at(labels.len());
    match (Shape::new(outcomes, states), Shape::new(1, counts)) {
        (Some(states), Some(counts)) => Ok((states, counts)),
        _ => Err(TableError::Empty),
    }
}

impl Likelihood for OutcomeTable<'_> {
    fn probability(&self, outcome: usize, states: &[usize]) -> f32 {
        let inside =
            states.iter().enumerate().all(|(condition, &state)| state < self.shape.states(condition));
        let column = self.column(self.kind(states));
        if inside { column.get(outcome).copied().unwrap_or(0.0) } else { 0.0 }
    }

    fn expect(&self, shape: &Shape, beliefs: &[&[f32]], preference: &[f32]) -> Terms {
        if let [first, second] = *beliefs {
            // The same sums in the same order, whether a pair comes alone or with others.
            let mut pair = [Terms::ZERO];
            self.expect_pairs(shape, &[first], &[second], preference, &mut pair);
            let [terms] = pair;
            return terms;
        }
        let masses = self.kind_masses(beliefs);
        let ambiguity = masses.iter().zip(&self.ambiguity).map(|(mass, entropy)| mass * entropy).sum();
        let mut prediction = Prediction::new();
        for (block, preferences) in preference.chunks(LANES).enumerate() {
            let mut sums = [0.0; LANES];
            for (kind, mass) in (0..self.count).zip(&masses) {
                add_scaled(&mut sums, *mass, &self.block(kind, block));
            }
            prediction.add_some(sums.into_iter(), preferences);
        }
        Terms::of(&prediction, ambiguity)
    }

    fn expect_pairs(
        &self,
        _shape: &Shape,
        firsts: &[&[f32]],
        seconds: &[&[f32]],
        preference: &[f32],
        pairs: &mut [Terms],
    ) {
        pairs.fill(Terms::ZERO);
        for (number, preferences) in preference.chunks(LANES).enumerate() {
            let mut block = Block { columns: [Remains::NONE; MAX_KINDS], preferences: [0.0; LANES] };
            math::assign(&mut block.preferences, preferences);
            for ((kind, column), entropy) in
                block.columns.iter_mut().take(self.count).enumerate().zip(&self.ambiguity)
            {
                // The ambiguity is about all outcomes: it counts once.
                let ambiguity = if number == 0 { *entropy } else { 0.0 };
                *column = Remains { outcomes: self.block(kind, number), ambiguity };
            }
            self.expect_block(&block, firsts, seconds, pairs);
        }
    }

    fn message(&self, _: &Shape, evidence: Evidence, beliefs: &[&[f32]], to: usize, message: &mut [f32]) {
        self.tell(&self.evidence(evidence), beliefs, to, message);
    }

    fn log_message(&self, _: &Shape, evidence: Evidence, beliefs: &[&[f32]], to: usize, scores: &mut [f32]) {
        let of = self.evidence(evidence).map(|p| math::ln(p.max(FLOOR)));
        self.tell(&of, beliefs, to, scores);
    }

    fn effort(&self, shape: &Shape) -> usize {
        let states: usize = (0..shape.conditions()).map(|condition| shape.states(condition)).sum();
        states.saturating_add(self.combinations.columns().unwrap_or(usize::MAX))
    }
}
