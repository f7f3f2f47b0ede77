//! Results beyond the paper: heterogeneous teams that know their differences, and robots that learn
//! where they are served.

use firmware::missions::{LAYERS, NODES, POLICIES};
use host_sim::beyond::{LearnedPreferences, Mixed, Unlike};
use host_sim::campaign::Score;
use host_sim::{Conditions, Faults, NavigatorFlight, Scenario, Series, fly_series, library};
use iibt_core::grid::{Cell, Map};
use iibt_core::navigation::{MAX_GOALS, Mission};

fn built_in(name: &str) -> Scenario {
    library::find(name).expect("built in").expect("sound")
}

fn series(seed: u64, learning: bool, loss: f64) -> Series {
    let conditions = Conditions { seed, loss: Some(loss), ..Conditions::default() };
    fly_series(&built_in("deliveries"), conditions, learning, &mut ()).expect("it can be flown")
}

#[test]
fn robots_that_know_their_paces_are_sooner_at_their_goals_and_nobody_collides() {
    let mixed = Mixed::fly(&built_in("mixed"), Unlike::Paces, 400);
    println!("{:?}", mixed.saved());
    assert!(mixed.saved().is_significant() && mixed.saved().mean > 0.0, "{:?}", mixed.saved());
    assert!(!mixed.known.iter().chain(&mixed.alike).any(Score::has_collided));
    assert_eq!(Mixed::accomplished(&mixed.known).count, 400);
}

#[test]
fn robots_that_know_their_sensors_do_not_collide() {
    for unlike in [Unlike::Sensors, Unlike::Both] {
        let mixed = Mixed::fly(&built_in("mixed"), unlike, 20);
        assert!(!mixed.known.iter().chain(&mixed.alike).any(Score::has_collided));
    }
}

#[test]
fn robots_that_learn_are_served_more_often_and_nobody_collides() {
    let learned = LearnedPreferences::fly(&built_in("deliveries"), 30);
    let [with, without] =
        [&learned.learning, &learned.not].map(|series| LearnedPreferences::last_third(series).mean);
    println!("served: {with} with learning, {without} without; {:?}", learned.gain());
    // The two stations that serve best serve 85 % together.
    assert!(learned.gain().is_significant() && with > 0.82 && with - without > 0.25, "{with} {without}");
    assert!(learned.learning.iter().chain(&learned.not).all(|series| series.collided == 0));
    assert!(learned.learning.iter().all(|series| series.together == series.shares.len()));
}

#[test]
fn the_same_seed_gives_the_same_series_and_the_first_mission_knows_nothing() {
    assert_eq!(series(3, true, 0.1), series(3, true, 0.1));
    let [learning, not] = [true, false].map(|learning| series(5, learning, 0.0));
    assert_eq!(learning.missions.len(), 30);
    let cells = |series: &Series| series.missions[0].record.robots.iter().map(|r| r.cell).collect::<Vec<_>>();
    assert_eq!(cells(&learning), cells(&not));
}

#[test]
fn a_radio_that_loses_three_frames_in_ten_makes_nobody_collide_while_they_learn() {
    for seed in 0..3 {
        let series = series(seed, true, 0.3);
        assert!(series.missions.iter().all(|mission| mission.record.collisions.total() == 0), "seed {seed}");
    }
}

/// A robot between two goals, one step from each.
fn goal_with(values: &[f32; MAX_GOALS]) -> Cell {
    let (starts, goals) = ([Cell(25)], [Cell(24), Cell(26)]);
    let mission = Mission::new(Map::<2>::new(7, 7).expect("49 cells fit two words"), &starts, &goals);
    let flight = NavigatorFlight::<49, 2, LAYERS, NODES, POLICIES>::over(&mission, Faults::default(), 0);
    let mut flight = flight.expect("a sound mission");
    flight.robot_mut(0).robot_mut().navigation_mut().set_goal_preferences(values);
    while !flight.has_arrived() && flight.ticks() < 20 {
        flight.tick();
    }
    flight.cells()[0]
}

#[test]
fn of_two_goals_as_near_the_one_that_serves_more_often_is_chosen() {
    let with = |first: f32, second: f32| {
        let mut values = [1.0; MAX_GOALS];
        (values[0], values[1]) = (first, second);
        goal_with(&values)
    };
    assert_eq!((with(0.25, 1.0), with(1.0, 0.25)), (Cell(26), Cell(24)));
    let usual = with(1.0, 1.0);
    for wrong in [f32::NAN, f32::INFINITY, -1.0, 0.0, 7.0] {
        assert_eq!(with(wrong, wrong), usual, "{wrong} counts as one");
        assert_eq!((with(wrong, 0.25), with(0.25, wrong)), (Cell(24), Cell(26)), "{wrong}");
    }
}

#[test]
fn paces_and_sensors_out_of_range_are_refused() {
    let (starts, goals) = ([Cell(0)], [Cell(24)]);
    let mission = Mission::new(Map::<2>::new(7, 7).expect("49 cells fit two words"), &starts, &goals);
    for (paces, sensors, sound) in
        [(&[8][..], &[1.0][..], true), (&[9], &[], false), (&[0], &[], false), (&[], &[1.1], false)]
    {
        let mission = Mission { paces, sensors, ..mission };
        assert_eq!(mission.check::<49>().is_ok(), sound, "{paces:?} {sensors:?}");
    }
}
