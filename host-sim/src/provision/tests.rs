//! Pages as they are written and read: round trips, damage, sizes.

mod tree;

use super::*;
use crate::missions::{Ground, RandomMissions};
use crate::{KEY, library};
use embedded_storage::nor_flash::{ErrorType, ReadNorFlash};
use firmware::page::{Fault, Size, Slots, Which};
use iibt_core::team::{Context, FrameAuth, Keys, SipHash64};

const TWO: Slots = Slots { first: 0, second: 0x8000 };

/// Two copies, erased after their ends.
struct Copies([Vec<u8>; 2]);

impl ErrorType for Copies {
    type Error = core::convert::Infallible;
}

impl ReadNorFlash for Copies {
    const READ_SIZE: usize = 4;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        assert!(offset.is_multiple_of(4) && bytes.len().is_multiple_of(4), "READ_SIZE");
        let copy = &self.0[usize::from(offset >= TWO.second)];
        let at = (offset % TWO.second) as usize;
        let read = |index: usize| copy.get(at + index).copied().unwrap_or(0xff);
        bytes.iter_mut().enumerate().for_each(|(index, byte)| *byte = read(index));
        Ok(())
    }

    fn capacity(&self) -> usize {
        2 * TWO.second as usize
    }
}

fn scenarios() -> Vec<Scenario> {
    let ground = Ground::Drawn { width: 2..=20, height: 2..=20, walls: 0.0..=0.3 };
    let kind = |is_owned| RandomMissions {
        ground: ground.clone(),
        robots: 1..=8,
        goals: None,
        is_owned,
        is_solvable: false,
        limit: 200,
    };
    let drawn = (0..200).filter_map(|seed| kind(seed % 2 == 0).draw(seed).ok());
    let drawn = drawn.map(|text| Scenario::parse("drawn", &text).expect("sound"));
    let built_in = library::names().map(|name| library::find(name).expect("built in").expect("sound"));
    built_in.chain(drawn).collect()
}

fn page(generation: u32) -> Vec<u8> {
    let scenario = library::find("two-goals").expect("built in").expect("sound");
    Provision { generation, ..Provision::new(RobotId(1), KEY) }.page(&scenario).expect("it fits")
}

#[test]
fn every_mission_is_read_as_it_was_written() {
    let scenarios = scenarios();
    assert!(scenarios.len() > 150);
    for (number, scenario) in scenarios.iter().enumerate() {
        let robot = RobotId((number % scenario.robots.len()) as u8);
        let written = Provision {
            channel: number as u32 * 77_777,
            tick: NonZero::new(1 + number as u16).expect("not zero"),
            epoch: 3 * number as u32,
            budget: NonZero::new(number as u32),
            thresholds: Thresholds { low: number as u8 % 50, charged: 50 + number as u8 % 51 },
            chassis: (number % 3 == 0).then_some(Chassis { cell: 0.5, track: 0.1, speed: 0.25, duty: 60 }),
            rotation: number as u32 % 5,
            accepts: (number % 2 == 0).then_some(9),
            ..Provision::new(robot, KEY)
        };
        let bytes = written.page(scenario).unwrap_or_else(|error| panic!("{}: {error}", scenario.name));
        let mut read = AnyPage::EMPTY;
        let origin = read.load_bytes(&bytes).expect("it was checked");
        assert_eq!((origin.which, origin.generation), (Which::First, 1));
        let lists = read.path_lists();
        let same = on_mission::<{ words(MAX_CELLS, 1) }, _>(scenario, |mission| {
            assert_eq!(format!("{mission:?}"), format!("{:?}", read.mission(&lists)), "{}", scenario.name);
            Ok(mission.id())
        });
        assert_eq!(same, Ok(read.mission(&lists).id()));
        let budget = written.budget.or(scenario.inference.budget.and_then(NonZero::new));
        assert_eq!(
            (read.robot(), read.channel(), read.tick(), read.epoch(), read.budget()),
            (robot, written.channel, written.tick, written.epoch, budget)
        );
        assert_eq!((read.thresholds(), read.chassis()), (written.thresholds, written.chassis));
        assert_eq!(read.rotations(), (written.rotation, written.accepts));
    }
}

#[test]
fn the_keys_of_a_page_are_those_derived_from_the_teams() {
    let mut read = AnyPage::EMPTY;
    let scenario = library::find("factory").expect("built in").expect("sound");
    let written = Provision { channel: 5, rotation: 2, accepts: Some(1), ..Provision::new(RobotId(0), KEY) };
    read.load_bytes(&written.page(&scenario).expect("it fits")).expect("it was checked");
    let settings = read.settings(1).expect("a member");
    let (on_robot, context) = (SipHash64::with(settings.keys().clone()), Context::from_bits(3));
    for sender in (0..scenario.robots.len() as u8).map(RobotId) {
        for rotation in 0..4 {
            let tag = SipHash64::with(Keys::of_team(&KEY, 5, rotation)).tag(sender, context, b"frame");
            let is_accepted = on_robot.verify(sender, context, b"frame", &tag);
            assert_eq!(is_accepted, rotation == 1 || rotation == 2, "{sender:?} {rotation}");
            assert_eq!(on_robot.tag(sender, context, b"frame") == tag, rotation == 2);
        }
    }
}

#[test]
fn a_page_with_any_bit_changed_is_refused_and_the_other_copy_counts() {
    let (old, new) = (page(1), page(2));
    for bit in 0..8 * new.len() {
        let mut damaged = new.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        let mut read = AnyPage::EMPTY;
        assert!(read.load_bytes(&damaged).is_err(), "bit {bit}");
        for copies in [[damaged.clone(), old.clone()], [old.clone(), damaged]] {
            let origin = read.load(&mut Copies(copies), TWO).expect("the old copy is whole");
            assert!(origin.generation == 1 && origin.other.is_some(), "bit {bit}: {origin:?}");
        }
    }
}

#[test]
fn a_page_that_was_cut_off_anywhere_is_refused_and_the_other_copy_counts() {
    let (old, new) = (page(1), page(2));
    for length in 0..new.len() {
        let mut read = AnyPage::EMPTY;
        let short = new[..length].to_vec();
        let refused = read.load_bytes(&short).expect_err("it is cut off");
        let Refused::Both { first, second } = refused else { panic!("{refused:?}") };
        assert!(second.fault == Fault::Blank && first.at as usize <= new.len(), "{refused:?}");
        let origin = read.load(&mut Copies([short, old.clone()]), TWO).expect("the old copy is whole");
        assert_eq!((origin.which, origin.generation), (Which::Second, 1), "{length}");
    }
}

/// Puts the right checksum on a page, as a wrong writer would.
fn sealed(mut page: Vec<u8>) -> Vec<u8> {
    let end = page.len() - 4;
    let checksum = CHECKSUM.checksum(&page[..end]);
    page[end..].copy_from_slice(&checksum.to_le_bytes());
    page
}

/// A reader of any page: what it makes of it is sound or refused with a place inside it.
fn reads_or_refuses(page: &[u8]) -> bool {
    let mut read = AnyPage::EMPTY;
    match read.load_bytes(page) {
        Ok(_) => {
            let lists = read.path_lists();
            assert_eq!(read.mission(&lists).check::<MAX_CELLS>(), Ok(()));
            assert!(read.settings(1).is_ok());
            true
        }
        Err(Refused::Content { error, .. } | Refused::Both { first: error, .. }) => {
            let is_inside = error.at as usize <= page.len() || error.fault == Fault::Checksum;
            assert!(is_inside, "{error}");
            false
        }
        Err(refused) => panic!("there is one copy: {refused}"),
    }
}

#[test]
fn pages_with_a_right_checksum_and_wrong_content_are_refused_by_name_or_sound() {
    let good = page(1);
    let mut refused = 0;
    for at in 0..good.len() - 4 {
        for value in 0..=u8::MAX {
            let mut other = good.clone();
            other[at] = value;
            refused += u32::from(!reads_or_refuses(&sealed(other)));
        }
    }
    assert!(refused > 10_000, "{refused}");
}

#[test]
fn any_bytes_are_read_or_refused() {
    let mut random = crate::Random::new(7);
    let good = page(1);
    for round in 0..100_000 {
        let mut other = good.clone();
        match round % 3 {
            0 => (0..1 + random.below(8)).for_each(|_| {
                let at = random.below(other.len());
                other[at] = random.bits() as u8;
            }),
            1 => {
                let from = random.below(other.len() - 24) + 20;
                other.drain(from..(from + 1 + random.below(8)).min(good.len() - 4));
            }
            _ => other[20..].iter_mut().for_each(|byte| *byte = random.bits() as u8),
        }
        let length = other.len() as u32;
        other[16..20].copy_from_slice(&length.to_le_bytes());
        reads_or_refuses(&sealed(other));
    }
}

#[test]
fn a_page_for_a_larger_image_is_refused_with_the_name_of_the_size() {
    fn refusal<const S: usize, const W: usize, const P: usize>(name: &str) -> Option<Fault> {
        let scenario = library::find(name).expect("built in").expect("sound");
        let page = Provision::new(RobotId(0), KEY).page(&scenario).expect("it fits");
        let mut read = Page::<S, W, P>::EMPTY;
        match read.load_bytes(&page).err()? {
            Refused::Content { error, .. } => Some(error.fault),
            refused => panic!("{refused}"),
        }
    }
    let too_large = |size, needed, room| Some(Fault::TooLarge { size, needed, room });
    assert_eq!(refusal::<49, 2, 8>("two-goals"), None);
    assert_eq!(refusal::<48, 2, 8>("two-goals"), too_large(Size::Cells, 49, 48));
    assert_eq!(refusal::<49, 1, 8>("two-goals"), too_large(Size::Cells, 49, 32));
    assert_eq!(refusal::<49, 2, 7>("two-goals"), too_large(Size::Paths, 8, 7));
    assert_eq!(refusal::<255, 8, 0>("courtyard"), too_large(Size::Cells, 256, 255));
}

#[test]
fn of_two_copies_the_newer_counts_and_equal_ones_must_be_the_same() {
    let mut read = AnyPage::EMPTY;
    let mut load = |first, second| read.load(&mut Copies([first, second]), TWO);
    assert_eq!(load(page(1), page(2)).map(|origin| origin.which), Ok(Which::Second));
    assert_eq!(load(page(3), page(2)).map(|origin| origin.which), Ok(Which::First));
    assert_eq!(load(page(2), page(2)).map(|origin| (origin.which, origin.other)), Ok((Which::First, None)));
    let scenario = library::find("factory").expect("built in").expect("sound");
    let other = Provision::new(RobotId(0), KEY).page(&scenario).expect("it fits");
    assert_eq!(load(page(1), other), Err(Refused::Ambiguous(1)));
}

#[test]
fn a_newer_page_that_does_not_fit_is_not_replaced_by_an_older_one() {
    let scenario = library::find("courtyard").expect("built in").expect("sound");
    let large = Provision { generation: 2, ..Provision::new(RobotId(0), KEY) };
    let mut copies = Copies([page(1), large.page(&scenario).expect("it fits")]);
    let refused = Page::<64, 2, 8>::EMPTY.clone().load(&mut copies, TWO);
    assert!(matches!(refused, Err(Refused::Content { which: Which::Second, .. })), "{refused:?}");
}
