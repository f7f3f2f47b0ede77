use iibt_core::inference::{Factor, IdentityNoise, Modality, Model, NextState};

static MOTION: NextState = NextState::new(&[1, 0], 2);
static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 3);
static FACTORS: [Factor; 1] = [Factor::new(&MOTION, MOTION.shape(), &[0.5, 0.5])];
static MODALITIES: [Modality; 1] = [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0, 0.0, 1.0])];
static MODEL: Model = Model::new(&FACTORS, &MODALITIES);

fn main() {
    let _ = &MODEL;
}
