//! The paper's results, each section as the report has it, and the claims behind its verdicts.

use firmware::missions::SECTION_5_1;
use host_sim::reproduce::{
    self, CHAPTERS, DecisionMode, Effort, Item, Judged, Reproduction, Section, Verdict, choice, detour,
};
use host_sim::{Conditions, FlightEvent, Outcome, fly, library};
use iibt_core::grid::{Path, first_conflict};

/// A chapter as the report has it.
fn section(id: &str) -> Section {
    reproduce::chapter(id)
        .expect("there is such a section")
        .run(&Reproduction::new(Effort::Quick, &|_, _| {}))
}

/// The items whose description begins so.
fn items<'s>(section: &'s Section, what: &str) -> Vec<&'s Item> {
    section.items.iter().filter(|item| item.what.starts_with(what)).collect()
}

fn assert_all(items: &[&Item], count: usize, verdict: Verdict) {
    assert_eq!(items.len(), count);
    items.iter().for_each(|item| assert_eq!(item.verdict, verdict, "{item:?}"));
}

fn total(judged: &Judged, pairs: &[usize]) -> f32 {
    pairs.iter().map(|&pair| judged.posterior[pair]).sum()
}

#[test]
fn section_5_1_as_published_gives_the_sixteen_probabilities_and_the_initial_beliefs() {
    let section = section("5.1");
    let published =
        |what| items(&section, what).into_iter().filter(|item| item.what.ends_with("as published"));
    assert_all(&published("P(").collect::<Vec<_>>(), 16, Verdict::Agrees);
    assert_all(&published("q").collect::<Vec<_>>(), 4, Verdict::Agrees);
}

#[test]
fn section_5_2_as_published_gives_the_nine_probabilities() {
    assert_all(&items(&section("5.2"), "P(X"), 9, Verdict::Agrees);
}

#[test]
fn section_5_1_as_published_gives_the_initial_beliefs() {
    let [first, second] = choice().judge(DecisionMode::AsPublished).beliefs;
    let close = |ours: f32, published: f32| (ours / published - 1.0).abs() < 1e-4;
    assert!(close(first[28], 0.993_314_8) && close(first[0], 1.453_304e-4));
    assert!(close(second[2], 0.884_474_5) && close(second[0], 2.511_423e-3));
    assert!(first[24] < 1e-11 && second[26] < 1e-11);
}

#[test]
fn section_5_1_by_default_arrives_together_at_different_goals() {
    let decision = choice();
    let judged = decision.judge(DecisionMode::Default);
    // B with c, B with d, C with a.
    assert_eq!(decision.simultaneous(), [6, 7, 9]);
    assert_eq!(decision.soonest(), 6, "the first of them in the order of the lists");
    assert!(total(&judged, &[6, 7, 9]) > 0.999, "{:?}", judged.posterior);
    assert_eq!(iibt_core::math::argmax(&judged.posterior), 9);
}

#[test]
fn section_5_2_by_default_takes_the_detour_together() {
    let decision = detour();
    let judged = decision.judge(DecisionMode::Default);
    assert_eq!(decision.simultaneous(), [3]);
    assert!(judged.posterior[3] > 0.999, "{:?}", judged.posterior);
}

/// Flies a built-in scenario with two robots; returns the paths they settled on.
fn settle(name: &str) -> [Path; 2] {
    let scenario = library::find(name).expect("it is built in").expect("it is sound");
    let record = fly(&scenario, Conditions::default(), &mut ()).expect("it can be flown");
    assert_eq!(record.outcome, Outcome::Together);
    [0, 1].map(|robot| Path::through(&reproduce::map(), &record.robots[robot].path).expect("a legal path"))
}

#[test]
fn section_5_1_both_robots_follow_the_first_of_the_pairs_that_arrive_together() {
    let decision = choice();
    assert_eq!(settle("two-goals"), [decision.candidates[0][1].1, decision.candidates[1][2].1], "B with c");
}

#[test]
fn section_5_1_the_papers_pair_is_flown_where_it_comes_first() {
    let mut scenario = library::find("two-goals").expect("it is built in").expect("it is sound");
    scenario.robots[0].paths.swap(0, 2);
    let record = fly(&scenario, Conditions::default(), &mut ()).expect("it can be flown");
    let decision = choice();
    let paths = [decision.candidates[0][2].1, decision.candidates[1][1].1];
    for (robot, path) in record.robots.iter().zip(paths) {
        assert!(path.cells(&reproduce::map()).eq(robot.path.iter().copied()), "C with a: {:?}", robot.path);
    }
    assert_eq!((record.outcome, record.spread()), (Outcome::Together, 0));
}

#[test]
fn section_5_2_both_robots_settle_on_a_pair_that_arrives_together_without_a_conflict() {
    let decision = detour();
    let [first, second] = settle("detour");
    assert_eq!([first, second], [decision.candidates[0][1].1, decision.candidates[1][0].1], "X2 with Y1");
    assert_eq!(first_conflict(&reproduce::map(), &first, &second), None);
}

#[test]
fn the_image_carries_the_paths_of_choice() {
    let lists = SECTION_5_1.paths.expect("they are listed");
    let paths = choice().candidates.map(|list| list.into_iter().map(|(_, path)| path).collect::<Vec<_>>());
    assert_eq!(lists.iter().map(|list| list.to_vec()).collect::<Vec<_>>(), paths);
}

#[test]
fn section_5_2_as_a_run_the_obstacle_appears_on_the_way_and_both_choose_again() {
    let record = fly(
        &library::find("obstacle").expect("it is built in").expect("it is sound"),
        Conditions::default(),
        &mut (),
    )
    .expect("it can be flown");
    let appeared = record
        .events
        .iter()
        .find(|timed| matches!(timed.event, FlightEvent::Appeared { .. }))
        .expect("it appears")
        .tick;
    let moved = record.history[appeared as usize] != record.history[0];
    let chosen = |timed: &&host_sim::TimedEvent| matches!(timed.event, FlightEvent::Chose { .. });
    let after = record.events.iter().filter(chosen).filter(|timed| timed.tick > appeared).count();
    assert!(moved && after == 2, "{:?}", record.events);
    assert_eq!((record.outcome, record.collisions.total()), (Outcome::Together, 0));
}

#[test]
fn section_6_1_every_plan_is_chosen_in_common_within_three_ticks() {
    let section = section("6.1");
    assert_all(&items(&section, "every plan: all choose the same joint policy"), 1, Verdict::Holds);
    assert_all(&items(&section, "phase "), 8, Verdict::Holds);
}

#[test]
fn section_6_1_as_published_gives_robot_3s_bars_whose_paths_are_known_and_its_choice() {
    let section = section("6.1");
    assert_all(
        &items(&section, "figure 9, robot 3 with robot 1: P of bar")
            .into_iter()
            .filter(|item| !item.what.contains("bar 10"))
            .collect::<Vec<_>>(),
        5,
        Verdict::Agrees,
    );
    assert_all(&items(&section, "figure 9, robot 3 with robot 2: P of bar"), 5, Verdict::Agrees);
    assert_all(&items(&section, "robot 3's choice"), 1, Verdict::Agrees);
    assert_all(&items(&section, "figure 9: where and when"), 1, Verdict::Holds);
}

#[test]
fn section_6_1_the_papers_own_plans_arrive_together_and_collide_six_times() {
    let section = section("6.1");
    let plans =
        |what: &str| section.items.iter().filter(|item| item.what.ends_with(what)).collect::<Vec<_>>();
    assert_all(&plans("legal, and together"), 4, Verdict::Holds);
    let counts: Vec<_> =
        plans("collisions").iter().map(|item| item.ours.clone().unwrap_or_default()).collect();
    assert_eq!(counts, ["0 collisions", "1 collision", "2 collisions", "3 collisions"]);
}

#[test]
fn the_lists_that_the_paper_does_not_print_are_reported_as_unknown() {
    let section = section("6.1");
    let unknown = section.items.iter().filter(|item| item.verdict == Verdict::Unknown).collect::<Vec<_>>();
    assert_eq!(unknown.len(), 3);
    assert!(unknown.iter().all(|item| item.ours.is_none() && item.note.is_some()));
}

#[test]
fn section_6_2_gives_the_reported_probabilities_with_both_presets() {
    let section = section("6.2");
    for preset in ["default", "calibrated"] {
        let printed =
            section.items.iter().filter(|item| item.what.starts_with("P(π") && item.what.ends_with(preset));
        assert_all(&printed.collect::<Vec<_>>(), 4, Verdict::Agrees);
    }
}

#[test]
fn the_tables_are_counted_from_the_trees_and_what_differs_says_why() {
    let section = section("tables");
    assert_all(&items(&section, "table 3, conventional"), 6, Verdict::Agrees);
    assert_all(&items(&section, "table 7"), 12, Verdict::Agrees);
    assert_all(&items(&section, "table 6, conventional, as drawn"), 6, Verdict::Differs);
    let differing = section.items.iter().filter(|item| item.verdict == Verdict::Differs).collect::<Vec<_>>();
    assert!(differing.len() == 7 && differing.iter().all(|item| item.note.is_some()), "{differing:?}");
}

#[test]
fn every_section_says_something_and_nothing_falls_short() {
    for chapter in CHAPTERS {
        let section = section(chapter.id);
        assert_eq!(section.id, chapter.id);
        assert!(!section.items.is_empty() && !section.figures.is_empty() && !section.text.is_empty());
        let misses = section.items.iter().filter(|item| item.verdict == Verdict::Misses).collect::<Vec<_>>();
        assert_eq!(misses, [] as [&Item; 0], "{}", chapter.id);
    }
}

#[test]
fn the_page_is_complete_in_itself_and_names_every_item() {
    let sections = [section("5.1"), section("5.2")];
    let page = reproduce::page(&sections);
    for forbidden in ["http:", "https:", "<script", "src=", "@import", "url("] {
        assert!(!page.contains(forbidden), "{forbidden}");
    }
    assert_eq!(page.matches("<svg").count(), page.matches("</svg>").count());
    for item in sections.iter().flat_map(|section| &section.items) {
        assert!(page.contains(&item.what), "{}", item.what);
    }
}

#[test]
fn an_item_that_falls_short_fails_the_report() {
    let mut sections = [section("5.2")];
    assert!(reproduce::succeeds(&sections));
    sections[0].items.push(Item::same("a planted fault", 1, 2));
    assert!(!reproduce::succeeds(&sections));
    assert!(reproduce::table(&sections, None).contains("1 MISSES"));
}
