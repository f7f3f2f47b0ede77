use iibt_core::inference::likelihood::Dense;

static A: Dense<2, 2> = Dense::new([[0.97, 0.2], [0.0, 0.8]]);

fn main() {
    let _ = &A;
}
