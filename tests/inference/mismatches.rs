//! Arguments that do not fit are refused with a message that names the table, its index and the
//! limit, and never as an event of the world.

use iibt_core::inference::{
    Agent, Argument, Beliefs, Candidates, DecisionError, Evaluation, Evidence, Factor, Habits, IdentityNoise,
    Impossible, Modality, Model, NextState, ObservationError, OutOfRange, Policy, Problem, Scoring, Terms,
    explanation,
};

// A ring of five cells, a sensor that never errs, and two moves.
static SENSOR: IdentityNoise = IdentityNoise::new(1.0, 5);
static RING: NextState = NextState::new(&[4, 0, 1, 2, 3, 1, 2, 3, 4, 0], 5);
static FACTORS: [Factor; 1] = [Factor::new(&RING, RING.shape(), &[1.0, 0.0, 0.0, 0.0, 0.0])];
static MODALITIES: [Modality; 1] = [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0, 0.0, 1.0, 0.0, 0.0])];
static MODEL: Model = Model::new(&FACTORS, &MODALITIES);

// Two robots on it.
static PAIR: [Factor; 2] = [FACTORS[0], FACTORS[0]];
static BOTH: [Modality; 2] = [MODALITIES[0], Modality::new(&SENSOR, SENSOR.shape(), &[1], &[0.0; 5])];
static TEAM: Model = Model::new(&PAIR, &BOTH);

static MOVES: [Policy; 3] = [Policy::of(&[0]), Policy::of(&[1]), Policy::of(&[1, 1])];

fn agent() -> iibt_core::Agent![MODEL, 3] {
    iibt_core::agent!(MODEL, 3)
}

fn message<T: std::fmt::Debug, E: std::error::Error>(result: Result<T, E>) -> String {
    result.expect_err("it does not fit").to_string()
}

#[test]
fn beliefs_too_small_for_the_model() {
    let error = "the model has 5 states, but the beliefs have room for 4";
    assert_eq!(message(Beliefs::<4, 1>::try_prior(&MODEL)), error);
    assert_eq!(message(Agent::<4, 1, 3, 1>::try_new(&MODEL)), error);
    // Beliefs that were made for a smaller model.
    static SMALL: IdentityNoise = IdentityNoise::new(1.0, 4);
    static STAY: NextState = NextState::new(&[0, 1, 2, 3], 4);
    let factors = [Factor::new(&STAY, STAY.shape(), &[0.25; 4])];
    let modalities = [Modality::new(&SMALL, SMALL.shape(), &[0], &[0.0; 4])];
    let mut beliefs = Beliefs::<4, 1>::prior(&Model::new(&factors, &modalities));
    let before = beliefs;
    assert_eq!(message(beliefs.update(&MODEL, &[Evidence::Outcome(1)])), error);
    assert_eq!(message(beliefs.observe(&MODEL, 0, Evidence::Outcome(1))), error);
    assert_eq!(message(beliefs.predict(&MODEL, &[Some(1)])), error);
    let policies = [&MOVES[..]];
    let problem = Problem::new(&MODEL, &beliefs, Candidates::all(&policies), Scoring::DEFAULT);
    assert_eq!(message(Evaluation::<4, 1, 3, 1>::new().evaluate(&problem)), error);
    assert_eq!(beliefs, before);
}

#[test]
#[should_panic(expected = "the model has more states than these beliefs have room for")]
fn beliefs_too_small_for_the_model_where_it_cannot_be_an_error() {
    let _ = Beliefs::<4, 1>::prior(&MODEL);
}

#[test]
fn an_agent_with_room_for_fewer_groups_than_the_model_has() {
    let error = "the model has 2 groups of factors, but the evaluation has room for 1";
    assert_eq!(message(Agent::<10, 1, 3, 3>::try_new(&TEAM)), error);
}

#[test]
fn an_evaluation_with_room_for_fewer_policies_than_given() {
    let mut agent: iibt_core::Agent![MODEL, 2] = iibt_core::agent!(MODEL, 2);
    let error = agent.decide(Candidates::all(&[&MOVES]));
    assert_eq!(message(error), "there are 3 joint policies, but the evaluation has room for 2");
    assert!(agent.posterior().is_empty() && agent.terms().is_empty(), "nothing of a shorter list");
}

#[test]
fn more_than_256_sequences_of_one_control_are_told_apart() {
    // 512 policies, all of which stay but for number 511: it alone reaches the goal.
    let mut policies = vec![Policy::EMPTY; 512];
    policies[511] = Policy::of(&[1, 1]);
    let mut agent = Agent::<5, 1, 64, 8>::new(&MODEL);
    let decision = agent.decide(Candidates::all(&[&policies])).expect("there is room");
    assert_eq!((decision.policy(), decision.sequence(0)), (511, 511));
    assert_eq!(decision.first_actions(), [Some(1)]);
    assert!(agent.terms()[511].utility > agent.terms()[255].utility + 0.5);
    // The same listed, the other way round.
    let rows: Vec<u16> = (0..512).rev().collect();
    let decision = agent.decide(Candidates::listed(&[&policies], &rows)).expect("there is room");
    assert_eq!((decision.policy(), decision.sequence(0)), (0, 511));
}

#[test]
fn an_outcome_out_of_range_is_no_event_of_the_world() {
    let mut agent = agent();
    let error = OutOfRange { what: Argument::Outcome, index: 0, value: 5, limit: 5 };
    assert_eq!(agent.observe(&[Evidence::Outcome(5)]), Err(ObservationError::OutOfRange(error)));
    assert_eq!(error.to_string(), "modality 0 has no outcome 5: there are 5, from 0");
    // What cannot happen, with an outcome that there is, is one.
    let event = Impossible { modality: 0 };
    assert_eq!(agent.observe(&[Evidence::Outcome(4)]), Err(ObservationError::Impossible(event)));
    assert_eq!(agent.belief(0), Ok(&[1.0, 0.0, 0.0, 0.0, 0.0][..]));
}

#[test]
fn evidence_that_does_not_fit() {
    let mut agent = agent();
    let twice = [Evidence::Outcome(0); 2];
    assert_eq!(message(agent.observe(&twice)), "evidence for 2 modalities, but the model has 1");
    let few = [Evidence::Soft(&[1.0, 1.0])];
    assert_eq!(message(agent.observe(&few)), "modality 0 has 5 outcomes, but 2 weights are given");
    for odd in [f32::NAN, -1.0, f32::INFINITY] {
        let weights = [1.0, 1.0, odd, 1.0, 1.0];
        let error = message(agent.observe(&[Evidence::Soft(&weights)]));
        assert_eq!(error, "modality 0: weight 2 is negative or not finite");
    }
    let mut beliefs = Beliefs::<5, 1>::prior(&MODEL);
    let error = beliefs.observe(&MODEL, 1, Evidence::Missing);
    assert_eq!(message(error), "there is no modality 1: there are 1, from 0");
    let error = beliefs.update_by_ascent(&MODEL, &twice, 4);
    assert_eq!(message(error), "evidence for 2 modalities, but the model has 1");
}

#[test]
fn actions_that_do_not_fit() {
    let mut agent = agent();
    assert_eq!(message(agent.act(&[Some(2)])), "control 0 has no action 2: there are 2, from 0");
    assert_eq!(message(agent.act(&[Some(16)])), "control 0 has no action 16: there are 2, from 0");
    let error = "something is given for 2 controls, but the model has 1";
    assert_eq!(message(agent.act(&[None, Some(0)])), error);
    assert_eq!(agent.belief(0), Ok(&[1.0, 0.0, 0.0, 0.0, 0.0][..]));
}

#[test]
fn factors_and_beliefs_that_do_not_fit() {
    let mut agent = agent();
    assert_eq!(message(agent.belief(1)), "there is no factor 1: there are 1, from 0");
    assert_eq!(message(agent.most_likely(7)), "there is no factor 7: there are 1, from 0");
    let beliefs = agent.beliefs_mut();
    assert_eq!(message(beliefs.set(&MODEL, 2, &[])), "there is no factor 2: there are 1, from 0");
    let error = "the belief about factor 0 has 5 entries, but 4 weights are given";
    assert_eq!(message(beliefs.set(&MODEL, 0, &[1.0; 4])), error);
    let error = "the belief about factor 0: weight 1 is negative or not finite";
    assert_eq!(message(beliefs.set(&MODEL, 0, &[1.0, -1.0, 1.0, 1.0, 1.0])), error);
    let error = "the weights of the belief about factor 0 sum to no number above zero";
    assert_eq!(message(beliefs.set(&MODEL, 0, &[0.0; 5])), error);
}

/// What a decision among candidates for the two robots is refused with.
fn refused(candidates: Candidates) -> String {
    let mut team = Agent::<5, 2, 4, 4>::new(&TEAM);
    let error = team.decide(candidates);
    assert!(matches!(error, Err(DecisionError::OutOfRange(_))));
    message(error)
}

#[test]
fn candidates_that_do_not_fit() {
    let unknown = [Policy::of(&[0]), Policy::of(&[0, 1, 2])];
    let error = refused(Candidates::all(&[&MOVES, &unknown]));
    assert_eq!(error, "control 1 has no action 2: there are 2, from 0");
    let error = refused(Candidates::all(&[&MOVES, &[], &MOVES]));
    assert_eq!(error, "there is no control 2: there are 2, from 0");
    let lists: [&[Policy]; 2] = [&MOVES, &MOVES];
    let error = refused(Candidates::listed(&lists, &[0, 1, 2]));
    assert_eq!(error, "3 numbers of action sequences are no list of policies of 2 controls");
    let error = refused(Candidates::listed(&lists, &[0, 1, 2, 3]));
    assert_eq!(error, "control 1 has no action sequence 3: there are 3, from 0");
    let error = refused(Candidates::all(&lists).with_announced(&[None, Some(3)]));
    assert_eq!(error, "control 1 has no action sequence 3: there are 3, from 0");
    let error = refused(Candidates::all(&lists).with_announced(&[None; 3]));
    assert_eq!(error, "something is given for 3 controls, but the model has 2");
    let many = vec![Policy::EMPTY; 65_536];
    let error = refused(Candidates::listed(&[&MOVES, &many], &[0, 0]));
    assert_eq!(error, "control 1 has 65536 action sequences, but there can be 65535");
}

#[test]
fn habits_that_do_not_fit() {
    let lists: [&[Policy]; 2] = [&MOVES, &MOVES];
    let error = refused(Candidates::all(&lists).with_habits(Habits::Joint(&[0.0; 8])));
    assert_eq!(error, "8 habits, but there are 9 joint policies");
    let error = refused(Candidates::all(&lists).with_habits(Habits::PerSequence(&[&[0.0; 3], &[0.0; 2]])));
    assert_eq!(error, "control 1 has 3 action sequences, but 2 habits are given");
    let none: [&[f32]; 3] = [&[]; 3];
    let error = refused(Candidates::all(&lists).with_habits(Habits::PerSequence(&none)));
    assert_eq!(error, "something is given for 3 controls, but the model has 2");
}

/// What evaluating a problem of one robot is refused with, and tracing it too.
fn misposed(change: impl Fn(&mut Problem<5, 1>)) -> String {
    let (beliefs, lists) = (Beliefs::<5, 1>::prior(&MODEL), [&MOVES[..]]);
    let mut problem = Problem::new(&MODEL, &beliefs, Candidates::all(&lists), Scoring::DEFAULT);
    change(&mut problem);
    let mut evaluation = Evaluation::<5, 1, 3, 1>::new();
    let error = message(evaluation.evaluate(&problem));
    assert_eq!((evaluation.best(), evaluation.done()), (None, 0));
    assert!(!evaluation.advance(&problem, 1));
    assert_eq!(message(explanation::trace(&problem, 0, |_| {})), error);
    error
}

#[test]
fn problems_that_do_not_fit() {
    let error = misposed(|problem| problem.preferences = &[&[0.0; 4]]);
    assert_eq!(error, "modality 0 has 5 outcomes, but 4 preferences are given");
    let error = misposed(|problem| problem.preferences = &[&[0.0; 5], &[]]);
    assert_eq!(error, "preferences for 2 modalities, but the model has 1");
    let error = misposed(|problem| problem.preferences = &[&[0.0, f32::NAN, 0.0, 0.0, 0.0]]);
    assert_eq!(error, "modality 0: the preference for outcome 1 is not finite");
    let error = misposed(|problem| problem.negative_preferences = &[&[0.0; 6]]);
    assert_eq!(error, "modality 0 has 5 outcomes, but 6 preferences are given");
    let error = misposed(|problem| problem.scope = 0b110);
    assert_eq!(error, "the scope names group 2: there are 1, from 0");
    let error = misposed(|problem| problem.horizon = 65);
    assert_eq!(error, "a horizon of 65 steps, but there can be 64");
}

#[test]
fn a_policy_that_does_not_exist_is_not_explained() {
    let (beliefs, lists) = (Beliefs::<5, 1>::prior(&MODEL), [&MOVES[..]]);
    let problem = Problem::new(&MODEL, &beliefs, Candidates::all(&lists), Scoring::DEFAULT);
    let error = "there is no joint policy 3: there are 3, from 0";
    assert_eq!(message(explanation::trace(&problem, 3, |_| {})), error);
    assert_eq!(message(explanation::Explanation::of(&problem, 0, 3)), error);
}

#[test]
fn nothing_is_chosen_where_nothing_could_be_scored() {
    let mut agent = agent();
    assert_eq!(agent.decide(Candidates::listed(&[&MOVES], &[])).err(), Some(DecisionError::NoPolicy));
    let ruled_out = [f32::NEG_INFINITY, f32::NAN, f32::NEG_INFINITY];
    let lists: [&[Policy]; 1] = [&MOVES];
    let candidates = Candidates::all(&lists).with_habits(Habits::Joint(&ruled_out));
    let mut agent = agent.with_scoring(Scoring { precision: 1.0, ..Scoring::DEFAULT });
    assert_eq!(
        message(agent.decide(candidates)),
        "no joint policy can be chosen: none is given, or all are ruled out"
    );
    assert_eq!(agent.posterior(), [0.0; 3]);
    let mut lost = agent.with_scoring(Scoring { precision: f32::NAN, ..Scoring::DEFAULT });
    assert_eq!(lost.decide(Candidates::all(&[&MOVES])).err(), Some(DecisionError::NoPolicy));
}

#[test]
fn a_longer_policy_is_judged_whole_unless_the_horizon_is_set() {
    let lists: [&[Policy]; 1] = [&MOVES];
    let mut whole = agent();
    assert_eq!(whole.decide(Candidates::all(&lists)).expect("it fits").policy(), 2);
    assert_eq!(whole.problem(Candidates::all(&lists)).horizon, 2);
    // In one step the goal cannot be reached, and the last two policies begin alike.
    let mut short = agent().with_horizon(1);
    let decision = short.decide(Candidates::all(&lists)).expect("it fits");
    assert_eq!(short.terms()[1], Terms { ..short.terms()[2] });
    assert!(decision.probability() < 0.34);
    let error = agent().with_horizon(65).decide(Candidates::all(&lists)).map(|decision| decision.policy());
    assert_eq!(message(error), "a horizon of 65 steps, but there can be 64");
}
