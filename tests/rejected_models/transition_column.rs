use iibt_core::inference::transition::DenseTransition;

static B: DenseTransition = DenseTransition::new(&[1.0, 0.5, 0.0, 0.4], 1, &[2]);

fn main() {
    let _ = &B;
}
