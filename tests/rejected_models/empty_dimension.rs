use iibt_core::inference::likelihood::Dense;

static A: Dense = Dense::new(&[], 2, &[0]);

fn main() {
    let _ = &A;
}
