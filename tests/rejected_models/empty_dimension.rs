use iibt_core::inference::likelihood::Dense;

static A: Dense<0, 2> = Dense::new([[], []]);

fn main() {
    let _ = &A;
}
