//! Traces that BehaviorTree.CPP itself left.

use super::*;

const RECORDED: &str = include_str!("traces.txt");

pub(super) struct Trace<'t> {
    pub(super) title: &'t str,
    pub(super) text: &'t str,
    pub(super) instance: Instance,
    pub(super) settings: DryRun<'t>,
    lines: Vec<&'t str>,
}

pub(super) fn recorded() -> Vec<Trace<'static>> {
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
    Some(Trace { title, text, instance: instance(text), settings, lines: lines.collect() })
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
