//! The control loop of one robot: listen, sense, tick the behavior tree, act, announce.

use crate::hardware::{Clock, Link};
use crate::{LinkReport, Robot, Settings};
use iibt_core::team::{
    Context, Deframer, Envelope, MAX_FRAME, MAX_TEAM, Message, Numbering, Peer, Peers, Roster, SipHash64,
    encode,
};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::Status;
use zeroize::Zeroize;

/// How often one tick reads from the link, a frame's bytes at a time: two frames of every robot. A
/// flood of bytes delays frames, but no tick.
const READS_PER_TICK: usize = 2 * MAX_TEAM;

/// How many packets one tick takes from the link: as many frames.
const PACKETS_PER_TICK: usize = 2 * MAX_TEAM;

/// The one loop that runs every robot: any [`Robot`] on any hardware with a [`Link`] and a
/// [`Clock`].
///
/// Call [`tick`](Self::tick) at the period of its [`Settings`], on the real time of the robot's
/// clock. The work of a tick is that of the robot's own methods, at most 2,032 bytes or 16 packets
/// received, and one frame sent. [`Robot`] has an example.
#[doc(alias = "control loop")]
#[doc(alias = "executor")]
#[doc(alias = "heartbeat")]
#[doc(alias = "beacon")]
#[derive(Clone, Debug)]
pub struct Controller<R: Robot<H>, H> {
    hardware: H,
    robot: R,
    roster: Roster<R::Message>,
    deframer: Deframer,
    auth: Option<SipHash64>,
    context: Context,
    channel: u32,
    numbering: Numbering,
    period: Duration,
    last_sent: Option<Instant>,
    /// Counts the frames that were due.
    turn: u16,
    sent: u32,
    unsent: u32,
}

impl<H: Link + Clock, R: Robot<H>> Controller<R, H> {
    /// Creates a controller that has received nothing.
    #[must_use]
    pub fn new(robot: R, settings: Settings, hardware: H) -> Self {
        let mut new = Self::idle(robot, settings, hardware);
        new.context = new.context_of_mission();
        new
    }

    /// Creates a controller whose robot is [started](Self::start) later; until then it says
    /// nothing.
    #[inline(always)] // built where it is to be, not on the stack
    #[must_use]
    pub fn idle(robot: R, settings: Settings, hardware: H) -> Self {
        Self {
            hardware,
            robot,
            roster: Roster::new(settings.member(), settings.limits()),
            deframer: Deframer::new(),
            auth: Some(SipHash64::with(settings.keys().clone())),
            context: Context::NONE,
            channel: settings.channel(),
            numbering: Numbering::new(settings.epoch()),
            period: settings.tick(),
            last_sent: None,
            turn: 0,
            sent: 0,
            unsent: 0,
        }
    }

    /// Starts a robot that was built without a mission.
    ///
    /// A controller takes kilobytes, which a small stack or an async task does not have. Build it
    /// where it is to be, and start its robot there:
    ///
    /// ```
    /// use core::num::NonZero;
    /// use firmware::adapters::{Absent, Body};
    /// use firmware::missions::{CELLS, LAYERS, NODES, POLICIES, SECTION_5_1, WORDS};
    /// use firmware::{Controller, Navigator, Settings};
    /// use iibt_core::team::{Key, Member, RobotId};
    /// use static_cell::StaticCell;
    /// # use firmware::hardware::{Clock, Drive, Link};
    /// # #[derive(Clone, Copy)]
    /// # struct Bench;
    /// # impl Link for Bench {
    /// #     fn receive(&mut self) -> Option<u8> { None }
    /// #     fn send(&mut self, _: &[u8]) -> bool { true }
    /// # }
    /// # impl Clock for Bench {
    /// #     fn now(&mut self) -> iibt_core::time::Instant { iibt_core::time::Instant(0) }
    /// # }
    /// # impl Drive for Bench {
    /// #     fn go(&mut self, _: iibt_core::grid::Move) {}
    /// #     fn is_moving(&mut self) -> bool { false }
    /// #     fn stop(&mut self) {}
    /// # }
    ///
    /// type Hardware = Body<Bench, Bench, Bench>; // link, clock and drive of the board
    /// type Robot = Controller<Navigator<'static, CELLS, WORDS, LAYERS, NODES, POLICIES>, Hardware>;
    /// static ROBOT: StaticCell<Robot> = StaticCell::new();
    ///
    /// let member = Member::new(RobotId(0), SECTION_5_1.starts.len())?;
    /// let settings = Settings::new(member, Key::new(*b"sixteen bytes..."), 1, NonZero::<u16>::MIN);
    /// let hardware = Body::new(Bench, Bench).driving(Bench, Absent);
    /// let robot = ROBOT.init_with(|| Controller::idle(Navigator::idle(), settings.clone(), hardware));
    /// robot.start(|navigator| navigator.start(&SECTION_5_1, &settings))?;
    /// robot.tick();
    /// assert!(robot.start(|navigator| navigator.start(&SECTION_5_1, &settings)).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// What `start` returns.
    pub fn start<E>(&mut self, start: impl FnOnce(&mut R) -> Result<(), E>) -> Result<(), E> {
        start(&mut self.robot)?;
        self.context = self.context_of_mission();
        Ok(())
    }

    fn context_of_mission(&self) -> Context {
        Context::of::<R::Message>(self.channel, self.robot.mission())
    }

    /// Runs one tick: listens, senses, ticks the tree, acts and sends. Returns the status of the
    /// tree.
    ///
    /// The work is bounded and never waits.
    pub fn tick(&mut self) -> Status {
        // One instant for the whole tick, so that ages, deadlines and the frame agree on it.
        let now = self.hardware.now();
        self.listen(now);
        self.robot.sense(&mut self.hardware, now);
        let status = self.robot.tick(self.roster.at(now), now);
        self.robot.act(&mut self.hardware);
        self.announce(now);
        status
    }

    /// Returns the robot.
    #[must_use]
    pub const fn robot(&self) -> &R {
        &self.robot
    }

    /// Returns the robot for instructions, a way-point for example.
    pub const fn robot_mut(&mut self) -> &mut R {
        &mut self.robot
    }

    /// Returns the hardware.
    #[must_use]
    pub const fn hardware(&self) -> &H {
        &self.hardware
    }

    /// Returns the hardware for changes from outside.
    pub const fn hardware_mut(&mut self) -> &mut H {
        &mut self.hardware
    }

    /// Returns the teammates at an instant.
    #[must_use]
    pub const fn peers(&self, now: Instant) -> Peers<'_, R::Message> {
        self.roster.at(now)
    }

    /// Returns the counts of frames sent and received.
    #[must_use]
    pub const fn link_report(&self) -> LinkReport {
        LinkReport {
            sent: self.sent,
            unsent: self.unsent,
            dropped: self.deframer.dropped(),
            received: *self.roster.counters(),
        }
    }

    /// Returns whether the numbers of frames of this epoch are used up. The robot is silent then
    /// until it starts again, in an epoch that is counted before it is used: restart it where it
    /// stands.
    #[must_use]
    pub const fn needs_new_epoch(&self) -> bool {
        self.numbering.is_exhausted()
    }

    /// Uses up the numbers of frames of this epoch but the last `left`, to see what follows.
    pub const fn use_up_numbers(&mut self, left: u32) {
        self.numbering.use_up(left);
    }

    /// Overwrites the keys with zeros. From now on the robot neither sends nor hears its team, and
    /// goes on only as far as what it has heard lets it. Those in the flash stay; see
    /// [`page::erase`](crate::page::erase).
    #[doc(alias = "zeroize")]
    pub fn forget_keys(&mut self) {
        self.auth.zeroize();
    }

    fn listen(&mut self, now: Instant) {
        self.roster.expire(now);
        let (robot, mut room) = (&self.robot, [0; MAX_FRAME]);
        for _ in 0..READS_PER_TICK {
            let count = self.hardware.receive_into(&mut room);
            let mut bytes = room.get(..count).unwrap_or(&room);
            if bytes.is_empty() {
                break;
            }
            let Some(auth) = &self.auth else { continue };
            while let Some(frame) = self.deframer.take(&mut bytes) {
                let accepts = |message: &R::Message| robot.accepts(message);
                // The roster counts what it refuses.
                let _ = self.roster.receive(frame, auth, self.context, now, accepts);
            }
        }
        self.listen_to_packets(now);
    }

    fn listen_to_packets(&mut self, now: Instant) {
        let mut room = [0; MAX_FRAME];
        for _ in 0..PACKETS_PER_TICK {
            let Some(length) = self.hardware.receive_packet(&mut room) else { break };
            let Some(auth) = self.auth.as_ref().filter(|_| length > 0) else { continue };
            let packet = room.get(..length).unwrap_or(&room);
            let accepts = |message: &R::Message| self.robot.accepts(message);
            // The roster counts what it refuses.
            let _ = self.roster.receive(packet, auth, self.context, now, accepts);
        }
    }

    /// Sends the robot's message when a frame is due.
    fn announce(&mut self, now: Instant) {
        // A clock that has jumped back says nothing of when a frame is due.
        if self.last_sent.is_some_and(|sent| now.has_reached(sent) && now.since(sent) < self.period) {
            return;
        }
        let Some(auth) = &self.auth else { return };
        let Some(message) = self.robot.message() else { return };
        self.turn = self.turn.wrapping_add(1);
        let peers = self.roster.at(now);
        let passed_on = if self.robot.repeats_itself() { to_pass_on(peers, self.turn) } else { None };
        let own;
        let envelope = if let Some(peer) = passed_on {
            peer.envelope()
        } else {
            // Taken even if the link then refuses the frame: a number that is used twice reads as a
            // replay.
            let Some(stamp) = self.numbering.next_stamp() else { return };
            own = Envelope { sender: self.roster.own(), stamp, message };
            &own
        };
        let mut buffer = [0; MAX_FRAME];
        let frame = encode(envelope, auth, self.context, &mut buffer);
        let noted = passed_on.is_none().then_some(envelope.stamp).zip(frame.ok());
        let taken = frame.is_ok_and(|frame| self.hardware.send(frame));
        if let Some((stamp, frame)) = noted {
            self.roster.note_sent(stamp, frame);
        }
        let counter = if taken { &mut self.sent } else { &mut self.unsent };
        *counter = counter.saturating_add(1);
        // A refused frame is not repeated: the next one is complete and newer.
        self.last_sent = Some(now);
    }
}

/// The teammate whose newest frame goes out in place of the robot's own: every second turn one of
/// those that have been heard, one after the other. A robot in a burst of losses so hears by way of
/// others what was said meanwhile, and everybody hears the last word of one that is silent for
/// good.
///
/// The frame is the one that the teammate has sent, with its number and its tag, so receivers take
/// it if it is news to them.
fn to_pass_on<M: Message>(peers: Peers<'_, M>, turn: u16) -> Option<&Peer<M>> {
    let heard = peers.iter().count();
    let others_hear = peers.team() > 2 && turn % 2 == 1;
    let start = usize::from(turn / 2) + peers.own().index();
    peers.iter().nth(start.checked_rem(heard)?).filter(|_| others_hear)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Navigator;
    use crate::adapters::{Absent, Body};
    use crate::missions::{CELLS, LAYERS, NODES, POLICIES, SECTION_5_1, WORDS};
    use core::num::NonZero;
    use core::task::Poll;
    use iibt_core::team::{Key, Member, RobotId};
    use static_cell::StaticCell;

    struct Desk;

    impl Link for Desk {
        fn receive(&mut self) -> Option<u8> {
            None
        }
        fn send(&mut self, _: &[u8]) -> bool {
            true
        }
    }

    impl Clock for Desk {
        fn now(&mut self) -> Instant {
            Instant(0)
        }
    }

    type Robot = Controller<
        Navigator<'static, CELLS, WORDS, LAYERS, NODES, POLICIES>,
        Body<Desk, Desk, Absent, Absent>,
    >;

    fn settings() -> Settings {
        let member = Member::new(RobotId(0), 2).expect("a team of two");
        Settings::new(member, Key::new([7; 16]), 1, NonZero::<u16>::MIN)
    }

    fn idle() -> Robot {
        Controller::idle(Navigator::idle(), settings(), Body::new(Desk, Desk).driving(Absent, Absent))
    }

    async fn next_tick() {
        core::future::poll_fn(|_| Poll::<()>::Pending).await;
    }

    #[test]
    fn a_controller_adds_little_to_the_task_that_builds_it() {
        static ROBOT: StaticCell<Robot> = StaticCell::new();
        let with = async {
            let robot = ROBOT.init_with(idle);
            let _ = robot.start(|navigator| navigator.start(&SECTION_5_1, &settings()));
            loop {
                robot.tick();
                next_tick().await;
            }
        };
        let without = async {
            loop {
                next_tick().await;
            }
        };
        let holding = async {
            let mut robot = idle();
            loop {
                robot.tick();
                next_tick().await;
            }
        };
        let [with, without, holding] = [size_of_val(&with), size_of_val(&without), size_of_val(&holding)];
        assert!(with <= without + 64, "{with} bytes for {without}");
        assert!(holding > size_of::<Robot>(), "a task that holds its robot is as large as that");
    }

    #[test]
    fn a_robot_says_nothing_before_it_is_started() {
        let mut robot = idle();
        for _ in 0..20 {
            robot.tick();
        }
        assert_eq!((robot.link_report().sent, robot.link_report().unsent), (0, 0));
        let start = |robot: &mut Robot| robot.start(|navigator| navigator.start(&SECTION_5_1, &settings()));
        assert!(start(&mut robot).is_ok() && start(&mut robot).is_err(), "it starts once");
    }

    #[test]
    fn a_robot_that_was_started_in_place_is_the_one_that_was_created() {
        let body = Body::new(Desk, Desk).driving(Absent, Absent);
        let created: Robot =
            Controller::new(Navigator::new(&SECTION_5_1, &settings()).expect("a mission"), settings(), body);
        let mut started = idle();
        started.start(|navigator| navigator.start(&SECTION_5_1, &settings())).expect("a mission");
        assert_eq!(std::format!("{:?}", started.robot), std::format!("{:?}", created.robot));
        assert_eq!(started.context, created.context);
    }
}
