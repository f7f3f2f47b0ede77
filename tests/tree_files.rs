//! Tree files: what is read, what is refused, and that trees behave as in BehaviorTree.CPP.

use host_sim::tree::{
    self, Diagnostic, Document, DryRecord, DryRun, Extras, Instance, LoadError, Mode, Severity, Statuses,
    library,
};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

// What a program would not use of it is no concern here.
#[allow(dead_code, unreachable_pub)]
#[path = "tree_files/patrol.rs"]
mod patrol;
#[allow(dead_code, unreachable_pub)]
#[path = "tree_files/t21.rs"]
mod t21;

fn document(text: &str) -> Document {
    Document::parse("f", text, &Extras::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn instance(text: &str) -> Instance {
    let document = document(text);
    let main = document.main_tree(None).unwrap_or_else(|error| panic!("{error}"));
    Instance::of(&document, &main).unwrap_or_else(|remarks| panic!("{remarks:?}"))
}

/// A file with one tree.
fn file(root: &str) -> String {
    format!("<root BTCPP_format=\"4\"><BehaviorTree ID=\"Main\">{root}</BehaviorTree></root>")
}

/// What a check says about a file, one remark a line.
fn remarks(text: &str) -> String {
    let found = match Document::parse("f", text, &Extras::default()) {
        Ok(document) => tree::check(&document, None),
        Err(error) => vec![error],
    };
    found.iter().map(Diagnostic::to_string).collect::<Vec<_>>().join("\n")
}

fn dry_run(instance: &Instance, ticks: u32, leaves: &[(&str, &str)]) -> DryRecord {
    let leaves: Vec<(String, Statuses)> =
        leaves.iter().map(|(name, part)| ((*name).to_owned(), part.parse().unwrap())).collect();
    let settings = DryRun {
        ticks,
        mode: Mode::ExactlyOnce,
        tick_ms: 10,
        leaves: &leaves,
        halt_after: None,
        compat: false,
    };
    settings.run(instance).unwrap_or_else(|error| panic!("{error}"))
}

/// Traces that BehaviorTree.CPP itself left.
mod traces {
    use super::*;

    const RECORDED: &str = include_str!("tree_files/traces.txt");

    struct Trace<'t> {
        title: &'t str,
        instance: Instance,
        settings: DryRun<'t>,
        lines: Vec<&'t str>,
    }

    fn recorded() -> Vec<Trace<'static>> {
        let blocks = RECORDED.split("## ").skip(1);
        blocks.map(|block| trace(block).unwrap_or_else(|| panic!("no trace: {block}"))).collect()
    }

    fn trace(block: &'static str) -> Option<Trace<'static>> {
        let mut lines = block.trim_end().lines();
        let (title, text) = (lines.next()?, lines.next()?);
        let mut settings = lines.next()?.split(' ');
        let mode = if settings.next()? == "once" { Mode::Once } else { Mode::ExactlyOnce };
        let mut number = || settings.next()?.parse::<u32>().ok();
        let (ticks, tick_ms, halt_after) = (number()?, number()?, number()?);
        let halt_after = Some(halt_after).filter(|tick| *tick > 0);
        let settings = DryRun { ticks, mode, tick_ms, leaves: &[], halt_after, compat: true };
        Some(Trace { title, instance: instance(text), settings, lines: lines.collect() })
    }

    #[test]
    fn trees_behave_as_recorded_from_behavior_tree_cpp() {
        let traces = recorded();
        assert!(traces.len() > 150, "only {} traces", traces.len());
        for trace in traces {
            let record = trace.settings.run(&trace.instance).unwrap();
            assert_eq!(
                record.text.lines().collect::<Vec<_>>(),
                trace.lines,
                "{} {:?}",
                trace.title,
                trace.settings
            );
        }
    }

    #[test]
    fn without_compat_only_the_documented_differences_show() {
        let mut halts = 0;
        for mut trace in recorded() {
            trace.settings.compat = false;
            let record = trace.settings.run(&trace.instance).unwrap();
            for (ours, theirs) in record.text.lines().zip(trace.lines) {
                if let (Some(ours), Some(theirs)) =
                    (ours.strip_prefix("haltTree:"), theirs.strip_prefix("haltTree:"))
                {
                    halts += 1;
                    assert!(
                        theirs.starts_with(ours),
                        "{}: {ours} is told first, then all again: {theirs}",
                        trace.title
                    );
                } else if trace.title == "Timeout in a reactive node" {
                    // There a timer halts the child in between two ticks.
                    let in_order = |line: &str| line.replace("halt(a) g:S", "g:S halt(a)");
                    assert_eq!(ours, in_order(theirs), "{}", trace.title);
                } else {
                    assert_eq!(ours, theirs, "{} {:?}", trace.title, trace.settings);
                }
            }
        }
        assert!(halts > 20, "only {halts} halts were compared");
    }

    #[test]
    fn every_node_that_the_engine_has_is_in_a_trace_or_is_nav2_s() {
        let nodes = "Sequence SequenceWithMemory ReactiveSequence AsyncSequence Fallback ReactiveFallback AsyncFallback \
            Parallel ParallelAll IfThenElse WhileDoElse Switch2 Switch3 Switch4 Switch5 Switch6 Inverter ForceSuccess ForceFailure \
            RetryUntilSuccessful Repeat KeepRunningUntilFailure Timeout Delay RunOnce Precondition AlwaysSuccess \
            AlwaysFailure Sleep SubTree Script ScriptCondition SetBlackboard";
        for node in nodes.split_whitespace() {
            let tag = [format!("<{node}>"), format!("<{node} "), format!("<{node}/")];
            assert!(tag.iter().any(|tag| RECORDED.contains(tag.as_str())), "{node} is in no trace");
        }
    }

    #[test]
    fn the_nodes_of_nav2_follow_its_documentation() {
        let run = |root: &str, ticks| dry_run(&instance(&file(root)), ticks, &[]).text;
        // A pipeline ticks the children before the running one again.
        let pipeline = "<PipelineSequence><L name=\"a\" s=\"S\"/><L name=\"b\" s=\"RS\"/><L name=\"c\" s=\"RS\"/></PipelineSequence>";
        let expected =
            "tick 1: a:S b:R => RUNNING\ntick 2: a:S b:S c:R => RUNNING\ntick 3: a:S b:S c:S => SUCCESS\n";
        assert_eq!(run(pipeline, 3), expected);
        // A recovery node ticks its second child when the first fails, and then the first again.
        let recovery = "<RecoveryNode number_of_retries=\"1\"><L name=\"a\" s=\"FFS\"/><L name=\"r\" s=\"S\"/></RecoveryNode>";
        assert_eq!(run(recovery, 2), "tick 1: a:F r:S a:F => FAILURE\ntick 2: a:S => SUCCESS\n");
        // A round robin begins where it ended.
        let robin = "<RoundRobin><L name=\"a\" s=\"S\"/><L name=\"b\" s=\"S\"/></RoundRobin>";
        assert_eq!(run(robin, 3), "tick 1: a:S => SUCCESS\ntick 2: b:S => SUCCESS\ntick 3: a:S => SUCCESS\n");
    }
}

/// Files that are refused, and where.
mod refusals {
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
        refuses(
            &file("\n<L s=\"RX\"/>"),
            "f:2:4: error: 'RX' is no script of statuses: letters S, F, R and K",
        );
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
        let reason = "the attribute 'main_tree_to_execute' must name the tree to execute, or --tree: there are 'A', 'B'";
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
        refuses(
            &file(lacking),
            "f:2:1: warning: run and codegen refuse this tree: the engine has no TryCatch",
        );
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
        assert!(
            remarks(&text).contains("error: more than 32768 nodes, SubTrees included"),
            "{}",
            remarks(&text)
        );
        let chain =
            |id: usize| format!("<BehaviorTree ID=\"T{id}\"><SubTree ID=\"T{}\"/></BehaviorTree>", id + 1);
        let trees: String = (0..2000).map(chain).collect();
        let text = format!(
            "<root BTCPP_format=\"4\" main_tree_to_execute=\"T0\">{trees}<BehaviorTree ID=\"T2000\"><AlwaysSuccess/></BehaviorTree></root>"
        );
        assert!(remarks(&text).contains("error: more than 256 levels, SubTrees included"));
    }
}

/// Files that include others.
mod includes {
    use super::*;

    fn load(files: &[(&str, &str)]) -> Result<Document, LoadError> {
        let files: BTreeMap<PathBuf, String> =
            files.iter().map(|(path, text)| (PathBuf::from(path), (*text).to_owned())).collect();
        let read = |path: &Path| files.get(path).cloned().ok_or_else(|| io::Error::other("no such file"));
        Document::load(Path::new("d/main.xml"), &read, &Extras::default())
    }

    const MAIN: &str = "<root BTCPP_format=\"4\" main_tree_to_execute=\"Main\"><include path=\"lib/a.xml\"/>
<BehaviorTree ID=\"Main\"><SubTree ID=\"A\"/></BehaviorTree></root>";
    const A: &str = "<root BTCPP_format=\"4\"><BehaviorTree ID=\"A\"><Wait/></BehaviorTree>
<TreeNodesModel><Action ID=\"Wait\"/></TreeNodesModel></root>";

    #[test]
    fn trees_and_models_come_from_files_relative_to_the_including_one() {
        let document = load(&[("d/main.xml", MAIN), ("d/lib/a.xml", A)]).unwrap();
        assert_eq!(tree::check(&document, None), []);
        let instance = Instance::of(&document, "Main").unwrap();
        assert_eq!(dry_run(&instance, 1, &[("Wait", "F")]).text, "tick 1: Wait:F => FAILURE\n");
        assert!(document.export().contains("<BehaviorTree ID=\"A\">"), "one file has it all");
    }

    #[test]
    fn what_cannot_be_included_is_named_where_it_is_included() {
        let refusal = |files: &[(&str, &str)]| load(files).err().map(|error| error.to_string());
        let missing = "d/main.xml:1:61: error: cannot include 'd/lib/a.xml': no such file";
        assert_eq!(refusal(&[("d/main.xml", MAIN)]).as_deref(), Some(missing));
        let circle = "<root><include path=\"../main.xml\"/></root>";
        let expected = "d/lib/a.xml:1:16: error: 'd/lib/../main.xml' includes itself";
        assert_eq!(refusal(&[("d/main.xml", MAIN), ("d/lib/a.xml", circle)]).as_deref(), Some(expected));
        let nameless = "<root><include file=\"a\"/></root>";
        let expected = "d/main.xml:1:7: error: <include> has no attribute 'path'";
        assert_eq!(refusal(&[("d/main.xml", nameless)]).as_deref(), Some(expected));
        let packaged = "<root><include ros_pkg=\"p\" path=\"a\"/></root>";
        let expected =
            "d/main.xml:1:16: error: ROS packages are not known here: write 'path' relative to this file";
        assert_eq!(refusal(&[("d/main.xml", packaged)]).as_deref(), Some(expected));
        assert_eq!(refusal(&[]).as_deref(), Some("d/main.xml: no such file"));
    }

    #[test]
    fn errors_in_an_included_file_name_that_file() {
        let document =
            load(&[("d/main.xml", MAIN), ("d/lib/a.xml", &A.replace("<Wait/>", "\n<Wait x=\"1\"/>"))])
                .unwrap();
        let expected = "d/lib/a.xml:2:7: error: Wait has no port 'x': it has none";
        assert_eq!(
            tree::check(&document, None).iter().map(Diagnostic::to_string).collect::<Vec<_>>(),
            [expected]
        );
    }
}

/// The trees that are built in.
mod built_in {
    use super::*;

    fn shipped(name: &str) -> (Document, Instance) {
        let document = library::find(name).expect("built in").expect("XML");
        let main = document.main_tree(None).expect("a main tree");
        let instance = Instance::of(&document, &main).unwrap_or_else(|remarks| panic!("{name}: {remarks:?}"));
        (document, instance)
    }

    #[test]
    fn all_are_without_remarks() {
        for name in library::names() {
            assert_eq!(tree::check(&shipped(name).0, None), [], "{name}");
        }
    }

    #[test]
    fn export_then_import_is_the_identity() {
        for name in library::names() {
            let (document, instance) = shipped(name);
            let text = document.export();
            let again = Document::parse(name, &text, &Extras::default()).expect("XML");
            assert_eq!(again.export(), text, "{name}");
            let main = again.main_tree(None).expect("a main tree");
            let second = Instance::of(&again, &main).expect("sound");
            assert_eq!(second.outline(), instance.outline(), "{name}");
            assert_eq!(second.codegen().unwrap(), instance.codegen().unwrap(), "{name}");
        }
    }

    #[test]
    fn they_have_the_sizes_that_the_paper_reports() {
        // Sequences, fallbacks, conditions, actions, levels: the paper's tables 3, 6 and 7 and its figures.
        for (name, [sequences, fallbacks, conditions, actions, levels]) in [
            ("pilot", [1, 1, 1, 2, 3]),
            ("figure-5-inference", [0, 0, 0, 1, 1]),
            ("figure-8-classical", [5, 4, 7, 5, 8]),
            ("figure-8-inference", [1, 1, 1, 2, 3]),
            ("figure-14-left", [1, 1, 1, 3, 3]),
            ("figure-14-right", [1, 0, 0, 2, 2]),
            ("figure-15a", [1, 2, 3, 2, 4]),
            ("figure-15b", [1, 2, 4, 2, 4]),
            ("figure-16a", [1, 2, 3, 2, 4]),
            ("t21", [5, 4, 8, 4, 4]),
            ("t33", [9, 4, 12, 8, 4]),
        ] {
            let census = shipped(name).1.census();
            let kind =
                |kinds: &[&str]| kinds.iter().filter_map(|kind| census.kinds.get(*kind)).sum::<usize>();
            let class = |class: &str| census.classes.get(class).copied().unwrap_or(0);
            let counted = [
                kind(&["Sequence", "ReactiveSequence"]),
                kind(&["Fallback"]),
                class("Condition"),
                class("Action"),
                census.depth(),
            ];
            assert_eq!(counted, [sequences, fallbacks, conditions, actions, levels], "{name}");
            assert_eq!(census.nodes(), sequences + fallbacks + conditions + actions, "{name}");
        }
    }

    #[test]
    fn the_reference_trees_succeed_with_the_statuses_of_their_benchmark() {
        for (name, leaves) in [("t21", 12), ("t33", 20)] {
            let record = dry_run(&shipped(name).1, 1, &[("Refused", "F")]);
            assert!(record.text.ends_with(" => SUCCESS\n"), "{}", record.text);
            assert_eq!(record.text.matches(':').count() - 1, leaves, "{}", record.text);
        }
    }

    #[test]
    fn any_tree_survives_export_and_import() {
        let text = "<root BTCPP_format=\"4\" main_tree_to_execute=\"Main\"><BehaviorTree ID=\"Main\" _note=\"x\"><Sequence>
<Action ID=\"Go\" name=\"a &amp; &quot;b&quot;\" to=\"{x}\" _skipIf=\"x &lt; 3\"/><SubTree ID=\"Sub\" p=\"{=}\" _autoremap=\"true\"/></Sequence></BehaviorTree>
<BehaviorTree ID=\"Sub\"><Wait/></BehaviorTree><TreeNodesModel><Action ID=\"Go\"><input_port name=\"to\" type=\"Pose\" default=\"1\">where &lt;to&gt;</input_port>
<output_port name=\"e\" type=\"double\"/></Action><Action ID=\"Wait\"/><SubTree ID=\"Sub\"><inout_port name=\"p\"/></SubTree></TreeNodesModel></root>";
        let once = document(text).export();
        assert_eq!(document(&once).export(), once);
        assert!(
            once.contains("<Go name=\"a &amp; &quot;b&quot;\" to=\"{x}\" _skipIf=\"x &lt; 3\"/>"),
            "{once}"
        );
        assert!(!once.contains("<Action ID=\"Go\" name"), "the explicit form is never written");
        assert_eq!(instance(&once).outline(), instance(text).outline());
    }
}

/// Pictures.
mod pictures {
    use super::*;

    const TREE: &str = "<ReactiveFallback><Inverter><L name=\"door\" s=\"F\"/></Inverter><Timeout msec=\"5\"><L name=\"go\" s=\"R\"/></Timeout></ReactiveFallback>";

    #[test]
    fn a_tree_is_shown_as_indented_text_with_its_counts() {
        let expected = "\
Main: 5 nodes, 3 levels
ReactiveFallback
├─ Inverter
│  └─ L 'door' s=F
└─ Timeout msec=5
   └─ L 'go' s=R

Inverter              1
L                     2
ReactiveFallback      1
Timeout               1

by class  Action 2, Control 1, Decorator 2
by level  1 2 2
";
        assert_eq!(instance(&file(TREE)).outline(), expected);
    }

    #[test]
    fn a_graph_has_a_line_for_each_node_and_edge() {
        let graph = instance(&file(TREE)).dot();
        assert!(graph.starts_with("digraph \"Main\" {"), "{graph}");
        assert_eq!((graph.matches("label=").count(), graph.matches(" -> ").count()), (5, 4));
    }
}

/// Rust source from trees; what is checked in is compiled and run here.
mod code {
    use super::*;
    use iibt_core::time::Instant;
    use iibt_core::tree::{Halt, Leaves, Memory, Status};

    const PATROL: &str = include_str!("tree_files/patrol.xml");

    #[test]
    fn the_checked_in_source_is_what_is_written_today() {
        assert_eq!(instance(PATROL).codegen().unwrap(), include_str!("tree_files/patrol.rs"));
        let t21 = library::find("t21").unwrap().unwrap();
        let t21 = Instance::of(&t21, "T21").unwrap();
        assert_eq!(t21.codegen().unwrap(), include_str!("tree_files/t21.rs"));
    }

    struct Robot(Vec<patrol::Leaf>);

    impl Leaves<patrol::Leaf> for Robot {
        fn condition(&mut self, leaf: &patrol::Leaf, _: Instant) -> bool {
            self.0.push(*leaf);
            *leaf != patrol::Leaf::BatteryOk
        }

        fn on_start(&mut self, leaf: &patrol::Leaf, now: Instant) -> Status {
            self.on_running(leaf, now)
        }

        fn on_running(&mut self, leaf: &patrol::Leaf, _: Instant) -> Status {
            self.0.push(*leaf);
            Status::Running
        }

        fn on_halted(&mut self, _: &patrol::Leaf, _: Instant) -> Halt {
            Halt::Done
        }
    }

    #[test]
    fn the_source_compiles_and_does_what_the_dry_run_does() {
        let mut robot = Robot(Vec::new());
        let status = patrol::TREE.tick(&mut Memory::new(), &mut robot, Instant(0)).status;
        assert_eq!(
            (status, robot.0.as_slice()),
            (Status::Running, &[patrol::Leaf::BatteryOk, patrol::Leaf::MoveTo][..])
        );
        let record = dry_run(&instance(PATROL), 1, &[("BatteryOk", "F"), ("MoveTo", "R")]);
        assert_eq!(record.text, "tick 1: BatteryOk:F MoveTo:R => RUNNING\n");
        assert_eq!(patrol::Leaf::BatteryOk.limit(), Some(0.2));
        assert_eq!(patrol::Leaf::MoveTo.goal(), Some(patrol::Port::Entry(patrol::Entry::Dock)));
        assert_eq!(patrol::Leaf::Home.goal(), Some(patrol::Port::Constant("origin")));
        assert_eq!(t21::NODES, 21);
        assert_eq!(t21::TREE.visits(), 21);
    }

    #[test]
    fn what_firmware_cannot_have_is_refused_with_its_place() {
        let refusal = |root: &str| instance(&file(root)).codegen().err().map(|error| error.to_string());
        let post = "\n<L name=\"a\" s=\"S\" _onHalted=\"x := 1\"/>";
        let expected =
            "f:2:19: error: _onHalted: scripts that run after a node are not translated: let the leaf do it";
        assert_eq!(refusal(post).as_deref(), Some(expected));
        let dead = "<Fallback><AlwaysSuccess/>\n<L name=\"a\" s=\"S\"/></Fallback>";
        let expected = "f:2:1: error: no tick can reach this node: the compiler refuses it";
        assert_eq!(refusal(dead).as_deref(), Some(expected));
    }
}

/// Logs and pages.
mod records {
    use super::*;

    const TREE: &str = "<Sequence><L name=\"a\" s=\"S\"/><L name=\"b\" s=\"RF\"/></Sequence>";

    #[test]
    fn a_log_has_the_layout_that_groot_reads() {
        let instance = instance(&file(TREE));
        let log = instance.btlog(&dry_run(&instance, 2, &[]).transitions);
        let rest = log.strip_prefix(b"BTCPP4-FileLogger2\x01").expect("magic and protocol");
        let (length, rest) = rest.split_at(4);
        let length = i32::from_le_bytes(length.try_into().unwrap()) as usize;
        let (xml, rest) = rest.split_at(length);
        let xml = std::str::from_utf8(xml).unwrap();
        assert!(
            xml.contains("<Sequence name=\"Sequence\" _uid=\"1\">") && xml.contains("_uid=\"3\""),
            "{xml}"
        );
        assert!(Document::parse("log", xml, &Extras::default()).is_ok());
        let (start, records) = rest.split_at(8);
        assert_eq!(start, [0; 8]);
        let record = |record: &[u8]| {
            let time = u64::from_le_bytes([&record[..6], &[0, 0]].concat().try_into().unwrap());
            (time, u16::from_le_bytes([record[6], record[7]]), record[8])
        };
        assert_eq!(records.len() % 9, 0);
        let records: Vec<_> = records.chunks(9).map(record).collect();
        // a succeeds, b and the root run; 10 ms later a is idle again, b and the root fail.
        let expected = [(0, 2, 2), (0, 3, 1), (0, 1, 1), (10_000, 2, 0), (10_000, 3, 3), (10_000, 1, 3)];
        assert_eq!(records, expected);
    }

    #[test]
    fn a_page_shows_every_node_and_how_it_ended() {
        let instance = instance(&file(TREE));
        let page = instance.timeline(&dry_run(&instance, 2, &[]).transitions);
        assert!(page.contains(">a</text>") && page.contains(">b</text>"));
        assert_eq!(page.matches("class=\"running\"").count(), 2);
        assert!(page.contains("FAILURE at 10 ms") && page.contains("SUCCESS at 0 ms"));
        assert!(!page.contains("src=") && !page.contains("href="), "the page is complete in itself");
    }
}

/// Nothing that is read can make the reader panic.
mod fuzzing {
    use super::*;

    /// How many files are tried; `TREE_FILES_EXECUTIONS` asks for more.
    const EXECUTIONS: u64 = 5_000;

    const SEEDS: [&str; 4] = [
        include_str!("tree_files/patrol.xml"),
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

    struct Lcg(u64);

    impl Lcg {
        fn below(&mut self, bound: usize) -> usize {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 33) as usize % bound.max(1)
        }
    }

    /// Puts other words in the place of values; one time in three also cuts and doubles pieces of the text.
    fn mutated(random: &mut Lcg) -> String {
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

    fn replace_value(random: &mut Lcg, text: &mut Vec<char>) {
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

    fn tear(random: &mut Lcg, text: &mut Vec<char>) {
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

    /// Takes a file as far as it goes; says how far that was.
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
        let mut random = Lcg(2026);
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
}
