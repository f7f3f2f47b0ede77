use iibt_core::inference::{IdentityNoise, Modality};

static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 2);
static C: Modality = Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0, 1.0, 0.0]);

fn main() {
    let _ = &C;
}
