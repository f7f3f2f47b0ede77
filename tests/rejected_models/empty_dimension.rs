use iibt_core::inference::likelihood::DenseLikelihood;

static A: DenseLikelihood = DenseLikelihood::new(&[], 2, &[0]);

fn main() {
    let _ = &A;
}
