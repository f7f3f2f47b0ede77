//! The contract between a robot's own code and the control loop.

use iibt_core::team::{Invalid, Message, Peers};
use iibt_core::time::Instant;
use iibt_core::tree::Status;

/// A robot that a [`Controller`](crate::Controller) runs on hardware `H`: its sensing, behavior
/// tree, actions and messages.
///
/// The controller calls the methods once a tick, in the order in which they stand here. None of
/// them waits. A robot asks of its hardware what it needs, as bounds on `H`, and nothing else.
///
/// A lamp on each of two robots, lit only while both buttons are held:
///
/// ```
/// use core::num::NonZero;
/// use firmware::hardware::{Clock, Link};
/// use firmware::{Controller, Robot, Settings};
/// use iibt_core::team::{Key, Member, Message, Peers, RobotId};
/// use iibt_core::time::Instant;
/// use iibt_core::tree::{Halt, Leaves, Memory, Status, Tree};
/// use serde::{Deserialize, Serialize};
///
/// #[derive(Clone, Copy)]
/// enum Leaf {
///     Held,
///     TeammateHolds,
///     Light,
/// }
///
/// static TREE: Tree<Leaf, 4> = iibt_core::tree! {
///     ReactiveSequence {
///         Condition(Leaf::Held),
///         Condition(Leaf::TeammateHolds),
///         Action(Leaf::Light),
///     }
/// };
///
/// /// Whether the button is held.
/// #[derive(Clone, Copy, Serialize, Deserialize)]
/// struct Button(bool);
///
/// impl Message for Button {
///     const SCHEMA: &'static str = "button: held bool";
///     const MAX_BYTES: usize = 1;
/// }
///
/// #[derive(Default)]
/// struct Lamp {
///     memory: Memory<4>,
///     skills: Skills,
/// }
///
/// #[derive(Default)]
/// struct Skills {
///     held: bool,
///     teammate_holds: bool,
///     lit: bool,
/// }
///
/// impl Leaves<Leaf> for Skills {
///     fn condition(&mut self, leaf: &Leaf, _: Instant) -> bool {
///         match leaf {
///             Leaf::Held => self.held,
///             Leaf::TeammateHolds => self.teammate_holds,
///             Leaf::Light => false,
///         }
///     }
///     fn on_running(&mut self, _: &Leaf, _: Instant) -> Status {
///         self.lit = true;
///         Status::Running
///     }
///     fn on_halted(&mut self, _: &Leaf, _: Instant) -> Halt {
///         Halt::Done
///     }
/// }
///
/// /// What this robot needs beside a link and a clock.
/// trait Panel {
///     fn is_held(&mut self) -> bool;
///     fn light(&mut self, on: bool);
/// }
///
/// impl<H: Panel> Robot<H> for Lamp {
///     type Message = Button;
///
///     fn sense(&mut self, hardware: &mut H, _: Instant) {
///         self.skills.held = hardware.is_held();
///     }
///     fn tick(&mut self, peers: Peers<'_, Button>, now: Instant) -> Status {
///         self.skills.teammate_holds = peers.fresh().any(|peer| peer.message().0);
///         self.skills.lit = false;
///         TREE.tick(&mut self.memory, &mut self.skills, now).status
///     }
///     fn act(&mut self, hardware: &mut H) {
///         hardware.light(self.skills.lit);
///     }
///     fn message(&self) -> Option<Button> {
///         Some(Button(self.skills.held))
///     }
/// }
///
/// /// Hardware for the bench: what is sent and received lies in lists.
/// #[derive(Default)]
/// struct Bench {
///     held: bool,
///     lit: bool,
///     inbox: std::collections::VecDeque<u8>,
///     outbox: Vec<u8>,
/// }
///
/// impl Panel for Bench {
///     fn is_held(&mut self) -> bool {
///         self.held
///     }
///     fn light(&mut self, on: bool) {
///         self.lit = on;
///     }
/// }
/// impl Link for Bench {
///     fn receive(&mut self) -> Option<u8> {
///         self.inbox.pop_front()
///     }
///     fn send(&mut self, frame: &[u8]) -> bool {
///         self.outbox.extend(frame);
///         true
///     }
/// }
/// impl Clock for Bench {
///     fn now(&mut self) -> Instant {
///         Instant(0)
///     }
/// }
///
/// let robot = |number| {
///     let key = Key::new(*b"sixteen bytes...");
///     let member = Member::new(RobotId(number), 2).unwrap();
///     let settings = Settings::new(member, key, 1, NonZero::<u16>::MIN);
///     Controller::new(Lamp::default(), settings, Bench { held: true, ..Bench::default() })
/// };
/// let [mut first, mut second] = [robot(0), robot(1)];
/// first.tick();
/// assert!(!first.hardware().lit, "it has not heard the other");
/// second.hardware_mut().inbox.extend(first.hardware_mut().outbox.drain(..));
/// second.tick();
/// assert!(second.hardware().lit);
/// ```
#[doc(alias = "agent")]
#[doc(alias = "blackboard")]
pub trait Robot<H> {
    /// The message that the robot announces.
    type Message: Message;

    /// Returns a hash or number of the mission. Robots with different numbers reject each other's
    /// frames.
    fn mission(&self) -> u64 {
        0
    }

    /// Checks a teammate's message against what only this robot knows, its map for example.
    ///
    /// # Errors
    /// [`Invalid`] with what is wrong; the message is then refused and counted.
    fn accepts(&self, message: &Self::Message) -> Result<(), Invalid> {
        let _ = message;
        Ok(())
    }

    /// Reads the sensors.
    fn sense(&mut self, hardware: &mut H, now: Instant);

    /// Ticks the behavior tree once and returns the status of its root.
    fn tick(&mut self, peers: Peers<'_, Self::Message>, now: Instant) -> Status;

    /// Carries out the decision of the tick.
    fn act(&mut self, hardware: &mut H);

    /// Returns the message to announce now; `None` while there is nothing true to say.
    fn message(&self) -> Option<Self::Message>;

    /// Returns whether the message is the same as in the ticks before, so that all teammates in
    /// reach know it: every second frame then passes on the newest of a teammate.
    fn repeats_itself(&self) -> bool {
        false
    }
}
