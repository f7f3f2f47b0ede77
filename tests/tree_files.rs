//! Tree files: what is read, what is refused, and that trees behave as in BehaviorTree.CPP.

use host_sim::tree::{
    self, Diagnostic, Document, DryRecord, DryRun, Extras, Instance, LoadError, Mode, Severity, Statuses,
    library,
};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

#[path = "tree_files/fuzzing.rs"]
mod fuzzing;
#[path = "tree_files/refusals.rs"]
mod refusals;
#[path = "tree_files/traces.rs"]
mod traces;
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
        // Sequences, fallbacks, conditions, actions, levels: the paper's tables 3, 6 and 7 and its
        // figures.
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
            let counts = shipped(name).1.counts();
            let kind =
                |kinds: &[&str]| kinds.iter().filter_map(|kind| counts.kinds.get(*kind)).sum::<usize>();
            let class = |class: &str| counts.classes.get(class).copied().unwrap_or(0);
            let counted = [
                kind(&["Sequence", "ReactiveSequence"]),
                kind(&["Fallback"]),
                class("Condition"),
                class("Action"),
                counts.depth(),
            ];
            assert_eq!(counted, [sequences, fallbacks, conditions, actions, levels], "{name}");
            assert_eq!(counts.nodes(), sequences + fallbacks + conditions + actions, "{name}");
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

/// Trees whose leaves are bound to a program's own.
mod binding {
    use super::*;
    use host_sim::tree::{BoundTree, LeafNode};
    use iibt_core::time::Instant;
    use iibt_core::tree::{Halt, Leaves, NodeMemory, Status, StatusChange};

    const TREE: &str = r#"<root BTCPP_format="4"><BehaviorTree ID="Main"><ReactiveFallback>
      <Sequence><IsLow/><GoTo place="dock"/></Sequence><GoTo place="field"/>
    </ReactiveFallback></BehaviorTree>
    <TreeNodesModel><Condition ID="IsLow"/>
      <Action ID="GoTo"><input_port name="place" type="std::string"/></Action></TreeNodesModel></root>"#;

    #[derive(Clone, Debug, PartialEq)]
    enum Skill {
        IsLow,
        GoTo(String),
    }

    fn find(leaf: &LeafNode) -> Result<Skill, String> {
        match (leaf.kind.as_str(), leaf.port("place")) {
            ("IsLow", None) => Ok(Skill::IsLow),
            ("GoTo", Some(place)) if place != "moon" => Ok(Skill::GoTo(place.into())),
            (kind, port) => Err(format!("nothing is called {kind} {}", port.unwrap_or(""))),
        }
    }

    #[derive(Default)]
    struct Robot {
        low: bool,
        calls: Vec<String>,
        transitions: usize,
    }

    impl Leaves<Skill> for Robot {
        fn condition(&mut self, leaf: &Skill, _: Instant) -> bool {
            *leaf == Skill::IsLow && self.low
        }

        fn on_start(&mut self, leaf: &Skill, _: Instant) -> Status {
            self.calls.push(format!("start {leaf:?}"));
            Status::Running
        }

        fn on_running(&mut self, _: &Skill, _: Instant) -> Status {
            Status::Running
        }

        fn on_halted(&mut self, leaf: &Skill, _: Instant) -> Halt {
            self.calls.push(format!("halt {leaf:?}"));
            Halt::Done
        }

        fn transition(&mut self, _: StatusChange) {
            self.transitions += 1;
        }
    }

    #[test]
    fn robots_share_a_tree_and_each_has_its_own_memory() {
        let tree: BoundTree<Skill> = instance(TREE).bind(find).unwrap();
        let mut robots = [Robot { low: true, ..Robot::default() }, Robot::default()];
        let mut memories = [vec![NodeMemory::NEW; tree.len()], vec![NodeMemory::NEW; tree.len()]];
        for tick in 0..2 {
            for (robot, memory) in robots.iter_mut().zip(&mut memories) {
                assert_eq!(tree.tick(memory, robot, Instant(tick)).status, Status::Running);
            }
        }
        let running = memories.each_ref().map(|memory| tree.running(memory));
        let place = |name: &str| Skill::GoTo(name.into());
        assert_eq!(running, [Some(&place("dock")), Some(&place("field"))]);
        assert_eq!(robots[0].calls, ["start GoTo(\"dock\")"]);
        assert_eq!(robots[1].calls, ["start GoTo(\"field\")"]);

        let [memory, other] = &mut memories;
        assert_eq!(tree.halt(memory, &mut robots[0], Instant(2)), Halt::Done);
        assert_eq!(robots[0].calls[1..], ["halt GoTo(\"dock\")"]);
        assert_eq!((tree.running(memory), tree.running(other)), (None, Some(&place("field"))));
        assert!(robots[0].transitions >= 6, "the robot is told what its tree does");
    }

    #[test]
    fn a_leaf_that_the_program_does_not_have_is_named_with_its_place() {
        let text = TREE.replace("field", "moon");
        let error = instance(&text).bind(find).unwrap_err();
        assert_eq!(error.message, "nothing is called GoTo moon");
        assert_eq!(error.place.line, 1 + text[..text.find("moon").unwrap()].matches('\n').count());
    }

    #[test]
    fn a_script_is_no_leaf() {
        let error = instance(&file(r#"<Script name="count" code="n := 1"/>"#)).bind(find).unwrap_err();
        assert_eq!(error.message, "'count' is more than a leaf");
    }
}
