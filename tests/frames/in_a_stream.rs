use super::*;

#[test]
fn noise_between_frames_spoils_neither() {
    let mut random = Random::new(9);
    for _ in 0..tries(200_000) {
        let (first, second) = (intention(&mut random), intention(&mut random));
        let [before, between] = [(); 2].map(|()| {
            let length = random.below(2 * MAX_FRAME);
            random.bytes(length)
        });
        let stream = [before, framed(&first), between, framed(&second)].concat();
        assert_eq!(received(&stream), [first, second]);
    }
}

#[test]
fn a_flipped_bit_loses_its_frame_and_no_other() {
    let mut random = Random::new(11);
    for _ in 0..tries(2_000) {
        let [first, second, third] = [intention(&mut random), intention(&mut random), intention(&mut random)];
        let damaged_length = framed(&first).len();
        let stream = [framed(&first), framed(&second), framed(&third)].concat();
        for bit in 0..8 * damaged_length {
            let mut stream = stream.clone();
            stream[bit / 8] ^= 1 << (bit % 8);
            // The delimiter before the first frame is not missed at the beginning of a stream
            // only if it turns into a byte of the frame; the one after it has another behind
            // it.
            let expected = [second.clone(), third.clone()];
            let received = received(&stream);
            let rest = received.strip_prefix(std::slice::from_ref(&first)).unwrap_or(&received);
            assert_eq!(rest, expected, "bit {bit}");
            let is_last = bit / 8 == damaged_length - 1;
            assert!(received.len() == 2 || is_last, "bit {bit}");
        }
    }
}

/// A recorder that plays everything back, in any order and at any time, changes nothing.
#[test]
fn a_replay_is_never_heard() {
    let mut random = Random::new(12);
    let mut roster = roster();
    let mut recorded = Vec::new();
    let mut newest = None;
    for sequence in 0..tries(50_000) {
        let epoch = sequence / 40;
        let stamp = Stamp { epoch, sequence: sequence % 40 };
        let frame = framed(&Said { sender: RobotId(1), stamp, ..intention(&mut random) });
        let expected = match (newest, epoch) {
            (None, _) => Heard::First,
            (Some(before), _) if before < epoch => Heard::Restart,
            _ => Heard::Update,
        };
        newest = Some(epoch);
        assert_eq!(receive(&mut roster, body_of(&frame), Instant(sequence)), Ok(expected));
        recorded.push(frame);
        let old = &recorded[random.below(recorded.len())];
        let refused = receive(&mut roster, body_of(old), Instant(sequence)).unwrap_err();
        assert!(matches!(refused, Refused::Duplicate | Refused::Outdated));
    }
    assert_eq!(roster.counters().accepted, roster.counters().refused());
}

#[test]
fn a_flood_of_junk_is_counted_and_harmless() {
    let mut random = Random::new(13);
    let mut roster = roster();
    receive(&mut roster, body_of(&framed(&driving())), Instant(0)).unwrap();
    for _ in 0..10_000 {
        let length = random.below(40);
        receive(&mut roster, &random.bytes(length), Instant(1)).unwrap_err();
    }
    assert_eq!((roster.counters().accepted, roster.counters().refused()), (1, 10_000));
    assert_eq!(roster.peer(RobotId(2)).map(|peer| peer.envelope().clone()), Some(driving()));
}
