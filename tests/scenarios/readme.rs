use super::*;
use host_sim::FlightEvent;
use serde_json::Value;

const README: &str = include_str!("../../host-sim/scenarios/README.md");

/// The keys of a value, those inside it included.
fn keys(value: &Value) -> BTreeSet<String> {
    match value {
        Value::Object(members) => {
            members.iter().flat_map(|(key, value)| keys(value).into_iter().chain([key.clone()])).collect()
        }
        Value::Array(values) => values.iter().flat_map(keys).collect(),
        _ => BTreeSet::new(),
    }
}

#[test]
fn every_member_of_the_record_is_explained() {
    let record = flown(&built_in("factory"), 0, 0.0);
    let mut names = keys(&serde_json::to_value(&record).unwrap());
    names.extend(keys(&serde_json::to_value(FlightEvent::Collided { times: 1 }).unwrap()));
    names.extend(["appeared", "found", "chose", "agreed", "arrived", "collided"].map(String::from));
    names.extend(
        ["asked", "refused", "visited", "drained", "left", "returned", "stopped", "resumed", "restarted"]
            .map(String::from),
    );
    names.extend(
        ["obstacle", "way_point", "battery", "free", "position", "teammate", "shortfall"].map(String::from),
    );
    names.extend(["deciding", "announced", "away", "together", "apart", "unfinished"].map(String::from));
    names.extend(
        ["nothing_to_do", "cleared", "waits", "for", "reason", "reading", "no_progress"].map(String::from),
    );
    let missing: Vec<_> = names.iter().filter(|name| !README.contains(&format!("`{name}`"))).collect();
    assert!(names.len() > 40 && missing.is_empty(), "of {}, missing {missing:?}", names.len());
}
