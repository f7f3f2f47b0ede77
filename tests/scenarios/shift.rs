//! Section 6.1 of the paper, phase by phase.

use super::*;
use host_sim::{FlightEvent, Phase};
use iibt_core::navigation::Cause;

/// The rounds to which all agreed.
fn agreed(record: &Record) -> Vec<&Phase> {
    record.phases.iter().filter(|phase| phase.agreed.is_some()).collect()
}

/// The tick of the first events of this kind.
fn tick_of(record: &Record, is_it: impl Fn(&FlightEvent) -> bool) -> u32 {
    record.events.iter().find(|timed| is_it(&timed.event)).expect("it happens").tick
}

/// The ways of all robots in a plan, on the map without obstacles.
fn paths(phase: &Phase) -> Vec<Vec<u16>> {
    let path = |chosen: &host_sim::Chosen| chosen.path.iter().map(|cell| cell.0).collect();
    phase.choices.iter().flatten().map(path).collect()
}

fn has_three_goals(phase: &Phase) -> bool {
    let goals: BTreeSet<_> = phase.choices.iter().flatten().filter_map(|chosen| chosen.goal).collect();
    goals.len() == 3
}

/// Whether no robot shares a cell with a teammate at any step, or swaps with it.
fn is_clear(phase: &Phase) -> bool {
    let paths = paths(phase);
    // A robot stays on the last cell of its path.
    let at = |path: &[u16], step: usize| path.get(step).or(path.last()).copied();
    let steps = paths.iter().map(Vec::len).max().unwrap_or(0);
    (1..steps).all(|step| {
        (0..paths.len()).all(|one| {
            (0..one).all(|other| {
                let (a, b) = (&paths[one], &paths[other]);
                let swaps = at(a, step) == at(b, step - 1) && at(b, step) == at(a, step - 1);
                at(a, step) != at(b, step) && !swaps
            })
        })
    })
}

fn cells(phase: &Phase) -> Vec<u16> {
    phase.obstacles.iter().map(|cell| cell.0).collect()
}

fn causes(record: &Record, cause: Cause) -> usize {
    record.phases.iter().filter(|phase| phase.cause == Some(cause)).count()
}

/// The obstacles that appeared, in their order, and when.
fn obstacles(record: &Record) -> Vec<(u32, Cell)> {
    let appeared = |timed: &host_sim::TimedEvent| match timed.event {
        FlightEvent::Appeared { cell } => Some((timed.tick, cell)),
        _ => None,
    };
    record.events.iter().filter_map(appeared).collect()
}

/// Everything that section 6.1 tells happens, whatever its order.
fn check(record: &Record, case: &str) {
    assert!(record.outcome.is_success(), "{case}: {:?}", record.outcome);
    assert_eq!(record.collisions.total(), 0, "{case}");
    for plan in agreed(record) {
        assert!(is_clear(plan), "{case}: {plan:?}");
    }
    assert_eq!(obstacles(record).len(), 2, "{case}");
    assert_eq!(
        [0, 1, 2].map(|robot| record.robots[robot].visited.clone()),
        [vec![Cell(4)], vec![], vec![Cell(39)]],
        "{case}"
    );
    assert_eq!([0, 1, 2].map(|robot| record.robots[robot].charged), [1, 0, 1], "{case}");
}

/// Everything happens phase by phase.
fn check_order(record: &Record) {
    let plans = agreed(record);
    let [(first, one), (second, other)] = obstacles(record)[..] else { panic!("two obstacles") };
    for plan in &plans {
        assert!(paths(plan).iter().flatten().all(|cell| !cells(plan).contains(cell)), "{plan:?}");
    }
    let known: Vec<_> = plans.iter().map(|plan| plan.obstacles.clone()).collect();
    let both = BTreeSet::from([one, other]).into_iter().collect();
    assert_eq!(known[..3], [vec![], vec![one], both]);
    assert!(paths(plans[0]).iter().any(|path| path.contains(&one.0)), "it is in the way of a robot");
    assert!(paths(plans[1]).iter().any(|path| path.contains(&other.0)), "so is the second one");
    let after = |tick: u32| plans.iter().find_map(|plan| plan.agreed.filter(|&agreed| agreed > tick));
    let at = |is_it: fn(&FlightEvent) -> bool| tick_of(record, is_it);
    let asked = at(|event| matches!(event, FlightEvent::Asked { robot: 0, cell: Cell(4) }));
    let order = [
        plans[0].agreed.expect("agreed"),
        first,
        after(first).expect("another plan"),
        second,
        after(second).expect("another plan"),
        asked,
        after(asked).expect("another plan"),
        at(|event| matches!(event, FlightEvent::Visited { robot: 0, cell: Cell(4) })),
        at(|event| matches!(event, FlightEvent::Left { robot: 0, .. })),
        at(|event| matches!(event, FlightEvent::Returned { robot: 0, .. })),
        at(|event| matches!(event, FlightEvent::Left { robot: 2, .. })),
        at(|event| matches!(event, FlightEvent::Returned { robot: 2, .. })),
        plans.last().and_then(|plan| plan.agreed).expect("agreed"),
    ];
    assert!(order.is_sorted(), "{order:?}");
    assert!(has_three_goals(plans.last().expect("there are plans")));
    let least = [(Cause::Obstacle, 2), (Cause::WayPoint, 1), (Cause::Battery, 2), (Cause::Free, 1)];
    for (cause, least) in least {
        assert!(causes(record, cause) >= least, "{cause:?}: {}", causes(record, cause));
    }
}

#[test]
fn all_five_phases_happen_in_their_order_and_the_team_arrives_together() {
    let record = flown(&built_in("shift"), 0, 0.0);
    check(&record, "no loss");
    check_order(&record);
    assert_eq!(record.outcome, Outcome::Together);
}

#[test]
fn all_five_phases_happen_whatever_the_radio_loses() {
    let scenario = built_in("shift");
    for seed in 0..=200 {
        check(&flown(&scenario, seed, 0.3), &format!("seed {seed}"));
    }
}

/// When a robot left to charge, and when it came back.
fn away(record: &Record, robot: usize) -> [usize; 2] {
    let left = |event: &FlightEvent| matches!(event, FlightEvent::Left { robot: who, .. } if *who == robot);
    let back =
        |event: &FlightEvent| matches!(event, FlightEvent::Returned { robot: who, .. } if *who == robot);
    [tick_of(record, left) as usize, tick_of(record, back) as usize]
}

/// The ticks in which a robot moved that does not charge, a number of ticks or more after
/// another left to charge.
fn moves_beside(record: &Record, after: usize) -> Vec<usize> {
    let absent = [0, 2].map(|robot: usize| (robot, away(record, robot)));
    let is_away = |robot: usize, tick: usize, after: usize| {
        let is_within = |&(who, [left, back]): &(usize, [usize; 2])| {
            (robot == usize::MAX || who == robot) && (left + after..=back).contains(&tick)
        };
        absent.iter().any(is_within)
    };
    let moved = |tick: usize, robot: usize| record.history[tick][robot] != record.history[tick + 1][robot];
    let ticks = (0..record.history.len() - 1).filter(|&tick| is_away(usize::MAX, tick, after));
    ticks.filter(|&tick| (0..3).any(|robot| moved(tick, robot) && !is_away(robot, tick, 0))).collect()
}

#[test]
fn the_others_stand_while_a_robot_charges() {
    // A move that was agreed on before may still be made while the frames travel.
    for (loss, after) in [(0.0, 1), (0.3, 8)] {
        for seed in 0..10 {
            let record = flown(&built_in("shift"), seed, loss);
            assert_eq!(moves_beside(&record, after), [0; 0], "{loss}, seed {seed}");
            for (robot, charger) in [(0, Cell(13)), (2, Cell(41))] {
                let [left, back] = away(&record, robot);
                assert!(record.history[left..=back].iter().any(|cells| cells[robot] == charger));
            }
        }
    }
}

#[test]
fn the_others_go_on_where_the_team_does_not_wait_for_charging() {
    let text = |waits: bool| {
        format!(
            "title = 't'\nwait_for_charging = {waits}\nmap = '''\n1.....G\n.......\n2.....G\n'''\n\
             [[robot]]\ncharger = 13\nbattery = 15\ncharging = 2"
        )
    };
    let [(waiting, back), (going_on, later)] = [true, false].map(|waits| {
        let record = flown(&Scenario::parse("t", &text(waits)).expect("sound"), 0, 0.0);
        assert!(record.outcome.is_success() && record.robots[0].charged == 1, "{:?}", record.outcome);
        (record.robots[1].arrived as usize, away(&record, 0)[1])
    });
    assert!(waiting > back && going_on < later, "{waiting}, {back}; {going_on}, {later}");
}

#[test]
fn every_robot_is_sure_of_its_cell_when_its_localiser_is_right() {
    let record = flown(&built_in("shift"), 0, 0.0);
    assert_eq!(record.certainty.len() + 1, record.history.len());
    let sure = record.certainty.iter().flatten().filter(|&&p| p > 0.99).count();
    assert!(sure * 10 > record.certainty.len() * 3 * 9, "{sure} of {}", record.certainty.len() * 3);
}
