//! A robot of a team on the STM32F405, in step with a host: it ticks when the host has told it what
//! it reads and hears, and answers with the cycles of the tick and its frame.
//!
//! Over USART2 it gets the number of robots, of the draw of their problem and its own, and what the
//! problem is: 0 for goals of anybody, 1 for goals that robots own, and with the feature `unknowns`
//! 2 for the bays of which the one of the draw serves. Then, for each tick, the cell (two bytes)
//! and the length of what it hears (two bytes), little-endian, and that. It answers with the cycles
//! (four bytes), the length of its frame (one byte) and the frame.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This image runs in step with a host: `cargo test -p tests --test all lockstep` starts it.");
}

#[cfg(target_os = "none")]
mod image {
    use cortex_m::singleton;
    use firmware::adapters::{Absent, Chassis};
    use firmware::bench::joint_plans::Instance;
    use firmware::bench::lockstep::{self, Robot, Senses, WORDS};
    #[cfg(feature = "unknowns")]
    use firmware::bench::sign::{self, Eyes};
    use firmware::board::{self, Board, TeamLink};
    use firmware::hardware::Link;
    use iibt_core::grid::Cell;
    use iibt_core::navigation::Mission;
    use static_cell::StaticCell;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let Some(mut board) = Board::take(Chassis::STANDING) else { board::restart() };
        defmt::info!("boot: in step with a host");
        let [robots, draw, number, kind] = [(); 4].map(|()| byte(&mut board.link));
        match kind {
            0 | 1 => match start(robots, draw, number, kind == 1) {
                Some(robot) => run(robot, &mut board),
                None => board::restart(),
            },
            #[cfg(feature = "unknowns")]
            2 => match start_looking(robots, draw, number) {
                Some(robot) => run(robot, &mut board),
                None => board::restart(),
            },
            _ => board::restart(),
        }
    }

    /// `None` when there is no such robot.
    #[cfg(feature = "unknowns")]
    #[inline(never)]
    fn start_looking(
        robots: u8,
        serving: u8,
        number: u8,
    ) -> Option<&'static mut Robot<'static, { sign::CELLS }, { sign::WORDS }, Eyes>> {
        type Looking = Robot<'static, { sign::CELLS }, { sign::WORDS }, Eyes>;
        let mission = sign::mission(robots.into())?;
        let mission: &'static Mission<'static, { sign::WORDS }> =
            singleton!(: Mission<'static, { sign::WORDS }> = mission)?;
        static ROBOT: StaticCell<Looking> = StaticCell::new();
        let settings = lockstep::settings(mission, number)?;
        let robot = ROBOT.try_init_with(|| lockstep::idle(&settings, Eyes::new(serving)))?;
        lockstep::start(robot, mission, &settings)?;
        Some(robot)
    }

    /// `None` when there is no such problem or robot.
    #[inline(never)]
    fn start(robots: u8, draw: u8, number: u8, owned: bool) -> Option<&'static mut Robot<'static>> {
        let problem = lockstep::problem(robots.into(), draw.into())?;
        let problem: &'static Instance = singleton!(: Instance = problem)?;
        let mission = if owned { problem.mission_with_owners() } else { problem.mission() };
        let mission: &'static Mission<'static, WORDS> = singleton!(: Mission<'static, WORDS> = mission)?;
        static ROBOT: StaticCell<Robot<'static>> = StaticCell::new();
        let settings = lockstep::settings(mission, number)?;
        let robot = ROBOT.try_init_with(|| lockstep::idle(&settings, Absent))?;
        lockstep::start(robot, mission, &settings)?;
        Some(robot)
    }

    fn run<const S: usize, const W: usize, E: Senses>(
        robot: &'static mut Robot<'static, S, W, E>,
        board: &mut Board,
    ) -> ! {
        defmt::info!("navigation takes {=usize} bytes", size_of_val(robot.robot()));
        loop {
            let [low, high, short, long] = [(); 4].map(|()| byte(&mut board.link));
            for _ in 0..u16::from_le_bytes([short, long]) {
                // What does not fit is lost, as on the air.
                let _ = robot.hardware_mut().link.heard.push(byte(&mut board.link));
            }
            let started = board.clock.cycles();
            let frame = lockstep::tick(robot, Cell(u16::from_le_bytes([low, high])));
            let took = board.clock.cycles().wrapping_sub(started);
            for part in [&took.to_le_bytes(), &[frame.len() as u8][..], frame] {
                board.link.send(part);
            }
        }
    }

    /// The next byte of the link, once it is there.
    fn byte(link: &mut TeamLink) -> u8 {
        loop {
            if let Some(byte) = link.receive() {
                return byte;
            }
            board::sleep();
        }
    }
}
