//! The guards on which the rounds rest. Each is taken out of a copy of the code in turn, and the
//! test that names what it is for must fail.
//!
//! The copy holds every guard beside what stands there without it, and is built once: which guard
//! is out is told to each run. `tests/nightly` does it; the table itself is checked with the other
//! tests.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// One guard.
struct Guard {
    name: &'static str,
    file: &'static str,
    /// The code that is the guard, once in its file, and what stands there without it: expressions
    /// or statements.
    code: &'static str,
    without: &'static str,
    /// A test that fails without it.
    caught_by: &'static str,
}

const fn guard(
    name: &'static str,
    file: &'static str,
    code: &'static str,
    without: &'static str,
    caught_by: &'static str,
) -> Guard {
    Guard { name, file, code, without, caught_by }
}

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

#[test]
fn every_guard_is_where_the_table_says_and_has_a_test() {
    for Guard { name, file, code, without, caught_by } in GUARDS {
        let source = fs::read_to_string(Path::new(ROOT).join(file)).expect(file);
        assert_eq!(source.matches(code).count(), 1, "{name}: {code:?} in {file}");
        assert_ne!(code, without, "{name}");
        let (module, test) = caught_by.split_once("::").expect("a module and a test");
        let tests = fs::read_to_string(format!("{ROOT}/tests/rounds/{module}.rs")).expect(module);
        assert!(tests.contains(&format!("#[test]\nfn {test}() {{")), "{name}: no test {caught_by}");
    }
}

#[test]
#[ignore = "a build of the core and a run for each guard: tests/nightly"]
fn no_guard_can_be_taken_out_unseen() {
    let copy = Path::new(env!("CARGO_TARGET_TMPDIR")).join("guards");
    copy_rounds(&copy);
    make_guards_removable(&copy);
    let build = cargo(&copy, &["--no-run"]).output().expect("cargo starts");
    assert!(build.status.success(), "{}", String::from_utf8_lossy(&build.stderr));
    assert!(passes(&copy, "", None), "the copy passes as it is");
    let is_missed = |&(number, guard): &(usize, &Guard)| {
        let is_missed = !passes(&copy, guard.caught_by, Some(number));
        println!("{}: {}", guard.name, if is_missed { guard.caught_by } else { "NOT CAUGHT" });
        is_missed
    };
    let unseen = GUARDS.iter().enumerate().filter(|guard| !is_missed(guard));
    assert_eq!(unseen.map(|(_, guard)| guard.name).collect::<Vec<_>>(), [""; 0]);
}

/// Puts a choice in the place of each guard: the code that is the guard, or what stands there
/// without it.
fn make_guards_removable(copy: &Path) {
    for (number, Guard { file, code, without, .. }) in GUARDS.iter().enumerate() {
        // A place can have several guards: only the first of them brings the code.
        if GUARDS[..number].iter().any(|other| (other.file, other.code) == (*file, *code)) {
            continue;
        }
        let path = copy.join(file);
        let source = fs::read_to_string(&path).expect("it was copied");
        let others = GUARDS.iter().enumerate().skip(number + 1);
        let others = others.filter(|(_, other)| (other.file, other.code) == (*file, *code));
        let more: String = others
            .map(|(number, other)| format!("else if {IS_OUT}({number}) {{ {} }} ", other.without))
            .collect();
        let choice = format!("{{ if {IS_OUT}({number}) {{ {without} }} {more}else {{ {code} }} }}");
        fs::write(path, source.replace(code, &choice)).expect("the copy can be written");
    }
    let library = copy.join("iibt-core/src/lib.rs");
    let source = fs::read_to_string(&library).expect("it was copied");
    let source = source.replacen("#[cfg(test)]\nextern crate std;", "extern crate std;", 1);
    fs::write(library, format!("{source}{CHOICE}")).expect("the copy can be written");
    // What asks for a choice is no constant.
    let view = copy.join(VIEW);
    let source = fs::read_to_string(&view).expect("it was copied");
    fs::write(view, source.replace("const fn is_quorum", "fn is_quorum")).expect("the copy can be written");
}

/// Asks whether the guard of a number is out, in the core and in what uses it.
const IS_OUT: &str = "::iibt_core::is_out";

const CHOICE: &str = r#"
extern crate self as iibt_core;

/// Whether the guard of this number is out, by the environment.
pub fn is_out(guard: usize) -> bool {
    static OUT: std::sync::OnceLock<Option<usize>> = std::sync::OnceLock::new();
    *OUT.get_or_init(|| std::env::var("GUARD_OUT").ok()?.parse().ok()) == Some(guard)
}
"#;

/// Whether the tests of the copy with this name pass, without the guard of this number.
fn passes(copy: &Path, name: &str, out: Option<usize>) -> bool {
    // The table is of the code as it is.
    let mut command = cargo(copy, &["--", "--skip", "guards::", name]);
    if let Some(guard) = out {
        command.env("GUARD_OUT", guard.to_string());
    }
    command.output().expect("cargo starts").status.success()
}

/// The tests of the copy.
fn cargo(copy: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO"));
    command
        .current_dir(copy)
        .args(["test", "--offline", "-p", "tests", "--test", "rounds"])
        .args(arguments)
        .env_remove("RUSTFLAGS")
        .env_remove("GUARD_OUT");
    command
}

/// The core, and of the tests those of the rounds, as a workspace of their own.
fn copy_rounds(to: &Path) {
    let _ = fs::remove_dir_all(to);
    for folder in ["iibt-core", "tests/rounds"] {
        copy(&Path::new(ROOT).join(folder), &to.join(folder));
    }
    for file in ["Cargo.lock", "rust-toolchain.toml", "README.md"] {
        fs::copy(Path::new(ROOT).join(file), to.join(file)).expect(file);
    }
    let workspace = fs::read_to_string(format!("{ROOT}/Cargo.toml")).expect("the workspace has a manifest");
    let is_elsewhere = |line: &&str| !["members", "default-members"].iter().any(|key| line.starts_with(key));
    let workspace: Vec<&str> = workspace.lines().filter(is_elsewhere).collect();
    let workspace = workspace
        .join("\n")
        .replacen("[workspace]", "[workspace]\nmembers = [\"iibt-core\", \"tests\"]", 1)
        .replacen("[profile.dev.package.host-sim]\nopt-level = 2\n", "", 1);
    fs::write(to.join("Cargo.toml"), workspace).expect("the copy can be written");
    fs::write(to.join("tests/Cargo.toml"), MANIFEST).expect("the copy can be written");
    fs::write(to.join("tests/lib.rs"), "").expect("the copy can be written");
}

const MANIFEST: &str = r#"
[package]
name = "tests"
version = "0.0.0"
edition = "2024"
autotests = false

[lib]
path = "lib.rs"

[[test]]
name = "rounds"
path = "rounds/main.rs"

[dependencies]
iibt-core = { workspace = true, features = ["inference"] }
serde.workspace = true
"#;

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("the copy can be written");
    for entry in fs::read_dir(from).expect("the folder is there") {
        let path: PathBuf = entry.expect("it can be read").path();
        let target = to.join(path.file_name().expect("it has a name"));
        if path.is_dir() {
            copy(&path, &target);
        } else {
            fs::copy(&path, &target).expect("the copy can be written");
        }
    }
}

#[rustfmt::skip]
const GUARDS: &[Guard] = &[
    guard("the epochs are under the digest", FACTS,
        "sum.absorb(&member)",
        "sum.absorb(member.1)",
        "scores::rule_4_every_fact_epoch_and_wall_and_the_mission_are_under_the_digest"),
    guard("who gives is a member of a quorum", FACTS,
        "        self.is_seated(self.proposal.view)?;\n",
        "",
        "members::rule_2_a_robot_that_is_left_out_joins_and_does_nothing_more"),
    guard("all members know the round alike", FACTS,
        "heard.message.proposal != self.proposal",
        "heard.message.proposal.walls.is_full()",
        "scores::rule_4_a_round_that_two_lives_of_a_robot_have_opened_is_void"),
    guard("no two members claim one place", FACTS,
        "        self.is_disjoint(teammates)?;\n",
        "",
        "scores::rule_4_two_members_on_one_place_are_not_believed"),
    guard("members check the walls", FACTS,
        "        self.accepts_walls(self.is_vouched(digest, teammates))?;\n",
        "",
        "scores::rule_4_a_robot_that_has_started_again_leaves_nobody_out"),
    guard("an earlier start is not heard", FACTS,
        "teammates.get(robot).filter(|&heard| self.is_current(robot, heard))",
        "teammates.get(robot)",
        "moves::rule_7_an_epoch_that_goes_back_is_ignored"),
    guard("scores count for one digest", FACTS,
        "digest.is_some() && digest == self.digest()",
        "digest.is_some() && self.digest().is_some()",
        "scores::rule_4_scores_of_other_facts_make_the_round_void"),
    guard("an epoch other than the one under the digest is seen", FACTS,
        "epoch.is_some_and(|&epoch| epoch != heard.stamp.epoch)",
        "epoch.is_some_and(|&epoch| epoch > heard.stamp.epoch)",
        "moves::rule_6_nobody_moves_while_a_member_is_not_in_the_plan"),
    guard("a robot joins standing", PROTOCOL,
        "is_standing && self.join(fact, teammates)",
        "self.join(fact, teammates)",
        "members::rule_2_a_robot_joins_the_newest_round_standing_and_freezes_its_fact"),
    guard("a view is a quorum", PROTOCOL,
        "!view.is_quorum(team)",
        "view.is_empty()",
        "members::rule_3_who_opens_is_a_member_of_a_quorum_and_knows_where_the_others_are"),
    guard("nobody opens without a robot that may be anywhere", PROTOCOL,
        "left_out.iter().find(|&robot| self.reach(robot).is_none())",
        "None",
        "members::rule_3_who_opens_is_a_member_of_a_quorum_and_knows_where_the_others_are"),
    guard("a wall is where the robot left out may be", PROTOCOL,
        "self.reach(robot).cloned().unwrap_or(F::Claim::EMPTY)",
        "F::Claim::EMPTY",
        "members::rule_3_who_opens_is_a_member_of_a_quorum_and_knows_where_the_others_are"),
    guard("a refused wall is united with the own", PROTOCOL,
        "wall.union(&reach)",
        "reach",
        "scores::rule_4_a_member_that_knows_more_refuses_the_walls_and_both_are_united"),
    guard("scores are given once", PROTOCOL,
        "self.given.is_some() || self.common(teammates)? != digest",
        "self.common(teammates)? != digest",
        "scores::rule_4_scores_are_given_once_for_the_same_facts_of_all"),
    guard("scores are of the present facts", PROTOCOL,
        "self.given.is_some() || self.common(teammates)? != digest",
        "self.given.is_some() || self.common(teammates).is_err()",
        "scores::rule_4_scores_of_a_list_from_other_facts_are_refused"),
    guard("what was heard counts before scores widen", PROTOCOL,
        "// scores widen.\n        self.hear(teammates, list);\n",
        "",
        "moves::rule_7_what_was_heard_before_scores_narrows_nothing_after_them"),
    guard("the reach widens before scores are sent", PROTOCOL,
        "        self.widen(list);\n",
        "",
        "moves::rule_7_where_a_teammate_may_be_grows_before_scores_and_shrinks_with_its_reports"),
    guard("all scores are known", PROTOCOL,
        "self.scores(teammates).count() < self.proposal.view.len()",
        "self.scores(teammates).count() < 1",
        "scores::rule_5_all_who_know_all_scores_decide_alike"),
    guard("who joins forgets the old plan", PROTOCOL,
        "        self.given = None;\n",
        "",
        "members::rule_2_a_robot_joins_the_newest_round_standing_and_freezes_its_fact"),
    guard("a fact is frozen", PROTOCOL,
        "is_standing && self.join(fact, teammates)",
        "{ self.fact = fact.clone(); is_standing && self.join(fact, teammates) }",
        "members::rule_2_a_robot_joins_the_newest_round_standing_and_freezes_its_fact"),
    guard("every robot has numbers of its own", PROTOCOL,
        "self.proposal.round.checked_add(ahead)",
        "self.proposal.round.checked_add(ahead.min(1))",
        "members::rule_3_every_robot_opens_rounds_of_its_own_numbers_until_none_are_left"),
    guard("the numbers of rounds do not begin again", PROTOCOL,
        "self.proposal.round.checked_add(ahead)",
        "Some(self.proposal.round.wrapping_add(ahead))",
        "members::rule_3_every_robot_opens_rounds_of_its_own_numbers_until_none_are_left"),
    guard("no scores while a robot left out may be anywhere", PROTOCOL,
        "{ return Err(Waiting::Unheard(robot)) }",
        "{ continue }",
        "scores::rule_4_a_robot_that_has_started_again_leaves_nobody_out"),
    guard("a wall contains the reach", PROTOCOL,
        "!wall.is_some_and(|wall| wall.contains(reach))",
        "wall.is_none()",
        "scores::rule_4_a_member_that_knows_more_refuses_the_walls_and_both_are_united"),
    guard("the round of an earlier start is not joined", PROTOCOL,
        "self.is_current(robot, heard)",
        "let _ = (robot, heard); true",
        "moves::rule_7_an_epoch_that_goes_back_is_ignored"),
    guard("scores under an epoch that is over are taken back", FACTS,
        "is_in_round(robot) && has_restarted(robot)",
        "is_in_round(robot) && has_restarted(robot) && F::LASTS",
        "scores::rule_4c_scores_under_an_epoch_that_is_over_are_taken_back"),
    guard("what was decided is not taken back", FACTS,
        "given.plan.is_none()",
        "true",
        "moves::rule_6_nobody_moves_while_a_member_is_not_in_the_plan"),
    guard("older rounds do not tell where a robot is", REACH,
        "stamp < location.known",
        "stamp < (0, 0)",
        "moves::rule_7_an_epoch_that_goes_back_is_ignored"),
    guard("a new start believes only an answer", REACH,
        "stamp > location.known && location.reach.is_answered()",
        "stamp > location.known",
        "moves::rule_7_a_robot_that_has_started_believes_nothing_that_does_not_answer_its_start"),
    guard("the word of others stands until an answer", REACH,
        "stamp > location.known && location.reach.is_answered()",
        "stamp > location.known && location.reach.claim().is_some()",
        "scores::rule_4e_a_robot_that_has_started_takes_the_word_of_a_quorum_that_has_scored"),
    guard("the word of others is that of a quorum", FACTS,
        "self.others().filter(has_scored).collect::<View>().is_quorum(self.member.team())",
        "self.others().filter(has_scored).count() > 1",
        "scores::rule_4e_the_half_of_a_team_without_robot_0_gives_nobody_its_word"),
    guard("the word of others is their scores", FACTS,
        "self.others().filter(has_scored).collect::<View>().is_quorum(self.member.team())",
        "{ let _ = has_scored; self.others().collect::<View>().is_quorum(self.member.team()) }",
        "scores::rule_4e_a_robot_that_has_started_takes_the_word_of_a_quorum_that_has_scored"),
    guard("who knows where a robot is takes nobody's word", PROTOCOL,
        "reach.is_none() && is_vouched",
        "is_vouched",
        "scores::rule_4e_a_robot_that_knows_more_takes_nobodys_word"),
    guard("the reach is the rest of the path", REACH,
        "list.claim((*policy).into(), robot, step)",
        "list.claim((*policy).into(), robot, u16::MAX)",
        "moves::rule_7_where_a_teammate_may_be_grows_before_scores_and_shrinks_with_its_reports"),
    guard("the reach is all paths before the choice", REACH,
        "any_of(list, robot, step, anchor)",
        "anchor",
        "moves::rule_7_before_the_choice_a_teammate_may_be_on_any_path"),
    guard("walls are remembered", REACH,
        "                location.reach = location.reach.with(wall);\n",
        "                drop(wall);\n",
        "scores::rule_4_a_member_that_knows_more_refuses_the_walls_and_both_are_united"),
    guard("the reach is widened by all policies", REACH,
        "any_of(list, robot, 0, reach)",
        "reach",
        "moves::rule_7_where_a_teammate_may_be_grows_before_scores_and_shrinks_with_its_reports"),
    guard("the order of the plan", EXECUTION,
        "!list.is_clear(policy, own, step, robot, reported)",
        "reported == u16::MAX",
        "moves::rule_6_a_place_is_entered_when_the_one_before_has_reported_that_it_left"),
    guard("members are in the round", EXECUTION,
        "        if let Err(missing) = self.is_in_round(robot, teammates) {\n            return Some(missing);\n        }\n",
        "",
        "moves::rule_7_an_epoch_that_goes_back_is_ignored"),
    guard("members have scored the same", EXECUTION,
        "!self.follows(heard)",
        "heard.message.proposal.round != self.proposal.round",
        "scores::rule_4_scores_of_other_facts_make_the_round_void"),
    guard("members have scored", EXECUTION,
        "heard.message.answer.digest()",
        "if heard.message.answer.digest().is_none() { return None } heard.message.answer.digest()",
        "scores::rule_5_all_who_know_all_scores_decide_alike"),
    guard("the barrier", EXECUTION,
        "is_last && reported.saturating_add(1) < theirs()",
        "is_last && reported > theirs()",
        "moves::rule_6b_the_last_moves_wait_for_each_other"),
    guard("half of a team needs robot 0", VIEW,
        "(twice == team && self.contains(RobotId(0)))",
        "twice == team",
        "patience::rule_8_without_a_quorum_or_before_all_were_heard_the_state_has_a_name"),
    guard("walls are in nobody's plan", "tests/rounds/grid.rs",
        "proposal.walls.iter().fold(Places::EMPTY, |all, wall| all.union(wall))",
        "Places::EMPTY",
        "exploration::two_robots_open_twice"),
    guard("every start has an epoch of its own", "tests/rounds/model.rs",
        "Stamp { epoch: self.stamp.epoch + 1, sequence: 0 }",
        "self.stamp",
        "exploration::two_robots_open_once_and_one_starts_again"),
    guard("a void round is followed by another", PATIENCE,
        "trouble.is_void |= matches!(obstacle, Waiting::Outdated(_) | Waiting::Proposal(_));",
        "",
        "patience::rule_8_a_robot_that_starts_again_is_answered_by_another_round"),
    guard("a refused wall is followed by another round", PATIENCE,
        "trouble.is_void |= matches!(protocol.accepts_walls(false), Err(Waiting::Wall(_)));",
        "",
        "exploration::three_robots_at_random"),
    guard("readmission backs off", PATIENCE,
        "                acquaintance.back_off();\n",
        "",
        "patience::rule_8_a_robot_that_is_lost_again_and_again_waits_longer_each_time"),
    guard("who comes back from a long silence is waited for longer", PATIENCE,
        "self.longest_silence.saturating_mul(3)",
        "0_u16",
        "patience::rule_8_who_was_silent_long_and_came_back_is_waited_for_longer"),
    guard("however long the silence, the wait ends", PATIENCE,
        "usual.saturating_mul(Timing::MOST_PATIENCE)",
        "u16::MAX",
        "patience::rule_8_who_was_silent_long_and_came_back_is_waited_for_longer"),
    guard("a new start ends no silence", PATIENCE,
        "is_known && stamp != self.stamp",
        "stamp != self.stamp",
        "patience::rule_8_the_silence_before_a_new_start_is_none_from_which_a_robot_came_back"),
    guard("a robot whose link is gone stands", PATIENCE,
        "protocol.has_moves_left(list) && !self.hears_any(protocol, teammates)",
        "false",
        "patience::rule_8_a_robot_that_hears_nobody_does_not_drive_its_plan_to_the_end"),
    guard("who stands outside is taken in", PATIENCE,
        "protocol.proposal().view.union(back)",
        "protocol.proposal().view",
        "patience::rule_8_who_blocks_in_silence_is_left_out_and_taken_in_again"),
    guard("who is lost is left out", PATIENCE,
        "grown.difference(self.lost(protocol))",
        "grown",
        "patience::rule_8_who_blocks_in_silence_is_left_out_and_taken_in_again"),
    guard("wishes are rationed", PATIENCE,
        "self.refractory == 0",
        "true",
        "patience::rule_8_a_robot_does_not_want_two_rounds_within_the_refractory_time"),
    guard("a round that is being decided goes first", PATIENCE,
        "is_due && protocol.has_decided()",
        "is_due",
        "patience::rule_8_a_robot_does_not_want_two_rounds_within_the_refractory_time"),
    guard("trouble is for one of them to end", PATIENCE,
        "2 + 2 * u16::from(protocol.member().robot().0)",
        "2",
        "patience::rule_8_a_robot_that_starts_again_is_answered_by_another_round"),
];

const FACTS: &str = "iibt-core/src/team/rounds/facts.rs";
const PROTOCOL: &str = "iibt-core/src/team/rounds/protocol.rs";
const REACH: &str = "iibt-core/src/team/rounds/reach.rs";
const EXECUTION: &str = "iibt-core/src/team/rounds/execution.rs";
const VIEW: &str = "iibt-core/src/team/rounds/view.rs";
const PATIENCE: &str = "iibt-core/src/team/rounds/patience.rs";
