//! The configuration whose frames fit packets of 64 bytes.

use super::*;
use firmware::missions::compact::{CELLS, LAYERS, LONGEST_PACKET, NODES, POLICIES, WORDS};
use host_sim::{Faults, NavigatorFlight, Radio};
use iibt_core::grid::{Map, Planner};
use iibt_core::navigation::{
    Effect, Mission, MissionError, Navigation, Place, Sight, Tells, Unknown, longest_packet,
};

type Compact = iibt_core::navigation::Intention<WORDS, POLICIES>;

type Flight<'m> = NavigatorFlight<'m, CELLS, WORDS, LAYERS, NODES, POLICIES>;

/// The bytes of a packet with this message, and with such numbers of starts, frames and rounds.
fn packet(message: RoundMessage<Fact<WORDS>, POLICIES>, stamp: Stamp) -> usize {
    let message = Compact { rounds: message, waypoints: PendingWaypoints::new() };
    let said = Envelope { sender: RobotId(7), stamp, message };
    let frame = iibt_core::team::encode(&said, &AUTH, CONTEXT, &mut [0; MAX_FRAME]).unwrap().len();
    frame - 2
}

/// The longest message of a team of eight without `left_out` robots, whose list has so many
/// policies.
fn longest(left_out: usize, policies: usize, round: u32) -> RoundMessage<Fact<WORDS>, POLICIES> {
    let last = Cell(CELLS as u16 - 1);
    // Four claims have five bytes of cells each: of a larger span they are drawn coarser, and
    // shorter.
    let span = if left_out == 4 { 40 } else { CELLS as u16 };
    let wall = || Cells::<WORDS>([Cell(0), Cell(span - 1)].into_iter().collect()).to_wire(left_out);
    let view: View = (left_out as u8..8).map(RobotId).collect();
    let evidence = [CellEvidence { cell: last, weight: i8::MIN }; Compact::PLACES].into_iter().collect();
    RoundMessage {
        proposal: Proposal { round, view, walls: (0..left_out).map(|_| wall()).collect() },
        fact: Fact { anchor: last, purpose: Purpose::Charge(last), evidence, ..Fact::default() },
        answer: Answer::Decided {
            digest: Digest([0xff; 4]),
            scores: Some((0..policies).map(|_| Score::CANNOT).collect()),
            choice: Some(Choice { policy: 0, probability: u8::MAX }),
            step: LAYERS as u16,
        },
    }
}

#[test]
fn the_longest_packet_is_as_long_as_its_type_says() {
    let last = Stamp { epoch: u32::MAX, sequence: u32::MAX };
    for (left_out, policies, bytes) in [(0, 8, 64), (1, 2, 63), (2, 1, 72), (3, 1, 83), (4, 1, 82)] {
        assert_eq!(packet(longest(left_out, policies, u32::MAX), last), bytes, "{left_out} left out");
        assert_eq!(longest_packet::<WORDS, POLICIES>(left_out), bytes);
    }
    let usual = Stamp { epoch: (1 << 14) - 1, sequence: (1 << 21) - 1 };
    assert_eq!(packet(longest(2, 1, (1 << 14) - 1), usual), LONGEST_PACKET);
}

#[test]
fn a_ninth_value_of_unknowns_and_a_third_place_are_refused_by_name() {
    let map = Map::<WORDS>::drawn("....\n....\n....\n....\n....").unwrap();
    let (starts, goals) = ([Cell(0), Cell(4)], [Cell(3), Cell(7)]);
    let sights = [sight(Cell(1), 1.0)];
    let start = |prior: &[f32]| {
        let cells: Vec<Place> = (1..prior.len()).map(|n| Place::new(Cell(7 + n as u16), n as u8)).collect();
        let unknowns = [Unknown { effect: Effect::Blocks, cells: &cells, prior, sights: &sights }];
        let mission = Mission { unknowns: &unknowns, ..Mission::new(map, &starts, &goals) };
        let member = Member::new(RobotId(0), 2).unwrap();
        Navigation::<CELLS, WORDS, LAYERS, NODES, POLICIES>::new(&mission, member, 1).map(|_| ())
    };
    assert_eq!((start(&[0.125; 8]), start(&[0.1; 10])), (Ok(()), Err(MissionError::UnknownCount)));
    let mut message = Compact { rounds: longest(0, 8, 1), waypoints: PendingWaypoints::new() };
    assert_eq!(message.validate(), Ok(()));
    message.waypoints = [Cell(1)].into_iter().collect();
    assert_eq!(message.validate(), Err(Compact::TOO_MANY));
}

/// A map of 8 x 8 cells with walls in 15 % of them, and so many cells of its largest part.
fn ground(random: &mut Random, wanted: usize) -> (Map<WORDS>, Vec<Cell>) {
    let mut planner = Planner::<CELLS>::new();
    loop {
        let mut map = Map::new(8, 8).unwrap();
        for cell in (0..64).map(Cell) {
            if random.bernoulli(0.15) {
                map.block(cell);
            }
        }
        let mut free: Vec<Cell> = (0..64).map(Cell).filter(|&cell| map.is_free(cell)).collect();
        let Some(&anchor) = free.first() else { continue };
        free.retain(|&cell| planner.shortest(&map, anchor, cell).is_ok());
        if free.len() >= wanted {
            return (map, (0..wanted).map(|_| free.swap_remove(random.below(free.len()))).collect());
        }
    }
}

/// A cell from where the value of an unknown is read.
const fn sight(from: Cell, right: f32) -> Sight {
    Sight { from, tells: Tells::Value, right }
}

/// Flies one mission; notes for each number of robots left out the longest packet on the air.
/// Returns whether all robots that are heard have arrived.
fn fly(seed: u64, longest: &mut [usize; 5]) -> bool {
    let mut random = Random::new(seed);
    let (map, cells) = ground(&mut random, 10);
    // A cell that may be blocked, and is not, seen from beside it.
    let doubtful = &cells[8..];
    let look_outs: Vec<Vec<Sight>> = doubtful
        .iter()
        .map(|&cell| map.free_neighbours(cell).map(|(_, from)| sight(from, 0.9)).collect())
        .collect();
    let places = [doubtful[0], doubtful[1]].map(|cell| [Place::new(cell, 1)]);
    let unknowns: Vec<Unknown<'_>> = places
        .iter()
        .zip(&look_outs)
        .map(|(cells, sights)| Unknown { effect: Effect::Blocks, cells, prior: &[1.0 - 1e-3, 1e-3], sights })
        .collect();
    let (starts, goals) = cells[..8].split_at(4);
    let mission = Mission { policies: 8, unknowns: &unknowns, ..Mission::new(map, starts, goals) };
    let radio = Radio { loss: 0.2, ..Radio::default() };
    let faults = Faults { radio, obstacle: 0.05, errand: 0.02, ..Faults::default() };
    let mut flight = Flight::over(&mission, faults, seed).unwrap();
    let lost = (seed % 3) as usize;
    for tick in 0..200 {
        // One robot falls silent, or two do.
        (0..lost).for_each(|robot| flight.silence(3 - robot, tick > 5));
        flight.tick();
        for robot in 0..4 {
            let rounds = flight.robot(robot).robot().navigation().rounds();
            let left_out = rounds.map_or(0, |rounds| 4 - rounds.proposal().view.len());
            let packet = flight.sent(robot).iter().map(|frame| frame.len() - 2).max();
            longest[left_out] = longest[left_out].max(packet.unwrap_or(0));
        }
        if flight.has_arrived() {
            return true;
        }
    }
    assert_eq!(flight.collisions().total(), 0);
    false
}

#[test]
fn in_flights_with_losses_obstacles_way_points_and_silent_robots() {
    let (mut longest, flights) = ([0; 5], 60);
    let arrived = (0..flights).filter(|&seed| fly(seed, &mut longest)).count();
    println!("longest packets by robots left out: {longest:?}; {arrived} of {flights} arrived");
    assert!(longest.iter().all(|&bytes| bytes <= LONGEST_PACKET), "{longest:?}");
    assert!(arrived >= flights as usize / 4, "of those with all robots");
    assert!(longest[..3].iter().all(|&bytes| bytes >= 48), "short frames only: {longest:?}");
}
