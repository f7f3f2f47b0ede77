use iibt_core::inference::NextState;

static B: NextState = NextState::new(&[1, 2], 2);

fn main() {
    let _ = &B;
}
