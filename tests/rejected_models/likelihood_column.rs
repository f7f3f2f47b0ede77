use iibt_core::inference::likelihood::DenseLikelihood;

static A: DenseLikelihood = DenseLikelihood::new(&[0.97, 0.2, 0.0, 0.8], 2, &[2]);

fn main() {
    let _ = &A;
}
