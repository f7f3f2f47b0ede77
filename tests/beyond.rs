//! Results beyond the paper: heterogeneous teams that know their differences, and robots that learn
//! where they are served.

use host_sim::beyond::{LearnedPreferences, Mixed, Unlike};
use host_sim::campaign::Score;
use host_sim::{Conditions, Scenario, Series, fly_series, library};
use iibt_core::grid::{Cell, Map};
use iibt_core::iibt::Task;
use iibt_core::navigation::{Mission, Navigation};
use iibt_core::team::{Member, RobotId};

fn built_in(name: &str) -> Scenario {
    library::find(name).expect("built in").expect("sound")
}

fn series(seed: u64, learning: bool, loss: f64) -> Series {
    let conditions = Conditions { seed, loss: Some(loss), ..Conditions::default() };
    fly_series(&built_in("deliveries"), conditions, learning, &mut ()).expect("it can be flown")
}

#[test]
fn robots_that_know_their_paces_are_sooner_at_their_goals_and_nobody_collides() {
    let mixed = Mixed::fly(&built_in("mixed"), Unlike::Paces, 40);
    assert!(mixed.saved().is_significant() && mixed.saved().mean > 0.0, "{:?}", mixed.saved());
    assert!(!mixed.known.iter().chain(&mixed.alike).any(Score::has_collided));
    assert_eq!(Mixed::accomplished(&mixed.known).count, 40);
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
    let learned = LearnedPreferences::fly(&built_in("deliveries"), 12);
    assert!(learned.gain().is_significant() && learned.gain().mean > 0.0, "{:?}", learned.gain());
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

#[test]
fn what_goals_are_worth_is_the_base_of_the_preference() {
    let (starts, goals) = ([Cell(0)], [Cell(24), Cell(26), Cell(48)]);
    let mission = Mission::new(Map::<2>::new(7, 7).expect("49 cells fit two words"), &starts, &goals);
    let member = Member::new(RobotId(0), 1).expect("a team of one");
    let mut robot = Navigation::<49, 2, 8>::new(&mission, member, 1).expect("it fits");
    let mut values = [1.0; 8];
    (values[1], values[2]) = (0.25, f32::NAN);
    robot.set_goal_preferences(&values);
    let worth = |robot: &Navigation<'_, 49, 2, 8>| [24, 26, 48, 25].map(|cell| robot.preference().get(cell));
    assert_eq!(worth(&robot), [1.0, 0.25, 1.0, 0.0].map(Some), "what is no worth counts as one");
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
    let mission = Mission { sensors: &[0.4976], ..mission };
    assert!(
        (mission.peer_sensor_of(RobotId(0)) - 0.452).abs() < 1e-6
            && mission.peer_sensor_of(RobotId(1)) == 0.904
    );
}
