use super::*;

/// Whether no robot has moved for twenty ticks.
fn stands_still(record: &Record) -> bool {
    let last = record.history.iter().rev().take(20).collect::<Vec<_>>();
    last.len() == 20 && last.windows(2).all(|pair| pair[0] == pair[1])
}

#[test]
fn losing_three_frames_in_ten_makes_nobody_collide() {
    let scenario = built_in("factory");
    for seed in 0..10 {
        let record = flown(&scenario, seed, 0.3);
        assert_eq!(record.collisions.total(), 0, "seed {seed}");
        assert!(record.frames.lost > 0, "seed {seed}");
        assert!(record.outcome.is_success() || stands_still(&record), "seed {seed}: {record:?}");
    }
}

#[test]
fn losing_half_of_them_makes_nobody_collide_anywhere() {
    for name in library::names() {
        for seed in 0..3 {
            let record = flown(&built_in(name), seed, 0.5);
            assert_eq!(record.collisions.total(), 0, "{name}, seed {seed}");
        }
    }
}

#[test]
fn without_it_everybody_stays() {
    let record = flown(&built_in("two-goals"), 0, 1.0);
    assert_eq!(record.outcome, Outcome::Unfinished);
    assert!(record.history.iter().all(|cells| *cells == record.history[0]));
    assert_eq!((record.frames.delivered, record.frames.lost), (0, record.frames.sent));
}

#[test]
fn late_and_repeated_frames_cost_time_only() {
    let mut scenario = built_in("factory");
    let usual = flown(&scenario, 0, 0.0);
    (scenario.radio.delay, scenario.radio.duplicate) = (4, 0.5);
    let record = flown(&scenario, 0, 0.0);
    assert!(record.outcome.is_success() && record.collisions.total() == 0, "{:?}", record.outcome);
    assert!(record.ticks > usual.ticks);
    // A frame heard twice is rejected once, and so is one that is passed on where no robot misses
    // it.
    for (robot, usual) in record.robots.iter().zip(&usual.robots) {
        assert!(robot.rejected > usual.rejected, "{} after {}", robot.rejected, usual.rejected);
    }
}
