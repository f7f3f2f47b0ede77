//! An image that drives and fails as it is told over the link, to test what a robot does then: `p`
//! panics, `f` faults, `s` overflows the stack, `l` does not come round to its main loop any more,
//! `d` does so without interrupts, and `o` logs more than the queue of the log holds.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This image is for the tests of the board. Build it with `cargo fw`.");
}

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;
    use firmware::board::{self, Board, Guard};
    use firmware::hardware::{Drive, Link};
    use firmware::team_member::CHASSIS;
    use iibt_core::grid::Move;
    use iibt_core::time::Duration;

    /// Within how many milliseconds the main loop has to come round.
    const LIMIT: Duration = Duration(100);

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let Some(mut board) = Board::take(CHASSIS) else { board::restart() };
        let mut guard = Guard::start(board.watchdog, LIMIT);
        board.drive.go(Move::Up);
        defmt::info!("boot");
        loop {
            guard.feed();
            match board.link.receive() {
                Some(b'p') => panic!("asked to"),
                Some(b'f') => cortex_m::asm::udf(),
                Some(b's') => defmt::info!("{=u32}", deeper(1)),
                Some(b'l') => drive_on(&mut board.drive),
                Some(b'd') => cortex_m::interrupt::free(|_| drive_on(&mut board.drive)),
                Some(b'o') => log_too_much(),
                _ => board::sleep(),
            }
        }
    }

    /// Never comes back, and drives all the while.
    fn drive_on(drive: &mut impl Drive) -> ! {
        loop {
            drive.go(Move::Up);
        }
    }

    /// Logs 2,000 lines while no interrupt can send any.
    fn log_too_much() {
        critical_section::with(|_| (0..2000_u32).for_each(|line| defmt::info!("line {=u32}", line)));
        #[cfg(not(feature = "rtt"))] // by RTT none is dropped: the oldest bytes are written over
        defmt::info!("dropped {=u32}", board::dropped_log_frames());
    }

    /// Needs more stack with every call, and does not end for a positive `depth` before it wraps.
    #[inline(never)]
    fn deeper(depth: u32) -> u32 {
        let frame = black_box([depth; 64]);
        let below = if depth == 0 { 0 } else { deeper(depth.wrapping_add(1)) };
        below.wrapping_add(black_box(&frame).iter().fold(0, |sum, word| sum ^ word))
    }
}
