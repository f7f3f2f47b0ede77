//! The README describes every key that a scenario can have, and no other.

use super::*;

const README: &str = include_str!("../../host-sim/scenarios/README.md");

/// The keys of a table, as the refusal of an unknown one lists them.
fn known(table: &str) -> BTreeSet<String> {
    let text = format!("title = 't'\nmap = '1.G'\n{table}\nxyzzy = 1");
    let refusal = Scenario::parse("t", &text).expect_err("there is no such key").reason;
    let list = refusal.split_once("expected").expect("a list").1;
    list.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// The keys of the table of the README.
fn described() -> BTreeSet<String> {
    let rows = README.lines().skip_while(|line| !line.starts_with("| key ")).skip(2);
    let cells = rows.take_while(|line| line.starts_with('|')).filter_map(|row| row.split('|').nth(1));
    let names = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2));
    let key = |name: &'static str| name.trim_matches(['[', ']']).rsplit('.').next().unwrap_or(name);
    names.map(|name| key(name).to_owned()).collect()
}

#[test]
fn every_key_is_described_and_no_other() {
    let known: BTreeSet<String> = [
        "",
        "[radio]",
        "[inference]",
        "[[robot]]",
        "[[event]]",
        "[[goal]]\ncell = 2\nserves = 1",
        "[[unknown]]\nprior = [1.0]",
        "[[unknown]]\nprior = [1.0]\n[[unknown.sight]]\nfrom = 1",
        "[[wear]]\nrobot = 'R1'\nmove = 'up'\nfails = 1",
    ]
    .into_iter()
    .flat_map(known)
    .collect();
    assert!(known.len() > 40, "{known:?}");
    assert_eq!(known, described());
}

#[test]
fn keys_that_are_gone_are_refused() {
    for key in ["peer_sensor", "haste", "collision"] {
        let text = format!("title = 't'\nmap = '1.G'\n[inference]\n{key} = 1");
        let refusal = Scenario::parse("t.toml", &text).expect_err("it is gone").to_string();
        assert!(refusal.starts_with(&format!("t.toml:4: unknown field `{key}`")), "{refusal}");
    }
}
