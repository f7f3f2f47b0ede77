//! What a robot does whose program fails: its motors stand at once, and after the restart it logs
//! why. The emulated chip has the motors' timer, but no hardware watchdog: of that, the image's
//! accesses are looked at.

use firmware::fail_safe::MOST_FAILURES;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use std::{env, fs};
use tests::gdb::Paused;
use tests::qemu::{PATIENCE, RESTARTING, Robot, image, team_member};
use tests::rig::{OnHost, demo_page};

/// The orders of the image `fault`, and what it logs of them.
const FAILURES: [(u8, &str); 4] = [
    (b'p', "a panic in line "),
    (b'f', "a fault at 0x08"),
    (b's', "a stack overflow"),
    (b'l', "a main loop that was late, by now 101 ms"),
];

/// QEMU pauses where the chip would be reset.
const TO_THE_RESET: [&str; 1] = ["-no-shutdown"];

/// What the timer of the motors gives out on both of its pins.
#[derive(Debug, PartialEq, Eq)]
enum Motors {
    /// Duty cycles of which one at least is not zero.
    Run,
    /// Duty cycles of zero.
    Stand,
    /// Low, whatever the duty cycles are.
    Cut,
}

impl Motors {
    fn of(mut chip: Paused) -> Self {
        let timer = 0x4000_0400; // TIM3
        let modes = chip.word(timer + 0x18) & 0x7070;
        let duty = [0x34, 0x38].map(|register| chip.word(timer + register));
        match (modes, duty) {
            (0x4040, _) => Self::Cut,
            (0x6060, [0, 0]) => Self::Stand,
            (0x6060, _) => Self::Run,
            _ => panic!("modes {modes:#x}, duty cycles {duty:?}"),
        }
    }
}

#[test]
fn the_motors_of_a_robot_that_fails_stand_before_it_is_reset() {
    let image = image("fault");
    for (order, why) in FAILURES {
        let mut robot = Robot::boot_as(&image, &TO_THE_RESET, None);
        robot.wait_for("boot");
        assert_eq!(Motors::of(robot.pause()), Motors::Run);
        robot.send(&[order]);
        assert_eq!(robot.wait_for(&format!("fails: {why}")).level, "error");
        assert_eq!(Motors::of(robot.pause()), Motors::Cut, "after {why}");
    }
}

#[test]
fn a_robot_that_was_restarted_logs_why_and_one_that_was_switched_on_does_not() {
    let mut robot = Robot::boot_as(&image("fault"), &RESTARTING, None);
    robot.wait_for("boot");
    assert!(!robot.seen().iter().any(|line| line.message.contains("restarted")), "{:?}", robot.seen());
    for (order, why) in FAILURES {
        robot.send(&[order]);
        robot.wait_for(&format!("restarted after {why}"));
        robot.wait_for("boot");
    }
}

/// It fails each time within a minute of its start.
#[test]
fn a_robot_that_fails_again_and_again_stands_until_somebody_resets_it() {
    let mut robot = Robot::boot_as(&image("fault"), &RESTARTING, None);
    for _ in 0..MOST_FAILURES {
        robot.wait_for("boot");
        assert_eq!(Motors::of(robot.pause()), Motors::Run);
        robot.send(b"p");
        robot.wait_for("restarted after a panic in line ");
    }
    assert_eq!(robot.wait_for("stands: failed 5 times in a row").level, "error");
    assert_ne!(Motors::of(robot.pause()), Motors::Run);
}

/// The released image, driving, with its program counter put where there is no code.
#[test]
fn a_robot_of_a_team_that_faults_on_its_way_stands_and_starts_again() {
    let (mut robot, _) = driving(0, &TO_THE_RESET);
    lead_astray(&robot);
    robot.wait_for("fails: a fault at 0x0f00");
    assert_eq!(Motors::of(robot.pause()), Motors::Cut);

    let (mut robot, _) = driving(0, &RESTARTING);
    lead_astray(&robot);
    robot.wait_for("restarted after a fault at 0x0f00");
    robot.wait_for("boot: robot 1 of 2");
}

/// Half of a team without robot 1 is no quorum.
#[test]
fn the_motors_of_a_robot_whose_link_is_gone_stand_on_its_way() {
    let (mut robot, _) = driving(1, &TO_THE_RESET);
    let line = robot.wait_for("waits: Quorum(RobotId(0))");
    assert_eq!(line.level, "warn");
    // A move that it has begun it makes: between two cells it would be in the others' way.
    (0..100).find(|_| stands_after_a_frame(&mut robot)).expect("it drives on");
    (0..30).for_each(|frame| assert!(stands_after_a_frame(&mut robot), "frame {frame} after it stood"));
    let arrived = robot.seen().iter().filter(|line| line.message.contains("Arrived"));
    assert_eq!(arrived.count(), 0, "{:#?}", robot.seen());
}

/// It sends a frame a tick.
fn stands_after_a_frame(robot: &mut Robot) -> bool {
    robot.receive();
    Motors::of(robot.pause()) == Motors::Stand
}

/// The robot of a team with this number, from zero, that has just begun its first move, and its
/// teammate.
fn driving(number: u8, options: &[&str]) -> (Robot, OnHost) {
    let mut robot = Robot::boot_as(team_member(), options, Some(&demo_page(number)));
    let mut teammate = OnHost::robot(1 - usize::from(number));
    robot.wait_for("took");
    drive(&mut robot, &mut teammate);
    (robot, teammate)
}

/// Has a robot go on where there is no code, out of its sleep: out of its log, there would be none
/// of the fault before the restart.
fn lead_astray(robot: &Robot) {
    for _ in 0..10_000 {
        let mut paused = robot.pause();
        if paused.is_asleep() {
            return paused.jump(0x0f00_0000);
        }
    }
    panic!("it never sleeps: {:#?}", robot.seen());
}

/// Ticks both until the first one drives.
fn drive(robot: &mut Robot, teammate: &mut OnHost) {
    for _ in 0..300 {
        let heard = robot.receive();
        robot.send(&teammate.tick(&heard));
        if Motors::of(robot.pause()) == Motors::Run {
            return;
        }
    }
    panic!("it does not drive: {:#?}", robot.seen());
}

/// Accesses to the watchdog of the emulated chip, which has none but tells of them, by another
/// name.
struct Accesses(PathBuf);

impl Accesses {
    fn new(name: &str) -> Self {
        Self(env::temp_dir().join(format!("iibt-{name}-{}", std::process::id())))
    }

    fn path(&self) -> &Path {
        &self.0
    }

    /// Each register's offset and the value that was written.
    fn writes(&self) -> Vec<(u32, u32)> {
        let hexadecimal = |line: &str, before: &str| {
            let digits = line.split(before).nth(1)?;
            let digits = digits.trim_start_matches("0x");
            let end = digits.find(|digit: char| !digit.is_ascii_hexdigit()).unwrap_or(digits.len());
            u32::from_str_radix(&digits[..end], 16).ok()
        };
        let text = fs::read_to_string(&self.0).unwrap_or_default();
        let writes = text.lines().filter(|line| line.starts_with("I2S2ext: unimplemented device write"));
        writes
            .filter_map(|line| Some((hexadecimal(line, "offset ")?, hexadecimal(line, "value ")?)))
            .collect()
    }

    /// The writes, once there are so many.
    fn wait_for(&self, count: usize) -> Vec<(u32, u32)> {
        let since = Instant::now();
        loop {
            let writes = self.writes();
            if writes.len() >= count {
                return writes;
            }
            assert!(since.elapsed() < PATIENCE, "{writes:x?}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for Accesses {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// The registers are those of the reference manual RM0090, section 21.4.
#[test]
fn the_watchdog_is_started_once_and_fed_until_the_program_hangs() {
    const KEY: u32 = 0;
    const FEED: (u32, u32) = (KEY, 0xaaaa);
    let accesses = Accesses::new("watchdog");
    let path = accesses.path().to_str().expect("a path of UTF-8");
    let mut robot = Robot::boot_as(&image("fault"), &["-d", "unimp", "-D", path], None);
    robot.wait_for("boot");
    let writes = accesses.wait_for(20);
    let [unlock, divider, reload, lock, start, fed @ ..] = &writes[..] else { panic!("{writes:x?}") };
    assert_eq!((*unlock, *lock, *start), ((KEY, 0x5555), FEED, (KEY, 0xcccc)));
    // 32 kHz / 256, counted down from 75: 608 ms.
    assert_eq!((*divider, *reload), ((4, 6), (8, 74)));
    assert!(fed.iter().all(|write| *write == FEED), "{writes:x?}");

    robot.send(b"d");
    let since = Instant::now();
    let mut before = 0;
    while accesses.writes().len() != before {
        assert!(since.elapsed() < PATIENCE, "a program that hangs feeds its watchdog");
        before = accesses.writes().len();
        std::thread::sleep(Duration::from_millis(200));
    }
}
