use super::*;

/// A sound scenario; the cases below each spoil one line of it.
const SOUND: &str = "\
title = 'two robots'
limit = 100
map = '''
....
.#..
....
'''
goals = [3, 11]
[[robot]]
start = 0
paths = [[0, 1, 2, 3]]
[[robot]]
name = 'Bo'
start = 8
paths = [[8, 9, 10, 11]]
[radio]
loss = 0.1
delay = 1
[[event]]
tick = 4
block = 7
[inference]
precision = 16.0
";

fn refusal(name: &str, text: &str) -> String {
    Scenario::parse(name, text).map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
}

#[test]
fn the_sound_one_is_not() {
    assert_eq!(refusal("sound.toml", SOUND), "accepted");
}

#[test]
fn with_file_line_and_reason() {
    #[rustfmt::skip]
    let cases = [
        ("limit = 100", "limit = ", "2", "string values must be quoted"),
        ("limit = 100", "limits = 100", "2", "unknown field `limits`, expected one of `title`"),
        ("limit = 100", "limit = 0", "2", "limit = 0 is not between 1 and 100000"),
        ("limit = 100", "limit = 2.5", "2", "expected a whole number"),
        ("limit = 100", "view = 9", "2", "view = 9 is not between 1 and 8"),
        ("'two robots'", "''", "1", "title is not one line of 1 to 120 characters"),
        (".#..", ".#.", "5", "row 1 of the map has 3 cells, but row 0 has 4"),
        (".#..", ".#x.", "5", "row 1, column 2 of the map: 'x' is not a map character"),
        (".#..", ".#1.", "10", "the map draws R1 as '1' already"),
        (".#..", ".#1.\n1...", "6", "row 2, column 0 of the map: robot 1 is drawn at 6 already"),
        (".#..", ".#G.", "8", "the map draws goals as 'G' already"),
        ("[[event]]", "[[unknown]]\nblocks = [[5]]\nprior = [0.5, 0.5]\n[[event]]", "20", "a cell of an unknown 5 is blocked"),
        ("[[event]]", "[[unknown]]\nblocks = [[12]]\nprior = [0.5, 0.5]\n[[event]]", "20", "a cell of an unknown 12 is outside"),
        ("[[event]]", "[[unknown]]\nserves = [[3], [6]]\nprior = [0.5, 0.5]\n[[event]]", "20", "6 is no goal"),
        ("[[event]]", "[[unknown]]\ntakes = [[3], [6]]\nprior = [0.5, 0.5]\nstart = 1\n[[event]]", "20", "6 is no goal"),
        ("[[event]]", "[[unknown]]\ntakes = [[3], [11]]\nprior = [0.5, 0.5]\n[[event]]", "19", "a stranger takes a goal"),
        ("[[event]]", "[[unknown]]\ntakes = [[3], [11]]\nprior = [0.5, 0.5]\nstart = 0\n[[event]]", "22", "another robot starts on 0"),
        ("[[event]]", "[[unknown]]\ntakes = [[3], [11]]\nprior = [0.5, 0.5]\nstart = 1\nrange = 1\n[[event]]", "23", "range = 1 is not between 2"),
        ("[[event]]", "[[unknown]]\nserves = [[3], [11]]\nprior = [0.5, 0.5]\nstart = 1\n[[event]]", "22", "only a stranger"),
        ("[[event]]", "[[unknown]]\nserves = [[3], [11]]\nprior = [0.5, 0.6]\n[[event]]", "21", "the probabilities of the values add up to 1.1"),
        ("[[event]]", "[[unknown]]\nblocks = [[6]]\n[[event]]", "19", "missing field `prior`"),
        ("limit = 100", "need = 0", "2", "need = 0 is not between 1 and 2"),
        ("limit = 100", "need = 3", "2", "need = 3 is not between 1 and 2"),
        ("limit = 100", "need = 'all'", "2", "expected a whole number"),
        ("limit = 100", "forget = -1", "2", "forget = -1 is not between 0 and 65535"),
        ("limit = 100", "forget = 70000", "2", "forget = 70000 is not between 0 and 65535"),
        ("limit = 100", "wait_for_charging = 1", "2", "expected a boolean"),
        ("start = 0", "start = 0\ngoal = 5", "11", "goal 5 is blocked on the map"),
        ("start = 0", "start = 0\ngoal = 12", "11", "goal 12 is outside the map, whose cells are 0 to 11"),
        ("precision = 16.0", "policies = 0", "23", "policies = 0 is not between 1 and 16"),
        ("precision = 16.0", "policies = 17", "23", "policies = 17 is not between 1 and 16"),
        ("precision = 16.0", "budget = 0", "23", "budget = 0 is not between 1 and 1000000000"),
        ("precision = 16.0", "haste = 2.0", "23", "unknown field `haste`"),
        ("block = 7", "clear = 5", "21", "clear 5 is blocked on the map"),
        ("block = 7", "clear = 12", "21", "clear 12 is outside the map"),
        ("block = 7", "clear = 7\nwho = 'Bo'", "22", "an obstacle is nobody's: leave `who` out"),
        ("block = 7", "block = 7\nclear = 7", "19", "say what happens: exactly one of block, block_path_of, clear"),
        ("block = 7", "block_path_of = 'Al'", "21", "no robot is called \"Al\": there are R1, Bo"),
        ("block = 7", "block_path_of = 7", "21", "expected a string"),
        ("block = 7", "block_path_of = 'Bo'\nfor = 3", "22", "only stop and freeze take a time: leave `for` out"),
        ("[3, 11]", "[3, 3]", "8", "goal 3 is listed twice"),
        ("[3, 11]", "[3,\n12]", "9", "goal 12 is outside the map, whose cells are 0 to 11"),
        ("[3, 11]", "[3, 11, 5]", "8", "goal 5 is blocked on the map"),
        ("[3, 11]", "[-1, 11]", "8", "goal -1 is outside the map"),
        ("start = 0", "start = 5", "10", "start 5 is blocked on the map"),
        ("start = 0", "start = 70000", "10", "start 70000 is outside the map"),
        ("start = 0", "battery = 50", "9", "R1 has no start: write start = CELL, or draw '1' on the map"),
        ("start = 8\npaths = [[8", "start = 0\npaths = [[0, 1, 2, 3], [0, 4, 8", "12", "Bo starts at 0, where R1 stands already"),
        ("'Bo'", "'R1'", "12", "two robots are called R1"),
        ("'Bo'", r#""B\no""#, "13", "name is not one line of 1 to 12 characters"),
        ("[[0, 1, 2, 3]]", "[[0, 1, 2]]", "11", "the path ends at 2, which is no goal"),
        ("[[0, 1, 2, 3]]", "[[0, 2, 3]]", "11", "0 and 2 on the path are no neighbours"),
        ("[[0, 1, 2, 3]]", "[[1, 2, 3]]", "11", "no path begins at 0, where the robot starts"),
        ("[[0, 1, 2, 3]]", "[[0, 1, 5]]", "11", "path cell 5 is blocked on the map"),
        ("[[0, 1, 2, 3]]", "[[0, 1, 99]]", "11", "path cell 99 is outside the map"),
        ("[[0, 1, 2, 3]]", "[[]]", "11", "the path has no cells"),
        ("[[0, 1, 2, 3]]", "[]", "11", "0 paths listed: give 1 to 16"),
        ("paths = [[0, 1, 2, 3]]", "", "15", "R1 has no paths: list them for every robot or for none"),
        ("loss = 0.1", "loss = 1.5", "17", "loss = 1.5 is not between 0 and 1"),
        ("loss = 0.1", "loss = nan", "17", "loss = NaN is not between 0 and 1"),
        ("delay = 1", "delay = 0", "18", "delay = 0 is not between 1 and 1000"),
        ("delay = 1", "jitter = 1", "18", "unknown field `jitter`"),
        ("block = 7", "block = 8", "21", "8 is where Bo starts"),
        ("block = 7", "block = 12", "21", "block 12 is outside the map"),
        ("tick = 4", "at = 4", "19", "say when it happens"),
        ("tick = 4", "robot = 'Al'\nat = 4", "20", "no robot is called \"Al\": there are R1, Bo"),
        ("tick = 4\nblock = 7", "tick = 4", "19", "say what happens: exactly one of block, block_path_of, clear, charge, visit, stop and freeze"),
        ("tick = 4", "tick = 4\nplan = 2", "19", "say when it happens"),
        ("tick = 4", "plan = 0", "20", "plan = 0 is not between 1 and 1000"),
        ("tick = 4", "plan = 1\nmoves = 65", "21", "moves = 65 is not between 0 and 64"),
        ("tick = 4", "tick = 4\nmoves = 1", "21", "moves are those of a plan: write plan = N with it"),
        ("block = 7", "block = 7\nstop = true", "19", "say what happens: exactly one"),
        ("block = 7", "block = 7\nwho = 'Bo'", "22", "an obstacle is nobody's: leave `who` out"),
        (
            "block = 7",
            "who = 'Bo'\nfreeze = 'wheels'",
            "22",
            "no device is called \"wheels\": there are localiser and drive",
        ),
        ("block = 7", "block = 7\nfor = 3", "22", "only stop and freeze take a time: leave `for` out"),
        ("block = 7", "charge = 20", "19", "say whom it concerns: who = \"NAME\""),
        ("block = 7", "charge = 101\nwho = 'Bo'", "21", "charge = 101 is not between 0 and 100"),
        ("block = 7", "visit = 5\nwho = 'Bo'", "21", "way-point 5 is blocked on the map"),
        ("block = 7", "visit = 12\nwho = 'Bo'", "21", "way-point 12 is outside the map"),
        ("block = 7", "visit = 7\nwho = 'Al'", "22", "no robot is called \"Al\": there are R1, Bo"),
        ("block = 7", "stop = false\nwho = 'Bo'", "21", "stop = false says nothing"),
        ("block = 7", "stop = true\nfor = 0\nwho = 'Bo'", "22", "for = 0 is not between 1 and 100000"),
        ("block = 7", "stop = 1\nwho = 'Bo'", "21", "expected a boolean"),
        ("start = 0", "start = 0\ncharger = 5", "11", "charger 5 is blocked on the map"),
        ("start = 0", "start = 0\ncharger = 12", "11", "charger 12 is outside the map"),
        ("start = 0", "start = 0\ndrain = -1", "11", "drain = -1 is not between 0 and 100"),
        ("start = 0", "start = 0\ncharging = 200", "11", "charging = 200 is not between 0 and 100"),
        ("start = 0", "start = 0\nslip = 2", "11", "slip = 2 is not between 0 and 1"),
        ("limit = 100", "slip = 1.5", "2", "slip = 1.5 is not between 0 and 1"),
        ("start = 0", "start = 0\npace = 0", "11", "pace = 0 is not between 1 and 8"),
        ("start = 0", "start = 0\nsensor = 2", "11", "sensor = 2 is not between 0 and 1"),
        ("start = 0", "start = 0\nview = 9", "11", "view = 9 is not between 1 and 8"),
        ("limit = 100", "missions = 0", "2", "missions = 0 is not between 1 and 1000"),
        ("[radio]", "[[goal]]\ncell = 4\nserves = 0.5\n[radio]", "17", "4 is no goal"),
        ("[radio]", "[[goal]]\ncell = 3\nserves = 2\n[radio]", "18", "serves = 2 is not between 0 and 1"),
        ("[radio]", "[[goal]]\ncell = 3\nserves = 1\n[[goal]]\ncell = 3\nserves = 1\n[radio]", "20", "goal 3 has a [[goal]] already"),
        ("precision = 16.0", "alike = 1", "23", "expected a boolean"),
        ("precision = 16.0", "precision = -1", "23", "precision = -1 is not between 0 and 1000"),
    ];
    for (right, wrong, line, reason) in cases {
        assert!(SOUND.contains(right), "{right}");
        let refusal = refusal("my.toml", &SOUND.replacen(right, wrong, 1));
        assert!(refusal.starts_with(&format!("my.toml:{line}: ")), "{wrong}: {refusal}");
        assert!(refusal.contains(reason), "{wrong}: {refusal}");
    }
}

/// A mission with an unknown whose entry is `unknown`, beside a second goal and a wall.
fn with_unknown(unknown: &str) -> String {
    format!("title = 't'\nneed = 1\nmap = '''\nG...1..G\n....#...\n'''\n{unknown}")
}

#[test]
fn when_an_unknown_is_not_written_as_one() {
    #[rustfmt::skip]
    let cases = [
        ("[unknown]\nserves = [[0], [7]]", "7: [unknown] is one of a list: write [[unknown]]"),
        ("[[unknown.sight]]\nfrom = 4", "7: [[unknown.sight]] belongs to an entry: put it after its [[unknown]]"),
        ("[[unknown]]\nserves = [[0], [7]]\nprior = [0.5, 0.5]\n[unknown.sight]\nfrom = 4", "10: [unknown.sight] is one of a list: write [[unknown.sight]]"),
        ("[[unknown]]\nprior = [0.5, 0.5]", "7: an unknown needs one of blocks, serves and takes"),
        ("[[unknown]]\nblocks = [[1]]\nserves = [[0], [7]]\nprior = [0.5, 0.5]", "9: an unknown has blocks or serves, not both"),
        ("[[unknown]]\nblocks = []\nprior = [1]", "8: blocks has 0 groups: list 1 or more"),
        ("[[unknown]]\nserves = []\nprior = [0.5, 0.5]", "8: serves has 0 groups: list 2 or more"),
        ("[[unknown]]\nserves = [[0, 7]]\nprior = [1.0]", "8: serves has 1 group: list 2 or more"),
        ("[[unknown]]\nserves = [[0], [7]]\nprior = [1.0]", "9: 1 probability for 2 values: serves has one for each group"),
        ("[[unknown]]\ntakes = [[0], [7]]\nprior = [0.2, 0.3, 0.5]", "9: 3 probabilities for 2 values: takes has one for each group"),
        ("[[unknown]]\nblocks = [[1], [2]]\nprior = [0.5, 0.5]", "9: 2 probabilities for 3 values: blocks has one that nothing is blocked, and one for each group"),
        ("[[unknown]]\nserves = [[0], [7]]\nprior = [0.501, 0.5]", "9: the probabilities of the values add up to 1.001, not to 1"),
    ];
    for (unknown, reason) in cases {
        let refused = refusal("my.toml", &with_unknown(unknown));
        assert!(refused.starts_with(&format!("my.toml:{reason}")), "{unknown}: {refused}");
    }
}

#[test]
fn when_an_unknown_makes_no_sense() {
    let either = |more: &str| format!("[[unknown]]\nserves = [[0], [7]]\nprior = [0.5, 0.5]\n{more}");
    let door = |more: &str| format!("[[unknown]]\nblocks = [[1]]\nprior = [0.5, 0.5]\n{more}");
    let sight = |more: &str| either("[[unknown.sight]]\nfrom = 3\n") + more;
    let robots = "beside = 1.0\n[[robot]]\npaths = [[4, 5, 6, 7]]";
    #[rustfmt::skip]
    let cases = [
        (either("beside = 0"), "10: beside = 0 is no better than a guess: of 2 answers it is over 1/2"),
        (either("beside = 0.5"), "10: beside = 0.5 is no better than a guess"),
        (sight("right = 0.5"), "12: right = 0.5 is no better than a guess: of 2 answers it is over 1/2"),
        (sight("tells = 1\nright = 0.4"), "13: right = 0.4 is no better than a guess"),
        (sight("[[unknown.sight]]\nfrom = 3"), "13: the unknown has such a sight from 3 already"),
        (either("beside = 1.0\n[[unknown.sight]]\nfrom = 1\ntells = 0"), "10: a sight from 1 tells of value 0 already, which beside does too"),
        (either(""), "7: nothing tells the value of this unknown: write beside = P, or add an [[unknown.sight]]"),
        (door(""), "7: nothing tells the value of this unknown"),
        (door("beside = 1.0\n") + &door("beside = 1.0"), "12: 1 belongs to another unknown already"),
        (door("beside = 1.0").replace("1]]", "4]]"), "8: 4 is where a robot starts: it is not blocked"),
        (door("beside = 1.0").replace("1]]", "]]"), "8: an empty group means the same as value 0, in which nothing is blocked"),
        (either("beside = 1.0").replace("[0], [7]", "[], []"), "8: an empty group means the same as the other empty one"),
        (either("beside = 1.0\nreal = 1").replace("0.5, 0.5", "1, 0"), "11: real = 1, but the prior of that value is 0"),
        (either(robots), "12: robots with paths do not look: leave them out, or every [[unknown]]"),
    ];
    for (unknown, reason) in cases {
        let refused = refusal("my.toml", &with_unknown(&unknown));
        assert!(refused.starts_with(&format!("my.toml:{reason}")), "{unknown}: {refused}");
    }
    for sound in [
        either("beside = 0.6"),
        sight("right = 0.6"),
        door("beside = 1.0"),
        sight("tells = 1\n[[unknown.sight]]\nfrom = 3"),
    ] {
        assert_eq!(refusal("my.toml", &with_unknown(&sound)), "accepted", "{sound}");
    }
}

#[test]
fn when_a_reading_of_several_values_is_no_better_than_a_guess() {
    let third = |right: f64| {
        let sight = format!("[[unknown.sight]]\nfrom = 3\nright = {right}");
        refusal(
            "my.toml",
            &with_unknown(&format!("[[unknown]]\nblocks = [[1], [2]]\nprior = [0.5, 0.3, 0.2]\n{sight}")),
        )
    };
    assert!(third(0.33).ends_with("of 3 answers it is over 1/3"), "{}", third(0.33));
    assert_eq!(third(0.34), "accepted", "of three values");
}

#[test]
fn when_no_world_lets_the_mission_be_accomplished() {
    let text = |need: &str, unknown: &str| {
        format!(
            "title = 't'\n{need}\nmap = '''\nG..1.2..G\n....#....\n'''\n[[unknown]]\n{unknown}\nprior = [0.5, 0.5]"
        )
    };
    let serves = "serves = [[0], [8]]\nbeside = 1.0";
    let refused = refusal("my.toml", &text("need = 2", serves));
    assert_eq!(refused, "my.toml:2: need = 2, but at most 1 can be held, whatever the unknowns are");
    assert!(refusal("my.toml", &text("", serves)).starts_with("my.toml:7: need = 2, but at most 1 "));
    assert_eq!(refusal("my.toml", &text("need = 1", serves)), "accepted");
    let takes = refusal("my.toml", &text("need = 2", "takes = [[0], [8]]\nstart = 4"));
    assert!(takes.starts_with("my.toml:2: need = 2, but at most 1 "), "{takes}");
    let shut = text("need = 1", "blocks = [[1, 10, 7, 16]]\nbeside = 1.0");
    assert_eq!(refusal("my.toml", &shut), "accepted", "it may be open");
    let surely = refusal("my.toml", &shut.replace("[0.5, 0.5]", "[0.0, 1.0]"));
    assert!(surely.starts_with("my.toml:2: need = 1, but at most 0 "), "{surely}");
}

#[test]
fn when_there_are_too_many_unknowns_values_or_combinations_of_them() {
    let door = |cell: usize| format!("[[unknown]]\nblocks = [[{cell}]]\nprior = [0.5, 0.5]\nbeside = 1.0\n");
    let doors = |count: usize| {
        let text: String = (2..2 + count).map(door).collect();
        refusal("my.toml", &format!("title = 't'\nmap = '1............G'\n{text}"))
    };
    assert_eq!(doors(4), "accepted");
    assert!(doors(5).ends_with("32 combinations of the values of unknowns, but a mission has at most 16"));
    assert!(doors(9).starts_with("my.toml:35: 9 unknowns, but a mission has at most 8"), "{}", doors(9));
    let groups: Vec<_> = (2..18).map(|cell| format!("[{cell}]")).collect();
    let (groups, prior) = (groups.join(", "), vec!["0.0588235"; 17].join(", "));
    let values = format!(
        "title = 't'\nmap = '1.................G'\n[[unknown]]\nblocks = [{groups}]\nprior = [{prior}]\nbeside = 1.0"
    );
    assert_eq!(refusal("my.toml", &values), "my.toml:3: 17 values of unknowns, but a mission has at most 16");
}

#[test]
fn when_a_robot_cannot_get_to_a_goal_of_its_own() {
    let apart = SOUND.replacen("....\n.#..\n....", "..#.\n.##.\n..#.", 1).replace("paths", "# paths");
    let refused = refusal("my.toml", &apart);
    assert!(refused.starts_with("my.toml:10: R1 on 0 can reach no goal: no way of at most 64"), "{refused}");
    let shared = "title = 't'\nmap = '''\n1.#G\n2.#.\nG.#.\n'''";
    let refused = refusal("my.toml", shared);
    assert!(refused.starts_with("my.toml:2: R2 on 4 can reach no goal of its own"), "{refused}");
}

#[test]
fn when_a_charger_or_a_way_point_is_out_of_reach_or_taken() {
    let text = |more: &str| format!("title = 't'\nmap = '''\n1.G\n###\n2.G\n'''\n{more}");
    let refused = |more: &str| refusal("my.toml", &text(more));
    assert_eq!(refused("[[robot]]\ncharger = 7"), "my.toml:8: R1 on 0 cannot reach the charger 7");
    let visit = "[[event]]\ntick = 3\nvisit = 1\nwho = 'R2'";
    assert_eq!(refused(visit), "my.toml:9: R2 on 6 cannot reach the way-point 1");
    let free = text("[[robot]]\ncharger = 1\n[[robot]]\ncharger = 1").replace("###", "...");
    assert_eq!(refusal("my.toml", &free), "my.toml:10: 1 is the charger of R1 already");
}

#[test]
fn when_a_goal_is_owned_twice_or_out_of_reach() {
    let text = |more: &str| format!("title = 't'\nmap = '''\n1.G\n###\n2.G\n'''\n{more}");
    let refused = |more: &str| refusal("my.toml", &text(more));
    assert_eq!(refused("[[robot]]\ngoal = 8"), "my.toml:8: R1 on 0 cannot reach the goal 8");
    let twice = text("[[robot]]\ngoal = 2\n[[robot]]\ngoal = 2").replace("###", "...");
    assert_eq!(refusal("my.toml", &twice), "my.toml:10: 2 is the goal of R1 already");
}

#[test]
fn when_a_number_is_left_out() {
    let refused = refusal("my.toml", "title = 't'\nmap = '''\n1.G\n3.G\n'''");
    assert_eq!(refused, "my.toml:2: robot 2 is missing, but the map draws robot 3: leave no number out");
}

#[test]
fn when_the_team_or_the_map_is_too_large() {
    let nine = "[[robot]]\nstart = 0\n".repeat(9);
    let team = refusal("a.toml", &format!("title = 't'\nmap = '...'\ngoals = [1]\n{nine}"));
    assert_eq!(team, "a.toml:20: 9 robots, but a team has at most 8");
    let map = refusal("a.toml", &format!("title = 't'\nmap = '''\n{}'''", "1.......G\n".repeat(114)));
    assert!(map.starts_with("a.toml:2: the map has 9 x 114 cells: draw 2 to 1024"), "{map}");
    let goals = refusal("a.toml", "title = 't'\nmap = '1GGGGGGGGGGGGGGGGG'");
    assert_eq!(goals, "a.toml:2: 17 goals, but a mission has at most 16");
    let no_goal = refusal("a.toml", "title = 't'\nmap = '1...'");
    assert_eq!(no_goal, "a.toml:2: no goal for 1 robot: draw 'G' on the map or list them");
    let nobody = refusal("a.toml", "title = 't'\nmap = '...G'");
    assert!(nobody.starts_with("a.toml:2: no robots"), "{nobody}");
    let path = format!("0{}", ", 1, 0".repeat(40));
    let long = format!("title = 't'\nmap = '...'\ngoals = [0]\n[[robot]]\nstart = 0\npaths = [[{path}]]");
    assert_eq!(refusal("a.toml", &long), "a.toml:6: the path has 80 moves, but at most 64 fit");
}

#[test]
fn when_it_is_no_text() {
    let error = Scenario::read("noise.bin", b"title = 't'\n\xff\xfe").unwrap_err();
    assert_eq!(error.to_string(), "noise.bin:2: this is no UTF-8 text");
}

#[test]
fn when_there_is_no_such_name() {
    assert!(library::find("factori").is_none());
    assert_eq!(library::nearest("factori"), Some("factory"));
}

proptest! {
    #[test]
    fn any_bytes_without_a_panic(bytes: Vec<u8>) {
        prop_assert!(Scenario::read("noise", &bytes).is_err());
    }

    #[test]
    fn any_damage_without_a_panic(at in 0..SOUND.len(), length in 0usize..40, insert in "[ -~\n]{0,6}") {
        let end = (at + length).min(SOUND.len());
        let text = [&SOUND[..at], &insert, &SOUND[end..]].concat();
        if let Err(error) = Scenario::parse("damaged", &text) {
            let lines = 1..=text.lines().count() + 1;
            prop_assert!(error.line.is_some_and(|line| lines.contains(&line)), "{error}");
            prop_assert!(!error.reason.is_empty());
        }
    }
}
