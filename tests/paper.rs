//! The paper's sections 5.1 and 5.2: its numbers in its own arithmetic, and the choices of ours.

use firmware::missions::SECTION_5_1;
use host_sim::{Conditions, Outcome, fly, library};
use iibt_core::grid::{Path, first_conflict};
use tests::paper::{Decision, Judged, Mode, section_5_1, section_5_2};

fn total(judged: &Judged, pairs: &[usize]) -> f32 {
    pairs.iter().map(|&pair| judged.posterior[pair]).sum()
}

/// The joint policies, row by row, in which both robots arrive in the same step at different goals.
fn simultaneous(decision: &Decision) -> Vec<usize> {
    let [first, second] = &decision.paths;
    let map = tests::paper::map();
    let together = |a: &Path, b: &Path| a.len() == b.len() && a.end(&map) != b.end(&map);
    let avoids = |path: &Path| path.cells(&map).all(|cell| Some(cell) != decision.obstacle);
    let pairs = first.iter().flat_map(|a| second.iter().map(move |b| (a, b)));
    pairs
        .enumerate()
        .filter(|(_, (a, b))| together(a, b) && avoids(a) && avoids(b))
        .map(|(pair, _)| pair)
        .collect()
}

#[test]
fn section_5_1_as_published_gives_the_sixteen_probabilities() {
    assert_published(&section_5_1());
}

#[test]
fn section_5_2_as_published_gives_the_nine_probabilities() {
    assert_published(&section_5_2());
}

fn assert_published(decision: &Decision) {
    let judged = decision.judge(Mode::AsPublished);
    assert_eq!(judged.posterior.len(), decision.published.len());
    for (pair, (ours, published)) in judged.posterior.iter().zip(&decision.published).enumerate() {
        assert!((ours / published - 1.0).abs() < 0.005, "pair {pair}: {ours} against {published}");
    }
}

#[test]
fn section_5_1_as_published_gives_the_initial_beliefs() {
    let [first, second] = section_5_1().judge(Mode::AsPublished).beliefs;
    let close = |ours: f32, published: f32| (ours / published - 1.0).abs() < 1e-4;
    assert!(close(first[28], 0.993_314_8) && close(first[0], 1.453_304e-4));
    assert!(close(second[2], 0.884_474_5) && close(second[0], 2.511_423e-3));
    assert!(first[24] < 1e-11 && second[26] < 1e-11);
}

#[test]
fn section_5_1_by_default_arrives_together_at_different_goals() {
    let decision = section_5_1();
    let judged = decision.judge(Mode::Default);
    // B with c, B with d, C with a.
    assert_eq!(simultaneous(&decision), [6, 7, 9]);
    assert!(total(&judged, &[6, 7, 9]) > 0.999, "{:?}", judged.posterior);
    assert_eq!(iibt_core::math::argmax(&judged.posterior), 9);
}

#[test]
fn section_5_2_by_default_takes_the_detour_together() {
    let decision = section_5_2();
    let judged = decision.judge(Mode::Default);
    assert_eq!(simultaneous(&decision), [3]);
    assert!(judged.posterior[3] > 0.999, "{:?}", judged.posterior);
}

/// Flies a built-in scenario with two robots; returns the paths they settled on.
fn settle(name: &str) -> [Path; 2] {
    let scenario = library::find(name).expect("it is built in").expect("it is sound");
    let record = fly(&scenario, Conditions::default(), &mut ()).expect("it can be flown");
    assert_eq!(record.outcome, Outcome::Together);
    [0, 1].map(|robot| Path::through(&tests::paper::map(), &record.robots[robot].path).expect("a legal path"))
}

#[test]
fn section_5_1_both_robots_settle_on_the_same_pair_each_from_its_own_senses() {
    let decision = section_5_1();
    assert_eq!(settle("two-goals"), [decision.paths[0][2], decision.paths[1][1]], "C with a");
}

#[test]
fn section_5_2_both_robots_settle_on_a_pair_that_arrives_together_without_a_conflict() {
    let decision = section_5_2();
    let [first, second] = settle("detour");
    assert_eq!([first, second], [decision.paths[0][1], decision.paths[1][0]], "X2 with Y1");
    assert_eq!(first_conflict(&tests::paper::map(), &first, &second), None);
}

#[test]
fn the_image_carries_the_paths_of_section_5_1() {
    let lists = SECTION_5_1.candidates.expect("they are listed");
    assert_eq!(lists.iter().map(|list| list.to_vec()).collect::<Vec<_>>(), section_5_1().paths);
}
