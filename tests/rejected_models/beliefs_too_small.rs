use iibt_core::inference::{Beliefs, Factor, IdentityNoise, Modality, Model, NextState};

static MOTION: NextState = NextState::new(&[0, 1, 2, 3, 4], 5);
static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 5);
static FACTORS: [Factor; 1] = [Factor::new(&MOTION, MOTION.shape(), &[0.2; 5])];
static MODALITIES: [Modality; 1] = [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0; 5])];
static MODEL: Model = Model::new(&FACTORS, &MODALITIES);
static BELIEFS: Beliefs<4, 1> = Beliefs::prior(&MODEL);

fn main() {
    let _ = &BELIEFS;
}
