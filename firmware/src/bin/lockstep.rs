//! A robot of a team on the STM32F405, in step with a host: it ticks when the host has told it what
//! it reads and hears, and answers with the cycles of the tick and its frame.
//!
//! Over USART2 it gets the number of robots, of the draw of their problem and its own, and whether
//! each robot owns a goal; then for each tick the cell (two bytes) and the length of what it hears
//! (two bytes), little-endian, and that. It answers with the cycles (four bytes), the length of its
//! frame (one byte) and the frame.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This image runs in step with a host: `cargo test -p tests --test all lockstep` starts it.");
}

#[cfg(target_os = "none")]
mod image {
    use cortex_m::singleton;
    use firmware::adapters::Chassis;
    use firmware::bench::joint_plans::Instance;
    use firmware::bench::lockstep::{self, Robot, WORDS};
    use firmware::board::{self, Board, TeamLink};
    use firmware::hardware::Link;
    use iibt_core::grid::Cell;
    use iibt_core::navigation::Mission;
    use static_cell::StaticCell;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let Some(mut board) = Board::take(Chassis::STANDING) else { board::restart() };
        defmt::info!("boot: in step with a host");
        match start(&mut board.link) {
            Some(robot) => {
                defmt::info!("navigation takes {=usize} bytes", size_of_val(robot.robot()));
                run(robot, &mut board)
            }
            None => board::restart(),
        }
    }

    /// `None` when there is no such problem or robot.
    #[inline(never)]
    fn start(link: &mut TeamLink) -> Option<&'static mut Robot<'static>> {
        let [robots, draw, number, owned] = [(); 4].map(|()| byte(link));
        let problem = lockstep::problem(robots.into(), draw.into())?;
        let problem: &'static Instance = singleton!(: Instance = problem)?;
        let mission = if owned == 0 { problem.mission() } else { problem.mission_with_owners() };
        let mission: &'static Mission<'static, WORDS> = singleton!(: Mission<'static, WORDS> = mission)?;
        static ROBOT: StaticCell<Robot<'static>> = StaticCell::new();
        let settings = lockstep::settings(mission, number)?;
        let robot = ROBOT.try_init_with(|| lockstep::idle(&settings))?;
        lockstep::start(robot, mission, &settings)?;
        Some(robot)
    }

    fn run(robot: &'static mut Robot<'static>, board: &mut Board) -> ! {
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
