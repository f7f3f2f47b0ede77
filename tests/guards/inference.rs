//! What inference consists of where something is unknown: beliefs, their evidence, the weighing of
//! policies, and the plans by which robots look.

use super::{Guard, Table, doubt, guard};

/// In a copy as that of a robot in doubt.
pub(super) const TABLE: Table = Table { name: "inference", guards: GUARDS, ..doubt::TABLE };

#[rustfmt::skip]
const GUARDS: &[Guard] = &[
    guard("a robot adds what it has read since the round to its belief", OWN_OUTLOOK,
        "belief_after(self.mission, self.robot(), &self.told())",
        "belief_after(self.mission, self.robot(), &AnnouncedReadings::new())",
        "unknowns::a_robot_reads_the_sign_while_the_others_go_on_and_the_team_follows_what_it_has_read"),
    guard("evidence counts once", "iibt-core/src/navigation/readings.rs",
        "-0.5 * f32::from(halves)",
        "-1.0 * f32::from(halves)",
        "unknowns::a_round_counts_what_every_member_has_read_once"),
    guard("readings change what a round believes", PROSPECTS,
        "self.worlds.belief(evidence(mission.unknowns, self.told.iter()))",
        "self.worlds.belief(|_, _| 0.0)",
        "unknowns::a_robot_reads_the_sign_while_the_others_go_on_and_the_team_follows_what_it_has_read"),
    guard("a robot announces what it has read", "iibt-core/src/navigation/team_robot.rs",
        "if shares { self.told() } else { AnnouncedReadings::new() }",
        "{ let _ = shares; AnnouncedReadings::new() }",
        "unknowns::a_robot_reads_the_sign_while_the_others_go_on_and_the_team_follows_what_it_has_read"),
    guard("what will be seen on the way counts", OUTLOOK,
        "mission.decider().branches()",
        "false",
        "unknowns::a_robot_reads_the_sign_while_the_others_go_on_and_the_team_follows_what_it_has_read"),
    guard("what will be seen later still counts", OUTLOOK,
        "*way = self.until_known(mission, &later, &shut, *way);",
        "",
        "unknowns::a_team_shares_a_search"),
    guard("plans are made by which a robot looks first", POLICIES,
        "mission.decider().looks() && worth >= LOOK_IF_WORTH",
        "{ let _ = worth; false }",
        "unknowns::a_robot_reads_the_sign_while_the_others_go_on_and_the_team_follows_what_it_has_read"),
    guard("plans are made by which robots share a search", "iibt-core/src/navigation/alternatives.rs",
        "self.tours(mission, prospects, closed).map(Variant::Made)",
        "None",
        "unknowns::a_team_shares_a_search"),
    guard("the posterior decides", POLICIES,
        "cheapest_policy(self, members)",
        "{ let _ = members; (!self.plans.is_empty()).then_some(0) }",
        "unknowns::a_robot_reads_the_sign_while_the_others_go_on_and_the_team_follows_what_it_has_read"),
    guard("a plan is left by the precision of the posterior", OWN_OUTLOOK,
        "self.mission.precision * ticks",
        "0.0 * ticks",
        "unknowns::robots_leave_a_plan_that_has_turned_out_worse_by_their_precision_and_habit"),
    guard("a plan is kept by habit", OWN_OUTLOOK,
        "ODDS + self.mission.habit",
        "ODDS",
        "unknowns::robots_leave_a_plan_that_has_turned_out_worse_by_their_precision_and_habit"),
    guard("a robot that stands in vain is not done", OWN_OUTLOOK,
        "here.is_some_and(may_tell) || self.standing().is_some_and(is_in_vain)",
        "{ let _ = is_in_vain; here.is_some_and(may_tell) }",
        "unknowns::a_team_that_finds_nothing_where_it_went_searches_on"),
    guard("a goal that serves a robot less often is worth less to it", "iibt-core/src/navigation/team_robot/decision.rs",
        "value.map_or(0.0, |(_, value)| 1.0 - value)",
        "{ let _ = value; 0.0 }",
        "lines::line_12_what_a_policy_costs_one_robot_counts_for_the_team"),
];

const OUTLOOK: &str = "iibt-core/src/navigation/outlook.rs";
const OWN_OUTLOOK: &str = "iibt-core/src/navigation/team_robot/outlook.rs";
const POLICIES: &str = "iibt-core/src/navigation/policies.rs";
const PROSPECTS: &str = "iibt-core/src/navigation/prospects.rs";
