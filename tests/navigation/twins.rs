//! Two robots with one number: the one whose frames are not the newest stands, is silent, and says
//! so.

use super::*;
use firmware::Navigator;

/// The factory's team, and a robot with the number of its second one, which has started so many
/// times more.
fn team_and_twin<'m>(mission: &'m Mission<'m, 2>, starts: u32) -> [Team<'m>; 2] {
    let (team, mut twin) = (agreed(mission), team(mission));
    [0, 2].into_iter().for_each(|other| twin.cause(EventEffect::Stop(other, None)));
    (0..starts).for_each(|_| twin.restart(1).expect("it was built before"));
    [team, twin]
}

/// Ticks a team, which hears the twin of its second robot and is heard by it.
fn tick_both(team: &mut Team<'_>, twin: &mut Team<'_>) {
    team.tick();
    twin.tick();
    let (frames, said) = (twin.sent(1).concat(), (0..3).flat_map(|robot| team.sent(robot).concat()));
    let said: Vec<u8> = said.collect();
    (0..3).for_each(|robot| team.deliver(robot, &frames));
    twin.deliver(1, &said);
}

fn twins_heard(team: &Team<'_>) -> u32 {
    team.robot(1).link_report().received.twin
}

#[test]
fn a_robot_that_hears_another_with_its_number_and_a_later_start_stands_and_says_so() {
    let mission = factory();
    let [mut team, mut twin] = team_and_twin(&mission, 1);
    (0..4).for_each(|_| tick_both(&mut team, &mut twin));
    assert_eq!(report(&team, 1).waiting, Some(Waiting::Twin));
    let (stands, mut has_failed) = (team.cells()[1], false);
    for _ in 0..Navigator::<49, 2, LAYERS, NODES, POLICIES>::TIMEOUT_TICKS + 10 {
        tick_both(&mut team, &mut twin);
        assert!(team.commands()[1].is_none() && team.sent(1).is_empty(), "it stands and is silent");
        has_failed |= team.statuses()[1] == Status::Failure;
    }
    assert_eq!((team.cells()[1], twins_heard(&twin)), (stands, 0), "the other does not know");
    assert!(twins_heard(&team) > 0 && has_failed, "its leaf fails at its timeout");
}

/// Both have started as often, and send the same numbers.
#[test]
fn one_of_two_robots_with_the_same_number_and_epoch_notices() {
    let mission = factory();
    for ahead in 0..3 {
        let [mut team, mut twin] = team_and_twin(&mission, 0);
        let behind = team.ticks() - ahead;
        tick(&mut twin, behind);
        (0..6).for_each(|_| tick_both(&mut team, &mut twin));
        let waits = |team: &Team<'_>| report(team, 1).waiting == Some(Waiting::Twin);
        assert!(waits(&team) || waits(&twin), "{ahead} ahead");
    }
}

#[test]
fn an_echo_is_no_other_robot_even_if_it_comes_late_or_from_the_life_before() {
    let mission = factory();
    let mut team = agreed(&mission);
    let mut said: Vec<u8> = vec![];
    for ticks in 0..200 {
        team.tick();
        said.extend(team.sent(1).concat());
        let late = said.len().saturating_sub(400);
        let [all, newest] = [&said[late..], &team.sent(1).concat()].map(<[u8]>::to_vec);
        team.deliver(1, &newest);
        if ticks % 7 == 0 {
            team.deliver(1, &all);
        }
        if ticks == 50 {
            team.restart(1).expect("it was built before");
        }
    }
    assert!(team.robot(1).link_report().received.own > 0);
    assert_eq!((twins_heard(&team), team.collisions().total()), (0, 0));
    assert!(stopped(&team));
}
