//! Bodies that only a holder of the key can have made.

use super::*;

#[test]
fn a_value_out_of_range_is_named() {
    let with = |change: fn(&mut Vec<u8>)| {
        let mut body = body(&driving());
        change(&mut body);
        decode(&sealed(VERSION, &body), &AUTH)
    };
    assert_eq!(with(|_| ()), Ok(driving()));
    for (change, expected) in [
        ((|body| body[0] = MAX_TEAM as u8) as fn(&mut Vec<u8>), DecodeError::Sender),
        (|body| body[7] = MAX_TEAM as u8 + 1, DecodeError::Body), // walls
        (|body| body[9] = 4, DecodeError::Body),                  // purpose
        (|body| body[10] = MAX_EVIDENCE as u8 + 1, DecodeError::Body),
        (|body| body[13] = 3, DecodeError::Body), // answer
        (|body| body[18] = 2, DecodeError::Body), // scores or none
        (|body| body[19] = 2, DecodeError::Body), // choice or none
        (|body| body.push(0), DecodeError::Trailing),
        (|body| body.truncate(body.len() - 1), DecodeError::Body),
    ] {
        assert_eq!(with(change), Err(expected));
    }
}

#[test]
fn what_does_not_fit_the_team_or_the_map_is_named() {
    let with = |change: fn(&mut RoundMessage<Fact<2>, K>)| {
        let mut message = driving().message;
        change(&mut message.rounds);
        message.check(3, 49)
    };
    let wall = || Blocks::default();
    assert_eq!(with(|_| ()), Ok(()));
    for (change, expected) in [
        ((|said| said.proposal.view = View::full(4)) as fn(&mut RoundMessage<_, K>), Round::STRANGER),
        (|said| said.proposal.view = View::full(2), Round::WALLS),
        (|said| said.answer = Answer::Listing(K as u8 + 1), Round::LISTING),
        (|said| choose(said, K as u8), Round::CHOICE),
        (|said| said.fact.anchor = Cell(49), Intention::OUTSIDE),
        (|said| said.fact.purpose = Purpose::Charge(Cell(49)), Intention::OUTSIDE),
        (|said| said.fact.evidence[0].cell = Cell(49), Intention::OUTSIDE),
    ] {
        assert_eq!(with(change), Err(expected));
    }
    let mut spare = driving().message;
    spare.rounds.proposal.walls.push(wall()).expect("there is room");
    assert_eq!(spare.check(3, 49), Err(Round::WALLS));
    choose(&mut spare.rounds, K as u8 - 1);
    spare.rounds.proposal.walls.clear();
    assert_eq!(spare.check(3, 49), Ok(()));
    assert!(spare.waypoints.push(Cell(48)).is_ok() && spare.check(3, 49).is_ok());
    assert!(spare.waypoints.push(Cell(49)).is_ok());
    assert_eq!(spare.check(3, 49), Err(Intention::OUTSIDE));
}

#[test]
fn more_way_points_than_the_evidence_leaves_room_for_are_neither_sent_nor_taken() {
    let mut said = driving();
    said.message.waypoints = [1, 2, 3].map(Cell).into_iter().collect();
    assert_eq!(decode(body_of(&framed(&said)), &AUTH).as_ref(), Ok(&said));
    said.message.waypoints.push(Cell(4)).expect("there is room without evidence");
    let mut buffer = [0; MAX_FRAME];
    let refused = encode(&said, &AUTH, &mut buffer);
    assert_eq!(refused, Err(EncodeError::Invalid(Intention::TOO_MANY)));
    let mut plain = body(&driving());
    plain.pop();
    plain.extend([4, 1, 2, 3, 4]);
    assert_eq!(decode(&sealed(VERSION, &plain), &AUTH), Err(DecodeError::Invalid(Intention::TOO_MANY)));
}

type Round = RoundMessage<Fact<2>, K>;

fn choose(said: &mut Round, policy: u8) {
    if let Answer::Decided { choice, .. } = &mut said.answer {
        *choice = Some(Choice { policy, probability: 0 });
    }
}

#[test]
fn nothing_but_valid_intentions_comes_out() {
    let mut random = Random::new(8);
    let mut decoded = 0;
    for _ in 0..tries(1_000_000) {
        let mut body = body(&intention(&mut random));
        for _ in 0..=random.below(3) {
            let at = random.below(body.len());
            body[at] = random.bits() as u8;
        }
        if let Ok(intention) = decode(&sealed(VERSION, &body), &AUTH) {
            decoded += 1;
            assert_eq!(decode(body_of(&framed(&intention)), &AUTH), Ok(intention));
        }
    }
    assert!(decoded > 0);
}

#[test]
fn the_sender_refuses_it_first() {
    let refused = |change: fn(&mut Said)| {
        let mut said = driving();
        change(&mut said);
        encode(&said, &AUTH, &mut [0; MAX_FRAME]).map(<[u8]>::len)
    };
    assert!(refused(|_| ()).is_ok());
    assert_eq!(refused(|said| said.sender = RobotId(MAX_TEAM as u8)), Err(EncodeError::Sender));
}

/// A message that is longer than it says.
#[derive(Clone, Serialize, Deserialize)]
struct Understated(u32);

impl Message for Understated {
    const SCHEMA: &'static str = "number u32";
    const MAX_BYTES: usize = 2;
}

#[test]
fn a_message_that_is_longer_than_its_type_says_is_not_sent() {
    let sent = |number| {
        let said = Envelope { sender: RobotId(0), stamp: Stamp::default(), message: Understated(number) };
        let context = Context::of::<Understated>(0, 0);
        iibt_core::team::encode(&said, &AUTH, context, &mut [0; MAX_FRAME]).map(<[u8]>::len)
    };
    assert!(sent(0x3fff).is_ok());
    assert_eq!(sent(0x4000), Err(EncodeError::MessageTooLong));
}

/// A message of the most bytes that a frame carries.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Full(u64, [u8; 32], [u8; 32], [u8; 30]);

impl Message for Full {
    const SCHEMA: &'static str = "number u64; bytes 32 32 30";
    const MAX_BYTES: usize = MAX_MESSAGE;

    fn validate(&self) -> Result<(), Invalid> {
        Ok(())
    }
}

#[test]
fn the_longest_message_of_any_task_fits_the_longest_frame() {
    let stamp = Stamp { epoch: u32::MAX, sequence: u32::MAX };
    let message = Full(u64::MAX, [0xff; 32], [0; 32], [1; 30]);
    let said = Envelope { sender: RobotId(7), stamp, message };
    let (context, mut buffer) = (Context::of::<Full>(0, 0), [0; MAX_FRAME]);
    let frame = iibt_core::team::encode(&said, &AUTH, context, &mut buffer).unwrap();
    assert_eq!(frame.len(), MAX_FRAME);
    assert_eq!(iibt_core::team::decode(body_of(frame), &AUTH, context), Ok(said));
}
