use super::*;

#[test]
fn every_intention_as_it_was_sent() {
    let mut random = Random::new(1);
    for _ in 0..5_000 {
        let intention = intention(&mut random);
        assert_eq!(decode(body_of(&framed(&intention)), &AUTH), Ok(intention));
    }
}

/// The layout, pinned. If this fails, the layout has changed: the schema must have changed with
/// it.
#[test]
fn in_the_published_layout() {
    let frame = framed(&driving());
    let plain = unstuffed(body_of(&frame));
    #[rustfmt::skip]
    let expected = [
        2,                       // version
        2,                       // sender
        3,                       // epoch
        0xc8, 0x01,              // sequence 200
        0xac, 0x02,              // round 300
        0b111,                   // members: robots 0, 1 and 2
        0,                       // no walls: nobody is left out
        8,                       // it stood on p8 when the round began
        0,                       // it is for a goal
        1, 23, 0x40,             // evidence on one cell, p23: four nats for an obstacle
        2,                       // it has decided
        1, 2, 3, 4,              // the digest
        0,                       // no scores any more
        1, 3, 191,               // policy 3 with a probability of 191/255
        5,                       // five moves are made
        0,                       // no way-points
    ];
    let (signed, tag) = plain.split_at(plain.len() - TAG_BYTES);
    assert_eq!(signed, expected);
    assert_eq!(tag, GOLDEN_TAG);
    assert_eq!(CONTEXT.to_bits(), GOLDEN_CONTEXT);
    assert_eq!(frame.len(), 36, "a typical frame");
}

#[test]
fn in_the_published_layout_while_a_robot_decides_without_another() {
    let view = View::full(3).without(RobotId(1));
    let wall: CellSet<2> = [9, 12, 16].map(Cell).into_iter().collect();
    let proposal = Proposal { round: 7, view, walls: [Cells(wall).to_wire(1)].into_iter().collect() };
    let fact = Fact { anchor: Cell(8), purpose: Purpose::Visit(Cell(40)), ..Fact::default() };
    let scores = [Score { delay: 8, price: 0 }, Score::CANNOT].into_iter().collect();
    let answer = Answer::Scored { digest: Digest([1, 2, 3, 4]), scores };
    let waypoints = [41, 42].map(Cell).into_iter().collect();
    let message = Intention { rounds: RoundMessage { proposal, fact, answer }, waypoints };
    let said = Said { message, ..driving() };
    let plain = unstuffed(body_of(&framed(&said)));
    #[rustfmt::skip]
    let expected = [
        7, 0b101,                      // round 7 of robots 0 and 2
        1, 0, 1, 2, 0b0001_0010, 0b1,  // one wall, cell by cell from p8 on, two bytes: p9 and p12, p16
        8, 1, 40, 0,                   // from p8 to the way-point p40, no evidence
        1, 1, 2, 3, 4,                 // it has scored the list of this digest
        2, 8, 0, 255, 255,             // two policies: a tick late, and cannot
        2, 41, 42,                     // then to the way-points p41 and p42
    ];
    assert_eq!(plain[5..plain.len() - TAG_BYTES], expected);
    assert_eq!(decode(body_of(&framed(&said)), &AUTH), Ok(said));
}

/// In the middle of a long mission on a map of 256 cells: epoch 40, sequence 100,000, round
/// 300, evidence on four cells.
#[test]
fn in_few_bytes_while_robots_decide_and_fewer_while_they_drive() {
    let digest = Digest([0xff; 4]);
    let scores: Scores<K> = (0..K as u8).map(|policy| Score { delay: 100 + policy, price: 200 }).collect();
    let choice = Some(Choice { policy: 15, probability: 255 });
    let length =
        |team: usize, left_out: usize, answer: &Answer<K>| framed(&mission(team, left_out, answer)).len();
    let scored = Answer::Scored { digest, scores: scores.clone() };
    let decided = Answer::Decided { digest, scores: Some(scores), choice, step: 31 };
    let driving = Answer::Decided { digest, scores: None, choice, step: 31 };
    for (answer, most) in [(&scored, 85), (&decided, 89), (&driving, 53), (&Answer::Listing(16), 53)] {
        let full = length(8, 0, answer);
        println!(
            "{} bytes of at most {most}, {:?}",
            full,
            (1..=4).map(|left_out| length(8, left_out, answer)).collect::<Vec<_>>()
        );
        assert!(full <= most, "{full} bytes: {answer:?}");
        for left_out in 1..=4 {
            assert!(length(8, left_out, answer) <= full + 14 * left_out, "{left_out} left out: {answer:?}");
        }
    }
}

#[test]
fn in_at_most_the_longest_frame() {
    let longest = framed(&largest());
    let content = Intention::MAX_BYTES + "version, sender".split(' ').count() + 5 + 5 + TAG_BYTES;
    assert_eq!(longest.len(), content + 1 + 2, "a byte for COBS, and the delimiters");
    assert!(longest.len() <= 127);
    assert_eq!(decode(body_of(&longest), &AUTH), Ok(largest()));
    let mut random = Random::new(2);
    assert!((0..5_000).all(|_| framed(&intention(&mut random)).len() <= MAX_FRAME));
}

#[test]
fn with_zeros_at_its_ends_and_nowhere_else() {
    let mut random = Random::new(3);
    for _ in 0..5_000 {
        let frame = framed(&intention(&mut random));
        let zeros: Vec<_> = (0..frame.len()).filter(|&at| frame[at] == 0).collect();
        assert_eq!(zeros, [0, frame.len() - 1]);
    }
}

#[test]
fn in_a_buffer_of_just_its_length() {
    let frame = framed(&driving());
    for length in 0..frame.len() {
        let outcome = encode(&driving(), &AUTH, &mut vec![0; length]).map(<[u8]>::len);
        assert_eq!(outcome, Err(EncodeError::BufferTooSmall), "{length} bytes");
    }
    assert_eq!(encode(&driving(), &AUTH, &mut vec![0; frame.len()]), Ok(&frame[..]));
}
