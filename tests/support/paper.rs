//! The paper's sections 5.1 and 5.2: data and recovered numbers.

use iibt_core::grid::{Cell, Map, Path};
use iibt_core::inference::belief::update_pair;
use iibt_core::inference::published::parallel_sweep;
use iibt_core::inference::{
    Belief, IdentityNoise, Interaction, Likelihood, NextState, OutcomeTable, Policy, Preference, Scoring,
    Side, Terms, Workspace,
};
use iibt_core::{grid::Move, math};

/// Cells of the paper's grid.
pub const S: usize = 49;

/// One decision of the paper, seen from robot 1.
pub struct Decision {
    /// The candidate paths of both robots.
    pub paths: [Vec<Path>; 2],
    /// Where an obstacle was found, if one was.
    pub obstacle: Option<Cell>,
    /// The longest path.
    pub horizon: usize,
    /// The recovered probabilities, a row for each path of robot 1.
    pub published: Vec<f32>,
}

/// Section 5.1: the initial choice. Robot 2's paths in the order of the numbers: b, a, c, d.
///
/// # Panics
/// When the scenario `two-goals` is not built in.
#[must_use]
pub fn section_5_1() -> Decision {
    #[rustfmt::skip]
    let published = [
        1.511_580_8e-8, 5.661_653e-7, 4.053_619_6e-8, 3.570_795_7e-8,
        9.957_6e-8, 2.100_489e-7, 0.081_268_09, 0.071_587_82,
        7.469_709e-8, 0.847_142_3, 1.331_203_8e-8, 1.172_637_1e-8,
        6.823_203e-8, 5.737_54e-7, 4.089_163_5e-8, 3.602_082e-8,
    ];
    Decision { paths: listed("two-goals"), obstacle: None, horizon: 10, published: published.into() }
}

/// Section 5.2: one step later, with an obstacle on 30. Columns Y1, Y3, Y2.
///
/// # Panics
/// When the scenario `detour` is not built in.
#[must_use]
pub fn section_5_2() -> Decision {
    #[rustfmt::skip]
    let published = [
        7.849_834_4e-7, 1.661_324_1e-7, 5.219_725e-8,
        0.999_998_8, 1.561_296_8e-7, 1.343_881_5e-8,
        8.982_09e-14, 2.568_905_3e-8, 5.546_443e-15,
    ];
    Decision { paths: listed("detour"), obstacle: Some(Cell(30)), horizon: 7, published: published.into() }
}

/// The candidate paths of the two robots in a built-in scenario.
fn listed(scenario: &str) -> [Vec<Path>; 2] {
    let scenario = host_sim::library::find(scenario).expect("it is built in").expect("it is sound");
    [0, 1].map(|robot| scenario.robots[robot].paths.clone())
}

/// Which arithmetic to use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The paper's own, artefacts included.
    AsPublished,
    /// The product's.
    Default,
}

/// A judged decision.
pub struct Judged {
    /// The beliefs of both robots after the first observation.
    pub beliefs: [Belief<S>; 2],
    /// The posterior over the joint policies, a row for each path of robot 1.
    pub posterior: Vec<f32>,
}

impl Decision {
    /// The posterior over the joint policies.
    #[must_use]
    pub fn judge(&self, mode: Mode) -> Judged {
        let (sensors, table) = ([IdentityNoise::new(0.9952), IdentityNoise::new(0.904)], outcomes());
        let beliefs = self.beliefs(mode, &sensors, &table);
        let scoring = if mode == Mode::Default { Scoring::DEFAULT } else { Scoring::AS_PUBLISHED };
        let preference = self.preference();
        let policies =
            self.paths.each_ref().map(|paths| paths.iter().map(|path| path.actions).collect::<Vec<Policy>>());
        let transition = transition();
        let side = |robot: usize| Side {
            likelihood: &sensors[robot],
            transition: &transition,
            belief: &beliefs[robot],
            preference: &preference,
            policies: &policies[robot],
        };
        let interaction = Interaction {
            outcomes: &table,
            preference: &Preference::new([0.0, 1.0, 0.0]),
            collision: if mode == Mode::Default { -4.0 } else { 0.0 },
        };
        let mut workspace = Workspace::<S, 4>::new();
        workspace.evaluate(&side(0), &side(1), &interaction, &scoring, self.horizon);
        let value = |terms: &Terms| -terms.expected_free_energy(scoring.convention);
        let mut posterior = vec![];
        for (row, first) in workspace.pairs().iter().zip(workspace.first_terms()).take(policies[0].len()) {
            for (pair, second) in row.iter().zip(workspace.second_terms()).take(policies[1].len()) {
                posterior.push(scoring.score(0.0, 0.0, value(first) + value(second) + pair));
            }
        }
        math::softmax(&mut posterior);
        Judged { beliefs, posterior }
    }

    fn beliefs(
        &self,
        mode: Mode,
        sensors: &[IdentityNoise<S>; 2],
        table: &OutcomeTable<S, 3, 3>,
    ) -> [Belief<S>; 2] {
        let seen = [0, 1].map(|robot| self.paths[robot][0].start.index());
        if mode == Mode::AsPublished {
            let evidence =
                [0, 1].map(|robot| core::array::from_fn(|s| sensors[robot].probability(seen[robot], s)));
            return parallel_sweep((&evidence[0], &evidence[1]), table, 0).into();
        }
        let mut beliefs = [Belief::uniform(); 2];
        for ((belief, sensor), seen) in beliefs.iter_mut().zip(sensors).zip(seen) {
            belief.update(sensor, seen).expect("every cell can be read");
        }
        let [first, second] = &mut beliefs;
        update_pair(first, second, table, 0).expect("nobody is on a goal");
        beliefs
    }

    fn preference(&self) -> Preference<S> {
        let mut preference = [0.0; S];
        (preference[24], preference[26]) = (1.0, 1.0);
        if let Some(obstacle) = self.obstacle {
            preference[obstacle.index()] = -1.0;
        }
        Preference::new(preference)
    }
}

/// The paper's grid.
#[must_use]
pub fn map() -> Map<2> {
    Map::new(7, 7).expect("49 cells fit 64 bits")
}

fn transition() -> NextState<S, 5> {
    NextState::new(
        Move::ALL.map(|step| core::array::from_fn(|cell| map().neighbour(Cell(cell as u16), step).0)),
    )
}

fn outcomes() -> OutcomeTable<S, 3, 3> {
    let mut labels = [0; S];
    (labels[24], labels[26]) = (1, 2);
    OutcomeTable::new(labels, [[0, 2, 2], [2, 2, 1], [2, 1, 2]])
}
