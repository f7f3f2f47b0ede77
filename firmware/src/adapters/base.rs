//! A base with a microcontroller of its own: wheels, positioning, scanner and battery over one
//! byte port.
//!
//! The base leads: it sends the readings of a tick, the robot ticks, and answers with what the base
//! is to do. docs/hil.md has the bytes.

mod message;

pub use message::{
    Act, BASE_KEY, BaseAnswer, BaseRequest, Decision, MAX_POSTERIOR, MAX_WATCHED, Operation, Readings,
    Sensed, first, read, write,
};

use crate::hardware::{Battery, Clock, Drive, Equipment, Link, Localiser, Scanner};
use iibt_core::grid::{Cell, Move};
use iibt_core::iibt::table::{Command, MAX_SENSORS};
use iibt_core::team::{Deframer, MAX_FRAME, Stamp};
use iibt_core::time::{Duration, Instant};

/// The most bytes that one call takes from the port.
const BYTES_PER_CALL: usize = 2 * MAX_FRAME;

/// A robot's hardware when the decisions run on one microcontroller and the motors on another: a
/// link `L` to the teammates, and a base behind the byte port `P`.
///
/// Call [`poll`](Self::poll) in the main loop, and tick the controller when it says so: the base's
/// readings set the pace, and their time is the clock. After the tick, [`end_tick`](Self::end_tick)
/// tells the base what to do. Where readings stay away, the base is told to stop.
///
/// ```
/// use firmware::adapters::base::{Base, BaseAnswer, BaseRequest, Event, Readings, read, write};
/// use firmware::hardware::{Drive, Link, Localiser};
/// use iibt_core::grid::{Cell, Move};
/// use iibt_core::team::{MAX_FRAME, Stamp};
/// use iibt_core::time::{Duration, Instant};
///
/// /// A port whose far end is two lists.
/// #[derive(Default)]
/// struct Wire {
///     inbox: std::collections::VecDeque<u8>,
///     outbox: Vec<u8>,
/// }
/// impl Link for Wire {
///     fn receive(&mut self) -> Option<u8> {
///         self.inbox.pop_front()
///     }
///     fn send(&mut self, frame: &[u8]) -> bool {
///         self.outbox.extend(frame);
///         true
///     }
/// }
///
/// let mut base = Base::new(Wire::default(), Wire::default(), Duration(500), Instant(0));
/// let readings = Readings { time: 7, cell: Some(Cell(3)), charge: 80, ..Readings::default() };
/// let (mut buffer, stamp) = ([0; MAX_FRAME], Stamp { epoch: 1, sequence: 4 });
/// base.port.inbox.extend(write(BaseRequest::Tick(readings), stamp, &mut buffer)?);
///
/// assert_eq!(base.poll(Instant(100)), Some(Event::Tick));
/// assert_eq!((base.locate(), base.is_moving()), (Some(Cell(3)), false));
/// base.go(Move::Left); // as the controller does in its tick
/// assert!(base.end_tick([]));
///
/// let frame = &base.port.outbox[1..base.port.outbox.len() - 1];
/// let (answered, BaseAnswer::Act(act)) = read(frame)? else { panic!("no command") };
/// assert_eq!((answered, act.step()), (stamp, Some(Move::Left)));
///
/// assert_eq!(base.poll(Instant(601)), Some(Event::Silent)); // and the base was told to stop
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "motor controller")]
#[doc(alias = "companion computer")]
#[derive(Debug)]
pub struct Base<L, P> {
    /// The link to the teammates.
    pub link: L,
    /// The port to the base.
    pub port: P,
    deframer: Deframer,
    /// The stamp of the last request, which its answers have too.
    stamp: Option<Stamp>,
    time: Instant,
    readings: Readings,
    /// What the sensors of a table task read, and whether an operator is under way.
    sensors: ([Option<u8>; MAX_SENSORS], bool),
    command: Option<Command>,
    /// The hazards that the controller has taken in.
    told: usize,
    step: Option<Move>,
    limit: Duration,
    heard: Instant,
    silent: bool,
    refused: u32,
}

/// What has come from the base.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The readings of a tick: tick the controller, then [`end_tick`](Base::end_tick).
    Tick,
    /// The readings of a tick of a table task: tick the controller, then
    /// [`end_operation`](Base::end_operation).
    Sensed,
    /// The question how many bytes of teammates wait: answer with [`BaseAnswer::Waiting`].
    Waiting,
    /// No readings for the limit: the base was told to stop.
    Silent,
}

/// How long readings may stay away before an image tells the base to stop, in milliseconds.
pub const SILENCE: Duration = Duration(1_000);

impl<L: Link, P: Link> Base<L, P> {
    /// Creates a base that has been heard last at `now`, and is silent after `limit` without
    /// readings, both by the robot's own clock.
    pub const fn new(link: L, port: P, limit: Duration, now: Instant) -> Self {
        Self {
            link,
            port,
            deframer: Deframer::new(),
            stamp: None,
            time: Instant(0),
            readings: Readings::NONE,
            sensors: ([None; MAX_SENSORS], false),
            command: None,
            told: 0,
            step: None,
            limit,
            heard: now,
            silent: false,
            refused: 0,
        }
    }

    /// Takes in what has come from the base; `now` is the time by the robot's own clock.
    pub fn poll(&mut self, now: Instant) -> Option<Event> {
        for _ in 0..BYTES_PER_CALL {
            let Some(byte) = self.port.receive() else { break };
            let Some(frame) = self.deframer.feed(byte) else { continue };
            match read(frame) {
                // A repeated request was answered before.
                Ok((stamp, request)) if self.stamp != Some(stamp) => {
                    self.stamp = Some(stamp);
                    return Some(self.take(request, now));
                }
                _ => self.refused = self.refused.saturating_add(1),
            }
        }
        self.listen_for_silence(now)
    }

    fn take(&mut self, request: BaseRequest, now: Instant) -> Event {
        match request {
            BaseRequest::Waiting => Event::Waiting,
            BaseRequest::Tick(readings) => {
                (self.time, self.readings, self.told) = (Instant(readings.time), readings, 0);
                (self.heard, self.silent) = (now, false);
                Event::Tick
            }
            BaseRequest::Sense(Sensed { time, busy, readings }) => {
                let mut sensors = [None; MAX_SENSORS];
                sensors.iter_mut().zip(&readings).for_each(|(sensor, reading)| *sensor = *reading);
                (self.time, self.sensors) = (Instant(time), (sensors, busy));
                (self.heard, self.silent) = (now, false);
                Event::Sensed
            }
        }
    }

    fn listen_for_silence(&mut self, now: Instant) -> Option<Event> {
        let is_over = now.has_reached(self.heard.after(self.limit));
        if !is_over || self.silent {
            return None;
        }
        self.silent = true;
        self.stop();
        Some(Event::Silent)
    }

    /// Ends a tick: tells the base which move to begin, and which cells to look at. Returns whether
    /// the port could take it.
    pub fn end_tick(&mut self, watched: impl IntoIterator<Item = Cell>) -> bool {
        let act = Act::new(self.step.take(), watched);
        self.answer(BaseAnswer::Act(act))
    }

    /// Ends a tick of a table task: tells the base which operator to begin. Returns whether the
    /// port could take it.
    pub fn end_operation(&mut self) -> bool {
        let operation = self.command.take().map(Operation::from);
        self.answer(BaseAnswer::Operate(operation))
    }

    /// Sends an answer to the last request; returns whether the port could take it.
    pub fn answer(&mut self, answer: BaseAnswer) -> bool {
        let mut buffer = [0; MAX_FRAME];
        let frame = write(answer, self.stamp.unwrap_or_default(), &mut buffer);
        frame.is_ok_and(|frame| self.port.send(frame))
    }

    /// Returns the cells that the robot was told to visit with the last readings.
    #[must_use]
    pub fn visits(&self) -> &[Cell] {
        &self.readings.visits
    }

    /// Returns the number of refused frames since the start: damaged, of another layout, or
    /// repeated.
    #[must_use]
    pub const fn refused(&self) -> u32 {
        self.refused
    }
}

impl<L: Link, P> Link for Base<L, P> {
    fn receive(&mut self) -> Option<u8> {
        self.link.receive()
    }

    fn receive_into(&mut self, bytes: &mut [u8]) -> usize {
        self.link.receive_into(bytes)
    }

    fn receive_packet(&mut self, packet: &mut [u8]) -> Option<usize> {
        self.link.receive_packet(packet)
    }

    fn send(&mut self, frame: &[u8]) -> bool {
        self.link.send(frame)
    }
}

impl<L, P> Clock for Base<L, P> {
    fn now(&mut self) -> Instant {
        self.time
    }
}

impl<L: Link, P: Link> Drive for Base<L, P> {
    fn go(&mut self, step: Move) {
        self.step = Some(step);
    }

    fn is_moving(&mut self) -> bool {
        self.readings.moving || self.step.is_some()
    }

    fn stop(&mut self) {
        (self.step, self.command) = (None, None);
        // A base that does not get it stops by itself: see its side of the protocol.
        let _ = self.answer(BaseAnswer::Stop);
    }
}

impl<L, P> Localiser for Base<L, P> {
    fn locate(&mut self) -> Option<Cell> {
        self.readings.cell
    }
}

impl<L, P> Scanner for Base<L, P> {
    fn scan(&mut self) -> Option<Cell> {
        let hazard = self.readings.hazards.get(self.told).copied();
        self.told = self.told.saturating_add(1);
        hazard
    }

    fn is_clear(&mut self, cell: Cell) -> bool {
        self.readings.clear.contains(&cell)
    }
}

impl<L, P> Battery for Base<L, P> {
    fn charge(&mut self) -> u8 {
        self.readings.charge
    }
}

impl<L, P> Equipment for Base<L, P> {
    fn read(&mut self, sensor: usize) -> Option<u8> {
        self.sensors.0.get(sensor).copied().flatten()
    }

    fn is_busy(&mut self) -> bool {
        self.sensors.1
    }

    fn begin(&mut self, command: Command) {
        self.command = Some(command);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::VecDeque;
    use std::vec::Vec;

    #[derive(Debug, Default)]
    struct Wire {
        inbox: VecDeque<u8>,
        outbox: Vec<u8>,
    }

    impl Link for Wire {
        fn receive(&mut self) -> Option<u8> {
            self.inbox.pop_front()
        }

        fn send(&mut self, frame: &[u8]) -> bool {
            self.outbox.extend(frame);
            true
        }
    }

    const fn stamp(sequence: u32) -> Stamp {
        Stamp { epoch: 1, sequence }
    }

    fn request(readings: Readings, sequence: u32) -> Vec<u8> {
        let mut buffer = [0; MAX_FRAME];
        write(BaseRequest::Tick(readings), stamp(sequence), &mut buffer).unwrap().to_vec()
    }

    fn base() -> Base<Wire, Wire> {
        Base::new(Wire::default(), Wire::default(), Duration(500), Instant(0))
    }

    fn answers(base: &mut Base<Wire, Wire>) -> Vec<(Stamp, BaseAnswer)> {
        let sent = core::mem::take(&mut base.port.outbox);
        sent.split(|&byte| byte == 0)
            .filter(|frame| !frame.is_empty())
            .map(|frame| read(frame).unwrap())
            .collect()
    }

    fn full() -> Readings {
        let cells = |count: u16| (0..count).map(|cell| Cell(u16::MAX - cell));
        Readings {
            time: u32::MAX,
            cell: Some(Cell(u16::MAX)),
            moving: true,
            charge: 100,
            hazards: cells(4).collect(),
            clear: cells(16).collect(),
            visits: cells(4).collect(),
        }
    }

    #[test]
    fn the_robot_reads_what_the_base_has_told_and_nothing_twice() {
        let mut base = base();
        base.port.inbox.extend(request(full(), 1));
        assert_eq!(base.poll(Instant(1)), Some(Event::Tick));
        assert_eq!((base.now(), base.locate()), (Instant(u32::MAX), Some(Cell(u16::MAX))));
        assert_eq!((base.charge(), base.is_moving(), base.visits().len()), (100, true, 4));
        assert_eq!(core::iter::from_fn(|| base.scan()).count(), 4);
        assert!(base.is_clear(Cell(u16::MAX - 15)) && !base.is_clear(Cell(0)));
        base.port.inbox.extend(request(full(), 1));
        assert_eq!((base.poll(Instant(2)), base.refused()), (None, 1), "it has ticked with these readings");
        base.port.inbox.extend(request(Readings::default(), 2));
        assert_eq!(base.poll(Instant(3)), Some(Event::Tick));
        assert_eq!((base.scan(), base.visits().len(), base.is_clear(Cell(u16::MAX))), (None, 0, false));
    }

    #[test]
    fn every_changed_bit_and_every_cut_of_a_frame_is_refused() {
        let frame = request(full(), 9);
        for bit in 8..8 * (frame.len() - 1) {
            let mut damaged = frame.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            let mut base = base();
            base.port.inbox.extend(damaged);
            assert_eq!(base.poll(Instant(1)), None, "bit {bit}");
        }
        for length in 1..frame.len() - 1 {
            let mut base = base();
            base.port.inbox.extend(&frame[..length]);
            assert_eq!(base.poll(Instant(1)), None);
            base.port.inbox.extend(&frame);
            assert_eq!(base.poll(Instant(2)), Some(Event::Tick), "the next frame after {length} bytes");
        }
    }

    #[test]
    fn an_answer_has_the_stamp_of_the_request_and_a_move_is_told_once() {
        let mut base = base();
        for (sequence, expected) in [(4, Some(Move::Up)), (5, None)] {
            base.port.inbox.extend(request(Readings::default(), sequence));
            assert_eq!(base.poll(Instant(1)), Some(Event::Tick));
            if let Some(step) = expected {
                base.go(step);
            }
            assert!(base.end_tick((0..99).map(Cell)));
            let [(answered, BaseAnswer::Act(act))] = &answers(&mut base)[..] else { panic!("one command") };
            assert_eq!((*answered, act.step(), act.watched.len()), (stamp(sequence), expected, MAX_WATCHED));
        }
    }

    #[test]
    fn a_base_that_falls_silent_is_told_once_to_stop_and_may_come_back() {
        let mut base = base();
        base.go(Move::Left);
        assert_eq!(base.poll(Instant(499)), None);
        assert_eq!(base.poll(Instant(500)), Some(Event::Silent));
        assert_eq!((base.poll(Instant(501)), base.is_moving()), (None, false));
        assert_eq!(answers(&mut base), [(Stamp::default(), BaseAnswer::Stop)]);
        base.port.inbox.extend(request(Readings::default(), 1));
        assert_eq!(base.poll(Instant(900)), Some(Event::Tick));
        assert_eq!([base.poll(Instant(1399)), base.poll(Instant(1400))], [None, Some(Event::Silent)]);
    }

    #[test]
    fn a_table_task_reads_its_sensors_by_number_and_begins_an_operator_once() {
        let mut base = base();
        let mut buffer = [0; MAX_FRAME];
        let sensed = Sensed { time: 9, busy: true, readings: [Some(3), None].into_iter().collect() };
        for (sequence, expected) in [(1, Some(Operation { operator: 2, target: Some(1) })), (2, None)] {
            let request = write(BaseRequest::Sense(sensed.clone()), stamp(sequence), &mut buffer);
            base.port.inbox.extend(request.unwrap());
            assert_eq!((base.poll(Instant(1)), base.now()), (Some(Event::Sensed), Instant(9)));
            assert_eq!([0, 1, 2, 99].map(|sensor| base.read(sensor)), [Some(3), None, None, None]);
            assert!(base.is_busy());
            if let Some(Operation { operator, target }) = expected {
                base.begin(Command { operator, target });
            }
            assert!(base.end_operation());
            assert_eq!(answers(&mut base), [(stamp(sequence), BaseAnswer::Operate(expected))]);
        }
    }

    #[test]
    fn noise_keeps_no_base_from_being_silent() {
        let mut base = base();
        base.port.inbox.extend([7; 2 * BYTES_PER_CALL]);
        assert_eq!(base.poll(Instant(500)), Some(Event::Silent));
        assert_eq!(base.port.inbox.len(), BYTES_PER_CALL, "a call takes so many bytes");
    }

    #[test]
    fn impossible_readings_and_commands_are_refused() {
        let mut buffer = [0; MAX_FRAME];
        let readings = Readings { charge: 101, ..Readings::default() };
        assert!(write(BaseRequest::Tick(readings), stamp(1), &mut buffer).is_err());
        let decision = Decision { posterior: [f32::MAX; MAX_POSTERIOR].into(), round: u32::MAX, policy: 255 };
        assert!(write(BaseAnswer::Decided(decision), stamp(u32::MAX), &mut buffer).is_ok(), "the longest");
    }

    #[test]
    fn the_bytes_are_those_of_the_document() {
        let hex = |bytes: &[u8]| {
            bytes.iter().map(|byte| std::format!("{byte:02x} ")).collect::<std::string::String>()
        };
        let mut buffer = [0; MAX_FRAME];
        let readings = Readings {
            time: 300,
            cell: Some(Cell(30)),
            charge: 80,
            hazards: [Cell(31)].into(),
            ..Readings::default()
        };
        let request = hex(write(BaseRequest::Tick(readings), stamp(4), &mut buffer).unwrap());
        let answer =
            hex(write(BaseAnswer::Act(Act::new(Some(Move::Right), [Cell(31)])), stamp(4), &mut buffer)
                .unwrap());
        let document = include_str!("../../../docs/hil.md");
        for frame in [request, answer] {
            assert!(document.contains(frame.trim_end()), "{frame}");
        }
    }
}
