//! Missions of which the team does not know all: robots look first where that pays, believe what
//! they read by its likelihood, and decide again when it says so.

use super::*;
use host_sim::campaign::{Ablation, Campaign, Disturbance};
use host_sim::families::{Family, FamilyMissions};
use host_sim::{Conditions, KEY, Observer, Outcome, Pilot, Record, Scenario, Snapshot, TeamFrames, fly};
use iibt_core::navigation::{Effect, Place, Sight, Tells, Unknown};

/// A mission of which the team does not know all, by the name of its file.
fn mission(name: &str) -> Scenario {
    let text = match name {
        "sign" => include_str!("../../host-sim/scenarios/sign.toml"),
        "noisy-sign" => include_str!("../../host-sim/scenarios/noisy-sign.toml"),
        "far-sign" => include_str!("../../host-sim/scenarios/far-sign.toml"),
        "gates" => include_str!("../../host-sim/scenarios/gates.toml"),
        _ => include_str!("../../host-sim/scenarios/leak.toml"),
    };
    Scenario::parse(name, text).expect("it is sound")
}

/// Flies a scenario with a seed; fails on a collision.
fn flown(scenario: &Scenario, seed: u64, loss: Option<f64>) -> Record {
    let record = fly(scenario, Conditions { seed, loss, ..Conditions::default() }, &mut ()).expect("it fits");
    assert_eq!(record.collisions.total(), 0, "{} with seed {seed}", scenario.name);
    record
}

/// The ticks until the last robot is where it ends, in each world of the only unknown.
fn in_every_world(scenario: &Scenario) -> Vec<u32> {
    let values = scenario.unknowns[0].prior.len() as u8;
    let of = |real| {
        let mut scenario = scenario.clone();
        scenario.unknowns[0].real = Some(real);
        let record = flown(&scenario, 1, None);
        assert!(record.outcome.is_success(), "{} in world {real}: {:?}", scenario.name, record.outcome);
        record.last_arrival()
    };
    (0..values).map(of).collect()
}

/// A robot sees the obstacle on its way, and goes round it, though no sight tells of it there.
#[test]
fn who_stands_before_a_door_that_is_shut_knows_it() {
    let text = r#"
        title = "A door of which only a far sign tells"
        map = """
        1.....G
        .####..
        .......
        """
        [[unknown]]
        blocks = [[3]]
        prior = [0.9, 0.1]
        real = 1
        [[unknown.sight]]
        from = 20
    "#;
    let door = Scenario::parse("door", text).expect("it is sound");
    let record = flown(&door, 1, None);
    assert!(record.outcome.is_success(), "{:?}", record.outcome);
    // Two moves to the door and back, and ten around it.
    assert!(record.last_arrival() <= 2 + 2 + 10 + 6, "{}", record.last_arrival());
    assert!(has_been_at(&record, 2) && !has_been_at(&record, 20), "{:?}", record.history);
}

/// The mean over the worlds of the only unknown.
fn mean(scenario: &Scenario, ticks: &[u32]) -> f64 {
    scenario.unknowns[0].prior.iter().zip(ticks).map(|(&p, &ticks)| f64::from(p) * f64::from(ticks)).sum()
}

fn has_been_at(record: &Record, cell: u16) -> bool {
    record.history.iter().any(|cells| cells.contains(&Cell(cell)))
}

/// Two rounds take six ticks; without them the bar is 10.3 in the mean, and 13 in the worst world.
#[test]
fn a_robot_reads_the_sign_while_the_others_go_on_and_the_team_follows_what_it_has_read() {
    let sign = mission("sign");
    let ticks = in_every_world(&sign);
    let mut blind = sign.clone();
    blind.unknowns[0].sights.retain(|sight| sight.from != Cell(46));
    let without = in_every_world(&blind);
    let [with_it, without_it] = [&ticks, &without].map(|ticks| mean(&sign, ticks));
    println!("with the sign {with_it:.2} {ticks:?}, without {without_it:.2} {without:?}");
    assert!(with_it <= 10.3 + 6.0 && ticks.iter().all(|&ticks| ticks <= 13 + 6), "{ticks:?}");
    assert!(with_it <= without_it - 2.0, "{with_it} {without_it}");
    assert!(has_been_at(&flown(&sign, 1, None), 46));
}

/// One round takes three ticks, and another one where the likelier bay is the wrong one.
#[test]
fn nobody_is_sent_to_read_a_sign_that_is_too_far_away() {
    let far = mission("far-sign");
    let ticks = in_every_world(&far);
    println!("{:.2} {ticks:?}", mean(&far, &ticks));
    assert!((1..=20).all(|seed| !has_been_at(&flown(&far, seed, None), 44)));
    assert!(mean(&far, &ticks) <= 7.85 + 4.5, "{ticks:?}");
}

/// With nine right readings of ten, and with a fifth of the frames lost.
#[test]
fn readings_that_may_be_wrong_add_up() {
    let noisy = mission("noisy-sign");
    for loss in [None, Some(0.2)] {
        let flights: Vec<_> = (1..=100).map(|seed| flown(&noisy, seed, loss)).collect();
        let done = flights.iter().filter(|record| record.outcome.is_success()).count();
        let ticks: Vec<u32> = flights.iter().map(Record::last_arrival).collect();
        let mean = f64::from(ticks.iter().sum::<u32>()) / 100.0;
        println!(
            "loss {loss:?}: {done} of 100 accomplished, {mean:.1} ticks, at most {:?}",
            ticks.iter().max()
        );
        assert!(done >= 99, "{done} of 100 with {loss:?}");
    }
}

#[test]
fn a_gate_that_is_seen_to_be_shut_sends_the_team_another_way() {
    let gates = mission("gates");
    let mut all = 0;
    for worlds in 0..8_u8 {
        let mut scenario = gates.clone();
        for (number, unknown) in scenario.unknowns.iter_mut().enumerate() {
            unknown.real = Some(worlds >> number & 1);
        }
        let record = flown(&scenario, 1, None);
        assert!(record.outcome.is_success(), "gates {worlds:03b}: {:?}", record.outcome);
        all += record.last_arrival();
    }
    println!("{:.2} ticks in the mean", f64::from(all) / 8.0);
    assert!(f64::from(all) / 8.0 <= 12.2 + 7.0, "{all}");
}

/// Two rounds take six ticks, the second one because the leak is found; without them the bar is 9.6
/// in the mean.
#[test]
fn a_team_shares_a_search() {
    let leak = mission("leak");
    let ticks = in_every_world(&leak);
    println!("{:.2} {ticks:?}", mean(&leak, &ticks));
    assert!(mean(&leak, &ticks) <= 9.6 + 6.5, "{ticks:?}");
}

/// The missions of a family with the first seeds, each flown with its own.
fn family(family: Family, count: u64) -> Vec<Scenario> {
    let missions = FamilyMissions::of(family);
    let parsed = |seed| Scenario::parse("drawn", &missions.draw(seed).expect("there is room"));
    (0..count).map(|seed| parsed(seed).expect("what is drawn is sound")).collect()
}

/// Robots that have gone to a goal each may all find that theirs is not the one.
#[test]
fn a_team_that_finds_nothing_where_it_went_searches_on() {
    for (seed, scenario) in (0..).zip(family(Family::Search, 60)) {
        let record = flown(&scenario, seed, None);
        assert!(record.outcome.is_success(), "seed {seed}: {:?}", record.outcome);
    }
}

/// What inference is worth on missions of a family, by the upper end of the 95 % interval of the
/// difference: against inference that never looks, and against rules. Each team
/// flies the same seeds.
#[test]
fn inference_pays_on_missions_with_a_sign_and_in_searches() {
    let (sign, search) = (family(Family::Sign, 80), family(Family::Search, 80));
    for (name, scenarios, least) in [("sign", &sign, 1.0), ("search", &search, 4.0)] {
        let others = ["no-looking", "random", "free-space", "likeliest"];
        let others = others.map(|name| Pilot::Ablated(Ablation::find(name).expect("it is one of them")));
        let pilots: Vec<Pilot> = [Pilot::Inference].into_iter().chain(others).collect();
        let seeds = scenarios.len() as u32;
        let campaign = Campaign { scenarios, disturbances: &[Disturbance::None], pilots: &pilots, seeds };
        let flown = campaign.fly(None, &|_, _| ()).expect("they fit");
        let row = &flown.rows[0];
        assert_eq!(
            (row.summaries[0].accomplished.count, flown.collided(Pilot::Inference)),
            (seeds, 0),
            "{name}"
        );
        for comparison in &row.comparisons {
            let (other, ticks) = (comparison.pilots[1].name(), comparison.ticks);
            println!("{name}: inference minus {other} {:.1} {:?}", ticks.mean, ticks.interval);
            assert!(ticks.interval[1] < 0.0, "{name}, {other}: {ticks:?}");
        }
        let free = row.comparisons[2].ticks.mean;
        assert!(free < -least, "{name}: {free} ticks to free space");
    }
}

/// Looking must not cost where it does not pay: within a tenth of a tick of a team that never
/// looks.
#[test]
fn nobody_looks_where_it_does_not_pay() {
    for kind in [Family::Floor, Family::FarSign] {
        let scenarios = family(kind, 80);
        let blind = Pilot::Ablated(Ablation::find("no-looking").expect("it is one of them"));
        let pilots = [Pilot::Inference, blind];
        let campaign = Campaign {
            scenarios: &scenarios,
            disturbances: &[Disturbance::None],
            pilots: &pilots,
            seeds: 80,
        };
        let flown = campaign.fly(None, &|_, _| ()).expect("they fit");
        let ticks = flown.rows[0].comparisons[0].ticks;
        println!("{kind:?}: {:+.2} {:?}", ticks.mean, ticks.interval);
        assert!(ticks.mean <= 0.1, "{kind:?}: {ticks:?}");
    }
}

/// A robot that dies may have read what nobody else has.
#[test]
fn the_others_go_on_when_the_one_that_looks_dies() {
    let mut sign = mission("sign");
    sign.limit = 400;
    for seed in 1..=10 {
        let text = "[[event]]\ntick = 5\nwho = 'R2'\nstop = true";
        let with_event = |sign: &Scenario| {
            let map = "####...####\nGG.......GG\n####...####\n####.1.####\n##...2.####\n####.3.####\n\
                       ####...####\nGG.......GG\n####...####";
            let parsed =
                Scenario::parse("dies", &format!("title = 'd'\nneed = 2\nmap = '''\n{map}\n'''\n{text}"));
            let events = parsed.expect("it is sound").events;
            Scenario { events, ..sign.clone() }
        };
        let record = flown(&with_event(&sign), seed, None);
        assert!(record.outcome.is_success(), "seed {seed}: {:?}", record.outcome);
    }
}

/// A hall with a bay of two goals on either side, one of which serves, and a sign at its end.
/// Robots misread the sign and the bays in one of five cases.
mod hall {
    use super::*;

    static STARTS: [Cell; 3] = [Cell(37), Cell(38), Cell(39)];
    static GOALS: [Cell; 4] = [Cell(7), Cell(8), Cell(12), Cell(13)];
    static PLACES: [Place; 4] =
        [Place::new(Cell(7), 0), Place::new(Cell(8), 0), Place::new(Cell(12), 1), Place::new(Cell(13), 1)];
    pub(super) const PRIOR: [f32; 2] = [0.6, 0.4];
    pub(super) static SIGHTS: [Sight; 7] = [
        sight(45, Tells::Value),
        sight(7, Tells::Whether(0)),
        sight(8, Tells::Whether(0)),
        sight(9, Tells::Whether(0)),
        sight(11, Tells::Whether(1)),
        sight(12, Tells::Whether(1)),
        sight(13, Tells::Whether(1)),
    ];
    static UNKNOWNS: [Unknown<'_>; 1] =
        [Unknown { effect: Effect::Serves, cells: &PLACES, prior: &PRIOR, sights: &SIGHTS }];

    const fn sight(from: u16, tells: Tells) -> Sight {
        Sight { from: Cell(from), tells, right: 0.8 }
    }

    pub(super) fn mission() -> Mission<'static, 2> {
        let map = Map::drawn(
            &["##...##", ".......", "##...##", "##...##", "##...##", "##...##", "##...##"].join("\n"),
        );
        Mission {
            unknowns: &UNKNOWNS,
            need: Some(2),
            ..Mission::new(map.expect("49 cells"), &STARTS, &GOALS)
        }
    }
}

/// The prior times the likelihoods of what all members have told when the round began, each once.
#[test]
fn a_round_counts_what_every_member_has_read_once() {
    let mission = hall::mission();
    let (mut rounds, mut together) = (0, 0);
    for seed in 0..80 {
        let faults = Faults { radio: Radio { duplicate: 0.5, ..Radio::default() }, ..Faults::default() };
        let mut team = Team::over(&mission, faults, seed).expect("it is sound");
        let mut checked = None;
        while team.ticks() < 120 && !team.has_arrived() {
            let stood = team.cells().to_vec();
            team.tick();
            let protocols =
                [0, 1, 2].map(|robot| task(&team, robot).rounds().map(|rounds| rounds.protocol()));
            let [Some(first), Some(second), Some(third)] = protocols else { continue };
            let all = [first, second, third];
            let round = first.proposal().round;
            let has_decided = |protocol: &&Protocol<Fact, POLICIES>| {
                protocol.proposal().round == round && protocol.has_decided()
            };
            if !all.iter().all(has_decided) || checked.replace(round) == Some(round) {
                continue;
            }
            // Half a nat in half a byte, for each value the evidence against it.
            let against = |value: usize| {
                let of = |protocol: &Protocol<Fact, POLICIES>| {
                    let byte = protocol.fact().readings.first().copied().unwrap_or(0);
                    0.5 * f32::from(byte >> (4 * value) & 0xf)
                };
                all.iter().map(|protocol| of(protocol)).sum::<f32>()
            };
            let weights = [0, 1].map(|value| hall::PRIOR[value] * (-against(value)).exp());
            let expected = weights[0] / (weights[0] + weights[1]);
            let told = all.iter().filter(|protocol| !protocol.fact().readings.is_empty()).count();
            // Those that see something have read more while they decided.
            let sees = |robot: &usize| hall::SIGHTS.iter().any(|sight| sight.from == stood[*robot]);
            for robot in (0..3).filter(|robot| !sees(robot)) {
                let believes = task(&team, robot).worlds();
                assert!((believes[0] - expected).abs() < 1e-3, "seed {seed}: {believes:?}, not {expected}");
                rounds += u32::from(told > 0);
                together += u32::from(told > 1);
            }
        }
    }
    println!("{rounds} beliefs by what was read, {together} of them by more than one robot");
    assert!(rounds > 40 && together > 10, "{rounds} {together}");
}

/// The ticks of the worlds in which the likelier bays are the wrong ones, altogether.
fn where_the_guess_is_wrong(precision: f32, habit: f32) -> u32 {
    let mut sign = mission("sign");
    (sign.inference.precision, sign.inference.habit) = (Some(precision), Some(habit));
    let ticks = in_every_world(&sign);
    ticks[2] + ticks[3]
}

#[test]
fn robots_leave_a_plan_that_has_turned_out_worse_by_their_precision_and_habit() {
    let [usual, blunt, stubborn] = [(1.0, 0.0), (0.0, 0.0), (1.0, 20.0)]
        .map(|(precision, habit)| where_the_guess_is_wrong(precision, habit));
    println!("{usual} ticks, {blunt} without precision, {stubborn} with a habit of 20 nats");
    assert!(blunt >= usual + 8 && stubborn >= usual + 8);
}

/// Keeps all frames.
struct Frames(Vec<u8>);

impl Observer for Frames {
    fn observe(&mut self, snapshot: &Snapshot<'_>) {
        self.0.extend(snapshot.frames);
    }
}

#[test]
fn frames_tell_who_looks() {
    let scenario = mission("sign");
    let mut frames = Frames(vec![]);
    let record = fly(&scenario, Conditions::default(), &mut frames).expect("it fits");
    assert_ne!(record.outcome, Outcome::Unfinished);
    let told = TeamFrames::read(&scenario, &KEY, &frames.0).expect("a team").to_string();
    assert!(told.lines().any(|line| line.contains("R2") && line.ends_with(", by the look-out 46")), "{told}");
}
