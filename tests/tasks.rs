//! Tasks written as tables in TOML: flown, refused with their places, and exported.

use bumpalo::Bump;
use host_sim::manipulation::tables::IN_TURN;
use host_sim::task::{LEVELS, NAMES, TableMission, Trouble, built_in, level_table};
use host_sim::tree::{Document, Extras};
use std::num::NonZeroUsize;
use tests::package::{Package, assert_is_kept};

fn text(name: &str) -> &'static str {
    built_in(name).expect("it is built in")
}

fn mission<'a>(arena: &'a Bump, name: &str) -> TableMission<'a> {
    TableMission::parse(arena, name, text(name)).expect("it is sound")
}

#[test]
fn the_bottle_and_plate_of_the_file_is_that_of_the_paper() {
    let arena = Bump::new();
    let tables = mission(&arena, "bottle-and-plate").tables;
    assert_eq!(tables.roles()[0], IN_TURN[0]);
    // R2's file has the aim to bring the plate as well, which in the paper is a plain leaf.
    assert_eq!(tables.roles()[1].operators, IN_TURN[1].operators);
    assert_eq!(tables.roles()[1].facts, IN_TURN[1].facts);
    assert_eq!(tables.roles()[1].aims[0], IN_TURN[1].aims[0]);
}

#[test]
fn valves_are_closed_in_their_order_under_noise_that_the_tables_tell() {
    let arena = Bump::new();
    let valves = mission(&arena, "valves");
    let mut turns = 0;
    for seed in 0..200 {
        let flown = valves.fly(seed, Trouble { loss: Some(0.2), ..Trouble::default() }).expect("it fits");
        assert!(flown.success, "seed {seed}: {flown:?}");
        let of = |robot: usize| flown.operated.iter().filter(move |turn| turn.robot == robot);
        let (last, first) = (of(0).next_back().expect("R1 turns"), of(1).next().expect("R2 turns"));
        assert!(last.tick < first.tick, "seed {seed}: {flown:?}");
        assert!(flown.operated.iter().all(|turn| turn.policy.is_some()), "every turn is inferred");
        turns += flown.operated.len();
    }
    // Two valves, each after 1 / 0.8 turns on average.
    assert!((460..540).contains(&turns), "{turns} turns");
}

#[test]
fn bottle_and_plate_is_flown_from_its_file_at_every_level() {
    let arena = Bump::new();
    let task = mission(&arena, "bottle-and-plate");
    let levels = task.campaign(60, None).expect("it fits");
    assert_eq!(levels.iter().map(|level| level.level).collect::<Vec<_>>(), LEVELS);
    for level in &levels {
        assert!(level.success.count >= 57, "{level:?}");
    }
    assert!(levels[0].ticks.mean < levels[3].ticks.mean);
    let one = task.campaign(20, NonZeroUsize::new(1)).expect("it fits");
    assert_eq!(one, task.campaign(20, NonZeroUsize::new(3)).expect("it fits"), "threads change nothing");
}

#[test]
fn without_a_radio_no_robot_begins() {
    let arena = Bump::new();
    for name in NAMES {
        let flown = mission(&arena, name).fly(1, Trouble { loss: Some(1.0), ..Trouble::default() });
        let flown = flown.expect("it fits");
        assert!(!flown.believed && flown.operated.is_empty(), "{flown:?}");
        let told = mission(&arena, name).narrate(&flown);
        assert!(told.contains("R1 waits for R2: it was never heard"), "{told}");
    }
}

#[test]
fn a_flight_repeats_with_its_seed_and_is_told() {
    let arena = Bump::new();
    let valves = mission(&arena, "valves");
    let trouble = Trouble { wrong: Some(0.0), fails: Some(0.0), loss: None };
    let [one, two] = [0, 0].map(|_| valves.fly(7, trouble).expect("it fits"));
    assert_eq!(one, two);
    let told = valves.narrate(&one);
    assert!(told.contains("R1 begins turn, by pi1, P "), "{told}");
    assert!(told.contains("R2 begins turn, by pi2, P "), "{told}");
    assert!(told.contains("All goals are reached: "), "{told}");
}

#[test]
fn the_example_of_the_readme_opens_its_door() {
    let readme = include_str!("../host-sim/tasks/README.md");
    let text = readme.split("```toml").nth(1).and_then(|rest| rest.split("```").next()).expect("an example");
    let arena = Bump::new();
    let door = TableMission::parse(&arena, "door.toml", text).expect("it is sound");
    for seed in 0..50 {
        assert!(door.fly(seed, Trouble::default()).expect("it fits").success, "seed {seed}");
    }
}

/// What `valves` tells of a flight in which `from` is replaced by `to`, its actions left out.
fn end(from: &str, to: &str, trouble: Trouble) -> String {
    let text = text("valves");
    assert!(text.contains(from), "{from}");
    let arena = Bump::new();
    let text = text.replacen(from, to, 1);
    let task = TableMission::parse(&arena, "my.toml", &text).expect("it is sound");
    let flown = task.fly(0, trouble).expect("it fits");
    assert_eq!(flown.missing.is_empty(), flown.success, "{flown:?}");
    task.narrate(&flown).lines().skip_while(|line| line.starts_with("tick ")).skip(1).collect()
}

#[test]
fn what_keeps_a_robot_is_said_at_the_end() {
    let calm = Trouble { wrong: Some(0.0), fails: Some(0.0), loss: None };
    assert_eq!(end("title", "title", calm), "");
    let deaf = Trouble { loss: Some(1.0), ..calm };
    let deaf = end("title", "title", deaf);
    assert!(
        deaf.contains("  R1 waits for R2: it was never heard") && deaf.contains("  R2 waits for R1: "),
        "{deaf}"
    );
    let wrong = end("right = 0.9", "right = 0.5", calm);
    assert!(wrong.contains("  R1 is not sure of \"valve\": \"open\" 0."), "{wrong}");
    // R1 waits for R2 to turn its valve, and R2 for R1 to have closed its own.
    let waits = end("doing = [\"idle\"]", "doing = [\"turn\"]", calm);
    assert!(waits.contains("  R1 prefers to do nothing until \"R2 idle\" holds"), "{waits}");
    assert!(waits.contains("  R2 prefers to do nothing until \"inlet closed\" holds"), "{waits}");
    let goal = |state: &str| format!("[[goal]]\nrobot = \"R1\"\nfactor = \"valve\"\nis = [\"{state}\"]");
    let wrong = end(&goal("closed"), &goal("open"), calm);
    assert_eq!(wrong, "  R1: \"valve\" is in truth \"closed\"");
}

#[test]
fn an_action_that_another_one_makes_possible_needs_a_remedy() {
    let arena = Bump::new();
    let steps = r#"
title = "A robot fetches a crate"
limit = 60
[[robot]]
name = "porter"
factor = [{ name = "crate", states = ["shelf", "held", "bench"] }]
sensor = [{ name = "scales", reads = "crate", right = 0.9 }]
fact = [
    { name = "held", factor = "crate", is = ["held"] },
    { name = "there", factor = "crate", is = ["bench"] },
]
action = [
    { name = "idle" },
    { name = "lift", brings = "held", effect = [{ factor = "crate", to = "held" }] },
    { name = "put", needs = ["held"], brings = "bench", effect = [{ factor = "crate", to = "bench" }] },
]
aim = [{ name = "deliver", done = ["there"], prefer = { held = 1.0, bench = 2.0 } }]
REMEDY
[[goal]]
robot = "porter"
factor = "crate"
is = ["bench"]
"#;
    let told = |remedy: &str| {
        let text = steps.replace("REMEDY", remedy);
        let task = TableMission::parse(&arena, "steps.toml", &text).expect("it is sound");
        task.narrate(&task.fly(0, Trouble::default()).expect("it fits"))
    };
    let stuck = told("");
    assert!(
        stuck.ends_with(
            "  porter does not begin \"put\" until \"held\" holds: no remedy says what to do until then\n"
        ),
        "{stuck}"
    );
    let text = steps.replace("REMEDY", "");
    let task = TableMission::parse(&arena, "steps.toml", &text).expect("it is sound");
    let table = level_table(&task.campaign(2, None).expect("it fits"));
    let row: Vec<_> = table.lines().nth(1).expect("a row").split_whitespace().collect();
    assert_eq!(row[row.len() - 2..], ["-", "-"], "no means of no successes: {table}");
    let remedied = told("remedy = [{ missing = \"held\", prefer = \"held\" }]");
    assert!(
        remedied.contains("porter begins lift") && remedied.contains("All goals are reached"),
        "{remedied}"
    );
}

/// What is said about a task file in which `from` is replaced by `to`.
fn refusal(name: &str, from: &str, to: &str) -> String {
    let text = text(name);
    assert!(text.contains(from), "{from}");
    let arena = Bump::new();
    let refused = TableMission::parse(&arena, "my.toml", &text.replacen(from, to, 1));
    refused.map_or_else(|error| error.to_string(), |_| String::new())
}

#[test]
fn what_is_wrong_is_said_with_line_and_column() {
    let cases = [
        ("title = \"Two", "titel = \"Two", "my.toml:1:1: unknown field `titel`"),
        ("limit = 300", "limit = 0", "my.toml:2:9: limit = 0 is not between 1 and 100000"),
        (
            "prior = [0.5, 0.5]",
            "prior = [0.5, 0.4]",
            "my.toml:9:1: factor \"valve\": its prior is no distribution",
        ),
        (
            "start = \"open\"",
            "start = \"ajar\"",
            "my.toml:13:9: there is no state \"ajar\": there are open, closed",
        ),
        ("reads = \"valve\"", "reads = \"tap\"", "my.toml:17:9: there is no factor \"tap\": there are valve"),
        ("right = 0.9", "right = 1.9", "my.toml:15:1: sensor \"position\": its accuracy is no probability"),
        (
            "is = [\"closed\"]",
            "is = [\"shut\"]",
            "my.toml:23:7: there is no state \"shut\": there are open, closed",
        ),
        ("robot = \"R2\"", "robot = \"R3\"", "my.toml:27:9: there is no robot \"R3\": there are R1, R2"),
        (
            "robot = \"R2\"",
            "robot = \"R1\"",
            "my.toml:25:1: fact \"R2 idle\": it is about a robot that is no teammate",
        ),
        (
            "doing = [\"idle\"]",
            "doing = [\"nap\"]",
            "my.toml:28:10: there is no action \"nap\": there are turn, idle",
        ),
        (
            "needs = [\"R2 idle\"]",
            "needs = [\"R2\"]",
            "my.toml:32:10: there is no fact \"R2\": there are closed, R2 idle",
        ),
        (
            "needs = [\"R2 idle\"]",
            "needs = [\"closed\"]",
            "my.toml:30:1: action \"turn\": it both requires and forbids one fact",
        ),
        ("success = 0.8", "success = 8.0", "my.toml:36:11: success = 8 is not between 0 and 1"),
        ("to = \"closed\"", "to = \"target\"", ""),
        ("prefer = { closed = 1.0 }", "prefer = { shut = 1.0 }", "my.toml:50:19: there is no state \"shut\""),
        ("done = [\"closed\"]", "done = []", "my.toml:47:1: aim \"close\": nothing says when it is reached"),
        (
            "\"R1.valve\" = \"closed\"",
            "\"R1.tap\" = \"closed\"",
            "there is no factor \"tap\": there are valve",
        ),
        ("name = \"R2\"", "name = \"R1\"", "my.toml:53:8: two robots are called \"R1\""),
        ("name = \"R2 idle\"", "name = \"closed\"", "my.toml:26:8: two facts are called \"closed\""),
        ("name = \"idle\"", "name = \"turn\"", "two actions are called \"turn\""),
        ("[\"open\", \"closed\"]", "[\"open\", \"open\"]", "my.toml:11:19: two states are called \"open\""),
        ("name = \"R1\"", "name = \"R\\n1\"", "my.toml:7:8: a name is not one line of 1 to 60 characters"),
        ("title = \"Two", "title = \"\\tTwo", "my.toml:1:9: title is not one line of 1 to 120 characters"),
        ("is = [\"closed\"]", "is = []", "my.toml:21:8: `is` names no state, so the fact can never hold"),
        ("doing = [\"idle\"]", "doing = []", "my.toml:26:8: `doing` names no action"),
        ("limit = 300", "precision = -1", "my.toml:2:13: precision = -1: it is negative or not finite"),
        ("limit = 300", "confidence = 1", "my.toml:2:14: confidence = 1: it is not between 0.5 and 1"),
        ("closed = 1.0 }", "closed = 1e9 }", "closed = 1000000000 is not between -1000000 and 1000000"),
        (
            "[[robot.sensor]]\nname = \"position\"\nreads = \"valve\"\nright = 0.9\n",
            "",
            "a robot needs a [[robot.sensor]]",
        ),
    ];
    for (from, to, reason) in cases {
        let said = refusal("valves", from, to);
        assert!(said.contains(reason) && said.is_empty() == reason.is_empty(), "{to}: {said}");
    }
    let said = refusal("bottle-and-plate", "target = \"goal A\"", "target = \"goal D\"");
    assert!(said.contains("there is no state \"goal D\": there are elsewhere, goal A"), "{said}");
    let said = refusal("bottle-and-plate", "\"failure\", \"success\",", "\"failure\",");
    assert!(said.contains("the table lacks an entry per combination of states"), "{said}");
}

/// A task of robots that each have as many actions as they are told.
fn crowd(actions: &[usize]) -> String {
    let mut text = "title = 'A crowd'\n".to_owned();
    for (robot, &actions) in actions.iter().enumerate() {
        let others: String = (1..actions).map(|at| format!(", {{ name = 'a{at}', brings = 'b' }}")).collect();
        text += &format!(
            "[[robot]]\nname = 'r{robot}'\nfactor = [{{ name = 'f', states = ['a', 'b'] }}]\n\
             sensor = [{{ name = 's', reads = 'f', right = 0.9 }}]\nfact = [{{ name = 'b', factor = 'f', is = ['b'] }}]\n\
             action = [{{ name = 'idle' }}{others}]\naim = [{{ name = 'x', done = ['b'], prefer = {{ b = 1.0 }} }}]\n"
        );
    }
    text + "[[goal]]\nrobot = 'r0'\nfactor = 'f'\nis = ['b']\n"
}

#[test]
fn a_task_for_which_there_is_no_room_is_refused_with_its_size() {
    let arena = Bump::new();
    let said = |actions: &[usize]| {
        let read = TableMission::parse(&arena, "my.toml", &crowd(actions));
        read.map_or_else(
            |error| error.to_string(),
            |task| task.fly(0, Trouble::default()).err().map_or_else(String::new, |error| error.to_string()),
        )
    };
    assert_eq!(said(&[4, 4, 4, 4]), "", "the largest that fits");
    assert_eq!(said(&[16, 16]), "", "the largest that fits");
    assert!(said(&[2; 5]).ends_with(": a task has 1 to 4 robots, not 5"), "{}", said(&[2; 5]));
    let policies =
        "my.toml:2:1: the robots' actions make 16 x 16 x 2 = 512 joint policies: there is room for 256";
    assert_eq!(said(&[16, 16, 2]), policies);
    assert_eq!(said(&[17]), "my.toml:2:1: robot \"r0\": a robot has 1 to 16 actions");
}

/// Why the trees of a file are not those of the robots: the file of bottle and plate, changed.
fn refused_trees(from: &str, to: &str) -> String {
    let text = include_str!("../host-sim/tasks/bottle-and-plate.xml");
    assert!(text.contains(from), "{from}");
    let document = Document::parse("t.xml", &text.replacen(from, to, 1), &Extras::default());
    let arena = Bump::new();
    match mission(&arena, "bottle-and-plate").with_trees(&document.expect("it is XML")) {
        Ok(mission) => {
            mission.fly(0, Trouble::default()).map_or_else(|error| error.to_string(), |_| String::new())
        }
        Err(remarks) => remarks[0].to_string(),
    }
}

#[test]
fn a_tree_that_a_robot_cannot_have_is_refused_with_its_place() {
    assert_eq!(refused_trees("aim=\"hold\"", "aim=\"1\""), "", "an aim by its number");
    let cases = [
        (
            "aim=\"hold\"",
            "aim=\"2\"",
            "t.xml:9:11: error: there is no aim '2': there are hold, place, or 0 to 1",
        ),
        ("aim=\"hold\"", "", "t.xml:9:11: error: Pursue needs the port 'aim'"),
        ("<Do skill=\"finished\"/>", "<Do skill=\"256\"/>", "t.xml:16:9: error: there is no skill '256'"),
        ("<Do skill=\"finished\"/>", "<Do skill=\"1\"/>", "skill 0, which is finished, and no skill 1"),
        (
            "<Do skill=\"finished\"/>",
            "<Script code=\"a:=1\"/>",
            "t.xml:16:9: error: 'Script' is more than a leaf",
        ),
        ("<Has skill=\"finished\"/>", "<AlwaysSuccess/>", "t.xml:7:7: error: no tick can reach this node"),
        ("BehaviorTree ID=\"R2\"", "BehaviorTree ID=\"R4\"", "must name the tree to execute"),
    ];
    for (from, to, reason) in cases {
        let said = refused_trees(from, to);
        assert!(said.contains(reason), "{from} -> {to}: {said}");
    }
}

#[rustfmt::skip]
#[allow(dead_code, unreachable_pub, reason = "modules as they are written for other crates")]
mod exported {
    #[path = "../../firmware/src/tasks/bottle_and_plate.rs"]
    pub mod bottle_and_plate;
    #[path = "../exported/valves.rs"]
    pub mod valves;
}

#[test]
fn exported_tables_are_those_of_the_file_and_what_export_writes() {
    use exported::{bottle_and_plate, valves};
    let arena = Bump::new();
    let exports = [
        ("bottle-and-plate", &bottle_and_plate::TABLES, "../../firmware/src/tasks/bottle_and_plate.rs"),
        ("valves", &valves::TABLES, "valves.rs"),
    ];
    for (name, exported, file) in exports {
        let task = mission(&arena, name);
        assert_eq!(task.tables, *exported, "{name}");
        assert_is_kept(file, &task.to_rust());
    }
}

#[test]
fn exported_tables_compile_for_the_chip() {
    let arena = Bump::new();
    let sources = [
        ("lib.rs", "#![no_std]\npub mod bottle_and_plate;\npub mod valves;\n".to_owned()),
        ("bottle_and_plate.rs", mission(&arena, "bottle-and-plate").to_rust()),
        ("valves.rs", mission(&arena, "valves").to_rust()),
    ];
    Package::new(concat!(env!("CARGO_TARGET_TMPDIR"), "/tables"), sources).assert_compiles_for_the_chip();
}
