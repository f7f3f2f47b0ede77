//! B learned from experience: by a robot in flight, which then chooses otherwise, and on the host
//! from a log.

use firmware::missions::{LAYERS, NODES, POLICIES};
use host_sim::{
    Conditions, ExecutionLog, Faults, Learned, Logbook, MoveRatio, NavigatorFlight, Record, Scenario, fly,
    library,
};
use iibt_core::grid::{Cell, Map, Move};
use iibt_core::inference::learning::Rates;
use iibt_core::navigation::Mission;

const SEEDS: u64 = 30;

fn worn() -> Scenario {
    library::find("worn").expect("built in").expect("sound")
}

fn flown(scenario: &Scenario, seed: u64) -> (Record, Vec<u8>) {
    let mut logbook = Logbook::new(Vec::new());
    let record =
        fly(scenario, Conditions { seed, ..Conditions::default() }, &mut logbook).expect("it can be flown");
    (record, logbook.finish().expect("memory takes any log"))
}

/// The goals that the robot has chosen, one after another.
fn choices(record: &Record) -> Vec<u16> {
    let goal = |timed: &host_sim::TimedEvent| match timed.event {
        host_sim::FlightEvent::Chose { goal, .. } => Some(goal.0),
        _ => None,
    };
    record.events.iter().filter_map(goal).collect()
}

mod in_flight {
    use super::*;

    const RIGHT: u16 = 12;
    const BOTTOM: u16 = 109;

    #[test]
    fn a_robot_whose_drive_wears_out_changes_its_choice_because_of_what_it_learned() {
        let scenario = worn();
        let mut without = scenario.clone();
        without.inference.learning = Some(0.0);
        let (mut with_ticks, mut without_ticks) = (0, 0);
        for seed in 0..SEEDS {
            let (learns, does_not) = (flown(&scenario, seed).0, flown(&without, seed).0);
            assert_eq!(choices(&learns), [RIGHT, BOTTOM], "seed {seed}");
            assert_eq!(
                choices(&does_not),
                [RIGHT, RIGHT],
                "seed {seed}: the same failures, and nothing learned"
            );
            assert!(learns.outcome.is_success() && does_not.outcome.is_success(), "seed {seed}");
            with_ticks += learns.ticks;
            without_ticks += does_not.ticks;
        }
        println!("ticks of {SEEDS} flights: {with_ticks} with learning, {without_ticks} without");
        assert!(with_ticks < without_ticks);
    }

    #[test]
    fn a_robot_whose_drive_is_sound_keeps_its_choice() {
        let mut scenario = worn();
        scenario.drive_faults.clear();
        let mut without = scenario.clone();
        without.inference.learning = Some(0.0);
        let (learns, does_not) = (flown(&scenario, 0).0, flown(&without, 0).0);
        assert_eq!(choices(&learns), [RIGHT, RIGHT]);
        assert_eq!(learns, does_not, "to the last bit");
    }

    /// The true probability is reached within three standard errors of a ratio of this many tries,
    /// plus what the eight successes that a robot begins with weigh.
    #[test]
    fn the_slips_a_robot_has_learned_are_those_of_its_drive() {
        let (starts, goals) = ([Cell(0)], [Cell(48)]);
        let map = Map::new(7, 7).expect("49 cells fit two words");
        let mission = Mission { learning: Rates::DEFAULT, ..Mission::new(map, &starts, &goals) };
        let slip = 0.5_f32;
        for seed in 0..10 {
            let faults = Faults { slip: f64::from(slip), ..Faults::default() };
            let flight = NavigatorFlight::<49, 2, LAYERS, NODES, POLICIES>::over(&mission, faults, seed);
            let mut flight = flight.expect("a sound mission");
            // The robot is put back again and again, so that it tries its moves often.
            let mut made = [0_u16; 2];
            for tick in 0..8000 {
                if tick % 80 == 79 {
                    flight.place(0, starts[0]);
                }
                let before = flight.cells()[0].0;
                flight.tick();
                let after = flight.cells()[0].0;
                made[0] += u16::from(after == before + 1);
                made[1] += u16::from(after == before + 7);
            }
            let learned = flight.robot(0).robot().navigation().localisation().slips();
            for (step, made) in [Move::Right, Move::Down].into_iter().zip(made) {
                let found = learned[usize::from(step.code())];
                let tries = f32::from(made) / (1.0 - slip);
                let error = 3.0 * (slip * (1.0 - slip) / tries).sqrt() + 8.0 / tries;
                println!("seed {seed}: {step:?} slips with {found} in about {tries} tries");
                assert!(tries > 400.0 && (found - slip).abs() < error, "seed {seed}: {found}, error {error}");
            }
        }
    }
}

mod from_logs {
    use super::*;

    fn totals(scenario: &Scenario) -> [MoveRatio; 4] {
        let mut logs = (0..SEEDS).map(|seed| {
            let (_, log) = flown(scenario, seed);
            Learned::from(&ExecutionLog::read("flight.csv", &log).expect("what was written can be read"))
        });
        let first = logs.next().expect("a flight").robots.remove(0).moves;
        let sum = logs.fold(first, |mut sum, learned| {
            for (all, one) in sum.iter_mut().zip(&learned.robots[0].moves) {
                all.successes += one.successes;
                all.failures += one.failures;
            }
            sum
        });
        sum.try_into().expect("four moves")
    }

    #[test]
    fn the_ratios_are_within_three_standard_errors_of_the_true_probabilities() {
        let mut scenario = worn();
        scenario.inference.learning = Some(0.0);
        scenario.drive_faults.push(host_sim::DriveFault { robot: 0, step: Move::Down, from: 0, fails: 0.3 });
        let [up, down, left, right] = totals(&scenario);
        for (of, truth) in [(&up, 1.0), (&down, 0.7), (&right, 0.2)] {
            let tries = f64::from(of.successes + of.failures);
            let (ratio, error) = (f64::from(of.successes) / tries, (truth * (1.0 - truth) / tries).sqrt());
            println!("{}: {ratio:.3} of {tries} tries for {truth}, standard error {error:.3}", of.name);
            assert!(
                tries >= 30.0 && (ratio - truth).abs() <= 3.0 * error,
                "{}: {ratio} for {truth}",
                of.name
            );
        }
        assert_eq!(left.ratio, None);
    }

    #[test]
    fn wear_begins_at_its_tick() {
        let mut scenario = worn();
        scenario.drive_faults[0].from = 8;
        let log = ExecutionLog::read("flight.csv", &flown(&scenario, 0).1).expect("sound");
        let failures = || log.attempts.iter().filter(|attempt| !attempt.succeeded);
        assert!(failures().count() > 0 && failures().all(|attempt| attempt.tick >= 8));
        assert!(failures().all(|attempt| attempt.step == Move::Right && attempt.next == attempt.cell));
    }

    #[test]
    fn a_log_tells_every_move_of_the_flight() {
        for name in library::names() {
            let scenario = library::find(name).expect("built in").expect("sound");
            let (record, log) = flown(&scenario, 3);
            let log = ExecutionLog::read("flight.csv", &log).expect("sound");
            assert_eq!(log.map, scenario.map);
            let made = log.attempts.iter().filter(|attempt| attempt.succeeded).count();
            assert_eq!(made as u32, record.robots.iter().map(|robot| robot.moves).sum::<u32>(), "{name}");
        }
    }

    #[test]
    fn a_name_with_a_comma_or_a_quote_comes_back_as_it_was() {
        let mut scenario = worn();
        scenario.robots[0].name = "R, \"1\"".to_owned();
        let log = ExecutionLog::read("flight.csv", &flown(&scenario, 0).1).expect("sound");
        assert!(log.attempts.iter().all(|attempt| attempt.robot == "R, \"1\""));
    }

    #[test]
    fn b_of_a_learned_log_has_a_distribution_in_every_column() {
        let learned = Learned::from(&ExecutionLog::read("flight.csv", &flown(&worn(), 0).1).expect("sound"));
        let value: serde_json::Value = serde_json::from_str(&learned.to_json().expect("text")).expect("JSON");
        let b = &value["B"][0];
        let ratio = &value["robots"][0]["moves"][3]["ratio"];
        assert_eq!((&b[1][0][3], value["actions"][3].as_str()), (ratio, Some("right")));
        for cell in 0..117 {
            for action in 0..5 {
                let column = (0..117).map(|next| b[next][cell][action].as_f64().expect("a number"));
                assert!((column.sum::<f64>() - 1.0).abs() < 1e-12, "{cell}, {action}");
            }
        }
    }
}

mod refused {
    use super::*;

    const SOUND: &str = "\
# map ..../.#..
tick,robot,cell,move,next,succeeded
0,R1,0,right,1,1
2,R1,1,right,1,0
";

    fn refusal(text: &str) -> String {
        ExecutionLog::read("my.csv", text.as_bytes())
            .map_or_else(|error| error.to_string(), |_| "accepted".into())
    }

    #[test]
    fn a_log_with_file_line_and_reason() {
        assert_eq!(refusal(SOUND), "accepted");
        let cases = [
            ("# map", "map", "1", "the first line is not the map"),
            ("/.#..", "/.#.", "1", "row 1 of the map has 3 cells, but row 0 has 4"),
            ("/.#..", "/.x..", "1", "'x' is no cell of a map"),
            ("..../.#..", ".", "1", "the map has 1 x 1 cells, not 2 to 1024"),
            ("tick,", "time,", "2", "the second line is not"),
            ("0,R1,0", "0,R1", "3", "there are no six values"),
            ("0,R1,0", "zero,R1,0", "3", "tick = zero is no whole number"),
            ("0,R1,0", "0,,0", "3", "the robot has no name"),
            ("0,R1,0", "0,R1,5", "3", "cell = 5 is no free cell of the map"),
            ("right,1,1", "right,9,1", "3", "next = 9 is no free cell of the map"),
            ("right,1,1", "wait,1,1", "3", "no move is called \"wait\": there are up, down, left and right"),
            ("right,1,1", "up,0,1", "3", "a move up from 0 that succeeded does not end on 0"),
            ("right,1,1", "right,2,1", "3", "a move right from 0 that succeeded does not end on 2"),
            ("right,1,0", "right,2,0", "4", "a move right from 1 that failed does not end on 2"),
            ("right,1,0", "right,1,yes", "4", "succeeded = yes is not 1 or 0"),
        ];
        for (right, wrong, line, reason) in cases {
            assert!(SOUND.contains(right), "{right}");
            let refusal = refusal(&SOUND.replacen(right, wrong, 1));
            assert!(refusal.starts_with(&format!("my.csv:{line}: ")), "{wrong}: {refusal}");
            assert!(refusal.contains(reason), "{wrong}: {refusal}");
        }
        let noise = ExecutionLog::read("my.csv", b"# map ..\n\xff").map_err(|error| error.to_string());
        assert_eq!(noise, Err("my.csv:2: this is no UTF-8 text".to_owned()));
    }

    #[test]
    fn a_scenario_with_file_line_and_reason() {
        let sound =
            "title = 't'\nmap = '1.G'\n[[wear]]\nrobot = 'R1'\nmove = 'right'\nfrom = 5\nfails = 0.7\n";
        assert!(Scenario::parse("my.toml", sound).is_ok());
        let cases = [
            ("'R1'", "'R2'", "4", "no robot is called \"R2\": there are R1"),
            ("'right'", "'wait'", "5", "no move is called \"wait\": there are up, down, left and right"),
            ("from = 5", "from = -5", "6", "from = -5 is not between 0 and 100000"),
            ("fails = 0.7", "fails = 1.7", "7", "fails = 1.7 is not between 0 and 1"),
            ("fails = 0.7", "", "3", "missing field `fails`"),
            ("fails = 0.7", "fail = 0.7", "7", "unknown field `fail`"),
            (
                "fails = 0.7",
                "fails = 0.7\n[inference]\nlearning = -1",
                "9",
                "learning = -1 is not between 0 and",
            ),
        ];
        for (right, wrong, line, reason) in cases {
            let refusal = Scenario::parse("my.toml", &sound.replacen(right, wrong, 1)).map(|_| ());
            let refusal = refusal.map_err(|error| error.to_string()).expect_err(wrong);
            assert!(refusal.starts_with(&format!("my.toml:{line}: ")), "{wrong}: {refusal}");
            assert!(refusal.contains(reason), "{wrong}: {refusal}");
        }
    }
}
