//! Files that are refused, and where.

use super::*;

#[track_caller]
fn refuses(text: &str, expected: &str) {
    assert_eq!(remarks(text), expected, "{text}");
}

#[test]
fn malformed_files_get_a_precise_error_each() {
    let leaf = "<AlwaysSuccess/>";
    refuses(
        "<root BTCPP_format=\"4\">\n<BehaviorTree ID=\"A\">\n",
        "f:2:1: error: <BehaviorTree> is never closed",
    );
    refuses(
        "<tree/>",
        "f:1:1: error: the first element must be <root>, not <tree>\nf:1:1: error: there is no <BehaviorTree> in the file",
    );
    refuses(
        &file("\n  <Sequenc/>"),
        "f:2:3: error: there is no kind of node called 'Sequenc'; did you mean 'Sequence'?",
    );
    refuses(
        &file("\n<Lift/>"),
        "f:2:1: error: there is no kind of node called 'Lift'; declare it in <TreeNodesModel>: <Action ID=\"Lift\"/>, or <Condition ID=\"Lift\"/>",
    );
    refuses(
        &file("\n<GoTo name=\"home\" place=\"dock\"/>"),
        "f:2:1: error: there is no kind of node called 'GoTo'; declare it in <TreeNodesModel>: <Action ID=\"GoTo\"><input_port name=\"place\"/></Action>, or <Condition ID=\"GoTo\"><input_port name=\"place\"/></Condition>",
    );
    refuses(
        &file(&format!("\n<Vote>{leaf}</Vote>")),
        "f:2:1: error: there is no kind of node called 'Vote'; declare it in <TreeNodesModel>",
    );
    refuses(
        &file("\n<SequenceStar/>"),
        "f:2:1: error: there is no kind of node called 'SequenceStar'; version 4 calls it SequenceWithMemory",
    );
    refuses(&file("\n<Inverter/>"), "f:2:1: error: Inverter must have exactly 1 child, here are 0");
    refuses(&file("\n<Sequence/>"), "f:2:1: error: Sequence must have at least 1 child, here are 0");
    refuses(
        &file(&format!("\n<AlwaysSuccess>{leaf}</AlwaysSuccess>")),
        "f:2:1: error: AlwaysSuccess must have no children, here are 1",
    );
    refuses(
        &file(&format!("\n<Repeat num_cycle=\"3\">{leaf}</Repeat>")),
        "f:2:1: error: Repeat needs a value for its port 'num_cycles'\nf:2:9: error: Repeat has no port 'num_cycle': it has num_cycles",
    );
    refuses(&file("\n<Sleep msec=\"soon\"/>"), "f:2:8: error: 'soon' for port 'msec' is no unsigned int");
    refuses(
        &file(&format!("{leaf}\n")).replace("\n</Beh", "\n<AlwaysFailure/></Beh"),
        "f:1:24: error: <BehaviorTree> must have exactly 1 child, here are 2",
    );
    refuses(&file("\n<SubTree ID=\"Dock\"/>"), "f:2:1: error: there is no tree called 'Dock'");
    refuses(&file("\n<SubTree ID=\"Main\"/>"), "f:2:1: error: the tree 'Main' contains itself");
    refuses(&file("\n<SubTree/>"), "f:2:1: error: <SubTree> must have the attribute 'ID'");
    refuses(
        &file("\n<Script code=\"a := \"/>"),
        "f:2:9: error: in the script of 'code': expected a value at the end",
    );
    refuses(
        &file("\n<AlwaysSuccess _skipIf=\"(a\"/>"),
        "f:2:16: error: in the script of _skipIf: expected ')' at the end",
    );
    refuses(
        &file(&format!("\n<ReactiveSequence><Action ID=\"AlwaysSuccess\"/>{leaf}</ReactiveSequence>")),
        "f:2:19: error: a child of ReactiveSequence must be written <AlwaysSuccess>, not <Action ID=\"AlwaysSuccess\">",
    );
    refuses(&file("\n<L s=\"RX\"/>"), "f:2:4: error: 'RX' is no script of statuses: letters S, F, R and K");
}

#[test]
fn what_behavior_tree_cpp_finds_only_at_run_time_is_found_before() {
    let leaf = "<AlwaysSuccess/>";
    for (root, expected) in [
        (
            format!("<IfThenElse>{leaf}</IfThenElse>"),
            "f:2:1: error: IfThenElse must have 2 or 3 children, here are 1",
        ),
        (
            format!(
                "<Switch3 variable=\"{{v}}\" case_1=\"1\" case_2=\"2\" case_3=\"3\">{leaf}{leaf}</Switch3>"
            ),
            "f:2:1: error: Switch3 must have 4 children, one for each case and a default, here are 2",
        ),
        (
            format!("<Parallel success_count=\"3\">{leaf}{leaf}</Parallel>"),
            "f:2:11: error: success_count is 3, but with 2 children the node could never succeed",
        ),
        (
            format!("<ParallelAll max_failures=\"2\">{leaf}</ParallelAll>"),
            "f:2:14: error: max_failures is 2, but with 1 children the node could never fail",
        ),
        (format!("<Timeout>{leaf}</Timeout>"), "f:2:1: error: Timeout needs a value for its port 'msec'"),
        (format!("<Delay>{leaf}</Delay>"), "f:2:1: error: Delay needs a value for its port 'delay_msec'"),
        (
            format!("<RetryUntilSuccessful>{leaf}</RetryUntilSuccessful>"),
            "f:2:1: error: RetryUntilSuccessful needs a value for its port 'num_attempts'",
        ),
        ("<Sleep/>".into(), "f:2:1: error: Sleep needs a value for its port 'msec'"),
        (
            format!("<Precondition if=\"1\" else=\"IDLE\">{leaf}</Precondition>"),
            "f:2:22: error: no node may return IDLE: SUCCESS, FAILURE, RUNNING or SKIPPED",
        ),
    ] {
        refuses(&file(&format!("\n{root}")), expected);
    }
}

#[test]
fn types_that_clash_on_an_entry_are_found_across_subtrees() {
    let clash = "<root BTCPP_format=\"4\" main_tree_to_execute=\"Main\">
<BehaviorTree ID=\"Main\"><Sequence><Sleep msec=\"{t}\"/><SubTree ID=\"Sub\" n=\"{t}\"/></Sequence></BehaviorTree>
<BehaviorTree ID=\"Sub\"><Repeat num_cycles=\"{n}\"><AlwaysSuccess/></Repeat></BehaviorTree></root>";
    refuses(clash, "f:3:32: error: '{n}' is of type int here, but of type unsigned int at 2:42");
}

#[test]
fn mandatory_ports_and_second_names_of_subtrees_are_found() {
    let file = |subtrees: &str| {
        format!(
            "<root BTCPP_format=\"4\" main_tree_to_execute=\"Main\">\n<BehaviorTree ID=\"Main\"><Sequence>\n{subtrees}</Sequence></BehaviorTree>
<BehaviorTree ID=\"Sub\"><AlwaysSuccess/></BehaviorTree>
<TreeNodesModel><SubTree ID=\"Sub\"><input_port name=\"p\"/></SubTree></TreeNodesModel></root>"
        )
    };
    refuses(
        &file("<SubTree ID=\"Sub\"/>"),
        "f:3:1: error: the tree 'Sub' needs a value for its port 'p', declared at f:5",
    );
    let twice = "<SubTree ID=\"Sub\" name=\"n\" p=\"1\"/>";
    refuses(
        &file(&format!("{twice}\n{twice}")),
        "f:4:1: error: a second SubTree is called 'n': give it another name, or none",
    );
}

#[test]
fn a_tree_that_is_not_used_cannot_keep_the_others_from_loading() {
    let text = "<root BTCPP_format=\"4\" main_tree_to_execute=\"A\"><BehaviorTree ID=\"A\"><AlwaysSuccess/></BehaviorTree>
<BehaviorTree ID=\"B\"><Sleep/></BehaviorTree></root>";
    refuses(text, "f:2:22: warning: Sleep needs a value for its port 'msec'");
}

#[test]
fn which_tree_to_execute_must_be_known() {
    let text = |main: &str| {
        format!(
            "<root BTCPP_format=\"4\"{main}>\n<BehaviorTree ID=\"A\"><AlwaysSuccess/></BehaviorTree>
<BehaviorTree ID=\"B\"><AlwaysSuccess/></BehaviorTree></root>"
        )
    };
    let reason =
        "the attribute 'main_tree_to_execute' must name the tree to execute, or --tree: there are 'A', 'B'";
    refuses(&text(""), &format!("f:1:1: error: {reason}"));
    refuses(
        &text(" main_tree_to_execute=\"C\""),
        "f:1:24: error: there is no tree called 'C', only 'A', 'B'",
    );
    assert_eq!(document(&text("")).main_tree(Some("B")), Ok("B".into()));
}

#[test]
fn what_the_engine_lacks_is_named_and_not_ignored() {
    let lacking = "\n<TryCatch><AlwaysSuccess/><AlwaysSuccess/></TryCatch>";
    refuses(&file(lacking), "f:2:1: warning: run and codegen refuse this tree: the engine has no TryCatch");
    let dynamic = "\n<Repeat num_cycles=\"{n}\"><AlwaysSuccess/></Repeat>";
    refuses(
        &file(dynamic),
        "f:2:9: warning: run and codegen refuse this tree: the entry 'n' for port 'num_cycles' is known only when the tree runs, and a table in flash needs a constant",
    );
    let dead = "\n<Sequence><AlwaysFailure/>\n<AlwaysSuccess/></Sequence>";
    refuses(&file(dead), "f:3:1: warning: no tick can reach this node");
}

#[test]
fn a_small_file_cannot_make_a_large_tree() {
    let double = |id: usize| {
        format!(
            "<BehaviorTree ID=\"T{id}\"><Sequence><SubTree ID=\"T{0}\"/><SubTree ID=\"T{0}\"/></Sequence></BehaviorTree>",
            id + 1
        )
    };
    let trees: String = (0..40).map(double).collect();
    let text = format!(
        "<root BTCPP_format=\"4\" main_tree_to_execute=\"T0\">{trees}<BehaviorTree ID=\"T40\"><AlwaysSuccess/></BehaviorTree></root>"
    );
    assert!(remarks(&text).contains("error: more than 32768 nodes, SubTrees included"), "{}", remarks(&text));
    let chain =
        |id: usize| format!("<BehaviorTree ID=\"T{id}\"><SubTree ID=\"T{}\"/></BehaviorTree>", id + 1);
    let trees: String = (0..2000).map(chain).collect();
    let text = format!(
        "<root BTCPP_format=\"4\" main_tree_to_execute=\"T0\">{trees}<BehaviorTree ID=\"T2000\"><AlwaysSuccess/></BehaviorTree></root>"
    );
    assert!(remarks(&text).contains("error: more than 256 levels, SubTrees included"));
}
