//! The rules of BehaviorTree.CPP's nodes, one test each: scripted leaves in, traces out.
//!
//! A leaf is a letter. `a=RS` returns running, then success, and repeats the last; K is skipped.
//! Ticks are 10 ms apart. In a trace `!` stands for a tick after which the tree wants the next one
//! at once.

use iibt_core::time::Instant;
use iibt_core::tree;
use iibt_core::tree::{Compat, Full, Halt, Log, Memory, Next, Node, Status, Tree, TreeRule};

#[path = "trees/script.rs"]
mod script;

use script::{Script, end, plays};

/// One test: a tree of the full set, its script, and what each tick does.
macro_rules! rule {
    ($(#[$doc:meta])* $name:ident: { $($tree:tt)* } $($lines:literal => [$($expected:literal),* $(,)?])+) => {
        $(#[$doc])*
        #[test]
        fn $name() {
            const NODES: usize = nodes(stringify!($($tree)*));
            const TREE: Tree<char, NODES, Full> = tree! { $($tree)* };
            $(plays(TREE, $lines, &[$($expected),*]);)+
        }
    };
}

/// Counts the nodes of a written tree: each has a name that begins with a capital letter.
const fn nodes(text: &str) -> usize {
    let bytes = text.as_bytes();
    let (mut at, mut count) = (0, 0);
    while at < bytes.len() {
        let begins = at == 0 || !(bytes[at - 1].is_ascii_alphanumeric() || bytes[at - 1] == b':');
        if bytes[at].is_ascii_uppercase() && begins {
            count += 1;
        }
        // `Status::Failure` is an argument and no node.
        if at >= 2 && bytes[at - 1] == b':' && bytes[at - 2] == b':' {
            count -= 1;
        }
        at += 1;
    }
    count
}

rule!(a_guard_that_fails_halts_what_runs_behind_it:
    { ReactiveSequence { Condition('g'), Sequence { Action('a'), Action('b') } } }
    "g=SFS a=S b=R" => ["g:S a:S b:R => R", "g:F halt(b) => F", "g:S a:S b:R => R"]);

rule!(a_sequence_resumes_and_resets_on_failure:
    { Sequence { Action('a'), Action('b'), Action('c') } }
    "a=S b=RS c=FS" => ["a:S b:R => R", "b:S c:F => F", "a:S b:S c:S => S"]);

rule!(a_sequence_of_skipped_children_is_skipped:
    { Sequence { Action('a'), Action('b'), Action('c') } }
    "a=K b=K c=K" => ["a:K b:K c:K => K"]
    "a=K b=S c=K" => ["a:K b:S c:K => S"]
    "a=S b=K c=K" => ["a:S b:K c:K => S"]
    "a=K b=RK c=K" => ["a:K b:R => R", "b:K c:K => K"]
    "a=KS b=RKK c=K" => ["a:K b:R => R", "b:K c:K => K", "a:S b:K c:K => S"]);

rule!(a_halt_resets_the_place_of_a_sequence:
    { Sequence { Action('a'), Action('b') } }
    "a=S b=R" => ["a:S b:R => R", "halt: halt(b)", "a:S b:R => R", "halt: halt(b)", "halt:"]);

rule!(a_fallback_is_the_mirror_image:
    { Fallback { Action('a'), Action('b'), Action('c') } }
    "a=F b=RF c=SF" => ["a:F b:R => R", "b:F c:S => S", "a:F b:F c:F => F"]
    "a=K b=K c=K" => ["a:K b:K c:K => K"]
    "a=K b=F c=K" => ["a:K b:F c:K => F"]);

rule!(a_sequence_with_memory_retries_the_child_that_failed:
    { SequenceWithMemory { Action('a'), Action('b'), Action('c') } }
    "a=S b=FS c=S" => ["a:S => R!", "b:F => F", "b:S => R!", "c:S => S", "a:S => R!"]);

rule!(a_sequence_with_memory_keeps_its_place_when_it_is_halted:
    { SequenceWithMemory { Action('a'), Action('b') } }
    "a=S b=RRS" => ["a:S => R!", "b:R => R", "halt: halt(b)", "b:R => R", "b:S => S", "a:S => R!"]);

rule!(a_sequence_with_memory_does_not_yield_after_a_child_that_was_running:
    { SequenceWithMemory { Action('a'), Action('b'), Action('c') } }
    "a=RS b=S c=S" => ["a:R => R", "a:S b:S => R!", "c:S => S"]
    "a=K b=K c=K" => ["a:K b:K c:K => K"]);

rule!(a_reactive_sequence_begins_at_its_first_child_and_halts_the_others:
    { ReactiveSequence { Action('a'), Action('b'), Action('c') } }
    "a=SSR b=SRS c=R" => ["a:S b:S c:R => R", "a:S b:R halt(c) => R", "a:R halt(b) => R"]
    "a=K b=K c=K" => ["a:K b:K c:K => K"]
    "a=KS b=K c=RK" => ["a:K b:K c:R => R", "a:S b:K c:K => S"]);

rule!(a_reactive_fallback_begins_at_its_first_child_and_halts_the_others:
    { ReactiveFallback { Action('a'), Action('b') } }
    "a=FRFS b=R" => ["a:F b:R => R", "a:R halt(b) => R", "a:F b:R => R", "a:S halt(b) => S"]);

rule!(an_async_sequence_yields_after_each_child_that_succeeds_at_once:
    { AsyncSequence { Action('a'), Action('b'), Action('c') } }
    "a=S b=RS c=S" => ["a:S => R!", "b:R => R", "b:S c:S => S"]
    "a=S b=S c=S" => ["a:S => R!", "halt:", "a:S => R!", "b:S => R!", "c:S => S"]
    "a=SK b=F c=S" => ["a:S => R!", "b:F => F", "a:K b:F => F"]);

rule!(an_async_fallback_yields_after_each_child_that_fails_at_once:
    { AsyncFallback { Action('a'), Action('b') } }
    "a=F b=F" => ["a:F => R!", "b:F => F", "a:F => R!"]);

rule!(a_parallel_node_stops_at_its_threshold_and_halts_the_rest:
    { Parallel(2, 2) { Action('a'), Action('b'), Action('c'), Action('d') } }
    "a=RS b=S c=R d=R" => ["a:R b:S c:R d:R => R", "a:S halt(c) halt(d) => S", "a:S b:S => S"]
    "a=F b=RF c=R d=S" => ["a:F b:R c:R d:S => R", "b:F halt(c) => F"]);

rule!(a_parallel_node_counts_negative_thresholds_from_all:
    { Parallel(-2, -1) { Action('a'), Action('b'), Action('c') } }
    "a=F b=S c=RS" => ["a:F b:S c:R => R", "c:S => S"]
    "a=F b=F c=S" => ["a:F b:F => F"]
    "a=K b=S c=R" => ["a:K b:S => S"]);

rule!(a_parallel_node_ticks_skipped_children_again:
    { Parallel(2, 1) { Action('a'), Action('b'), Action('c') } }
    "a=KS b=S c=K" => ["a:K b:S c:K => R", "a:S => S"]
    "a=K b=K c=K" => ["a:K b:K c:K => K"]);

rule!(a_parallel_node_that_is_halted_begins_anew:
    { Parallel(2, 1) { Action('a'), Action('b') } }
    "a=S b=R" => ["a:S b:R => R", "halt: halt(b)", "a:S b:R => R"]);

rule!(parallel_all_waits_for_all:
    { ParallelAll(2) { Action('a'), Action('b'), Action('c') } }
    "a=F b=F c=RS" => ["a:F b:F c:R => R", "c:S => F", "a:F b:F c:S => F"]
    "a=F b=S c=S" => ["a:F b:S c:S => S"]
    "a=F b=K c=S" => ["a:F b:K c:S => S"]
    "a=K b=K c=K" => ["a:K b:K c:K => K"]);

rule!(if_then_else_does_not_ask_again_while_the_branch_runs:
    { IfThenElse { Action('i'), Action('a'), Action('b') } }
    "i=SF a=RS b=S" => ["i:S a:R => R", "a:S => S", "i:F b:S => S"]
    "i=R a=S b=S" => ["i:R => R"]
    "i=K a=S b=S" => ["i:K => K"]);

rule!(if_then_without_else_fails:
    { IfThenElse { Action('i'), Action('a') } }
    "i=F a=S" => ["i:F => F"]);

rule!(while_do_else_asks_at_every_tick_and_halts_the_other_branch:
    { WhileDoElse { Action('i'), Action('a'), Action('b') } }
    "i=SSFFS a=R b=R" => ["i:S a:R => R", "i:S a:R => R", "i:F halt(a) b:R => R", "i:F b:R => R", "i:S halt(b) a:R => R"]
    "i=SR a=R b=S" => ["i:S a:R => R", "i:R => R", "halt: halt(i) halt(a)"]);

rule!(while_do_without_else_fails_and_halts:
    { WhileDoElse { Action('i'), Action('a') } }
    "i=SF a=R" => ["i:S a:R => R", "i:F halt(a) => F"]);

rule!(a_switch_halts_the_case_it_leaves:
    { Switch('v') { Action('a'), Action('b'), Action('d') } }
    "v=01x0 a=R b=S d=R" => ["v:0 a:R => R", "v:1 halt(a) b:S => S", "v:x d:R => R", "v:0 halt(d) a:R => R"]);

rule!(an_inverter_passes_running_and_skipped:
    { Inverter { Action('a') } }
    "a=RSFK" => ["a:R => R", "a:S => F", "a:F => S", "a:K => K"]);

rule!(force_success_passes_running_and_skipped:
    { ForceSuccess { Action('a') } }
    "a=RFSK" => ["a:R => R", "a:F => S", "a:S => S", "a:K => K"]);

rule!(force_failure_passes_running_and_skipped:
    { ForceFailure { Action('a') } }
    "a=RFSK" => ["a:R => R", "a:F => F", "a:S => F", "a:K => K"]);

rule!(keep_running_until_failure_turns_success_into_running:
    { KeepRunningUntilFailure { Action('a') } }
    "a=SRKF" => ["a:S => R", "a:R => R", "a:K => R", "a:F => F"]);

rule!(retry_yields_after_each_attempt_and_gives_up:
    { RetryUntilSuccessful(3) { Action('a') } }
    "a=F" => ["a:F => R!", "a:F => R!", "a:F => F", "a:F => R!"]
    "a=FS" => ["a:F => R!", "a:S => S"]);

rule!(retry_loops_in_the_same_tick_after_a_child_that_was_running:
    { RetryUntilSuccessful(5) { Action('a') } }
    "a=RFRFFS" => ["a:R => R", "a:F a:R => R", "a:F a:F => R!", "a:S => S"]);

rule!(the_count_of_a_retry_is_reset_by_a_halt:
    { RetryUntilSuccessful(2) { Action('a') } }
    "a=F" => ["a:F => R!", "halt:", "a:F => R!", "a:F => F"]);

rule!(repeat_counts_successes_and_ends_with_a_failure:
    { Repeat(3) { Action('a') } }
    "a=S" => ["a:S => R!", "a:S => R!", "a:S => S"]
    "a=SF" => ["a:S => R!", "a:F => F"]
    "a=SK" => ["a:S => R!", "a:K => K"]);

rule!(repeat_without_end_repeats:
    { Repeat(-1) { Action('a') } }
    "a=S" => ["a:S => R!", "a:S => R!", "a:S => R!"]);

/// Nothing below a loop of zero rounds is ever ticked, which `Tree` refuses: so the table is built
/// by hand.
#[test]
fn zero_rounds_end_without_a_tick() {
    use iibt_core::tree::{NodeMemory, Row, Times, TreeRef};
    for (node, status) in [
        (Node::Repeat(Times::new(0)), Status::Success),
        (Node::RetryUntilSuccessful(Times::new(0)), Status::Failure),
    ] {
        assert_eq!(
            Tree::<_, 2, Full>::try_new([node, Node::Action('a')]).unwrap_err().rule,
            TreeRule::NeverTicked
        );
        let mut rows = [Row::new(node), Row::new(Node::Action('a'))];
        let tree = TreeRef::<_, Full>::try_new(&mut rows).unwrap();
        let mut script = Script::new("a=S");
        assert_eq!(tree.tick(&mut [NodeMemory::NEW; 2], &mut script, Instant(0)).status, status);
        assert_eq!(script.trace, "");
    }
}

rule!(a_timeout_halts_its_child_and_fails:
    { Timeout(20) { Action('a') } }
    "a=R" => ["a:R => R", "a:R => R", "halt(a) => F", "a:R => R"]
    "a=RS" => ["a:R => R", "a:S => S"]);

rule!(a_timeout_of_zero_is_no_limit:
    { Timeout(0) { Action('a') } }
    "a=R" => ["a:R => R", "a:R => R", "a:R => R"]);

rule!(a_delay_waits_before_its_child:
    { Delay(20) { Action('a') } }
    "a=RS" => ["=> R", "=> R", "a:R => R", "a:S => S", "=> R"]);

rule!(a_halted_delay_begins_anew:
    { Delay(20) { Action('a') } }
    "a=R" => ["=> R", "=> R", "halt:", "=> R", "=> R", "a:R => R"]);

rule!(a_sleep_succeeds_when_its_time_has_passed:
    { Sequence { Sleep(20), Action('a') } }
    "a=S" => ["=> R", "=> R", "a:S => S"]);

rule!(constant_leaves_are_constant:
    { Fallback { Inverter { AlwaysSuccess() }, Inverter { Inverter { AlwaysFailure() } }, Action('a') } }
    "a=S" => ["a:S => S"]);

rule!(run_once_is_skipped_afterwards:
    { Sequence { RunOnce(true) { Action('a') }, Action('b') } }
    "a=RS b=SR" => ["a:R => R", "a:S b:S => S", "b:R => R"]);

rule!(run_once_may_repeat_its_status:
    { RunOnce(false) { Action('a') } }
    "a=RF" => ["a:R => R", "halt: halt(a)", "a:F => F", "=> F"]);

rule!(run_once_is_not_reset_by_a_halt:
    { Sequence { RunOnce(true) { Action('a') }, Action('b') } }
    "a=S b=R" => ["a:S b:R => R", "halt: halt(b)", "b:R => R"]);

rule!(a_precondition_is_asked_at_every_tick:
    { Precondition('g', Status::Skipped) { Action('a') } }
    "g=FSSF a=R" => ["g:F => K", "g:S a:R => R", "g:S a:R => R", "g:F halt(a) => K"]);

#[test]
fn in_compat_a_precondition_is_not_asked_again_while_its_child_runs() {
    let tree: Tree<char, 2, Compat> = tree! { Precondition('g', Status::Failure) { Action('a') } };
    plays(tree, "g=SF a=RS", &["g:S a:R => R", "a:S => S", "g:F => F"]);
}

rule!(a_subtree_passes_its_status_on:
    { SubTree { Sequence { Action('a'), Action('b') } } }
    "a=S b=RK" => ["a:S b:R => R", "b:K => S"]);

rule!(a_pipeline_ticks_earlier_children_again:
    { PipelineSequence { Action('a'), Action('b'), Action('c') } }
    "a=SRS b=SR c=RRS" => ["a:S b:S c:R => R", "a:R b:R c:R => R", "a:S b:R c:S halt(b) => S"]
    "a=SF b=R c=S" => ["a:S b:R => R", "a:F halt(b) => F"]);

rule!(a_round_robin_goes_on_where_it_ended:
    { RoundRobin { Action('a'), Action('b'), Action('c') } }
    "a=S b=F c=S" => ["a:S => S", "b:F c:S => S", "a:S => S"]
    "a=F b=F c=F" => ["a:F b:F c:F => F", "a:F b:F c:F => F"]
    "a=K b=K c=K" => ["a:K b:K c:K => K"]);

rule!(a_recovery_is_tried_so_many_times:
    { RecoveryNode(2) { Action('a'), Action('r') } }
    "a=F r=S" => ["a:F r:S a:F r:S a:F => F"]
    "a=RFS r=RS" => ["a:R => R", "a:F r:R => R", "r:S a:S => S"]
    "a=F r=F" => ["a:F r:F => F"]);

rule!(a_rate_controller_keeps_its_rate_in_a_pipeline:
    { PipelineSequence { RateController(20) { Action('a') }, Action('b') } }
    "a=S b=R" => ["a:S b:R => R", "b:R => R", "a:S b:R => R", "b:R => R"]);

rule!(a_tree_is_halted_depth_first_from_left_to_right:
    { Parallel(3, 1) { Sequence { Action('a'), Action('b') }, Fallback { Action('c'), Action('d') }, Action('e') } }
    "a=S b=R c=R d=R e=R" => ["a:S b:R c:R e:R => R", "halt: halt(b) halt(c) halt(e)", "halt:"]);

#[test]
fn in_compat_a_halt_of_the_tree_tells_idle_actions_too() {
    let tree: Tree<char, 3, Compat> = tree! { Sequence { Action('a'), Action('b') } };
    plays(tree, "a=S b=R", &["a:S b:R => R", "halt: halt(b) halt(a) halt(b)"]);
}

#[test]
fn tick_until_idle_goes_on_while_the_tree_wakes_itself() {
    let once: Tree<char, 2, Full> = tree! { RetryUntilSuccessful(3) { Action('a') } };
    let mut script = Script::new("a=F");
    let result = once.tick_until_idle(&mut Memory::new(), &mut script, Instant(0), 100);
    assert_eq!(end(&mut script, result), "a:F a:F a:F => F");
    let for_ever: Tree<char, 2, Full> = tree! { Repeat(-1) { Action('a') } };
    let mut script = Script::new("a=S");
    let result = for_ever.tick_until_idle(&mut Memory::new(), &mut script, Instant(0), 5);
    assert_eq!(end(&mut script, result), "a:S a:S a:S a:S a:S => R!", "bounded");
    let running: Tree<char, 2, Full> = tree! { AsyncSequence { Action('a') } };
    let mut script = Script::new("a=R");
    let result = running.tick_until_idle(&mut Memory::new(), &mut script, Instant(0), 5);
    assert_eq!(end(&mut script, result), "a:R => R", "nothing to wait for");
}

#[test]
fn a_halt_may_take_several_ticks_in_which_nothing_else_is_ticked() {
    let tree: Tree<char, 5, Full> = tree! {
        Fallback { ReactiveSequence { Condition('g'), Action('a') }, Action('b') }
    };
    let mut memory = Memory::new();
    let mut script = Script::new("g=SFS a=R b=R");
    script.stopping.insert('a', 2);
    let mut traces = Vec::new();
    for tick in 0..5 {
        let result = tree.tick_until_idle(&mut memory, &mut script, Instant(tick), 9);
        traces.push(end(&mut script, result));
    }
    assert_eq!(
        traces,
        ["g:S a:R => R", "g:F halt(a) => R!", "halting(a) => R!", "halting(a) b:R => R", "b:R => R"]
    );
}

#[test]
fn a_halt_from_outside_may_be_pending() {
    let tree: Tree<char, 1, Full> = tree! { Action('a') };
    let mut memory = Memory::new();
    let mut script = Script::new("a=R");
    script.stopping.insert('a', 2);
    tree.tick(&mut memory, &mut script, Instant(0));
    assert_eq!(tree.halt(&mut memory, &mut script, Instant(1)), Halt::Pending);
    assert!(!memory.is_idle() && !memory.is_running(0));
    assert_eq!(tree.halt(&mut memory, &mut script, Instant(2)), Halt::Pending);
    assert_eq!(tree.halt(&mut memory, &mut script, Instant(3)), Halt::Done);
    assert_eq!(script.trace, "a:R halt(a) halting(a) halting(a) ");
    assert!(memory.is_idle());
}

#[test]
fn a_tick_says_when_the_next_one_can_change_something() {
    let tree: Tree<char, 5, Full> = tree! {
        Timeout(100) { Sequence { Sleep(30), Delay(50) { Action('a') } } }
    };
    let mut memory = Memory::new();
    let mut script = Script::new("a=R");
    let start = u32::MAX - 60;
    let mut next = |after: u32| tree.tick(&mut memory, &mut script, Instant(start.wrapping_add(after))).next;
    let at = |after: u32| Next::At(Instant(start.wrapping_add(after)));
    assert_eq!([next(0), next(10), next(30), next(80)], [at(30), at(30), at(80), at(100)]);
    assert_eq!(next(100), Next::Event, "it has failed");
}

#[test]
fn transitions_go_into_a_ring_that_counts_what_it_lost() {
    let tree: Tree<char, 3, Full> = tree! { Sequence { Action('a'), Action('b') } };
    let mut memory = Memory::new();
    let mut script = Script::new("a=S b=R");
    script.log = Some(Log::new());
    tree.tick(&mut memory, &mut script, Instant(5));
    tree.halt(&mut memory, &mut script, Instant(6));
    let mut log = script.log.take().unwrap();
    let seen: Vec<_> = core::iter::from_fn(|| log.pop()).map(|it| (it.time.0, it.node, it.to)).collect();
    let (success, running) = (Some(Status::Success), Some(Status::Running));
    assert_eq!(seen, [(5, 1, success), (5, 2, running), (5, 0, running), (6, 0, None), (6, 2, None)]);
    assert_eq!(log.lost(), 0);
}

#[test]
fn every_broken_rule_is_found_at_its_row() {
    use Node::*;
    use iibt_core::tree::{Millis, Times};
    fn found<const N: usize>(nodes: [Node<char>; N]) -> (u16, TreeRule) {
        let error = Tree::<char, N, Full>::try_new(nodes).unwrap_err();
        (error.node, error.rule)
    }
    let a = Action('a');
    let parallel = |success_count, failure_count| Parallel { children: 2, success_count, failure_count };
    assert_eq!(found([IfThenElse(1), a]), (0, TreeRule::Arity));
    assert_eq!(found([WhileDoElse(4), a, a, a, a]), (0, TreeRule::Arity));
    assert_eq!(found([Switch(2, 'v'), a, a]), (0, TreeRule::Arity));
    assert_eq!(found([Inverter, parallel(3, 1), a, a]), (1, TreeRule::SuccessCount));
    assert_eq!(found([parallel(-1, 3), a, a]), (0, TreeRule::FailureCount));
    assert_eq!(found([ParallelAll { children: 1, max_failures: 2 }, a]), (0, TreeRule::FailureCount));
    assert_eq!(found([Repeat(Times::new(-2)), a]), (0, TreeRule::Times));
    assert_eq!(found([Sleep(Millis::new(u32::MAX))]), (0, TreeRule::Duration));
    assert_eq!(found([RateController(Millis::new(0)), a]), (0, TreeRule::Duration));
    assert_eq!(found([Sequence(2), AlwaysFailure, a]), (2, TreeRule::NeverTicked));
    let c = Condition('c');
    assert_eq!(found([Sequence(2), Repeat(Times::FOREVER), c, a]), (3, TreeRule::NeverTicked));
    let basic = Tree::<char, 1>::try_new([AlwaysSuccess]).unwrap_err();
    assert_eq!((basic.node, basic.rule), (0, TreeRule::NotInSet));
}

#[test]
fn the_work_of_a_tick_is_known_before() {
    const PLAIN: Tree<char, 3, Full> = tree! { Sequence { Action('a'), Action('b') } };
    const WORST: u32 = PLAIN.visits();
    assert_eq!(WORST, 3, "each node once");
    let retry: Tree<char, 2, Full> = tree! { RetryUntilSuccessful(-1) { Action('a') } };
    assert_eq!(retry.visits(), 3, "the end of one attempt and the next");
    let recovery: Tree<char, 3, Full> = tree! { RecoveryNode(3) { Action('a'), Action('r') } };
    assert_eq!(recovery.visits(), 8);
}
