//! Support for building the examples for a chip, where nothing is printed.

/// Prints a line on the PC.
macro_rules! show {
    ($($text:tt)*) => {{
        #[cfg(not(target_os = "none"))]
        println!($($text)*);
        #[cfg(target_os = "none")]
        let _ = format_args!($($text)*);
    }};
}

/// Runs an example: as a program and as a test on the PC, and as code that is linked on the chip.
macro_rules! play {
    ($play:path) => {
        #[cfg(not(target_os = "none"))]
        fn main() {
            $play();
        }

        #[cfg(target_os = "none")]
        #[used]
        static PLAY: fn() = $play;

        #[test]
        fn it_shows_what_it_says() {
            $play();
        }
    };
}

#[cfg(target_os = "none")]
#[panic_handler]
fn stop(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
