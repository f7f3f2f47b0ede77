//! The log of an image in QEMU: why it decided and what its tree did, as `host-sim log` and
//! `host-sim tree replay` read it; logs that are cut off or garbled; the log in the memory, for a
//! probe.

use host_sim::tree::{Instance, Replay, library};
use host_sim::{FirmwareLog, LogItem, LogLine, Random};
use iibt_core::inference::CostExplanation;
use iibt_core::navigation::Stage;
use object::{Object, ObjectSymbol};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tests::qemu::{Robot, image_for, log_of};
use tests::rig::{OnHost, demo_page};

/// The image of the STM32F405 with more features than its board.
fn image_with(features: &str) -> PathBuf {
    image_for("team_member", "firmware", "thumbv7em-none-eabihf", &format!("stm32f405,{features}"))
}

fn explaining() -> &'static Path {
    static IMAGE: OnceLock<PathBuf> = OnceLock::new();
    IMAGE.get_or_init(|| image_with("explain"))
}

/// A mission of the image with a robot on the host, from the boot to the goals.
struct Mission {
    lines: Vec<String>,
    bytes: Vec<u8>,
    /// Why the robot on the host chose what both chose.
    why: CostExplanation,
}

fn flown() -> &'static Mission {
    static MISSION: OnceLock<Mission> = OnceLock::new();
    MISSION.get_or_init(|| {
        let mut image = Robot::boot_with_page(explaining(), &demo_page(0));
        let mut second = OnHost::robot(1);
        image.wait_for("boot");
        let (mut why, mut after) = (None, 0);
        // The image arrives with the frames that follow.
        for _ in 0..2000 {
            let frame = image.receive();
            image.send(&second.tick(&frame));
            let navigation = second.navigation();
            if navigation.report().stage == Stage::Agreed {
                why = navigation.weighed().explain();
            }
            after += u32::from(navigation.report().stage == Stage::Arrived);
            if after > 20 {
                break;
            }
        }
        image.wait_for("Arrived in round 0");
        let lines = image.seen().iter().map(|line| line.message.clone()).collect();
        Mission { lines, bytes: image.log_bytes().to_vec(), why: why.expect("it has decided") }
    })
}

/// The numbers in a text.
fn numbers(text: &str) -> Vec<f32> {
    let is_part = |character: char| !(character.is_ascii_digit() || "e.-".contains(character));
    text.split(is_part).filter_map(|word| word.trim_matches('.').parse().ok()).collect()
}

#[test]
fn the_image_logs_why_it_chose_as_the_robot_on_the_host_would_explain_it() {
    let Mission { lines, why, .. } = flown();
    let line = lines.iter().find(|line| line.contains(": why ")).expect("it explains its decision");
    let (_, text) = line.split_once(": why ").expect("it was found");
    let next = why.next.expect("there is another policy");
    let ranked = |ranked: iibt_core::inference::RankedPolicy| {
        let cost = ranked.cost;
        let terms = [cost.time, cost.epistemic, cost.habit, cost.delay, cost.price].map(f32::from);
        let head = [ranked.policy as f32, ranked.probability, cost.total() as f32, 8.0];
        [&head[..], &terms[..]].concat()
    };
    let mut expected = [ranked(why.chosen), vec![why.policies as f32], ranked(next)].concat();
    if let Some((term, by)) = why.decided_by {
        expected.extend([why.lead() as f32, f32::from(by)]);
        assert!(text.ends_with(&format!("dearer by {}, most by {term:?} ({by})", why.lead())), "{text}");
    } else {
        assert!(text.ends_with(", as dear and later in the list"), "{text}");
    }
    let logged = numbers(text);
    let bits = |numbers: &[f32]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&logged), bits(&expected), "{text}\n{why:?}");
}

fn pilot() -> Instance {
    let document = library::find("pilot").expect("it is built in").expect("it is sound");
    Instance::of(&document, "Pilot").expect("it is sound")
}

fn replay(lines: &[String]) -> Replay {
    let ticks = pilot().recorded("log", lines.join("\n").as_bytes(), None);
    pilot().replay(&ticks.unwrap_or_else(|error| panic!("{error}"))).expect("the engine has the tree")
}

#[test]
fn the_tree_of_the_image_replays_from_its_log() {
    let replay = replay(&flown().lines);
    assert_eq!((replay.fault.as_deref(), replay.gaps.len()), (None, 0));
    let first = "\
tick 1, 0 ms
RUNNING  ReactiveSequence
SUCCESS  ├─ Fallback
SUCCESS  │  ├─ BatteryEnough
         │  └─ Recharge
RUNNING  └─ MoveToGoal
";
    let drawn = &replay.ticks[0].text;
    assert_eq!(drawn.lines().skip(1).collect::<Vec<_>>(), first.lines().skip(1).collect::<Vec<_>>());
    assert!(drawn.starts_with("tick 1, "), "{drawn}");
    let last = &replay.ticks.last().expect("it has ticked").text;
    assert!(last.contains("SUCCESS  ReactiveSequence") && last.contains("SUCCESS  └─ MoveToGoal"), "{last}");
}

#[test]
fn what_is_left_out_of_the_log_of_the_image_is_found() {
    let lines = &flown().lines;
    let about_the_tree = |line: &String| line.contains(": tree ");
    let entries: Vec<_> = (0..lines.len()).filter(|&line| about_the_tree(&lines[line])).collect();
    assert!(entries.len() >= 3, "{entries:?}");
    for &entry in &entries {
        let (head, changes) = lines[entry].split_once(" ms:").expect("an entry");
        let changes: Vec<_> = changes.split_whitespace().collect();
        for omitted in 0..changes.len() {
            let rest: String = (0..changes.len())
                .filter(|&it| it != omitted)
                .map(|it| format!(" {}", changes[it]))
                .collect();
            let mut altered = lines.clone();
            altered[entry] = format!("{head} ms:{rest}");
            assert!(replay(&altered).fault.is_some(), "{} without {}", lines[entry], changes[omitted]);
        }
    }
    // The last entry may be the end of the log; every other one is missed.
    for &entry in &entries[..entries.len() - 1] {
        let mut altered = lines.clone();
        altered.remove(entry);
        assert_eq!(replay(&altered).gaps.len(), 1, "without {}", lines[entry]);
    }
}

/// What a log decodes to: the lines, and how many frames cannot be read.
fn decoded(bytes: &[u8]) -> (Vec<LogLine>, usize) {
    static LOG: OnceLock<FirmwareLog> = OnceLock::new();
    let log = LOG.get_or_init(|| log_of(explaining(), &std::fs::read(explaining()).expect("the image")));
    let mut log = log.clone();
    let mut items = log.receive(bytes);
    items.extend(log.finish().map(LogItem::Unreadable));
    let count = items.len();
    let lines: Vec<_> = items
        .into_iter()
        .filter_map(|item| match item {
            LogItem::Line(line) => Some(line),
            LogItem::Unreadable(_) => None,
        })
        .collect();
    let unreadable = count - lines.len();
    (lines, unreadable)
}

#[test]
fn a_log_that_is_cut_off_loses_the_frame_that_is_cut() {
    let bytes = &flown().bytes;
    let (whole, unreadable) = decoded(bytes);
    assert_eq!(unreadable, 0);
    let mut random = Random::new(1);
    assert!(whole.len() > 20 && whole.iter().any(|line| line.tick.is_some() && line.source.is_some()));
    for _ in 0..100 {
        let cut = 1 + random.below(bytes.len() - 1);
        let (before, unreadable) = decoded(&bytes[..cut]);
        assert!(unreadable <= 1 && whole.starts_with(&before), "to byte {cut}");
        let (after, unreadable) = decoded(&bytes[cut..]);
        // The rest of a frame may be a whole message by chance; all that follow are right.
        let right = after.len().min(whole.len() - before.len() - 1);
        assert!(unreadable <= 1 && whole.ends_with(&after[after.len() - right..]), "from byte {cut}");
        assert!(before.len() + after.len() + 1 >= whole.len(), "at byte {cut}");
    }
}

#[test]
fn a_garbled_byte_costs_two_messages_at_most() {
    let bytes = &flown().bytes;
    let (whole, _) = decoded(bytes);
    let mut random = Random::new(2026);
    let (mut reported, mut wrong) = (0, 0);
    for _ in 0..200 {
        let (at, mut garbled) = (random.below(bytes.len()), bytes.clone());
        garbled[at] ^= 1 << random.below(8);
        let (lines, unreadable) = decoded(&garbled);
        let same = whole.iter().zip(&lines).take_while(|(a, b)| a == b).count();
        let rest =
            whole[same..].iter().rev().zip(lines[same..].iter().rev()).take_while(|(a, b)| a == b).count();
        assert!(same + rest + 2 >= whole.len(), "byte {at}");
        reported += usize::from(unreadable > 0);
        wrong += usize::from(unreadable == 0);
    }
    println!("{reported} garbled bytes are reported, {wrong} give another message: defmt has no checksum");
    assert!(reported > wrong / 2);
}

#[test]
fn bytes_that_are_no_log_are_refused_frame_by_frame() {
    let mut random = Random::new(7);
    let mut unreadable = 0;
    for _ in 0..10 {
        let bytes: Vec<u8> = (0..5000).map(|_| random.below(256) as u8).collect();
        unreadable += decoded(&bytes).1;
    }
    assert!(unreadable > 100, "{unreadable}");
    let endless = vec![1; 200_000];
    assert_eq!(decoded(&[&endless[..], &[0], &flown().bytes].concat()).1, 1);
}

/// A probe reads the control block of RTT, and the bytes up to its write offset.
#[test]
fn the_log_lies_in_the_memory_for_a_probe() {
    let path = image_with("rtt");
    let elf = std::fs::read(&path).expect("the image");
    let file = object::File::parse(&*elf).expect("an ELF file");
    let block =
        file.symbols().find(|symbol| symbol.name() == Ok("_SEGGER_RTT")).expect("it logs by RTT").address();
    let mut image = Robot::boot_with_page(&path, &demo_page(0));
    assert!(image.receive().len() > 10, "it announces what it knows");
    let mut paused = image.pause();
    let header = paused.memory(block as u32, 48);
    let word = |at: usize| u32::from_le_bytes(header[at..at + 4].try_into().expect("four bytes"));
    assert_eq!((&header[..10], word(16)), (&b"SEGGER RTT"[..], 1));
    let (buffer, size, written) = (word(28), word(32), word(36));
    assert!(written > 10 && written < size, "{written} of {size}");
    let bytes = paused.memory(buffer, written as usize);
    drop(paused);
    let mut log = log_of(&path, &elf);
    let lines: Vec<_> = log.receive(&bytes).into_iter().map(|item| format!("{item:?}")).collect();
    assert!(lines.iter().any(|line| line.contains("boot: robot 1 of 2 on p28")), "{lines:#?}");
    assert!(!lines.iter().any(|line| line.contains("Unreadable")), "{lines:#?}");
}
