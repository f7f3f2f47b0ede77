use iibt_core::inference::{Factor, NextState};

static MOTION: NextState = NextState::new(&[1, 0], 2);
static D: Factor = Factor::new(&MOTION, MOTION.shape(), &[0.5, 0.4]);

fn main() {
    let _ = &D;
}
