use iibt_core::inference::{IdentityNoise, Model, NextState};

static MODEL: Model<IdentityNoise<2>, NextState<2, 1>, 2, 2> =
    Model::new(IdentityNoise::new(0.9), NextState::new([[1, 0]]), [0.0, 1.0], [0.5, 0.4]);

fn main() {
    let _ = &MODEL;
}
