//! Links of bytes and of packets under the controller: cut frames, noise, floods.

use firmware::adapters::{FrameInbox, PacketLink, PacketQueue, PacketRadio};
use firmware::hardware::{Clock, Link};
use firmware::{Controller, LinkReport, Robot, Settings};
use host_sim::Random;
use iibt_core::team::{
    Context, Envelope, Invalid, Key, MAX_FRAME, Member, Message, Peers, RobotId, SipHash64, Stamp, encode,
};
use iibt_core::time::Instant;
use iibt_core::tree::Status;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::convert::Infallible;
use std::num::NonZero;

/// The robots of the team: the one that listens, and its teammates.
const TEAM: usize = 8;

const KEY: Key = Key::new(*b"the team's key..");

/// What a line of 115,200 baud carries in a tick of 100 ms.
const LINE: usize = 1_152;

/// A message of as many bytes as those of navigating robots have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Count(u32, [u8; 28]);

impl Message for Count {
    const SCHEMA: &'static str = "count u32; padding 28 u8";
    const MAX_BYTES: usize = 5 + 28;

    fn validate(&self) -> Result<(), Invalid> {
        Ok(())
    }
}

/// A robot that only listens.
struct Listener;

impl<H> Robot<H> for Listener {
    type Message = Count;

    fn sense(&mut self, _: &mut H, _: Instant) {}
    fn tick(&mut self, _: Peers<'_, Count>, _: Instant) -> Status {
        Status::Running
    }
    fn act(&mut self, _: &mut H) {}
    fn message(&self) -> Option<Count> {
        None
    }
}

/// A link, a clock that counts ticks, and what the controller has taken from the link.
struct Hardware<L> {
    link: L,
    tick: u32,
    bytes: usize,
    packets: usize,
}

impl<L: Link> Link for Hardware<L> {
    fn receive(&mut self) -> Option<u8> {
        unreachable!("the controller takes many bytes at once")
    }
    fn receive_into(&mut self, bytes: &mut [u8]) -> usize {
        let count = self.link.receive_into(bytes);
        self.bytes += count;
        count
    }
    fn receive_packet(&mut self, packet: &mut [u8]) -> Option<usize> {
        let length = self.link.receive_packet(packet);
        self.packets += usize::from(length.is_some());
        length
    }
    fn send(&mut self, frame: &[u8]) -> bool {
        self.link.send(frame)
    }
}

impl<L> Clock for Hardware<L> {
    fn now(&mut self) -> Instant {
        Instant(self.tick)
    }
}

/// A robot on a link, and the frames of its teammates.
struct Bench<L> {
    robot: Controller<Listener, Hardware<L>>,
    sequence: u32,
}

impl<L: Link> Bench<L> {
    fn on(link: L) -> Self {
        let member = Member::new(RobotId(0), TEAM).unwrap();
        let settings = Settings::new(member, KEY, 1, NonZero::<u16>::MIN);
        let hardware = Hardware { link, tick: 0, bytes: 0, packets: 0 };
        Self { robot: Controller::new(Listener, settings, hardware), sequence: 0 }
    }

    fn link(&mut self) -> &mut L {
        &mut self.robot.hardware_mut().link
    }

    /// The next frame of a teammate, with its delimiters.
    fn frame(&mut self, sender: u8) -> Vec<u8> {
        self.sequence += 1;
        let stamp = Stamp { epoch: 1, sequence: self.sequence };
        let said = Envelope { sender: RobotId(sender), stamp, message: Count(self.sequence, [sender; 28]) };
        let context = Context::of::<Count>(0, 0);
        encode(&said, &SipHash64::new(KEY), context, &mut [0; MAX_FRAME]).unwrap().to_vec()
    }

    /// The next packet of a teammate.
    fn packet(&mut self, sender: u8) -> Vec<u8> {
        let frame = self.frame(sender);
        frame[1..frame.len() - 1].to_vec()
    }

    /// Ticks once; returns the number of the newest frame of a teammate that the robot has.
    fn tick(&mut self, sender: u8) -> Option<u32> {
        self.robot.hardware_mut().tick += 1;
        self.robot.tick();
        self.heard(sender)
    }

    fn heard(&self, sender: u8) -> Option<u32> {
        let peers = self.robot.peers(Instant(self.robot.hardware().tick));
        peers.fresh().find(|peer| peer.envelope().sender == RobotId(sender)).map(|peer| peer.message().0)
    }

    /// Ticks; the robot has heard the newest frame of each teammate, from two packets of each at
    /// the most.
    fn hears_all(&mut self, tick: u32) {
        let before = self.robot.hardware().packets;
        self.tick(1);
        assert!(self.robot.hardware().packets - before <= 2 * TEAM);
        for sender in 1..TEAM as u8 {
            let newest = self.sequence - (TEAM as u32 - 1) + u32::from(sender);
            assert_eq!(self.heard(sender), Some(newest), "tick {tick}");
        }
    }

    fn report(&self) -> LinkReport {
        self.robot.link_report()
    }
}

/// A serial line with a buffer for all that comes, however much it is.
#[derive(Default)]
struct Wire(VecDeque<u8>);

impl Link for Wire {
    fn receive(&mut self) -> Option<u8> {
        self.0.pop_front()
    }
    fn send(&mut self, _: &[u8]) -> bool {
        true
    }
}

/// A serial line whose interrupt cuts frames out of what it receives.
struct Filtered(FrameInbox<2048>);

impl Link for Filtered {
    fn receive(&mut self) -> Option<u8> {
        None
    }
    fn receive_packet(&mut self, packet: &mut [u8]) -> Option<usize> {
        self.0.packets.pop(packet)
    }
    fn send(&mut self, _: &[u8]) -> bool {
        true
    }
}

/// A radio whose driver keeps the packets of a tick, however many they are.
#[derive(Default)]
struct Fifo(VecDeque<Vec<u8>>);

impl PacketRadio for Fifo {
    type Error = Infallible;

    fn send(&mut self, _: &[u8]) -> Result<(), Infallible> {
        Ok(())
    }
    fn receive(&mut self, packet: &mut [u8]) -> Option<usize> {
        let next = self.0.pop_front()?;
        let length = next.len().min(packet.len());
        packet[..length].copy_from_slice(&next[..length]);
        Some(length)
    }
}

/// A radio whose interrupt puts packets into a queue.
struct Queued(PacketQueue<2048>);

impl PacketRadio for Queued {
    type Error = Infallible;

    fn send(&mut self, _: &[u8]) -> Result<(), Infallible> {
        Ok(())
    }
    fn receive(&mut self, packet: &mut [u8]) -> Option<usize> {
        self.0.pop(packet)
    }
}

#[test]
fn a_frame_that_is_cut_anywhere_costs_no_other_on_a_link_of_bytes() {
    let mut bench = Bench::on(Wire::default());
    let length = bench.frame(1).len();
    for cut in 0..length {
        for is_head_missing in [false, true] {
            let cut_frame = bench.frame(1);
            let rest = if is_head_missing { &cut_frame[cut..] } else { &cut_frame[..cut] };
            let next = bench.frame(2);
            let expected = bench.sequence;
            bench.link().0.extend(rest.iter().chain(&next));
            assert_eq!(bench.tick(2), Some(expected), "cut at {cut}, {is_head_missing}");
        }
    }
    assert!(bench.report().received.refused() as usize >= 2 * length - 6);
}

#[test]
fn a_packet_that_is_cut_anywhere_costs_no_other_on_a_link_of_packets() {
    let mut bench = Bench::on(PacketLink::new(Fifo::default()));
    let length = bench.packet(1).len();
    for cut in 0..length {
        for is_head_missing in [false, true] {
            let cut_packet = bench.packet(1);
            let rest = if is_head_missing { &cut_packet[cut + 1..] } else { &cut_packet[..cut] };
            let next = bench.packet(2);
            let expected = bench.sequence;
            bench.link().radio.0.extend([rest.to_vec(), next]);
            assert_eq!(bench.tick(2), Some(expected), "cut at {cut}, {is_head_missing}");
        }
    }
    let counters = *bench.link().counters();
    assert_eq!(counters.taken + counters.refused(), 4 * length as u32);
    assert_eq!(bench.report().received.accepted as usize, 2 * length);
}

#[test]
fn packets_that_are_not_one_frame_are_refused_by_name() {
    let mut bench = Bench::on(PacketLink::new(Fifo::default()));
    let (first, second) = (bench.packet(1), bench.packet(2));
    let framed = bench.frame(3);
    let padded = [&bench.packet(4)[..], &[0; 9]].concat();
    let other = [&[0x41, 0x88][..], &[7; 40]].concat(); // a frame of another network
    let packets = [vec![], vec![5; 126], vec![5; 250], [&first[..], &[0], &second].concat(), framed, other];
    bench.link().radio.0.extend(packets);
    bench.link().radio.0.push_back(padded);
    bench.tick(4);
    let counters = bench.link().counters();
    assert_eq!((counters.too_short, counters.too_long, counters.delimiter, counters.form), (1, 2, 2, 1));
    assert_eq!((counters.taken, bench.report().received.accepted), (1, 1), "zeros at the end are padding");
    assert!([1, 2, 3].iter().all(|&sender| bench.heard(sender).is_none()) && bench.heard(4).is_some());
}

/// A line that carries noise whenever no frame is on it: every frame comes through.
#[test]
fn noise_at_the_rate_of_the_line_costs_no_frame() {
    let (mut bench, mut random) = (Bench::on(Wire::default()), Random::new(1));
    for tick in 0..500 {
        let mut line = Vec::new();
        let mut newest = [0; TEAM];
        for sender in 1..TEAM as u8 {
            let noise = random.below(LINE / TEAM - 60);
            line.extend(random.bytes(noise));
            line.extend(bench.frame(sender));
            newest[usize::from(sender)] = bench.sequence;
        }
        line.extend(random.bytes(LINE - line.len()));
        bench.link().0.extend(line);
        bench.tick(1);
        for sender in 1..TEAM as u8 {
            assert_eq!(bench.heard(sender), Some(newest[usize::from(sender)]), "tick {tick}");
        }
    }
}

/// Ten times as many bytes as the line carries, in a buffer without end: the tick reads no more
/// than its share, and once that is read, frames are heard as before.
#[test]
fn a_flood_of_bytes_delays_frames_but_no_tick_and_costs_nothing_that_follows() {
    let (mut bench, mut random) = (Bench::on(Wire::default()), Random::new(2));
    for _ in 0..20 {
        let noise = random.bytes(10 * LINE);
        bench.link().0.extend(noise);
        let before = bench.robot.hardware().bytes;
        bench.tick(1);
        assert!(bench.robot.hardware().bytes - before <= 2 * TEAM * MAX_FRAME);
    }
    let frame = bench.frame(1);
    bench.link().0.extend(frame);
    while !bench.link().0.is_empty() {
        bench.tick(1);
    }
    assert_eq!(bench.heard(1), Some(bench.sequence));
}

/// The same where the interrupt cuts frames out of the noise: no teammate's frame is late.
#[test]
fn a_flood_of_bytes_starves_nobody_where_frames_are_cut_out_as_they_come() {
    let (mut bench, mut random) = (Bench::on(Filtered(FrameInbox::new())), Random::new(3));
    for tick in 0..500 {
        for sender in 1..TEAM as u8 {
            let noise = random.bytes(10 * LINE / (TEAM - 1));
            let frame = bench.frame(sender);
            bench.link().0.feed(&noise);
            bench.link().0.feed(&frame);
        }
        bench.hears_all(tick);
    }
}

/// Ten times as many packets of others as a channel carries, noise and frames of another network.
#[test]
fn a_flood_of_packets_starves_nobody_and_costs_nothing_that_follows() {
    let (mut bench, mut random) = (Bench::on(PacketLink::new(Queued(PacketQueue::new()))), Random::new(4));
    for tick in 0..500 {
        for sender in 1..TEAM as u8 {
            for _ in 0..10 * LINE / (TEAM - 1) / 40 {
                let length = random.below(127);
                let mut noise = random.bytes(length);
                if random.bernoulli(0.5) && length > 2 {
                    noise[..2].copy_from_slice(&[0x41, 0x88]);
                }
                // What is refused is counted.
                let _ = bench.link().radio.0.push(&noise);
            }
            let packet = bench.packet(sender);
            bench.link().radio.0.push(&packet).unwrap();
        }
        bench.hears_all(tick);
    }
    assert!(bench.link().radio.0.counters().refused() > 100_000);
}

/// Without a queue that keeps them out, packets of others take the turns of those of teammates, up
/// to the bound of a tick, and never for longer than they are there.
#[test]
fn a_flood_of_packets_delays_no_tick() {
    let mut bench = Bench::on(PacketLink::new(Fifo::default()));
    for _ in 0..160 {
        bench.link().radio.0.push_back(vec![9; 50]);
    }
    let packet = bench.packet(1);
    bench.link().radio.0.push_back(packet);
    let ticks = (1..).find(|_| bench.tick(1).is_some()).unwrap();
    assert_eq!((ticks, bench.robot.hardware().packets), (11, 161), "16 packets a tick");
}
