//! The trees that are built in.

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
        let kind = |kinds: &[&str]| kinds.iter().filter_map(|kind| counts.kinds.get(*kind)).sum::<usize>();
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
    assert!(once.contains("<Go name=\"a &amp; &quot;b&quot;\" to=\"{x}\" _skipIf=\"x &lt; 3\"/>"), "{once}");
    assert!(!once.contains("<Action ID=\"Go\" name"), "the explicit form is never written");
    assert_eq!(instance(&once).outline(), instance(text).outline());
}
