//! Recorded logs: what a tree has done is drawn as it was, and a log that is not the tree's is
//! refused.

use super::traces::recorded;
use super::*;
use host_sim::tree::Replay;
use iibt_core::time::Instant;
use iibt_core::tree::StatusChange;

const PATROL: &str = "<ReactiveSequence><Fallback><L name=\"charged\" s=\"S\"/><L name=\"charge\" s=\"R\"/></Fallback>\
                      <L name=\"drive\" s=\"RRRS\"/></ReactiveSequence>";

fn replay(instance: &Instance, log: &str, robot: Option<&str>) -> Result<Replay, String> {
    let ticks = instance.recorded("log", log.as_bytes(), robot).map_err(|error| error.to_string())?;
    instance.replay(&ticks).map_err(|error| error.to_string())
}

/// The transitions of a run as a file of Groot2, replayed.
fn replayed(instance: &Instance, transitions: &[StatusChange]) -> Replay {
    let log = instance.btlog(transitions);
    let ticks = instance.recorded("log", &log, None).unwrap_or_else(|error| panic!("{error}"));
    instance.replay(&ticks).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn the_tree_is_drawn_as_it_ticked() {
    let log = "0.001 INFO  boot: robot 1 of 2 on p28\n\
               0.002 INFO  tick 1: tree 1 at 0 ms: 2:S 1:S 4:R 0:R\n\
               0.100 INFO  tick 2: tree 2 at 100 ms: 2:S 1:S\n\
               0.300 INFO  tick 4: tree 3 at 300 ms: 2:S 1:S 4:S 0:S\n";
    let replay = replay(&instance(&file(PATROL)), log, None).unwrap();
    let drawn: String = replay.ticks.iter().map(|tick| tick.text.as_str()).collect();
    let expected = "\
tick 1, 0 ms
RUNNING  ReactiveSequence
SUCCESS  ├─ Fallback
SUCCESS  │  ├─ L 'charged' s=S
         │  └─ L 'charge' s=R
RUNNING  └─ L 'drive' s=RRRS
ticks 2 to 3, 100 ms
RUNNING  ReactiveSequence
SUCCESS  ├─ Fallback
SUCCESS  │  ├─ L 'charged' s=S
         │  └─ L 'charge' s=R
RUNNING  └─ L 'drive' s=RRRS
tick 4, 300 ms
SUCCESS  ReactiveSequence
SUCCESS  ├─ Fallback
SUCCESS  │  ├─ L 'charged' s=S
         │  └─ L 'charge' s=R
SUCCESS  └─ L 'drive' s=RRRS
";
    assert_eq!(drawn, expected);
    assert_eq!((replay.gaps.len(), replay.fault, replay.transitions.len()), (0, None, 10));
}

#[test]
fn the_same_log_is_read_as_lines_as_objects_and_with_places_of_other_decoders() {
    let instance = instance(&file(PATROL));
    let lines = ["tick 1: tree 1 at 0 ms: 2:S 1:S 4:R 0:R", "tick 2: tree 2 at 100 ms: 2:S 1:S"];
    let expected = replay(&instance, &lines.join("\n"), None).unwrap();
    assert_eq!(expected.ticks.len(), 2);
    let object = |line: &str| format!("{{\"time\":\"0.1\",\"level\":\"info\",\"message\":\"{line}\"}}");
    assert_eq!(replay(&instance, &lines.map(object).join("\n"), None).as_ref(), Ok(&expected));
    let placed = |line: &str| format!("0.100 [INFO ] {line} (firmware src/team_member.rs:210)");
    assert_eq!(replay(&instance, &lines.map(placed).join("\n"), None).as_ref(), Ok(&expected));
    let of_robot = |line: &str| format!("robot R1: {line}\nrobot a b: {line}");
    let both = lines.map(of_robot).join("\n");
    assert_eq!(
        replay(&instance, &both, Some("R1")).map(|replay| replay.transitions),
        Ok(expected.transitions)
    );
    let refused = "log: the log is of several robots: R1, a b; choose one with --robot";
    assert_eq!(replay(&instance, &both, None), Err(refused.to_owned()));
    let unknown = "log: no robot is called \"R3\" there, only R1, a b";
    assert_eq!(replay(&instance, &both, Some("R3")), Err(unknown.to_owned()));
}

#[test]
fn a_change_that_is_left_out_or_another_one_is_found() {
    let instance = instance(&file(PATROL));
    let fault = |second: &str| {
        let log = format!("tick 1: tree 1 at 0 ms: 2:S 1:S 4:R 0:R\ntick 2: tree 2 at 100 ms:{second}");
        replay(&instance, &log, None).unwrap().fault.unwrap_or_default()
    };
    assert_eq!(fault(" 2:S 1:S"), "");
    let cases = [
        ("", "2:charged is ticked here, and nothing more is recorded"),
        (" 1:S", "2:charged is ticked here, and what is recorded is 1:Fallback to SUCCESS"),
        (" 2:S", "1:Fallback to SUCCESS follows from what the leaves returned, and nothing more is recorded"),
        (
            " 2:S 1:S 4:S",
            "0:ReactiveSequence to SUCCESS follows from what the leaves returned, and nothing more is recorded",
        ),
        (
            " 2:S 1:S 0:S",
            "0:ReactiveSequence to SUCCESS is recorded, which does not follow from what the leaves returned",
        ),
        (
            " 2:S 1:F",
            "1:Fallback to SUCCESS follows from what the leaves returned, and 1:Fallback to FAILURE is recorded",
        ),
        (" 2:F 3:R 1:R", "4:drive to IDLE"),
    ];
    for (second, reason) in cases {
        let found = fault(second);
        assert!(found.starts_with("line 2: tick 2: ") && found.contains(reason), "{second}: {found}");
    }
}

/// The basic set, which images tick, halts an action before another one starts.
#[test]
fn the_log_of_a_robot_that_charges_replays_in_the_order_of_its_set_of_nodes() {
    let log = "tick 1: tree 1 at 0 ms: 2:S 1:S 4:R 0:R\n\
               tick 2: tree 2 at 1 ms: 2:S 1:S\n\
               tick 21: tree 3 at 20 ms: 2:F 4:I 3:R 1:R\n\
               tick 22: tree 4 at 21 ms:\n\
               tick 35: tree 5 at 34 ms: 3:S 1:S 4:R\n";
    let replay = replay(&instance(&file(PATROL)), log, None).unwrap();
    assert_eq!((replay.fault, replay.gaps.len(), replay.ticks.len()), (None, 0, 5));
}

#[test]
fn entries_that_are_missing_are_reported_and_the_rest_is_drawn() {
    let instance = instance(&file(PATROL));
    let log = "tick 1: tree 1 at 0 ms: 2:S 1:S 4:R 0:R\n\
               tick 9: tree 4 at 800 ms: 2:S 1:S 4:S 0:S and 2 more\n\
               tick 12: tree 5 at 900 ms: 2:S\n\
               tick 1: tree 1 at 0 ms: 2:S 1:S 4:R 0:R\n\
               tick 2: tree 3 at 0 ms: 2:S 1:S\n\
               tick 3: tree 3 at 0 ms: 2:S 1:S\n";
    let replay = replay(&instance, log, None).unwrap();
    let gaps = [
        "line 2: entries 2 to 3 are missing",
        "line 3: 2 changes of entry 4 are missing",
        "line 5: entry 2 is missing",
        "line 6: entry 3 comes after entry 3",
    ];
    assert_eq!((replay.gaps.as_slice(), replay.ticks.len()), (&gaps.map(str::to_owned)[..], 6));
    // After the robot has started again, its log is checked again.
    assert_eq!(replay.fault, None);
}

#[test]
fn a_log_that_is_not_the_trees_is_refused_with_the_reason() {
    let patrol = instance(&file(PATROL));
    let refused = |log: &[u8]| patrol.recorded("log", log, None).unwrap_err().to_string();
    assert_eq!(refused(b""), "log: the log is empty");
    assert!(refused(b"tick 1: heard the team\n").starts_with("log: no line is about a tree, like"));
    let line = |rest: &str| refused(format!("boot\ntick 1: tree {rest}").as_bytes());
    assert_eq!(line("1 at 0 ms: 5:S"), "log:2: \"5:S\": the tree has no node 5: there are 5, from 0");
    assert!(line("1 at 0 ms: 4:X").starts_with("log:2: \"4:X\" is no change of a node, like 3:S"));
    assert!(line("1 at 0").starts_with("log:2: \"tree 1 at 0\" is no entry"));
    assert_eq!(line("x at 0 ms: 4:S"), "log:2: \"x\" is no whole number");
    assert_eq!(line("0 at 0 ms: 4:S"), "log:2: entries of a tree are numbered from 1");
    assert_eq!(refused(&[0; 10]), "log: 10 bytes are not whole records of 9 bytes");
    let other = instance(&file("<Sequence><L name=\"a\" s=\"S\"/><L name=\"b\" s=\"R\"/></Sequence>"));
    let log = other.btlog(&dry_run(&other, 2, &[]).transitions);
    assert_eq!(refused(&log), "log: the log is of a tree of 3 nodes, and 'Main' has 5");
    assert_eq!(refused(&log[..30]), "log: the file ends within its head");
    assert!(
        patrol.recorded("log", &log, Some("R1")).unwrap_err().to_string().contains("only a log of lines")
    );
    // As many nodes, but another tree.
    let log = patrol.btlog(&dry_run(&patrol, 4, &[]).transitions);
    let other = instance(&file(
        "<Sequence><L name=\"a\" s=\"S\"/><Fallback><L name=\"b\" s=\"R\"/><L name=\"c\" s=\"S\"/></Fallback></Sequence>",
    ));
    let ticks = other.recorded("log", &log, None).unwrap();
    let fault = other.replay(&ticks).unwrap().fault.unwrap();
    assert_eq!(fault, "record 1: tick 1: 1:a is ticked here, and what is recorded is 2:Fallback to SUCCESS");
}

/// The trees of the recorded traces that have no conditions before nodes, with what a run changes.
fn runs(set: impl Fn(&mut DryRun<'_>)) -> Vec<(String, Instance, Vec<StatusChange>)> {
    let run = |mut trace: super::traces::Trace<'_>| {
        trace.settings.compat = false;
        set(&mut trace.settings);
        let record = trace.settings.run(&trace.instance).unwrap();
        (trace.title.to_owned(), trace.instance, record.transitions)
    };
    let is_plain =
        |text: &str| ["_skipIf", "_failureIf", "_successIf", "_while"].iter().all(|it| !text.contains(it));
    recorded().into_iter().filter(|trace| is_plain(trace.text)).map(run).collect()
}

#[test]
fn every_kind_of_tree_replays_as_it_ran() {
    let runs = runs(|_| ());
    assert!(runs.len() > 100, "only {} runs", runs.len());
    for (title, instance, transitions) in runs {
        let replay = replayed(&instance, &transitions);
        assert_eq!((replay.fault, replay.gaps.len()), (None, 0), "{title}");
        assert_eq!(replay.transitions, transitions, "{title}");
    }
}

#[test]
fn a_change_that_is_left_out_is_found_in_every_kind_of_tree() {
    let mut count = 0;
    // The changes of each tick have a time of their own.
    let apart = |settings: &mut DryRun<'_>| {
        settings.tick_ms = settings.tick_ms.max(1);
        (settings.mode, settings.halt_after) = (Mode::ExactlyOnce, None);
    };
    for (title, instance, transitions) in runs(apart) {
        for omitted in 0..transitions.len() {
            let at = |time: Instant| transitions.iter().filter(|other| other.time == time).count();
            // Where it is the only one, the tick is missing as a whole: entries have numbers for
            // that. Where a leaf is ticked twice in a tick, it may have returned the second status
            // at once.
            let left = transitions[omitted];
            let again = |next: &StatusChange| next.node == left.node && next.time == left.time;
            if at(left.time) < 2 || transitions.get(omitted + 1).is_some_and(again) {
                continue;
            }
            let rest: Vec<_> = (0..).zip(&transitions).filter(|(index, _)| *index != omitted).collect();
            let rest: Vec<_> = rest.into_iter().map(|(_, transition)| *transition).collect();
            assert!(replayed(&instance, &rest).fault.is_some(), "{title}: {left:?} is not missed");
            count += 1;
        }
    }
    assert!(count > 1000, "only {count} changes were left out");
}

/// Logs of robots come over lines that garble them.
#[test]
fn garbled_logs_are_refused_or_replayed_and_never_panic() {
    let instance = instance(&file(PATROL));
    let lines =
        "robot R1: tick 1: tree 1 at 0 ms: 2:S 1:S 4:R 0:R\nrobot R1: tick 2: tree 2 at 100 ms: 2:S 1:S\n";
    let records = dry_run(&instance, 6, &[]).transitions;
    let raw: Vec<u8> = records.iter().flat_map(|record| record.btlog(Instant(0))).collect();
    let seeds = [lines.as_bytes().to_vec(), instance.btlog(&records), raw];
    let mut random = host_sim::Random::new(2026);
    let mut outcomes = [0; 3];
    for _ in 0..5_000 {
        let mut log = seeds[random.below(seeds.len())].clone();
        for _ in 0..=random.below(3) {
            let at = random.below(log.len().max(1));
            if log.is_empty() {
                break;
            }
            match random.below(3) {
                0 => log[at] = random.below(256) as u8,
                1 => _ = log.remove(at),
                _ => log.truncate(at.max(1)),
            }
        }
        let outcome = match instance.recorded("log", &log, None) {
            Err(_) => 0,
            Ok(ticks) => 1 + usize::from(instance.replay(&ticks).unwrap().fault.is_some()),
        };
        outcomes[outcome] += 1;
    }
    assert!(outcomes.iter().all(|&count| count > 50), "refused, replayed, different: {outcomes:?}");
}
