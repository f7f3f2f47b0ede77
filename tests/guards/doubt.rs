//! The guards of a robot in doubt: whether its readings follow its moves, and what it does while
//! they do not.

use super::{Guard, Table, guard};

/// In a copy of the packages that fly, and of the tests of navigating robots.
pub(super) const TABLE: Table = Table {
    name: "doubt",
    guards: GUARDS,
    file_of: |module| match module {
        "unit" => PROGRESS.to_owned(),
        _ => format!("tests/navigation/{module}.rs"),
    },
    packages: &["iibt-core", "firmware", "host-sim"],
    tests: &["support", "budgets.toml", "navigation.rs", "navigation"],
    manifest: r#"
[lib]
path = "support/lib.rs"

[[test]]
name = "flights"
path = "flights.rs"

[dependencies]
embedded-storage.workspace = true
firmware.workspace = true
host-sim.workspace = true
iibt-core = { workspace = true, features = ["inference", "learning"] }
object.workspace = true
serde.workspace = true
serde_json.workspace = true
toml.workspace = true
"#,
    root: ("flights.rs", "mod navigation;\n"),
    targets: &["-p", "iibt-core", "-p", "tests", "--lib", "--test", "flights"],
};

#[rustfmt::skip]
const GUARDS: &[Guard] = &[
    guard("a row of failures counts once a reading follows a move", PROGRESS,
        "doubt.filter(|_| made.is_some()).map_or(0, |doubt| doubt.moves)",
        "doubt.map_or(0, |doubt| doubt.moves)",
        "unit::a_robot_runs_into_walls_three_times_or_twice_as_often_as_its_drive_has_failed_before"),
    guard("an obstacle ahead explains a move that failed", PROGRESS,
        "self.doubt.is_some() || to.is_some()",
        "true",
        "unit::an_obstacle_ahead_explains_a_move_that_failed"),
    guard("a doubt reckons on from where its moves lead", PROGRESS,
        "leads(self.reckoned().unwrap_or(here), step)",
        "leads(here, step)",
        "progress::a_robot_whose_localiser_freezes_hits_nobody_and_stops"),
    guard("a robot whose moves fail in two directions is stuck", PROGRESS,
        "doubt.is_cornered || doubt.has_turned && doubt.odds < UNLIKELY",
        "doubt.is_cornered",
        "progress::a_localiser_that_works_again_is_believed_once_a_reading_follows_a_move"),
    guard("a robot without a safe move is stuck", PROGRESS,
        "doubt.is_cornered || doubt.has_turned && doubt.odds < UNLIKELY",
        "doubt.has_turned && doubt.odds < UNLIKELY",
        "progress::a_robot_whose_localiser_freezes_hits_nobody_and_stops"),
    guard("a row in one direction is a worn drive", PROGRESS,
        "doubt.is_cornered || doubt.has_turned && doubt.odds < UNLIKELY",
        "doubt.is_cornered || doubt.odds < UNLIKELY",
        "unit::a_row_in_one_direction_is_a_worn_drive_and_one_in_two_directions_is_not"),
    guard("moves that fail once in four hundred times are no reason", PROGRESS,
        "doubt.is_cornered || doubt.has_turned && doubt.odds < UNLIKELY",
        "doubt.is_cornered || doubt.has_turned",
        "unit::a_drive_that_is_known_to_fail_is_given_more_moves"),
    guard("a robot in doubt claims its trail", PROGRESS,
        "self.doubt.as_ref().map_or(&[], |doubt| &doubt.trail)",
        "&[]",
        "progress::a_robot_whose_localiser_freezes_hits_nobody_and_stops"),
    guard("a robot in doubt seldom runs into a wall", PROGRESS,
        "self.doubt.as_ref().is_none_or(|doubt| doubt.bumps < most)",
        "{ let _ = most; true }",
        "progress::a_robot_whose_localiser_freezes_hits_nobody_and_stops"),
    guard("a robot waits before it tries another move", PROGRESS,
        "doubt.rest == 0",
        "true",
        "lines::lines_34_to_36_a_robot_stands_while_the_next_cell_is_not_left_or_the_barrier_is_not_reached"),
    guard("each rest is twice as long", PROGRESS,
        "doubt.last_rest.saturating_mul(2).min(LONGEST_REST)",
        "doubt.last_rest",
        "unit::moves_are_tried_after_a_rest_twice_as_long_each_time_and_without_one_the_robot_is_stuck"),
    guard("a drive that is known to fail is given more moves", PROGRESS,
        "self.odds *= slip",
        "self.odds *= slip.min(0.05)",
        "unit::a_drive_that_is_known_to_fail_is_given_more_moves"),
    guard("a robot in doubt holds its plan", DOUBT,
        "self.is_in_doubt()",
        "false",
        "progress::a_robot_whose_localiser_freezes_hits_nobody_and_stops"),
    guard("the move of the plan must be safe", DOUBT,
        "!is_stuck && self.risk(step, teammates).is_some()",
        "!is_stuck",
        "progress::a_localiser_that_works_again_is_believed_once_a_reading_follows_a_move"),
    guard("a trial rests", DOUBT,
        "self.progress.wait()",
        "{ self.progress.wait(); true }",
        "lines::lines_34_to_36_a_robot_stands_while_the_next_cell_is_not_left_or_the_barrier_is_not_reached"),
    guard("a trial is safe from where the moves lead", DOUBT,
        "self.risk(step, teammates).filter(|_| is_safe)",
        "self.risk(step, teammates).or(Some(3)).filter(|_| is_safe)",
        "progress::a_robot_whose_localiser_freezes_hits_nobody_and_stops"),
    guard("a move into a wall is a risk", DOUBT,
        "Some(2).filter(|_| self.progress.may_bump())",
        "Some(2)",
        "progress::a_robot_whose_localiser_freezes_hits_nobody_and_stops"),
    guard("a cell that is claimed is no risk", DOUBT,
        "trail.contains(&to) || self.localisation.position().0 == to",
        "false",
        "progress::a_localiser_that_works_again_is_believed_once_a_reading_follows_a_move"),
    guard("a robot enters no cell where a teammate may be", DOUBT,
        "has_room && !self.seen.contains(to) && is_free()",
        "{ let _ = is_free; has_room && !self.seen.contains(to) }",
        "progress::a_robot_whose_localiser_freezes_hits_nobody_and_stops"),
];

const PROGRESS: &str = "iibt-core/src/navigation/progress.rs";
const DOUBT: &str = "iibt-core/src/navigation/team_robot/doubt.rs";
