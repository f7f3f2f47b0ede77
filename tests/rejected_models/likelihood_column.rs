use iibt_core::inference::likelihood::Dense;

static A: Dense = Dense::new(&[0.97, 0.2, 0.0, 0.8], 2, &[2]);

fn main() {
    let _ = &A;
}
