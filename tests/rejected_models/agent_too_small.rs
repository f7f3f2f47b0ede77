use iibt_core::inference::{Agent, Factor, IdentityNoise, Modality, Model, NextState};

static MOTION: NextState = NextState::new(&[0, 1], 2);
static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 2);
static FACTORS: [Factor; 2] = [Factor::new(&MOTION, MOTION.shape(), &[0.5; 2]); 2];
static MODALITIES: [Modality; 1] = [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0; 2])];
static MODEL: Model = Model::new(&FACTORS, &MODALITIES);
static AGENT: Agent<4, 1, 2, 2> = Agent::new(&MODEL);

fn main() {
    let _ = &AGENT;
}
