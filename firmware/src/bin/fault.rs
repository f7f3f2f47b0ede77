//! An image that fails as it is told over the link, to test what a robot does then: `p` panics, `f`
//! faults, `s` overflows the stack.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This image is for the tests of the board. Build it with `cargo fw`.");
}

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;
    use firmware::adapters::Chassis;
    use firmware::board::{self, Board};
    use firmware::hardware::Link;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let Some(mut board) = Board::take(Chassis::STANDING) else { board::restart() };
        defmt::info!("boot");
        loop {
            match board.link.receive() {
                Some(b'p') => panic!("asked to"),
                Some(b'f') => cortex_m::asm::udf(),
                Some(b's') => defmt::info!("{=u32}", deeper(1)),
                _ => board::sleep(),
            }
        }
    }

    /// Needs more stack with every call, and does not end for a positive `depth` before it wraps.
    #[inline(never)]
    fn deeper(depth: u32) -> u32 {
        let frame = black_box([depth; 64]);
        let below = if depth == 0 { 0 } else { deeper(depth.wrapping_add(1)) };
        below.wrapping_add(black_box(&frame).iter().fold(0, |sum, word| sum ^ word))
    }
}
