//! The paper's section 6.2: one robot's decisions on the bench, then two robots with a bottle and a
//! plate.

mod decisions {
    use host_sim::manipulation::tables::{
        ELSEWHERE, EMPTY, FREE, GOAL_A, GOAL_B, GOAL_C, GRIP, HOLD, HOLDS, IDLE, IN_TURN, LOC, MOVE_TO, PICK,
        PLACE, PLACED, PUT, PUT_DOWN, TO_PLACE, TOGETHER,
    };
    use iibt_core::iibt::table::{Announcement, Operator, Role, TableMessage, Tables};
    use iibt_core::iibt::{Condition, Logic};
    use iibt_core::team::Message;
    use iibt_core::team::rounds::{Answer, Proposal, RoundMessage};
    use iibt_core::tree::Status;
    use proptest::prelude::*;
    use tests::handling::{Bench, Said, idle, ready, said};

    static TURNS: Tables = Tables::new(&IN_TURN);
    static AT_ONCE: Tables = Tables::new(&TOGETHER);

    const FREED: [f32; 4] = [0.0, 0.0, 0.0, 1.0];
    const HELD: [f32; 4] = [0.0, 1.0, 0.0, 0.0];

    #[test]
    fn robot_1_goes_to_the_bottle_first_because_its_place_is_raised_and_the_raise_leaves_no_trace() {
        let mut robot = Bench::new(&TURNS, 0);
        assert_eq!(robot.tick(Some(idle())), Status::Running);
        assert_eq!(robot.begun(), Some((MOVE_TO, Some(GOAL_A))));
        assert_eq!(robot.preferences(), [[2.0, 1.0, 0.0, 0.0], FREED], "equations 10 and 11");
        let (policy, probability) = robot.decided();
        assert_eq!(policy, 3);
        assert!((probability - 0.255).abs() < 0.005, "{probability}");
        assert!(robot.node.raised().is_none());
    }

    #[test]
    fn robot_1_picks_where_the_bottle_is_without_a_raise() {
        let mut robot = Bench::new(&TURNS, 0);
        robot.put(GOAL_A, LOC);
        robot.tick(Some(idle()));
        assert_eq!(robot.begun(), Some((PICK, None)));
        assert_eq!(robot.preferences(), [HELD, FREED]);
        let (policy, probability) = robot.decided();
        assert_eq!(policy, 7);
        assert!((probability - 0.205).abs() < 0.005, "{probability}");
    }

    #[test]
    fn robot_2_begins_when_robot_1_is_free_and_has_its_bottle() {
        for (message, policy) in
            [(idle(), 15), (said(ELSEWHERE, EMPTY, MOVE_TO), 3), (said(GOAL_A, EMPTY, PICK), 7)]
        {
            let mut robot = Bench::new(&TURNS, 1);
            assert_eq!(robot.tick(Some(message)), Status::Running);
            assert_eq!(robot.begun(), None, "{message:?}");
            assert_eq!(robot.decided().0, policy, "it knows what robot 1 does");
        }
        let mut robot = Bench::new(&TURNS, 1);
        robot.tick(Some(said(GOAL_A, HOLDS, IDLE)));
        assert_eq!(robot.begun(), Some((MOVE_TO, Some(GOAL_B))));
        assert_eq!(robot.preferences(), [FREED, [2.0, 1.0, 0.0, 0.0]]);
        assert_eq!(robot.decided().0, 12);
    }

    #[test]
    fn robot_1_waits_at_goal_c_until_robot_2_stands_there_with_the_plate() {
        let mut robot = Bench::new(&TURNS, 0);
        robot.put(GOAL_C, HOLD);
        robot.task.pursue(TO_PLACE);
        for message in [idle(), said(ELSEWHERE, HOLDS, IDLE), said(GOAL_C, HOLDS, PICK)] {
            assert_eq!(robot.tick(Some(message)), Status::Running);
            assert_eq!(robot.begun(), None, "{message:?}");
            assert_eq!(robot.preferences()[0], [0.0, 0.0, 1.0, 2.0], "it wants to be free");
        }
        robot.tick(Some(ready()));
        assert_eq!(robot.begun(), Some((PUT_DOWN, None)));
        let (policy, probability) = robot.decided();
        assert_eq!(policy, 11);
        assert!(probability > 0.3, "success of the team is within reach: {probability}");
        assert_eq!(robot.preferences(), [[0.0, 0.0, 1.0, 0.0], FREED]);
    }

    #[test]
    fn a_bottle_that_is_missing_at_goal_c_is_fetched_again() {
        let mut robot = Bench::new(&TURNS, 0);
        robot.put(GOAL_C, FREE);
        robot.task.pursue(TO_PLACE);
        let steps = [
            ((GOAL_C, FREE), (MOVE_TO, Some(GOAL_A))),
            ((GOAL_A, LOC), (PICK, None)),
            ((GOAL_A, HOLD), (MOVE_TO, Some(GOAL_C))),
        ];
        for ((place, state), begun) in steps {
            robot.put(place, state);
            robot.tick(Some(ready()));
            assert_eq!(robot.begun(), Some(begun));
        }
    }

    #[test]
    fn a_robot_that_is_not_sure_looks_again_before_it_acts() {
        let mut robot = Bench::new(&TURNS, 0);
        robot.tick(Some(idle()));
        robot.readings = [GOAL_A, LOC];
        robot.tick(Some(idle()));
        assert_eq!(robot.begun(), Some((PICK, None)));
        // It reads that it holds nothing, then that it does: neither is enough against the other.
        let mut looks = 0;
        for state in [LOC, HOLD, HOLD, HOLD] {
            robot.readings[1] = state;
            let status = robot.step(Some(idle()));
            looks += u32::from(status == Status::Running && robot.begun().is_none());
        }
        assert_eq!((looks, robot.task.announcement().state(GRIP.into())), (3, Some(HOLDS)));
    }

    #[test]
    fn a_percept_counts_once_however_many_nodes_see_it() {
        let [mut once, mut twice] = [0, 0].map(|robot| Bench::new(&TURNS, robot));
        for robot in [&mut once, &mut twice] {
            robot.readings = [GOAL_A, LOC];
        }
        once.tick_node();
        twice.tick_node();
        twice.tick_node();
        assert_eq!(once.task.belief(PLACE.into()), twice.task.belief(PLACE.into()));
    }

    #[test]
    fn both_fetch_at_once_when_the_mission_says_so() {
        let mut robot = Bench::new(&AT_ONCE, 1);
        robot.tick(Some(said(ELSEWHERE, EMPTY, MOVE_TO)));
        assert_eq!(robot.begun(), Some((MOVE_TO, Some(GOAL_B))));
        assert_eq!(robot.decided().0, 0, "(moveTo, moveTo)");
    }

    #[test]
    fn table_5_as_the_node_asks_it() {
        // What is missing first, for each operator, in a few situations of robot 1.
        let unmet = |operator: u8, on: &[u8]| {
            let Operator { requires, forbids, .. } = IN_TURN[0].operators[usize::from(operator)];
            let condition = Condition { all: Logic::of(requires), none: Logic::of(forbids) };
            let literal = condition.unmet(Logic::of(on))?;
            Some((IN_TURN[0].facts[usize::from(literal.variable)].name, literal.value))
        };
        let [holding, source, meeting, target, placed, idle, there, holds] = [0, 1, 2, 3, 4, 6, 8, 9];
        assert_eq!(unmet(MOVE_TO, &[idle]), None);
        assert_eq!(unmet(MOVE_TO, &[idle, target]), Some(("IsReached(target)", false)));
        assert_eq!(unmet(PICK, &[idle]), Some(("IsReached(source)", true)));
        assert_eq!(unmet(PICK, &[idle, source]), None);
        assert_eq!(unmet(PICK, &[idle, source, holding]), Some(("IsHolding", false)));
        let ready = [idle, there, holds];
        let may_place = |more: &[u8]| unmet(PUT_DOWN, &[&ready, more].concat());
        assert_eq!(may_place(&[meeting]), Some(("IsHolding", true)), "first what is to be placed");
        assert_eq!(may_place(&[holding]), Some(("IsReached(goal C)", true)));
        assert_eq!(may_place(&[holding, meeting]), None);
        assert_eq!(may_place(&[holding, meeting, placed]), Some(("IsPlaced", false)));
        for missing in [there, holds, idle] {
            let rest: Vec<u8> = ready.into_iter().filter(|fact| *fact != missing).collect();
            let name = IN_TURN[0].facts[usize::from(missing)].name;
            assert_eq!(unmet(PUT_DOWN, &[&rest[..], &[holding, meeting]].concat()), Some((name, true)));
        }
        assert_eq!(unmet(IDLE, &[]), None);
    }

    #[test]
    fn messages_of_other_tables_are_not_accepted() {
        let robot = Bench::new(&TURNS, 0);
        let message = |team, place, grip, operator, intends| {
            let fact = Announcement::new([Some(place), Some(grip)], operator, intends);
            let round = RoundMessage { proposal: Proposal::first(team), fact, answer: Answer::Listing(0) };
            TableMessage { round, own: () }
        };
        assert!(robot.task.accepts(&message(2, GOAL_C, HOLDS, IDLE, PICK)).is_ok());
        assert!(robot.task.accepts(&message(3, GOAL_C, HOLDS, IDLE, PICK)).is_err(), "a team of three");
        assert!(robot.task.accepts(&message(2, 4, EMPTY, IDLE, IDLE)).is_err(), "there is no fifth place");
        assert!(robot.task.accepts(&message(2, GOAL_A, PLACED + 1, IDLE, IDLE)).is_err());
        assert!(robot.task.accepts(&message(2, GOAL_A, EMPTY, IDLE + 1, IDLE)).is_err());
        assert!(robot.task.accepts(&message(2, GOAL_A, EMPTY, IDLE, IDLE + 1)).is_err());
        assert!(message(2, GOAL_A, EMPTY, 16, IDLE).validate().is_err());
        let renamed = [Role { name: "R3", ..IN_TURN[0] }, IN_TURN[1]];
        assert_ne!(TURNS.mission(), Tables::new(&renamed).mission());
        assert_ne!(TURNS.mission(), AT_ONCE.mission(), "what they need before they begin");
    }

    fn teammates() -> impl Strategy<Value = Said> {
        (0..4u8, 0..3u8, 0..4u8).prop_map(|(place, grip, operator)| said(place, grip, operator))
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

        #[test]
        fn an_announcement_keeps_what_it_is_made_of(
            states in prop::collection::vec(prop::option::of(0..15u8), 0..9),
            operator in 0..16u8,
            intends in 0..16u8,
        ) {
            let said = Announcement::new(states.iter().copied(), operator, intends);
            for factor in 0..8 {
                prop_assert_eq!(said.state(factor), states.get(factor).copied().flatten());
            }
            prop_assert_eq!((said.state(8), said.operator(), said.intends()), (None, operator, intends));
        }

        #[test]
        fn whatever_is_read_and_heard_beliefs_stay_distributions_and_raises_are_rolled_back(
            robot in 0..2u8,
            place_aim in any::<bool>(),
            steps in prop::collection::vec((0..4u8, 0..4u8, prop::option::of(teammates())), 1..60),
        ) {
            let mut bench = Bench::new(&TURNS, robot);
            if place_aim {
                bench.task.pursue(TO_PLACE);
            }
            for (place, state, message) in steps {
                bench.readings = [place, state];
                bench.step(message);
                let states = bench.task.states();
                for belief in [&states[..], bench.task.belief(PLACE.into())] {
                    prop_assert!((belief.iter().sum::<f32>() - 1.0).abs() < 1e-4);
                    prop_assert!(belief.iter().all(|q| (0.0..=1.000_1).contains(q)));
                }
                prop_assert!(bench.task.surprise().is_ok());
                prop_assert!(bench.node.raised().is_none() || bench.begun().is_none());
            }
        }
    }

    #[test]
    fn a_reading_that_no_sensor_has_is_an_error_and_no_event() {
        let mut robot = Bench::new(&TURNS, 0);
        let before = robot.task.belief(PLACE.into()).to_vec();
        robot.readings = [9, PUT];
        robot.tick(Some(idle()));
        let error = robot.task.surprise().expect_err("there are four places").to_string();
        assert_eq!(error, "modality 0 has no outcome 9: there are 4, from 0");
        let after = robot.task.belief(PLACE.into());
        assert!(before.iter().zip(after).all(|(before, after)| (before - after).abs() < 1e-3));
    }
}

mod missions {
    use host_sim::manipulation::{
        CampaignRuns, Compared, Detail, Disturbances, Findings, Run, RunTerms, Trees, Trust, compare,
        narrate, run,
    };
    use host_sim::manipulation::{Order, Preset};
    use std::num::NonZeroUsize;

    fn calm(trees: Trees) -> RunTerms {
        RunTerms { trees, disturbances: Disturbances::NONE, ..RunTerms::new(0) }
    }

    fn watched(terms: RunTerms) -> Run {
        run(&terms, Detail::History).expect("the terms are sound")
    }

    fn findings(terms: RunTerms, seeds: u32) -> Findings {
        CampaignRuns { terms, seeds }.run(None).expect("the terms are sound")
    }

    #[test]
    fn the_published_sequence_of_joint_policies_brings_the_bottle_to_the_plate() {
        for (preset, tolerance) in [(Preset::DEFAULT, 0.005), (Preset::CALIBRATED, 0.001)] {
            let run = watched(RunTerms { preset, ..calm(Trees::Inference) });
            assert!(run.success && run.believed);
            assert_eq!(run.sequence(), [3, 7, 12, 13, 11]);
            for (decided, published) in run.decisions.iter().zip([0.255, 0.205, 0.255, 0.205]) {
                assert!((decided.probability - published).abs() < tolerance, "{decided:?}");
            }
            assert_eq!((run.actions.moves, run.actions.picks, run.actions.placings), (4, 2, 1));
            assert_eq!(run.retries, 0);
        }
    }

    #[test]
    fn both_go_to_goal_c_after_both_hold_and_before_the_bottle_is_placed() {
        let run = watched(calm(Trees::Inference));
        let begun = |robot: usize, what: [&str; 2]| {
            let at = run.history.iter().find(|tick| tick.robots[robot].begins == Some(what));
            at.map(|tick| tick.tick).expect("it was begun")
        };
        let picked = begun(1, ["pick", "goal B"]);
        let placed = begun(0, ["place", "goal C"]);
        for robot in [0, 1] {
            let left = begun(robot, ["moveTo", "goal C"]);
            assert!(picked < left && left < placed, "{picked} {left} {placed}");
        }
    }

    #[test]
    fn while_one_acts_by_a_joint_policy_the_other_does_its_part() {
        let run = watched(calm(Trees::Inference));
        for decided in &run.decisions {
            let other = 2 - decided.robot;
            let tick = &run.history[decided.tick as usize].robots[other];
            let expected = decided.actions[other];
            assert_eq!(tick.begins.map_or("idle", |[deed, _]| deed), expected, "{decided:?}");
            assert!(tick.reading.is_some(), "no action of it was under way");
        }
    }

    #[test]
    fn every_raise_of_a_mission_is_rolled_back_to_the_last_bit() {
        let run = watched(RunTerms::new(3));
        let mut raises = 0;
        for robot in run.history.iter().flat_map(|tick| &tick.robots) {
            let thought = robot.thought.as_ref().expect("it infers");
            let Some(raised) = thought.raised.filter(|_| robot.begins.is_some()) else { continue };
            raises += u32::from(raised != thought.preferences);
            for value in thought.preferences.as_flattened() {
                assert!([0.0f32.to_bits(), 1.0f32.to_bits()].contains(&value.to_bits()), "{thought:?}");
            }
        }
        assert!(raises >= 2, "{raises}");
    }

    #[test]
    fn failed_grasps_are_made_again_until_the_truth_is_as_it_should_be() {
        for order in [Order::InTurn, Order::Together] {
            let found = findings(RunTerms { order, ..RunTerms::new(0) }, 200);
            assert_eq!((found.success.count, found.mistaken.count), (200, 0), "{found:?}");
            // Two things to pick, each after 1 / 0.9 tries on average.
            assert!((0.1..0.4).contains(&found.retries.mean), "{found:?}");
        }
    }

    #[test]
    fn missions_end_well_at_three_in_ten_and_with_everything_failing() {
        let hard = Disturbances { wrong_readings: 0.3, failed_grasps: 0.3, ..Disturbances::NONE };
        let found = findings(RunTerms { disturbances: hard, ..RunTerms::new(0) }, 200);
        assert_eq!(found.success.count, 200, "{found:?}");
        let all = Disturbances { failed_moves: 0.1, failed_placings: 0.1, loss: 0.3, ..Disturbances::TENTH };
        let found = findings(RunTerms { disturbances: all, ..RunTerms::new(0) }, 200);
        assert_eq!(found.success.count, 200, "{found:?}");
        assert!(found.retries.mean > 0.5, "{found:?}");
    }

    #[test]
    fn without_a_radio_the_inferring_robots_wait() {
        let mut terms = calm(Trees::Inference);
        terms.disturbances.loss = 1.0;
        let run = watched(RunTerms { max_ticks: 50, ..terms });
        assert!(!run.believed && run.actions.moves + run.actions.picks + run.actions.placings == 0);
    }

    #[test]
    fn conventional_trees_do_the_mission_on_readings_and_on_the_same_belief() {
        for trees in [Trees::Conventional, Trees::Table6] {
            for trust in [Trust::Equal(3), Trust::Belief] {
                assert!(watched(RunTerms { trust, ..calm(trees) }).success, "{trees:?} {trust:?}");
                let found = findings(RunTerms { trees, trust, ..RunTerms::new(0) }, 100);
                assert!(found.success.count >= 98, "{trees:?} {trust:?} {found:?}");
            }
        }
    }

    #[test]
    fn as_drawn_each_robot_waits_for_the_other_and_neither_begins() {
        let run = watched(RunTerms { max_ticks: 100, ..calm(Trees::AsDrawn) });
        assert!(!run.believed);
        assert_eq!(run.actions.moves + run.actions.picks + run.actions.placings, 0);
    }

    #[test]
    fn believing_is_not_success() {
        let terms = RunTerms { trees: Trees::Conventional, trust: Trust::Equal(1), ..RunTerms::new(0) };
        let found = findings(terms, 100);
        assert!(found.mistaken.count > 10, "single readings mislead: {found:?}");
        assert!(found.success.count + found.mistaken.count <= 100);
    }

    #[test]
    fn the_same_seed_gives_the_same_run_and_threads_change_nothing() {
        let twice = [0, 1].map(|_| watched(RunTerms::new(11)).to_json().expect("it is text"));
        assert_eq!(twice[0], twice[1]);
        let campaign = CampaignRuns { terms: RunTerms::new(5), seeds: 31 };
        let found = [1, 2, 7].map(|threads| campaign.run(NonZeroUsize::new(threads)).expect("sound"));
        assert!(found.iter().all(|one| *one == found[0]));
    }

    #[test]
    fn a_comparison_has_every_contender_at_every_level_and_no_one_fails_undisturbed() {
        let compared = compare(0, 4).expect("sound");
        let levels = host_sim::manipulation::LEVELS.len();
        assert_eq!(compared.len(), levels * host_sim::manipulation::CONTENDERS.len());
        let calm = |of: &&Compared| of.level == 0.0;
        assert!(compared.iter().filter(calm).all(|of| of.findings.success.count == 4));
    }

    #[test]
    fn trees_that_count_readings_are_wrong_or_slow_and_a_belief_under_the_same_tree_is_neither() {
        let compared = compare(0, 150).expect("sound");
        let noisy = |name: &str| {
            let of = compared.iter().find(|of| of.contender == name && of.level == 0.3).expect("a contender");
            of.findings
        };
        let belief = noisy("conventional, the same belief");
        let [hasty, careful] =
            [2, 4].map(|readings| noisy(&format!("conventional, {readings} equal readings")));
        assert!(hasty.success.interval[1] < belief.success.interval[0], "{hasty:?} {belief:?}");
        assert!(careful.ticks.interval[0] > 2.0 * belief.ticks.mean, "{careful:?} {belief:?}");
        let inference = noisy("inference, both at once");
        assert!(belief.ticks.mean < 1.1 * inference.ticks.mean, "{belief:?} {inference:?}");
    }

    #[test]
    fn terms_that_make_no_sense_are_refused_by_name() {
        let refusal = |change: fn(&mut RunTerms)| {
            let mut terms = RunTerms::new(0);
            change(&mut terms);
            run(&terms, Detail::Outcome).expect_err("it makes no sense").to_string()
        };
        assert!(refusal(|terms| terms.disturbances.loss = 1.5).starts_with("loss: "));
        assert!(
            refusal(|terms| terms.disturbances.wrong_readings = f64::NAN).starts_with("wrong readings: ")
        );
        assert!(refusal(|terms| terms.preset.precision = f32::NAN).contains("precision"));
    }

    #[test]
    fn the_narration_names_the_policies_and_the_outcome() {
        let text = narrate(&watched(calm(Trees::Inference)));
        for words in
            ["by pi3 = (moveTo, idle), P 0.259", "by pi11 = (place, idle)", "the bottle is on the plate"]
        {
            assert!(text.contains(words), "{text}");
        }
        assert!(text.ends_with("58 frames of which 0 were lost.\n"), "{text}");
    }
}

mod sizes {
    use host_sim::manipulation::{TreeSize, Trees};

    /// Sequences, fallbacks, conditions, actions, nodes, levels.
    fn counted(size: &TreeSize) -> [usize; 6] {
        [size.sequences, size.fallbacks, size.conditions, size.actions, size.nodes, size.depth]
    }

    #[test]
    fn the_inference_trees_have_the_sizes_of_tables_6_and_7() {
        let [left, right] = Trees::Inference.sizes();
        assert_eq!(counted(&left), [1, 1, 1, 3, 6, 3]);
        assert_eq!(counted(&right), [1, 0, 0, 2, 3, 2]);
    }

    #[test]
    fn the_conventional_trees_as_drawn_have_table_7_s_size_and_not_table_6_s() {
        let [left, right] = Trees::AsDrawn.sizes();
        assert_eq!(counted(&left), [3, 5, 8, 5, 21, 5], "table 6 prints 4, 9, 9, 11, 33, 7");
        assert_eq!(counted(&right), [2, 2, 3, 3, 10, 5]);
    }

    #[test]
    fn a_conventional_tree_with_the_counts_of_table_6_exists() {
        assert_eq!(counted(&Trees::Table6.sizes()[0]), [4, 9, 9, 11, 33, 7]);
    }

    #[test]
    fn what_one_would_write_is_smaller_than_table_6() {
        let [left, right] = Trees::Conventional.sizes();
        assert_eq!(counted(&left), [3, 5, 6, 5, 19, 6]);
        assert_eq!(counted(&right), [2, 3, 3, 3, 11, 5]);
    }
}
