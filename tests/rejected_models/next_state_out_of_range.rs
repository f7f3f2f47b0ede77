use iibt_core::inference::NextState;

static B: NextState<2, 1> = NextState::new([[1, 2]]);

fn main() {
    let _ = &B;
}
