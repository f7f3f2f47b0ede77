use super::*;

fn json(name: &str, seed: u64, loss: f64) -> String {
    flown(&built_in(name), seed, loss).to_json().unwrap()
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    for name in ["factory", "detour"] {
        assert_eq!(json(name, 7, 0.3), json(name, 7, 0.3), "{name}");
        assert_ne!(json(name, 7, 0.3), json(name, 8, 0.3), "{name}");
    }
}

#[test]
fn it_tells_the_whole_flight() {
    let record = flown(&built_in("two-goals"), 3, 0.0);
    let value: serde_json::Value = serde_json::from_str(&record.to_json().unwrap()).unwrap();
    assert_eq!(value["scenario"], "two-goals");
    assert_eq!(
        (&value["seed"], &value["loss"], &value["outcome"]),
        (&3.into(), &0.0.into(), &"together".into())
    );
    assert_eq!(value["history"][0], serde_json::json!([28, 2]));
    assert_eq!(value["robots"][0]["path"], serde_json::json!([28, 35, 36, 37, 38, 31, 24]));
    assert_eq!(value["history"].as_array().unwrap().len(), record.history.len());
}
