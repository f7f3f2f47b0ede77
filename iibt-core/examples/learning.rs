//! A robot learns how often its moves fail, and takes the other way: a transition B as Dirichlet
//! counts.
//!
//! `cargo run -p iibt-core --example learning`. Two ways lead from the start to the goal: by the
//! passage, where a move is made 19 times in 20, or so it was built, and by the ramp, where it is
//! made 4 times in 5. Then the wheel for the passage wears out.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[macro_use]
mod chip;

use iibt_core::inference::learning::{Rates, TransitionCounts};
use iibt_core::inference::transition::DenseTransition;
use iibt_core::inference::{
    Agent, Candidates, DecisionError, Evidence, Factor, IdentityNoise, Modality, Model, Policy, Scoring,
};

const START: usize = 0;
const PASSAGE: usize = 1;
const PLACES: usize = 4; // start, passage, ramp, goal

/// B as the robot was built: action 0 drives by the passage, action 1 by the ramp.
#[rustfmt::skip]
static BUILT: DenseTransition = DenseTransition::new(&[
    0.05, 0.0,  1.0, 0.0,   0.95, 0.05, 0.0, 0.0,   0.0, 0.0, 0.0, 0.0,   0.0, 0.95, 0.0, 1.0,
    0.2,  1.0,  0.0, 0.0,   0.0,  0.0,  0.0, 0.0,   0.8, 0.0, 0.2, 0.0,   0.0, 0.0,  0.8, 1.0,
], 2, &[PLACES]);
static LOCALISER: IdentityNoise = IdentityNoise::new(0.99, PLACES);
static WAYS: [Policy; 2] = [Policy::of(&[0, 0]), Policy::of(&[1, 1])];

/// The robot's knowledge of its drive.
type Drive = TransitionCounts<'static, PLACES, PLACES, 2>;

/// A model borrows its tables: it is put together for one decision, and the drive learns in
/// between.
fn with_agent<T>(drive: &Drive, work: impl FnOnce(&mut Agent<PLACES, 1, 2, 1>) -> T) -> T {
    let factors = [Factor::new(drive, drive.shape(), &[1.0, 0.0, 0.0, 0.0])];
    let modalities = [Modality::new(&LOCALISER, LOCALISER.shape(), &[0], &[0.0, 0.0, 0.0, 3.0])];
    let model = Model::new(&factors, &modalities);
    work(&mut Agent::new(&model).with_scoring(Scoring::JAX_PYMDP))
}

/// The path that the robot chooses, and its probability.
fn choose(drive: &Drive) -> Result<(usize, f32), DecisionError> {
    with_agent(drive, |agent| {
        let decision = agent.decide(Candidates::all(&[&WAYS]))?;
        Ok((decision.policy(), decision.probability()))
    })
}

/// One attempt to drive into the passage, and the robot's update: B learns from the beliefs before
/// and after.
fn drive_once(drive: &mut Drive, arrives: bool) -> bool {
    let seen = if arrives { PASSAGE } else { START };
    let beliefs = with_agent(drive, |agent| {
        let before = *agent.beliefs();
        let known = agent.act(&[Some(0)]).is_ok() && agent.observe(&[Evidence::Outcome(seen)]).is_ok();
        known.then_some((before, *agent.beliefs()))
    });
    beliefs.is_some_and(|(before, after)| drive.learn(0, &[before.as_flat()], after.as_flat()))
}

fn play() {
    // What it was built for counts as ten moves.
    let mut drive = Drive::new(&BUILT, 10.0, BUILT.shape(), Rates::DEFAULT).unwrap();
    let (way, probability) = choose(&drive).unwrap();
    show!("as built:  by way {way}, with probability {probability:.2}");
    assert_eq!(way, 0);

    // The worn wheel makes three moves in ten.
    let mut changed = None;
    let wear = [false, true, false, false, true, false, false, false, true, false];
    for (number, arrives) in wear.iter().cycle().take(100).enumerate() {
        assert!(drive_once(&mut drive, *arrives), "every try is learned from");
        if changed.is_none() && choose(&drive).unwrap().0 == 1 {
            changed = Some(number + 1);
        }
    }
    let (way, probability) = choose(&drive).unwrap();
    let learned = drive.counts(0, &[START]).expect("there is such a column").probability(PASSAGE);
    show!("after wear: by way {way}, with probability {probability:.2}; it makes {learned:.2} of its moves");
    show!("it changed its way after {} tries", changed.expect("it never changed its way"));
    assert_eq!(way, 1);
    assert!((learned - 0.3).abs() < 0.1, "{learned} is not about three moves in ten");
}

play!(play);
