//! The image in QEMU against the host: the same decision with the same bits, and a mission flown
//! together.

use firmware::missions::{CANDIDATES, SECTION_5_1};
use iibt_core::grid::Cell;
use iibt_core::navigation::{Said, Stage};
use iibt_core::team::{SipHash64, decode};
use tests::qemu::{Line, Robot, number, team_member};
use tests::rig::{DEMO_KEY, OnHost, context};

/// The bits of one row of the posterior that the image logged.
fn row(line: &Line) -> Vec<u32> {
    let bits = line.message.rsplit(": ").next().expect("a row after the colon");
    bits.split(' ').map(|word| u32::from_str_radix(word, 16).expect("eight hexadecimal digits")).collect()
}

fn stage(robot: &OnHost) -> Stage {
    robot.navigation().stage()
}

/// The posterior of robot 1 when robot 2 is heard for the first time at this tick.
fn posterior_on_the_host(at: u32) -> Vec<Vec<u32>> {
    let (mut first, mut second) = (OnHost::robot(0), OnHost::robot(1));
    let hello = second.tick(&[]);
    for _ in 1..at {
        first.tick(&[]);
    }
    first.tick(&hello);
    assert_eq!(stage(&first), Stage::Announced, "it decides as soon as it hears robot 2");
    let joint = first.navigation().decision().joint().into_iter();
    joint.map(|row| row.iter().map(|p| p.to_bits()).collect()).collect()
}

#[test]
fn the_image_decides_with_the_same_bits_as_the_host_and_arrives_with_a_robot_on_the_host() {
    let mut image = Robot::boot(team_member());
    let mut second = OnHost::robot(1);
    image.wait_for("boot");

    // Robot 2 hears every frame of the image and answers each with one of its own.
    let auth = SipHash64::new(DEMO_KEY);
    let mut said: Vec<Said> = vec![];
    while stage(&second) != Stage::Arrived
        || said.last().is_none_or(|said| said.message.stage != Stage::Arrived)
    {
        let frame = image.receive();
        said.push(
            decode(&frame[1..frame.len() - 1], &auth, context(&SECTION_5_1))
                .expect("the image sends authentic frames"),
        );
        image.send(&second.tick(&frame));
        assert!(said.len() < 2000, "no arrival after {} frames: {:#?}", said.len(), image.seen());
    }

    let rows: Vec<Vec<u32>> =
        (0..CANDIDATES).map(|policy| row(&image.wait_for(&format!("posterior of {policy}:")))).collect();
    let chosen = image.wait_for("chose p");
    assert_eq!(rows, posterior_on_the_host(number(&chosen.message, "tick ")));
    assert_eq!(number(&chosen.message, "chose p"), 26, "{}", chosen.message);
    image.wait_for("Agreed in round 0");
    image.wait_for("step 6 done, on p26");
    image.wait_for("Arrived in round 0");

    let together: f32 =
        [(1, 2), (1, 3), (2, 1)].map(|(own, other)| f32::from_bits(rows[own][other])).iter().sum();
    assert!(together > 0.999, "simultaneous arrivals at different goals have {together}");
    assert_eq!(second.navigation().report().goal, Some(Cell(24)));

    let path = said.last().expect("the image has spoken").message.path;
    let cells: Vec<u16> = path.cells(&SECTION_5_1.map).map(|cell| cell.0).collect();
    assert_eq!(cells, [28, 29, 30, 31, 32, 33, 26], "path C");
}
