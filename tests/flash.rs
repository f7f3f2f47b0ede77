//! What lies in a robot's flash, while its power is cut: the count of its starts and its page.

use embedded_storage::nor_flash::NorFlash;
use firmware::page::{self, MAX_PAGE, Page, Refused, Slots, StoreError};
use firmware::{BootCounter, EpochError, Storage};
use host_sim::{KEY, Provision, Random, library};
use iibt_core::team::RobotId;
use tests::nor_flash::PoweredFlash;

/// Parts with sixteen entries of eight bytes, or fewer.
const PART: usize = 128;

const COUNTER: BootCounter = BootCounter { first: 0, second: PART as u32, length: PART as u32 };

type Flash<const WRITE: usize> = PoweredFlash<WRITE, PART>;

/// Cuts the power at every operation of every one of 80 starts, and goes on with 40 more.
fn cut_everywhere<const WRITE: usize>() {
    let mut flash = Flash::<WRITE>::erased(2, 0);
    let (mut last, mut cuts) = (0, 0);
    for start in 0..80 {
        for power in 0.. {
            let mut is_cut = false;
            for seed in 0..8 {
                let mut other = flash.clone().with_seed(1000 * start + 10 * u64::from(power) + seed);
                other.power = Some(power);
                let mut taken = last;
                match COUNTER.count(&mut other, 0) {
                    Ok(epoch) => taken = epoch,
                    Err(_) => is_cut = true,
                }
                assert!(is_cut || taken > last, "{taken} after {last}");
                other.power = None;
                for _ in 0..40 {
                    let epoch = COUNTER.count(&mut other, 0).expect("the power is back");
                    assert!(epoch > taken && epoch < last + 60, "{epoch} after {taken} and {last}");
                    taken = epoch;
                }
            }
            if !is_cut {
                break;
            }
            cuts += 1;
        }
        let epoch = COUNTER.count(&mut flash, 0).expect("it has power");
        assert_eq!(epoch, last + 1);
        last = epoch;
    }
    assert!(cuts >= 80 && flash.erasures >= 2, "{cuts} cuts, {} erasures", flash.erasures);
}

#[test]
fn the_count_of_starts_only_grows_wherever_the_power_is_cut() {
    cut_everywhere::<1>();
    cut_everywhere::<4>();
    cut_everywhere::<8>();
    cut_everywhere::<16>();
    cut_everywhere::<32>();
}

#[test]
fn the_count_of_starts_only_grows_over_many_starts_with_power_that_fails_at_random() {
    for seed in 0..20 {
        let (mut flash, mut random) = (Flash::<4>::erased(2, seed), Random::new(seed));
        let (mut last, mut taken, mut lost) = (0, 0, 0);
        for _ in 0..5000 {
            flash.power = (random.below(2) == 0).then(|| random.below(4) as u32);
            match COUNTER.count(&mut flash, 0) {
                Ok(epoch) => {
                    assert!(epoch > last, "{epoch} after {last}");
                    (last, taken) = (epoch, taken + 1);
                }
                Err(_) => lost += 1,
            }
            flash.power = None;
        }
        assert!(taken > 2500 && lost > 1000 && flash.erasures > 100, "{taken} {lost} {}", flash.erasures);
        assert!(last <= taken + 4 * lost, "{last}: {taken} and {lost} that may have been taken");
    }
}

#[test]
fn a_count_that_cannot_be_read_any_more_is_not_taken_again() {
    for starts in 1..60 {
        let mut flash = Flash::<4>::erased(2, 0);
        let last = (0..starts).map(|_| COUNTER.count(&mut flash, 0).expect("it has power")).last();
        let last = last.expect("there is a start");
        let at = flash.bytes.windows(4).step_by(4).position(|word| word == last.to_le_bytes());
        let at = 4 * at.expect("it is written");
        for bit in 0..64 {
            let mut damaged = flash.clone();
            damaged.bytes[at + bit / 8] ^= 1 << (bit % 8);
            let next = COUNTER.count(&mut damaged, 0).expect("it can be written");
            assert_eq!(next, last + 1, "bit {bit} of the count after {starts} starts");
        }
    }
}

#[test]
fn a_start_that_is_not_counted_has_no_epoch() {
    let mut flash = Flash::<4>::erased(2, 0);
    flash.is_stuck = true;
    assert_eq!(COUNTER.count(&mut flash, 7), Err(EpochError::Unwritable), "writes that change nothing");
    flash.power = Some(0);
    assert_eq!(COUNTER.count(&mut flash, 7), Err(EpochError::Unreadable));

    let flash = Flash::<4>::erased(2, 0);
    let mut storage = Storage { flash, page: SLOTS, counter: None };
    assert_eq!(storage.epoch(0), Err(EpochError::NotCounted));
    assert_eq!([storage.epoch(7), storage.epoch(7)], [Ok(7); 2], "whoever loads the page counts");
    storage.counter = Some(COUNTER);
    assert_eq!([storage.epoch(7), storage.epoch(7)], [Ok(7), Ok(8)]);

    let mut foreign = Flash::<4>::erased(2, 0);
    foreign.bytes.fill(0x55);
    assert_eq!(COUNTER.count(&mut foreign, 7), Err(EpochError::Lost));
    let mut full = Flash::<4>::erased(2, 0);
    assert_eq!(COUNTER.count(&mut full, u32::MAX - 1), Ok(u32::MAX - 1));
    assert_eq!(COUNTER.count(&mut full, 0), Err(EpochError::Exhausted));
    assert_eq!(COUNTER.count(&mut full, 0), Err(EpochError::Exhausted));
}

const SLOTS: Slots = Slots { first: 0, second: MAX_PAGE };

type PageFlash = PoweredFlash<4, 4096>;

fn page_of(generation: u32, robot: u8) -> Vec<u8> {
    let scenario = library::find("two-goals").expect("built in").expect("sound");
    Provision { generation, ..Provision::new(RobotId(robot), KEY) }.page(&scenario).expect("it fits")
}

/// The generation and the robot of the page in a flash.
fn stored<F: NorFlash>(flash: &mut F) -> Result<(u32, u8), Refused> {
    let mut page = Page::<64, 2, 8>::EMPTY;
    page.load(flash, SLOTS).map(|origin| (origin.generation, page.robot().0))
}

#[test]
fn a_page_whose_writing_is_cut_off_anywhere_leaves_the_one_before_or_the_new_one() {
    let (old, new) = (page_of(1, 0), page_of(2, 1));
    let mut before = PageFlash::erased(4, 0);
    page::store(&mut before, SLOTS, &old).expect("it has power");
    assert_eq!(stored(&mut before), Ok((1, 0)));
    let (mut olds, mut news) = (0, 0);
    for power in 0.. {
        let mut flash = before.clone().with_seed(power.into());
        flash.power = Some(power);
        let outcome = page::store(&mut flash, SLOTS, &new);
        flash.power = None;
        match stored(&mut flash) {
            Ok((1, 0)) => olds += 1,
            Ok((2, 1)) => news += 1,
            wrong => panic!("power for {power} operations: {wrong:?}"),
        }
        if outcome.is_ok() {
            break;
        }
        // A second write finds it done or does it.
        let again = page::store(&mut flash, SLOTS, &new);
        assert!(matches!(again, Ok(()) | Err(StoreError::NotNewer(2))), "{again:?}");
        assert_eq!(stored(&mut flash), Ok((2, 1)));
    }
    assert!(olds > 50 && news > 50, "{olds} {news}");
}

#[test]
fn only_a_newer_whole_page_is_stored_and_an_erased_one_is_gone() {
    let mut flash = PageFlash::erased(4, 0);
    let mut damaged = page_of(3, 0);
    damaged[30] ^= 1;
    assert!(matches!(page::store(&mut flash, SLOTS, &damaged), Err(StoreError::Page(_))));
    page::store(&mut flash, SLOTS, &page_of(3, 0)).expect("it is whole");
    assert_eq!(page::store(&mut flash, SLOTS, &page_of(3, 1)), Err(StoreError::NotNewer(3)));
    assert_eq!(stored(&mut flash), Ok((3, 0)));
    page::erase(&mut flash, SLOTS).expect("it has power");
    assert!(stored(&mut flash).is_err() && flash.bytes.iter().all(|&byte| byte == 0xff));
}
