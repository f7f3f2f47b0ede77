//! The paper's sections 5.1 and 5.2: data and recovered numbers.

use iibt_core::actions::Action;
use iibt_core::grid::{Cell, Map, Path};
use iibt_core::inference::{
    Beliefs, Candidates, Encounter, Evaluation, Evidence, Factor, IdentityNoise, Modality, Model, NextState,
    OutcomeTable, Policy, Problem, Scoring, Shape, Sweeps,
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
    pub beliefs: [Vec<f32>; 2],
    /// The posterior over the joint policies, a row for each path of robot 1.
    pub posterior: Vec<f32>,
}

impl Decision {
    /// The posterior over the joint policies.
    #[must_use]
    pub fn judge(&self, mode: Mode) -> Judged {
        let labels: [u8; S] = core::array::from_fn(|cell| match cell {
            24 => 1,
            26 => 2,
            _ => 0,
        });
        let labels = [&labels[..]; 2];
        let outcomes = OutcomeTable::new(&labels, &[0, 2, 2, 2, 2, 1, 2, 1, 2], &CERTAIN, 3);
        let sensors = [IdentityNoise::new(0.9952, S), IdentityNoise::new(0.904, S)];
        let (next, place, flat, preference) =
            (next(), Shape::new(S, &[S]).expect("49"), [1.0 / S as f32; S], self.preference());
        let motion = NextState::new(&next, S);
        let factors = [Factor::new(&motion, place, &flat); 2];
        let modalities = [
            Modality::new(&sensors[0], place, &[0], &preference),
            Modality::new(&sensors[1], place, &[1], &preference),
            Modality::new(&outcomes, outcomes.shape(), &[0, 1], &[0.0, 1.0, 0.0]),
        ];
        let model = Model::new(&factors, &modalities);
        let beliefs = self.beliefs(mode, &model);
        let policies =
            self.paths.each_ref().map(|paths| paths.iter().map(|path| path.actions).collect::<Vec<Policy>>());
        let sequences = policies.each_ref().map(|policies| policies.as_slice());
        let aversions = preference.map(|value| value.min(0.0));
        let problem = Problem {
            horizon: self.horizon,
            aversions: &[&aversions, &aversions],
            encounters: if mode == Mode::Default { &[&Collision] } else { &[] },
            ..Problem::new(
                &model,
                &beliefs,
                Candidates::all(&sequences),
                match mode {
                    Mode::Default => Scoring::DEFAULT,
                    Mode::AsPublished => Scoring::AS_PUBLISHED,
                },
            )
        };
        let mut evaluation = Evaluation::<S, 2, 4, 4>::new();
        evaluation.evaluate(&problem);
        let posterior = evaluation.posterior().as_flattened()[..evaluation.done()].to_vec();
        Judged { beliefs: [0, 1].map(|robot| beliefs.of(&model, robot).to_vec()), posterior }
    }

    fn beliefs(&self, mode: Mode, model: &Model) -> Beliefs<S, 2> {
        let [first, second] = [0, 1].map(|robot| Evidence::Outcome(self.paths[robot][0].start.index()));
        let seen = [first, second, Evidence::Outcome(0)];
        let mut beliefs = Beliefs::prior(model);
        if mode == Mode::AsPublished {
            beliefs.update_in_parallel(model, &seen, Sweeps::PAPER);
        } else {
            beliefs.update(model, &seen).expect("every cell can be read, and nobody is on a goal");
        }
        beliefs
    }

    fn preference(&self) -> [f32; S] {
        let mut preference = [0.0; S];
        (preference[24], preference[26]) = (1.0, 1.0);
        if let Some(obstacle) = self.obstacle {
            preference[obstacle.index()] = -1.0;
        }
        preference
    }
}

/// Every outcome is certain given the labels.
const CERTAIN: [f32; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// What the product takes a collision to be worth.
struct Collision;

impl Encounter for Collision {
    fn factors(&self) -> [usize; 2] {
        [0, 1]
    }

    fn departing(&self, [first, second]: [&[f32]; 2], [action, reply]: [Option<Action>; 2]) -> f32 {
        let (Some(action), Some(reply)) = (action, reply) else { return 0.0 };
        let to = |action, cell: usize| usize::from(next()[usize::from(action) * S + cell]);
        let swaps = |cell: &usize| to(action, *cell) != *cell && to(reply, to(action, *cell)) == *cell;
        -4.0 * (0..S).filter(swaps).map(|cell| first[cell] * second[to(action, cell)]).sum::<f32>()
    }

    fn arrived(&self, [first, second]: [&[f32]; 2]) -> f32 {
        -4.0 * math::expectation(first, second)
    }
}

/// The paper's grid.
#[must_use]
pub fn map() -> Map<2> {
    Map::new(7, 7).expect("49 cells fit 64 bits")
}

/// The next cell per move and cell.
fn next() -> Vec<u16> {
    let cells = || (0..S as u16).map(Cell);
    Move::ALL.iter().flat_map(|&step| cells().map(move |cell| map().neighbour(cell, step).0)).collect()
}
