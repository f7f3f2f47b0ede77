//! The paper's sections 5.1 and 5.2: its numbers in its own arithmetic, and the choices of ours.

use tests::paper::{Decision, Judged, Mode, section_5_1, section_5_2};

fn total(judged: &Judged, pairs: &[usize]) -> f32 {
    pairs.iter().map(|&pair| judged.posterior[pair]).sum()
}

/// The joint policies, row by row, in which both robots arrive in the same step at different goals.
fn simultaneous(decision: &Decision) -> Vec<usize> {
    let [first, second] = &decision.paths;
    let together = |a: &Vec<u16>, b: &Vec<u16>| a.len() == b.len() && a.last() != b.last();
    let avoids = |path: &Vec<u16>| decision.obstacle.is_none_or(|cell| !path.contains(&(cell as u16)));
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
    assert!(close(first.probabilities()[28], 0.993_314_8) && close(first.probabilities()[0], 1.453_304e-4));
    assert!(close(second.probabilities()[2], 0.884_474_5) && close(second.probabilities()[0], 2.511_423e-3));
    assert!(first.probabilities()[24] < 1e-11 && second.probabilities()[26] < 1e-11);
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
