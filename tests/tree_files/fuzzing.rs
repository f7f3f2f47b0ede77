//! No file makes the reader panic.

use super::*;
use host_sim::Random;

/// How many files are tried; `TREE_FILES_EXECUTIONS` asks for more.
const EXECUTIONS: u64 = 5_000;

const SEEDS: [&str; 4] = [
    include_str!("patrol.xml"),
    "<root BTCPP_format=\"4\" main_tree_to_execute=\"A\"><BehaviorTree ID=\"A\"><Sequence><SubTree ID=\"B\" n=\"3\" k=\"{x}\" _autoremap=\"true\"/><Switch2 variable=\"{v}\" case_1=\"1\" case_2=\"b\"><L s=\"RS\"/><L name=\"q\"/><AlwaysFailure/></Switch2></Sequence></BehaviorTree><BehaviorTree ID=\"B\"><Repeat num_cycles=\"{n}\"><L name=\"a\" s=\"RSF\" _skipIf=\"x == 1 || 'a' .. 2 != 'b'\"/></Repeat></BehaviorTree></root>",
    "<root BTCPP_format=\"4\"><BehaviorTree ID=\"M\"><Parallel success_count=\"-1\" failure_count=\"2\"><Script code=\"a := 1; b := a + 2 * 3; a = b ? 4 : 'c'\"/><Timeout msec=\"100\"><Sleep msec=\"50\"/></Timeout><SetBlackboard value=\"3\" output_key=\"z\"/></Parallel></BehaviorTree></root>",
    "<root><include path=\"x\"/><BehaviorTree ID=\"T\"><RecoveryNode number_of_retries=\"2\"><PipelineSequence><RateController hz=\"1.0\"><L s=\"S\"/></RateController></PipelineSequence><RoundRobin><Delay delay_msec=\"5\"><AlwaysSuccess/></Delay></RoundRobin></RecoveryNode></BehaviorTree><TreeNodesModel><Condition ID=\"C\"><input_port name=\"p\" type=\"double\" default=\"1\">d</input_port></Condition></TreeNodesModel></root>",
];

const VALUES: [&str; 24] = [
    "",
    "1",
    "-1",
    "0",
    "3",
    "1.5",
    "{x}",
    "{n}",
    "{=}",
    "{@x}",
    "true",
    "FAILURE",
    "A",
    "B",
    "T",
    "M",
    "RS",
    "K",
    "x == 1",
    "x := 1; y := 'a'",
    "x += 1",
    "a ? 1 : 2",
    "2147483648",
    "nan",
];

const WORDS: [&str; 40] = [
    "<",
    ">",
    "/>",
    "</",
    "\"",
    "'",
    "=",
    " ",
    "{x}",
    "{",
    "}",
    "&lt;",
    "&#x110000;",
    "<!--",
    "-->",
    "<![CDATA[",
    "<?",
    "<!D",
    "<Sequence>",
    "</Sequence>",
    "<SubTree ID=\"A\"/>",
    "<SubTree ID=\"B\"/>",
    "<Inverter>",
    "</Inverter>",
    "-1",
    "0",
    "2147483648",
    "999999999999999999999",
    "1e400",
    "nan",
    "IDLE",
    "_while=\"x\"",
    "ID=\"Main\"",
    "<BehaviorTree ID=\"B\">",
    "</BehaviorTree>",
    "é",
    "\u{feff}",
    "\0",
    "((((",
    "name=\"\"",
];

/// Puts other words in the place of values; one time in three also cuts and doubles pieces of the
/// text.
fn mutated(random: &mut Random) -> String {
    let mut text: Vec<char> = SEEDS[random.below(SEEDS.len())].chars().collect();
    for _ in 0..random.below(4) {
        replace_value(random, &mut text);
    }
    if random.below(3) == 0 {
        for _ in 0..=random.below(3) {
            tear(random, &mut text);
        }
    }
    text.into_iter().collect()
}

fn replace_value(random: &mut Random, text: &mut Vec<char>) {
    let quotes: Vec<usize> = (0..text.len()).filter(|&at| text[at] == '"').collect();
    let at = 2 * random.below(quotes.len() / 2);
    if let Some(&[from, to]) = quotes.get(at..at + 2) {
        let value = if random.below(2) == 0 {
            VALUES[random.below(VALUES.len())].chars().collect()
        } else {
            let other = 2 * random.below(quotes.len() / 2);
            text[quotes[other] + 1..quotes[other + 1]].to_vec()
        };
        text.splice(from + 1..to, value);
    }
}

fn tear(random: &mut Random, text: &mut Vec<char>) {
    let from = random.below(text.len());
    let to = (from + random.below(24)).min(text.len());
    match random.below(4) {
        0 => _ = text.drain(from..to),
        1 => {
            let piece = text[from..to].to_vec();
            text.splice(from..from, piece);
        }
        2 => _ = text.splice(from..to, WORDS[random.below(WORDS.len())].chars()),
        _ => _ = text.splice(from..from, WORDS[random.below(WORDS.len())].chars()),
    }
}

/// Processes a file as far as possible; returns how far that was.
fn try_out(text: &str) -> usize {
    let Ok(document) = Document::parse("f", text, &Extras::default()) else { return 0 };
    let remarks = tree::check(&document, None);
    let Ok(main) = document.main_tree(None) else { return 1 };
    let Ok(instance) = Instance::of(&document, &main) else { return 1 };
    assert!(remarks.iter().all(|remark| remark.severity == Severity::Warning), "{text}\n{remarks:?}");
    let exported = document.export();
    let again = Document::parse("f", &exported, &Extras::default());
    assert_eq!(again.map(|again| again.export()).as_ref(), Ok(&exported), "{text}");
    _ = (instance.outline(), instance.dot(), instance.codegen());
    let settings = DryRun {
        ticks: 4,
        mode: Mode::ExactlyOnce,
        tick_ms: 20,
        leaves: &[],
        halt_after: Some(3),
        compat: false,
    };
    let Ok(record) = settings.run(&instance) else { return 2 };
    _ = (instance.btlog(&record.transitions), instance.timeline(&record.transitions));
    3
}

#[test]
fn mutated_files_are_refused_or_run_and_never_panic() {
    let executions = std::env::var("TREE_FILES_EXECUTIONS").ok().and_then(|text| text.parse().ok());
    let executions = executions.unwrap_or(EXECUTIONS);
    let mut random = Random::new(2026);
    let mut reached = [0_u64; 4];
    for _ in 0..executions {
        reached[try_out(&mutated(&mut random))] += 1;
    }
    println!("{executions} files: {reached:?} not XML, refused, not run, run");
    assert!(
        reached.iter().all(|count| *count > executions / 100),
        "a kind of outcome is missing: {reached:?}"
    );
}
