//! Teams of emulated robots beside the same teams in process: the same decisions, frames and moves,
//! bit for bit.

use bumpalo::Bump;
use firmware::adapters::base::{self, BaseAnswer};
use host_sim::hil::{Bench, HilRecord, Sabotage, fly_emulated, fly_emulated_task};
use host_sim::task::{TableMission, Trouble, built_in as built_in_task};
use host_sim::tree::{Document, Extras};
use host_sim::{
    Conditions, FlightEvent, FrameRecording, KEY, Pilot, Provision, Record, Scenario, fly, library,
};
use iibt_core::grid::Cell;
use iibt_core::team::RobotId;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::{Duration, Instant};
use tests::elf::Elf;
use tests::qemu::{PATIENCE, Robot, image};

fn based_member() -> &'static Path {
    static IMAGE: OnceLock<PathBuf> = OnceLock::new();
    IMAGE.get_or_init(|| image("based_member"))
}

fn built_in(name: &str) -> Scenario {
    library::find(name).expect("it is built in").expect("it is sound")
}

fn bench() -> Bench {
    Bench { image: based_member().to_owned(), ..Bench::default() }
}

fn conditions(seed: u64, loss: f64) -> Conditions {
    Conditions { seed, loss: Some(loss), tree: Pilot::Image }
}

fn emulated(name: &str, conditions: Conditions, bench: &Bench) -> HilRecord {
    fly_emulated(&built_in(name), conditions, bench, &mut ())
        .unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A flight in which nothing differed, all arrived, and no robot collided.
#[track_caller]
fn same(flown: &HilRecord) -> &Record {
    assert_eq!(flown.difference, None);
    assert!(flown.record.outcome.is_success() && flown.record.collisions.total() == 0);
    let robots = flown.record.robots.len() as u32;
    assert!(flown.compared.decisions >= robots && flown.compared.moves > robots, "{:?}", flown.compared);
    &flown.record
}

#[test]
fn an_emulated_team_flies_as_the_team_in_process() {
    for (name, seed, loss) in [("two-goals", 0, 0.0), ("factory", 3, 0.2)] {
        let flown = emulated(name, conditions(seed, loss), &bench());
        let in_process = fly(&built_in(name), conditions(seed, loss), &mut ()).expect("it is sound");
        assert_eq!(*same(&flown), in_process, "{name}");
    }
}

#[test]
fn a_machine_that_is_reset_decides_as_the_robot_that_restarts_in_process() {
    let bench = Bench { restarts: vec![(1, 6)], ..bench() };
    let flown = emulated("factory", conditions(5, 0.2), &bench);
    let restarted = FlightEvent::Restarted { robot: 1 };
    assert!(same(&flown).events.iter().any(|timed| timed.tick == 6 && timed.event == restarted));
}

/// The cells that each robot has been on, one after the other.
fn ways(record: &Record) -> Vec<Vec<Cell>> {
    let way = |robot: usize| {
        let mut cells: Vec<_> = record.history.iter().map(|cells| cells[robot]).collect();
        cells.dedup();
        cells
    };
    (0..record.robots.len()).map(way).collect()
}

#[test]
fn a_recording_that_is_played_back_changes_no_move() {
    let (scenario, conditions) = (built_in("two-goals"), conditions(1, 0.0));
    let mut recording = FrameRecording::new(Vec::new());
    let first = fly_emulated(&scenario, conditions, &bench(), &mut recording).expect("it is sound");
    let replay = recording.finish().expect("a list takes all");
    let second = fly_emulated(&scenario, conditions, &Bench { starts: 1, replay, ..bench() }, &mut ());
    let second = second.expect("it is sound");
    assert_eq!(ways(same(&first)), ways(same(&second)));
    let refused = |flown: &HilRecord| flown.record.robots.iter().map(|robot| robot.rejected).sum::<u32>();
    assert!(refused(&first) == 0 && refused(&second) > 20, "{}", refused(&second));
}

#[test]
fn a_flipped_bit_and_a_wrong_reading_are_the_first_difference() {
    for (sabotage, tick) in [(Sabotage::Bit, 1), (Sabotage::Reading, 2)] {
        let bench = Bench { sabotage: Some((1, tick, sabotage)), ..bench() };
        let flown = emulated("two-goals", conditions(0, 0.0), &bench);
        let difference = flown.difference.unwrap_or_else(|| panic!("{sabotage:?} is not seen"));
        assert_eq!((difference.robot.as_str(), difference.tick), ("R2", tick), "{difference}");
        assert!(difference.what.contains(", in process "), "{difference}");
    }
}

/// The trees of two robots, with nodes of the full set, that decide when to pursue which aim.
const TREES: &str = include_str!("../host-sim/tasks/bottle-and-plate.xml");

#[test]
fn robots_with_a_task_fly_with_the_trees_of_their_pages_as_in_process() {
    let image = image("based_table_robot");
    let arena = Bump::new();
    let text = built_in_task("bottle-and-plate").expect("it is built in");
    let plain = TableMission::parse(&arena, "bottle-and-plate", text).expect("it is sound");
    let document = Document::parse("trees.xml", TREES, &Extras::default()).expect("it is XML");
    let with_trees = plain.clone().with_trees(&document).expect("they are sound");
    for (mission, seed, loss) in [(&plain, 0, 0.0), (&with_trees, 0, 0.0), (&with_trees, 4, 0.2)] {
        let trouble = Trouble { loss: Some(loss), ..Trouble::default() };
        let bench = Bench { image: image.clone(), ..Bench::default() };
        let done = fly_emulated_task(mission, seed, trouble, &bench).expect("it starts");
        assert_eq!(done.difference, None, "seed {seed}, loss {loss}");
        assert!(done.flown.success && done.compared.decisions > 4 && done.compared.moves > 4, "{done:?}");
    }
    let ticks = |mission: &TableMission<'_>| {
        let flown = mission.fly(0, Trouble::default()).expect("it fits");
        flown.operated.iter().map(|begun| (begun.tick, begun.robot, begun.operator)).collect::<Vec<_>>()
    };
    assert_ne!(ticks(&plain), ticks(&with_trees), "the trees make a difference");
}

#[test]
fn a_robot_with_a_task_stands_where_its_page_is_for_another_one() {
    let image = image("based_table_robot");
    let arena = Bump::new();
    let text = built_in_task("valves").expect("it is built in");
    let valves = TableMission::parse(&arena, "valves", text).expect("it is sound");
    let provision = Provision { epoch: 1, ..Provision::new(RobotId(0), KEY) };
    let pages = [
        (provision.page_of_task(&valves).expect("it is sound"), "OtherTask"),
        (provision.page(&built_in("two-goals")).expect("it is sound"), "size: Cells"),
    ];
    for (page, why) in pages {
        let stands = Robot::boot_with_page(&image, &page).wait_for("stands: ");
        assert!(stands.level == "error" && stands.message.contains(why), "{stands:?}");
    }
}

#[test]
fn an_image_whose_base_is_silent_tells_it_to_stop_once() {
    let folder = std::env::temp_dir().join(format!("silent-base-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("there is room");
    let [page, said] = ["page", "said"].map(|name| folder.join(name));
    let provision = Provision { epoch: 1, ..Provision::new(RobotId(0), KEY) };
    std::fs::write(&page, provision.page(&built_in("two-goals")).expect("it is sound"))
        .expect("there is room");
    let mut qemu = Command::new("qemu-system-arm")
        .args(["-M", "netduinoplus2", "-display", "none", "-monitor", "none", "-no-reboot"])
        .args(["-serial", "null", "-serial", "null", "-serial", &format!("file:{}", said.display())])
        .args(["-device", &format!("loader,file={},addr=0x08080000,force-raw=on", page.display())])
        .arg("-kernel")
        .arg(based_member())
        .spawn()
        .expect("qemu-system-arm starts: `tests/run` installs it");
    let answers = || {
        let bytes = std::fs::read(&said).unwrap_or_default();
        let frames = bytes.split(|&byte| byte == 0).filter_map(|frame| base::read(frame).ok());
        frames.map(|(_, answer)| answer).collect::<Vec<BaseAnswer>>()
    };
    let since = Instant::now();
    while answers().len() < 2 && since.elapsed() < PATIENCE {
        std::thread::sleep(Duration::from_millis(10));
    }
    std::thread::sleep(Duration::from_millis(500)); // seconds of the robot's own time
    qemu.kill().and_then(|()| qemu.wait()).expect("it is a child");
    assert_eq!(answers(), [BaseAnswer::Ready, BaseAnswer::Stop]);
    let _ = std::fs::remove_dir_all(&folder);
}

#[test]
fn the_image_with_a_base_has_no_panicking_branch_and_no_allocator() {
    let elf = Elf::read(based_member());
    let unwanted = ["panick", "__rust_alloc", "__rg_alloc", "__rust_realloc", "malloc", "alloc5alloc"];
    assert_eq!(elf.symbols_with(&unwanted).collect::<Vec<_>>(), Vec::<&str>::new());
}
