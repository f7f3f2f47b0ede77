use iibt_core::inference::IdentityNoise;

static A: IdentityNoise = IdentityNoise::new(1.2, 4);

fn main() {
    let _ = &A;
}
