//! The image in QEMU against the host: the same plan with the same bits, and a mission flown
//! together.

use firmware::adapters::Chassis;
use firmware::missions::{SECTION_5_1, WORDS};
use firmware::page::Slots;
use host_sim::{Provision, Random, library};
use iibt_core::grid::Cell;
use iibt_core::navigation::{Intention, Stage};
use iibt_core::team::rounds::{Answer, Choice, Digest, Scores};
use iibt_core::team::{Envelope, RobotId, SipHash64, decode};
use std::num::NonZero;
use tests::budgets::assert_stack_within;
use tests::qemu::{MICROBIT, RISC_V, Robot, image_for, number, reduced_image, team_member};
use tests::rig::{DEMO_KEY, OnHost, ReducedOnHost, SizedOnHost, demo_keys, demo_page};

/// Flies section 5.1 with the image: robot 2 hears every frame of it and answers with what
/// `disturb` makes of its own, but where the last answer is still on its way.
fn fly<const L: usize, const M: usize, const K: usize>(
    image: &mut Robot,
    second: &mut SizedOnHost<L, M, K>,
    mut disturb: impl FnMut(Vec<u8>) -> Vec<u8>,
) -> Vec<Envelope<Intention<WORDS, K>>> {
    let (auth, context) = (SipHash64::with(demo_keys()), second.context());
    let mut said: Vec<Envelope<Intention<WORDS, K>>> = vec![];
    let has_arrived = |said: &Envelope<Intention<WORDS, K>>| matches!(said.message.rounds.answer, Answer::Decided { step, .. } if step == 6);
    while stage(second) != Stage::Arrived || !said.last().is_some_and(has_arrived) {
        let frame = image.receive();
        let inside = &frame[1..frame.len() - 1];
        said.push(decode(inside, &auth, context).expect("the image sends authentic frames"));
        let answer = disturb(second.tick(&frame));
        if image.has_taken_all() {
            image.send(&answer);
        }
        assert!(said.len() < 2000, "no arrival after {} frames: {:#?}", said.len(), image.seen());
    }
    said
}

fn stage<const L: usize, const M: usize, const K: usize>(robot: &SizedOnHost<L, M, K>) -> Stage {
    robot.navigation().report().stage
}

/// The posterior and the costs that the image logged of its policies.
fn logged(image: &mut Robot, policies: usize) -> Vec<(u32, u32)> {
    let row = |policy: usize| {
        let line = image.wait_for(&format!("posterior of {policy}:")).message;
        let bits = line.split(": ").nth(2).and_then(|rest| rest.split(',').next()).expect("bits");
        (u32::from_str_radix(bits, 16).expect("eight hexadecimal digits"), number(&line, "cost "))
    };
    (0..policies).map(row).collect()
}

#[test]
fn the_image_decides_with_the_same_bits_as_the_host_and_arrives_with_a_robot_on_the_host() {
    decides_and_arrives(Robot::boot_with_page(team_member(), &demo_page(0)));
}

/// The same program on another instruction set, without a floating-point unit. Its milliseconds
/// are those of the host, so it ticks and drives faster.
#[test]
fn the_image_on_a_risc_v_decides_with_the_same_bits_as_the_host_and_arrives() {
    let image = image_for("team_member", "firmware", "riscv32imc-unknown-none-elf", "riscv-virt");
    decides_and_arrives(Robot::boot_on(RISC_V, &image, (0x8020_0000, &fast_page(20))));
}

/// The page that makes it robot 1, which drives twenty times as fast, with a tick of so many
/// milliseconds.
fn fast_page(tick: u16) -> Vec<u8> {
    let provision = Provision {
        epoch: 1,
        tick: NonZero::new(tick).expect("not zero"),
        chassis: Some(Chassis { cell: 0.5, track: 0.1, speed: 5.0, duty: 60 }),
        ..Provision::new(RobotId(0), DEMO_KEY)
    };
    provision.page_of(&SECTION_5_1).expect("it fits")
}

/// The reduced configuration on the smallest chip, whose image has no log: what it says is what its
/// twin in process says, which hears the same.
///
/// QEMU hands over what this chip hears byte by byte, and needs up to 20 ms for each on a busy host.
/// With ticks as short as those of the other chips most frames would come too late.
#[test]
fn the_reduced_image_on_a_cortex_m0_decides_as_its_twin_in_process_and_arrives() {
    let page = (Slots::NRF51822.first, &fast_page(500)[..]);
    let mut image = Robot::boot_stopped_on(MICROBIT, &reduced_image(), page);
    let top = image.pause().paint();
    let mut second = ReducedOnHost::robot(1);
    let mut twin = ReducedOnHost::robot(0);
    let context = twin.context();
    let mut twin_said = vec![];
    let said = fly(&mut image, &mut second, |frame| {
        twin_said.push(twin.tick(&frame));
        frame
    });
    let used = top - image.pause().lowest_used();
    assert_stack_within("nrf51822", "stack", used.into());
    let auth = SipHash64::with(demo_keys());
    let twin_said = twin_said.iter().map(|frame| decode(&frame[1..frame.len() - 1], &auth, context));
    let twin_said: Vec<_> = twin_said.map(|said| said.expect("it sends authentic frames")).collect();
    let (own, twins) = (decision(&said), decision(&twin_said));
    assert!(own.1.len() > 4, "{own:?}");
    assert_eq!(own, twins);

    let other = second.navigation().report().goal.expect("it has a goal");
    let own = twin.navigation().report().goal.expect("it has a goal");
    let mut goals = [own, other];
    goals.sort_unstable();
    assert_eq!(goals, SECTION_5_1.goals, "each has a goal of its own");
}

/// What a robot has decided from, its scores, and its choice, by what it said.
fn decision<const K: usize>(said: &[Envelope<Intention<WORDS, K>>]) -> (Digest, Scores<K>, Choice) {
    let answers = said.iter().map(|said| &said.message.rounds.answer);
    let mut decided = answers.filter_map(|answer| match answer {
        Answer::Decided { digest, scores: Some(scores), choice: Some(choice), .. } => {
            Some((*digest, scores.clone(), *choice))
        }
        _ => None,
    });
    decided.next().expect("it has decided")
}

fn decides_and_arrives(mut image: Robot) {
    let mut second = OnHost::robot(1);
    image.wait_for("boot");
    fly(&mut image, &mut second, |frame| frame);

    let weighed = second.navigation().weighed();
    let on_host: Vec<_> = weighed
        .posterior()
        .iter()
        .zip(weighed.costs())
        .map(|(p, cost)| (p.to_bits(), cost.total()))
        .collect();
    assert!(on_host.len() > 4 && logged(&mut image, on_host.len()) == on_host, "{on_host:08x?}");
    let chosen = image.wait_for("chose p");
    let own = number(&chosen.message, "chose p");
    image.wait_for("Agreed in round 0");
    image.wait_for("step 6 done");
    image.wait_for("Arrived in round 0");

    let other = second.navigation().report().goal.expect("it has a goal");
    let mut goals = [Cell(own as u16), other];
    goals.sort_unstable();
    assert_eq!(goals, SECTION_5_1.goals, "each has a goal of its own");
}

/// Robot 2's line carries ten bytes of noise for each of a frame, a quarter of them delimiters, as
/// fast as the emulator takes them.
#[test]
fn the_image_arrives_although_ten_times_as_much_noise_as_frames_comes_in() {
    let mut image = Robot::boot_with_page(team_member(), &demo_page(0));
    let mut random = Random::new(1);
    image.wait_for("boot");
    fly(&mut image, &mut OnHost::robot(1), |frame| {
        let noise = |random: &mut Random| match random.below(4) {
            0 => 0,
            _ => random.below(256) as u8,
        };
        let before: Vec<u8> = (0..5 * frame.len()).map(|_| noise(&mut random)).collect();
        let after: Vec<u8> = (0..5 * frame.len()).map(|_| noise(&mut random)).collect();
        [before, frame, after].concat()
    });
    image.wait_for("Arrived");
    assert!(!image.seen().iter().any(|line| line.level == "error"), "{:#?}", image.seen());
}

/// Before each frame of robot 2 comes its beginning, cut at every place in turn.
#[test]
fn the_image_arrives_although_every_frame_comes_after_one_that_was_cut_off() {
    let mut image = Robot::boot_with_page(team_member(), &demo_page(0));
    let (mut cut, mut longest) = (0, 0);
    image.wait_for("boot");
    fly(&mut image, &mut OnHost::robot(1), |frame| {
        cut += 1;
        longest = longest.max(frame.len());
        [&frame[..cut % frame.len().max(1)], &frame].concat()
    });
    image.wait_for("Arrived");
    assert!(cut > longest, "{cut} frames of up to {longest} bytes were cut");
    assert!(!image.seen().iter().any(|line| line.level == "error"), "{:#?}", image.seen());
}

#[test]
fn the_image_stands_without_a_page_that_it_can_use_and_logs_the_reason() {
    let reason = |page: &[u8]| {
        let mut image = Robot::boot_with_page(team_member(), page);
        image.wait_for("stands").message
    };
    let page = demo_page(1);
    assert!(reason(&[]).contains("Blank"), "nothing is written");
    assert!(reason(b"a page of another kind").contains("Magic"));
    for at in [4, 5, 16, 19, 60, page.len() - 1] {
        let mut damaged = page.clone();
        damaged[at] ^= 1;
        let reason = reason(&damaged);
        assert!(reason.contains("NoPage") && reason.contains("byte "), "{at}: {reason}");
    }
    assert!(reason(&page[..page.len() / 2]).contains("Checksum"), "cut off");

    let provision = |scenario: &str, epoch| {
        let scenario = library::find(scenario).expect("built in").expect("sound");
        Provision { epoch, ..Provision::new(RobotId(0), DEMO_KEY) }.page(&scenario).expect("it fits")
    };
    let too_large = reason(&provision("courtyard", 1));
    assert!(too_large.contains("TooLarge { size: Cells, needed: 256, room: 49 }"), "{too_large}");
    assert!(reason(&provision("two-goals", 0)).contains("NotCounted"), "the emulator cannot count");
}

#[test]
fn the_same_image_is_any_robot_of_any_team_by_its_page() {
    let boot = |scenario: &str, robot: u8, epoch| {
        let scenario = library::find(scenario).expect("built in").expect("sound");
        let provision = Provision { epoch, ..Provision::new(RobotId(robot), DEMO_KEY) };
        let page = provision.page(&scenario).expect("it fits");
        let mut image = Robot::boot_with_page(team_member(), &page);
        let line = image.wait_for("boot").message;
        image.wait_for(&format!("boot: epoch {epoch}"));
        let expected = format!(
            "boot: robot {} of {} on p{}",
            robot + 1,
            scenario.robots.len(),
            scenario.robots[usize::from(robot)].start.0
        );
        assert_eq!(line, expected);
    };
    boot("two-goals", 1, 1);
    boot("factory", 2, 7);
    boot("shift", 0, 900);
}
