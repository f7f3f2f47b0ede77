//! The program as its users run it: what it prints where, and its exit status.

use assert_cmd::{Command, cargo_bin_cmd};
use predicates::prelude::*;
use predicates::str::{contains, is_empty, starts_with};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

fn host_sim(line: &str) -> Command {
    let mut command = cargo_bin_cmd!("host-sim");
    command.args(line.split_whitespace());
    command
}

/// A file with this text, for one test.
fn file(name: &str, text: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, text).expect("the folder for tests can be written");
    path
}

/// Input that cannot be used: status 2, a reason on standard error, nothing on standard output.
#[track_caller]
fn refuses(command: &mut Command, reason: &str) {
    command.assert().code(2).stdout(is_empty()).stderr(starts_with("error: ").and(contains(reason)));
}

#[test]
fn every_verb_explains_itself() {
    let help = host_sim("--help").assert().success().stdout(contains("Exit status:"));
    let help = String::from_utf8_lossy(&help.get_output().stdout).into_owned();
    let verbs =
        help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names: Vec<_> = verbs.filter_map(|line| line.strip_prefix("  ")?.split(' ').next()).collect();
    let names: Vec<_> = names.into_iter().filter(|name| !name.is_empty() && *name != "help").collect();
    assert!(names.len() >= 9, "{names:?}");
    for name in names {
        let help = host_sim(&format!("{name} --help")).assert().success().stderr(is_empty());
        help.stdout(
            contains(format!("Usage: host-sim {name} ")).or(contains(format!("Usage: host-sim {name}\n"))),
        );
    }
}

#[test]
fn a_flight_is_printed_as_json_and_its_end_is_the_exit_status() {
    let flight = |line: &str, status: i32| {
        let run = host_sim(line).assert().code(status).stderr(is_empty());
        serde_json::from_slice::<Value>(&run.get_output().stdout).expect("JSON")
    };
    let accomplished = flight("two-goals --json", 0);
    assert_eq!(accomplished, flight("run two-goals --json --seed 0", 0));
    assert_eq!(accomplished["outcome"], "together");
    assert_eq!(flight("two-goals --json --loss 1", 1)["outcome"], "unfinished");
}

#[test]
fn every_scenario_that_is_listed_can_be_read() {
    let list = host_sim("list").assert().success();
    let list = String::from_utf8_lossy(&list.get_output().stdout).into_owned();
    let names: Vec<_> = list.lines().filter_map(|line| line.split("  ").next()).collect();
    assert!(names.contains(&"factory") && names.len() >= 5, "{names:?}");
    for name in names {
        host_sim(&format!("{name} --loss 1 --quiet"))
            .assert()
            .code(vec![0, 1])
            .stderr(is_empty())
            .stdout(contains("no collisions").or(contains(" ticks, ")));
    }
}

#[test]
fn wrong_usage_and_unusable_input_have_status_two_and_a_reason() {
    refuses(&mut host_sim("run --loss 2"), "a probability is a number from 0 to 1");
    refuses(&mut host_sim("factry"), "did you mean 'factory'?");
    refuses(&mut host_sim("run nowhere.toml"), "nowhere.toml: ");
    let folder = folder("of-scenarios");
    fs::create_dir(&folder).expect("the folder for tests can be written");
    refuses(host_sim("run").arg(&folder), "`campaign` flies all scenarios of a folder");
    refuses(host_sim("infer").arg(&folder), "a folder, but a file is expected");
    refuses(&mut host_sim("run --seed -1"), "a seed is a whole number from 0 to 18446744073709551615");
    refuses(&mut host_sim("family sign --out x --count -1"), "-1 is not in 1..=1000000");
    refuses(&mut host_sim("campaign factory --seeds -1"), "-1 is not in 1..=1000000");
    let scenario = file("wide.toml", "title = 't'\nmap = '''\n1..G\n'''\nlimitt = 3\n");
    refuses(host_sim("run").arg(&scenario), "wide.toml:5:");
    let model = file("model.json", "{\n  \"A\": [1,,2]\n}");
    refuses(host_sim("infer").arg(&model), "model.json:2:11: expected value, found ','");
    let tree = file("tree.xml", "<root>\n<BehaviorTree ID='A'>");
    let check = host_sim("tree check").arg(&tree).assert().code(1).stderr(is_empty());
    check.stdout(contains("tree.xml:2:1: error: <BehaviorTree> is never closed"));
}

#[test]
fn a_model_is_run_and_a_table_of_a_campaign_printed() {
    let models = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("models");
    let run = host_sim("infer").arg(models.join("switch.json")).assert().success().stderr(is_empty());
    serde_json::from_slice::<Value>(&run.get_output().stdout).expect("JSON");
    for threads in [1, 3] {
        let campaign =
            host_sim(&format!("campaign two-goals --seeds 2 --json --threads {threads}")).assert().success();
        let report: Value = serde_json::from_slice(&campaign.get_output().stdout).expect("JSON");
        let once = host_sim("campaign two-goals --seeds 2 --json").output().expect("it runs");
        assert_eq!(report, serde_json::from_slice::<Value>(&once.stdout).expect("JSON"));
    }
}

#[test]
fn recorded_frames_tell_who_goes_where_when_and_how_surely() {
    let recording = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("flight.bin");
    let flown =
        host_sim("run two-goals --json --frames").arg(&recording).assert().success().stderr(is_empty());
    let flight: Value = serde_json::from_slice(&flown.get_output().stdout).expect("JSON");
    let frames = |arguments: &str| {
        let mut command = host_sim("frames");
        command.arg(&recording).args(arguments.split_whitespace());
        command
    };
    let told = frames("--mission two-goals").assert().success().stderr(is_empty());
    let told = String::from_utf8_lossy(&told.get_output().stdout).into_owned();
    let path = |robot: usize| {
        let cells = flight["robots"][robot]["path"].as_array().expect("a path");
        cells.iter().map(Value::to_string).collect::<Vec<_>>().join(" ")
    };
    for (robot, name) in ["R1", "R2"].into_iter().enumerate() {
        let line = told.lines().find(|line| line.trim_start().starts_with(name)).expect("a line");
        assert!(line.contains("in 6 steps, 6 of 6 moves made: ") && line.ends_with(&path(robot)), "{told}");
    }
    let probability = flight["robots"][0]["probability"].as_f64().expect("a number");
    let policies = flight["phases"][0]["policies"].as_array().expect("a list");
    let p = |number: &usize| policies[*number]["probability"].as_f64().expect("a number");
    let number = (0..policies.len()).rev().max_by(|one, other| p(one).total_cmp(&p(other))).expect("one");
    assert!(told.starts_with(&format!("round 0, R1 R2: joint policy {number}, one of ")), "{told}");
    let said: f64 =
        told.lines().next().and_then(|line| line.rsplit(' ').next()?.parse().ok()).expect("a number");
    assert!((said - probability).abs() < 0.003, "{told}");
    assert!(told.ends_with(&format!("{} frames read\n", flight["frames"]["sent"])), "{told}");

    assert!(!told.contains("two robots"), "{told}");

    let another = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("another-flight.bin");
    host_sim("run two-goals --loss 0.3 --seed 5 --frames").arg(&another).assert().success();
    let mut bytes = fs::read(&another).expect("it was written");
    let listen = |file: &Path| {
        let told = host_sim("frames --mission two-goals").arg(file).assert().success();
        String::from_utf8_lossy(&told.get_output().stdout).into_owned()
    };
    let told = listen(&another);
    assert!(!told.contains("two robots"), "frames that are passed on are no other's: {told}");
    bytes.extend(fs::read(&recording).expect("it was written"));
    fs::write(&another, bytes).expect("it can be written");
    let told = listen(&another);
    for name in ["R1", "R2"] {
        assert!(told.contains(&format!("\ntwo robots send as {name}: ")), "{told}");
    }

    refuses(&mut frames("--mission factory"), "no frame of the mission factory");
    refuses(&mut frames("--mission two-goals --key 00112233445566778899aabbccddeeff"), "wrong tag");
    refuses(&mut frames("--mission two-goals --key 0011"), "a key is 32 hexadecimal digits");
    refuses(&mut frames("--mission factry"), "did you mean 'factory'?");
    refuses(host_sim("frames --mission two-goals").arg(file("empty.bin", "")), "empty.bin: no frame");
    refuses(&mut host_sim("frames nowhere.bin --mission two-goals"), "nowhere.bin: ");
    refuses(&mut host_sim("run deliveries --frames x.bin"), "not of a series");
}

#[test]
fn recorded_frames_of_a_task_tell_who_does_what_and_how_surely() {
    let recording = file("valves.bin", "");
    let run = host_sim("run valves --seed 3 --json --frames").arg(&recording).assert().success();
    let flight: Value = serde_json::from_slice(&run.stderr(is_empty()).get_output().stdout).expect("JSON");
    let frames = |arguments: &str| {
        let mut command = host_sim("frames");
        command.arg(&recording).args(arguments.split(' '));
        command
    };
    let told = frames("--task valves").assert().success().stderr(is_empty());
    let told = String::from_utf8_lossy(&told.get_output().stdout).into_owned();
    assert!(told.starts_with("round 0, R1 R2: joint policy "), "{told}");
    for robot in ["R1", "R2"] {
        assert!(told.contains(&format!("\n  {robot}   begins turn: valve ")), "{told}");
    }
    assert!(told.ends_with(&format!("{} frames read\n", flight["frames"]["sent"])), "{told}");
    frames("--mission valves").assert().success().stdout(told);

    refuses(&mut frames("--task bottle-and-plate"), "no frame of the mission bottle-and-plate: ");
    refuses(&mut frames("--task two-goals"), "no frame of the mission two-goals: ");
    refuses(&mut frames("--task valves --key 00112233445566778899aabbccddeeff"), "wrong tag");
    refuses(&mut frames("--task valvs"), "did you mean 'valves'?");
    let broken = file("broken.toml", "[[robot]]\nname = 'R1'\n[[robot.factor]]\nname = 'valve'\n");
    refuses(frames("--task").arg(&broken), "broken.toml:");
    refuses(
        host_sim("frames --task valves").arg(file("none.bin", "")),
        "none.bin: no frame of the mission valves: it is empty",
    );
    refuses(&mut host_sim("run valves --frames no/such/folder/x.bin"), "no/such/folder/x.bin: ");
}

#[test]
fn a_task_is_slower_with_less_work_in_a_tick_and_does_the_same() {
    let text = include_str!("../tasks/valves.toml");
    let flown = |budget: &str| {
        let calm = text.replace("right = 0.9", "right = 0.9999").replace("success = 0.8", "success = 1.0");
        let path = file("budget.toml", &calm.replacen("limit = 300", &format!("limit = 300\n{budget}"), 1));
        let run = host_sim("run --json").arg(path).assert().success();
        let flight: Value = serde_json::from_slice(&run.get_output().stdout).expect("JSON");
        let turns = flight["operated"].as_array().expect("a list").iter();
        let turns: Vec<_> = turns.map(|turn| (turn["robot"].clone(), turn["operator"].clone())).collect();
        (flight["ticks"].as_u64().expect("a number"), turns)
    };
    let (free, slow) = (flown(""), flown("budget = 1"));
    assert!(slow.0 > free.0 + 10 && slow.1 == free.1, "{free:?} {slow:?}");
    let none = file("none.toml", &text.replacen("limit = 300", "budget = 0", 1));
    refuses(host_sim("run").arg(none), "none.toml:2:");
}

#[test]
fn a_page_is_written_for_a_robot_and_printed_without_its_keys() {
    const KEY: &str = "000102030405060708090a0b0c0d0e0f";
    let page = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("robot.bin");
    let write = |arguments: &str, key: &str| {
        let mut command = host_sim("provision factory");
        command.args(arguments.split_whitespace()).args(["--team-key", key, "-o"]).arg(&page);
        command
    };
    let commands = contains("probe-rs download").and(contains("0x08080000")).and(contains("0x080a0000"));
    write("--robot 2 --epoch 7 --board stm32f405", KEY).assert().success().stdout(commands);
    let first = fs::read(&page).expect("it was written");
    let key_file = file("team.key", &format!("{KEY}\n"));
    write("--robot R2 --epoch 7", &key_file.display().to_string()).assert().success().stderr(is_empty());
    assert_eq!(fs::read(&page).expect("it was written"), first, "by name, and with the key from a file");

    let shown = host_sim("provision --show").arg(&page).assert().success().stderr(is_empty());
    let shown = String::from_utf8_lossy(&shown.get_output().stdout).into_owned();
    assert!(shown.contains("2 of 3") && shown.contains("at least 7") && shown.contains("hidden"), "{shown}");
    assert!(!first.windows(16).any(|bytes| (0..16).eq(bytes.iter().copied())), "the team's own key");

    refuses(&mut write("--robot 4", KEY), "factory: no robot 4: there are R1, R2, R3, or 1 to 3");
    refuses(&mut write("--robot 1", "0001"), "0001: ");
    let cut = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("cut.bin");
    fs::write(&cut, &first[..first.len() - 1]).expect("the folder for tests can be written");
    refuses(host_sim("provision --show").arg(&cut), "wrong checksum: damaged, or a write was cut off");
}

/// What the robot would refuse, with its motors off, is refused before it is written.
#[test]
fn a_page_for_the_smallest_board_has_given_paths_and_fits_a_kilobyte() {
    let page = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("small.bin");
    let write = |mission: &str| {
        let mut command = host_sim(&format!("provision {mission} --robot 1 --board nrf51822"));
        command.args(["--team-key", "000102030405060708090a0b0c0d0e0f", "-o"]).arg(&page);
        command
    };
    let commands = contains("--chip nRF51822_xxAC").and(contains("0x0000f800")).and(contains("0x0000fc00"));
    write("two-goals").assert().success().stdout(commands);
    let _ = fs::remove_file(&page);
    refuses(
        &mut write("factory"),
        "factory, board nrf51822: a robot without a planner needs a mission with paths",
    );
    refuses(&mut write("courtyard"), "courtyard, board nrf51822: ");
    assert!(!page.exists(), "nothing was written");
}

#[test]
fn the_page_of_a_robot_with_a_task_has_its_tree() {
    let page = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("task-robot.bin");
    let write = |arguments: &str| {
        let mut command =
            host_sim("provision bottle-and-plate --team-key 000102030405060708090a0b0c0d0e0f -o");
        command.arg(&page).args(arguments.split_whitespace());
        command
    };
    let shown = || {
        let shown = host_sim("provision --show").arg(&page).assert().success().stderr(is_empty());
        String::from_utf8_lossy(&shown.get_output().stdout).into_owned()
    };
    write("--robot 2").assert().success();
    let aims = "  Sequence(3)\n                 Inference aim 0\n                 Inference aim 1\n";
    let text = shown();
    assert!(text.contains("2 of 2") && text.contains("6 nodes") && text.contains(aims), "{text}");

    let trees = concat!(env!("CARGO_MANIFEST_DIR"), "/tasks/bottle-and-plate.xml");
    write(&format!("--robot R2 --task-tree {trees}")).assert().success();
    let text = shown();
    assert!(text.contains("RetryUntilSuccessful(5)\n") && text.contains("Delay(2 ms)\n"), "{text}");
    assert!(text.contains("Condition fact 2\n"), "by the name of the fact: {text}");

    let other =
        file("other-trees.xml", &fs::read_to_string(trees).unwrap().replace("aim=\"bring\"", "aim=\"fly\""));
    let other = other.display();
    let reason = "other-trees.xml:30:13: error: there is no aim 'fly': there are hold, bring, or 0 to 1";
    refuses(&mut write(&format!("--robot R2 --task-tree {other}")), reason);
    refuses(&mut write("--robot R3"), "bottle-and-plate: no robot R3: there are R1, R2, or 1 to 2");
    let two_goals = "provision two-goals --robot 1 -o nowhere.bin --task-tree trees.xml";
    refuses(&mut host_sim(two_goals), "two-goals: --task-tree is for tasks");
    refuses(&mut host_sim("run factory --task-tree trees.xml"), "factory: a scenario is flown without");
}

#[test]
fn nothing_to_do_is_its_own_word_and_success() {
    let scenario = file("there.toml", "title = 't'\nmap = '''\n1..\n2..\n'''\ngoals = [0, 3]\n");
    let run = host_sim("run --quiet").arg(&scenario).assert().success();
    run.stdout(contains("there was nothing to do"));
    let campaign = host_sim("campaign --seeds 2 --disturbance none --json").arg(&scenario).assert().success();
    let report: Value = serde_json::from_slice(&campaign.get_output().stdout).expect("JSON");
    assert_eq!(report["rows"][0]["summaries"][0]["accomplished"]["count"], 0, "no points");
}

#[test]
fn what_a_robot_waits_for_is_printed() {
    let run = host_sim("run two-goals --loss 1").assert().code(1);
    run.stdout(contains("R1 stands on 28: waiting for R2: it was never heard, so it may be anywhere"));
}

#[test]
fn a_flight_is_watched_with_a_rule_in_place_of_inference() {
    let flown = |arguments: &str| {
        let run = host_sim(&format!("run scenarios/sign.toml --json {arguments}")).assert().success();
        serde_json::from_slice::<Value>(&run.get_output().stdout).expect("JSON")
    };
    let (inference, rule) = (flown(""), flown("--decider pessimistic"));
    assert_ne!(inference["robots"], rule["robots"]);
    refuses(
        &mut host_sim("run factory --decider likeliest"),
        "factory: nothing is unknown, which --decider is for",
    );
    refuses(&mut host_sim("run sign --decider clever"), "there is no 'clever': there are no-branching, ");
    refuses(
        &mut host_sim("hil sign --decider likeliest"),
        "--decider likeliest: the image decides by inference",
    );
}

#[test]
fn a_task_is_flown_and_exported_without_what_is_for_scenarios_and_models() {
    for option in ["--log x.csv", "--tree conventional"] {
        let reason = "valves: a task is flown without --tree, --decider, --disturbance, --log and --tree-log";
        refuses(&mut host_sim(&format!("run valves {option}")), reason);
    }
    for option in ["--name x", "--dense"] {
        let reason = "valves: a task is exported without --name and --dense";
        refuses(&mut host_sim(&format!("export valves {option}")), reason);
    }
    refuses(&mut host_sim("run valvs"), "did you mean 'valves'? built in are factory");
}

#[test]
fn what_keeps_a_robot_of_a_task_is_printed_after_the_outcome() {
    let outcome = "The robots are not done: 300 ticks, 0 actions, 600 frames of which 600 were lost.\n";
    let run = host_sim("run valves --loss 1").assert().code(1);
    let first = "R1 waits for R2: it was never heard, so it may be anywhere";
    let second = "R2 waits for R1: it is lost, and the others are no quorum";
    run.stdout(format!("{outcome}  {first}\n  {second}\n"));
    host_sim("run valves --loss 1 --quiet").assert().code(1).stdout(outcome);
}

#[test]
fn output_that_is_not_read_to_its_end_is_no_error() {
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin!("host-sim"));
    command
        .args(["factory", "--json"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped());
    let mut child = command.spawn().expect("it starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!((output.status.code(), String::from_utf8_lossy(&output.stderr).as_ref()), (Some(0), ""));
}

/// A folder that does not exist yet, for one test.
fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    if path.exists() {
        fs::remove_dir_all(&path).expect("the folder for tests can be written");
    }
    path
}

#[test]
fn random_missions_are_drawn_and_flown_as_a_campaign() {
    let one = host_sim("missions --robots 2 --seed 11").assert().success().stderr(is_empty());
    let drawn = String::from_utf8_lossy(&one.get_output().stdout).into_owned();
    assert!(drawn.starts_with("title = \"Random mission 11 with 2 robots\"\n"), "{drawn}");
    let out = folder("missions");
    let line = "missions --robots 2 --count 3 --seed 9 --out";
    host_sim(line).arg(&out).assert().success().stdout(contains("3 missions in "));
    let names = fs::read_dir(&out).expect("a folder").map(|entry| entry.expect("a file").file_name());
    let mut names: Vec<_> = names.collect();
    names.sort();
    assert_eq!(names, ["09.toml", "10.toml", "11.toml"]);
    assert_eq!(fs::read_to_string(out.join("11.toml")).expect("a file"), drawn);
    refuses(host_sim(line).arg(&out), "not empty");

    let campaign = |options: &str| {
        let line = format!("campaign --disturbance none --json {options}");
        let flown = host_sim(&line).arg(&out).assert().success();
        serde_json::from_slice::<Value>(&flown.get_output().stdout).expect("JSON")
    };
    let flown = campaign("--tree inference");
    let summary = &flown["rows"][0]["summaries"][0];
    let counts = (&summary["accomplished"]["count"], &summary["accomplished"]["of"], &summary["missed"]);
    assert_eq!(counts, (&Value::from(3), &Value::from(3), &Value::Array(Vec::new())));
    let alone = |(seed, name): (usize, &str)| {
        let line = format!("run --disturbance none --json --seed {seed}");
        let flown = host_sim(&line).arg(out.join(name)).assert().success();
        let record: Value = serde_json::from_slice(&flown.get_output().stdout).expect("JSON");
        record["ticks"].as_f64().expect("a number")
    };
    let sum: f64 = ["09.toml", "10.toml", "11.toml"].into_iter().enumerate().map(alone).sum();
    assert_eq!(summary["reported"]["mean"].as_f64(), Some(sum / 3.0), "each file is flown once");
    let slow = campaign("--tree image --budget 1");
    let ticks =
        |flown: &Value| flown["rows"][0]["summaries"][0]["reported"]["mean"].as_f64().expect("a number");
    assert!(ticks(&slow) > ticks(&flown) + 3.0, "a unit a tick: {} and {}", ticks(&slow), ticks(&flown));
    assert_eq!(campaign("--tree image --seeds 5")["rows"][0]["summaries"][0]["accomplished"]["of"], 5);
}

#[test]
fn missions_of_a_family_are_listed_drawn_and_refused_with_a_reason() {
    let names = ["sign", "rooms", "gates", "search", "floor", "far-sign"];
    let list = host_sim("family").assert().success().stderr(is_empty());
    let list = String::from_utf8_lossy(&list.get_output().stdout).into_owned();
    assert!(list.lines().map(|line| line.split(' ').next()).eq(names.map(Some)), "{list}");
    let help = names.into_iter().map(|name| contains(format!("- {name}:")));
    help.fold(host_sim("family --help").assert().success(), assert_cmd::assert::Assert::stdout);
    let one = host_sim("family sign --right 0.9 --seed 10").assert().success().stderr(is_empty());
    let drawn = String::from_utf8_lossy(&one.get_output().stdout).into_owned();
    assert!(drawn.starts_with("title = \"Random mission 10: ") && drawn.contains("right = 0.9"), "{drawn}");
    let out = folder("family");
    let line = "family sign --right 0.9 --count 2 --seed 9 --out";
    host_sim(line).arg(&out).assert().success().stdout(contains("2 missions in "));
    assert_eq!(fs::read_to_string(out.join("10.toml")).expect("a file"), drawn);
    host_sim("run --quiet").arg(out.join("09.toml")).assert().success();
    refuses(host_sim(line).arg(&out), "not empty");
    refuses(&mut host_sim("family sing"), "[possible values: sign, rooms, gates, search, floor, far-sign]");
    refuses(host_sim("family --out").arg(&out), "name one of sign, rooms, gates, search, floor, far-sign");
    refuses(&mut host_sim("family sign --robots 9"), "a number of robots is 1 to 8");
    refuses(&mut host_sim("family sign --need 0"), "a number of goals is 1 or more");
    refuses(&mut host_sim("family sign --right 1.1"), "a probability is a number from 0 to 1");
    for right in ["0", "0.5", "-1"] {
        let line = format!("family sign --right {right}");
        refuses(&mut host_sim(&line), "a probability ");
    }
    refuses(&mut host_sim("family gates --need 2"), "gates: a need of 2..2 goals");
    refuses(&mut host_sim("family sign --robots 1"), "sign: a need of 2..2 goals");
    refuses(&mut host_sim("family sign --count 2"), "--out");
}

#[test]
fn trees_that_know_of_no_unknowns_say_so_and_ablations_are_for_missions_with_unknowns() {
    let scenarios = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let flown = |tree: &str, name: &str| {
        let file = scenarios.join(name);
        host_sim(&format!("run --quiet --tree {tree}")).arg(file).assert().code(vec![0, 1])
    };
    flown("conventional", "sign.toml")
        .stderr(starts_with("note: a conventional tree knows of no [[unknown]]"));
    flown("inference", "sign.toml").stderr(is_empty());
    flown("conventional", "two-goals.toml").stderr(is_empty());
    refuses(
        &mut host_sim("campaign two-goals --ablate"),
        "two-goals: --ablate is for missions with an [[unknown]]",
    );
    let help = host_sim("campaign --help").assert().success();
    let help = String::from_utf8_lossy(&help.get_output().stdout).into_owned();
    let at = |text: &str| help.find(text).expect("it is told");
    assert!(at("all` are the `parts`") < at("  matching ") && at("  matching ") < at("and the `rules`"));
    assert!(at("and the `rules`") < at("  free-space "));
}

#[test]
fn missions_that_cannot_be_drawn_or_flown_are_refused_with_a_reason() {
    refuses(&mut host_sim("missions --robots 9"), "a number of robots is 1 to 8");
    refuses(&mut host_sim("missions --size 33x32"), "a size is WxH or WxH..WxH, with 2 to 1024 cells");
    refuses(&mut host_sim("missions --walls 1"), "a share of walls is a number from 0 to below 1");
    refuses(&mut host_sim("missions --goals 17"), "17 is not in 1..=16");
    refuses(&mut host_sim("missions --owned --goals 2"), "cannot be used with");
    refuses(&mut host_sim("missions --map factory --walls 0.1"), "cannot be used with");
    refuses(&mut host_sim("missions --count 2"), "--out");
    refuses(&mut host_sim("missions --size 2x2 --robots 5"), "none of 10000 draws with seed 0");
    refuses(&mut host_sim("missions --robots 8 --owned --solvable"), "more than 1000000 joint states");
    refuses(&mut host_sim("missions --map nowhere.toml"), "nowhere.toml: ");
    let empty = folder("no-missions");
    fs::create_dir(&empty).expect("the folder for tests can be written");
    refuses(host_sim("campaign").arg(&empty), "no file in this folder ends in .toml");
    fs::write(empty.join("a.toml"), "title = 't'\nmap = '1.'\n").expect("a file");
    refuses(host_sim("campaign").arg(&empty), "a.toml:");
    let wide = file("wider.toml", &format!("title = 't'\nmap = '1{}G'\n", ".".repeat(63)));
    refuses(
        host_sim("campaign --tree image --seeds 1").arg(wide),
        "wider.toml: 65 cells, but this tree flies on at most 64",
    );
}

#[cfg(unix)]
mod emulated {
    use super::*;
    use std::os::unix::fs::PermissionsExt;
    use std::path::Path;
    use std::time::{Duration, Instant};

    /// An emulator that writes down its process and then does nothing.
    const IDLE: &str =
        "#!/bin/sh\n[ \"$1\" = --version ] && exit 0\necho $$ > \"$TMPDIR/process\"\nexec sleep 60\n";

    /// A folder with this program as `qemu-system-arm`, and one for what the simulator leaves.
    fn with_emulator(name: &str, program: &str) -> (PathBuf, PathBuf) {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = fs::remove_dir_all(&folder);
        let (programs, left) = (folder.join("programs"), folder.join("left"));
        for folder in [&programs, &left] {
            fs::create_dir_all(folder).expect("the folder for tests can be written");
        }
        let emulator = programs.join("qemu-system-arm");
        fs::write(&emulator, program).expect("the folder for tests can be written");
        fs::set_permissions(&emulator, fs::Permissions::from_mode(0o755)).expect("it is ours");
        (programs, left)
    }

    fn hil(line: &str, programs: &Path, left: &Path) -> Command {
        let mut command = host_sim(&format!("hil {line}"));
        let path = std::env::var("PATH").unwrap_or_default();
        command.env("PATH", format!("{}:{path}", programs.display())).env("TMPDIR", left);
        command
    }

    fn until(what: &str, mut is_so: impl FnMut() -> bool) {
        let since = Instant::now();
        while !is_so() {
            assert!(since.elapsed() < Duration::from_secs(30), "{what}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    #[test]
    fn what_cannot_be_emulated_is_refused_with_the_reason() {
        let image = file("no-image.elf", "");
        let line = |rest: &str| host_sim(&format!("hil {rest} --image {}", image.display()));
        refuses(line("two-goals").env("PATH", ""), "install the package qemu-system-arm");
        refuses(&mut line("two-goals --restart R3@4"), "no robot is called R3; there are R1, R2");
        refuses(&mut line("two-goals --restart R2"), "write ROBOT@TICK");
        refuses(&mut line("two-goals --restart R2@soon"), "soon is no tick");
        refuses(&mut line("two-goals --robots 3"), "two-goals has 1 to 2");
        refuses(&mut line("two-goals --robots 0"), "two-goals has 1 to 2");
        refuses(&mut line("two-goals --tree conventional"), "the image has the tree with inference");
        refuses(&mut line("valves --restart R1@3"), "a task is flown without --robots, --restart");
        let (programs, left) = with_emulator("hil-refused", IDLE);
        refuses(&mut hil("two-goals --image nowhere.elf", &programs, &left), "nowhere.elf: ");
        let image = image.display();
        refuses(&mut hil(&format!("warehouse --image {image}"), &programs, &left), "room for 64");
        refuses(
            &mut hil(&format!("valves --image {image}"), &programs, &left),
            "the tables of bottle-and-plate",
        );
        refuses(&mut hil(&format!("deliveries --image {image}"), &programs, &left), "room for 64");
        assert_eq!(fs::read_dir(&left).expect("it is there").count(), 0);
    }

    #[test]
    fn an_emulator_that_ends_is_reported_and_its_folder_goes() {
        let (programs, left) = with_emulator("hil-ends", "#!/bin/sh\n[ \"$1\" = --version ] || exit 3\n");
        let image = file("an-image.elf", "");
        let mut command = hil(&format!("two-goals --image {}", image.display()), &programs, &left);
        refuses(&mut command, "the machine of R1 does not start: qemu-system-arm ended with exit status: 3");
        assert_eq!(fs::read_dir(&left).expect("it is there").count(), 0);
    }

    #[test]
    fn a_simulator_that_is_killed_or_ended_leaves_nothing_behind() {
        for signal in ["-KILL", "-TERM"] {
            let (programs, left) = with_emulator(&format!("hil-killed{signal}"), IDLE);
            let image = file("some-image.elf", "");
            let path = std::env::var("PATH").unwrap_or_default();
            let mut simulator = std::process::Command::new(assert_cmd::cargo::cargo_bin!("host-sim"))
                .args(["hil", "two-goals", "--image"])
                .arg(&image)
                .env("PATH", format!("{}:{path}", programs.display()))
                .env("TMPDIR", &left)
                .spawn()
                .expect("it is built");
            let process = left.join("process");
            let written = || fs::read_to_string(&process).is_ok_and(|text| text.ends_with('\n'));
            until("no emulator starts", written);
            let number = fs::read_to_string(&process).expect("it is written").trim().to_owned();
            fs::remove_file(&process).expect("it is ours");
            let run =
                |line: &str| std::process::Command::new("sh").args(["-c", line]).status().expect("a shell");
            assert!(run(&format!("kill {signal} {}", simulator.id())).success());
            simulator.wait().expect("it is a child");
            until("the emulator goes on", || !run(&format!("kill -0 {number} 2>/dev/null")).success());
            until("a folder is left", || fs::read_dir(&left).expect("it is there").count() == 0);
        }
    }
}
