use iibt_core::inference::transition::Dense;

static B: Dense<2, 1> = Dense::new([[[1.0, 0.5], [0.0, 0.4]]]);

fn main() {
    let _ = &B;
}
