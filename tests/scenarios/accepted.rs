use super::*;

/// A drawing of up to 8 x 8 cells with two robots and two goals somewhere.
fn drawing() -> impl Strategy<Value = String> {
    let cells = (2usize..8, 2usize..8);
    cells.prop_flat_map(|(width, height)| {
        let floor =
            proptest::collection::vec(prop_oneof![4 => Just('.'), 1 => Just('#')], width * height - 4);
        let marks = floor.prop_map(|floor| floor.into_iter().chain("12GG".chars()).collect::<Vec<_>>());
        marks.prop_shuffle().prop_map(move |marks| {
            marks.chunks(width).map(|row| row.iter().collect::<String>()).collect::<Vec<_>>().join("\n")
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn can_be_flown_without_a_collision(map in drawing(), seed: u64) {
        let text = format!("title = 't'\nlimit = 60\nmap = '''\n{map}\n'''\n[radio]\nloss = 0.2");
        let scenario = match Scenario::parse("drawn", &text) {
            Err(error) if error.reason.contains("can reach no goal") => {
                return Err(TestCaseError::reject("walled off"));
            }
            scenario => scenario.unwrap(),
        };
        let record = fly(&scenario, Conditions { seed, ..Conditions::default() }, &mut ()).unwrap();
        prop_assert_eq!(record.collisions.total(), 0);
        prop_assert!(record.history.len() <= 61);
    }
}
