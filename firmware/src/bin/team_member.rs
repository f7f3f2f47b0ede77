//! Robot 1 of the paper's section 5.1 on a board: `cargo fw` builds it for the STM32F405.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "This image runs on a robot: `cargo fw` builds it, `cargo fw-run team_member` starts it in QEMU."
    );
}

#[cfg(target_os = "none")]
mod image {
    use firmware::board::{self, Board, Gauge, Milliseconds, Motors, TeamLink};
    use firmware::team_member::{self, CHASSIS, Memory};

    static MEMORY: Memory<TeamLink, Milliseconds, Motors, Gauge> = Memory::new();

    #[board::entry]
    fn main() -> ! {
        let Some(Board { link, clock, drive, battery, .. }) = Board::take(CHASSIS) else { board::restart() };
        match MEMORY.start(link, clock, drive, battery) {
            Some(robot) => team_member::run(robot, || clock.cycles(), board::sleep),
            None => board::restart(),
        }
    }
}
