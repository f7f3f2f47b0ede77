//! The 21-node reference tree in both forms, to measure what a tree takes of the flash: four times
//! "unless a condition holds, if another does, act".
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This image is for the budget of trees. Build it with `cargo fw`.");
}

#[cfg(target_os = "none")]
mod leaves {
    use core::sync::atomic::{AtomicBool, Ordering};
    use iibt_core::time::Instant;
    use iibt_core::tree::{Halt, Leaves, Status};

    #[derive(Clone, Copy)]
    pub(crate) enum Leaf {
        Holds,
        Fails,
        Act,
    }

    /// Each leaf looks at a flag that an interrupt could change, so that no two looks can be made
    /// one.
    pub(crate) struct TreeRobot {
        pub(crate) flags: [AtomicBool; 3],
        pub(crate) calls: u32,
    }

    impl TreeRobot {
        /// The work of a leaf is no part of the cost of a tree: it is code once, and called.
        #[inline(never)]
        fn look(&mut self, leaf: Leaf) -> bool {
            self.calls = self.calls.wrapping_add(1);
            self.flags.get(leaf as usize).is_some_and(|flag| flag.load(Ordering::Relaxed))
        }
    }

    impl Leaves<Leaf> for TreeRobot {
        fn condition(&mut self, leaf: &Leaf, _: Instant) -> bool {
            self.look(*leaf)
        }

        fn on_start(&mut self, leaf: &Leaf, _: Instant) -> Status {
            if self.look(*leaf) { Status::Success } else { Status::Running }
        }

        fn on_running(&mut self, leaf: &Leaf, now: Instant) -> Status {
            self.on_start(leaf, now)
        }

        fn on_halted(&mut self, _: &Leaf, _: Instant) -> Halt {
            self.calls = self.calls.wrapping_add(1);
            Halt::Done
        }
    }
}

#[cfg(target_os = "none")]
macro_rules! t21 {
    ($form:ident) => {
        iibt_core::$form! { Sequence {
            Fallback { Condition(Leaf::Fails), Sequence { Condition(Leaf::Holds), Action(Leaf::Act) } },
            Fallback { Condition(Leaf::Fails), Sequence { Condition(Leaf::Holds), Action(Leaf::Act) } },
            Fallback { Condition(Leaf::Fails), Sequence { Condition(Leaf::Holds), Action(Leaf::Act) } },
            Fallback { Condition(Leaf::Fails), Sequence { Condition(Leaf::Holds), Action(Leaf::Act) } },
        } }
    };
}

#[cfg(target_os = "none")]
mod table {
    use super::leaves::{Leaf, TreeRobot};
    use iibt_core::time::Instant;
    use iibt_core::tree::{Memory, Status, Tree};

    static T21: Tree<Leaf, 21> = t21!(tree);

    #[inline(never)]
    pub(crate) fn tick(memory: &mut Memory<21>, robot: &mut TreeRobot, now: Instant) -> Status {
        T21.tick(memory, robot, now).status
    }

    #[inline(never)]
    pub(crate) fn halt(memory: &mut Memory<21>, robot: &mut TreeRobot, now: Instant) {
        let _ = T21.halt(memory, robot, now);
    }
}

#[cfg(target_os = "none")]
mod compiled {
    use super::leaves::{Leaf, TreeRobot};
    use iibt_core::time::Instant;
    use iibt_core::tree::{Compiled, Status};

    pub(crate) const fn t21() -> impl Compiled<Leaf, TreeRobot> {
        t21!(compiled_tree)
    }

    #[inline(never)]
    pub(crate) fn tick(
        tree: &mut impl Compiled<Leaf, TreeRobot>,
        robot: &mut TreeRobot,
        now: Instant,
    ) -> Status {
        tree.tick(robot, now)
    }

    #[inline(never)]
    pub(crate) fn halt(tree: &mut impl Compiled<Leaf, TreeRobot>, robot: &mut TreeRobot, now: Instant) {
        tree.halt(robot, now);
    }
}

#[cfg(target_os = "none")]
mod image {
    use super::leaves::TreeRobot;
    use super::{compiled, table};
    use core::hint::black_box;
    use core::sync::atomic::AtomicBool;
    use firmware::board;
    use iibt_core::time::Instant;
    use iibt_core::tree::Memory;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let mut memory = Memory::new();
        let mut tree = compiled::t21();
        let mut robot = TreeRobot { flags: [true, false, true].map(AtomicBool::new), calls: 0 };
        loop {
            let now = Instant(robot.calls);
            black_box(&robot.flags);
            black_box(table::tick(&mut memory, &mut robot, now));
            table::halt(&mut memory, &mut robot, now);
            black_box(compiled::tick(&mut tree, &mut robot, now));
            compiled::halt(&mut tree, &mut robot, now);
            board::sleep();
        }
    }
}
